"""Robots whose set-points come from a program, tick by tick: for what learns."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from proleg import _core
from proleg._checks import Unique, array, whole
from proleg.run import _scenario
from proleg.scenario import Scenario


class Worlds(Unique):
    """Robots that are alike, each in a world of its own, moved by set-points that the caller gives at each tick.

    Robot and world are those of a scenario; its gait does not run. From a set-point on, everything is as in simulate():
    limits, servo pulses, servos, world. So the set-points of a run give the motion of that run, to the last bit. In the
    reduced engine, worlds make their steps together.

        worlds = proleg.Worlds("caterpillar", n=64)
        observation = worlds.reset(seed=1)
        while True:
            observation, reward, done, info = worlds.step(policy(observation))
            if done.all():
                break

    A world ends (`done`) after the duration of the scenario, or if its simulation fails. It then stays as it is, with the
    reward 0, until reset(), which begins all of them anew.
    """

    def __init__(self, scenario: Scenario | str | os.PathLike[str], n: int = 1, *, seconds: float | None = None,
                 engine: str | None = "reduced") -> None:
        """scenario: as in simulate(). n: worlds, 1 to 4096. seconds: length of an episode, by default that of the scenario.
        engine: "reduced", or another one; None takes that of the scenario.

        Raises InputError, for example for a robot that the engine does not have.
        """
        count = whole("n", n)
        if not 1 <= count <= 4096:
            raise _core.InputError(f"n: found {count}, expected 1 to 4096")
        self._scenario = _scenario(scenario).replace(engine=engine, seconds=seconds)
        self._worlds = _core.Worlds(self._scenario._state, count)
        self._n = count
        self._names = tuple(self._worlds.names)
        self._joints = len(self._scenario.joints)

    @property
    def n(self) -> int:
        """Number of worlds."""
        return self._n

    @property
    def joints(self) -> list[str]:
        """Names of the joints, from the head: the columns of the set-points."""
        return self._scenario.joints

    @property
    def observation_names(self) -> tuple[str, ...]:
        """Columns of an observation: "angle_deg.J5", "speed_deg_per_s.J5" and "current_mA.J5" of each joint,
        "contact_rear.Head" and "contact_front.Head" (0 or 1) of each link, and the orientation of the head, "qw.Head" to
        "qz.Head". All of it is known at the end of the tick; a module has the contacts then, too."""
        return self._names

    @property
    def tick(self) -> float:
        """Seconds of a tick."""
        return self._scenario.tick

    @property
    def positions(self) -> NDArray[np.float64]:
        """(n, links, 3) m: the frames of the links in their worlds."""
        return self._worlds.positions

    @property
    def displacements(self) -> NDArray[np.float64]:
        """(n) m: how far the centre of mass is from its start."""
        return self._worlds.displacements

    def reset(self, seed: int = 0, setpoints: ArrayLike | None = None) -> NDArray[np.float64]:
        """Puts all robots back to their start, and returns the observation, (n, len(observation_names)).

        seed: 0 to 2^63; world i has the seed `seed + i`, for the noise of its touch sensors. setpoints: (n, joints) or
        (joints), degrees, from which the robots begin; by default 0.
        """
        number = whole("seed", seed)
        if not 0 <= number <= 2**63:
            raise _core.InputError(f"seed: found {number}, expected 0 to 2^63")
        return self._worlds.reset(number, self._array(0.0 if setpoints is None else setpoints))

    def step(self, setpoints: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_], dict[str, Any]]:
        """A tick of all worlds that have not ended.

        setpoints: (n, joints) degrees at the end of the tick, or (joints) for all worlds; what is beyond the limits of a
        joint is cut to them.

        Returns the observation; the reward (n): m that the centre of mass came in the tick in the direction that the head
        had at the start; done (n); and info, with "failures": for each world why its simulation failed, only in a tick in
        which one is done. Raises InputError for what are no such numbers.
        """
        observation, reward, ended = self._worlds.step(self._array(setpoints))
        done = ended.view(np.bool_)
        return observation, reward, done, {"failures": self._worlds.failures} if done.any() else {}

    def _array(self, given: ArrayLike) -> NDArray[np.float64]:
        values = array("setpoints", given, f"({self._n}, {self._joints}) numbers")
        if values.shape == (self._n, self._joints):
            return values
        if values.ndim == 0 or values.shape == (self._joints,):
            return np.broadcast_to(values, (self._n, self._joints))
        raise _core.InputError(f"setpoints: found an array of shape {values.shape}, expected ({self._n}, {self._joints}) numbers")

"""Worlds with the interface of Gymnasium (https://gymnasium.farama.org, version 1): Env, and VectorEnv for many at once.

With the package gymnasium they are its Env and VectorEnv, with its spaces. Without it (Debian 12 has none) they have the same
methods and a Box of their own, so that a program for the one runs with the other.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from proleg import _core
from proleg._checks import Unique, whole
from proleg.scenario import Scenario
from proleg.worlds import Worlds


class _Chance:
    """Random numbers. Without a seed they are other ones in a process that was forked."""

    def _seed(self, seed: int | None) -> None:
        self._process = None if seed is not None else os.getpid()
        self._chance = np.random.default_rng(seed)

    def _renew(self) -> None:
        if self._process not in (None, os.getpid()):
            self._seed(None)


class _Box(_Chance):
    """A box of numbers, as gymnasium.spaces.Box: every number has its own bounds, which may be infinite."""

    def __init__(self, low: NDArray[Any], high: NDArray[Any], dtype: Any = np.float32, seed: int | None = None) -> None:
        self.low = np.asarray(low, dtype=dtype)
        self.high = np.asarray(high, dtype=dtype)
        self.shape = self.low.shape
        self.dtype = np.dtype(dtype)
        self._seed(seed)

    def seed(self, seed: int | None = None) -> int | None:
        self._seed(seed)
        return seed

    def sample(self) -> NDArray[Any]:
        """Uniform between two bounds, exponential from one, normal without bounds."""
        self._renew()
        low, high = self.low.astype(np.float64), self.high.astype(np.float64)
        below, above = np.isfinite(low), np.isfinite(high)
        far = self._chance.exponential(size=self.shape)
        one = np.where(below, low + far, np.where(above, high - far, self._chance.standard_normal(self.shape)))
        both = self._chance.uniform(np.where(below, low, 0), np.where(above, high, 1))
        drawn: NDArray[Any] = np.where(below & above, both, one).astype(self.dtype)
        return drawn

    def contains(self, x: Any) -> bool:
        array = np.asarray(x)
        return (array.shape == self.shape and np.can_cast(array.dtype, self.dtype)
                and bool(np.all(array >= self.low) and np.all(array <= self.high)))

    __contains__ = contains

    def __eq__(self, other: object) -> bool:
        return (isinstance(other, _Box) and self.dtype == other.dtype and np.array_equal(self.low, other.low)
                and np.array_equal(self.high, other.high))

    def __repr__(self) -> str:
        return f"Box({self.low.min()}, {self.high.max()}, {self.shape}, {self.dtype})"


class _Env:
    """What Env and VectorEnv have of Gymnasium's classes."""

    metadata: dict[str, Any] = {"render_modes": []}
    render_mode = None
    spec = None

    @property
    def unwrapped(self) -> Any:
        return self

    def render(self) -> None:
        return None

    def close(self) -> None:
        pass

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


if TYPE_CHECKING:
    _Space = _Box

    class _EnvBase(_Env): ...

    class _VectorBase(_Env): ...
else:
    try:
        import gymnasium
        import gymnasium.vector
        from gymnasium.spaces import Box as _Space

        _EnvBase, _VectorBase = gymnasium.Env, gymnasium.vector.VectorEnv
    except ImportError:
        _Space, _EnvBase, _VectorBase = _Box, _Env, _Env

#: The set-points of an action are from -LARGEST_ANGLE to LARGEST_ANGLE degrees; the limits of a joint cut them, too.
LARGEST_ANGLE = 90.0


def _spaces(worlds: Worlds, n: int | None) -> tuple[_Space, _Space]:
    """Of observations and actions; n: a row for each world."""
    bounds = {"contact_rear": (0.0, 1.0), "contact_front": (0.0, 1.0), "qw": (-1.0, 1.0), "qx": (-1.0, 1.0), "qy": (-1.0, 1.0),
              "qz": (-1.0, 1.0), "current_mA": (0.0, np.inf)}
    low, high = np.transpose([bounds.get(name.split(".")[0], (-np.inf, np.inf)) for name in worlds.observation_names])
    # An orientation is a unit quaternion up to rounding.
    slack = np.where(np.isfinite(low) & (low < 0), 1e-6, 0.0)
    low, high = low - slack, high + slack
    angle = np.full(len(worlds.joints), LARGEST_ANGLE)
    if n is not None:
        low, high, angle = (np.tile(row, (n, 1)) for row in (low, high, angle))
    return _Space(low, high, dtype=np.float64), _Space(-angle, angle, dtype=np.float32)


class _Episodes(_Chance):
    """Seeds of episodes, and what reset() and step() check."""

    def __init__(self, worlds: Worlds) -> None:
        self.worlds = worlds
        self._seed(None)
        self.goes_on = False

    def reset(self, seed: int | None, options: Mapping[str, Any] | None) -> NDArray[np.float64]:
        if options is not None and not isinstance(options, Mapping):
            raise _core.InputError(f'options: found {options!r}, expected a dict such as {{"setpoints": angles}}')
        given = dict(options or {})
        setpoints = given.pop("setpoints", None)
        mask = given.pop("reset_mask", None)
        if given:
            raise _core.InputError(f'options: found {list(given)}, expected none but "setpoints"')
        if mask is not None and not np.all(mask):
            raise _core.InputError("reset_mask: found worlds that go on, expected all of them: they begin together")
        if seed is not None:
            if whole("seed", seed) < 0:
                raise _core.InputError(f"seed: found {seed!r}, expected a whole number from 0")
            self._seed(int(seed))
        self._renew()
        observation = self.worlds.reset(int(self._chance.integers(2**62)), setpoints)
        self.goes_on = True
        return observation

    def step(self, action: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_], list[str]]:
        if not self.goes_on:
            raise _core.InputError("step: found no episode, expected reset() first, and after the end of each episode")
        observation, reward, done, info = self.worlds.step(action)
        self.goes_on = not done.all()
        return observation, reward, done, info.get("failures", [""] * self.worlds.n)


class Env(Unique, _EnvBase):
    """One robot in a world, whose set-points an agent gives at every tick.

        env = proleg.gym.Env("caterpillar", seconds=10)
        observation, info = env.reset(seed=1)
        while True:
            observation, reward, terminated, truncated, info = env.step(policy(observation))
            if terminated or truncated:
                break

    Observation, action and reward are those of Worlds: `observation_names` has the columns; an action is a set-point for each joint,
    degrees from -90 to 90; the reward is m forward in the tick. An episode is truncated after its seconds, and terminated if the
    simulation fails. After that, step() raises InputError until reset().
    """

    def __init__(self, scenario: Scenario | str | os.PathLike[str], *, seconds: float | None = None,
                 engine: str | None = "reduced") -> None:
        """scenario, seconds, engine: as for Worlds."""
        self._episodes = _Episodes(Worlds(scenario, 1, seconds=seconds, engine=engine))
        self.observation_space, self.action_space = _spaces(self._episodes.worlds, None)

    @property
    def observation_names(self) -> Sequence[str]:
        """What the numbers of an observation are, as for Worlds."""
        return self._episodes.worlds.observation_names

    def reset(self, *, seed: int | None = None,
              options: Mapping[str, Any] | None = None) -> tuple[NDArray[np.float64], dict[str, Any]]:
        """Begins an episode. seed: of this episode and those that follow without one; equal seeds give equal episodes.
        options: {"setpoints": (joints) degrees from which the robot begins}."""
        return self._episodes.reset(seed, options)[0], {}

    def step(self, action: ArrayLike) -> tuple[NDArray[np.float64], float, bool, bool, dict[str, Any]]:
        """A tick. action: (joints) degrees. info: {"failure": why the simulation failed} if it did."""
        observation, reward, done, failures = self._episodes.step(action)
        failed = bool(done[0] and failures[0])
        return (observation[0], float(reward[0]), failed, bool(done[0]) and not failed,
                {"failure": failures[0]} if failed else {})


class VectorEnv(Unique, _VectorBase):
    """Many robots, each in its own world, which make their steps together. All begin with reset(): Gymnasium's
    AutoresetMode.DISABLED. A world that has ended stays as it is, with the reward 0.

    num_envs: worlds. Otherwise as Env, with a row for each world.
    """

    metadata: dict[str, Any] = {"render_modes": [], "autoreset_mode": "Disabled"}

    def __init__(self, scenario: Scenario | str | os.PathLike[str], num_envs: int, *, seconds: float | None = None,
                 engine: str | None = "reduced") -> None:
        worlds = Worlds(scenario, num_envs, seconds=seconds, engine=engine)
        if _VectorBase is not _Env:
            from gymnasium.vector import AutoresetMode  # type: ignore[import]

            self.metadata = {**self.metadata, "autoreset_mode": AutoresetMode.DISABLED}
        self._episodes = _Episodes(worlds)
        self.num_envs = worlds.n
        self.single_observation_space, self.single_action_space = _spaces(worlds, None)
        self.observation_space, self.action_space = _spaces(worlds, worlds.n)

    @property
    def observation_names(self) -> Sequence[str]:
        """Columns of an observation, as for Worlds."""
        return self._episodes.worlds.observation_names

    def reset(self, *, seed: int | None = None,
              options: Mapping[str, Any] | None = None) -> tuple[NDArray[np.float64], dict[str, Any]]:
        """Begins an episode of all worlds; as Env.reset()."""
        return self._episodes.reset(seed, options), {}

    def step(self, actions: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_],
                                               dict[str, Any]]:
        """A tick of all worlds. actions: (num_envs, joints) degrees. info: {"failure": by world why it failed, or ""} in a tick in which
        one has ended."""
        observation, reward, done, failures = self._episodes.step(actions)
        failed = np.array([bool(failure) for failure in failures])
        return observation, reward, done & failed, done & ~failed, {"failure": failures} if done.any() else {}

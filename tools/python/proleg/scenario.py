"""Scenarios: a robot, its gait and its world."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from proleg import _core
from proleg._checks import array, number, path, text, whole
from proleg._places import shipped_folder

Name = Union[str, "tuple[str, str]"]


@dataclass(frozen=True)
class Parameter:
    """What can be set in a scenario, as its algorithm declares it."""

    name: str
    module: str  #: the algorithm that has it
    position: int  #: of the algorithm in the actuation file, from 1
    unit: str  #: "deg", "Hz"; empty for a ratio or a count
    minimum: float
    maximum: float
    default: float
    help: str


def _setting_name(key: Name) -> str:
    if isinstance(key, str):
        return text("name", key)
    if isinstance(key, tuple) and len(key) == 2 and all(isinstance(part, str) for part in key):
        return text("name", f"{key[0]}:{key[1]}")
    raise _core.InputError(f'found {key!r}, expected the name of a parameter such as "amplitude", or a name and a joint '
                           'such as "amplitude", "J3"')


class _Later:
    """A time of a run, at which parameters change."""

    def __init__(self, scenario: Scenario, seconds: float) -> None:
        self._scenario = scenario
        self._seconds = number("at", seconds)

    def __setitem__(self, key: Name, value: ArrayLike) -> None:
        self._scenario._set(key, value, self._seconds)


class Scenario(Mapping[str, "NDArray[np.float64]"]):
    """A robot, its gait and its world, read from files and checked.

    It is also the values of its parameters: ``scenario["amplitude"]`` are those of all joints, from the head, and
    ``scenario["amplitude", "J3"]`` is the one of a joint. A value that is set is rounded to the nearest fixed-point number
    of the core, as that of a file is. Where two algorithms have a parameter of one name, ``"2.amplitude"`` names the one
    of the second algorithm, as `--set` does.

    Copies (`copy()`, `copy.copy`, pickle) have the changes, too. A run takes a copy when it begins, so changes during a
    run have no effect on it.
    """

    __slots__ = ("_state",)
    _state: _core.Scenario

    def __init__(self, file: str | os.PathLike[str], *, engine: str | None = None, seed: int | None = None,
                 friction: float | None = None, at: Sequence[float] | None = None, heading: float | None = None) -> None:
        """Reads a scenario.

        file: a ``*.simulation.xml`` file, or the name of a shipped scenario (`shipped()`).
        engine: "ode", "reduced" or "mujoco" instead of the engine of the environment.
        seed: of the run, 0 to 2^64 - 1. friction: coefficient of every object of the environment.
        at: (x, y) or (x, y, z) of the start, m. heading: turns the start pose about the vertical, to the left, degrees.

        Raises InputError, with file and line, for what cannot be read.
        """
        self._state = _core.Scenario(_core.shipped_file(path("file", file), shipped_folder()),
                                    _overrides(engine, seed, friction, at, heading))

    @classmethod
    def _of(cls, core: _core.Scenario) -> Scenario:
        scenario = cls.__new__(cls)
        scenario._state = core
        return scenario

    # The values of the parameters.

    @overload
    def __getitem__(self, key: str) -> NDArray[np.float64]: ...

    @overload
    def __getitem__(self, key: tuple[str, str]) -> float: ...

    def __getitem__(self, key: Name) -> NDArray[np.float64] | float:
        joints, values = self._state.values(_setting_name(key))
        return values[0] if isinstance(key, tuple) else np.array(values)

    def __setitem__(self, key: Name, value: ArrayLike) -> None:
        self._set(key, value, None)

    def __contains__(self, key: object) -> bool:
        try:
            self._state.values(_setting_name(key))  # type: ignore[arg-type]
        except _core.InputError:
            return False
        return True

    def get(self, key: Any, default: Any = None) -> Any:
        """As self[key]; the default if there is no such parameter."""
        return self[key] if key in self else default

    def __iter__(self) -> Iterator[str]:
        """The names of the parameters; "2.amplitude" where several algorithms have one of that name."""
        names = [parameter.name for parameter in self.parameters]
        for parameter in self.parameters:
            yield parameter.name if names.count(parameter.name) == 1 else f"{parameter.position}.{parameter.name}"

    def __len__(self) -> int:
        return len(self._state.parameters)

    def _set(self, key: Name, value: ArrayLike, time: float | None) -> None:
        name = _setting_name(key)
        try:
            is_number = np.shape(value) == ()
        except (TypeError, ValueError):  # rows of different lengths
            is_number = False
        if is_number:
            self._state.set(name, number(name, value), time)
            return
        joints, _ = self._state.values(name)
        expected = f"a number, or an array of shape {(len(joints),)}: one for each joint, from the head"
        values = array(name, value, expected)
        if values.shape != (len(joints),) or ":" in name:
            raise _core.InputError(f"{name}: found an array of shape {values.shape}, expected {expected}")
        changed = self._state.copy()
        for joint, one in zip(joints, values):
            changed.set(f"{name}:{joint}", float(one), time)
        self._state = changed  # all, or none if one of them cannot be used

    def at(self, seconds: float) -> _Later:
        """The parameters at a time of the run: ``scenario.at(5.0)["frequency"] = 0.5`` changes one while the robot moves.

        seconds: after the start; the change takes effect at the tick that begins then, or next.
        """
        return _Later(self, seconds)

    def move(self, at: float, x: float, y: float, z: float, turn: float = 0.0) -> None:
        """Puts the robot elsewhere during the run, as a hand does it.

        at: s after the start. x, y, z: m, where the frame of the head comes. turn: degrees about the vertical, to the left.
        """
        where = ",".join(_word(name, value) for name, value in (("x", x), ("y", y), ("z", z), ("turn", turn)))
        self._state.move(f"{where}@{_word('at', at)}s")

    # What the files say.

    @property
    def parameters(self) -> list[Parameter]:
        """All parameters, with units and ranges."""
        return [Parameter(name, module, position, unit, minimum, maximum, default, help_text)
                for position, module, name, unit, minimum, maximum, default, help_text in self._state.parameters]

    @property
    def file(self) -> str:
        """The top-level file."""
        return self._state.path

    @property
    def files(self) -> dict[str, str]:
        """All files that were read, and their texts; the top-level file first."""
        return dict(self._state.files)

    @property
    def joints(self) -> list[str]:
        """Names of the joints, from the head. Arrays of a run have this order."""
        return self._state.joints

    @property
    def links(self) -> list[str]:
        """Names of the links, from the head."""
        return self._state.links

    @property
    def tick(self) -> float:
        """Seconds from one computation of the gait to the next."""
        return self._state.tick

    @property
    def warnings(self) -> list[str]:
        """What is valid in the files and probably not meant."""
        return self._state.warnings

    @property
    def duration(self) -> float:
        """Length of a run in s, 0.01 to 86400."""
        return self._state.duration

    @duration.setter
    def duration(self, seconds: float) -> None:
        self._state.set_duration(number("duration", seconds))

    @property
    def engine(self) -> str:
        """What computes the motion: "ode", "reduced" or "mujoco"."""
        return self._state.engine

    @engine.setter
    def engine(self, engine: str) -> None:
        self._override(engine=engine)

    @property
    def seed(self) -> int:
        """Of the random numbers of a run."""
        return self._state.seed

    @seed.setter
    def seed(self, seed: int) -> None:
        self._override(seed=seed)

    def replace(self, *, engine: str | None = None, seed: int | None = None, friction: float | None = None,
                at: Sequence[float] | None = None, heading: float | None = None, seconds: float | None = None) -> Scenario:
        """A copy with other values, as the options of `proleg simulate` give them; None keeps what is there."""
        other = self.copy()
        overrides = _overrides(engine, seed, friction, at, heading)
        if overrides:
            other._state = other._state.with_overrides({**other._state.overrides, **overrides})
        if seconds is not None:
            other.duration = seconds
        return other

    def _override(self, **values: Any) -> None:
        self._state = self.replace(**values)._state

    def save(self, file: str | os.PathLike[str], *, replace: bool = False) -> str:
        """Writes the scenario for the command line, the page and the robot, and returns the path of its top-level file.

        file: NAME.simulation.xml. Beside it come NAME.actuation.xml with the values of the parameters, and NAME.files with
        copies of the robot and the world. replace: whether it may replace an earlier one.

        Raises InputError for what files cannot say (at(), move(), another friction, place or heading), and FileError.
        """
        return self._state.save(path("file", file), bool(replace))

    def copy(self) -> Scenario:
        return Scenario._of(self._state.copy())

    def __copy__(self) -> Scenario:
        return self.copy()

    def __deepcopy__(self, memo: object) -> Scenario:
        return self.copy()

    def __reduce__(self) -> tuple[object, tuple[_core.Scenario]]:
        return Scenario._of, (self._state,)

    __hash__ = None  # type: ignore[assignment]
    __eq__ = object.__eq__

    def __repr__(self) -> str:
        return f"<proleg.Scenario {self.file}: {len(self.joints)} joints, {self.engine}, {self.duration:g} s>"


def _word(name: str, value: float) -> str:
    return repr(number(name, value))


def _overrides(engine: str | None, seed: int | None, friction: float | None, at: Sequence[float] | None,
               heading: float | None) -> dict[str, str]:
    words = {}
    if engine is not None:
        words["engine"] = text("engine", engine)
    if seed is not None:
        words["seed"] = str(whole("seed", seed))
    if friction is not None:
        words["friction"] = _word("friction", friction)
    if at is not None:
        words["at"] = ",".join(_word("at", part) for part in _coordinates(at))
    if heading is not None:
        words["heading"] = _word("heading", heading)
    return words


def _coordinates(at: object) -> Iterable[float]:
    if isinstance(at, Iterable) and not isinstance(at, (str, bytes, Set)) and getattr(at, "ndim", 1) > 0:
        return at
    raise _core.InputError(f"at: found {at!r}, expected (x, y) or (x, y, z)")


def caterpillar(joints: int = 5, axes: str | None = None) -> Scenario:
    """A caterpillar of joint modules with a travelling wave, on a flat floor.

    joints: 1 to 64. axes: "p" for a pitch joint and "y" for a yaw joint, repeated along the chain from the tail.
    """
    return _new("caterpillar", joints, axes)


def snake(joints: int = 8, axes: str | None = None) -> Scenario:
    """A snake whose joints bend up and down and to the sides in turn; joints, axes: as for caterpillar()."""
    return _new("snake", joints, axes)


def _new(kind: str, joints: int, axes: str | None) -> Scenario:
    count = whole("joints", joints)
    if not 1 <= count <= 64:
        raise _core.InputError(f"joints: found {count}, expected 1 to 64")
    return Scenario._of(_core.make(kind, count, None if axes is None else text("axes", axes)))


def shipped() -> Sequence[str]:
    """Names of the scenarios that ship with Proleg, for Scenario()."""
    return _core.shipped_names

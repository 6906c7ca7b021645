"""A robot of modules, driven as `proleg drive` does."""

from __future__ import annotations

import os
import warnings
import weakref
from dataclasses import dataclass, field
from types import TracebackType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from proleg import _core, _robot
from proleg._checks import Unique, number, path, text
from proleg._places import bus_program
from proleg.run import _scenario
from proleg.scenario import Name, Scenario, _setting_name

if _program := bus_program():
    _robot.use_programs_of(os.path.dirname(_program))


class Module(NamedTuple):
    """A joint module on a bus."""

    node: int  #: its node id
    serial: int
    joint: int | None  #: from 0; None if it has no place in a robot yet
    name: str
    drive: str  #: state of its servo, such as "no power"
    software: str


@dataclass(frozen=True, eq=False)
class Motion:
    """What a robot did in a run(). Arrays have a row for each tick; joints count from the head."""

    times: NDArray[np.float64] = field(repr=False)  #: (ticks,) s after the start of the gait: the end of each tick
    raw_setpoints: NDArray[np.int32] = field(repr=False)  #: (ticks, joints) 90 degrees = 2^30
    angles: NDArray[np.float64] = field(repr=False)  #: (ticks, joints) degrees that the modules measured; nan: none
    currents: NDArray[np.float64] = field(repr=False)  #: (ticks, joints) mA that the modules measured; nan: none
    setpoint_hash: str  #: of all ticks from the start of the gait to the last of these: that of simulate() for this time
    differences: int  #: state frames, since the start, that differ from the gait of this computer; 0 is right
    missing: int  #: state frames, since the start, that this computer did not receive

    @property
    def setpoints(self) -> NDArray[np.float64]:
        """(ticks, joints) degrees that the gait asks for."""
        return self.raw_setpoints * (90.0 / 2**30)


class Robot(Unique):
    """A robot of modules on a bus, which moves as its scenario says.

        with proleg.Robot("can0", "gait.simulation.xml") as robot:
            print(robot.modules)
            first = robot.run(5)
            robot["amplitude"] = 20
            then = robot.run(5)

    It does what `proleg drive` does, with the same checks and messages. The first run() sets the modules up, gives the servos
    power and starts the gait. From then on the robot moves, also between two calls; but not longer than `idle` seconds, so that a
    program that hangs leaves no robot moving. At the end of the block the joints ramp down and the
    servos lose their power: after an exception, Ctrl-C and the end of Python, too. A process that is killed sends nothing
    more: modules without a host stop by themselves within 1.5 s, and hold their joints (docs/safety.md).

    It belongs to one thread at a time, and to the process that opened it: a child of fork() cannot use it. Only stop() may come from
    another thread at any moment; a run() of the first one then raises RunError.
    """

    def __init__(self, bus: str | None, scenario: Scenario | str | os.PathLike[str], *,
                 record: str | os.PathLike[str] | None = None, idle: float | None = 0.4) -> None:
        """Opens the bus; nothing is sent and nothing moves.

        bus: as `--bus` of `proleg drive`: "can0", "serial:/dev/ttyACM0", "tcp:HOST:PORT", "sim:FILE" for simulated modules,
        and others; None: $PROLEG_BUS, or the only adapter with modules behind it. scenario: as in simulate(); its changes (`at()`) are made, its place in the world has no effect.
        record: a file into which a recording is written.
        idle: s, 0.1 to 3600: how long the robot moves on after the end of a run() or another call. Then it stops as at the end of the
        block, and the next call raises RunError. None: without limit.

        Raises InputError for a scenario or an address that cannot be used, and RunError for a bus that cannot be opened.
        """
        limit = None if idle is None else number("idle", idle)
        if limit is not None and not 0.1 <= limit <= 3600:
            raise _core.InputError(f"idle: found {limit}, expected 0.1 to 3600 seconds, or None")
        self._scenario = _scenario(scenario).copy()
        self._robot = _robot.Robot(None if bus is None else text("bus", bus), self._scenario._state,
                             None if record is None else path("record", record), limit)
        self._modules: list[Module] | None = None
        self._end = weakref.finalize(self, self._robot.stop)  # also at the end of Python

    @property
    def modules(self) -> list[Module]:
        """The joint modules on the bus, by node id. They are looked for once, before run(); that takes a second."""
        if self._modules is None:
            self._modules = [Module(*module) for module in self._robot.modules()]
        return list(self._modules)

    def run(self, seconds: float) -> Motion:
        """Lets the robot move, and returns what it did.

        seconds: 0.01 to 3600, from the end of the last run() on, or from the start of the gait. The robot moves on between two calls, so
        a late call returns sooner; no tick is left out.

        What modules report, such as a restart, becomes a Python warning. Raises InputError if the robot of the scenario cannot be driven;
        RunError, with the line of `proleg drive`, if it does not start, if a joint does not follow any more, or if the bus
        is lost: the robot has stopped then.
        """
        wanted = number("seconds", seconds)
        if not 0.01 <= wanted <= 3600:
            raise _core.InputError(f"seconds: found {wanted}, expected 0.01 to 3600")
        try:
            result = self._robot.run(round(wanted / self._scenario.tick))
        finally:
            self._warn()
        first = result.pop("first_tick")
        ticks = len(result["setpoints"])
        return Motion(np.arange(first + 1, first + ticks + 1) * self._scenario.tick, raw_setpoints=result.pop("setpoints"), **result)

    def __setitem__(self, key: Name, value: float) -> None:
        """Changes a parameter, as ``robot["amplitude"] = 20`` or ``robot["amplitude", "J3"] = 20``: as soon as all modules
        have the value. Before the first run() it changes the start value. Raises InputError as Scenario does."""
        name = _setting_name(key)
        checked = self._scenario.copy()
        checked[key] = number(name, value)
        self._robot.change(f"{name}={number(name, value)!r}")
        self._scenario = checked

    def __getitem__(self, key: Name) -> NDArray[np.float64] | float:
        """The value that was set last, as in a Scenario."""
        return self._scenario[key]

    @property
    def joints(self) -> list[str]:
        """Names of the joints, from the head: the columns of a motion."""
        return self._scenario.joints

    def stop(self) -> None:
        """Ramps the joints down, takes the power from the servos and closes the bus. It may be called again.

        Ctrl-C does not break it off. It takes a second; up to twenty if modules do not answer. Raises RunError if a module has not
        confirmed that its servo has no power.
        """
        try:
            self._end()
        finally:
            self._warn()

    def _warn(self) -> None:
        for line in self._robot.reports():
            warnings.warn(line, stacklevel=3)

    def __enter__(self) -> Robot:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.stop()

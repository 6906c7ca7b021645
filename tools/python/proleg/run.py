"""A run of a scenario, and what it gives."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from proleg import _core
from proleg._checks import path, text, texts
from proleg.player import Shown, temporary_recording
from proleg.scenario import Scenario

#: Names of the series that a run can keep, for `keep`.
SERIES: tuple[str, ...] = _core.series_names


class Measure(NamedTuple):
    """What rates a run (docs/gait-measures.md)."""

    name: str
    unit: str  #: empty if it has none
    higher_is_better: bool
    help: str


#: All measures by name.
MEASURES: Mapping[str, Measure] = {measure[0]: Measure(*measure) for measure in _core.measures}


@dataclass(frozen=True, eq=False)
class Run(Shown):
    """The result of simulate(). Arrays have a row for each tick; joints and links count from the head.

    A series that was not kept is an empty array of shape (0,).

    A notebook shows its measures and its picture; `player()` is the page that plays it. Both simulate the run once more, with
    the same bits, because a run keeps no recording.
    """

    scenario: Scenario = field(repr=False)  #: as it was when the run began
    displacement: float  #: m, horizontal distance of the centre of mass from its start
    duration: float  #: s
    measures: Mapping[str, float] = field(repr=False)  #: by name, nan if the run does not define one; see MEASURES
    setpoint_hash: str  #: equal for equal set-points: the command line, virtual modules and robots print the same
    servo_hash: str  #: of all servo pulses
    world_hash: str | None  #: of the motion; None if the engine does not give the same on every computer
    motion_hash: str  #: of all poses of the world, with every engine: equal for the same program on the same processor
    lost_frames: int = field(repr=False)
    clipped_ticks: list[int] = field(repr=False)  #: by joint: ticks in which its limits cut the set-point
    _series: Mapping[str, NDArray[Any]] = field(repr=False)
    _losses: str | None = field(repr=False)

    def _recording(self) -> AbstractContextManager[str]:
        def write(file: str) -> None:
            again = _core.simulate(self.scenario._state, [], self._losses, file)
            if again["servo_hash"] != self.servo_hash or again["motion_hash"] != self.motion_hash:
                raise _core.RunError(f"{self.scenario.file}: found another motion than before, expected the same: a file of losses has "
                                     "changed, or the engine does not repeat")

        return temporary_recording(Path(self.scenario.file).name.removesuffix(".simulation.xml"), write)

    def _facts(self) -> Mapping[str, str]:
        facts = {"scenario": self.scenario.file, "engine": self.scenario.engine, "duration": f"{self.duration:g} s",
                 "displacement": f"{self.displacement:.4g} m"}
        for name in ("speed", "cost_of_transport"):
            facts[name.replace("_", " ")] = f"{self.measures[name]:.4g} {MEASURES[name].unit}"
        return {**facts, "set-points": self.setpoint_hash}

    def _of(self, name: str) -> NDArray[Any]:
        return self._series.get(name, np.empty(0))

    @property
    def times(self) -> NDArray[np.float64]:
        """(ticks,) s after the start: the end of each tick, when all other rows hold."""
        ticks = round(self.duration / self.scenario.tick)
        return np.arange(1, ticks + 1) * self.scenario.tick

    @property
    def raw_setpoints(self) -> NDArray[np.int32]:
        """(ticks, joints) set-points as the core computes them, 90 degrees = 2^30: the bits that a module computes."""
        return self._of("setpoints")

    @property
    def setpoints(self) -> NDArray[np.float64]:
        """(ticks, joints) degrees that the gait asks for."""
        return self._of("setpoints") * (90.0 / 2**30)

    @property
    def angles(self) -> NDArray[np.float64]:
        """(ticks, joints) degrees that the joints have."""
        return self._of("angles")

    @property
    def torques(self) -> NDArray[np.float64]:
        """(ticks, joints) Nm of the motors, means over the tick."""
        return self._of("torques")

    @property
    def currents(self) -> NDArray[np.float64]:
        """(ticks, joints) mA of the servos, an estimate, means over the tick."""
        return self._of("currents")

    @property
    def contacts(self) -> NDArray[np.uint8]:
        """(ticks, links) touch sensors that the gait got: bit 0 the rear one, bit 1 the front one."""
        return self._of("contacts")

    @property
    def contact_forces(self) -> NDArray[np.float64]:
        """(ticks, links) N, normal forces, means over the tick."""
        return self._of("contact_forces")

    @property
    def positions(self) -> NDArray[np.float64]:
        """(ticks, links, 3) m, of the frames of the links in the world."""
        return self._of("positions")

    @property
    def orientations(self) -> NDArray[np.float64]:
        """(ticks, links, 4) of the links in the world, as quaternions w, x, y, z."""
        return self._of("orientations")


def simulate(scenario: Scenario | str | os.PathLike[str], seconds: float | None = None, *, engine: str | None = None,
             seed: int | None = None, keep: Iterable[str] = SERIES, losses: str | None = None,
             record: str | os.PathLike[str] | None = None) -> Run:
    """Runs a scenario in the physics simulation, as `proleg simulate` does: numbers and hashes are the same to the last bit.

    scenario: one that was made before, or what Scenario() takes. seconds: length of the run, 0.01 to 86400; by default
    that of the scenario. engine, seed: instead of those of the scenario. keep: names of the series to keep, of SERIES.
    losses: state frames that joints do not receive, "SEED:RATE", or a file (`--losses`). record: a file into which a
    recording is written, too; it replaces an earlier recording and no other file.

    Other Python threads run meanwhile; Ctrl-C ends the run. Raises InputError, RunError if the simulation fails, and
    FileError if the recording cannot be written.
    """
    start = _scenario(scenario).replace(engine=engine, seed=seed, seconds=seconds)
    lost = None if losses is None else text("losses", losses)
    result = _core.simulate(start._state, texts("keep", keep), lost, None if record is None else path("record", record))
    series = result.pop("series")
    for numbers in series.values():
        numbers.flags.writeable = False
    return Run(scenario=start, _series=series, _losses=lost, **result)


def _scenario(given: object) -> Scenario:
    if isinstance(given, Scenario):
        return given
    if isinstance(given, (str, os.PathLike)):
        return Scenario(given)
    raise _core.InputError(f"scenario: found {type(given).__name__}, expected a Scenario, a file or the name of a shipped one")

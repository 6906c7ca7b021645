"""Recordings: what a run or a robot did, in a file."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from proleg import _core
from proleg._checks import path
from proleg.player import Shown

if TYPE_CHECKING:
    import pandas  # type: ignore[import]


@dataclass(frozen=True, eq=False)
class Recording(Shown):
    """A recording as it was when it was opened (docs/recordings.md).

    A notebook shows its results and its picture; `player()` is the page that plays it. Both read the file again.
    """

    file: str
    finished: bool  #: False for a run that was interrupted, or is still running
    results: Mapping[str, str] = field(repr=False)  #: texts by name, such as "displacement_m" and "setpoint_hash"
    _table: Mapping[str, NDArray[np.float64]] = field(repr=False)

    def _recording(self) -> AbstractContextManager[str]:
        return nullcontext(self.file)

    def _facts(self) -> Mapping[str, str]:
        return {"recording": self.file, **({} if self.finished else {"state": "interrupted, or still running"}), **self.results}

    def table(self) -> pandas.DataFrame | Mapping[str, NDArray[np.float64]]:
        """A row for each tick: a pandas table if pandas is installed, otherwise columns() ."""
        try:
            import pandas
        except ImportError:
            return self.columns()
        return pandas.DataFrame(dict(self._table))

    def columns(self) -> dict[str, NDArray[np.float64]]:
        """Arrays by the names of `proleg export`: "time_s", "angle_deg.J1", "x_m.Head" and others."""
        return dict(self._table)


def open(file: str | os.PathLike[str]) -> Recording:  # noqa: A001 - `proleg.open` is what a reader looks for
    """Reads a recording. Never changes the file. Raises InputError for a file that is none, or is damaged."""
    name = path("file", file)
    result = _core.read_recording(name)
    return Recording(name, result["finished"], dict(result["results"]), result["table"])

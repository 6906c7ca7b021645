"""Searches with the methods and the store of `proleg optimise`, whose candidates a program rates."""

from __future__ import annotations

import os
import warnings
import weakref
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from proleg import _core
from proleg._checks import Unique, array, columns, path, text, texts, whole
from proleg._search import Search as _Search
from proleg.evaluation import Scores
from proleg.scenario import Scenario

if TYPE_CHECKING:
    import pandas  # type: ignore[import]


class Dimension(NamedTuple):
    """A number that a search chooses."""

    name: str  #: as for evaluate(): "amplitude:J5", "phase_difference"
    unit: str  #: "deg", "Hz"; empty if it has none
    values: NDArray[np.float64]  #: all that it can have, ascending


class Objective(NamedTuple):
    """What a search tries to reach."""

    name: str
    unit: str  #: empty for a sum of measures, and if it has none
    higher_is_better: bool


@dataclass(frozen=True)
class Found:
    """An evaluation of a search."""

    number: int  #: from 0, in the order of the search
    values: Mapping[str, float]  #: by the names of the dimensions
    scores: Mapping[str, float]  #: by the names of the objectives

    def __hash__(self) -> int:
        return hash(self.number)


class Search(Unique):
    """A search as `proleg optimise` makes it. It asks for the scores of candidates, and a program tells them.

        search = proleg.Search("gait.optimise.xml", store="found")
        while not search.done:
            candidates = search.ask()
            search.tell(proleg.evaluate(search.scenario, search.names, candidates, search.measures))
        print(search.best)

    Candidates, scores and store are those of `proleg optimise` with the same file and seed, to the last bit. What was told is
    in the store: a search that was interrupted goes on where it was, here or with `proleg optimise --resume`, and nothing is
    rated twice. `proleg optimise --stop`, `proleg ui` and every reader of stores work with it.

    It is also a context manager. close(), the end of the object and the end of Python end it and release its store. It
    belongs to one thread at a time, and to the process that opened it: a child of fork() cannot use it.
    """

    def __init__(self, experiment: str | os.PathLike[str] | None = None, store: str | os.PathLike[str] | None = None,
                 method: str | None = None, *, simulation: str | os.PathLike[str] | None = None, engine: str | None = None,
                 trials: int | None = None, evaluations: int | None = None, seed: int | None = None,
                 at_once: int | None = None) -> None:
        """Begins a search, or continues the one whose store is in the folder.

        experiment: a ``*.optimise.xml`` file; None takes the experiment of the store. store: a folder; by default the name of
        the file up to its first dot. method: "great-deluge", "genetic", or a method of pagmo such as "cmaes", instead of that
        of the file; settings of the file that it does not have are left out. simulation, engine, trials, evaluations, seed:
        as the options of `proleg optimise`.
        at_once: candidates for which ask() asks at the same time, 1 to 4096; by default those of a generation. With more,
        ask() also asks for some that the method may turn out not to need. It changes no result.

        Raises InputError, with the line that the command line prints: for what cannot be read, a store of another experiment,
        and one that another program writes.
        """
        words = {}
        for name, file in (("file", experiment), ("store", store), ("simulation", simulation)):
            if file is not None:
                words[name] = path(name, file)
        for name, word in (("method", method), ("engine", engine)):
            if word is not None:
                words[name] = text(name, word)
        for name, number in (("trials", trials), ("evaluations", evaluations), ("seed", seed)):
            if number is not None:
                words[name] = str(whole(name, number))
        if at_once is not None and not 1 <= whole("at_once", at_once) <= 4096:
            raise _core.InputError(f"at_once: found {at_once}, expected 1 to 4096")
        self._search = _Search(words, at_once)
        self._rows = 0
        self._numbers = np.empty(0, dtype=np.int64)
        self._trials = np.empty(0, dtype=np.int64)
        self._end = weakref.finalize(self, self._search.close)  # also at the end of Python
        if self._search.remark:
            warnings.warn(self._search.remark, stacklevel=2)

    # The search.

    def ask(self, most: int | None = None) -> NDArray[np.float64]:
        """The candidates that the method needs next: (n, len(names)) values, in the units of the dimensions.

        most: at most so many rows; None for all. Empty when the search has ended. A call without tell() before it gives the
        same rows again. With several trials a candidate has a row for each of them; `trials` says which.
        """
        values, self._numbers, self._trials = self._search.ask(_count("most", most))
        self._rows = len(values)
        return values

    def tell(self, scores: ArrayLike, measures: str | Sequence[str] | None = None, *,
             failures: Sequence[str] | None = None) -> None:
        """Takes the measures of the rows of the last ask(). They are in the store when this returns.

        scores: (n, len(measures)), or (n) for one measure. measures: names of the columns; by default those that the search
        needs, `measures`. With more of them the tables and pictures of `proleg optimise` are complete. nan: the run failed or does not
        define the measure; the score is then what `<objective failed>` says, as in `proleg optimise`. failures: by row the
        reason why it failed, or ""; by default those of an array that evaluate() has returned, if its numbers and rows are unchanged.

        Raises InputError for another shape, without an ask() before it, or if the search has ended; nothing is taken then.
        FileError: the store cannot be written.
        """
        names = list(self.measures) if measures is None else columns("measures", measures)
        reasons = (scores._reasons() if isinstance(scores, Scores) else []) if failures is None else _reasons(failures)
        values = np.empty((0, 0))
        if self._rows:
            shape = (self._rows, len(names))
            expected = f"{shape} numbers: a row for each of ask()"
            values = array("scores", scores, expected)
            if values.shape not in ((shape, shape[:1]) if len(names) == 1 else (shape,)):
                raise _core.InputError(f"scores: found an array of shape {values.shape}, expected {expected}")
            reasons = reasons or [""] * self._rows
            if len(reasons) != self._rows:
                raise _core.InputError(f"failures: found {len(reasons)}, expected {self._rows}: one for each row of ask()")
            values = np.ascontiguousarray(values.reshape(shape))
        self._search.tell(values, names, reasons)
        self._rows = 0

    def simulate(self, most: int | None = None, *, workers: int | None = None) -> int:
        """Rates what ask() would give exactly as `proleg optimise` does, tells it, and returns the number of runs.

        It is ask(), evaluate() and tell() in one, and it alone knows the worlds of several trials, their random numbers, racing
        and the heading of an experiment. most: as for ask(). workers: as for evaluate(). Ctrl-C ends it, without these runs.
        """
        count = len(os.sched_getaffinity(0)) if workers is None else whole("workers", workers)
        if workers is not None and not 1 <= count <= 64:
            raise _core.InputError(f"workers: found {count}, expected 1 to 64")
        self._rows = 0
        return self._search.simulate(_count("most", most), min(count, 64))

    def close(self) -> None:
        """Ends the search; what was told stays in the store. May be called again; best and table() stay."""
        self._end()

    def __enter__(self) -> Search:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    # What it is and what it found.

    @property
    def done(self) -> bool:
        """Whether nothing more is asked for: it has ended, or was stopped or closed."""
        return self._search.done

    @property
    def ending(self) -> str | None:
        """Why it ended: "converged", "all 600 evaluations made" and others; None if it did not, or was stopped.

        `proleg optimise --resume` then writes tables, pictures and the best scenario; if the engine is not ODE, or runs
        depend on random numbers, it first rates the best again in fresh runs.
        """
        return self._search.ending

    @property
    def best(self) -> Found | None:
        """The best evaluation by the first objective; None if none has a score."""
        best = self._search.best
        return None if best is None else Found(*best)

    def table(self) -> pandas.DataFrame | dict[str, object]:
        """All evaluations: a pandas table if pandas is installed, otherwise columns by name.

        "number"; a "score NAME" for each objective; the values; all measures (nan: not told); "reused", whether an
        earlier evaluation had the result; "failure", empty or why the run failed.
        """
        columns = self._search.table()
        try:
            import pandas
        except ImportError:
            return columns
        return pandas.DataFrame(columns)

    @property
    def scenario(self) -> Scenario:
        """A copy of the scenario of which the search changes parameters."""
        return Scenario._of(self._search.scenario)

    @property
    def names(self) -> list[str]:
        """Names of the dimensions: the columns of ask()."""
        return [dimension.name for dimension in self.dimensions]

    @property
    def dimensions(self) -> list[Dimension]:
        """What the search chooses, with units and values."""
        return [Dimension(*dimension) for dimension in self._search.dimensions]

    @property
    def objectives(self) -> list[Objective]:
        """What it tries to reach; the first one decides what is best."""
        return [Objective(*objective) for objective in self._search.objectives]

    @property
    def measures(self) -> list[str]:
        """The measures that tell() needs, of which the objectives are sums; see MEASURES."""
        return self._search.measures

    @property
    def numbers(self) -> NDArray[np.int64]:
        """(n) of the rows of the last ask(): the numbers of their evaluations, from 0."""
        return self._numbers

    @property
    def trials(self) -> NDArray[np.int64]:
        """(n) of the rows of the last ask(): which trial of its candidate it is, from 0."""
        return self._trials

    @property
    def folder(self) -> str:
        """The folder with the store, for `proleg optimise --resume`."""
        return self._search.folder

    @property
    def method(self) -> str:
        """Short name of the method."""
        return self._search.method

    @property
    def seed(self) -> int:
        """Of all random numbers of the search."""
        return self._search.seed

    @property
    def evaluations(self) -> int:
        """Evaluations at most; 0: until the method ends."""
        return self._search.evaluations

    def __repr__(self) -> str:
        return f"<proleg.Search in {self.folder}: {self.method}, {len(self.dimensions)} dimensions>"


def _reasons(failures: Sequence[str]) -> list[str]:
    if isinstance(failures, Set):
        raise _core.InputError(f"failures: found a {type(failures).__name__}, expected texts in an order")
    return texts("failures", failures)


def _count(name: str, value: int | None) -> int:
    if value is None:
        return 2**31
    if whole(name, value) < 1:
        raise _core.InputError(f"{name}: found {value}, expected at least 1")
    return min(int(value), 2**31)

"""Many candidates of one scenario."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from proleg import _core
from proleg._checks import array, columns, whole
from proleg.run import _scenario
from proleg.scenario import Scenario


class Scores(np.ndarray[Any, np.dtype[np.float64]]):
    """An array of scores; `failures` says why candidates have none.

    failures: for each candidate the reason why its simulation failed; empty if it did not. Rows that are chosen with an index
    (a slice, a mask, numbers of rows) and copies have their own reasons; what is computed of scores is a plain array or a
    number. After sort() and the like there are none: [].
    """

    _failures: list[str]
    _rated: NDArray[np.float64] | None  #: the numbers to which the reasons belong

    def __array_finalize__(self, other: object) -> None:
        self._failures, self._rated = [], None

    def __array_wrap__(self, array: NDArray[Any], context: object = None) -> Any:
        return self if array is self else np.asarray(array)[()]

    @property
    def failures(self) -> list[str]:
        return self._failures

    @failures.setter
    def failures(self, reasons: Sequence[str]) -> None:
        self._failures, self._rated = list(reasons), np.array(self)

    def _rows(self, index: Any, part: Any) -> Any:
        """The part that an index has chosen, with the reasons of its rows."""
        if isinstance(part, Scores) and part.ndim > 0 and self._rated is not None and len(self._failures) == len(self):
            rows = np.broadcast_to(np.arange(len(self)).reshape(-1, *[1] * (self.ndim - 1)), self.shape)[index]
            rows = rows.reshape(len(rows), -1) if rows.size > 0 else np.empty((0, 1))
            if (rows == rows[:, :1]).all():
                part._failures, part._rated = [self._failures[row] for row in rows[:, 0]], self._rated[index]
        return part

    def __getitem__(self, index: Any) -> Any:
        return self._rows(index, super().__getitem__(index))

    def __setitem__(self, index: Any, value: Any) -> None:
        super().__setitem__(index, value)
        if not np.isscalar(value):  # rows of others
            self.__array_finalize__(None)

    def copy(self, order: Any = "C") -> Scores:
        return self._rows(..., super().copy(order))

    def __copy__(self) -> Scores:
        return self.copy()

    def __deepcopy__(self, memo: object) -> Scores:
        return self.copy()

    def sort(self, *arguments: Any, **options: Any) -> None:
        self.__array_finalize__(None)
        super().sort(*arguments, **options)

    def partition(self, *arguments: Any, **options: Any) -> None:
        self.__array_finalize__(None)
        super().partition(*arguments, **options)

    def __reduce__(self) -> Any:
        make, arguments, state = super().__reduce__()  # type: ignore[misc]
        return make, arguments, (state, self._failures, self._rated)

    def __setstate__(self, state: Any) -> None:
        array, self._failures, self._rated = state
        super().__setstate__(array)  # type: ignore[misc]

    def _reasons(self) -> list[str]:
        """Those of evaluate(); none if rows have other numbers since."""
        is_same = self._rated is not None and np.array_equal(self, self._rated, equal_nan=True)
        return self._failures if is_same else []


def evaluate(scenario: Scenario | str | os.PathLike[str], names: Sequence[str], candidates: ArrayLike,
             measure: str | Sequence[str] = "distance", *, workers: int | None = None, seconds: float | None = None,
             engine: str | None = None, seed: int | None = None) -> NDArray[np.float64]:
    """Simulates candidates: each has its own values of some parameters, and is a run of its own.

    names: (d) parameters in an order, each once, such as "amplitude" or "amplitude:J1". candidates: (n, d) values, in the units of the
    parameters. measure: a name of MEASURES, or several. workers: cores that compute, 1 to 64; by default all.
    seconds, engine, seed: as in simulate().

    Returns (n,) scores; (n, m) for several measures. nan: the simulation failed, or the run does not define the measure;
    the attribute `failures` of the array has the reasons of the former. Each score is the one that simulate() gives, to
    the last bit, whatever the number of workers is. The reduced engine computes up to 64 candidates together, which is
    fastest; ODE with its iterative solver (more than 8 links) uses one core at a time.

    Ctrl-C ends it. Raises InputError, for example for a value that its parameter does not take, before anything is
    simulated.
    """
    start = _scenario(scenario).replace(engine=engine, seed=seed, seconds=seconds)
    names = columns("names", names)
    if not names:
        raise _core.InputError("names: found none, expected at least one parameter")
    values = _candidates(candidates, len(names))
    several = not isinstance(measure, str)
    measures = columns("measure", measure)
    if not measures:
        raise _core.InputError("measure: found none, expected at least one")
    count = len(os.sched_getaffinity(0)) if workers is None else whole("workers", workers)
    if workers is not None and not 1 <= count <= 64:
        raise _core.InputError(f"workers: found {count}, expected 1 to 64")
    scores, failures = _core.evaluate(start._state, names, values, measures, min(count, 64))
    result = (scores if several else scores[:, 0]).view(Scores)
    result.failures = failures
    return result


def _candidates(given: ArrayLike, count: int) -> NDArray[np.float64]:
    values = array("candidates", given, f"(n, {count}) numbers")
    if values.size == 0 and values.ndim <= 2:
        values = np.empty((0, count))
    if values.ndim != 2 or values.shape[1] != count:
        raise _core.InputError(f"candidates: found an array of shape {values.shape}, expected (n, {count}) numbers")
    return np.ascontiguousarray(values)

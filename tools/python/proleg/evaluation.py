"""Many candidates of one scenario."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from proleg import _core
from proleg._checks import texts, whole
from proleg.run import _scenario
from proleg.scenario import Scenario


class Scores(np.ndarray[Any, np.dtype[np.float64]]):
    """An array of scores; `failures` says why candidates have none.

    failures: for each candidate the reason why its simulation failed; empty if it did not.
    """

    failures: list[str]

    def __array_finalize__(self, other: object) -> None:
        self.failures = getattr(other, "failures", [])


def evaluate(scenario: Scenario | str | os.PathLike[str], names: Sequence[str], candidates: ArrayLike,
             measure: str | Sequence[str] = "distance", *, workers: int | None = None, seconds: float | None = None,
             engine: str | None = None, seed: int | None = None) -> NDArray[np.float64]:
    """Simulates candidates: each has its own values of some parameters, and is a run of its own.

    names: (d) parameters, such as "amplitude" or "amplitude:J1". candidates: (n, d) values, in the units of the
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
    names = texts("names", names)
    if not names:
        raise _core.InputError("names: found none, expected at least one parameter")
    values = _candidates(candidates, len(names))
    several = not isinstance(measure, str)
    measures = texts("measure", measure)
    if not measures:
        raise _core.InputError("measure: found none, expected at least one")
    count = len(os.sched_getaffinity(0)) if workers is None else whole("workers", workers)
    if workers is not None and not 1 <= count <= 64:
        raise _core.InputError(f"workers: found {count}, expected 1 to 64")
    scores, failures = _core.evaluate(start._state, names, values, measures, min(count, 64))
    result = (scores if several else scores[:, 0]).view(Scores)
    result.failures = failures
    return result


def _candidates(given: ArrayLike, columns: int) -> NDArray[np.float64]:
    try:
        array = np.asarray(given)
    except (TypeError, ValueError) as error:  # rows of different lengths
        raise _core.InputError(f"candidates: found an array that numpy does not make ({error}), expected (n, {columns}) numbers") from None
    if array.size == 0 and array.ndim <= 2:
        array = np.empty((0, columns))
    if array.ndim != 2 or array.shape[1] != columns or array.dtype.kind not in "iuf":
        raise _core.InputError(f"candidates: found an array of shape {array.shape} of {array.dtype}, expected (n, {columns}) numbers")
    return np.ascontiguousarray(array, dtype=np.float64)

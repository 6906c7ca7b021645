"""The module in C++ (tools/python/module/search.cpp). Only the package calls it."""

import numpy as np
from numpy.typing import NDArray

from proleg import _core

class Search:
    done: bool
    ending: str | None
    best: tuple[int, dict[str, float], dict[str, float]] | None
    dimensions: list[tuple[str, str, NDArray[np.float64]]]
    objectives: list[tuple[str, str, bool]]
    measures: list[str]
    folder: str
    method: str
    seed: int
    evaluations: int
    remark: str
    scenario: _core.Scenario
    def __init__(self, words: dict[str, str], at_once: int | None) -> None: ...
    def ask(self, most: int) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]: ...
    def tell(self, values: NDArray[np.float64], measures: list[str], failures: list[str]) -> None: ...
    def simulate(self, most: int, workers: int) -> int: ...
    def close(self) -> None: ...
    def table(self) -> dict[str, object]: ...

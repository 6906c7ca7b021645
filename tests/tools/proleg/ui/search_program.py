"""Searches through `proleg ui`, for tests. The folders of ui_program.py and waiting.py are in sys.path."""

import contextlib
import sqlite3

from ui_program import UiProgram
from waiting import wait_until

SECONDS = 1  # of a run


class SearchProgram(UiProgram):
    """`proleg ui` whose draft runs for a second, and its searches."""

    def __init__(self, programs, folder):
        super().__init__(programs, folder)
        self.must("draft.run", name="duration", value=SECONDS)

    def searches(self):
        """The searches by their names, as they are now."""
        for _ in range(2):  # an answer may come before its document, but not before that of the operation before it
            self.must("search.refresh")
        self.viewer.until(lambda: "searches" in self.viewer.documents)
        return {search["name"]: search for search in self.document()["searches"]}

    def document(self):
        return self.viewer.documents["searches"]["value"]

    def when(self, name, is_so):
        """The search, when it is as it is waited for."""
        return wait_until(lambda: (found := self.searches().get(name)) and is_so(found) and found,
                          lambda: f"{name}: {self.searches().get(name)}")

    def refused(self, name, /, **arguments):
        result = self.ask(name, **arguments)
        assert not result["ok"], (name, arguments, result)
        assert "\n" not in result["error"], result
        return result["error"]


def experiment(**changes):
    """CMA-ES for the amplitudes of the caterpillar."""
    return {"method": "cmaEs", "settings": {"popsize": "8", "sigma0": "0.5"},
            "parameters": [{"module": 0, "parameter": "amplitude", "joints": None, "same": False, "lower": "0", "upper": "60",
                            "step": "0.5", "with_lower": True, "with_upper": True, "set": None}],
            "objectives": [{"terms": [{"measure": "distance", "weight": ""}]}], "evaluations": "40", "seed": "7", **changes}


def rows_of(folder):
    """What a search has found, without what depends on time."""
    with contextlib.closing(sqlite3.connect(f"file:{folder}/store.sqlite?mode=ro", uri=True)) as store:
        return store.execute("SELECT number, candidate, seed, distance, smoothness FROM evaluation ORDER BY number").fetchall()

"""Searches that do not begin as usual: two programs go on with one search at the same time, a start that takes minutes, a store
that cannot be used. The program of searches waits here until the gate of its search is open.

Usage: search_starts_test.py SOURCE PROGRAMS fast|slow; slow: what takes the minute after which a start is late"""

import contextlib
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE, PROGRAMS = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
sys.path[:0] = [str(SOURCE / part) for part in ("tests/host/server", "tests/tools/proleg/ui", "tests/support")]
from search_program import SearchProgram, experiment, rows_of  # noqa: E402
from ui_program import UiProgram  # noqa: E402
from waiting import wait_until  # noqa: E402

MANY = "100000"  # evaluations: such a search goes on until it is stopped


def endless(**changes):
    """Where it converges, it begins anew."""
    settings = {"popsize": "8", "sigma0": "0.5", "generations": MANY, "restartAfter": "5"}
    return experiment(settings=settings, **changes)


class Gates:
    """Programs whose searches begin when the gate of their name is open."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir()
        for name in ("proleg", "proleg-ui"):
            shutil.copy2(PROGRAMS / name, folder / name)
        script = folder / "proleg-optimise"
        script.write_text(f"""#!/bin/sh
cd '{folder}'
for word; do
  case $word in */searches/*) name=${{word##*/}} ;; esac
done
: > waiting.$name.$$
while [ -e closed.$name ]; do sleep 0.1; done
rm waiting.$name.$$
exec '{PROGRAMS}/proleg-optimise' "$@"
""")
        script.chmod(0o755)

    def close(self, name):
        (self.folder / f"closed.{name}").touch()

    def open(self, name):
        (self.folder / f"closed.{name}").unlink()

    def waiting(self, name):
        """The processes that wait."""
        return [int(path.suffix[1:]) for path in self.folder.glob(f"waiting.{name}.*")]


def ask(program, name, /, **arguments):
    """Asks, and does not wait for the answer."""
    return program.viewer.start(name, program.epoch, **arguments)


def require_whole(folder):
    with contextlib.closing(sqlite3.connect(folder / "store.sqlite")) as store:
        assert store.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    rows = rows_of(folder)
    assert [row[0] for row in rows] == list(range(len(rows))), "each evaluation once"
    return rows


def stopped(program, name):
    program.must("search.stop", name=name)
    search = program.when(name, lambda found: found["state"] == "interrupted")
    assert search["problem"] is None, search
    return search


def one_of_two_goes_on(program, gates):
    """Both have started their program before one of them has the store."""
    name = program.must("search.start", name="both", experiment=endless())["name"]
    program.when(name, lambda found: found["state"] == "ended")
    with UiProgram(gates.folder, program.folder) as other:
        gates.close("both")
        asked = [(each, ask(each, "search.resume", name=name, evaluations=MANY)) for each in (program, other)]
        wait_until(lambda: len(gates.waiting("both")) == 2, "two programs do not wait")
        gates.open("both")
        results = [each.viewer.result(number) for each, number in asked]
        assert sorted(result["ok"] for result in results) == [False, True], results
        error = next(result["error"] for result in results if not result["ok"])
        assert error == "another program has begun to continue this search", error
        other.end()
    program.when(name, lambda found: found["state"] == "running" and found["made"] > 60)
    found = stopped(program, name)
    rows = require_whole(program.folder / name)
    assert len(rows) == found["made"]
    alone = program.must("search.start", name="alone", experiment=endless(evaluations=str(len(rows))))["name"]
    program.when(alone, lambda found: found["state"] == "ended")
    assert rows_of(program.folder / alone) == rows, "it is not the search that nobody has disturbed"


def a_shell_is_faster(program, gates):
    name = "searches/both"
    gates.close("both")
    number = ask(program, "search.resume", name=name)
    wait_until(lambda: gates.waiting("both"), "no program waits")
    made = len(rows_of(program.folder / name))
    words = ["--resume", program.folder / name, "--evaluations", MANY]
    with open(program.folder / "shell.log", "w") as log:
        shell = subprocess.Popen([PROGRAMS / "proleg-optimise", *words], stdout=log, stderr=log)
        program.when(name, lambda found: found["state"] == "running" and found["made"] > made)
        gates.open("both")
        result = program.viewer.result(number)
        assert result.get("error") == "another program has begun to continue this search", result
        assert "is running" in program.refused("search.resume", name=name)
        stopped(program, name)
        shell.wait()
    require_whole(program.folder / name)


def a_refusal_is_the_problem_of_the_search(program):
    for name, state in (("searches/alone", "ended"), ("searches/both", "interrupted")):
        store = program.folder / name / "store.sqlite"

        def set_key(value):
            with contextlib.closing(sqlite3.connect(store)) as database:
                before = database.execute("SELECT value FROM experiment WHERE key = 'result_key'").fetchone()[0]
                database.execute("UPDATE experiment SET value = ? WHERE key = 'result_key'", (value,))
                database.commit()
            return before

        rows = require_whole(store.parent)
        before = set_key("other sources")
        error = program.refused("search.resume", name=name, evaluations=MANY)
        assert "was made by a program with other sources" in error, error
        search = program.when(name, lambda found: found["problem"])
        assert (search["state"], search["problem"], search["made"]) == (state, error, len(rows)), search
        assert require_whole(store.parent) == rows
        set_key(before)
        evaluations = str(len(rows) + 10)
        program.must("search.resume", name=name, evaluations=evaluations)
        search = program.when(name, lambda found: found["state"] == "ended" and found["made"] == len(rows) + 10)
        assert search["problem"] is None, search


def has_ended(process):
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(") ")[2]
    except FileNotFoundError:
        return True
    return state.startswith("Z")  # nobody has asked for its status


def a_late_search_is_stopped(program, gates):
    names = ("stopped", "goes_on", "gone")
    for name in names:
        gates.close(name)
    asked = [ask(program, "search.start", name=name, experiment=endless(evaluations=MANY)) for name in names]
    for number in asked:
        result = program.viewer.result(number)
        assert "has not begun in time" in result.get("error", ""), result
    program.must("search.stop", name="searches/stopped")
    for name in ("stopped", "goes_on"):
        gates.open(name)
    program.when("searches/stopped", lambda found: found["state"] == "interrupted")
    program.when("searches/goes_on", lambda found: found["state"] == "running" and found["made"] > 60)
    stopped(program, "searches/goes_on")

    # It does not begin any more when the program has ended that knew of the stop.
    (waiting,) = gates.waiting("gone")
    program.must("search.stop", name="searches/gone")
    program.end()
    wait_until(lambda: has_ended(waiting), "the program of the search goes on")
    assert not (program.folder / "searches/gone/store.sqlite").exists()


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "project"
        shutil.copytree(SOURCE / "sim/scenarios/travelling_wave", folder)
        gates = Gates(Path(name) / "programs")
        with SearchProgram(gates.folder, folder) as program:
            program.must("draft.save")  # the duration
            if sys.argv[3] == "slow":
                a_late_search_is_stopped(program, gates)
                return
            one_of_two_goes_on(program, gates)
            a_shell_is_faster(program, gates)
            a_refusal_is_the_problem_of_the_search(program)
            program.end()


main()

"""A folder after a week of work, through `proleg ui`: 200 searches and 2,000 recordings are listed, all of them.

Usage: week_test.py SOURCE PROGRAMS"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE, PROGRAMS = Path(sys.argv[1]), Path(sys.argv[2])
sys.path[:0] = [str(SOURCE / part) for part in ("tests/host/server", "tests/tools/proleg/ui", "tests/support")]
from search_program import SearchProgram, experiment  # noqa: E402
from waiting import wait_until  # noqa: E402

SEARCHES, RECORDINGS = 200, 2000


def searches_are_listed(program):
    first = program.must("search.start", name="wave_0", experiment=experiment(evaluations="8"))["name"]
    program.when(first, lambda found: found["state"] == "ended")
    names = {f"searches/wave_{number}" for number in range(SEARCHES)}
    for name in names - {first}:
        shutil.copytree(program.folder / first, program.folder / name)
    found = wait_until(lambda: (searches := program.searches()).keys() == names and
                       all(search["state"] == "ended" for search in searches.values()) and searches,
                       lambda: [name for name, search in program.searches().items() if search["state"] != "ended"])
    assert {(search["made"], search["best"], search["problem"]) for search in found.values()} == \
        {(8, found[first]["best"], None)}


def recordings_are_listed(program):
    first = program.folder / "day_0/run_0.proleg"
    first.parent.mkdir()
    subprocess.run([PROGRAMS / "proleg", "simulate", program.folder / "uniform.simulation.xml", "--seconds", "0.1",
                    "--record", first], check=True, stdout=subprocess.DEVNULL)
    names = {f"day_{number % 7}/run_{number}.proleg" for number in range(RECORDINGS)}
    for number in range(RECORDINGS):
        path = program.folder / f"day_{number % 7}/run_{number}.proleg"
        path.parent.mkdir(exist_ok=True)
        if path != first:
            shutil.copy(first, path)
        os.utime(path, (1_000_000 + number, 1_000_000 + number))

    def files():
        return program.must("recording.list")["files"]

    assert [file["name"] for file in files()] == \
        [f"day_{number % 7}/run_{number}.proleg" for number in reversed(range(RECORDINGS))], "the newest first"
    wait_until(lambda: all(file["described"] for file in files()),
               lambda: [file["name"] for file in files() if not file["described"]])
    listed = files()
    assert {file["name"] for file in listed} == names
    assert {(file["seconds"], file["finished"], file["problem"]) for file in listed} == {(0.1, True, None)}


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copytree(SOURCE / "sim/scenarios/travelling_wave", folder, dirs_exist_ok=True)
        with SearchProgram(PROGRAMS, folder) as program:
            searches_are_listed(program)
            recordings_are_listed(program)
            program.end()


main()

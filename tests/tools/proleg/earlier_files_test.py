#!/usr/bin/env python3
"""Files that an earlier version has written are read, and of a later one it is said in one line.

earlier_files/ has one file of each format, by its number: recording_6.proleg.gz is of version 0.2.0,
    proleg simulate sim/scenarios/travelling_wave/uniform.simulation.xml --engine reduced --seconds 0.2 --record FILE
and store_1.sqlite.gz of a search of that version,
    proleg optimise sim/scenarios/travelling_wave/cma_es.optimise.xml --engine reduced --evaluations 12 --out FOLDER
They stay as they are. A version with another format adds its own.

Usage: earlier_files_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import contextlib
import csv
import gzip
import sqlite3
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
SOURCE, PROGRAMS = (Path(argument).resolve() for argument in sys.argv[1:3])
sys.path[:0] = [str(SOURCE / part) for part in ("tests/host/server", "tests/tools/proleg/ui", "tests/support")]
from ui_program import UiProgram  # noqa: E402

FILES = Path(__file__).resolve().parent / "earlier_files"
LONGEST = 300  # s


def select(file, query):
    with contextlib.closing(sqlite3.connect(f"file:{file}?mode=ro", uri=True)) as database:
        return database.execute(query).fetchall()


class EarlierFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def unpacked(self, name, place):
        file = self.folder / place
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(gzip.decompress((FILES / name).read_bytes()))
        return file

    def proleg(self, *words):
        return subprocess.run([PROGRAMS / "proleg", *words], capture_output=True, text=True, timeout=LONGEST, cwd=self.folder)

    def test_a_recording_is_exported_as_it_was_measured(self):
        self.unpacked("recording_6.proleg.gz", "run.proleg")
        result = self.proleg("export", "run.proleg")
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.folder / "run.tsv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file, delimiter="\t"))
        samples = select(self.folder / "run.proleg", "SELECT tick, joint, setpoint_deg, angle_deg FROM sample_by_name")
        self.assertEqual((len(rows), len(samples)), (20, 100))
        for tick, joint, setpoint, angle in samples:
            self.assertAlmostEqual(float(rows[tick][f"setpoint_deg.{joint}"]), setpoint, 6)
            self.assertAlmostEqual(float(rows[tick][f"angle_deg.{joint}"]), angle, 6)

    def test_a_recording_becomes_a_page_and_a_picture(self):
        self.unpacked("recording_6.proleg.gz", "run.proleg")
        for words in (("export", "run.proleg", "--html"), ("plot", "run.proleg")):
            result = self.proleg(*words)
            self.assertEqual(result.returncode, 0, result.stderr)

    def test_a_recording_of_a_later_format_is_refused_in_one_line_and_stays_as_it_is(self):
        file = self.unpacked("recording_6.proleg.gz", "run.proleg")
        with contextlib.closing(sqlite3.connect(file)) as database:
            database.execute("PRAGMA user_version = 1000")
        before = file.read_bytes()
        for command in ("export", "plot", "replay"):
            result = self.proleg(command, "run.proleg")
            self.assertEqual((result.returncode, result.stdout), (2, ""))
            self.assertRegex(result.stderr, r"\A.*run\.proleg: found recording format 1000, of another version.*reads format \d+.*\n\Z")
        self.assertEqual(file.read_bytes(), before)

    def test_the_page_shows_a_search(self):
        file = self.unpacked("store_1.sqlite.gz", "searches/earlier/store.sqlite")
        scenario = SOURCE / "sim/scenarios/travelling_wave"
        for name in ("uniform.simulation.xml", "uniform.actuation.xml", "caterpillar.robot.xml", "flat.environment.xml"):
            (self.folder / name).write_text((scenario / name).read_text())
        (self.folder / "modules").symlink_to(scenario / "modules")
        distances = [distance for distance, in select(file, "SELECT distance FROM evaluation ORDER BY number")]
        self.assertEqual(len(distances), 12)
        with UiProgram(PROGRAMS, self.folder) as program:
            program.must("search.open", name="searches/earlier")
            rows = program.must("search.rows", name="searches/earlier", **{"from": 0})
            self.assertEqual([score for score, *_ in rows["scores"]], distances)
            program.end()

    def test_a_search_goes_on_if_this_program_computes_the_same_or_says_why_not(self):
        file = self.unpacked("store_1.sqlite.gz", "earlier/store.sqlite")
        count = "SELECT count(*) FROM evaluation"
        experiment = SOURCE / "sim/scenarios/travelling_wave/cma_es.optimise.xml"
        result = self.proleg("optimise", experiment, "--engine", "reduced", "--evaluations", "12", "--resume", "earlier")
        if result.returncode != 0:
            self.assertRegex(result.stderr, r"\A.*store\.sqlite: was made by a program with other sources, compiler or libraries .*\n\Z")
        self.assertEqual(select(file, count), [(12,)])

    def test_a_search_of_a_later_format_is_refused_in_one_line_and_stays_as_it_is(self):
        file = self.unpacked("store_1.sqlite.gz", "later/store.sqlite")
        with contextlib.closing(sqlite3.connect(file)) as database:
            database.execute("PRAGMA user_version = 1000")
        result = self.proleg("optimise", "--resume", "later")
        self.assertNotEqual(result.returncode, 0)
        self.assertRegex(result.stderr, r"\A.*store\.sqlite: has format 1000, this program reads format \d+\n\Z")
        self.assertEqual(select(file, "SELECT count(*) FROM evaluation"), [(12,)])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=1)

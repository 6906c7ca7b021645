#!/usr/bin/env python3
"""'proleg export --html' against a reader of its file that is written after docs/page-interface.md: an HTML parser, JSON,
base64 and zlib. The expected values come from the tables of the recording, read by SQLite.

The page around the recording is that of tools/page in the tests of host/page/browser; here it is a page without scripts.

Usage: export_html_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import base64
import json
import math
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib
from html.parser import HTMLParser
from pathlib import Path

LONGEST = 300  # s; the runs take some seconds on an idle computer
RAW_PER_RADIAN = 2**30 / (math.pi / 2)
PLAYER = "<!doctype html>\n<!-- A recording of Proleg -->\n<body><!-- the recording --></body>\n"
HOSTILE = ["</script><script>alert(1)</script>", "<!--<script>", "\"'&lt;]]>", "\u00e9</SCRIPT >", "J1"]


class Elements(HTMLParser):
    """The script elements of a page: attributes and text."""

    def __init__(self, text):
        super().__init__()
        self.scripts = []
        self.inside = False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        if tag == "script":
            self.inside = True
            self.scripts.append((dict(attributes), []))

    def handle_endtag(self, tag):
        if tag == "script":
            self.inside = False

    def handle_data(self, text):
        if self.inside:
            self.scripts[-1][1].append(text)


class Page:
    """A page as a reader sees it: documents, and the rows of each tick."""

    def __init__(self, path):
        self.text = path.read_text(encoding="utf-8")
        scripts = [(attributes, "".join(parts)) for attributes, parts in Elements(self.text).scripts]
        documents, blocks = scripts[0], scripts[1:]
        assert documents[0] == {"type": "application/json", "id": "documents"}, documents[0]
        self.documents = json.loads(documents[1])
        self.signals = self.documents["telemetry"]["signals"]
        self.width = sum(signal["count"] for signal in self.signals)
        self.block_sizes = []
        self.rows = []
        for attributes, text in blocks:
            assert attributes == {"type": "text/plain", "class": "ticks"}, attributes
            self.rows += self.decode(text)
        self.recording = self.documents["recording"]

    def decode(self, text):
        data = zlib.decompress(base64.b64decode(text, validate=True))
        count = len(data) // 4 // self.width
        self.block_sizes.append(count)
        columns = []
        for column in range(self.width):
            value = 0
            values = []
            for difference in struct.unpack_from(f"<{count}i", data, 4 * column * count):
                value = (value + difference + 2**31) % 2**32 - 2**31
                values.append(value)
            columns.append(values)
        return list(zip(*columns))

    def values(self, name):
        """Of all ticks: the values of a signal."""
        signal = next(signal for signal in self.signals if signal["name"] == name)
        end = signal["offset"] + signal["count"]
        return [list(row[signal["offset"]:end]) for row in self.rows]


class Tables:
    """The same values from the tables of the recording."""

    def __init__(self, path):
        self.database = sqlite3.connect(path)

    def per_tick(self, sql, *parameters):
        """Columns tick, place, value: of each tick the values in the order of places."""
        rows = {}
        for tick, _, value in self.database.execute(sql + " ORDER BY 1, 2", parameters):
            rows.setdefault(tick, []).append(value)
        return [rows[tick] for tick in sorted(rows)]

    def sample(self, column):
        return self.per_tick(f"SELECT tick, joint, {column} FROM sample")


class ExportHtml(unittest.TestCase):
    source = None
    programs = None

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        # The player lies beside the build: build/host/bin, build/player.
        cls.bin = cls.folder / "build/host/bin"
        cls.bin.mkdir(parents=True)
        shutil.copy(cls.programs / "proleg-export", cls.bin)
        cls.player = cls.folder / "build/player/player.html"
        cls.player.parent.mkdir()
        cls.player.write_text(PLAYER)
        cls.scenarios = cls.source / "sim/scenarios"
        cls.recording = cls.folder / "coupled.proleg"
        cls.simulate("travelling_wave/coupled", cls.recording, "--seconds", "42", "--set", "amplitude=30@100",
                     "--set", "1.current_phase:J2=90@4100")

    @classmethod
    def simulate(cls, scenario, recording, *more):
        file = cls.scenarios / f"{scenario}.simulation.xml" if isinstance(scenario, str) else scenario
        subprocess.run([cls.programs / "proleg-simulate", file, "--record", recording, *more], check=True,
                       capture_output=True, timeout=LONGEST)

    def export(self, recording, *more):
        return subprocess.run([self.bin / "proleg-export", recording, "--html", *more], capture_output=True, text=True,
                              timeout=LONGEST, check=False)

    def page(self, recording, *more):
        file = recording.with_suffix(".html")
        finished = self.export(recording, *more)
        self.assertEqual(finished.returncode, 0, finished.stderr)
        return Page(file)

    def refused(self, recording, words, *more):
        """Status 2, one line, no file."""
        before = sorted(self.folder.iterdir())
        finished = self.export(recording, *more)
        self.assertEqual(finished.returncode, 2, finished.stderr)
        self.assertEqual((finished.stdout, finished.stderr.count("\n")), ("", 1), finished.stderr)
        for word in words:
            self.assertIn(word, finished.stderr)
        self.assertEqual(sorted(self.folder.iterdir()), before)

    def changed_copy(self, name, sql):
        """A recording whose tables differ."""
        copy = self.folder / name
        shutil.copy(self.recording, copy)
        with sqlite3.connect(copy) as database:
            database.executescript(sql)
        database.close()
        return copy

    def test_every_column_is_that_of_the_recording(self):
        page = self.page(self.recording)
        tables = Tables(self.recording)
        self.assertEqual(page.block_sizes, [4096, 104])
        exact = {"setpoint": tables.sample("setpoint_raw"), "pulse": tables.sample("servo_command"),
                 "contact": tables.per_tick("SELECT tick, link, rear + 2 * front FROM contact")}
        names = tables.database.execute("SELECT slot, value_index, name FROM internal_value_name").fetchall()
        for slot, index, name in names:
            exact[f"{slot + 1}/{name}"] = tables.per_tick(
                "SELECT tick, joint, raw FROM internal_value WHERE slot = ? AND value_index = ?", slot, index)
        near = {"angle": tables.sample(f"angle_rad * {RAW_PER_RADIAN!r}"), "current": tables.sample("servo_current_ma"),
                "torque": tables.sample("motor_torque_nm * 1e3"),
                "force": tables.per_tick("SELECT tick, link, normal_force_n * 1e3 FROM contact")}
        head = tables.database.execute("SELECT x_m, y_m, z_m, qw, qx, qy, qz FROM pose WHERE link = 0 ORDER BY tick")
        near["head"] = [[value * (1e6 if i < 3 else 2**30) for i, value in enumerate(pose)] for pose in head]
        self.assertEqual({signal["name"] for signal in page.signals}, exact.keys() | near.keys())
        for name, expected in exact.items():
            self.assertEqual(page.values(name), expected, name)
        for name, expected in near.items():
            found = page.values(name)
            self.assertEqual(len(found), len(expected), name)
            for row, values in zip(found, expected):
                self.assertEqual(len(row), len(values), name)
                for value, wanted in zip(row, values):
                    self.assertLessEqual(abs(value - wanted), 0.5001, name)

    def test_the_documents_say_what_was_recorded(self):
        page = self.page(self.recording)
        results = dict(Tables(self.recording).database.execute("SELECT name, value FROM result"))
        self.assertEqual({result["name"]: result["value"] for result in page.recording["results"]}, results)
        self.assertEqual((page.recording["first_tick"], page.recording["last_tick"]), (0, 4199))
        self.assertTrue(page.recording["finished"] and page.recording["has_path"])
        self.assertEqual(page.recording["marks"],
                         [{"kind": "change", "tick": 100, "text": "amplitude = 30"},
                          {"kind": "change", "tick": 4100, "text": "current_phase J2 = 90"}])
        robot = page.documents["robot"]
        self.assertEqual([joint["name"] for joint in robot["joints"]], ["J5", "J4", "J3", "J2", "J1"])
        self.assertEqual((robot["kind"], [body["name"] for body in robot["terrain"]]), ("recording", ["floor"]))
        amplitude = next(value for value in page.documents["parameters"] if value["name"] == "amplitude")
        self.assertEqual([round(raw * amplitude["scale"], 6) for raw in amplitude["file"]], [40.0] * 5)

    def test_faults_and_restarts_are_marks(self):
        copy = self.changed_copy("faults.proleg", """
            INSERT INTO fault VALUES (0, 1500000, NULL, 3, 'J2 loses frames');
            INSERT INTO restart VALUES (50, 4, 'stopped'), (70, 4, 'joined');""")
        marks = [(mark["tick"], mark["kind"], mark["text"]) for mark in self.page(copy).recording["marks"]]
        self.assertEqual(marks, [(50, "restart", "J1 stopped"), (70, "restart", "J1 joined"),
                                 (100, "change", "amplitude = 30"), (150, "fault", "J2 loses frames"),
                                 (4100, "change", "current_phase J2 = 90")])

    def test_names_cannot_leave_their_element(self):
        folder = self.folder / "hostile"
        shutil.copytree(self.scenarios / "travelling_wave", folder)
        robot = folder / "caterpillar.robot.xml"
        text = robot.read_text()
        for number, name in enumerate(reversed(HOSTILE), 1):
            quoted = name.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
            text = text.replace(f'<Joint name="J{number}"', f'<Joint name="{quoted}"')
        robot.write_text(text)
        recording = self.folder / "<b>.proleg"
        self.simulate(folder / "uniform.simulation.xml", recording, "--seconds", "0.1")
        page = self.page(recording)
        self.assertEqual([joint["name"] for joint in page.documents["robot"]["joints"]], HOSTILE)
        self.assertEqual(page.recording["file"], "<b>.proleg")
        added = page.text[len(PLAYER.split("<!-- the recording -->")[0]):]
        self.assertEqual(added.count("<"), 5, "found more than two elements and the end of the page")

    def test_a_run_that_goes_on_is_exported_up_to_its_last_tick(self):
        copy = self.changed_copy("growing.proleg", "UPDATE run SET value = '0' WHERE key = 'finished'")
        finished = self.export(copy)
        self.assertEqual(finished.returncode, 0)
        self.assertIn("the run is not finished; the recording has 42 s", finished.stderr)
        self.assertFalse(Page(copy.with_suffix(".html")).recording["finished"])

    def test_a_driven_robot_has_no_path(self):
        recording = self.folder / "driven.proleg"
        scenario = self.scenarios / "travelling_wave/uniform.simulation.xml"
        subprocess.run([self.programs / "proleg-drive", scenario, "--bus", f"sim:{scenario}", "--fast", "--seconds", "2",
                        "--record", recording], check=True, capture_output=True, timeout=LONGEST)
        page = self.page(recording)
        self.assertFalse(page.recording["has_path"])
        self.assertEqual(len({tuple(head) for head in page.values("head")}), 1)

    def test_it_says_how_large_the_file_is(self):
        file = self.recording.with_suffix(".html")
        finished = self.export(self.recording)
        size = file.stat().st_size
        self.assertEqual(finished.stdout, f"{file}\n{size / 1e6:.2f} MB, 4200 ticks, 42 s\n")
        as_json = json.loads(self.export(self.recording, "--json").stdout)
        self.assertEqual(as_json, {"file": str(file), "bytes": size, "ticks": 4200, "seconds": 42.0})

    def test_standard_output_has_the_page_alone(self):
        file = self.recording.with_suffix(".html")
        self.export(self.recording)
        self.assertEqual(self.export(self.recording, "--out", "-").stdout, file.read_text(encoding="utf-8"))

    def test_bad_input_writes_nothing(self):
        notes = self.folder / "notes.html"
        notes.write_text("<!doctype html>\n<p>precious\n")
        self.refused(self.recording, [str(notes), "page of a recording"], "--out", notes)
        self.assertEqual(notes.read_text(), "<!doctype html>\n<p>precious\n")
        self.refused(notes, [str(notes)])
        self.refused(self.folder / "missing.proleg", ["no such file"])
        self.refused(self.changed_copy("bare.proleg", "DELETE FROM source"), ["scenario"])
        self.refused(self.changed_copy("slot.proleg", "UPDATE slot SET algorithm = 'Other'"), ["scenario"])
        renamed = "UPDATE internal_value_name SET name = 'other' WHERE value_index = 1"
        self.refused(self.changed_copy("renamed.proleg", renamed), ["scenario"])
        self.refused(self.recording, ["--json"], "--json", "--out", "-")

    def test_a_missing_player_is_one_line(self):
        expected = [f"found no player in {self.player.parent}", "tools/page"]
        self.addCleanup(self.player.write_text, PLAYER)
        self.player.write_text("<!doctype html>\n<p>another page\n")
        self.refused(self.recording, ["player.html", "tools/page"])
        self.player.unlink()
        self.refused(self.recording, expected)


if __name__ == "__main__":
    ExportHtml.source, ExportHtml.programs = Path(sys.argv[1]), Path(sys.argv[2])
    unittest.main(argv=sys.argv[:1], verbosity=2)

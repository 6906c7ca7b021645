"""Data files of the thesis (listing B.8): `proleg export --thesis` writes them, `export` and `plot` read them.

Python's XML parser and SQLite are the oracles: a data file has the numbers of its recording.

usage: data_file_test.py SOURCE_DIR PROGRAM_DIR
"""

import contextlib
import math
import os
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

LONGEST = 300  # s, for a command that takes a second on an idle computer
STAMPS = ["realtime", "simtime", "stepcount"]


class DataFile:
    """What a data file has, by (module, type): a list of numbers for each frame."""

    def __init__(self, path):
        root = ElementTree.parse(path).getroot()
        self.header = {module.tag: module for module in root.find("header")}
        self.types = {name: module.find("typenames").text.split() for name, module in self.header.items()}
        self.values = {}
        self.frames = {name: [] for name in self.header}
        self.rounds = [int(one.get("number")) for one in root.findall("round")]
        for module in (module for one in root.findall("round") for module in one):
            for frame in module:
                self.frames[module.tag].append((int(frame.get("index")), float(frame.get("simtime"))))
                for one in frame:
                    self.values.setdefault((module.tag, one.tag), []).append([float(x) for x in one.text.split()])


class DataFiles(unittest.TestCase):
    source = None
    programs = None

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.run_file = cls.folder / "run.proleg"
        cls.simulate(cls.source / "sim/scenarios/travelling_wave/uniform.simulation.xml", cls.run_file, "--seconds", "3.5",
                     "--set", "amplitude=20@200")
        cls.must("export", cls.run_file, "--thesis")
        cls.data = cls.folder / "run.data.xml"

    @classmethod
    def command(cls, program, *words, **more):
        return subprocess.run([cls.programs / f"proleg-{program}", *words], capture_output=True, text=True,
                              timeout=LONGEST, check=False, **more)

    @classmethod
    def must(cls, program, *words, **more):
        finished = cls.command(program, *words, **more)
        assert finished.returncode == 0, finished.stderr
        return finished

    @classmethod
    def simulate(cls, scenario, recording, *more):
        cls.must("simulate", scenario, "--record", recording, *more)

    def refused(self, program, *words, message):
        """Status 2, one line, no file."""
        before = sorted(self.folder.iterdir())
        finished = self.command(program, *words)
        self.assertEqual(finished.returncode, 2, finished.stderr)
        self.assertEqual((finished.stdout, finished.stderr.count("\n")), ("", 1), finished.stderr)
        self.assertIn(message, finished.stderr)
        self.assertEqual(sorted(self.folder.iterdir()), before)

    def table(self, file):
        lines = self.must("export", file, "--out", "-").stdout.splitlines()
        names = lines[0].split("\t")
        rows = [line.split("\t") for line in lines[1:]]
        return {name: [row[i] for row in rows] for i, name in enumerate(names)}

    def test_the_header_is_that_of_the_print(self):
        data = DataFile(self.data)
        self.assertEqual(list(data.types), ["PatternGenerator_sinusoidal", "tactile", "robot_data"])
        self.assertEqual(data.types["PatternGenerator_sinusoidal"],
                         ["Angle", "Time", "Phase_Difference", "Frequency", *STAMPS])
        self.assertEqual(data.types["tactile"], ["x-normals", "y-normals", "z-normals", *STAMPS])
        self.assertEqual(data.types["robot_data"],
                         ["speed", "x_pos", "y_pos", "z_pos", "alpha", "beta", "gamma", "potential_energy",
                          "average_com_speed", "desired_joint_positions", "real_joint_positions", "servo_currents",
                          "servo_speeds", *STAMPS])
        parts = {name: module.get("parts") for name, module in data.header.items()}
        self.assertEqual(parts, {"PatternGenerator_sinusoidal": "5", "tactile": "12", "robot_data": "6"})
        for name, module in data.header.items():
            self.assertEqual(int(module.get("types")), len(data.types[name]))

    def test_every_frame_has_the_numbers_of_the_recording(self):
        data = DataFile(self.data)
        self.assertEqual(data.rounds, [0, 1, 2, 3])
        self.assertEqual(data.frames["robot_data"], [(tick, 10.0 * (tick + 1)) for tick in range(350)])
        database = sqlite3.connect(self.run_file)
        joints = [row[0] for row in database.execute("SELECT joint FROM joint ORDER BY file_index")]
        self.assertEqual(joints, [4, 3, 2, 1, 0])
        for type_name, column in (("desired_joint_positions", "setpoint_deg"), ("real_joint_positions", "angle_deg"),
                                  ("servo_currents", "servo_current_ma")):
            rows = database.execute(f"SELECT tick, joint, {column} FROM sample").fetchall()
            self.compare(data.values["robot_data", type_name], {(tick, 4 - joint): x for tick, joint, x in rows}, 5)
        for column in ("x_m", "y_m", "z_m"):
            rows = database.execute(f"SELECT tick, link, {column} FROM pose").fetchall()
            self.compare(data.values["robot_data", f"{column[0]}_pos"], {(t, 5 - link): x for t, link, x in rows}, 6)
        pressed = {}
        for tick, link, rear, front in database.execute("SELECT tick, link, rear, front FROM contact"):
            pressed[tick, 2 * (5 - link)] = rear
            pressed[tick, 2 * (5 - link) + 1] = front
        lengths = [[math.sqrt(x * x + y * y + z * z) for x, y, z in zip(*axes, strict=True)]
                   for axes in zip(*(data.values["tactile", f"{axis}-normals"] for axis in "xyz"), strict=True)]
        self.compare(lengths, pressed, 12)
        self.assertTrue(any(map(any, lengths)), "something touches the ground")
        # One module alone: the set-point is what it adds.
        self.assertEqual(data.values["PatternGenerator_sinusoidal", "Angle"],
                         data.values["robot_data", "desired_joint_positions"])
        database.close()

    def compare(self, frames, expected, parts):
        self.assertEqual(len(frames) * parts, len(expected))
        for (tick, part), value in expected.items():
            self.assertEqual(len(frames[tick]), parts)
            self.assertLessEqual(abs(frames[tick][part] - value), 1e-8 * abs(value) + 1e-300, (tick, part))

    def test_the_gait_of_the_thesis_gives_the_angles_that_it_prints(self):
        """A = 30 degrees, T = 1 s, -88.73 degrees from joint to joint, every 31 ms (algorithms.md, section 1.1)."""
        scenario = self.folder / "thesis.simulation.xml"
        shipped = self.source / "sim/scenarios/travelling_wave"
        text = (shipped / "uniform.simulation.xml").read_text()
        text = re.sub(r"<(robot|actuation|environment)>", rf"<\1>{shipped}/", text)
        text, count = re.subn(r"<tick[^>]*>[^<]*</tick>", '<tick unit="ms">31</tick>', text)
        self.assertEqual(count, 1)
        scenario.write_text(text)
        recording = self.folder / "thesis.proleg"
        self.simulate(scenario, recording, "--seconds", "0.31", "--set", "amplitude=30", "--set", "frequency=1",
                      "--set", "phase_difference=88.73", "--set", "phase=-354.92", "--set", "offset=0")
        self.must("export", recording, "--thesis")
        data = DataFile(self.folder / "thesis.data.xml")
        printed = [[5.80648, -29.297, -7.10298, 28.9827, 8.38557], [11.3934, -27.4934, -12.6101, 26.9354, 13.802]]
        for frame, angles in enumerate(printed):
            for found, angle in zip(data.values["PatternGenerator_sinusoidal", "Angle"][frame], angles, strict=True):
                self.assertAlmostEqual(found, angle, delta=0.005)
        self.assertEqual(data.values["PatternGenerator_sinusoidal", "Time"][:2], [[0.031] * 5, [0.062] * 5])

    def test_a_data_file_becomes_the_table_of_its_recording(self):
        ours = self.table(self.data)
        recorded = self.table(self.run_file)
        self.assertEqual(ours["tick"], recorded["tick"])
        self.assertEqual(ours["time_s"], recorded["time_s"])
        for new, old in (("Angle.J2", "setpoint_deg.J2"), ("real_joint_positions.J5", "angle_deg.J5"),
                         ("y_pos.Head", "y_m.Head"), ("servo_currents.J1", "current_mA.J1")):
            for a, b in zip(ours[new], recorded[old], strict=True):
                # The table has the shortest decimal that means the same step of 8.4e-8 degrees.
                self.assertLessEqual(abs(float(a) - float(b)), 1e-8 * abs(float(b)) + 4.2e-8)
        finished = self.must("export", self.data, "--json")
        self.assertIn('"ticks": 350', finished.stdout)
        self.assertTrue((self.folder / "run.data.tsv").is_file())

    def test_the_print_is_read(self):
        text = (self.source / "tests/sim/data_file/printed_data.hpp").read_text()
        printed = self.folder / "printed.xml"
        printed.write_text(re.search(r'R"\((.*)\)"', text, re.DOTALL)[1])
        self.assertEqual([row[1] for row in zip(*(self.table(printed)[f"Angle.{i}"] for i in range(1, 6)), strict=True)],
                         ["-29.297", "-27.4934"])
        self.must("plot", printed)
        self.assertIn("Angle.5", (self.folder / "printed.svg").read_text())

    def test_a_file_that_is_cut_gives_its_whole_frames_and_a_warning(self):
        cut = self.folder / "cut.xml"
        text = self.data.read_text()
        cut.write_text(text[:len(text) // 2 + 1000])
        finished = self.must("export", cut, "--out", "-")
        whole = cut.read_text().count("</frame>")
        line = cut.read_text().count("\n") + 1
        self.assertEqual(finished.stderr, f"proleg export: warning: {cut}:{line}: the file ends in the middle; its {whole} "
                                          "whole frames are used\n")
        complete = self.must("export", self.data, "--out", "-").stdout.splitlines()
        for cut_row, row in zip(finished.stdout.splitlines(), complete, strict=False):
            for cell, cell_of_whole in zip(cut_row.split("\t"), row.split("\t"), strict=True):
                self.assertIn(cell, ("", cell_of_whole))
        self.assertEqual(self.must("plot", cut).stderr.count("whole frames are used"), 1)

    def test_a_large_file_needs_little_memory(self):
        large = self.folder / "large.xml"
        frame = ('<frame index="{0}" realtime="{0}" simtime="{0}">\n<a>' + " ".join(["1.2345678"] * 90) + "</a>\n</frame>\n")
        with large.open("w") as file:
            file.write('<dataroot><header><m parts="90" types="4"><typenames>a realtime simtime stepcount</typenames></m>'
                       "</header>\n<round number=\"0\"><m>\n")
            for index in range(60_000):
                file.write(frame.format(index))
            file.write("</m></round></dataroot>\n")
        size_kb = large.stat().st_size // 1024
        self.assertGreater(size_kb, 50_000)
        for words in (["export", large, "--out", "/dev/null"], ["plot", large, "--series", "a.1,a.2"]):
            process = subprocess.Popen([self.programs / f"proleg-{words[0]}", *words[1:]], stdout=subprocess.DEVNULL)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            self.assertEqual(process.returncode, 0)
            self.assertLess(usage.ru_maxrss, 40_000, words)

    def test_what_cannot_be_is_refused(self):
        self.refused("export", self.data, "--thesis", message="found an XML file, expected a recording, because of --thesis")
        self.refused("export", self.data, "--html", message="because of --html")
        self.refused("export", self.run_file, "--thesis", "--html", message="--html")
        self.refused("export", self.run_file, "--thesis", "--out", self.run_file, message="no data file")
        damaged = self.folder / "damaged.proleg"
        shutil.copyfile(self.run_file, damaged)
        with contextlib.closing(sqlite3.connect(damaged)) as database:
            database.execute("ALTER TABLE source RENAME COLUMN text TO words")
        for form in ("--thesis", "--html"):
            self.refused("export", damaged, form, message="no such column: text")
        damaged.unlink()
        wrong = self.folder / "wrong.xml"
        wrong.write_text(self.data.read_text().replace('index="7"', 'index="seven"', 1))
        self.refused("export", wrong, message="wrong.xml:")
        self.refused("plot", wrong, message="found index='seven' in <frame>")
        wrong.unlink()

    def test_series_are_drawn(self):
        picture = self.folder / "series.svg"
        self.must("plot", self.run_file, "--series", "angle_deg,torque_Nm.J1", "--from", "1", "--to", "2", "--out", picture)
        texts = ["".join(one.itertext()) for one in ElementTree.parse(picture).getroot()]
        text = " ".join(texts)
        for word in ("angle (deg)", "torque (Nm)", "time (s)", "angle_deg.J5", "torque_Nm.J1"):
            self.assertIn(word, text)
        self.assertNotIn("angle_deg.J6", text)
        self.must("plot", self.data, "--series", "y_pos.Head", "--x", "x_pos.Head", "--out", picture)
        self.assertIn("x pos of Head (m)", picture.read_text())
        self.refused("plot", self.run_file, "--series", "angel_deg.J1", message="for example angle_deg.J1")
        self.refused("plot", self.run_file, "--series", "angle_deg.J1,", message="names of columns with commas")
        self.refused("plot", self.run_file, "--x", "time_s", message="--x: found no --series")

    def test_a_png_is_made_by_the_converter_that_is_installed(self):
        folder = self.folder / "bin"
        folder.mkdir()
        for tool in ("cat", "sh"):
            (folder / tool).symlink_to(shutil.which(tool))
        environment = dict(os.environ, PATH=str(folder))
        finished = self.command("plot", self.run_file, "--png", env=environment)
        self.assertEqual((finished.returncode, finished.stdout, finished.stderr.count("\n")), (2, "", 1))
        self.assertIn("librsvg2-bin", finished.stderr)
        self.assertFalse((self.folder / "run.png").exists())
        converter = folder / "rsvg-convert"
        converter.write_text('#!/bin/sh\n[ "$1 $2 $5" = "--format png --output" ] || exit 9\n'
                             '(printf "\\211PNG" && cat "$7") > "$6"\n')
        converter.chmod(0o755)
        finished = self.command("plot", self.run_file, "--png", env=environment)
        self.assertEqual(finished.returncode, 0, finished.stderr)
        self.assertEqual(finished.stdout, f"{self.folder / 'run.png'}\n")
        self.assertTrue((self.folder / "run.png").read_bytes().startswith(b"\x89PNG<?xml"))
        self.assertEqual(self.command("plot", self.run_file, "--png", env=environment).returncode, 0, "a PNG replaces a PNG")
        converter.write_text("#!/bin/sh\nexit 3\n")
        self.assertEqual(self.command("plot", self.run_file, "--png", env=environment).returncode, 1)
        self.refused("plot", self.run_file, "--png", "--out", self.folder / "a.svg", message="ends with .png")


if __name__ == "__main__":
    DataFiles.source = Path(sys.argv[1])
    DataFiles.programs = Path(sys.argv[2])
    unittest.main(argv=sys.argv[:1])

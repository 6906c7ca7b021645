#!/usr/bin/env python3
"""A search can be resumed by every build that gives the same results: the key of the build must change with the sources
and settings that determine a result, and with nothing else.

Usage: result_key_test.py SCRIPT (tools/cmake/write_result_key.cmake)"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(sys.argv.pop(1)).resolve()

DETERMINE_A_RESULT = [
    "shared/fixed", "shared/gait", "shared/kernel", "sim/robot", "sim/environment", "sim/scenario", "sim/physics",
    "sim/mujoco", "sim/ode", "sim/reduced", "sim/measure", "sim/loop", "sim/optimize/experiment", "sim/optimize/evaluation",
    "sim/optimize/method"]
OTHERS = [
    "docs", "firmware/module", "shared/canopen", "shared/computer/master", "sim/bus", "sim/mcu/cpu", "sim/optimize/mpi",
    "sim/optimize/report", "sim/record", "sim/scenarios/travelling_wave", "tests/sim/ode", "tools/proleg"]


class ResultKey(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.tree = pathlib.Path(self.folder.name) / "tree"
        for room in DETERMINE_A_RESULT + OTHERS:
            (self.tree / room).mkdir(parents=True)
            (self.tree / room / "a.cpp").write_text("int a;\n")

    def tearDown(self):
        self.folder.cleanup()

    def key(self, settings="gcc 12.2;-O2;ODE 0.16.2"):
        output = pathlib.Path(self.folder.name) / "key.hpp"
        subprocess.run(["cmake", f"-DSOURCE_DIR={self.tree}", f"-DSETTINGS={settings}", f"-DOUTPUT={output}", "-P",
                        str(SCRIPT)], check=True)
        return output.read_text()

    def test_changes_with_each_room_that_determines_a_result(self):
        keys = {self.key()}
        for number, room in enumerate(DETERMINE_A_RESULT):
            (self.tree / room / "a.cpp").write_text("int b;\n")
            keys.add(self.key())
            self.assertEqual(len(keys), number + 2, room)

    def test_changes_with_new_removed_and_renamed_files(self):
        keys = {self.key()}
        room = self.tree / "sim/physics"
        (room / "below").mkdir()
        (room / "below/b.hpp").write_text("int b;\n")
        keys.add(self.key())
        (room / "below/b.hpp").rename(room / "below/c.hpp")
        keys.add(self.key())
        (room / "a.cpp").unlink()
        keys.add(self.key())
        self.assertEqual(len(keys), 4)

    def test_changes_with_compiler_flags_and_libraries(self):
        settings = ["gcc 12.2;-O2;ODE 0.16.2", "gcc 12.3;-O2;ODE 0.16.2", "gcc 12.2;-O3;ODE 0.16.2",
                    "gcc 12.2;-O2;ODE 0.16.3"]
        self.assertEqual(len({self.key(each) for each in settings}), 4)

    def test_stays_when_other_files_change_or_the_tree_moves(self):
        key = self.key()
        for room in OTHERS:
            (self.tree / room / "a.cpp").write_text("int b;\n")
            self.assertEqual(self.key(), key, room)
        (self.tree / "sim/physics/notes.md").write_text("a note\n")
        self.assertEqual(self.key(), key)
        self.tree = self.tree.rename(self.tree.parent / "elsewhere")
        self.assertEqual(self.key(), key)

    def test_an_equal_key_does_not_touch_the_header(self):
        self.key()
        header = pathlib.Path(self.folder.name) / "key.hpp"
        before = header.stat().st_mtime_ns
        self.key()
        self.assertEqual(header.stat().st_mtime_ns, before)


if __name__ == "__main__":
    unittest.main()

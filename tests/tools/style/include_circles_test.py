"""include_circles.py finds the circles that are planted, and nothing else."""

import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CHECK = Path(__file__).resolve().parent / "include_circles.py"
SOURCE = Path(__file__).resolve().parents[3]


class TestIncludeCircles(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def write(self, name, *lines):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("".join(line + "\n" for line in lines))

    def check(self):
        done = subprocess.run([sys.executable, CHECK, self.folder], capture_output=True, text=True)
        self.assertEqual(done.stderr, "")
        return done.returncode, done.stdout

    def expect_none(self):
        self.assertEqual(self.check(), (0, ""))

    def expect(self, *lines):
        self.assertEqual(self.check(), (1, "".join(line + "\n" for line in lines)))

    def test_a_header_and_its_source_are_one_unit(self):
        self.write("sim/bus/bus.hpp", "#pragma once")
        self.write("sim/bus/bus.cpp", '#include "sim/bus/bus.hpp"')
        self.expect_none()

    def test_units_that_include_one_another_in_one_direction_are_no_circle(self):
        self.write("shared/can/frame.hpp")
        self.write("sim/bus/controller.hpp", '#include "shared/can/frame.hpp"')
        self.write("sim/bus/bus.hpp", '#include "sim/bus/controller.hpp"', '#include "shared/can/frame.hpp"')
        self.expect_none()

    def test_two_headers(self):
        self.write("sim/bus/bus.hpp", "#pragma once", '#include "sim/bus/controller.hpp"')
        self.write("sim/bus/controller.hpp", '#include "sim/bus/bus.hpp"')
        self.expect(
            "sim/bus/bus -> sim/bus/controller -> sim/bus/bus",
            '    sim/bus/bus.hpp:2: #include "sim/bus/controller.hpp"',
            '    sim/bus/controller.hpp:1: #include "sim/bus/bus.hpp"',
        )

    def test_an_include_of_the_source_closes_a_circle(self):
        self.write("sim/bus/bus.hpp", '#include "sim/bus/controller.hpp"')
        self.write("sim/bus/controller.hpp")
        self.write("sim/bus/controller.cpp", '#include "sim/bus/controller.hpp"', '#  include  "sim/bus/bus.hpp"')
        self.expect(
            "sim/bus/bus -> sim/bus/controller -> sim/bus/bus",
            '    sim/bus/bus.hpp:1: #include "sim/bus/controller.hpp"',
            '    sim/bus/controller.cpp:2: # include "sim/bus/bus.hpp"',
        )

    def test_a_circle_of_three_is_printed_once(self):
        self.write("sim/a.hpp", '#include "sim/b.hpp"')
        self.write("sim/b.hpp", '#include "sim/c.hpp"')
        self.write("sim/c.hpp", '#include "sim/a.hpp"')
        self.assertEqual(self.check()[1].splitlines()[0], "sim/a -> sim/b -> sim/c -> sim/a")
        self.assertEqual(len(self.check()[1].splitlines()), 4)

    def test_every_circle_is_printed(self):
        self.write("sim/a.hpp", '#include "sim/b.hpp"')
        self.write("sim/b.hpp", '#include "sim/a.hpp"')
        self.write("host/c.hpp", '#include "host/d.hpp"')
        self.write("host/d.hpp", '#include "host/c.hpp"')
        circles = [line for line in self.check()[1].splitlines() if not line.startswith(" ")]
        self.assertEqual(circles, ["host/c -> host/d -> host/c", "sim/a -> sim/b -> sim/a"])

    def test_tests_name_files_of_their_folder_and_of_others_without_the_folder(self):
        self.write("tests/sim/landscape.hpp", '#include "log.hpp"')
        self.write("tests/sim/log.hpp", '#include "support/rig.hpp"')
        self.write("tests/cpu/support/rig.hpp", '#include "landscape.hpp"')
        self.assertIn("tests/cpu/support/rig -> tests/sim/landscape -> tests/sim/log -> tests/cpu/support/rig\n", self.check()[1])

    def test_folders_in_a_circle_although_their_units_are_in_none(self):
        self.write("tools/proleg/export.cpp", '#include "tools/proleg/ui/document.hpp"')
        self.write("tools/proleg/ui/document.hpp")
        self.write("tools/proleg/ui/session.cpp", '#include "tools/proleg/bus.hpp"')
        self.write("tools/proleg/bus.hpp")
        self.expect(
            "tools/proleg/ -> tools/proleg/ui/ -> tools/proleg/",
            '    tools/proleg/export.cpp:1: #include "tools/proleg/ui/document.hpp"',
            '    tools/proleg/ui/session.cpp:1: #include "tools/proleg/bus.hpp"',
        )

    def test_files_of_the_page_also_with_imports_of_types_and_of_chunks(self):
        self.write("host/page/source/app.tsx", "import {", "  Panel,", "} from './panels/panel.js';")
        self.write("host/page/source/panels/panel.tsx", "export const scene = () => import('../scene.js');")
        self.write("host/page/source/scene.ts", "import type { App } from './app.js';")
        self.expect(
            "host/page/source/app.tsx -> host/page/source/panels/panel.tsx -> host/page/source/scene.ts -> "
            "host/page/source/app.tsx",
            "    host/page/source/app.tsx:1: import { Panel, } from './panels/panel.js'",
            "    host/page/source/panels/panel.tsx:1: import('../scene.js')",
            "    host/page/source/scene.ts:1: import type { App } from './app.js'",
            "host/page/source/ -> host/page/source/panels/ -> host/page/source/",
            "    host/page/source/app.tsx:1: import { Panel, } from './panels/panel.js'",
            "    host/page/source/panels/panel.tsx:1: import('../scene.js')",
        )

    def test_a_circle_in_a_copy_of_a_room_of_the_tree(self):
        for room in ("shared/fixed", "shared/can"):
            shutil.copytree(SOURCE / room, self.folder / room)
        self.expect_none()
        planted = self.folder / "shared/can/can_port.hpp"
        planted.write_text(planted.read_text() + '#include "shared/can/transmit_queue.hpp"\n')
        status, text = self.check()
        self.assertEqual(status, 1)
        self.assertEqual(text.splitlines()[0], "shared/can/can_port -> shared/can/transmit_queue -> shared/can/can_port")

    def test_a_folder_without_sources_is_an_error(self):
        status, text = self.check()
        self.assertEqual(status, 1)
        self.assertIn("found no sources", text)


if __name__ == "__main__":
    unittest.main()

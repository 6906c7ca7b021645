#!/usr/bin/env python3
"""A robot that chooses its gait comes farther than with each gait alone; the rules for it can be learned.

Usage: gait_course_test.py SOURCE_FOLDER PROGRAM_FOLDER [learned]

Without `learned` the rules are given.
"""

import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE, PROGRAMS = Path(sys.argv[1]), Path(sys.argv[2])
IS_LEARNED = sys.argv[3:] == ["learned"]
sys.path.insert(0, str(SOURCE / "tests" / "bench"))
import gait_course  # noqa: E402


class GaitCourse(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.course = gait_course.Course(PROGRAMS, temporary.name)

    def expect_farther(self, rules, seconds, starts):
        distances, end = self.course.distances(rules, seconds, starts)
        for side in ("feet", "back"):
            for i, start in enumerate(starts):
                alone = max(distances[side, number][i] for number in (1, 2, 3))
                with self.subTest(side=side, start=start):
                    self.assertGreater(distances[side, 0][i], end, "behind all obstacles")
                    self.assertLess(alone, 0.7 * end)

    @unittest.skipIf(IS_LEARNED, "a test of its own")
    def test_the_choosing_robot_passes_a_course_on_which_each_gait_alone_stops(self):
        self.expect_farther(gait_course.RULES, 150, (0.1,))

    @unittest.skipIf(IS_LEARNED, "a test of its own")
    def test_the_shipped_scenario_has_this_course_and_these_rules(self):
        def boxes(text):
            """Centre, angle and extents of each box."""
            for body in re.findall(r"<Body type=\"static\">.*?</Body>", text, re.S):
                words = [re.search(pattern, body) for pattern in (r"<Translation>([^<]*)", r"<RotationAxis>1 0 0 ([^<]*)", r"<extents>([^<]*)")]
                yield [float(number) for word in words for number in (word.group(1).split() if word else [0])]

        shipped = SOURCE / "sim" / "scenarios" / "course"
        floor, *bodies = boxes((shipped / "course.environment.xml").read_text())
        self.assertEqual(bodies, list(boxes("\n".join(gait_course.course()[0]))))
        actuation = (shipped / "chooses.actuation.xml").read_text()
        values = {name: float(value) for name, value in re.findall(r'name="(\w+)" value="([^"]*)"', actuation)}
        expected = {name: float(value) for name, value in re.findall(r'name="(\w+)" value="([^"]*)"', gait_course.ACTUATION)}
        self.assertEqual(values, expected | gait_course.RULES)

    @unittest.skipIf(IS_LEARNED, "a test of its own")
    def test_the_shipped_scenario_ends_behind_the_last_obstacle_in_both_engines(self):
        for engine in ("reduced", "ode"):
            done = subprocess.run([PROGRAMS / "proleg", "simulate", "course", "--engine", engine, "--json"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            result = json.loads(done.stdout)
            self.assertGreater(result["measures"]["speed"] * 150, gait_course.course()[1], engine)

    @unittest.skipUnless(IS_LEARNED, "takes two minutes")
    def test_learned_rules_are_right_on_unseen_recordings_and_pass_the_course(self):
        learned = self.course.learn(self.course.record())
        print(f"right on unseen recordings: {learned['unseen_right']}; {learned['changes_per_minute']} changes a minute; "
              f"{learned['rules']}")
        self.assertGreaterEqual(learned["unseen_right"], 0.95)
        self.assertLess(learned["changes_per_minute"], 5)
        self.expect_farther(learned["parameters"], 300, (0.07, 0.14, 0.21))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

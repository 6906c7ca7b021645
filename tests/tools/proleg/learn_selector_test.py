#!/usr/bin/env python3
"""proleg learn-selector: rules from labelled recordings, what it writes and refuses.

Usage: learn_selector_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE, PROGRAMS = Path(sys.argv[1]), Path(sys.argv[2])
WAVE = SOURCE / "sim" / "scenarios" / "travelling_wave"

# The second gait is for a robot that lies on its back.
ACTUATION = """<actuation>
  <actuationModule name="SensingModule_gait_selector">
    <jointConfiguration joints="11111"/>
    <parameter name="amplitude_2" value="20"/>
    <parameter name="amplitude_4" value="20"/>
    <parameter name="window" value="300"/>
    <parameter name="dwell" value="500"/>
  </actuationModule>
</actuation>
"""
SIMULATION = """<simulation>
  <robot>{wave}/caterpillar.robot.xml</robot>
  <actuation>selector.actuation.xml</actuation>
  <environment>{world}.environment.xml</environment>
  <simulationProperties><duration>4</duration></simulationProperties>
</simulation>
"""
# Roll is always below 2; the robot decides at once.
PLAY_SET_2 = ("--set", "feature_2=-3", "--set", "threshold_2=2", "--set", "window=1", "--set", "dwell=0")


def run(command, *arguments):
    return subprocess.run([PROGRAMS / "proleg", command, *map(str, arguments)], capture_output=True, text=True)


class LearnSelector(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        (cls.folder / "selector.actuation.xml").write_text(ACTUATION)
        flat = (WAVE / "flat.environment.xml").read_text()
        start = flat.index("Pose:")
        end = flat.index("-->", start)
        for world, pose in (("upright", "0 0 0.026,0 0 0"), ("overturned", "0 0 0.026,0 180 0")):
            (cls.folder / f"{world}.environment.xml").write_text(f"{flat[:start]}Pose: ,{pose},{flat[end:]}")
            (cls.folder / f"{world}.simulation.xml").write_text(SIMULATION.format(wave=WAVE, world=world))
            for name, options in (("first", ()), ("second", PLAY_SET_2)):
                for seed in (1, 2):
                    cls.record(world, f"{world}_{name}_{seed}", "--seed", seed, *options)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def record(cls, world, name, *options):
        made = run("simulate", cls.folder / f"{world}.simulation.xml", "--engine", "reduced", "--record",
                   cls.folder / f"{name}.proleg", *options)
        assert made.returncode == 0, made.stderr

    def labelled(self):
        return [f"{number}={self.folder / world}_{name}_{seed}.proleg"
                for number, world in ((1, "upright"), (2, "overturned")) for name in ("first", "second")
                for seed in (1, 2)]

    def learn(self, *options, recordings=None):
        result = run("learn-selector", *(recordings or self.labelled()), "--json", *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def refused(self, *arguments):
        """The one line with which bad input is refused."""
        result = run("learn-selector", *arguments)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        return result.stderr

    def test_the_rules_are_right_on_recordings_that_they_were_not_learned_from(self):
        result = self.learn("--feature", "roll")
        self.assertEqual(result["parameters"]["feature_2"], 3)
        self.assertGreater(result["parameters"]["threshold_2"], 0.1)
        self.assertLess(result["parameters"]["threshold_2"], 0.9)
        self.assertEqual(result["rules"]["3"], "never")
        self.assertGreater(result["right"], 0.99)
        self.assertGreater(result["unseen_right"], 0.99)
        self.assertEqual(result["changes_per_minute"], 0)
        self.assertEqual([each["sets"] for each in result["recordings"]], [[1]] * 4 + [[2]] * 4)

    def test_the_written_scenario_chooses_as_the_rules_say(self):
        self.learn("--feature", "roll", "--out", self.folder / "learned")
        learned = self.folder / "learned" / "learned.simulation.xml"
        for world, expected in (("upright", 1), ("overturned", 2)):
            other = self.folder / "learned" / f"{world}.simulation.xml"
            other.write_text(learned.read_text().replace(
                learned.read_text().split("<environment>")[1].split("</environment>")[0],
                str(self.folder / f"{world}.environment.xml")))
            record = self.folder / f"learned_{world}.proleg"
            made = run("simulate", other, "--engine", "reduced", "--record", record)
            self.assertEqual(made.returncode, 0, made.stderr)
            table = run("export", record, "--out", "-").stdout.splitlines()
            column = next(i for i, name in enumerate(table[0].split("\t")) if name.startswith("set") and "J5" in name
                          and "setpoint" not in name)
            self.assertEqual(float(table[-1].split("\t")[column]), expected)

    def test_sets_with_the_same_gait_count_as_one(self):
        recordings = [word.replace("2=", "4=", 1) if word.startswith("2=") else word for word in self.labelled()]
        self.assertGreater(self.learn(recordings=recordings)["right"], 0.99)
        one = self.refused(*(word.replace("1=", "2,4=", 1) for word in recordings))
        self.assertIn("found recordings with one right gait", one)

    def test_a_single_recording_of_a_gait_is_not_tried_as_unseen(self):
        result = self.learn(recordings=[self.labelled()[0], self.labelled()[4]])
        self.assertIsNone(result["unseen_right"])
        text = run("learn-selector", self.labelled()[0], self.labelled()[4]).stdout
        self.assertIn("unseen     not known", text)

    def test_a_set_that_was_played_wherever_it_is_right_is_learned_without_hysteresis(self):
        # The robot lies upright in all recordings: nothing that it senses tells set 2 from set 1 but the gait itself.
        words = [f"{number}={self.folder}/upright_{name}_{seed}.proleg"
                 for number, name in ((1, "first"), (2, "second")) for seed in (1, 2)]
        result = self.learn("--feature", "roll", recordings=words)
        self.assertEqual(result["rules"]["2"], "never")
        self.assertLess(result["right"], 0.51)
        self.assertEqual([each["entry_tried"] for each in result["recordings"]], [False] * 4)
        text = run("learn-selector", *words, "--feature", "roll").stdout
        self.assertIn("\nset        1, 2: played in all recordings in which it is right", text)

    def test_the_written_scenario_has_the_values_with_which_the_recording_began(self):
        self.record("upright", "changed", "--seed", 3, *PLAY_SET_2, "--set", "amplitude_3=33", "--set", "dwell=40")
        others = [self.folder / f"upright_first_{seed}.proleg" for seed in (1, 2)]
        refusal = self.refused(f"2={self.folder}/changed.proleg", f"1={others[0]}")
        self.assertIn("found set 3 with other parameters", refusal)
        self.record("overturned", "changed_too", "--seed", 3, "--set", "amplitude_3=33", "--set", "dwell=40")
        result = self.learn("--out", self.folder / "changed", recordings=[f"2={self.folder}/changed.proleg",
                                                                          f"1={self.folder}/changed_too.proleg"])
        self.assertEqual(result["parameters"]["dwell"], 40)
        written = (self.folder / "changed" / "learned.actuation.xml").read_text()
        self.assertIn('name="amplitude_3" value="33"', written)
        self.assertIn('name="dwell" value="40"', written)

    def test_only_the_selector_that_was_learned_from_has_the_rules(self):
        (self.folder / "two.actuation.xml").write_text(ACTUATION.replace("11111", "11100").replace(
            "</actuation>", """  <actuationModule name="SensingModule_gait_selector">
    <jointConfiguration joints="00011"/>
    <parameter name="feature_2" value="-4"/>
    <parameter name="window" value="777"/>
  </actuationModule>
</actuation>"""))
        for world in ("upright", "overturned"):
            (self.folder / f"two_{world}.simulation.xml").write_text(
                SIMULATION.format(wave=WAVE, world=world).replace("selector.actuation", "two.actuation"))
            self.record(f"two_{world}", f"two_{world}")
        self.learn("--out", self.folder / "two", "--feature", "roll",
                   recordings=[f"1={self.folder}/two_upright.proleg", f"2={self.folder}/two_overturned.proleg"])
        first, second = (self.folder / "two" / "learned.actuation.xml").read_text().split("</actuationModule>")[:2]
        self.assertIn('name="feature_2" value="3"', first)
        self.assertIn('name="feature_2" value="-4"', second)
        self.assertIn('name="window" value="777"', second)

    def test_a_table_has_a_line_for_each_recording(self):
        text = run("learn-selector", *self.labelled()).stdout
        for word in self.labelled():
            self.assertIn(word[2:], text)
        self.assertIn("\nright      ", text)
        self.assertIn("\nunseen     ", text)
        self.assertIn("\nchanges    ", text)

    def test_bad_input_is_refused_in_one_line(self):
        good = self.labelled()
        other = self.folder / "other.proleg"
        made = run("simulate", WAVE / "uniform.simulation.xml", "--seconds", 1, "--record", other)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertIn("PatternGenerator_sinusoidal", self.refused(*good, f"1={other}"))
        self.assertIn("found the set '5'", self.refused("5=a", *good))
        self.assertIn("found no '='", self.refused("a.proleg", *good))
        self.assertIn("found no time from 3 s to 2 s", self.refused(good[0] + "@3-2", *good))
        self.assertIn("expected more than 0.9 s", self.refused(good[0] + "@1-1.5", *good))
        self.assertIn("missing.proleg", self.refused("1=missing.proleg", *good))
        self.assertIn("expected pitch, pitch_swing, roll", self.refused(*good, "--feature", "smell"))
        self.assertIn("expected 1 to 600000 ms", self.refused(*good, "--window", "0"))
        self.assertIn("expected 0 to 1", self.refused(*good, "--hysteresis", "2"))
        self.assertIn("found seconds that are also in", self.refused(*good, "2" + good[0][1:]))
        self.record("upright", "other_group", "--set", "amplitude_1=60@2s")
        self.assertIn("found another amplitude_1 from 2", self.refused(*good, f"1={self.folder}/other_group.proleg"))
        self.assertIn("--out: found an empty name", self.refused(*good, "--out", ""))
        full = self.folder / "full"
        full.mkdir()
        (full / "learned.simulation.xml").write_text("mine")
        self.refused(*good, "--out", full)
        self.assertEqual((full / "learned.simulation.xml").read_text(), "mine")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

#!/usr/bin/env python3
"""proleg adapt with a small atlas: what it finds, writes and refuses, and how it continues.

Usage: adapt_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

SOURCE, PROGRAMS = Path(sys.argv[1]), Path(sys.argv[2])
WAVE = SOURCE / "sim" / "scenarios" / "travelling_wave"
SCENARIO = WAVE / "uniform.simulation.xml"
OTHER_ROBOT = SOURCE / "sim" / "scenarios" / "long_chain" / "twenty.simulation.xml"


def run(command, *arguments):
    return subprocess.run([PROGRAMS / "proleg", command, *map(str, arguments)], capture_output=True, text=True)


def lines_of_trials(folder):
    """The lines of its table, behind comments and head."""
    return [line for line in (folder / "trials.tsv").read_text().splitlines() if not line.startswith("#")][1:]


class Adapt(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        cls.atlas = cls.folder / "atlas"
        cls.search(300)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def search(cls, evaluations, *options):
        made = run("optimise", WAVE / "gait_map.optimise.xml", "--engine", "reduced", "--workers", 1, "--evaluations",
                   evaluations, *(options or ("--out", cls.atlas)))
        assert made.returncode == 0, made.stderr

    def adapt(self, name, *options, scenario=SCENARIO, status=0, suspects=("none",)):
        """Without the usual suspects, whose simulation takes time, unless there are others."""
        suspected = [word for suspect in suspects for word in ("--suspect", suspect)]
        result = run("adapt", scenario, "--atlas", self.atlas, "--out", self.folder / name, "--json", *suspected, *options)
        self.assertEqual(result.returncode, status, result.stderr)
        return json.loads(result.stdout)

    def refused(self, *arguments):
        """The one line with which bad input is refused."""
        result = run("adapt", *arguments)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        return result.stderr

    def test_an_intact_robot_needs_few_trials(self):
        result = self.adapt("intact")
        self.assertEqual(result["ended"], "good enough")
        self.assertLessEqual(len(result["trials"]), 3)
        self.assertEqual(result["diagnosis"][0]["damage"], "none")
        first = result["trials"][0]
        self.assertAlmostEqual(first["measured"] / first["expected"], 1, delta=0.15)  # ODE, the reduced engine

    def test_the_gait_that_is_written_goes_as_far_as_was_measured(self):
        result = self.adapt("written", "--trials", 4, "--alpha", 1, "--length", 0.05)
        self.assertEqual(result["best"], max(trial["measured"] for trial in result["trials"]))
        self.assertEqual(result["best"], result["trials"][result["best_trial"] - 1]["measured"])
        simulated = json.loads(run("simulate", self.folder / "written" / "adapted.simulation.xml", "--json").stdout)
        self.assertEqual(simulated["measures"]["distance"], result["best"])

    def test_a_jammed_joint_is_worked_around(self):
        result = self.adapt("jammed", "--damage", "jammed:J3=20")
        self.assertLessEqual(len(result["trials"]), 12)
        first = result["trials"][0]
        self.assertLess(first["measured"], 0.9 * first["expected"])  # the atlas does not know of the jam
        self.assertGreaterEqual(result["best"], first["measured"])
        cells = [line.split("\t") for line in lines_of_trials(self.folder / "jammed")]
        self.assertEqual([line[1] for line in cells], [",".join(map(str, trial["cell"])) for trial in result["trials"]])
        picture = ElementTree.parse(self.folder / "jammed" / "trials.svg").getroot()
        group = next(g for g in picture.iter("{http://www.w3.org/2000/svg}g") if g.get("class") == "trials")
        numbers = {n for text in group.iter("{http://www.w3.org/2000/svg}text") for n in text.text.split(",")}
        self.assertEqual(numbers, {str(i + 1) for i in range(len(result["trials"]))})

    def test_a_suspicion_is_confirmed_and_shortens_the_trials(self):
        alone = self.adapt("alone", "--damage", "powerless:J4")
        suspects = ("powerless:J2", "powerless:J4", "jammed:J4=0", "friction=50%")
        result = self.adapt("suspected", "--damage", "powerless:J4", suspects=("none", *suspects))
        self.assertLess(len(result["trials"]), len(alone["trials"]))
        self.assertGreaterEqual(result["best"], alone["best"])
        probabilities = {its["damage"]: its["probability"] for its in result["diagnosis"]}
        self.assertEqual(set(probabilities), {"none", "unknown", *suspects})
        self.assertAlmostEqual(sum(probabilities.values()), 1)
        self.assertEqual(result["diagnosis"][0], {"damage": "powerless:J4", "probability": max(probabilities.values())})
        self.assertGreater(probabilities["powerless:J4"], 0.5)
        self.assertEqual([its["damage"] for its in alone["diagnosis"]], ["unknown", "none"])

    def test_suspected_damages_are_simulated_once_for_an_atlas(self):
        file = self.atlas / "damage_scores_3s.txt"
        options = ("--seconds", 3, "--trials", 1)
        first = self.adapt("once", *options, suspects=("none", "powerless:J5"))
        scores = file.read_text()
        file.write_text(scores.replace("\t", "\t0", 1))  # the same number
        self.assertEqual(self.adapt("again", *options, suspects=("none", "powerless:J5"))["trials"], first["trials"])
        self.assertEqual(file.read_text(), scores.replace("\t", "\t0", 1))  # read, and not made again
        file.write_bytes(b"\xff\0# inputs:\n")
        self.adapt("mended", *options, suspects=("friction=50%", "none", "powerless:J5", "powerless:J5"))
        lines = file.read_text().splitlines()
        self.assertEqual([line.split("\t")[0] for line in lines[2:]], ["friction=50%", "powerless:J5"])
        self.assertIn(lines[3], scores)
        self.adapt("other_length", "--seconds", 1, "--trials", 1, suspects=("none", "powerless:J5"))
        self.assertEqual(file.read_text().splitlines(), lines)
        file.unlink()
        os.mkfifo(file)  # which no program reads
        self.adapt("pipe", *options, suspects=("none", "powerless:J5"))

    def test_a_damage_is_suspected_once_however_it_is_written(self):
        result = self.adapt("spelling", "--seconds", 1, "--trials", 1, "--damage", "jammed:J3=20.0", "--damage", "friction=90",
                            suspects=("none", "jammed:J3", "jammed:J3=-0", "jammed:J3=0.0", "torque:J2=40", "torque:J2=40.0%"))
        self.assertEqual({its["damage"] for its in result["diagnosis"]}, {"none", "unknown", "jammed:J3=0", "torque:J2=40%"})
        again = run("adapt", SCENARIO, "--atlas", self.atlas, "--resume", self.folder / "spelling", "--suspect", "none", "--seconds", 1,
                    "--trials", 1, "--damage", "friction=90%", "--damage", "jammed:J3=20", "--json")
        self.assertEqual(json.loads(again.stdout)["resumed"], 1, again.stderr)

    def test_what_was_tried_is_kept_if_its_picture_cannot_be_written(self):
        options = ("--damage", "jammed:J3=20", "--alpha", 1, "--seconds", 1)
        first = self.adapt("no_picture", *options, "--trials", 2)
        folder = self.folder / "no_picture"
        (folder / "trials.svg").unlink()
        (folder / "trials.svg").mkdir()
        resume = ("adapt", SCENARIO, "--atlas", self.atlas, "--suspect", "none", *options, "--trials", 3, "--resume", folder, "--json")
        refused = run(*resume)
        self.assertEqual((refused.returncode, refused.stdout), (2, ""))
        self.assertIn("trials.svg: found a folder, expected a file of `proleg adapt`", refused.stderr)
        (folder / "trials.svg").rmdir()
        (folder / "adapted.files").rename(folder / "moved")
        (folder / "adapted.files").write_text("")  # where a folder has to be
        failed = run(*resume)
        self.assertEqual(failed.returncode, 1, failed.stderr)
        result = json.loads(failed.stdout)
        self.assertEqual((result["ended"], len(result["trials"]), result["trials"][:2]), ("failed", 3, first["trials"]))
        self.assertIn("adapted.files", result["reason"])
        self.assertEqual(len(lines_of_trials(folder)), 3)
        self.assertRegex(failed.stderr, "ended after 3 trials, because .*; the same command with --resume .* continues")

    def test_an_interruption_before_the_next_trial_forgets_none(self):
        options = ("--damage", "jammed:J3=20", "--alpha", 1)
        first = self.adapt("earlier", *options, "--trials", 2)
        suspects = [word for degrees in range(-40, 41) for word in ("--suspect", f"jammed:J2={degrees}")]
        command = [PROGRAMS / "proleg", "adapt", SCENARIO, "--atlas", self.atlas, "--resume", self.folder / "earlier", "--json", "--trials", "3",
                   *map(str, options), "--suspect", "none", *suspects]
        running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while not (self.atlas / "damage_scores_10s.txt").exists() or "jammed:J2=-4" not in (self.atlas / "damage_scores_10s.txt").read_text():
            self.assertIsNone(running.poll())
            time.sleep(0.05)
        running.send_signal(signal.SIGINT)
        out, errors = running.communicate()
        self.assertEqual(running.returncode, 1, errors)
        result = json.loads(out)
        self.assertEqual((result["ended"], result["resumed"], result["trials"], result["best"]),
                         ("interrupted", 2, first["trials"], first["best"]))
        self.assertEqual(set(result), set(first))
        self.assertIsNone(result["diagnosis"])
        self.assertIn("interrupted after 2 trials; the same command with --resume", errors)

    def test_the_usual_damages_are_suspected_beside_those_that_are_named(self):
        result = self.adapt("usual", "--seconds", 1, "--damage", "powerless:J2", suspects=("powerless:J3", "mass:Head=150%"))
        damages = {its["damage"] for its in result["diagnosis"]}
        self.assertEqual(len(damages), 2 + 5 * 5 + 1 + 1)
        self.assertLessEqual({"mass:Head=150%"}, damages)
        self.assertLessEqual({"none", "unknown", "friction=50%", "powerless:J2", "torque:J3=50%", "jammed:J1=-20"}, damages)

    def test_every_damage_changes_the_trials(self):
        intact = self.adapt("as_it_is", "--trials", 1)["best"]
        for damage in ("jammed:J3", "torque:J3=40", "powerless:J3", "lost:J3", "friction=50%", "mass:Head=300"):
            with self.subTest(damage=damage):
                result = self.adapt("damage_" + damage.replace(":", "_"), "--trials", 1, "--damage", damage)
                self.assertNotEqual(result["best"], intact)
                self.assertEqual(result["damage"], [damage])

    def test_it_continues_where_it_was(self):
        options = ["--damage", "jammed:J3=20", "--alpha", 1, "--length", 0.05]
        whole = self.adapt("whole", *options, "--trials", 5)
        self.adapt("parts", *options, "--trials", 2)
        rest = run("adapt", SCENARIO, "--atlas", self.atlas, *options, "--suspect", "none", "--trials", 5, "--resume",
                   self.folder / "parts", "--json")
        self.assertEqual(rest.returncode, 0, rest.stderr)
        rest = json.loads(rest.stdout)
        self.assertEqual(rest["resumed"], 2)
        self.assertEqual(rest["trials"], whole["trials"])
        for name in ("trials.tsv", "trials.svg"):
            self.assertEqual((self.folder / "parts" / name).read_text(), (self.folder / "whole" / name).read_text())

    def test_other_inputs_do_not_continue(self):
        self.adapt("refused", "--trials", 1, "--damage", "jammed:J2")
        resume = ["--resume", self.folder / "refused", "--atlas", self.atlas, "--suspect", "none"]
        for options in (["--damage", "jammed:J3"], ["--damage", "jammed:J2", "--seconds", 11],
                        ["--damage", "jammed:J2", "--friction", 0.4]):
            self.assertIn("trials.tsv:1: found trials of another atlas, scenario or program",
                          self.refused(SCENARIO, *resume, *options))
        self.assertIn("nothing to resume",
                      self.refused(SCENARIO, *resume[2:], "--resume", self.folder / "nowhere"))
        self.assertFalse((self.folder / "nowhere").exists())

    def test_control_c_keeps_what_was_learned(self):
        folder = self.folder / "interrupted"
        command = [PROGRAMS / "proleg", "adapt", SCENARIO, "--atlas", self.atlas, "--damage", "jammed:J3", "--seconds",
                   "30", "--alpha", "1", "--suspect", "none"]
        program = subprocess.Popen([*command, "--trials", "1000", "--out", folder], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        self.assertTrue(program.stdout.readline().startswith("trial 1 "))
        program.send_signal(signal.SIGINT)
        _, errors = program.communicate()
        self.assertEqual(program.returncode, 1, errors)
        self.assertIn("--resume", errors)
        made = len(lines_of_trials(folder))
        self.assertGreaterEqual(made, 1)
        self.assertTrue((folder / "adapted.simulation.xml").exists())
        resumed = subprocess.run([*command, "--trials", str(made), "--resume", folder, "--json"], capture_output=True,
                                 text=True)
        self.assertEqual(resumed.returncode, 0, resumed.stderr)
        self.assertEqual(json.loads(resumed.stdout)["resumed"], made)

    def test_bad_input_is_refused_in_one_line(self):
        out = ["--out", self.folder / "none"]
        atlas = ["--atlas", self.atlas]
        self.assertIn("--damage: found", self.refused(SCENARIO, *atlas, *out, "--damage", "jammed:J9"))
        self.assertIn("--suspect: found", self.refused(SCENARIO, *atlas, *out, "--suspect", "jammed:J9"))
        self.assertIn("--suspect: found", self.refused(SCENARIO, *atlas, *out, "--suspect", "none", "--suspect", "lost"))
        self.assertIn("--trials", self.refused(SCENARIO, *atlas, *out, "--trials", 0))
        self.assertIn("--alpha", self.refused(SCENARIO, *atlas, *out, "--alpha", "nan"))
        self.assertIn("--seconds", self.refused(SCENARIO, *atlas, *out, "--seconds", 0))
        self.assertIn(f"--atlas: found no {self.folder}/store.sqlite, expected the folder of a search that has made a map",
                      self.refused(SCENARIO, "--atlas", self.folder, *out))
        (self.folder / "cut").mkdir()
        store = (self.atlas / "store.sqlite").read_bytes()
        (self.folder / "cut" / "store.sqlite").write_bytes(store[:len(store) // 2])
        self.assertIn("store.sqlite: found a damaged database (",
                      self.refused(SCENARIO, "--atlas", self.folder / "cut", *out))
        self.assertIn("found 20 joints, expected 5 joints as in the atlas", self.refused(OTHER_ROBOT, *atlas, *out))
        self.assertIn("found another frequency", self.refused(SCENARIO, *atlas, *out, "--set", "frequency=0.7"))
        self.assertFalse((self.folder / "none").exists())
        self.adapt("twice", "--trials", 1)
        self.assertIn("found an existing file", self.refused(SCENARIO, *atlas, "--out", self.folder / "twice"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])

#!/usr/bin/env python3
"""proleg adapt and proleg optimise with a robot of modules, here that of 'proleg bus': its trials, their scores, and what goes wrong.

Usage: robot_trials_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import json
import os
import re
import shutil
import signal
import sqlite3
import statistics
import subprocess
import sys
import tempfile
import threading
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
sys.path.append(str(Path(__file__).resolve().parents[2] / "support"))
from processes import children
from waiting import LONGEST, wait_until

SOURCE, PROGRAMS = Path(sys.argv[1]), Path(sys.argv[2])
WAVE = SOURCE / "sim" / "scenarios" / "travelling_wave"
JOINTS = {"J1", "J2", "J3", "J4", "J5"}


class Program:
    """A program whose messages are read as they come."""

    def __init__(self, name, *arguments, **options):
        self.process = subprocess.Popen([PROGRAMS / name, *map(str, arguments)], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)
        self.messages = []
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        for line in self.process.stderr:
            self.messages.append(line.rstrip("\n"))

    def until(self, pattern, count=1):
        """Waits for so many messages."""
        wait_until(lambda: sum(1 for line in list(self.messages) if re.search(pattern, line)) >= count,
                   lambda: f"{count} x {pattern} in {self.messages}")

    def say(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def end(self):
        """Waits for its end."""
        self.process.stdin.close()
        self.process.stdout.read()
        self.process.wait(LONGEST)
        self.reader.join(LONGEST)
        self.process.stdout.close()
        self.process.stderr.close()


class Bus(Program):
    """'proleg bus', until the end of a test."""

    def __init__(self, scenario):
        super().__init__("proleg-bus", scenario, "--tcp", 0, "--verbose")
        self.address = re.search(r"--bus (\S+)", self.process.stdout.readline()).group(1)

    def powered(self):
        """The joints with power, as the robot itself reports."""
        joints = set()
        for line in list(self.messages):
            if found := re.search(r": (\S+) has (no )?power", line):
                (joints.discard if found.group(2) else joints.add)(found.group(1))
        return joints

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGINT)
        self.end()


class RobotTrials(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        shutil.copytree(WAVE, cls.folder / "wave")
        cls.scenario = cls.folder / "wave" / "uniform.simulation.xml"
        cls.scenario.write_text(cls.scenario.read_text().replace("<duration>30<", "<duration>2<"))
        cls.atlas = cls.folder / "atlas"
        made = cls.proleg("optimise", cls.folder / "wave" / "gait_map.optimise.xml", "--engine", "reduced", "--workers", 1,
                          "--evaluations", 120, "--out", cls.atlas)
        assert made.returncode == 0, made.stderr
        # The program of the documentation that measures a trial.
        page = (SOURCE / "docs" / "adaptation.md").read_text()
        program = re.search(r"```python\n(#!.*?)```", page, re.DOTALL).group(1)
        assert len(program.splitlines()) <= 15
        cls.simulates = cls.script("simulates.py", program)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def script(cls, name, text):
        path = cls.folder / name
        path.write_text(text)
        path.chmod(0o755)
        return path

    @classmethod
    def proleg(cls, *arguments, **options):
        return subprocess.run([PROGRAMS / "proleg", *map(str, arguments)], capture_output=True, text=True, timeout=LONGEST,
                              env={"PATH": f"{PROGRAMS}:/usr/bin:/bin", **cls.environment()}, **options)

    @staticmethod
    def environment():
        """Virtual time is handed on in it."""
        return {name: value for name, value in os.environ.items() if name != "PATH"}

    def adapting(self, out, bus, *options, trials=2):
        return ["adapt", self.scenario, "--atlas", self.atlas, "--out", self.folder / out, "--bus", bus, "--seconds", 2,
                "--trials", trials, "--alpha", 1, "--length", 0.05, "--suspect", "none", *options]

    def made(self, out):
        """The trials that were kept."""
        lines = (self.folder / out / "trials.tsv").read_text().splitlines()
        return [line for line in lines if not line.startswith("#")][1:]  # behind comments and head

    def simulated_bus(self):
        return f"sim:{self.scenario}"

    def refused(self, *arguments):
        """The one line with which bad input is refused."""
        result = self.proleg(*arguments)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        return result.stderr

    # A program measures.

    def test_a_robot_that_moves_as_the_simulation_makes_the_trials_of_the_simulation(self):
        with Bus(self.scenario) as bus:
            made = self.proleg(*self.adapting("robot", bus.address, "--score-command", self.simulates, "--json", trials=3))
            self.assertEqual(made.returncode, 0, made.stderr)
            self.assertEqual(bus.powered(), set())
            for joint in JOINTS:
                self.assertEqual(sum(f"{joint} has power" in line for line in bus.messages), 3, bus.messages)
        robot = json.loads(made.stdout)
        simulated = json.loads(self.proleg("adapt", self.scenario, "--atlas", self.atlas, "--out", self.folder / "simulated",
                                           "--seconds", 2, "--trials", 3, "--alpha", 1, "--length", 0.05, "--suspect", "none",
                                           "--json").stdout)
        self.assertEqual(len(robot["trials"]), 3)
        self.assertEqual(robot["trials"], simulated["trials"])
        self.assertEqual((robot["engine"], robot["bus"]), ("robot", bus.address))
        best = json.loads(self.proleg("simulate", self.folder / "robot" / "adapted.simulation.xml", "--json").stdout)
        self.assertEqual(best["measures"]["distance"], robot["best"])
        names = {path.name for path in (self.folder / "robot" / "trials").iterdir()}
        self.assertEqual(names, {"files"} | {f"trial_{i}.{end}" for i in (1, 2, 3)
                                             for end in ("proleg", "simulation.xml", "actuation.xml")})

    def test_a_program_that_prints_no_number_ends_the_trials_and_they_can_continue(self):
        prints = {"a_word": ("echo far", "found 'far'"), "two": ("echo 1 2", "found '1 2'"), "nan": ("echo nan", "found 'nan'"),
                  "inf": ("echo inf", "found 'inf'"), "nothing": ("true", "found no output"),
                  "fails": ("echo 1; echo no camera >&2; exit 3", "found exit status 3: no camera"),
                  "negative": ("echo -1", "found '-1'"), "huge": ("echo 1e12", "found '1e12'"),
                  "lines": ("echo far; echo away", "found 'far away'"), "hangs": ("sleep 60", "found no end in 2 s")}
        for name, (text, found) in prints.items():
            with self.subTest(name):
                script = self.script(name, f"#!/bin/sh\n{text}\n")
                command = self.adapting("no_number_" + name, self.simulated_bus())
                failed = self.proleg(*command, "--score-command", script, "--score-timeout", 2, "--json")
                self.assertEqual(failed.returncode, 1, failed.stderr)
                recording = self.folder / ("no_number_" + name) / "trials" / "trial_1.proleg"
                reason = f"trial_1 has no score: {script} of {recording}: {found}, expected"
                last = failed.stderr.splitlines()[-1]
                self.assertIn(f"proleg adapt: ended after 0 trials, because {reason}", last)
                self.assertIn("; the same command with --resume", last)
                result = json.loads(failed.stdout)
                self.assertEqual((result["ended"], result["trials"], result["best"]), ("failed", [], None))
                self.assertIn(reason, result["reason"])
                self.assertEqual(self.made("no_number_" + name), [])
        command = self.adapting("no_number_two", self.simulated_bus(), "--resume", self.folder / "no_number_two")
        rest = self.proleg(*command, "--score-command", self.simulates)
        self.assertEqual(rest.returncode, 0, rest.stderr)
        self.assertEqual(len(self.made("no_number_two")), 2)

    def test_a_program_that_vanishes_ends_the_trials_and_what_was_learned_is_kept(self):
        script = self.script("vanishes.sh", "#!/bin/sh\nrm \"$0\"\necho 0.01\n")
        failed = self.proleg(*self.adapting("vanishes", self.simulated_bus(), "--score-command", script, "--json"))
        self.assertEqual(failed.returncode, 1, failed.stderr)
        reason = f"trial_2 has no score: found no program {script}, expected an executable file"
        self.assertIn(f"ended after 1 trial, because {reason}; the same command with --resume", failed.stderr)
        result = json.loads(failed.stdout)
        self.assertEqual((result["ended"], result["reason"], result["best"]), ("failed", reason, 0.01))
        for name in ("trials.svg", "adapted.simulation.xml"):
            self.assertTrue((self.folder / "vanishes" / name).exists(), name)
        self.assertEqual(len(self.made("vanishes")), 1)

    # A person measures.

    def test_a_person_types_what_was_measured(self):
        with Bus(self.scenario) as bus:
            program = Program("proleg", *self.adapting("person", bus.address, trials=3))
            program.until("trial_1: the servos have no power.*distance in m")
            self.assertEqual(bus.powered(), set())
            self.assertEqual(children(program.process.pid), {})  # nothing runs that could move the robot
            for wrong in ("far", "1,5", "nan", "", "-1", "1e12", 1_000_000 * "1"):
                program.say(wrong)
            program.until(r"^found .*, expected a number from 0 to 1e9 \(distance in m\), again or stop", 7)
            program.until("^found a line of more than 1000 characters, expected")
            program.say("again")
            program.until("trial_1: the servos have no power", 2)
            program.say("0.01")
            program.until("trial_2: the servos have no power")
            program.say("stop")
            program.end()
        self.assertEqual(program.process.returncode, 1)
        self.assertIn("interrupted after 1 trial;", program.messages[-1])
        self.assertEqual([line.split("\t")[-2] for line in self.made("person")], ["0.01"])

    def test_a_program_that_types_what_is_no_answer_ends_the_trials(self):
        ended = self.proleg(*self.adapting("flood", self.simulated_bus()), "--json", input="0.01\n" + 10_000 * "y\n")
        self.assertEqual(ended.returncode, 1)
        self.assertEqual(ended.stderr.count("found 'y', expected a number"), 100)
        self.assertIn("100 wrong answers: no further trial", ended.stderr)
        self.assertEqual([line.split("\t")[-2] for line in self.made("flood")], ["0.01"])

    def test_a_robot_that_does_not_move_has_a_score_of_0(self):
        still = self.proleg(*self.adapting("still", self.simulated_bus(), trials=2), "--json", input="0\n0\n")
        self.assertEqual(still.returncode, 0, still.stderr)
        self.assertEqual([trial["failure"] for trial in json.loads(still.stdout)["trials"]], [None, None])
        self.assertTrue((self.folder / "still" / "adapted.simulation.xml").exists())

    def test_the_end_of_standard_input_ends_the_trials(self):
        command = self.adapting("typed", self.simulated_bus(), trials=4)
        ended = self.proleg(*command, input="0.01\n0.02\n")
        self.assertEqual(ended.returncode, 1)
        self.assertIn("standard input has ended", ended.stderr)
        self.assertEqual([line.split("\t")[-2] for line in self.made("typed")], ["0.01", "0.02"])
        self.assertTrue((self.folder / "typed" / "adapted.simulation.xml").exists())
        rest = self.proleg(*command, "--resume", self.folder / "typed", input="0.03\n0.015\n")
        self.assertEqual(rest.returncode, 0, rest.stderr)
        self.assertEqual([line.split("\t")[-2] for line in self.made("typed")], ["0.01", "0.02", "0.03", "0.015"])
        self.assertIn("found trials of another atlas, scenario or program",
                      self.refused(*[word for word in command if word not in ("--bus", self.simulated_bus())], "--resume",
                                   self.folder / "typed"))

    # What goes wrong while the robot moves.

    def moving(self, bus, out):
        """A run whose robot moves in its first trial, which takes a minute."""
        command = self.adapting(out, bus.address, "--score-command", self.simulates)
        command[command.index("--seconds") + 1] = 60
        program = Program("proleg", *command)
        wait_until(lambda: bus.powered() == JOINTS, lambda: f"{bus.messages} {program.messages}")
        return program

    def assert_cut_short(self, out):
        """The trial has ended long before its time."""
        with sqlite3.connect(self.folder / out / "trials" / "trial_1.proleg") as recording:
            self.assertLess(recording.execute("SELECT max(tick) FROM sample").fetchone()[0] or 0, 3000)

    def test_control_c_takes_the_power_away_and_a_second_one_changes_nothing(self):
        with Bus(self.scenario) as bus:
            program = self.moving(bus, "interrupted")
            program.process.send_signal(signal.SIGINT)
            program.process.send_signal(signal.SIGINT)
            program.end()
            self.assertEqual(bus.powered(), set())
        self.assert_cut_short("interrupted")
        self.assertEqual(program.process.returncode, 1)
        self.assertIn("interrupted after 0 trials; the same command with --resume", program.messages[-1])
        self.assertEqual(self.made("interrupted"), [])

    def test_a_killed_program_leaves_no_robot_that_moves(self):
        with Bus(self.scenario) as bus:
            program = self.moving(bus, "killed")
            program.process.kill()
            wait_until(lambda: bus.powered() == set(), lambda: bus.messages)
            program.end()
        self.assert_cut_short("killed")

    def test_a_program_that_is_suspended_leaves_no_robot_that_moves(self):
        with Bus(self.scenario) as bus:
            program = self.moving(bus, "suspended")
            program.process.send_signal(signal.SIGSTOP)
            wait_until(lambda: bus.powered() == set(), lambda: bus.messages)
            program.process.send_signal(signal.SIGCONT)
            program.end()
        self.assert_cut_short("suspended")
        self.assert_no_score(program, "suspended", "'proleg drive' has ended with status 1: .*is suspended, or hangs")

    def test_a_bus_that_vanishes_and_modules_that_restart_give_no_score(self):
        with Bus(self.scenario) as bus:
            program = self.moving(bus, "vanished")
            bus.process.kill()
            program.end()
            self.assert_no_score(program, "vanished", "'proleg drive' has ended with status 1: ")
        with Bus(self.scenario) as bus:
            program = self.moving(bus, "restarted")
            bus.say("off")
            bus.until("the supply of the robot is off")
            bus.say("on")
            program.end()
            self.assert_no_score(program, "restarted", "'proleg drive' has ended with status 1: |a module has restarted")
            self.assertEqual(bus.powered(), set())

    def assert_no_score(self, program, out, why):
        self.assertEqual(program.process.returncode, 1)
        self.assertTrue(any(re.search(f"trial_1 has no score: (?:{why})", line) for line in program.messages),
                        program.messages)
        self.assertEqual(self.made(out), [])

    # Bad input.

    def test_what_makes_no_sense_with_a_robot_is_refused_before_it_moves(self):
        adapt = self.adapting("none", self.simulated_bus())
        self.assertIn("--damage: found an option for simulated worlds", self.refused(*adapt, "--damage", "jammed:J3"))
        self.assertIn("--friction", self.refused(*adapt, "--friction", 0.3))
        self.assertIn("--set: found a change during the run", self.refused(*adapt, "--set", "amplitude=3@10"))
        recording = self.refused(*adapt, "--score", "recording")
        self.assertIn("distance", recording)
        self.assertIn("electrical_energy, mean_current, duty_factor, lifted_links", recording)
        self.assertIn("--score: found 'guess', expected ask or recording", self.refused(*adapt, "--score", "guess"))
        self.assertIn("--score-command: found 'none.py'", self.refused(*adapt, "--score-command", "none.py"))
        self.assertIn("--score-command", self.refused(*adapt, "--score-command", self.scenario))
        self.assertIn("--score-timeout", self.refused(*adapt, "--score-timeout", 3))
        self.assertIn("--score-timeout", self.refused(*adapt, "--score-command", self.simulates, "--score-timeout", "nan"))
        without_bus = [word for word in adapt if word not in ("--bus", self.simulated_bus())]
        self.assertIn("--score: found an option for the trials of a robot, expected --bus BUS",
                      self.refused(*without_bus, "--score", "ask"))
        adapt[1] = SOURCE / "sim" / "scenarios" / "long_chain" / "twenty.simulation.xml"
        self.assertIn("expected 5 joints as in the atlas", self.refused(*adapt))
        self.assertFalse((self.folder / "none").exists())

        search = ["optimise", self.folder / "wave" / "cma_es.optimise.xml", "--out", self.folder / "none"]
        for option in (["--workers", 2], ["--engine", "reduced"], ["--estimate"]):
            self.assertIn(f"{option[0]}: found an option for simulated trials beside --bus",
                          self.refused(*search, "--bus", self.simulated_bus(), *option))
        self.assertIn("--score: found an option for the trials of a robot", self.refused(*search, "--score", "ask"))
        two_measures = ["optimise", self.folder / "wave" / "gait_map.optimise.xml", "--out", self.folder / "none", "--bus",
                        self.simulated_bus()]
        self.assertIn("--bus: found distance, height to be measured in a trial", self.refused(*two_measures))
        self.assertFalse((self.folder / "none").exists())

    def test_a_wrong_bus_is_refused_before_anything_is_written(self):
        nowhere = self.folder / "nowhere.simulation.xml"
        search = ["optimise", self.folder / "wave" / "cma_es.optimise.xml", "--out", self.folder / "none"]
        for bus, found in (("", "bus: found ''"), ("sim:", "bus: found 'sim:'"), ("/dev/null", "bus: found '/dev/null'"),
                           ("tcp:nowhere", "bus: found 'tcp:nowhere'"), (f"sim:{nowhere}", str(nowhere))):
            with self.subTest(bus):
                self.assertIn(found, self.refused(*self.adapting("none", bus)))
                self.assertIn(found, self.refused(*search, "--bus", bus))
        self.assertFalse((self.folder / "none").exists())

    def test_trials_of_another_simulated_robot_are_not_continued(self):
        other = self.folder / "wave" / "other.simulation.xml"
        other.write_text(self.scenario.read_text())
        command = self.adapting("one_robot", self.simulated_bus(), "--score-command", self.simulates, trials=1)
        made = self.proleg(*command)
        self.assertEqual(made.returncode, 0, made.stderr)
        searched = self.proleg(*self.searching("one_searched", "--score-command", self.simulates, evaluations=2))
        self.assertEqual(searched.returncode, 0, searched.stderr)
        for bus in (f"sim:{other}", "can0"):
            with self.subTest(bus):
                adapt = self.adapting("one_robot", bus, "--resume", self.folder / "one_robot")
                self.assertIn("found trials of another atlas, scenario or program, or with other options", self.refused(*adapt))
                search = self.searching("one_searched", "--resume", self.folder / "one_searched")
                search[search.index("--bus") + 1] = bus
                self.assertIn("differences: simulated robot", self.refused(*search))

    # proleg optimise.

    def searching(self, out, *options, method="cma_es", evaluations=3):
        return ["optimise", self.folder / "wave" / f"{method}.optimise.xml", "--bus", self.simulated_bus(), "--evaluations",
                evaluations, "--out", self.folder / out, *options]

    def test_a_search_gets_the_scores_of_the_robot_and_continues(self):
        for method in ("cma_es", "great_deluge"):
            with self.subTest(method):
                command = self.searching(method, "--score-command", self.simulates, method=method)
                made = self.proleg(*command, "--json")
                self.assertEqual(made.returncode, 0, made.stderr)
                result = json.loads(made.stdout)
                self.assertEqual((result["engine"], result["evaluations"], result["simulated"]), ("robot", 3, 3))
                for name in ("learning_curve.svg", "best.tsv", "store.sqlite"):
                    self.assertTrue((self.folder / method / name).exists())
                best = json.loads(self.proleg("simulate", self.folder / method / "best.simulation.xml", "--json").stdout)
                self.assertEqual(best["measures"]["distance"], result["best_score"])
                recordings = {path.stem for path in (self.folder / method / "trials").glob("*.proleg")}
                self.assertEqual(recordings, {f"evaluation_{i}" for i in range(3)})  # none that was only expected
        rest = json.loads(self.proleg(*self.searching("cma_es", "--resume", self.folder / "cma_es", "--score-command",
                                                      self.simulates, evaluations=4), "--json").stdout)
        self.assertEqual((rest["restored"], rest["simulated"]), (3, 1))
        whole = self.proleg("optimise", self.folder / "wave" / "cma_es.optimise.xml", "--evaluations", 4, "--out",
                            self.folder / "in_ode", "--json")
        self.assertEqual(json.loads(whole.stdout)["best_score"], rest["best_score"])
        self.assertIn("differences: engine", self.refused("optimise", self.folder / "wave" / "cma_es.optimise.xml",
                                                          "--resume", self.folder / "cma_es"))
        self.assertIn("found the trials of a robot, expected --bus BUS",
                      self.refused("optimise", "--resume", self.folder / "cma_es"))
        self.assertIn("found simulated trials, expected no --bus",
                      self.refused("optimise", "--resume", self.folder / "in_ode", "--bus", self.simulated_bus()))

    def test_the_recording_has_measures_of_the_modules(self):
        search = self.folder / "wave" / "current.optimise.xml"
        search.write_text((WAVE / "cma_es.optimise.xml").read_text().replace(
            '<objective measure="distance"/>', '<objective measure="mean_current" goal="minimise" failed="1000"/>'))
        made = self.proleg(*self.searching("current", "--score", "recording", "--json", method="current", evaluations=2))
        self.assertEqual(made.returncode, 0, made.stderr)
        with sqlite3.connect(self.folder / "current" / "store.sqlite") as store:
            rows = store.execute("SELECT mean_current, stride_frequency, duty_factor FROM evaluation ORDER BY number").fetchall()
        scores = [row[0] for row in rows]
        for number, (score, frequency, duty_factor) in enumerate(rows):
            with sqlite3.connect(self.folder / "current" / "trials" / f"evaluation_{number}.proleg") as recording:
                currents = [row[0] for row in recording.execute("SELECT servo_current_ma FROM sample")]
            self.assertGreater(score, 10)
            self.assertAlmostEqual(score, statistics.fmean(currents), delta=1e-6 * score)
            trial = self.folder / "current" / "trials" / f"evaluation_{number}.simulation.xml"
            simulated = json.loads(self.proleg("simulate", trial, "--json").stdout)["measures"]
            self.assertAlmostEqual(frequency, simulated["stride_frequency"], delta=1e-6)
            self.assertAlmostEqual(duty_factor, simulated["duty_factor"], delta=0.1)
        self.assertEqual(json.loads(made.stdout)["best_score"], min(scores))

    def test_a_search_ends_with_its_trial(self):
        failed = self.proleg(*self.searching("without_camera", "--score-command", "/bin/false", "--json"))
        self.assertEqual(failed.returncode, 1, failed.stderr)
        self.assertIn("ended before the first evaluation, because evaluation_0 has no score: /bin/false of", failed.stderr)
        result = json.loads(failed.stdout)
        self.assertEqual((result["ended"], result["evaluations"], result["best_score"]), ("failed", 0, None))
        self.assertIn("evaluation_0 has no score: /bin/false of", result["reason"])
        self.assertIn("continue with: proleg optimise", failed.stderr)
        self.assertIn("--score-command /bin/false", failed.stderr)
        typed = self.proleg(*self.searching("asked", evaluations=4), input="1\n2\n")
        self.assertEqual(typed.returncode, 1, typed.stderr)
        self.assertIn("interrupted after 2 evaluations; continue with: ", typed.stderr)
        rest = self.proleg(*self.searching("asked", "--resume", self.folder / "asked", "--json", evaluations=4),
                           input="4\n3\n")
        self.assertEqual(rest.returncode, 0, rest.stderr)
        self.assertEqual(json.loads(rest.stdout)["best_score"], 4)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])

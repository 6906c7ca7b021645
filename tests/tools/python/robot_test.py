"""A robot that Python drives, against 'proleg bus': what it does, what it refuses, and that its servos lose their power in the end.

    robot_test.py PROGRAM_FOLDER
"""

import copy
import os
import pickle
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy as np
import proleg

PROGRAMS = Path(sys.argv.pop(1))
LONGEST = 600  # s; everything takes seconds


class Bus:
    """'proleg bus', which says which joints have power."""

    def __init__(self, scenario="caterpillar", *options):
        self.process = subprocess.Popen([PROGRAMS / "proleg-bus", scenario, "--tcp", "0", "--verbose", *options], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        found = re.search(r"--bus (tcp:\S+)", line)
        if not found:
            raise AssertionError(f"proleg bus printed {line!r} {self.process.stderr.read()!r}")
        self.address = found.group(1)
        self.lines = []
        self.changed = threading.Condition()
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        for line in self.process.stderr:
            with self.changed:
                self.lines.append(line)
                self.changed.notify_all()

    def powered(self):
        """Names of the joints whose servos have power."""
        joints = {}
        for line in list(self.lines):
            if found := re.match(r"proleg bus: (\S+) has (no )?power", line):
                joints[found.group(1)] = not found.group(2)
        return sorted(joint for joint, has_power in joints.items() if has_power)

    def wait_for_power(self, joints):
        with self.changed:
            if not self.changed.wait_for(lambda: self.powered() == joints, timeout=LONGEST):
                raise AssertionError(f"{self.powered()} have power, expected {joints}: {self.lines}")

    def vanish(self):
        self.process.kill()
        self.process.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        self.process.wait(LONGEST)
        self.reader.join()
        for stream in (self.process.stdin, self.process.stdout, self.process.stderr):
            stream.close()


ALL = ["J1", "J2", "J3", "J4", "J5"]


class ARobot(unittest.TestCase):
    def test_moves_as_its_scenario_says(self):
        """Its set-points are those of simulate(), and the measured angles follow them."""
        scenario = proleg.Scenario("caterpillar")
        scenario.at(1.0)["amplitude"] = 25
        with Bus() as bus:
            with proleg.Robot(bus.address, scenario, record=f"{bus.process.pid}.proleg") as robot:
                self.assertEqual([(module.node, module.drive) for module in robot.modules], [(node, "no power") for node in range(1, 6)])
                self.assertEqual(bus.powered(), [])
                motions = [robot.run(1.5), robot.run(0.5)]
                self.assertEqual(bus.powered(), ALL)
            bus.wait_for_power([])
        run = proleg.simulate(scenario, 2)
        self.assertEqual(motions[1].setpoint_hash, run.setpoint_hash)
        np.testing.assert_array_equal(np.concatenate([motion.raw_setpoints for motion in motions]), run.raw_setpoints)
        np.testing.assert_allclose(np.concatenate([motion.times for motion in motions]), run.times)
        self.assertEqual([(motion.differences, motion.missing) for motion in motions], [(0, 0), (0, 0)])
        measured = np.concatenate([motion.angles for motion in motions])
        self.assertGreater(np.isfinite(measured).mean(), 0.05)
        late = measured[50:] - run.setpoints[50:]
        self.assertLess(np.nanmax(np.abs(late)), 20)  # a servo lags behind; a joint of another robot is 60 degrees off
        currents = np.concatenate([motion.currents for motion in motions])
        self.assertTrue(np.nanmax(currents) > 0)
        recording = proleg.open(f"{bus.process.pid}.proleg")
        self.assertTrue(recording.finished)
        self.assertEqual(recording.results["differences"], "0")
        np.testing.assert_array_equal(recording.columns()["setpoint_deg.J5"][:200].round(3), run.setpoints[:, 0].round(3))

    def test_is_changed_while_it_moves(self):
        with Bus() as bus, proleg.Robot(bus.address, "caterpillar") as robot:
            robot["amplitude"] = 10
            robot["amplitude", "J1"] = 5
            first = robot.run(2)
            np.testing.assert_allclose(np.abs(first.setpoints).max(axis=0), [10, 10, 10, 10, 5], atol=0.1)
            robot["amplitude"] = 20
            np.testing.assert_array_equal(robot["amplitude"], [20] * 5)
            robot.run(2)
            np.testing.assert_allclose(np.abs(robot.run(2).setpoints).max(axis=0), [20] * 5, atol=0.1)
            for what, action in {
                "an unknown parameter": lambda: robot.__setitem__("amplitud", 3),
                "a value": lambda: robot.__setitem__("amplitude", 1000),
                "a text": lambda: robot.__setitem__("amplitude", "20"),
                "no time": lambda: robot.run(0),
                "too long": lambda: robot.run(1e9),
                "a look at the modules": lambda: robot.modules,
            }.items():
                with self.subTest(what), self.assertRaises(proleg.InputError):
                    action()
            self.assertEqual(bus.powered(), ALL)
            robot.stop()
            bus.wait_for_power([])
            with self.assertRaisesRegex(proleg.InputError, "stopped"):
                robot.run(1)
            robot.stop()


class ThePower(unittest.TestCase):
    """It is off in the end, however the program ends; the bus says so."""

    def run_program(self, bus, text, status):
        program = f"import os, signal, sys, proleg\nrobot = proleg.Robot({bus.address!r}, 'caterpillar')\nrobot.run(1)\n{text}"
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False, timeout=LONGEST)
        self.assertEqual(done.returncode, status, done.stderr)
        bus.wait_for_power([])
        self.assertEqual(len([line for line in bus.lines if re.search(r"\S+ has power", line)]), 5)
        return done.stderr

    def test_at_the_end_of_python(self):
        for text, status in (("", 0), ("sys.exit(3)", 3), ("del robot", 0), ("robot.itself = robot; del robot", 0)):
            with self.subTest(text), Bus() as bus:
                self.run_program(bus, text, status)

    def test_after_an_exception(self):
        with Bus() as bus:
            self.assertIn("ZeroDivisionError", self.run_program(bus, "with robot: 1 / 0", 1))

    def test_after_ctrl_c_in_a_run(self):
        with Bus() as bus:
            text = ("import threading\nthreading.Timer(0.5, signal.raise_signal, [signal.SIGINT]).start()\n"
                    "with robot: robot.run(1000)")
            self.assertIn("KeyboardInterrupt", self.run_program(bus, text, -signal.SIGINT))

    def test_although_a_child_was_forked(self):
        with Bus() as bus:
            self.run_program(bus, """if True:
                child = os.fork()
                if child == 0:
                    try:
                        robot.run(1)
                        os._exit(1)
                    except proleg.InputError as error:
                        assert "forked" in str(error), error
                    robot.stop()
                    del robot
                    sys.exit(5)
                assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 5
                robot.run(1)""", 0)

    def test_of_a_killed_program_is_taken_by_the_next_one(self):
        """The modules hold their joints by themselves (docs/safety.md)."""
        with Bus() as bus:
            program = f"import os, signal, proleg\nrobot = proleg.Robot({bus.address!r}, 'caterpillar')\nrobot.run(1)\nos.kill(os.getpid(), signal.SIGKILL)"
            self.assertEqual(subprocess.run([sys.executable, "-c", program], check=False).returncode, -signal.SIGKILL)
            self.assertEqual(bus.powered(), ALL)
            with proleg.Robot(bus.address, "caterpillar") as robot:
                self.assertEqual(robot.run(0.5).differences, 0)
            bus.wait_for_power([])


class AnIdleProgram(unittest.TestCase):
    """It leaves no robot moving: its servos lose their power without a call of the program."""

    def test_that_waits_or_computes_loses_its_robot(self):
        hogging = "import ctypes; ctypes.PyDLL(None).sleep(10)"  # it keeps the lock of the interpreter
        for what, hang in {"waits": lambda bus: bus.wait_for_power([]), "keeps the interpreter": lambda bus: exec(hogging)}.items():
            with self.subTest(what), Bus() as bus, proleg.Robot(bus.address, "caterpillar") as robot:
                robot.run(0.5)
                self.assertEqual(bus.powered(), ALL)
                hang(bus)
                bus.wait_for_power([])
                with self.assertRaisesRegex(proleg.RunError, "idle: found no call of the program for 0.4 s.*idle=SECONDS"):
                    robot.run(0.1)
                with self.assertRaisesRegex(proleg.RunError, "idle"):
                    robot["amplitude"] = 3

    def test_after_an_interrupted_run_too(self):
        with Bus() as bus, proleg.Robot(bus.address, "caterpillar") as robot:
            robot.run(0.5)
            threading.Timer(0.5, signal.raise_signal, [signal.SIGINT]).start()
            with self.assertRaises(KeyboardInterrupt):
                robot.run(1000)
            bus.wait_for_power([])

    def test_that_thinks_between_its_calls_keeps_it(self):
        """No tick is left out, and calls of any kind count."""
        with Bus() as bus, proleg.Robot(bus.address, "caterpillar") as robot:
            motions = []
            for _ in range(8):
                motions.append(robot.run(0.1))
                time.sleep(0.3)
                robot["amplitude"] = 20
                time.sleep(0.3)
            self.assertEqual(bus.powered(), ALL)
            np.testing.assert_allclose(np.concatenate([motion.times for motion in motions]), np.arange(1, 81) / 100)

    def test_has_the_limit_that_it_sets(self):
        for idle in (3, None):
            with self.subTest(idle), Bus() as bus, proleg.Robot(bus.address, "caterpillar", idle=idle) as robot:
                robot.run(0.5)
                time.sleep(2.5)
                self.assertEqual(robot.run(2).missing, 0)
                self.assertEqual(bus.powered(), ALL)
        for idle in (0, 0.05, 1e9, float("nan"), "1", True, np.timedelta64(1, "s")):
            with self.subTest(idle), self.assertRaisesRegex(proleg.InputError, "idle: found"):
                proleg.Robot("tcp:127.0.0.1:1", "caterpillar", idle=idle)


class AnotherThread(unittest.TestCase):
    def test_gets_an_input_error_meanwhile(self):
        with Bus() as bus, proleg.Robot(bus.address, "caterpillar") as robot:
            outcomes = []
            first = threading.Thread(target=lambda: outcomes.append(robot.run(3)))
            robot.run(0.5)
            first.start()
            time.sleep(0.5)
            for action in (lambda: robot.run(1), lambda: robot.__setitem__("amplitude", 20), lambda: robot.modules):
                with self.assertRaisesRegex(proleg.InputError, "Robot: found a call while another thread makes one, expected one thread at a time"):
                    action()
            first.join()
            self.assertEqual(len(outcomes[0].times), 300)
            self.assertEqual(robot["amplitude", "J1"], 40)
            robot.run(0.1)

    def test_may_stop_it(self):
        with Bus() as bus:
            robot = proleg.Robot(bus.address, "caterpillar")
            robot.run(0.5)
            stopper = threading.Timer(0.5, robot.stop)
            stopper.start()
            with self.assertRaisesRegex(proleg.RunError, "does not move any more"):
                robot.run(1000)
            stopper.join()
            bus.wait_for_power([])

    def test_of_a_program_that_ends_does_not_keep_its_power(self):
        with Bus() as bus:
            program = (f"import threading, time, proleg\nrobot = proleg.Robot({bus.address!r}, 'caterpillar')\nrobot.run(0.5)\n"
                       "threading.Thread(target=robot.run, args=[1000], daemon=True).start()\ntime.sleep(0.5)")
            done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False, timeout=LONGEST)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertNotIn("Traceback", done.stderr)
            bus.wait_for_power([])

    def test_is_no_copy(self):
        with Bus() as bus, proleg.Robot(bus.address, "caterpillar") as robot:
            for given in (robot, robot._robot):
                for action in (copy.copy, copy.deepcopy, pickle.dumps, lambda it: pickle.dumps(it, 0)):
                    with self.assertRaisesRegex(TypeError, "expected a new"):
                        action(given)


class WhatCannotBeDriven(unittest.TestCase):
    def test_is_a_robot_of_another_scenario(self):
        with Bus() as bus, proleg.Robot(bus.address, proleg.snake(8)) as robot:
            with self.assertRaises(proleg.RunError) as caught:
                robot.run(1)
            command = subprocess.run([PROGRAMS / "proleg-drive", proleg.snake(8).save(f"{os.getpid()}.simulation.xml"), "--bus", bus.address],
                                     capture_output=True, text=True, check=False)
            self.assertEqual(command.returncode, 1)
            self.assertIn(str(caught.exception).split(";")[0], command.stderr)
            self.assertEqual(bus.powered(), [])

    def test_is_driven_by_another_host(self):
        with Bus() as bus, proleg.Robot(bus.address, "caterpillar") as first:
            first.run(0.5)
            with proleg.Robot(bus.address, "caterpillar") as second, self.assertRaisesRegex(proleg.RunError, "host"):
                second.run(1)
            self.assertEqual(first.run(3).differences, 0)
            self.assertEqual(bus.powered(), ALL)

    def test_is_a_bus_that_vanishes(self):
        with Bus() as bus:
            robot = proleg.Robot(bus.address, "caterpillar")
            robot.run(0.5)
            threading.Timer(0.5, bus.vanish).start()
            with self.assertRaises(proleg.RunError):
                robot.run(1000)
            with self.assertRaisesRegex(proleg.RunError, "switch the robot off"):
                robot.stop()
            robot.stop()

    def test_is_refused_before_anything_is_sent(self):
        scenario = proleg.Scenario("caterpillar")
        moved = scenario.copy()
        moved.move(at=1, x=0, y=0, z=0)
        for what, arguments in {
            "an address": ("bluetooth:x:y:z", scenario),
            "no address": (3, scenario),
            "another place": ("tcp:127.0.0.1:1", scenario.replace(at=(1, 0))),
            "another friction": ("tcp:127.0.0.1:1", scenario.replace(friction=0.1)),
            "a move": ("tcp:127.0.0.1:1", moved),
            "no scenario": ("tcp:127.0.0.1:1", "nothing"),
            "a file with a long name": ("sim:" + "x" * 300, scenario),
        }.items():
            with self.subTest(what), self.assertRaises(proleg.InputError):
                proleg.Robot(*arguments)
        with self.assertRaises(proleg.RunError):
            proleg.Robot("tcp:127.0.0.1:1", scenario)
        Path("mine.txt").write_text("mine")
        with self.assertRaises(proleg.InputError):
            proleg.Robot("tcp:127.0.0.1:1", scenario, record="mine.txt")
        self.assertEqual(Path("mine.txt").read_text(), "mine")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        program = unittest.main(exit=False)
        os.chdir("/")
    sys.exit(not program.result.wasSuccessful())

"""A run in Python is the run of the command line, to the last bit.

    run_test.py PROLEG CASES [SEED]     CASES random scenarios; 20 in the ordinary suite, 500 in the slow one
"""

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import unittest
from pathlib import Path

import numpy as np
import proleg

PROLEG, CASES = sys.argv[1], int(sys.argv[2])
SEED = int(sys.argv[3]) if len(sys.argv) > 3 else 1
del sys.argv[1:]

#: Scenarios that the reduced engine has, and one that it has not.
NAMES = ["caterpillar", "coupled", "hopf", "matsuoka", "serpentine", "turning", "adaptive_touch_level", "snake", "wall", "twenty_joints"]


def command_line(*words):
    done = subprocess.run([PROLEG, *words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return json.loads(done.stdout)


def random_case(chance):
    """A scenario in Python, and the words of `proleg simulate` for the same."""
    name = chance.choice(NAMES)
    engine = chance.choice(["ode", "ode", "reduced"]) if name in ("caterpillar", "coupled", "hopf", "matsuoka") else "ode"
    seed = chance.randrange(2**64)
    seconds = chance.choice([0.25, 0.5, 1.0])
    scenario = proleg.Scenario(name, engine=engine, seed=seed)
    words = ["simulate", name, "--engine", engine, "--seed", str(seed), "--seconds", str(seconds), "--json"]
    for parameter in chance.sample(scenario.parameters, min(3, len(scenario.parameters))):
        value = chance.uniform(parameter.minimum, parameter.maximum)
        key = f"{parameter.position}.{parameter.name}"
        joints = list(scenario._state.values(key)[0])
        target = (key, chance.choice(joints)) if chance.random() < 0.5 else key
        word = ":".join(target) if isinstance(target, tuple) else target
        if chance.random() < 0.3:
            scenario.at(0.1)[target] = value
            words += ["--set", f"{word}={value!r}@0.1s"]
        else:
            scenario[target] = value
            words += ["--set", f"{word}={value!r}"]
    return scenario, seconds, words


class ARun(unittest.TestCase):
    def test_gives_the_bits_of_the_command_line(self):
        chance = random.Random(SEED)
        for number in range(CASES):
            scenario, seconds, words = random_case(chance)
            with self.subTest(number=number, seed=SEED, words=" ".join(words)):
                printed = command_line(*words)
                run = proleg.simulate(scenario, seconds)
                for name in ("setpoint_hash", "servo_hash", "world_hash", "motion_hash"):
                    self.assertEqual(getattr(run, name), printed[name])
                self.assertEqual(run.displacement, printed["displacement_m"])
                for name, value in printed["measures"].items():
                    self.assertEqual(None if np.isnan(run.measures[name]) else run.measures[name], value, name)

    def test_is_a_key_of_a_dict(self):
        """And so are a recording and what else has arrays; two of them are the same only if they are one object."""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "one.proleg"
            one, other = (proleg.simulate("caterpillar", 0.05, engine="reduced", record=file) for _ in range(2))
            self.assertEqual(({one: 1, other: 2}[other], len({one, other, one}), one == other), (2, 2, False))
            recording = proleg.open(file)
            self.assertEqual(len({recording, recording, proleg.open(file)}), 2)

    def test_has_a_row_for_each_tick(self):
        run = proleg.simulate("caterpillar", 0.5, engine="reduced")
        self.assertEqual(run.times.shape, (50,))
        self.assertAlmostEqual(run.times[-1], 0.5)
        for name, shape in {"setpoints": (50, 5), "raw_setpoints": (50, 5), "angles": (50, 5), "torques": (50, 5), "currents": (50, 5),
                            "contacts": (50, 6), "contact_forces": (50, 6), "positions": (50, 6, 3),
                            "orientations": (50, 6, 4)}.items():
            self.assertEqual(getattr(run, name).shape, shape, name)
        np.testing.assert_allclose(np.linalg.norm(run.orientations, axis=2), 1)
        with self.assertRaises(ValueError):
            run.angles[0, 0] = 1

    def test_keeps_what_it_is_asked_for(self):
        run = proleg.simulate("caterpillar", 0.1, engine="reduced", keep=["angles"])
        self.assertEqual((run.angles.shape, run.positions.shape), ((10, 5), (0,)))
        self.assertEqual(proleg.simulate("caterpillar", 0.1, engine="reduced", keep=()).angles.shape, (0,))

    def test_gives_what_its_recording_gives(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "run.proleg"
            scenario = proleg.Scenario("adaptive_touch")
            run = proleg.simulate(scenario, 0.5, record=file)
            recording = proleg.open(file)
            self.assertTrue(recording.finished)
            self.assertEqual(recording.results["setpoint_hash"], run.setpoint_hash)
            columns = recording.columns()
            for i, joint in enumerate(scenario.joints):
                np.testing.assert_array_equal(columns[f"current_mA.{joint}"], run.currents[:, i])
                np.testing.assert_allclose(columns[f"setpoint_deg.{joint}"], run.setpoints[:, i], atol=1e-7)
                np.testing.assert_allclose(columns[f"angle_deg.{joint}"], run.angles[:, i], rtol=1e-14)
            for i, link in enumerate(scenario.links):
                np.testing.assert_array_equal(columns[f"x_m.{link}"], run.positions[:, i, 0])
                np.testing.assert_array_equal(columns[f"contact_rear.{link}"], run.contacts[:, i] & 1)
            self.assertEqual(len(columns["tick"]), 50)
            subprocess.run([PROLEG, "replay", str(file)], check=True, capture_output=True)

    def test_loses_the_frames_of_the_command_line(self):
        printed = command_line("simulate", "coupled", "--seconds", "1", "--losses", "7:5%", "--json")
        run = proleg.simulate("coupled", 1, losses="7:5%")
        self.assertEqual((run.setpoint_hash, run.lost_frames), (printed["setpoint_hash"], printed["lost_frames"]))

    def test_does_not_see_changes_of_its_scenario(self):
        scenario = proleg.Scenario("caterpillar", engine="reduced")
        runs = []
        thread = threading.Thread(target=lambda: runs.append(proleg.simulate(scenario, 20)))
        thread.start()
        for amplitude in range(80):
            scenario["amplitude"] = amplitude
        thread.join()
        # Whatever values it began with, it kept them to its end.
        self.assertEqual(proleg.simulate(runs[0].scenario).world_hash, runs[0].world_hash)

    def test_in_many_threads_is_the_same(self):
        """Worlds of ODE's iterative solver share the random generator of the engine."""
        for name in ("caterpillar", "twenty_joints"):
            expected = proleg.simulate(name, 0.3, engine="ode")
            runs = []
            threads = [threading.Thread(target=lambda: runs.append(proleg.simulate(name, 0.3, engine="ode"))) for _ in range(4)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual({run.displacement for run in runs}, {expected.displacement}, name)

    def test_goes_on_in_a_child_that_was_forked_during_another(self):
        thread = threading.Thread(target=lambda: proleg.simulate("twenty_joints", 2, engine="ode", keep=()))
        thread.start()
        child = os.fork()
        if child == 0:
            try:
                signal.alarm(600)  # the test ends if the child waits for ever
                run = proleg.simulate("twenty_joints", 0.05, engine="ode", keep=())
                os._exit(0 if run.duration > 0 else 1)
            finally:
                os._exit(1)
        _, status = os.waitpid(child, 0)
        thread.join()
        self.assertEqual(status, 0)

    def test_ends_with_a_signal(self):
        program = ("import proleg, sys\n"
                   "try:\n"
                   "    print('begins', flush=True)\n"
                   "    CALL\n"
                   "except KeyboardInterrupt:\n"
                   "    print('interrupted')\n")
        for call in ("proleg.simulate('caterpillar', 86400, keep=())",
                     "proleg.evaluate('caterpillar', ['amplitude'], [[30]] * 4000, engine='reduced', workers=2)"):
            with self.subTest(call):
                child = subprocess.Popen([sys.executable, "-c", program.replace("CALL", call)], stdout=subprocess.PIPE, text=True)
                self.assertEqual(child.stdout.readline(), "begins\n")
                child.send_signal(signal.SIGINT)
                self.assertEqual(child.communicate(timeout=600)[0], "interrupted\n")

    def test_refuses_what_cannot_be_used(self):
        scenario = proleg.Scenario("caterpillar")
        late = scenario.copy()
        late.at(5.0)["amplitude"] = 10
        with tempfile.TemporaryDirectory() as folder:
            other = Path(folder) / "notes.txt"
            other.write_text("mine")
            for what, action in {
                "no scenario": lambda: proleg.simulate(3),
                "a duration": lambda: proleg.simulate(scenario, float("nan")),
                "a change after the end": lambda: proleg.simulate(late, 1),
                "a series": lambda: proleg.simulate(scenario, 0.1, keep=["angels"]),
                "losses": lambda: proleg.simulate(scenario, 0.1, losses="often"),
                "a folder for a recording": lambda: proleg.simulate(scenario, 0.1, record=folder),
                "another file for a recording": lambda: proleg.simulate(scenario, 0.1, record=other),
                "a robot that the engine does not have": lambda: proleg.simulate("mesh_world", 0.1, engine="reduced"),
                "more numbers than fit": lambda: proleg.simulate("sixty_joints", 86400),
                "no recording": lambda: proleg.open(other),
                "a missing recording": lambda: proleg.open("/no/such"),
            }.items():
                with self.subTest(what), self.assertRaises(proleg.Error) as caught:
                    action()
                self.assertNotIn("\n", str(caught.exception))
            self.assertEqual(other.read_text(), "mine")


if __name__ == "__main__":
    unittest.main()

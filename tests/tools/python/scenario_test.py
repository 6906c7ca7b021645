"""Scenarios in Python: values are those of the files and of --set, and what cannot be used raises InputError."""

import copy
import os
import pickle
import tempfile
import unittest
from pathlib import Path

import numpy as np
import proleg


class ValuesOfAScenario(unittest.TestCase):
    def setUp(self):
        self.scenario = proleg.Scenario("caterpillar")

    def test_are_those_of_the_files(self):
        self.assertEqual(self.scenario["amplitude"].tolist(), [40.0] * 5)
        self.assertEqual(self.scenario["frequency", "J1"], 1.0)
        self.assertEqual(self.scenario["frequency:J1"].tolist(), [1.0])

    def test_change_for_all_joints_or_for_one(self):
        self.scenario["amplitude"] = 30
        self.scenario["amplitude", "J3"] = np.float32(20.5)
        self.assertEqual(self.scenario["amplitude"].tolist(), [30, 30, 20.5, 30, 30])
        self.scenario["amplitude"] = [1, 2, 3, 4, 5]
        self.assertEqual(self.scenario["amplitude"].tolist(), [1, 2, 3, 4, 5])

    def test_change_all_or_none(self):
        with self.assertRaises(proleg.InputError):
            self.scenario["amplitude"] = [1, 2, 3, 4, 500]
        self.assertEqual(self.scenario["amplitude"].tolist(), [40.0] * 5)

    def test_are_a_mapping_of_names(self):
        self.assertEqual(list(self.scenario), ["amplitude", "frequency", "phase_difference", "phase", "offset"])
        self.assertIn("amplitude", self.scenario)
        self.assertNotIn("amplitud", self.scenario)
        self.assertEqual((self.scenario.get("amplitud", 5), self.scenario.get("amplitud"), self.scenario.get(3, 4)), (5, None, 4))
        self.assertEqual(self.scenario.get("amplitude").tolist(), [40.0] * 5)
        self.assertEqual({parameter.unit for parameter in self.scenario.parameters}, {"deg", "Hz"})

    def test_are_rounded_to_the_numbers_of_the_core(self):
        self.scenario["amplitude"] = 0.1
        self.assertAlmostEqual(self.scenario["amplitude", "J1"], 0.1, delta=90 / 2**30)

    def test_of_a_copy_are_its_own(self):
        for other in (self.scenario.copy(), copy.copy(self.scenario), copy.deepcopy(self.scenario)):
            other["amplitude"] = 10
        self.assertEqual(self.scenario["amplitude", "J1"], 40.0)

    def test_survive_a_pickle(self):
        self.scenario["amplitude", "J2"] = 12
        self.scenario.at(1.0)["frequency"] = 2
        self.scenario.move(0.5, x=0.1, y=0, z=0.1)
        self.scenario.duration = 2
        self.scenario.engine = "reduced"
        other = pickle.loads(pickle.dumps(self.scenario))
        self.assertEqual(proleg.simulate(other).world_hash, proleg.simulate(self.scenario).world_hash)

    def test_of_several_algorithms_have_the_position_in_their_name(self):
        scenario = proleg.Scenario("adaptive_touch")
        self.assertTrue(all(name in scenario for name in scenario))
        self.assertGreater(len({parameter.position for parameter in scenario.parameters}), 1)


class AScenario(unittest.TestCase):
    def test_of_every_shipped_name_can_be_read(self):
        for name in proleg.shipped():
            with self.subTest(name):
                self.assertGreaterEqual(len(proleg.Scenario(name).joints), 1)

    def test_can_be_made_without_files(self):
        self.assertEqual(len(proleg.caterpillar(7).joints), 7)
        self.assertEqual(len(proleg.snake().joints), 8)
        self.assertEqual(len(proleg.caterpillar(3, axes="pyp").joints), 3)

    def test_has_what_its_options_say(self):
        scenario = proleg.Scenario("caterpillar", engine="reduced", seed=2**64 - 1, friction=0.5, at=(1, 2), heading=90)
        self.assertEqual((scenario.engine, scenario.seed), ("reduced", 2**64 - 1))
        positions = proleg.simulate(scenario, seconds=0.01).positions
        self.assertAlmostEqual(positions[0, 0, 0], 1, delta=0.5)
        self.assertEqual(scenario.replace(engine="ode").seed, 2**64 - 1)

    def test_reads_the_files_of_a_user(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, contents in proleg.caterpillar(4).files.items():
                (Path(folder) / name).parent.mkdir(parents=True, exist_ok=True)
                (Path(folder) / name).write_text(contents)
            top = next(Path(folder).glob("*.simulation.xml"))
            self.assertEqual(len(proleg.Scenario(top).joints), 4)
            text = top.read_text().replace("<robot>", "<robt>")
            top.write_text(text)
            with self.assertRaisesRegex(proleg.InputError, rf"{top.name}:\d+: found .*, expected"):
                proleg.Scenario(top)

    def test_can_be_saved_for_the_command_line(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("caterpillar", "y1", "adaptive_touch"):
                scenario = proleg.Scenario(name)
                first = next(iter(scenario))
                scenario[first] = scenario[first] * 0.5
                scenario.duration = 0.1
                file = scenario.save(Path(folder) / f"{name} 1.simulation.xml")
                read = proleg.Scenario(file)
                self.assertEqual(proleg.simulate(read).setpoint_hash, proleg.simulate(scenario).setpoint_hash)
                self.assertEqual(proleg.simulate(read).displacement, proleg.simulate(scenario).displacement)
                with self.assertRaisesRegex(proleg.InputError, "found a file, expected a new name"):
                    scenario.save(file)
                scenario.save(file, replace=True)
                with self.assertRaises(proleg.InputError):
                    scenario.save(Path(folder) / "name")
            made = proleg.snake()
            self.assertEqual(len(proleg.Scenario(made.save(Path(folder) / "snake.simulation.xml")).joints), 8)
            made.at(1.0)["1.amplitude"] = 3
            with self.assertRaisesRegex(proleg.InputError, "a change while the robot moves"):
                made.save(Path(folder) / "late.simulation.xml")
            with self.assertRaises(proleg.FileError):
                proleg.snake().save("/proc/no/snake.simulation.xml")

    def test_refuses_what_cannot_be_used(self):
        scenario = proleg.Scenario("caterpillar")

        def assign(key, value):
            scenario[key] = value

        for what, action in {
            "a name": lambda: proleg.Scenario("no_such"),
            "a folder": lambda: proleg.Scenario("/tmp"),
            "a file": lambda: proleg.Scenario("/no/such.simulation.xml"),
            "a null byte": lambda: proleg.Scenario("a\0b"),
            "no text": lambda: proleg.Scenario(3),
            "an engine": lambda: proleg.Scenario("caterpillar", engine="bullet"),
            "a seed below 0": lambda: proleg.Scenario("caterpillar", seed=-1),
            "a seed of 65 bits": lambda: proleg.Scenario("caterpillar", seed=2**64),
            "a seed that is no whole number": lambda: proleg.Scenario("caterpillar", seed=1.5),
            "a friction": lambda: proleg.Scenario("caterpillar", friction=float("nan")),
            "a place": lambda: proleg.Scenario("caterpillar", at=(1,)),
            "a parameter": lambda: assign("amplitud", 1),
            "a joint": lambda: assign(("amplitude", "J9"), 1),
            "a key": lambda: assign(3, 1),
            "a value above its range": lambda: assign("amplitude", 91),
            "nan": lambda: assign("amplitude", float("nan")),
            "infinity": lambda: assign("amplitude", float("inf")),
            "a text for a number": lambda: assign("amplitude", "30"),
            "a truth value": lambda: assign("amplitude", True),
            "a complex number": lambda: assign("amplitude", 1j),
            "a huge number": lambda: assign("amplitude", 10**400),
            "a mask": lambda: assign("amplitude", np.ma.array([1, 2, 3, 4, 5], mask=[0, 0, 1, 0, 0])),
            "a masked number": lambda: assign("amplitude", np.ma.masked),
            "a time for a number": lambda: assign("amplitude", np.timedelta64(3, "s")),
            "rows of different lengths": lambda: assign("amplitude", [[1], [2, 3]]),
            "values without an order": lambda: assign("amplitude", {1, 2, 3, 4, 5}),
            "a place without an order": lambda: proleg.Scenario("caterpillar", at={1, 2}),
            "a time as a duration": lambda: scenario.replace(seconds=np.timedelta64(1, "s")),
            "a time as a seed": lambda: proleg.Scenario("caterpillar", seed=np.timedelta64(1, "s")),
            "half a character": lambda: proleg.Scenario("\ud800"),
            "half a character in a place": lambda: scenario.save("\ud800.simulation.xml"),
            "half a character in a name": lambda: assign("\ud800", 1),
            "None": lambda: assign("amplitude", None),
            "too few values": lambda: assign("amplitude", [1, 2]),
            "a table": lambda: assign("amplitude", np.ones((5, 5))),
            "values for one joint": lambda: assign(("amplitude", "J1"), [1, 2, 3, 4, 5]),
            "a name with the sign of an option": lambda: assign("amplitude=3@4", 1),
            "a time": lambda: scenario.at(-1.0).__setitem__("amplitude", 1),
            "a duration": lambda: setattr(scenario, "duration", 0),
            "a long duration": lambda: setattr(scenario, "duration", 1e9),
            "joints": lambda: proleg.caterpillar(0),
            "many joints": lambda: proleg.caterpillar(65),
            "axes": lambda: proleg.caterpillar(5, axes="x"),
            "a damaged pickle": lambda: type(scenario._state).__new__(type(scenario._state)).__setstate__((1, 2)),
        }.items():
            with self.subTest(what), self.assertRaises(proleg.InputError) as caught:
                action()
            self.assertIn("found", str(caught.exception))
            self.assertNotIn("\n", str(caught.exception))
        self.assertEqual(scenario["amplitude"].tolist(), [40.0] * 5)
        self.assertTrue(issubclass(proleg.InputError, (proleg.Error, ValueError)))

    def test_is_found_from_any_folder(self):
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir("/")
        self.assertEqual(proleg.Scenario("caterpillar").joints, ["J5", "J4", "J3", "J2", "J1"])


if __name__ == "__main__":
    unittest.main()

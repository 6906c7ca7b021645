"""Worlds: the set-points of a run give its motion, to the last bit; what cannot be used raises InputError."""

import pickle
import threading
import unittest

import numpy as np
import proleg


def still_at_first(name, seconds, **options):
    """A scenario whose set-points begin at 0, as those of Worlds do."""
    scenario = proleg.Scenario(name, **options)
    if "noise" in scenario:
        scenario["noise"] = 0
    for key in [name for name in scenario if name.endswith("amplitude")]:
        scenario.at(0.05)[key] = scenario[key]
        scenario[key] = 0
    scenario.duration = seconds
    return scenario


class Motion(unittest.TestCase):
    def test_is_that_of_the_run_with_these_set_points(self):
        for name, engine in (("caterpillar", "reduced"), ("caterpillar", "ode"), ("twenty_joints", "ode")):
            with self.subTest(name, engine=engine):
                scenario = still_at_first(name, 1.5, engine=engine)
                run = proleg.simulate(scenario)
                worlds = proleg.Worlds(scenario, n=3 if engine == "reduced" else 1, engine=engine)
                names = worlds.observation_names
                observation = worlds.reset(seed=scenario.seed)
                joints = len(scenario.joints)
                front = names.index(f"contact_front.{scenario.links[0]}")
                forward = np.zeros(worlds.n)
                for tick, setpoints in enumerate(run.setpoints):
                    np.testing.assert_array_equal(observation[0, front:front + len(scenario.links)], run.contacts[tick] >> 1)
                    observation, reward, done, _ = worlds.step(setpoints)
                    np.testing.assert_array_equal(observation[0, :joints], run.angles[tick])
                    np.testing.assert_array_equal(observation[-1], observation[0])
                    np.testing.assert_array_equal(worlds.positions[0], run.positions[tick])
                    self.assertEqual(done.all(), tick + 1 == len(run.times))
                    forward += reward
                self.assertEqual(worlds.displacements[0], run.displacement)
                self.assertAlmostEqual(forward[0], run.measures["speed"] * 1.5, places=12)

    def test_begins_anew_after_reset(self):
        worlds = proleg.Worlds("caterpillar", n=4, seconds=0.3)

        def episode(seed):
            observations = [worlds.reset(seed=seed)]
            for tick in range(30):
                observations.append(worlds.step([30 * np.sin(tick / 5 + k) for k in range(5)])[0])
            return np.array(observations)

        np.testing.assert_array_equal(episode(1), episode(1))

    def test_stays_when_a_world_has_ended(self):
        worlds = proleg.Worlds("caterpillar", n=2, seconds=0.02)
        worlds.reset()
        worlds.step(np.zeros(5))
        done = worlds.step(np.zeros(5))[2]
        self.assertEqual(done.tolist(), [True, True])

    def test_takes_set_points_of_any_form(self):
        worlds = proleg.Worlds("caterpillar", n=3, seconds=1)
        rows = np.arange(15.0).reshape(3, 5)
        for form in (rows, rows.tolist(), np.asfortranarray(rows), rows.astype(">f8"), rows.astype(np.int16), np.repeat(rows, 2, axis=1)[:, ::2]):
            worlds.reset()
            observation = worlds.step(form)[0]
            if form is rows:
                expected = observation
            np.testing.assert_array_equal(observation, expected)


class WhatCannotBeUsed(unittest.TestCase):
    def test_raises_input_error(self):
        worlds = proleg.Worlds("caterpillar", n=2, seconds=1)
        with self.assertRaisesRegex(proleg.InputError, "reset"):
            worlds.step(np.zeros(5))
        worlds.reset()
        for what, action in {
            "too few joints": lambda: worlds.step(np.zeros((2, 4))),
            "too few worlds": lambda: worlds.step(np.zeros((1, 5))),
            "nan": lambda: worlds.step([[0, 0, 0, 0, float("nan")]] * 2),
            "infinity": lambda: worlds.step(np.full(5, np.inf)),
            "texts": lambda: worlds.step(["a"] * 5),
            "a mask": lambda: worlds.step(np.ma.array(np.zeros(5), mask=[0, 1, 0, 0, 0])),
            "masked worlds": lambda: worlds.step(list(np.ma.array(np.zeros((2, 5)), mask=np.eye(2, 5)))),
            "a mask at the start": lambda: worlds.reset(setpoints=np.ma.array(np.zeros(5), mask=[0, 1, 0, 0, 0])),
            "times": lambda: worlds.step(np.zeros(5, "timedelta64[s]")),
            "dates": lambda: worlds.step(np.zeros(5, "datetime64[s]")),
            "half of nan": lambda: worlds.step(np.full(5, np.nan, np.float16)),
            "a long number": lambda: worlds.step(np.full(5, np.longdouble("1e400"))),
            "a number of worlds that is a time": lambda: proleg.Worlds("caterpillar", n=np.timedelta64(1, "s")),
            "nothing": lambda: worlds.step(None),
            "ragged rows": lambda: worlds.step([[1], [1, 2]]),
            "a seed": lambda: worlds.reset(seed=-1),
            "a start": lambda: worlds.reset(setpoints=np.zeros(4)),
            "no worlds": lambda: proleg.Worlds("caterpillar", n=0),
            "too many worlds": lambda: proleg.Worlds("caterpillar", n=5000),
            "an engine": lambda: proleg.Worlds("caterpillar", engine="bullet"),
            "a robot that the engine does not have": lambda: proleg.Worlds("mesh_world").reset(),
        }.items():
            with self.subTest(what), self.assertRaises(proleg.InputError) as caught:
                action()
            self.assertIn("found", str(caught.exception))
        worlds.step(np.zeros(5))  # they can still be used

    def test_is_a_call_from_another_thread_meanwhile(self):
        worlds = proleg.Worlds("caterpillar", n=512, seconds=20)
        worlds.reset()
        outcomes = []

        def run():
            for _ in range(40):
                try:
                    worlds.step(np.zeros(5))
                    outcomes.append("a tick")
                except proleg.InputError as error:
                    outcomes.append(str(error))

        threads = [threading.Thread(target=run) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        refused = set(outcomes) - {"a tick"}
        self.assertLessEqual(refused, {"Worlds: found a call while another thread makes one, expected one thread at a time"})
        worlds.step(np.zeros(5))

    def test_is_a_pickle(self):
        with self.assertRaises(TypeError):
            pickle.dumps(proleg.Worlds("caterpillar"))


if __name__ == "__main__":
    unittest.main()

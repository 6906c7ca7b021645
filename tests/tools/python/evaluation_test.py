"""evaluate() gives each candidate the score of its own run, whatever is computed beside it."""

import copy
import json
import os
import pickle
import random
import resource
import threading
import unittest

import numpy as np
import proleg

SEED = 1
NAMES = ["amplitude:J1", "phase_difference", "frequency"]


def random_candidates(count, seed=SEED):
    chance = np.random.default_rng(seed)
    return np.stack([chance.uniform(10, 70, count), chance.uniform(15, 140, count), chance.uniform(0.3, 2.2, count)], axis=1)


def alone(scenario, row, measure, seconds):
    own = scenario.copy()
    for name, value in zip(NAMES, row):
        own[name] = value
    return proleg.simulate(own, seconds, keep=()).measures[measure]


class Scores(unittest.TestCase):
    def test_are_those_of_runs_alone(self):
        candidates = random_candidates(21)
        for engine in ("reduced", "ode"):
            scenario = proleg.Scenario("caterpillar", engine=engine)
            scores = proleg.evaluate(scenario, NAMES, candidates, ["distance", "cost_of_transport"], seconds=0.5)
            for row, score in zip(candidates, scores):
                expected = [alone(scenario, row, measure, 0.5) for measure in ("distance", "cost_of_transport")]
                np.testing.assert_array_equal(score, expected, engine)

    def test_do_not_depend_on_workers_and_order(self):
        candidates = random_candidates(100)
        scenario = proleg.Scenario("caterpillar", engine="reduced")
        expected = proleg.evaluate(scenario, NAMES, candidates, seconds=0.5, workers=1)
        order = np.random.default_rng(SEED).permutation(len(candidates))
        for workers in (2, 3, 64):
            np.testing.assert_array_equal(proleg.evaluate(scenario, NAMES, candidates[order], seconds=0.5, workers=workers),
                                          expected[order])

    def test_of_long_robots_do_not_depend_on_workers(self):
        """ODE's iterative solver has one random generator in a process."""
        candidates = [[20.0], [30.0], [40.0]]
        one = proleg.evaluate("twenty_joints", ["1.amplitude"], candidates, seconds=0.1, engine="ode", workers=1)
        np.testing.assert_array_equal(proleg.evaluate("twenty_joints", ["1.amplitude"], candidates, seconds=0.1, engine="ode", workers=3), one)

    def test_come_from_arrays_of_any_form(self):
        scenario = proleg.Scenario("caterpillar", engine="reduced")
        values = random_candidates(12)
        expected = proleg.evaluate(scenario, NAMES, values, seconds=0.2)
        fortran = np.asfortranarray(values)
        strided = np.repeat(values, 2, axis=0)[::2]
        swapped = values.astype(">f8")
        locked = values.copy()
        locked.flags.writeable = False
        for form in (values.tolist(), fortran, strided, swapped, locked, values[::-1][::-1]):
            np.testing.assert_array_equal(proleg.evaluate(scenario, NAMES, form, seconds=0.2), expected)
        whole = proleg.evaluate(scenario, ["amplitude"], np.array([[30]], dtype=np.uint8), seconds=0.2)
        np.testing.assert_array_equal(whole, proleg.evaluate(scenario, "amplitude", [[30.0]], seconds=0.2))

    def test_have_the_shape_of_the_request(self):
        scenario = proleg.Scenario("caterpillar", engine="reduced")
        self.assertEqual(proleg.evaluate(scenario, NAMES, np.empty((0, 3)), seconds=0.1).shape, (0,))
        self.assertEqual(proleg.evaluate(scenario, NAMES, [], seconds=0.1).shape, (0,))
        self.assertEqual(proleg.evaluate(scenario, NAMES, random_candidates(2), seconds=0.1).shape, (2,))
        self.assertEqual(proleg.evaluate(scenario, NAMES, random_candidates(2), ["speed"], seconds=0.1).shape, (2, 1))

    def test_have_the_reasons_of_their_rows(self):
        scores = proleg.evaluate("caterpillar", ["amplitude"], [[10], [20], [30]], ["distance", "speed"], seconds=0.05, engine="reduced")
        scores.failures = ["bad A", "", "bad C"]
        scores[0] = scores[2] = np.nan
        failed = np.isnan(scores[:, 0])
        for part, reasons in ((scores[failed], ["bad A", "bad C"]), (scores[::-1], ["bad C", "", "bad A"]), (scores[1:, 0], ["", "bad C"]),
                              (scores[[2, 2, 1]], ["bad C", "bad C", ""]), (scores[:, None], ["bad A", "", "bad C"]),
                              (scores.copy(), ["bad A", "", "bad C"]), (copy.deepcopy(scores), ["bad A", "", "bad C"]),
                              (pickle.loads(pickle.dumps(scores)), ["bad A", "", "bad C"]), (pickle.loads(pickle.dumps(scores, 0)), ["bad A", "", "bad C"]),
                              (scores[failed][1:], ["bad C"]), (scores.reshape(-1), []), (scores[None], []), (scores.T, []), (scores[3:], [])):
            self.assertEqual(part.failures, reasons)
        for change in (lambda it: it.sort(), lambda it: it.sort(axis=0), lambda it: it.partition(1), lambda it: np.random.shuffle(it),
                       lambda it: it.__setitem__(slice(None), it[::-1])):
            changed = scores.copy()
            change(changed)
            self.assertEqual(changed.failures, [])

    def test_give_numbers_when_they_are_reduced(self):
        scores = proleg.evaluate("caterpillar", ["amplitude"], [[10], [20], [30]], seconds=0.05, engine="reduced")
        for reduced in (scores.max(), scores.sum(), scores.mean(), np.mean(scores), np.nanmax(scores), np.median(scores), scores[0],
                        np.percentile(scores, 50), scores.min(), scores.std(), scores[0] + scores[1], scores.max(axis=0)):
            self.assertIsInstance(reduced, float)
            self.assertEqual(json.loads(json.dumps(reduced)), round(reduced, 30))
        scores[1] = np.nan
        self.assertTrue(np.isnan(scores.mean()))
        self.assertEqual(np.nanargmax(scores), int(np.nanargmax(np.asarray(scores))))
        for plain in (scores * 2, -scores, np.isnan(scores)):
            self.assertIs(type(plain), np.ndarray)
        same = scores
        scores += 1
        self.assertIs(scores, same)

    def test_of_values_near_zero_are_those_of_zero(self):
        scenario = proleg.Scenario("caterpillar", engine="reduced")
        for value in (1e-300, 5e-324, -0.0, 1e-61, np.longdouble("1e-4000")):
            with self.subTest(value):
                np.testing.assert_array_equal(proleg.evaluate(scenario, ["phase"], [[value]], seconds=0.1),
                                              proleg.evaluate(scenario, ["phase"], [[0.0]], seconds=0.1))
                other = scenario.copy()
                other["phase"] = value
                self.assertEqual(other["phase", "J1"], 0)

    def test_in_threads_are_the_same(self):
        scenario = proleg.Scenario("caterpillar", engine="reduced")
        candidates = random_candidates(30)
        expected = proleg.evaluate(scenario, NAMES, candidates, seconds=0.3)
        found = []
        threads = [threading.Thread(target=lambda: found.append(proleg.evaluate(scenario, NAMES, candidates, seconds=0.3, workers=2)))
                   for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for scores in found:
            np.testing.assert_array_equal(scores, expected)

    def test_refuse_what_cannot_be_used(self):
        scenario = proleg.Scenario("caterpillar", engine="reduced")
        for what, arguments in {
            "one row": (["amplitude"], [30]),
            "too many columns": (["amplitude"], [[30, 40]]),
            "ragged rows": (["amplitude"], [[30], [40, 50]]),
            "texts": (["amplitude"], [["30"]]),
            "objects": (["amplitude"], np.array([[object()]])),
            "complex numbers": (["amplitude"], [[1j]]),
            "truth values": (["amplitude"], [[True]]),
            "nan": (["amplitude"], [[30], [float("nan")]]),
            "infinity": (["amplitude"], [[float("inf")]]),
            "a value above its range": (["amplitude"], [[91]]),
            "no names": ([], np.empty((3, 0))),
            "an unknown name": (["amplitud"], [[30]]),
            "a name that is none": ([3], [[30]]),
            "a measure": (["amplitude"], [[30]], "distanz"),
            "names without an order": ({"amplitude", "phase"}, [[30, 40]]),
            "frozen names": (frozenset(["amplitude", "phase"]), [[30, 40]]),
            "common keys": ({"amplitude": 1, "phase": 2}.keys() & {"amplitude", "phase"}, [[30, 40]]),
            "measures without an order": (["amplitude"], [[30]], {"speed", "distance"}),
            "a measure twice": (["amplitude"], [[30]], ["speed", "speed"]),
            "a name twice": (["amplitude", "phase", "amplitude"], [[30, 40, 50]]),
            "a parameter by two names": (["amplitude", "1.amplitude"], [[30, 40]]),
            "a joint before all": (["amplitude:J1", "amplitude"], [[30, 40]]),
            "a mask": (["amplitude"], np.ma.array([[30.0], [40.0]], mask=[[False], [True]])),
            "a masked number": (["amplitude"], [[30.0], [np.ma.masked]]),
            "rows with a mask": (["amplitude", "phase"], list(np.ma.array([[30.0, 1.0], [40.0, 2.0]], mask=[[False, True], [False, False]]))),
            "a date": (["amplitude"], np.array([["2026-01-01"]], dtype="datetime64[s]")),
            "a time": (["amplitude"], np.array([[3]], dtype="timedelta64[s]")),
            "half of nan": (["amplitude"], np.array([["nan"]], dtype=np.float16)),
            "a long number": (["amplitude"], np.array([["1e400"]], dtype=np.longdouble)),
            "a set of rows": (["amplitude"], {(30,), (40,)}),
            "rows that are used up": (["amplitude"], iter([[30]])),
        }.items():
            with self.subTest(what), self.assertRaises(proleg.InputError) as caught:
                proleg.evaluate(scenario, *arguments)
            self.assertIn("found", str(caught.exception))
        class Table:  # as pandas makes it of its nullable types
            def __array__(self, dtype=None):
                return np.array([[30]], dtype=object)

            def to_numpy(self, dtype):
                return np.array([[30.0]])

        with self.assertRaisesRegex(proleg.InputError, r"to_numpy\(float\)"):
            proleg.evaluate(scenario, ["amplitude"], Table())
        in_order = {"amplitude": 30, "amplitude:J1": 20}
        expected = proleg.evaluate(scenario, list(in_order), [[30, 20]], seconds=0.1)
        for names in (in_order, in_order.keys(), iter(in_order), np.array(list(in_order))):
            np.testing.assert_array_equal(proleg.evaluate(scenario, names, np.ma.array([[30, 20]]), seconds=0.1), expected)
        for workers in (0, -1, 65, 1.5, "2"):
            with self.subTest(workers), self.assertRaises(proleg.InputError):
                proleg.evaluate(scenario, ["amplitude"], [[30]], workers=workers)
        with self.assertRaisesRegex(proleg.InputError, r"candidates\[1, 0\]"):
            proleg.evaluate(scenario, ["amplitude"], [[30], [91]])


class RandomArguments(unittest.TestCase):
    """Whatever is given: a result, or an InputError; of what only the package calls, an exception; never a crash."""

    def test_never_crash(self):
        chance = random.Random(SEED)
        print(f"seed {SEED}")
        scenario = proleg.Scenario("caterpillar", engine="reduced")

        def anything():
            return chance.choice([None, True, -1, 0, 1, 2**70, 0.5, float("nan"), float("-inf"), "", "amplitude", "J1", "\0", "é\n", b"x",
                                  [], [1], ["amplitude"], (), ("amplitude", "J1"), {}, {"a": 1}, object(), scenario, np.nan,
                                  np.zeros(0), np.zeros((2, 2)), np.ones(5), np.array("x"), np.zeros((1, 1, 1)), np.int8(3),
                                  np.array([[30]], dtype=object), 1j, print, type])

        calls = [
            lambda: proleg.Scenario(anything()),
            lambda: proleg.Scenario("caterpillar", engine=anything(), seed=anything(), at=anything(), heading=anything()),
            lambda: scenario.copy().__setitem__(anything(), anything()),
            lambda: scenario[anything()],
            lambda: scenario.at(anything()).__setitem__(anything(), anything()),
            lambda: scenario.copy().move(anything(), anything(), anything(), anything()),
            lambda: scenario.replace(engine=anything(), seed=anything(), friction=anything(), seconds=anything()),
            lambda: proleg.caterpillar(anything(), anything()),
            lambda: proleg.simulate(chance.choice([scenario, anything()]), 0.02, keep=anything()),
            lambda: proleg.simulate(scenario, 0.02, losses=anything(), seed=anything()),
            lambda: proleg.evaluate(scenario, anything(), anything(), seconds=0.02),
            lambda: proleg.evaluate(scenario, ["amplitude"], [[30]], anything(), seconds=0.02, workers=anything()),
            lambda: proleg.open(anything()),
        ]
        inner = [
            lambda: type(scenario._state).__new__(type(scenario._state)).__setstate__(anything()),
            lambda: type(scenario._state)(anything(), anything()),
            lambda: proleg._core.evaluate(scenario._state, anything(), anything(), anything(), 1),
        ]
        outcomes = {}
        for _ in range(6000):
            try:
                chance.choice(calls)()
                outcome = "a result"
            except proleg.InputError:
                outcome = "InputError"
            outcomes[outcome] = outcomes.get(outcome, 0) + 1
        print(outcomes)
        self.assertGreater(outcomes["InputError"], 1000)
        for _ in range(1000):
            try:
                chance.choice(inner)()
            except Exception:  # noqa: BLE001 - any exception is right, a crash is not
                pass


@unittest.skipIf("ASAN_OPTIONS" in os.environ, "the sanitizer keeps memory that is free")
class Memory(unittest.TestCase):
    def test_stays_the_same_in_a_loop(self):
        scenario = proleg.Scenario("caterpillar", engine="reduced")
        rounds = int(os.environ.get("PROLEG_ROUNDS", "2000"))

        def work():
            for _ in range(rounds // 10):
                scenario["amplitude"] = 30
                proleg.simulate(scenario, 0.01)
                proleg.evaluate(scenario, ["amplitude"], [[30.0]], seconds=0.01, workers=1)

        def peak_kib():
            return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

        work()
        work()
        before = peak_kib()
        for _ in range(8):
            work()
        self.assertLess(peak_kib() - before, 2048, f"{rounds} rounds")


if __name__ == "__main__":
    unittest.main()

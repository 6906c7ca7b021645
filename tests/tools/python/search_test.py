"""A search by ask and tell is the search of `proleg optimise`: its candidates, its scores, its store, its errors.

    search_test.py PROLEG SCENARIO_FOLDER
"""

import json
import os
import signal
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy as np
import proleg

PROLEG = sys.argv.pop(1)
SHIPPED = sorted(Path(sys.argv.pop(1)).rglob("*.optimise.xml"))

METHODS = {
    "great-deluge": "<greatDeluge>{0}<properties><waterLevel>0.001</waterLevel><rain>0.001</rain><chains>3</chains>{1}</properties>{2}"
                    "</greatDeluge>",
    "genetic": "<geneticAlgorithm>{0}<properties><popsize>8</popsize><gamode>2</gamode>{1}</properties>{2}</geneticAlgorithm>",
    "cmaes": "<cmaEs>{0}<properties><popsize>6</popsize>{1}</properties>{2}</cmaEs>",
    "de": "<differentialEvolution>{0}<properties><popsize>7</popsize>{1}</properties>{2}</differentialEvolution>",
    "nsga2": "<nsga2>{0}<properties><popsize>8</popsize>{1}</properties>{2}</nsga2>",
    "pso": '<pagmo algorithm="pso">{0}<properties><popsize>5</popsize>{1}</properties>{2}</pagmo>',
}
PARAMETERS = """<registeredParameters>
  <parameter number="0" controlAlgorithm="PatternGenerator_sinusoidal" parameter="amplitude"/>
</registeredParameters>"""
REST = """<genome><genomeConfig number="0" allJoints="1" genomeType="1" valueType="1" valueSpace="1" activeJoints="11111">
  <lowerBounds>0</lowerBounds><upperBounds>40</upperBounds><boundsIncrements>0.25</boundsIncrements>
  <lowerBoundTypes>1</lowerBoundTypes><upperBoundTypes>1</upperBoundTypes><uniform>0</uniform>
</genomeConfig></genome>
<fitness><objective measure="distance"/>{objectives}</fitness>
<evaluation><evaluations>{evaluations}</evaluations><seed>{seed}</seed>{evaluation}</evaluation>"""


MAP = next(file for file in SHIPPED if file.name == "gait_map.optimise.xml")


class InAFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, "/")
        os.chdir(folder.name)
        proleg.Scenario("caterpillar").replace(seconds=0.4).save("short.simulation.xml")

    def experiment(self, method="cmaes", evaluations=30, seed=3, objectives="", evaluation=""):
        """Writes an experiment; returns its file."""
        if method == "nsga2" and not objectives:
            objectives = '<objective measure="mechanical_energy" goal="minimise"/>'
        rest = REST.format(evaluations=evaluations, seed=seed, objectives=objectives, evaluation=evaluation)
        file = f"{method}.optimise.xml"
        Path(file).write_text(METHODS[method].format("<simulation>short.simulation.xml</simulation>", PARAMETERS, rest))
        return file


def optimise(*words, status=0):
    done = subprocess.run([PROLEG, "optimise", *words], capture_output=True, text=True, check=False)
    if done.returncode != status:
        raise AssertionError(f"{words}: status {done.returncode}: {done.stderr}")
    return done


def rows(folder, what, order="number"):
    """Rows of a table of a store, without what a clock measured."""
    with sqlite3.connect(f"file:{folder}/store.sqlite?mode=ro", uri=True) as store:
        store.row_factory = sqlite3.Row
        return [{key: row[key] for key in row.keys() if key not in ("wall_s", "worker", "simulated_s")}
                for row in store.execute(f"SELECT {what} ORDER BY {order}")]


def history(folder):
    return [(row["number"], row["candidate"], *(row[key] for key in row if key.startswith("score")), row["failure"])
            for row in rows(folder, "* FROM evaluation")]


def rate(search, most=None):
    candidates = search.ask(most)
    search.tell(proleg.evaluate(search.scenario, search.names, candidates, search.measures))
    return len(candidates)


class History(InAFolder):
    def test_is_that_of_the_command_line(self):
        for method in METHODS:
            file = self.experiment(method)
            optimise(file, "--workers", "2", "--out", f"{method}.cli")
            for at_once in (None, 1, 13):
                with self.subTest(method, at_once=at_once), proleg.Search(file, f"{method}.{at_once}", at_once=at_once) as search:
                    asked = 0
                    while not search.done:
                        asked += rate(search)
                    self.assertEqual(history(f"{method}.cli"), history(f"{method}.{at_once}"))
                    self.assertEqual(search.ending, "all 30 evaluations made")
                    if at_once == 1:
                        self.assertEqual(asked, sum(not row["reused"] for row in rows(search.folder, "* FROM evaluation")))

    def test_of_a_map_of_gaits_is_that_of_the_command_line(self):
        optimise(str(MAP), "--simulation", "short.simulation.xml", "--evaluations", "300", "--workers", "2", "--out", "map.cli")
        with proleg.Search(MAP, "map.python", simulation="short.simulation.xml", evaluations=300) as search:
            self.assertEqual(search.method, "map-elites")
            while not search.done:
                rate(search)
        self.assertEqual(history("map.cli"), history("map.python"))

    def test_of_every_shipped_experiment_begins(self):
        self.assertGreaterEqual(len(SHIPPED), 9)
        for number, file in enumerate(SHIPPED):
            with self.subTest(file), proleg.Search(file, f"shipped{number}") as search:
                self.assertEqual(search.ask(1).shape, (1, len(search.names)))
            for method in ("great-deluge", "genetic", "cmaes", "de", "nsga2", "pso"):
                with self.subTest(file, method=method):
                    try:
                        proleg.Search(file, f"shipped{number}.{method}", method).close()
                    except proleg.InputError as error:  # a method for another number of objectives
                        self.assertRegex(str(error), "objective|map")

    def test_is_whole_with_the_worlds_of_the_search(self):
        """Several trials, racing and a heading: simulate() knows them; every number of the store is that of the command line."""
        for evaluation in ('<trials count="3" randomNumbers="fresh"><friction>0.2</friction></trials>', '<racing after="0.5" keep="0.95"/>'):
            file = self.experiment(evaluation=evaluation)
            name = evaluation[1:6]
            optimise(file, "--workers", "2", "--out", f"{name}.cli")
            with proleg.Search(file, f"{name}.python") as search:
                while not search.done:
                    search.simulate(workers=2)
            with self.subTest(evaluation):
                self.assertEqual(rows(f"{name}.cli", "* FROM evaluation"), rows(f"{name}.python", "* FROM evaluation"))
                # Without trials made ahead in vain, and without the fresh runs of the best.
                one, other = (rows(folder, "trial.* FROM trial JOIN evaluation USING(run, number) WHERE trial < 3", "number, trial")
                              for folder in (f"{name}.cli", f"{name}.python"))
                self.assertEqual(one, other)
                self.assertEqual(any(row["given_up"] for row in one), name == "racin")
            optimise("--resume", f"{name}.python")
            with self.subTest(evaluation, part="the best, rated again by a resumption"):
                one, other = (rows(folder, "* FROM trial WHERE trial >= 3", "number, trial") for folder in (f"{name}.cli", f"{name}.python"))
                self.assertEqual(one, other)

    def test_with_another_method_can_be_resumed_without_its_file(self):
        file = self.experiment("cmaes")
        with proleg.Search(file, "found", "de") as search:
            self.assertEqual(search.method, "de")
            rate(search)
        result = json.loads(optimise("--resume", "found", "--json").stdout)
        self.assertEqual((result["method"], result["evaluations"]), ("de", 30))
        with self.assertRaisesRegex(proleg.InputError, "another experiment.*method"):
            proleg.Search(file, "found")


class Store(InAFolder):
    def test_has_what_was_told_when_the_call_returns(self):
        """Told one by one and broken off anywhere: nothing is asked for twice, and the history is the same."""
        file = self.experiment("genetic")
        optimise(file, "--out", "cli")
        asked = []
        stop_after = 1
        done = False
        while not done:
            with proleg.Search(file, "python") as search:
                for _ in range(stop_after):
                    candidates = search.ask(1)
                    if len(candidates) == 0:
                        break
                    asked.append((search.numbers[0], *candidates[0]))
                    search.tell(proleg.evaluate(search.scenario, search.names, candidates, search.measures))
                search.ask()  # and these are never told
                done = search.done
            stop_after += 3
        self.assertEqual(len(asked), len(set(asked)))
        self.assertEqual(history("cli"), history("python"))

    def test_survives_a_killed_process(self):
        file = self.experiment()
        program = f"""if True:
            import os, signal, sys, proleg
            search = proleg.Search({file!r}, "python")
            for _ in range(8):
                search.tell(proleg.evaluate(search.scenario, search.names, search.ask(1), search.measures))
            os.kill(os.getpid(), signal.SIGKILL)"""
        self.assertEqual(subprocess.run([sys.executable, "-c", program], check=False).returncode, -signal.SIGKILL)
        self.assertEqual(len(rows("python", "* FROM trial")), 8)
        result = json.loads(optimise(file, "--resume", "python", "--json").stdout)
        self.assertGreaterEqual(result["restored"] + result["reused"], 8)
        optimise(file, "--out", "cli")
        self.assertEqual(history("cli"), history("python"))

    def test_of_the_command_line_can_be_continued(self):
        file = self.experiment()
        optimise(file, "--out", "both", "--evaluations", "11")
        with proleg.Search(file, "both") as search:
            self.assertGreaterEqual(search.ask().shape[0], 1)
            self.assertEqual(search.numbers[0], 11)
            while not search.done:
                rate(search)
            table = search.table()
            self.assertEqual(list(table["number"]), list(range(30)))
            best = search.best
            self.assertEqual(best.scores["distance"], max(table["score distance"]))
            self.assertEqual([table[name][best.number] for name in search.names], list(best.values.values()))
        optimise(file, "--out", "cli")
        self.assertEqual(history("cli"), history("both"))
        optimise("--resume", "both")
        self.assertTrue(Path("both/best.simulation.xml").exists())
        with proleg.Search(store="both") as again:
            self.assertTrue(again.done)
            self.assertEqual(again.best, best)
            self.assertEqual(len({again.best, best}), 1)

    def test_has_the_failures_of_the_command_line(self):
        """nan is a run that failed, or does not define the measure: the score is that of a failed run."""
        text = Path(self.experiment()).read_text().replace('measure="distance"', 'measure="distance" failed="-7"')
        Path("failing.optimise.xml").write_text(text)
        with proleg.Search("failing.optimise.xml", "python") as search:
            self.assertEqual(len(search.ask()), 1)  # the baseline
            search.tell([0.5])
            self.assertGreaterEqual(len(search.ask()), 2)
            scores = np.full(len(search.numbers), 0.25)
            scores[:2] = np.nan
            search.tell(scores, failures=["it flew off", *[""] * (len(scores) - 1)])
            table = search.table()
            self.assertEqual(list(table["score distance"][:3]), [0.5, -7, -7])
            self.assertEqual(list(table["failure"][:3]), ["", "it flew off", ""])
            self.assertEqual(search.best.number, 0)
        result = json.loads(optimise("--resume", "python", "--json").stdout)
        self.assertGreaterEqual(result["failed"], 2)
        self.assertEqual([row[2] for row in history("python")[:3]], [0.5, -7, -7])

    def test_has_no_reason_of_another_row(self):
        with proleg.Search(self.experiment(), "python") as search:
            search.tell(np.zeros(len(search.ask())))
            rows = len(search.ask())
            scores = np.arange(rows, dtype=float)
            scores[0] = np.nan
            scores = scores.view(proleg.Scores)
            scores.failures = ["broke"] + [""] * (rows - 1)
            search.tell(scores[::-1])
            table = search.table()
            self.assertEqual([reason for score, reason in zip(table["distance"], table["failure"]) if np.isnan(score)], ["broke"])
            self.assertEqual(sum(reason != "" for reason in table["failure"]), 1)
            rows = len(search.ask())
            scores = np.arange(rows, dtype=float).view(proleg.Scores)
            scores.failures = ["broke"] + [""] * (rows - 1)
            scores[1] = np.nan  # another than evaluate() has found
            search.tell(scores)
            self.assertEqual(sum(reason != "" for reason in search.table()["failure"]), 1)

    def test_is_locked(self):
        file = self.experiment()
        with proleg.Search(file, "python"):
            refused = optimise(file, "--resume", "python", status=2).stderr
            self.assertIn("another program is writing to it", refused)
            with self.assertRaises(proleg.InputError) as caught:
                proleg.Search(file, "python")
            self.assertEqual(f"proleg optimise: {caught.exception}\n", refused)
        optimise(file, "--resume", "python")

    def test_of_another_experiment_is_refused_as_on_the_command_line(self):
        self.experiment("de")
        optimise("de.optimise.xml", "--out", "found")
        other = self.experiment("cmaes", seed=4)
        refused = optimise(other, "--resume", "found", status=2).stderr
        with self.assertRaises(proleg.InputError) as caught:
            proleg.Search(other, "found")
        self.assertEqual(f"proleg optimise: {caught.exception}\n", refused)

    def test_can_be_stopped_from_outside(self):
        file = self.experiment()
        with proleg.Search(file, "python") as search:
            candidates = search.ask()
            optimise("--stop", "python")
            self.assertTrue(search.done)
            self.assertIsNone(search.ending)
            with self.assertRaisesRegex(proleg.InputError, "--stop"):
                search.tell(np.zeros(len(candidates)))
            self.assertEqual(len(search.ask()), 0)
        optimise(file, "--resume", "python")

    def test_is_no_file_that_can_be_written(self):
        file = self.experiment()
        with proleg.Search(file, "python") as search:
            rate(search, 1)
            Path("python/store.sqlite").unlink()
            with self.assertRaisesRegex(proleg.FileError, "store.sqlite"):
                while not search.done:
                    rate(search)


class WhatCannotBeUsed(InAFolder):
    def test_raises_input_error_and_changes_nothing(self):
        file = self.experiment()
        with proleg.Search(file, "python") as search:
            with self.assertRaisesRegex(proleg.InputError, "ask"):
                search.tell([1.0])
            candidates = search.ask()
            np.testing.assert_array_equal(search.ask(), candidates)
            n = len(candidates)
            for what, action in {
                "too few": lambda: search.tell(np.zeros(n - 1)),
                "too many": lambda: search.tell(np.zeros(n + 1)),
                "two columns": lambda: search.tell(np.zeros((n, 2))),
                "a scalar": lambda: search.tell(1.0),
                "texts": lambda: search.tell(["a"] * n),
                "objects": lambda: search.tell([None] * n),
                "ragged rows": lambda: search.tell([[1], [1, 2]]),
                "complex numbers": lambda: search.tell(np.zeros(n, complex)),
                "an unknown measure": lambda: search.tell(np.zeros(n), "distanz"),
                "a measure that is not needed": lambda: search.tell(np.zeros(n), "speed"),
                "a mask": lambda: search.tell(np.ma.array(np.zeros(n), mask=np.arange(n) == 0)),
                "masked numbers": lambda: search.tell([np.ma.masked] * n),
                "times": lambda: search.tell(np.zeros(n, "timedelta64[s]")),
                "a set": lambda: search.tell(set(range(n))),
                "measures without an order": lambda: search.tell(np.zeros((n, 2)), {"distance", "speed"}),
                "a measure twice": lambda: search.tell(np.zeros((n, 2)), ["distance", "distance"]),
                "reasons without an order": lambda: search.tell(np.zeros(n), failures={"a", "b"}),
                "too many reasons": lambda: search.tell(np.zeros(n), failures=["x"] * (n + 1)),
                "reasons that are none": lambda: search.tell(np.zeros(n), failures=[1] * n),
                "no rows": lambda: search.ask(0),
                "half a row": lambda: search.ask(1.5),
                "workers": lambda: search.simulate(workers=65),
            }.items():
                with self.subTest(what), self.assertRaises(proleg.InputError) as caught:
                    action()
                self.assertIn("found", str(caught.exception))
            search.ask()
            rate(search)
            with self.assertRaisesRegex(proleg.InputError, "ask"):
                search.tell(np.zeros(n))
            while not search.done:
                rate(search)
            with self.assertRaisesRegex(proleg.InputError, "ended: all 30 evaluations made"):
                search.tell([])
        optimise(file, "--out", "cli")
        self.assertEqual(history("cli"), history("python"))

    def test_is_not_opened(self):
        file = self.experiment()
        for what, arguments in {
            "no file": {"experiment": "nothing.optimise.xml"},
            "neither file nor store": {},
            "a scenario": {"experiment": "short.simulation.xml"},
            "a method": {"experiment": file, "method": "guess"},
            "a method for several objectives": {"experiment": file, "method": "nsga2"},
            "an engine": {"experiment": file, "engine": "bullet"},
            "trials": {"experiment": file, "trials": 0},
            "evaluations": {"experiment": file, "evaluations": -1},
            "a seed": {"experiment": file, "seed": 2**64},
            "at once": {"experiment": file, "at_once": 0},
            "a store that is none": {"store": "nowhere"},
            "a store with a long name": {"experiment": file, "store": "x" * 300},
            "a file with a long name": {"experiment": "x" * 5000 + ".optimise.xml"},
            "half a character": {"experiment": file, "store": "\ud800"},
            "a seed that is a time": {"experiment": file, "seed": np.timedelta64(1, "s")},
            "a store over a file of the experiment": {"experiment": file, "store": b"x"},
        }.items():
            with self.subTest(what), self.assertRaises(proleg.InputError) as caught:
                proleg.Search(**arguments)
            self.assertRegex(str(caught.exception), "found|does not exist")
        self.assertEqual([path.name for path in Path().glob("*/store.sqlite*")], [])

    def test_is_a_second_genetic_search(self):
        file = self.experiment("genetic")
        with proleg.Search(file, "one") as one:
            with self.assertRaisesRegex(proleg.InputError, "one at a time"):
                proleg.Search(file, "two")
            rate(one)
        with proleg.Search(file, "two") as two:
            rate(two)

    def test_is_a_call_from_another_thread_meanwhile(self):
        with proleg.Search(self.experiment(evaluations=200), "python") as search:
            outcomes = []

            def run():
                for _ in range(20):
                    try:
                        search.simulate(1, workers=1)
                    except proleg.InputError as error:
                        outcomes.append(str(error))

            threads = [threading.Thread(target=run) for _ in range(3)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertLessEqual(set(outcomes), {"Search: found a call while another thread makes one, expected one thread at a time"})
            search.simulate()


class TheEnd(InAFolder):
    """Its thread ends in every way in which a program can end, and the store is free then."""

    def run_program(self, text, status=0):
        file = self.experiment()
        program = f"import os, signal, sys, proleg\nsearch = proleg.Search({file!r}, 'python')\nsearch.simulate()\n{text}"
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False, timeout=60)
        self.assertEqual(done.returncode, status, done.stderr)
        with proleg.Search(file, "python") as search:
            self.assertGreater(search.ask().shape[0], 0)
        return done

    def test_of_python(self):
        self.run_program("search.ask()")
        self.run_program("sys.exit(3)", 3)
        self.run_program("del search")
        self.run_program("search.loop = search; del search")  # the collector finds it

    def test_by_an_exception(self):
        self.assertIn("KeyboardInterrupt", self.run_program("signal.raise_signal(signal.SIGINT)", -signal.SIGINT).stderr)
        self.run_program("with search: raise SystemExit(4)", 4)

    def test_of_a_forked_child(self):
        self.run_program("""if True:
            child = os.fork()
            if child == 0:
                try:
                    search.ask()
                    os._exit(1)
                except proleg.InputError as error:
                    assert "forked" in str(error), error
                search.close()
                del search
                sys.exit(5)
            assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 5
            search.simulate()""")

    def test_releases_the_store_although_a_child_lives_on(self):
        file = self.experiment()
        search = proleg.Search(file, "python")
        end, wake = os.pipe()
        child = os.fork()
        if child == 0:
            os.read(end, 1)
            os._exit(0)
        search.close()
        with proleg.Search(file, "python") as again:
            rate(again)
        os.write(wake, b"x")
        os.waitpid(child, 0)

    def test_by_ctrl_c_in_a_simulation(self):
        file = self.experiment()
        proleg.Scenario("caterpillar").replace(seconds=80000).save("short.simulation.xml", replace=True)
        search = proleg.Search(file, "python")
        timer = threading.Timer(0.2, signal.raise_signal, [signal.SIGINT])
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            proleg.evaluate(search.scenario, search.names, search.ask(), search.measures)
        timer.join()
        self.assertGreater(len(search.ask()), 0)  # it goes on
        search.close()
        search.close()


class Loading(unittest.TestCase):
    def test_of_the_package_does_not_load_the_optimisers(self):
        program = "import proleg, sys; assert 'pagmo' not in open('/proc/self/maps').read(); proleg.Search; assert 'pagmo' in open('/proc/self/maps').read()"
        subprocess.run([sys.executable, "-c", program], check=True)


if __name__ == "__main__":
    unittest.main()

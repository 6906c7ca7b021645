"""What interpreters do with any package: their end while threads work, a second interpreter, copies, pickles, objects without __init__.

    interpreter_test.py SCENARIO_FOLDER
"""

import copy
import inspect
import pickle
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import proleg
import proleg.gym
import proleg.robot
import proleg.search

EXPERIMENT = Path(sys.argv.pop(1)) / "travelling_wave/cma_es.optimise.xml"
BEGIN = """
import threading, time
import numpy as np
import proleg
scenario = proleg.Scenario("caterpillar", engine="reduced")
began = threading.Event()
"""
SHORT = "proleg.simulate(scenario, seconds=0.1)"


def run(program, folder=None):
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False, timeout=300, cwd=folder)


class TheEndOfPython(unittest.TestCase):
    """It comes while daemon threads are in a call: the program ends as if they did not exist."""

    def check(self, work, before="", end="", count=3):
        program = f"""{BEGIN}{before}
def work():
    began.set()
    while True:
        {work}
for _ in range({count}):
    threading.Thread(target=work, daemon=True).start()
began.wait()
time.sleep(0.05)
{end}
print("end")"""
        with tempfile.TemporaryDirectory() as folder:
            done = run(program, folder)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "end\n", ""))

    def test_in_short_and_long_simulations(self):
        for seconds in (0.01, 0.2, 80000):
            with self.subTest(seconds):
                self.check(f"proleg.simulate(scenario, {seconds}, keep=())")

    def test_in_evaluations(self):
        for seconds in (0.05, 80000):
            with self.subTest(seconds):
                self.check(f"proleg.evaluate(scenario, ['amplitude'], [[10], [20], [30]], seconds={seconds})")

    def test_in_worlds(self):
        self.check("own = proleg.Worlds('caterpillar', 2, seconds=1); own.reset(); [own.step(np.zeros(5)) for _ in range(100)]")

    def test_in_searches(self):
        before = f"search = proleg.Search({str(EXPERIMENT)!r}, store='found')\n"
        self.check("search.simulate(1, workers=1)", before, count=1)
        self.check("search.ask()", before, count=1)

    def test_in_pictures_and_recordings(self):
        before = "one = proleg.simulate(scenario, 5, record='one.proleg')\n"
        self.check("proleg.open('one.proleg')", before)
        self.check("one.picture()", before)

    def test_leaves_work_to_the_main_thread(self):
        self.check(SHORT, end=f"import atexit\natexit.register(lambda: {SHORT})")

    def test_waits_for_other_threads(self):
        done = run(f"{BEGIN}\ndef work():\n    for _ in range(20): {SHORT}\n    print('all')\nthreading.Thread(target=work).start()")
        self.assertEqual((done.returncode, done.stdout), (0, "all\n"), done.stderr)

    def test_in_a_child_of_fork(self):
        """Whose parent has threads in a call: it has none of them."""
        self.check(SHORT, end="import os, sys\nchild = os.fork()\nif child == 0:\n    sys.exit(7)\n"
                              "assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7")


class ASecondInterpreter(unittest.TestCase):
    def test_gets_an_import_error(self):
        for before in ("", "import proleg\n"):
            with self.subTest(before):
                done = run(f"""{before}import _xxsubinterpreters as interpreters
one = interpreters.create()
try:
    interpreters.run_string(one, "import proleg")
except interpreters.RunFailedError as error:
    print(error)""")
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertRegex(done.stdout, "ImportError.*interpreter")


def classes():
    """All classes of C++."""
    return [each for module in (proleg._core, proleg.search._core, sys.modules["proleg._search"], sys.modules["proleg._robot"])
            for _, each in inspect.getmembers(module, inspect.isclass) if not issubclass(each, Exception)]


class AnObject(unittest.TestCase):
    def test_of_scenarios_and_runs_survives_every_protocol(self):
        scenario = proleg.Scenario("caterpillar", engine="reduced")
        scenario["amplitude"] = 12
        one = proleg.simulate(scenario, 0.1)
        for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
            with self.subTest(protocol):
                for given in (scenario, scenario._state, one):
                    again = pickle.loads(pickle.dumps(given, protocol))
                    self.assertIs(type(again), type(given))
                self.assertEqual(pickle.loads(pickle.dumps(scenario, protocol))["amplitude", "J1"], scenario["amplitude", "J1"])
                self.assertEqual(pickle.loads(pickle.dumps(one, protocol)).world_hash, one.world_hash)
        for again in (copy.copy(scenario._state), copy.deepcopy(scenario._state), copy.copy(one).scenario, copy.deepcopy(one).scenario):
            self.assertEqual(again.joints, scenario.joints)

    def test_that_belongs_to_a_process_is_no_copy(self):
        for given in (proleg.Worlds("caterpillar"), proleg.Worlds("caterpillar")._worlds, proleg.gym.Env("caterpillar"),
                      proleg.gym.VectorEnv("caterpillar", 2)):
            for action in (copy.copy, copy.deepcopy, *(lambda it, p=protocol: pickle.dumps(it, p) for protocol in range(6))):
                with self.subTest(type(given)), self.assertRaisesRegex(TypeError, "expected a new"):
                    action(given)

    def test_without_init_raises(self):
        """Of what only the package calls: an exception, in every attribute and as an argument."""
        self.assertEqual({each.__name__ for each in classes()}, {"Scenario", "Worlds", "Search", "Robot"})
        for each in classes():
            for name in dir(each):
                if not name.startswith("__") or name in ("__reduce__", "__reduce_ex__"):
                    with self.subTest(each.__name__, name=name), self.assertRaises((TypeError, AttributeError)):
                        value = getattr(each.__new__(each), name)
                        for arguments in ((), (1,), ("a",), ("a", 1.0, None), ({},), ("a", True), ([], [], [])):
                            try:
                                value(*arguments)
                            except TypeError as error:
                                wrong = error
                            else:
                                self.fail(f"{arguments} are taken")
                        raise wrong
            for protocol in range(6):
                with self.subTest(each.__name__, protocol=protocol), self.assertRaises(TypeError):
                    pickle.dumps(each.__new__(each), protocol)
        empty = proleg._core.Scenario.__new__(proleg._core.Scenario)
        for action in (lambda: proleg._core.simulate(empty, [], None, None), lambda: proleg._core.Worlds(empty, 1),
                       lambda: proleg._core.evaluate(empty, ["amplitude"], [[1.0]], ["distance"], 1)):
            with self.assertRaises(TypeError):
                action()


if __name__ == "__main__":
    unittest.main()

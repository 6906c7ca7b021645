"""The examples of docs/python.md: each search finds a gait above 1.9 m, in ODE too; what is learned crosses the terrace; the sweep prints a table.

    examples_test.py FOLDER
"""

import re
import subprocess
import sys
import unittest
from pathlib import Path

FOLDER = Path(sys.argv.pop(1))


class Examples(unittest.TestCase):
    def run_example(self, name):
        done = subprocess.run([sys.executable, FOLDER / name], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_of_searches_find_a_gait(self):
        for name in ("search_scipy.py", "search_optuna.py", "search_deap.py"):
            with self.subTest(name):
                printed = self.run_example(name)
                print(f"{name}: {printed.strip().splitlines()[-1]}")
                found = re.search(r"([0-9.]+) m found, ([0-9.]+) m in ODE", printed)
                self.assertGreater(float(found.group(1)), 1.9)
                self.assertGreater(float(found.group(2)), 1.9)

    def test_of_learning_crosses_the_terrace(self):
        printed = self.run_example("learn_step.py").strip().splitlines()[-1]
        print(printed)
        self.assertGreater(float(re.search(r"the last link is (-?[0-9.]+) m behind", printed).group(1)), 0)

    def test_of_a_sweep_prints_a_table(self):
        self.assertEqual(len(self.run_example("sweep_pandas.py").splitlines()), 6)


if __name__ == "__main__":
    unittest.main()

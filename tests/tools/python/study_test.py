"""The example of a study: a reviewer repeats it from its receipts, and notices what was changed afterwards.

    study_test.py STUDY PROGRAM_FOLDER
"""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

STUDY, PROGRAMS = sys.argv[1], sys.argv[2]
del sys.argv[1:]


def study(*words):
    path = f"{PROGRAMS}:{os.environ['PATH']}"
    return subprocess.run([sys.executable, STUDY, *words], capture_output=True, text=True, check=False, env={**os.environ, "PATH": path})


class AStudy(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.made = Path(folder.name) / "made"
        done = study(cls.made)
        assert done.returncode == 0, done.stderr

    def setUp(self):
        self.folder = self.made.with_name("checked")
        shutil.copytree(self.made, self.folder)  # elsewhere: no path is in what a reviewer gets
        self.addCleanup(shutil.rmtree, self.folder)

    def test_is_repeated(self):
        done = study("--check", self.folder)
        self.assertEqual((done.returncode, done.stdout), (0, "9 runs are repeated to the last bit\n"), done.stderr)

    def test_is_not_repeated_with_what_was_changed(self):
        def change(file, old, new):
            text = (self.folder / file).read_text()
            self.assertIn(old, text)
            (self.folder / file).write_text(text.replace(old, new, 1))

        distance = (self.folder / "study.tsv").read_text().split()[5]
        for what, file, old, new in (("a number of the table", "study.tsv", distance, distance[:8] + str((int(distance[8]) + 1) % 10) + distance[9:]),
                                     ("a setting of a receipt", "study.receipts", "set=amplitude=20", "set=amplitude=21"),
                                     ("the scenario", "study.actuation.xml", "1", "1.5"),
                                     ("a lost receipt", "study.receipts", (self.folder / "study.receipts").read_text().splitlines()[0] + "\n", "")):
            with self.subTest(what):
                before = (self.folder / file).read_text()
                change(file, old, new)
                self.assertNotEqual(study("--check", self.folder).returncode, 0)
                (self.folder / file).write_text(before)
        self.test_is_repeated()


if __name__ == "__main__":
    unittest.main()

"""receipt_test.py SCENARIOS PROLEG_RECEIPT: a receipt states a run, and whoever has the files can verify it."""

import json
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROLEG_RECEIPT = Path(sys.argv.pop(2)).resolve()
SCENARIOS = Path(sys.argv.pop(1)).resolve()


def run(*words, text=""):
    return subprocess.run([PROLEG_RECEIPT, *words], input=text, text=True, capture_output=True, timeout=300)


class ReceiptTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        shutil.copytree(SCENARIOS / "travelling_wave", cls.folder / "wave")
        cls.file = cls.folder / "wave/uniform.simulation.xml"
        made = run(cls.file, "--seconds", "3", "--set", "amplitude=41", "--set", "frequency:J2=1.2@1s", "--seed", "7", "--heading", "30")
        assert made.returncode == 0, made.stderr
        cls.receipt = made.stdout.strip()

    def check(self, receipt, file=None):
        return run("check", file or self.file, receipt)

    def refused(self, *words, text=""):
        result = run(*words, text=text)
        self.assertEqual((result.returncode, result.stdout, result.stderr.count("\n")), (2, "", 1), result.stderr)
        return result.stderr

    def does_not_hold(self, receipt, file=None):
        result = self.check(receipt, file)
        self.assertEqual((result.returncode, result.stdout, result.stderr.count("\n")), (1, "", 1), result.stderr)
        return result.stderr


class Holds(ReceiptTest):
    def test_is_one_line_with_the_options_of_the_run(self):
        self.assertEqual(len(self.receipt.splitlines()), 1)
        for word in ["seconds=3", "seed=7", "heading=30", "set=amplitude=41", "set=frequency:J2=1.2@1s", "engine=reduced-"]:
            self.assertIn(word, self.receipt)

    def test_holds_where_the_files_are_elsewhere(self):
        shutil.copytree(self.folder / "wave", self.folder / "elsewhere", dirs_exist_ok=True)
        result = self.check(self.receipt, self.folder / "elsewhere/uniform.simulation.xml")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("the receipt holds: distance 0.", result.stdout)

    def test_is_read_as_words_as_a_line_and_from_standard_input_with_any_white_space(self):
        for words, text in [(self.receipt.split(), ""), ([self.receipt], ""), ([], self.receipt + "\n"),
                            ([self.receipt.replace(" ", "\n\t ")], "")]:
            self.assertEqual(run("check", self.file, *words, text=text).returncode, 0)

    def test_states_any_measure(self):
        made = run(self.file, "--seconds", "2", "--measure", "cost_of_transport", "--json")
        receipt = json.loads(made.stdout)["receipt"]
        result = json.loads(run("check", self.file, receipt, "--json").stdout)
        self.assertEqual((result["holds"], result["measure"], result["stated_value"]), (True, "cost_of_transport", result["value"]))


class DoesNotHold(ReceiptTest):
    def test_when_an_option_is_another_one(self):
        for found, instead in [("amplitude=41", "amplitude=40"), ("seconds=3", "seconds=2"), ("heading=30", "heading=31")]:
            self.assertIn("the world moves otherwise", self.does_not_hold(self.receipt.replace(found, instead)))

    def test_when_the_value_is_another_one(self):
        changed = re.sub("distance=0.(.)", lambda digit: f"distance=0.{(int(digit[1]) + 1) % 10}", self.receipt)
        self.assertRegex(self.does_not_hold(changed), "distance is 0.*, the receipt has 0")

    def test_when_a_file_is_another_one(self):
        shutil.copytree(self.folder / "wave", self.folder / "changed", dirs_exist_ok=True)
        floor = self.folder / "changed/flat.environment.xml"
        floor.write_text(floor.read_text().replace("<friction>0.1<", "<friction>0.11<"))
        self.assertIn("the files of the scenario are not those of the receipt",
                      self.does_not_hold(self.receipt, self.folder / "changed/uniform.simulation.xml"))

    def test_when_engine_or_algorithms_are_another_version(self):
        self.assertIn("the receipt is of the engine reduced-0", self.does_not_hold(re.sub("engine=reduced-[0-9]+", "engine=reduced-0", self.receipt)))
        self.assertIn("the receipt is of other algorithms", self.does_not_hold(re.sub("core=[^ ]+", "core=0x00000000", self.receipt)))


class BadInput(ReceiptTest):
    """One line, status 2."""

    def test_what_is_no_receipt(self):
        for text, reason in [("", "found nothing"), ("hello", "found 'hello'"), (self.receipt[:40], "found no word"),
                             (self.receipt.rsplit(" ", 1)[0], "found no word 'world='"),
                             (self.receipt + " world=0", "found two words for 'world'"),
                             (self.receipt + " distance=1", "found two words"), (self.receipt + " seed=8", "found two words for 'seed'"),
                             (self.receipt + " colour=red", "found 'colour=red'"), (self.receipt + " seed", "found 'seed'"),
                             (re.sub(" distance=[^ ]+", "", self.receipt), "found no measure")]:
            self.assertIn(reason, self.refused("check", self.file, text=text))

    def test_values_that_the_options_refuse(self):
        self.assertIn("--seconds", self.refused("check", self.file, self.receipt.replace("seconds=3", "seconds=x")))
        self.assertIn("amplitude", self.refused("check", self.file, self.receipt.replace("amplitude=41", "amplitude=4100")))
        self.assertIn("--measure", self.refused(self.file, "--measure", "beauty"))

    def test_a_scenario_that_the_engine_does_not_have(self):
        shutil.copytree(self.folder / "wave", self.folder / "ball", dirs_exist_ok=True)
        segment = self.folder / "ball/modules/segment.kinbody.xml"
        segment.write_text(segment.read_text().replace('<Geom type="box">', '<Geom type="sphere"><radius>0.026</radius>').replace(
            "<extents>0.026 0.018 0.026</extents>", ""))
        self.assertIn("with a sphere", self.refused(self.folder / "ball/uniform.simulation.xml"))


if __name__ == "__main__":
    unittest.main()

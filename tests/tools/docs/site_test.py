"""tools/docs makes the site without a warning, with a manual for each command, and its search works from a file.

usage: site_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path


class Site(unittest.TestCase):
    source = Path()
    programs = Path()

    @classmethod
    def setUpClass(cls):
        cls.made = subprocess.run([cls.source / "tools/docs", "--programs", cls.programs], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  text=True)
        cls.site = cls.source / "build/docs/site"

    def test_it_is_made_without_a_warning(self):
        self.assertEqual((self.made.returncode, self.made.stderr), (0, ""))

    def test_each_command_has_a_manual_with_its_options(self):
        listed = subprocess.run([self.programs / "proleg", "--help"], stdout=subprocess.PIPE, text=True, check=True).stdout
        names = re.findall(r"^  ([a-z]+) ", listed, flags=re.MULTILINE)
        self.assertGreater(len(names), 20)
        for name in names:
            self.assertIn("--help", (self.site / f"commands/{name}.html").read_text(), name)
        self.assertIn('id="proleg-image-sign"', (self.site / "commands/image.html").read_text())

    def test_the_core_has_its_interfaces(self):
        self.assertIn('id="class-kernel"', (self.site / "interfaces/shared_kernel.html").read_text().lower())

    def test_search_finds_a_word_in_a_page_that_was_opened_from_a_file(self):
        with tempfile.TemporaryDirectory() as profile:
            page = subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={profile}",
                                   "--virtual-time-budget=20000", "--dump-dom", f"file://{self.site}/commands/simulate.html?q=watchdog"],
                                  stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, timeout=300).stdout
        self.assertRegex(page, r"\d+ matching documents")


if __name__ == "__main__":
    Site.source, Site.programs = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    del sys.argv[1:]
    unittest.main()

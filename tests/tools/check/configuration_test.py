"""What `cmake --preset host` does without the packages of the tests.

A stand-in for dpkg-query says that two of them are not installed. usage: configuration_test.py SOURCE_FOLDER
"""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

MISSING = ("clang", "libgtest-dev")


class ConfigurationTest(unittest.TestCase):
    source = Path()

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        folder = Path(temporary.name)
        self.build = folder / "build"
        stand_in = folder / "bin/dpkg-query"
        stand_in.parent.mkdir()
        stand_in.write_text("#!/bin/sh\nfor word; do\n  case $word in " + "|".join(MISSING) + ") exit 1 ;; esac\ndone\n"
                            "echo 'install ok installed'\n")
        stand_in.chmod(0o755)
        self.environment = dict(os.environ, PATH=f"{stand_in.parent}:{os.environ['PATH']}")

    def configure(self, preset):
        return subprocess.run(["cmake", "--preset", preset, "-B", self.build], cwd=self.source, env=self.environment,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def test_it_names_the_packages_and_the_folder_stays_as_good_as_it_was(self):
        without_tests = self.configure("programs")
        self.assertEqual(without_tests.returncode, 0, without_tests.stdout)
        with_tests = self.configure("host")
        self.assertEqual(with_tests.returncode, 1, with_tests.stdout)
        self.assertIn("sudo apt-get install --no-install-recommends clang libgtest-dev\n", with_tests.stdout)
        # The build configures again, because the cache is newer: with the options that were good.
        build = subprocess.run(["cmake", "--build", self.build, "--target", "help"], env=self.environment,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual(build.returncode, 0, build.stdout)
        self.assertIn("programs: phony", build.stdout)
        self.assertNotIn("identity_test: phony", build.stdout)

    def test_a_first_configuration_names_them_too(self):
        self.assertIn("clang libgtest-dev\n", self.configure("host").stdout)
        self.assertEqual(self.configure("programs").returncode, 0)


if __name__ == "__main__":
    ConfigurationTest.source = Path(sys.argv.pop(1)).resolve()
    unittest.main()

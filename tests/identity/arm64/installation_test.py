#!/usr/bin/env python3
"""The installation for arm64 has the files of that for this computer; only the programs are others.

Usage: installation_test.py BUILD_FOLDER ARM64_BUILD_FOLDER
"""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ELF = b"\x7fELF"
AARCH64 = 183  # e_machine, at byte 18
LONGEST = 600  # s


def files_below(prefix):
    return {str(path.relative_to(prefix)): path for path in prefix.rglob("*") if path.is_symlink() or not path.is_dir()}


class Installation(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def install(self, build, name):
        prefix = Path(self.folder.name) / name
        result = subprocess.run(["cmake", "--install", build, "--prefix", prefix], capture_output=True, text=True, timeout=LONGEST)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return prefix

    def test_the_files_are_the_same_but_for_the_processor_of_the_programs(self):
        here, there = self.install(BUILD, "amd64"), self.install(ARM64, "arm 64")
        expected, found = files_below(here), files_below(there)
        # The optimiser on a cluster needs Open MPI, which is built in if it is installed.
        cluster = {"lib/proleg/bin/proleg-optimise-mpi", "share/man/man1/proleg-optimise-mpi.1"}
        self.assertEqual(sorted(set(found) - cluster), sorted(set(expected) - cluster))
        programs = equal = 0
        for name, file in found.items():
            if file.is_symlink():
                self.assertEqual(os.readlink(file), os.readlink(expected[name]), name)
                continue
            contents = file.read_bytes()
            if contents.startswith(ELF) and name.startswith("lib/proleg/"):
                programs += 1
                self.assertEqual(int.from_bytes(contents[18:20], "little"), AARCH64, name)
            else:
                equal += 1
                self.assertEqual(contents, expected[name].read_bytes(), name)
        print(f"{len(found)} files: {programs} programs for arm64, {equal} other files are equal", flush=True)
        self.assertGreater(programs, 30)

        command = (ARM64 / "emulated/proleg").read_text().replace(str(ARM64 / "bin"), str(there / "lib/proleg/bin"))
        words = ("simulate", "caterpillar", "--seconds", "2", "--json")
        result = subprocess.run(["sh", "-c", command, "proleg", *words], capture_output=True, text=True, timeout=LONGEST,
                                cwd=self.folder.name)
        self.assertEqual(result.returncode, 0, result.stderr)
        simulated = json.loads(subprocess.run([here / "bin/proleg", *words], capture_output=True, text=True, check=True).stdout)
        self.assertEqual(json.loads(result.stdout)["setpoint_hash"], simulated["setpoint_hash"])


if __name__ == "__main__":
    BUILD, ARM64 = map(Path, sys.argv[1:3])
    if not (ARM64 / "bin/proleg").exists():
        print(f"not run: found no {ARM64}/bin/proleg; tools/arm64 builds it")
        sys.exit(0)
    unittest.main(argv=sys.argv[:1], verbosity=1)

#!/usr/bin/env python3
"""The licences in the package name each function of newlib that is in an image of a module: its copyright holders must be named with the bytes.

usage: copyright_test.py COPYRIGHT_FILE IMAGE_FOLDER
"""

import re
import subprocess
import sys
import unittest
from pathlib import Path

CPU = ("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=soft")


def output_of(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def functions_of(file):
    """Pairs of name and size: the bootloader has its own functions with names of the C library."""
    return {(name, int(size, 16)) for size, name in re.findall(r"(?m)^[0-9a-f]+ ([0-9a-f]+) [TW] (\w+)$",
                                                               output_of("arm-none-eabi-nm", "--print-size", file))}


class Copyright(unittest.TestCase):
    def test_it_names_the_functions_of_newlib_in_the_images(self):
        newlib = set()
        for library in ("libc.a", "libm.a"):
            newlib |= functions_of(output_of("arm-none-eabi-gcc", *CPU, f"-print-file-name={library}").strip())
        self.assertIn("qsort", {name for name, _ in newlib})
        images = sorted(IMAGES.rglob("proleg_*.elf"))
        self.assertGreater(len(images), 1)
        found = {name for image in images for name, _ in functions_of(image) & newlib}
        named = {name for names in re.findall(r"\(newlib: (.*)\)", COPYRIGHT.read_text()) for name in names.split(", ")}
        self.assertEqual(named, found)


if __name__ == "__main__":
    COPYRIGHT, IMAGES = map(Path, sys.argv[1:3])
    unittest.main(argv=sys.argv[:1])

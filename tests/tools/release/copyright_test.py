#!/usr/bin/env python3
"""The licences in the package name the copyright holders of each function of newlib that is in an image of a module, and of each
library whose headers bring code into the programs.

usage: copyright_test.py SOURCE_FOLDER IMAGE_FOLDER
"""

import re
import subprocess
import sys
import unittest
from pathlib import Path

CPU = ("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=soft")

# Folders of headers. The code of these is in the programs, by the names of the libraries in the file.
CODE = {"CLI": "CLI11", "Eigen": "Eigen", "boost": "Boost", "ga": "GAlib", "nlohmann": "nlohmann-json", "pagmo": "pagmo", "pybind11": "pybind11"}
# These only declare what is in libraries that have Debian packages of their own, or in the system.
INTERFACES = {"arpa", "assimp", "console_bridge", "elfutils", "libevdev", "libqhull_r", "linux", "mujoco", "net", "netinet", "ode", "openssl",
              "sodium", "sys", "urdf_model", "urdf_parser"}


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

    def test_it_names_the_libraries_whose_headers_are_in_the_programs(self):
        sources = [file for room in ("host", "shared", "sim", "tools") for file in (SOURCE / room).rglob("*.[ch]pp")]
        folders = {folder for file in sources for folder in re.findall(r"(?m)^#include <(\w+)/", file.read_text())}
        self.assertEqual(folders - INTERFACES, set(CODE))
        for name in CODE.values():
            self.assertRegex(COPYRIGHT.read_text(), rf"(?m)^(Copyright:| )  .*\({name}\)$")


if __name__ == "__main__":
    SOURCE, IMAGES = map(Path, sys.argv[1:3])
    COPYRIGHT = SOURCE / "tools/release.d/copyright.in"
    unittest.main(argv=sys.argv[:1])

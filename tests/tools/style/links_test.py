"""Programs that simulate a gait without modules link neither the program of a module nor a bus nor a master: a change of
these rooms changes no simulation, and no search that is stored.

Usage: links_test.py NINJA BUILD_FOLDER"""
import re
import subprocess
import sys
import unittest

WITHOUT_MODULES = ["confirm", "experiment", "optimise", "receipt", "replay", "simulate", "sweep"]
ROOMS_OF_MODULES = re.compile(
    r"CMakeFiles/((?:firmware|host|sim_mcu)_\w+|shared_(?:broadcast|can|canopen|image|computer_master)"
    r"|sim_(?:bus|fault|hardware_loop|live|serial))\.dir/")


def rooms_of_modules_in(program):
    """Those rooms of modules whose objects Ninja needs for a program."""
    inputs = subprocess.run([ninja, "-C", build, "-t", "inputs", f"bin/proleg-{program}"], check=True, text=True,
                            capture_output=True).stdout
    return sorted(set(ROOMS_OF_MODULES.findall(inputs)))


class Links(unittest.TestCase):
    def test_programs_without_modules_link_no_room_of_modules(self):
        for program in WITHOUT_MODULES:
            with self.subTest(program):
                self.assertEqual(rooms_of_modules_in(program), [])

    def test_a_program_with_modules_links_them(self):
        self.assertLessEqual({"firmware_module", "shared_computer_master", "sim_bus", "sim_hardware_loop"},
                             set(rooms_of_modules_in("hil")))


if __name__ == "__main__":
    ninja, build = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1])

#!/usr/bin/env python3
"""The profiles of boards: what the chip cannot do does not compile, with a line that says what is expected.

Usage: profile_test.py SOURCE_FOLDER COMPILER
"""

import subprocess
import sys
import unittest
from pathlib import Path

PROFILE = "firmware/stm32f405/boards/weact_stm32f405.hpp"
# What changes in a good profile, and what the compiler must say.
BAD = {
    "no CAN pins": ({".can_receive = {'B', 8},\n    .can_transmit = {'B', 9},": ""}, "found no pins of CAN1, expected can_receive PB8"),
    "CAN pins of two pairs": ({".can_transmit = {'B', 9}": ".can_transmit = {'A', 12}"}, "found no pins of CAN1"),
    "CAN pins exchanged": ({"can_receive = {'B', 8}": "can_receive = {'B', 9}", "can_transmit = {'B', 9}": "can_transmit = {'B', 8}"},
                           "found no pins of CAN1"),
    "no crystal": ({".crystal = 8'000'000,": ""}, "expected 8, 12, 16 or 25 MHz"),
    "another crystal": ({"8'000'000": "10'000'000"}, "expected 8, 12, 16 or 25 MHz"),
    "a crystal in MHz": ({"8'000'000": "8"}, "expected 8, 12, 16 or 25 MHz"),
    "servo at another timer": ({".servo = {'A', 5}": ".servo = {'A', 6}"}, "expected PA0, PA5 or PA15, which are TIM2 channel 1"),
    "touch sensors at two ports": ({"{'B', 15}": "{'C', 6}"}, "expected four pins of one port"),
    "three touch sensors": ({", {'B', 15}": ""}, "expected four pins of one port"),
    "potentiometer at a pin without a channel": ({".feedback = Pin{'C', 1}": ".feedback = Pin{'C', 6}"}, "expected PC0 to PC5 or no pin"),
    "console at another controller": ({".console_transmit = Pin{'A', 2}": ".console_transmit = Pin{'A', 9}"}, "expected PA2 and PA3"),
    "half a console": ({".console_receive = Pin{'A', 3}": ".console_receive = {}"}, "expected PA2 and PA3"),
    "LED at the debugger": ({"Switch{{'B', 2}": "Switch{{'A', 13}"}, "expected ports A to C without PA13 and PA14"),
    "LED at a port that the package has not": ({"Switch{{'B', 2}": "Switch{{'E', 2}"}, "expected ports A to C without PA13 and PA14"),
    "LED at the servo": ({"Switch{{'B', 2}": "Switch{{'A', 5}"}, "found a pin that is used twice"),
    "an id without a name": ({".id = 3": ".id = 999"}, "found an id without a name, expected one of shared/image/board_names.hpp"),
}
GOOD = {
    "as it is": {},
    "crystals": {"8'000'000": "25'000'000"},
    "other pins": {".can_receive = {'B', 8}": ".can_receive = {'A', 11}", ".can_transmit = {'B', 9}": ".can_transmit = {'A', 12}",
                   ".servo = {'A', 5}": ".servo = {'A', 15}"},
    "without what may be missing": {".feedback = Pin{'C', 1}": ".feedback = {}", ".console_transmit = Pin{'A', 2}": ".console_transmit = {}",
                                    ".console_receive = Pin{'A', 3}": ".console_receive = {}"},
}


class Profiles(unittest.TestCase):
    source = compiler = None

    def errors(self, changes):
        text = (self.source / PROFILE).read_text()
        for old, new in changes.items():
            self.assertEqual(text.count(old), 1, old)
        for number, (old, _) in enumerate(changes.items()):
            text = text.replace(old, f"<{number}>")
        for number, (_, new) in enumerate(changes.items()):
            text = text.replace(f"<{number}>", new)
        text = text.replace("#pragma once", "") + "\nstatic_assert(proleg::stm32f405::check_board<proleg::stm32f405::boards::weact_stm32f405>());\n"
        result = subprocess.run([self.compiler, "-std=c++20", "-fsyntax-only", "-I", self.source, "-x", "c++", "-"], input=text,
                                capture_output=True, text=True)
        self.assertEqual(result.returncode != 0, bool(result.stderr), result.stderr)
        return result.stderr

    def test_a_profile_that_the_chip_cannot_have_does_not_compile(self):
        for name, (changes, message) in BAD.items():
            with self.subTest(name):
                errors = self.errors(changes)
                self.assertIn("board profile: found", errors)
                self.assertIn(message, errors)

    def test_what_may_change_compiles(self):
        for name, changes in GOOD.items():
            with self.subTest(name):
                self.assertEqual(self.errors(changes), "")


if __name__ == "__main__":
    Profiles.compiler = sys.argv.pop()
    Profiles.source = Path(sys.argv.pop()).resolve()
    unittest.main()

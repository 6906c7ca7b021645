#!/usr/bin/env python3
"""proleg calibrate, with a module whose joint the test turns: its object dictionary behind an slcan adapter over TCP.

Usage: calibrate_test.py PROGRAM_FOLDER
"""

import json
import socket
import struct
import subprocess
import sys
import threading
import time
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
sys.path.append(str(Path(__file__).resolve().parents[2] / "support"))
from waiting import LONGEST

NODE = 3
NO_POWER, POWER = 0x250, 0x237
READING, FITTED, LOWER, UPPER, STORE = (0x2009, 3), (0x2020, 2), (0x2020, 3), (0x2020, 4), (0x1010, 1)
SAVE = 0x65766173


class Module:
    """One module on a bus of its own. Objects: address -> (bytes, value)."""

    def __init__(self, reading=2000, statusword=NO_POWER, **changes):
        self.objects = {(0x6041, 0): (2, statusword), (0x6064, 0): (4, 0x80000000), READING: (2, reading), FITTED: (1, 0),
                        LOWER: (2, 0), UPPER: (2, 0), STORE: (4, 1)}
        self.__dict__.update({"keeps": True, **changes})
        self.stored, self.nmt, self.written = {}, [], []
        self.server = socket.create_server(("127.0.0.1", 0))
        self.address = f"tcp:127.0.0.1:{self.server.getsockname()[1]}"
        self.thread = threading.Thread(target=self.serve, daemon=True)
        self.thread.start()

    def turn(self, *readings):
        """What the next readings are; the last one stays."""
        self.readings = list(readings)

    readings = ()
    count = 0  # of readings

    def read(self, address):
        self.count += address == READING
        if address == READING and self.readings:
            self.objects[READING] = (2, self.readings.pop(0) if len(self.readings) > 1 else self.readings[0])
        return self.objects.get(address)

    def write(self, address, value):
        if address not in self.objects:
            return False
        self.written.append(address)
        if address == STORE:
            self.stored = {place: self.objects[place][1] for place in (FITTED, LOWER, UPPER)} if value == SAVE else {}
        else:
            self.objects[address] = (self.objects[address][0], value)
        return True

    def sdo(self, request):
        index, sub = struct.unpack_from("<HB", request, 1)
        address = index, sub
        head = request[1:4]
        if request[0] == 0x40:
            if found := self.read(address):
                size, value = found
                return bytes([0x43 | (4 - size) << 2]) + head + struct.pack("<I", value)
        elif request[0] & 0xE0 == 0x20 and self.write(address, struct.unpack_from("<I", request, 4)[0]
                                                      & (1 << 8 * self.objects.get(address, (4, 0))[0]) - 1):
            return b"\x60" + head + bytes(4)
        elif request[0] == 0x80:
            return None
        elif request[0] & 0xE0 not in (0x20, 0x40):
            return b"\x80" + head + struct.pack("<I", 0x05040001)  # no block transfers
        return b"\x80" + head + struct.pack("<I", 0x06020000)

    def receive(self, identifier, data):
        """Returns the frame that the module sends."""
        if identifier == 0x600 + NODE and (answer := self.sdo(data)):
            return 0x580 + NODE, answer
        if identifier == 0 and data[1] in (0, NODE):
            self.nmt.append(data[0])
            if data[0] == 0x81:
                for address in self.stored if self.keeps else ():
                    self.objects[address] = (self.objects[address][0], self.stored[address])
                return 0x700 + NODE, b"\0"
        return None

    @staticmethod
    def next_character(line):
        try:
            return line.read(1)
        except ConnectionResetError:
            return b""  # the program has ended

    def serve(self):
        connection = self.server.accept()[0]
        self.server.close()
        with connection, connection.makefile("rwb", buffering=0) as line:
            word = b""
            while character := self.next_character(line):
                if character != b"\r":
                    word += character
                    continue
                if word.startswith(b"t"):
                    answers = b"z\r"
                    frame = self.receive(int(word[1:4], 16), bytes.fromhex(word[5:].decode()))
                    if frame:
                        answers += b"t%03X%d%s\r" % (frame[0], len(frame[1]), frame[1].hex().upper().encode())
                else:
                    answers = {b"V": b"V1010\r", b"N": b"N0000\r"}.get(word[:1], b"\r")
                line.write(answers)
                word = b""


class Calibration:
    """The program, and what it prints."""

    def __init__(self, module, *options):
        self.process = subprocess.Popen([PROGRAMS / "proleg-calibrate", str(NODE), "--bus", module.address, *options],
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def event(self, name):
        for line in self.process.stdout:
            if (event := json.loads(line))["event"] == name:
                return event
        raise AssertionError(f"no {name}: {self.process.stderr.read()}")

    def wait_for_readings(self, reading):
        """Until all readings that count are this one."""
        equal = 0
        while equal < 9:
            equal = equal + 1 if self.event("reading")["reading"] == reading else 0

    def answer(self, word):
        self.process.stdin.write(word + "\n")
        self.process.stdin.flush()

    def end(self):
        self.output, self.errors = self.process.communicate(timeout=LONGEST)
        return self.process.returncode

    @property
    def is_asking(self):
        """Whether it has asked for the second angle, as it says to people."""
        self.said = getattr(self, "said", b"") + self.process.stderr.buffer.read1()
        return b"to +90" in self.said


class CalibrateTest(unittest.TestCase):
    def calibrate(self, module, lower, upper):
        run = Calibration(module, "--json-lines")
        self.assertEqual(run.event("question"), {"event": "question", "question": "lower", "node": NODE})
        module.turn(lower)
        run.wait_for_readings(lower)
        run.answer("here")
        self.assertEqual(run.event("question")["question"], "upper")
        module.turn(upper)
        run.wait_for_readings(upper)
        run.answer("here")
        return run

    def test_a_module_learns_its_potentiometer(self):
        for lower, upper in ((410, 3686), (3686, 410)):
            module = Module()
            run = self.calibrate(module, lower, upper)
            result = run.event("result")["value"]
            self.assertEqual(run.end(), 0)
            self.assertEqual(result["now"], {"fitted": True, "at_minus_90": lower, "at_plus_90": upper})
            self.assertEqual(result["before"], {"fitted": False, "at_minus_90": 0, "at_plus_90": 0})
            self.assertEqual(module.stored, {FITTED: 1, LOWER: lower, UPPER: upper})
            self.assertEqual(module.nmt, [0x80, 0x81], "pre-operational, then a reset")

    def test_a_person_presses_enter(self):
        module = Module(reading=500)
        run = Calibration(module)
        run.answer("")
        while run.process.poll() is None and not run.is_asking:
            pass
        module.turn(3000)
        count = module.count
        while run.process.poll() is None and module.count < count + 9:
            time.sleep(0.05)
        run.answer("")
        self.assertEqual(run.end(), 0, run.errors)
        self.assertIn("reads 500 at -90 degrees and 3000 at +90 degrees; stored", run.output)

    def test_a_joint_that_moves_is_asked_for_again(self):
        module = Module()
        run = Calibration(module, "--json-lines")
        run.event("question")
        module.turn(*[400, 900] * 500, 410)
        run.answer("here")
        self.assertIn("hold it still", run.event("refused")["text"])
        self.assertEqual(run.event("question")["question"], "lower")
        module.turn(410)
        run.wait_for_readings(410)
        run.answer("here")
        self.assertEqual(run.event("question")["question"], "upper")
        run.answer("quit")
        self.assertEqual(run.end(), 1)
        self.assertIn("nothing was written", run.errors)
        self.assertEqual(module.written, [])

    def test_without_a_potentiometer_nothing_is_written(self):
        module = Module()
        run = self.calibrate(module, 2000, 2100)
        self.assertEqual(run.end(), 1)
        self.assertIn("found the readings 2000 and 2100, expected at least 200 between them", run.errors)
        self.assertEqual(module.written, [])

    def test_a_servo_with_power_is_left_alone(self):
        module = Module(statusword=POWER)
        run = Calibration(module)
        self.assertEqual(run.end(), 1)
        self.assertIn("its servo has power", run.errors)
        self.assertEqual((module.nmt, module.written), ([], []))

    def test_a_module_that_cannot_is_named(self):
        old = Module()
        del old.objects[READING]
        for module, error in ((old, "0x2009:3"), (Module(reading=0xFFFF), "does not read the potentiometer")):
            run = Calibration(module)
            self.assertEqual(run.end(), 1)
            self.assertIn(error, run.errors)
            self.assertEqual(module.written, [])

    def test_a_module_that_has_not_kept_its_values_is_named(self):
        module = Module(keeps=False)
        original = module.receive

        def forget(identifier, data):
            answer = original(identifier, data)
            if identifier == 0 and data[0] == 0x81:
                module.objects.update({FITTED: (1, 0), LOWER: (2, 0), UPPER: (2, 0)})
            return answer

        module.receive = forget
        run = self.calibrate(module, 400, 3000)
        self.assertEqual(run.end(), 1)
        self.assertIn("other values after its restart", run.errors)

    def test_the_end_of_input_and_of_the_bus_end_it(self):
        module = Module()
        run = Calibration(module, "--json-lines")
        run.event("question")
        run.process.stdin.close()
        run.process.stdin = None
        self.assertEqual(run.end(), 1)
        self.assertIn("standard input has ended", run.errors)
        self.assertEqual(module.written, [])

    def test_bad_words_open_no_bus(self):
        for words in (("all",), ("1,2",), ("0",), ("x",), (), ("3", "--json", "--json-lines")):
            done = subprocess.run([PROGRAMS / "proleg-calibrate", *words, "--bus", "tcp:127.0.0.1:1"], capture_output=True,
                                  text=True, timeout=LONGEST)
            self.assertEqual(done.returncode, 2, (words, done.stderr))
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)


if __name__ == "__main__":
    PROGRAMS = Path(sys.argv.pop(1)).resolve()
    unittest.main(verbosity=1)

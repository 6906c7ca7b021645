#!/usr/bin/env python3
"""A tired user asks 'proleg doctor' about a bus of 'proleg bus', and about adapters that do not work.

Usage: doctor_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import fcntl
import json
import os
import pty
import signal
import socket
import subprocess
import sys
import threading
import tty
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
import robot_on_the_table_test as table
from robot_on_the_table_test import Bus, LONGEST, RealTimeTest, proleg, start_drive, wait_for_drives, wait_until


def examine(bus, **options):
    """The exit status and the JSON object."""
    result = subprocess.run([table.PROGRAMS / "proleg-doctor", "--bus", bus, "--json"], capture_output=True, text=True,
                            timeout=LONGEST, **options)
    if result.returncode not in (0, 1) or not result.stdout:
        raise AssertionError((result.returncode, result.stderr))
    return result.returncode, json.loads(result.stdout)


def codes(report):
    return [finding["code"] for finding in report["findings"]]


def examine_until(bus, *expected):
    """The first report with these findings. An answer that takes longer than 60 ms, as on a busy computer, is none: the tests of
    the examination say what is found when, in the time of a simulated bus."""
    report = {}

    def is_found():
        nonlocal report
        status, report = examine(bus)
        return (status, codes(report)) == (1 if expected else 0, list(expected))

    wait_until(is_found, lambda: f"found {report}, expected {expected}")
    return report


def wait_for_text(bus, status, line):
    """What it says to a person, once it has this line."""
    finished = None

    def says_so():
        nonlocal finished
        finished = proleg("doctor", "--bus", bus)
        return finished.returncode == status and line in finished.stdout

    wait_until(says_so, lambda: finished.stdout)
    return finished.stdout


class Adapter:
    """A serial line with something at its other end that answers each line by a function of its text."""

    def __init__(self, answer):
        self.end, self.line = pty.openpty()
        tty.setraw(self.line)
        self.path = os.ttyname(self.line)
        self.answer = answer
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        received = b""
        while True:
            try:
                received += os.read(self.end, 4096)
                while b"\r" in received:
                    command, received = received.split(b"\r", 1)
                    os.write(self.end, self.answer(command))
            except OSError:
                return

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.close(self.line)  # which ends the thread: it must not read from the next adapter with this number
        self.thread.join(LONGEST)
        os.close(self.end)


class Doctor(RealTimeTest):
    def test_a_healthy_robot_that_waits_and_that_moves_has_no_fault(self):
        with Bus() as bus:
            for address in (bus.pty, bus.tcp):
                report = examine_until(address)
                self.assertEqual([node["node"] for node in report["observations"]["nodes"]], [1, 2, 3, 4, 5])
            text = wait_for_text(bus.pty, 0, "no fault found")
            self.assertIn("nodes 1, 2, 3, 4, 5", text)
            drive = start_drive(bus.tcp)
            wait_for_drives(bus.pty, "operation enabled")
            self.assertGreater(examine_until(bus.pty)["observations"]["syncs"], 0)
            drive.send_signal(signal.SIGINT)
            result = json.loads(drive.communicate(timeout=LONGEST)[0])
            self.assertEqual(drive.returncode, 0)
            self.assertEqual(result["differences"], 0, "the examination has not disturbed the robot")

    def test_a_module_without_a_node_id_and_a_robot_whose_host_died(self):
        with Bus("--fresh", "3") as bus:
            examine_until(bus.tcp, "module_without_node_id")
            text = wait_for_text(bus.tcp, 1, "1. There are modules without a node id")
            self.assertIn("To do: ", text)
        with Bus() as bus:
            drive = start_drive(bus.tcp)
            wait_for_drives(bus.pty, "operation enabled")
            drive.kill()
            drive.communicate(timeout=LONGEST)
            wait_for_drives(bus.pty, "quick stop")
            examine_until(bus.pty, "quick_stop")

    def test_a_simulated_bus_of_ones_own(self):
        examine_until(f"sim:{table.SOURCE / table.SCENARIO}")

    def test_there_is_no_such_bus(self):
        with socket.socket() as nobody:
            nobody.bind(("127.0.0.1", 0))
            closed = f"tcp:127.0.0.1:{nobody.getsockname()[1]}"
            for bus, expected in (("can77", {"no_interface", "kernel_without_can"}), ("lo", {"wrong_kind"}),
                                  ("serial:/dev/missing", {"no_device"}), ("serial:/etc/passwd", {"wrong_kind", "no_rights"}),
                                  (closed, {"bus_not_reached"})):
                status, report = examine(bus)
                self.assertEqual(status, 1, bus)
                self.assertEqual(len(report["findings"]), 1, (bus, report))
                self.assertIn(codes(report)[0], expected, bus)
                self.assertIsNone(report["observations"], bus)

    def test_bad_words_end_it(self):
        for words in (("--bus", "nonsense:x"), ("--bsu", "can0"), ("can0",)):
            result = proleg("doctor", *words)
            self.assertEqual(result.returncode, 2, words)
            self.assertEqual(len(result.stderr.splitlines()), 1, words)
            self.assertEqual(result.stdout, "")

    def test_adapters_that_do_not_work(self):
        def refuse_bit_rate(command):
            return b"\a" if command in (b"S8", b"O") else b"V1013\r" if command == b"V" else b"\r"

        for answer, code in ((lambda command: b"", "adapter_silent"),
                             (lambda command: b"AT+ERROR\r\n\xff\x00garbage\r", "adapter_not_slcan"),
                             (refuse_bit_rate, "adapter_refuses")):
            with Adapter(answer) as adapter:
                report = examine_until(f"serial:{adapter.path}", code)
                self.assertIn(adapter.path, report["findings"][0]["what"])

    def test_an_adapter_behind_which_nobody_is(self):
        """As Proleg's gateway has it: the frames are taken, and the bus reports that nobody acknowledges them."""
        def alone(command):
            if command[:1] == b"t":
                return b"z\re1a\rsp000128\r"
            return b"V1013\r" if command == b"V" else b"NA123\r" if command == b"N" else b"\r"

        with Adapter(alone) as adapter:
            examine_until(f"serial:{adapter.path}", "no_acknowledgement")

    def test_another_program_uses_the_adapter(self):
        with Adapter(lambda command: b"\r") as adapter:
            fcntl.flock(adapter.line, fcntl.LOCK_EX)
            status, report = examine(f"serial:{adapter.path}")
            self.assertEqual((status, codes(report)), (1, ["device_in_use"]))
            self.assertIn(f"(process {os.getpid()})", report["findings"][0]["what"])

    def test_the_user_may_not_use_the_adapter(self):
        with Adapter(lambda command: b"\r") as adapter:
            os.chmod(adapter.path, 0)
            # Root may use everything.
            options = {"user": 65534, "group": 65534, "extra_groups": []} if os.geteuid() == 0 else {}
            try:
                status, report = examine(f"serial:{adapter.path}", **options)
            except PermissionError:
                self.skipTest("the programs are in a folder of root")
            self.assertEqual((status, codes(report)), (1, ["no_rights"]))
            self.assertIn("host/udev/70-proleg.rules", report["findings"][0]["to_do"])


if __name__ == "__main__":
    table.SOURCE = Path(sys.argv[1])
    table.PROGRAMS = Path(sys.argv[2])
    unittest.main(argv=sys.argv[:1], verbosity=1)

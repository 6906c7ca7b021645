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
from robot_on_the_table_test import Bus, LONGEST, proleg, start_drive, wait_for_drives


def examine(bus, **options):
    """The exit status and the JSON object."""
    result = subprocess.run([table.PROGRAMS / "proleg-doctor", "--bus", bus, "--json"], capture_output=True, text=True,
                            timeout=LONGEST, **options)
    if result.returncode not in (0, 1) or not result.stdout:
        raise AssertionError((result.returncode, result.stderr))
    return result.returncode, json.loads(result.stdout)


def codes(report):
    return [finding["code"] for finding in report["findings"]]


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


class Doctor(unittest.TestCase):
    def test_a_healthy_robot_that_waits_and_that_moves_has_no_fault(self):
        with Bus() as bus:
            for address in (bus.pty, bus.tcp):
                status, report = examine(address)
                self.assertEqual(codes(report), [], report)
                self.assertEqual(status, 0)
                self.assertEqual([node["node"] for node in report["observations"]["nodes"]], [1, 2, 3, 4, 5])
            text = proleg("doctor", "--bus", bus.pty)
            self.assertEqual(text.returncode, 0, text.stdout)
            self.assertIn("no fault found", text.stdout)
            self.assertIn("nodes 1, 2, 3, 4, 5", text.stdout)
            drive = start_drive(bus.tcp)
            wait_for_drives(bus.pty, "operation enabled")
            status, report = examine(bus.pty)
            self.assertEqual(codes(report), [], report)
            self.assertGreater(report["observations"]["syncs"], 10)
            drive.send_signal(signal.SIGINT)
            result = json.loads(drive.communicate(timeout=LONGEST)[0])
            self.assertEqual(drive.returncode, 0)
            self.assertEqual(result["differences"], 0, "the examination has not disturbed the robot")

    def test_a_board_without_a_current_sensor_is_named_and_is_no_fault(self):
        image = table.SOURCE / "build/stm32f405/bin/weact-stm32f405/proleg_stm32f405.elf"
        with Bus("--modules", "2=mcu", "--image", image) as bus:
            status, report = examine(bus.pty)
            # The chip has the option bytes of the factory.
            self.assertEqual((status, codes(report)), (1, ["no_brown_out_reset"]), report)
            self.assertEqual([node["current_sensor"] for node in report["observations"]["nodes"]],
                             [True, False, True, True, True])
            text = proleg("doctor", "--bus", bus.pty)
            self.assertIn("Without a current sensor: node 2.", text.stdout)

    def test_a_module_without_a_node_id_and_a_robot_whose_host_died(self):
        with Bus("--fresh", "3") as bus:
            status, report = examine(bus.tcp)
            self.assertEqual((status, codes(report)), (1, ["module_without_node_id"]))
            text = proleg("doctor", "--bus", bus.tcp)
            self.assertEqual(text.returncode, 1)
            self.assertIn("1. There are modules without a node id", text.stdout)
            self.assertIn("To do: ", text.stdout)
        with Bus() as bus:
            drive = start_drive(bus.tcp)
            wait_for_drives(bus.pty, "operation enabled")
            drive.kill()
            drive.communicate(timeout=LONGEST)
            wait_for_drives(bus.pty, "quick stop")
            self.assertEqual(codes(examine(bus.pty)[1]), ["quick_stop"])

    def test_a_simulated_bus_of_ones_own(self):
        self.assertEqual(codes(examine(f"sim:{table.SOURCE / table.SCENARIO}")[1]), [])

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
                status, report = examine(f"serial:{adapter.path}")
                self.assertEqual((status, codes(report)), (1, [code]), report)
                self.assertIn(adapter.path, report["findings"][0]["what"])

    def test_an_adapter_behind_which_nobody_is(self):
        """As Proleg's gateway has it: the frames are taken, and the bus reports that nobody acknowledges them."""
        def alone(command):
            if command[:1] == b"t":
                return b"z\re1a\rsp000128\r"
            return b"V1013\r" if command == b"V" else b"NA123\r" if command == b"N" else b"\r"

        with Adapter(alone) as adapter:
            status, report = examine(f"serial:{adapter.path}")
            self.assertEqual((status, codes(report)), (1, ["no_acknowledgement"]), report)

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
            self.assertIn("70-proleg.rules (docs/installing.md)", report["findings"][0]["to_do"])


if __name__ == "__main__":
    table.SOURCE = Path(sys.argv[1])
    table.PROGRAMS = Path(sys.argv[2])
    unittest.main(argv=sys.argv[:1], verbosity=1)

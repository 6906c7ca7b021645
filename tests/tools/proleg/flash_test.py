#!/usr/bin/env python3
"""A user flashes the modules of 'proleg bus', makes mistakes, and pulls plugs.

Usage: flash_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import json
import os
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
import robot_on_the_table_test as table
from robot_on_the_table_test import Bus, LONGEST, Listener, proleg, run_events, start_drive, wait_until

SLOT = 0x08020200
ALL = [1, 2, 3, 4, 5]


def program(seed, size=14_000):
    """A body that looks like a program: a vector table, then anything."""
    words = [0x20000800, SLOT + 0x201] + [(seed * 2654435761 + i * 40503) & 0xFFFFFFFF for i in range(size // 4 - 2)]
    return struct.pack(f"<{len(words)}I", *words)


def version_of(image):
    return json.loads(proleg("image", "info", image, "--json").stdout)["images"][0]["version"]


class Flash(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.images = {version: cls.make_image(version) for version in ("0.1.0", "0.2.0", "0.3.0")}

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def make_image(cls, version, board=1, content=None):
        body = Path(cls.folder.name) / f"{version}_{board}.bin"
        body.write_bytes(content or program(int(version[2])))
        image = body.with_suffix(".pimg")
        result = proleg("image", "make", body, "--output", image, "--board", str(board), "--address", hex(SLOT),
                        "--version", version, "--protocol", "0x0100", "--fingerprint", "12345678", "--schema", "2",
                        "--commit", version[2] * 40)
        if result.returncode != 0:
            raise AssertionError(result.stderr)
        return image

    def setUp(self):
        self.work = tempfile.TemporaryDirectory()
        self.addCleanup(self.work.cleanup)

    def start(self, bus, version, *options):
        image = self.images.get(version, version)
        return subprocess.Popen([table.PROGRAMS / "proleg-flash", "--bus", bus, "--json", image, *options],
                                cwd=self.work.name, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def start_until(self, bus, frames, version, *options):
        """The process, when that many frames of any program have been on the bus."""
        other = Listener(bus.tcp)
        process = self.start(bus.tcp, version, *options)
        wait_until(lambda: other.received() >= frames or process.poll() is not None, "frames on the bus", 0.01)
        other.end()
        return process

    def flash(self, bus, version, *options, status=0):
        """The JSON object of a run with this exit status."""
        process = self.start(bus, version, *options)
        out, self.errors = process.communicate(timeout=LONGEST)
        self.assertEqual(process.returncode, status, self.errors + out)
        return json.loads(out) if out else {}

    def assert_all_run(self, report, version, nodes=ALL):
        self.assertEqual([module["node"] for module in report["modules"]], nodes)
        for module in report["modules"]:
            self.assertTrue(module["good"], module)
            self.assertEqual(module["now"]["version"], version)
            self.assertEqual(module["now"]["sha256"], report["sha256"])
            self.assertTrue(module["now"]["running"] and module["now"]["confirmed"])
            self.assertEqual(module["changed_settings"], [])

    def files(self):
        return sorted(os.listdir(self.work.name))

    def test_all_modules_run_the_image_and_the_same_image_again_is_not_written(self):
        with Bus() as bus:
            tried = self.flash(bus.tcp, "0.2.0", "--dry-run")
            self.assertEqual({module["action"] for module in tried["modules"]}, {"flash"})
            report = self.flash(bus.tcp, "0.2.0")
            self.assertEqual({module["before"]["version"] for module in report["modules"]}, {"0.0.0"}, "dry run")
            self.assert_all_run(report, "0.2.0")
            self.assertGreater(report["transfer_s"], 0)
            again = self.flash(bus.pty, "0.2.0")
            self.assert_all_run(again, "0.2.0")
            self.assertEqual({module["action"] for module in again["modules"]}, {"same"})
            self.assertEqual(again["transfer_s"], 0)
            self.assertEqual(self.files(), [], "the settings are as before, so that their file is not needed")
            text = proleg("flash", "--bus", bus.tcp, self.images["0.2.0"]).stdout
            self.assertIn("node 3                 same    runs 0.2.0 (22222222) already", text)

    def follow(self, bus, version, *options, status=0):
        """The events of a run with this exit status."""
        events = run_events("flash", "--bus", bus, self.images.get(version, version), *options, folder=self.work.name)
        self.assertEqual(events.process.returncode, status, events.errors)
        return events

    def test_a_program_follows_an_update(self):
        with Bus() as bus:
            tried = self.flash(bus.tcp, "0.2.0", "--dry-run")
            events = self.follow(bus.tcp, "0.2.0", "--dry-run")
            self.assertEqual(events.names(), ["verdicts", "result"])
            self.assertEqual(events.result(), tried)
            self.assertEqual(events.all[0], {
                "event": "verdicts", "version": "0.2.0", "sha256": tried["sha256"], "modules": [
                    {"node": module["node"], "serial": module["serial"], "board": 1, "before": {"version": "0.0.0"},
                     "action": "flash", "reason": module["reason"]} for module in tried["modules"]]})

            events = self.follow(bus.tcp, "0.2.0")
            self.assertEqual(events.errors, "")
            report = events.result()
            self.assert_all_run(report, "0.2.0")
            progress = events.all[1:-2]
            self.assertEqual({event["event"] for event in progress}, {"progress"})
            self.assertEqual(events.names()[-2], "ended")
            places = [(module["node"], module["serial"]) for module in report["modules"]]
            for event in (*progress, events.all[-2]):
                self.assertEqual([(module["node"], module["serial"]) for module in event["modules"]], places)
            duration_s = report["transfer_s"] + report["installation_s"] + report["restart_s"]
            self.assertLessEqual(len(progress), 10 * duration_s + 2, "ten times a second, and at the end")
            self.assertGreaterEqual(len(progress), duration_s, "it is followed all the time")
            for index in range(len(ALL)):
                parts = [event["modules"][index]["part"] for event in progress]
                self.assertEqual(parts, sorted(parts))
                self.assertTrue(0 <= parts[0] and parts[-1] == 1, parts)
                states = list(dict.fromkeys(event["modules"][index]["state"] for event in progress))
                self.assertEqual([states[0], states[-1]], ["receives the image", "runs the image"])
                self.assertIn("installs it", states)
                self.assertEqual(events.all[-2]["modules"][index],
                                 {"node": ALL[index], "serial": places[index][1], "outcome": "runs the image", "good": True})
            self.assertEqual(self.files(), [])

    def test_each_update_has_its_end_and_a_refusal_is_a_result(self):
        foreign = self.make_image("0.3.0", board=2)
        with Bus() as bus:
            events = self.follow(bus.tcp, "0.2.0", "--canary", "--node", "1-3")
            updates = [event["modules"] for event in events.all if event["event"] == "ended"]
            self.assertEqual([[module["node"] for module in modules] for modules in updates], [[1], [2, 3]])
            events = self.follow(bus.tcp, foreign, "--node", "1", status=1)
            self.assertEqual(events.names(), ["verdicts", "result"])
            self.assertEqual([module["action"] for module in events.all[0]["modules"]], ["refuse"])
            self.assertEqual(events.all[0]["modules"][0]["before"], {"version": "0.2.0"})
            self.assertIn("is board 1", events.result()["modules"][0]["reason"])
            self.assertEqual(self.flash(bus.tcp, foreign, "--node", "1", status=1), events.result())
            self.assertEqual(self.errors, events.errors)

    def test_virtual_chips_take_another_version_of_their_program(self):
        built = table.SOURCE / "build/stm32f405/bin/proleg_stm32f405.pimg"
        newer = self.make_image("0.9.0", content=built.read_bytes()[512:])
        with Bus("--modules", "2,4=mcu") as bus:
            report = self.flash(bus.tcp, newer, "--node", "2,4")
            self.assertEqual({module["before"]["version"] for module in report["modules"]}, {version_of(built)})
            self.assert_all_run(report, "0.9.0", [2, 4])

    def test_some_modules_and_one_first(self):
        with Bus() as bus:
            report = self.flash(bus.tcp, "0.2.0", "--node", "2,4")
            self.assert_all_run(report, "0.2.0", [2, 4])
            report = self.flash(bus.tcp, "0.3.0", "--canary")
            self.assert_all_run(report, "0.3.0")
            missing = self.flash(bus.tcp, "0.3.0", "--node", "2,9", status=1)
            self.assertEqual(missing, {})
            self.assertIn("no joint module answers as node 9", self.errors)

    def test_an_older_image_and_one_for_another_board_need_a_word(self):
        foreign = self.make_image("0.3.0", board=2)
        with Bus() as bus:
            self.flash(bus.tcp, "0.2.0", "--node", "1-2")
            report = self.flash(bus.tcp, "0.1.0", "--node", "1", status=1)
            self.assertEqual(report["modules"][0]["action"], "refuse")
            self.assertIn("--allow-downgrade", report["modules"][0]["reason"])
            self.assertEqual(report["modules"][0]["now"]["version"], "0.2.0")
            self.assert_all_run(self.flash(bus.tcp, "0.1.0", "--node", "1", "--allow-downgrade"), "0.1.0", [1])
            report = self.flash(bus.tcp, foreign, "--node", "2", status=1)
            self.assertIn("is board 1 (reference), the image is for board 2 (olimex-stm32-p405)", report["modules"][0]["reason"])
            self.assert_all_run(self.flash(bus.tcp, foreign, "--node", "2", "--force-board"), "0.3.0", [2])

    def test_settings_stay(self):
        with Bus() as bus:
            self.assertEqual(proleg("set", "3", "0x200A:1", "1234", "--bus", bus.tcp).returncode, 0)
            self.assertEqual(proleg("set", "3", "0x1010:1", "0x65766173", "--bus", bus.tcp).returncode, 0)
            kept = Path(self.work.name) / "kept.params"
            self.assert_all_run(self.flash(bus.tcp, "0.2.0", "--node", "3", "--settings", kept), "0.2.0", [3])
            self.assertIn("0x200A:1\t1234", kept.read_text())
            values = json.loads(proleg("get", "3", "0x200A:1", "--bus", bus.tcp, "--json").stdout)["values"]
            self.assertEqual(values[0]["raw"], 1234)

    def test_a_host_that_is_killed_anywhere_leaves_modules_that_the_next_run_flashes(self):
        with Bus() as bus:
            for number, frames in enumerate((50, 400, 1500, 3000)):
                version = ("0.2.0", "0.3.0")[number % 2]
                process = self.start_until(bus, frames, version, "--allow-downgrade")
                process.send_signal(signal.SIGKILL if number % 2 == 0 else signal.SIGINT)
                process.communicate(timeout=LONGEST)
                self.assertIn(process.returncode, (-signal.SIGKILL, 0, 1))
            errors = ""

            def all_are_flashed():
                """A bootloader that installs hears nothing; it starts its program after ten seconds at most."""
                nonlocal errors
                process = self.start(bus.tcp, "0.1.0", "--allow-downgrade")
                out, errors = process.communicate(timeout=LONGEST)
                return process.returncode == 0 and len(json.loads(out)["modules"]) == len(ALL)

            wait_until(all_are_flashed, lambda: errors)
            self.assert_all_run(self.flash(bus.tcp, "0.1.0"), "0.1.0")

    def test_a_module_that_is_stopped_is_flashed_too(self):
        with Bus() as bus:
            table.proleg("nmt", "stop", "2", "--bus", bus.tcp)
            self.assert_all_run(self.flash(bus.tcp, "0.2.0"), "0.2.0")
            for node in ALL:
                table.proleg("nmt", "stop", str(node), "--bus", bus.tcp)
            self.assert_all_run(self.flash(bus.tcp, "0.3.0"), "0.3.0")

    def test_the_same_command_right_after_an_interrupted_one_completes_it(self):
        with Bus() as bus:
            for version, frames in (("0.2.0", 100), ("0.3.0", 1200), ("0.1.0", 2500)):
                process = self.start_until(bus, frames, version, "--allow-downgrade")
                process.send_signal(signal.SIGTERM)
                process.communicate(timeout=LONGEST)
                self.assert_all_run(self.flash(bus.tcp, version, "--allow-downgrade"), version)

    def test_settings_replace_no_file_of_another_kind(self):
        image = self.make_image("0.2.0")
        before = Path(image).read_bytes()
        with Bus() as bus:
            self.flash(bus.tcp, image, "--settings", image, status=2)
            self.assertIn("no file of parameters", self.errors)
        self.assertEqual(Path(image).read_bytes(), before)

    def test_two_hosts_at_once(self):
        with Bus() as bus:
            first = self.start_until(bus, 1500, self.make_image("0.4.0", content=program(4, 80_000)))
            self.flash(bus.pty, "0.3.0", status=1)
            # On a busy computer it may not have heard the first host, and then no module obeys it.
            self.assertRegex(self.errors, "another host|5 of 5 modules do not run the image")
            out, errors = first.communicate(timeout=LONGEST)
            self.assertEqual(first.returncode, 0, errors)
            self.assert_all_run(json.loads(out), "0.4.0")

    def test_a_robot_that_is_driven_is_left_alone(self):
        with Bus() as bus:
            drive = start_drive(bus.tcp)
            try:
                table.wait_for_drives(bus.pty, "operation enabled")
                self.flash(bus.pty, "0.2.0", status=1)
                self.assertIn("another host drives the robot", self.errors)
            finally:
                drive.send_signal(signal.SIGINT)
                drive.communicate(timeout=LONGEST)

    def test_a_bus_full_of_other_traffic_only_takes_longer(self):
        with Bus() as bus:
            other = Listener(bus.pty)
            is_over = threading.Event()

            def send():
                """About two thirds of the bus, above all else. The next frames come after the last ones were sent, so that
                they leave the same share of the bus free if the clock of the robot stands still."""
                sent = 0
                while not is_over.is_set():
                    try:
                        other.line.write(b"t0508AAAAAAAAAAAAAAAA\r" * 20)
                    except OSError:
                        return
                    sent += 20
                    while other.confirmed() < sent and not is_over.is_set():
                        time.sleep(0.001)
                    time.sleep(0.001)

            thread = threading.Thread(target=send, daemon=True)
            thread.start()
            try:
                self.assert_all_run(self.flash(bus.tcp, "0.2.0"), "0.2.0")
            finally:
                is_over.set()
                thread.join(timeout=LONGEST)

    def test_through_the_serial_line_of_a_gateway_which_is_the_last(self):
        with Bus("--gateway", "3=0") as bus:
            line = bus.find(r"--bus (\S+)$")
            self.assert_all_run(self.flash(line, "0.2.0"), "0.2.0")

    def test_a_module_without_a_node_id_is_flashed_too(self):
        with Bus("--fresh", "4") as bus:
            report = self.flash(bus.tcp, "0.2.0")
            self.assert_all_run(report, "0.2.0", [1, 2, 3, 5, 0])

    def test_files_that_are_no_images_and_options_that_exclude_each_other(self):
        damaged = Path(self.work.name) / "damaged.pimg"
        image = self.images["0.2.0"].read_bytes()
        with Bus() as bus:
            for cut in (0, 100, 512, len(image) - 4):
                damaged.write_bytes(image[:cut])
                self.flash(bus.tcp, damaged, status=2)
                self.assertIn("damaged.pimg", self.errors)
                self.assertEqual(len(self.errors.splitlines()), 1)
            for byte in (0, 8, 300, 511, 512, len(image) - 1):
                changed = bytearray(image)
                changed[byte] ^= 0x10
                damaged.write_bytes(changed)
                self.flash(bus.tcp, damaged, status=2)
            damaged.unlink()
            for options in (("--node", "1", "--all"), ("--node", "0"), ("--node", "x"), ("--probe", "stlink"),
                            ("--bare", "--all", "--probe", "dfu")):
                self.flash(bus.tcp, "0.2.0", *options, status=2)
            for options in (("--json",), ("--bare", "--probe", "dfu")):
                self.assertEqual(self.follow(bus.tcp, "0.2.0", *options, status=2).all, [])
            report = self.flash(bus.tcp, "0.2.0", "--dry-run")
            self.assertEqual({module["before"]["version"] for module in report["modules"]}, {"0.0.0"})
        self.flash("tcp:127.0.0.1:1", "0.2.0", status=1)


if __name__ == "__main__":
    table.SOURCE = Path(sys.argv[1])
    table.PROGRAMS = Path(sys.argv[2])
    unittest.main(argv=sys.argv[:1])

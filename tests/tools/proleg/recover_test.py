#!/usr/bin/env python3
"""A tired user lets 'proleg recover' bring back modules of 'proleg bus --broken'.

Usage: recover_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import json
import random
import signal
import struct
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
import robot_on_the_table_test as table
from robot_on_the_table_test import Bus, Events, LONGEST, proleg, run_events, start_drive, wait_for_drives

SEED = 7
ADDRESS = 0x08020200
SICK = ("--broken", "1=hangs", "--broken", "2=faults", "--broken", "3=no-program", "--broken", "4=newer-settings",
        "--broken", "5=duplicate:4")


def recover(bus, *words):
    """The exit status and the JSON object."""
    result = proleg("recover", *words, "--bus", bus, "--json")
    if result.returncode not in (0, 1) or not result.stdout:
        raise AssertionError((result.returncode, result.stderr))
    return result.returncode, json.loads(result.stdout)


def codes(report, member):
    """The codes of the faults of each module, in the order of node ids."""
    return [[fault["code"] for fault in module[member]] for module in report["modules"]]


class Recover(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def image(self, schema):
        """An image that starts well in a simulated module."""
        body = self.folder / "body.bin"
        start = struct.pack("<4I", 0x20000800, ADDRESS + 0x11, ADDRESS + 0x21, ADDRESS + 0x31)
        body.write_bytes(start + random.Random(SEED).randbytes(20_000))
        image = self.folder / f"schema_{schema}.pimg"
        made = proleg("image", "make", body, "--output", image, "--board", "1", "--address", hex(ADDRESS), "--version",
                      "0.2.0", "--protocol", "0x0100", "--fingerprint", "87932128", "--schema", str(schema))
        self.assertEqual(made.returncode, 0, made.stderr)
        return image

    def test_a_robot_that_is_well_is_left_alone(self):
        with Bus() as bus:
            text = proleg("recover", "--wait", "0", "--bus", bus.pty)
            self.assertEqual(text.returncode, 0, text.stderr)
            lines = text.stdout.splitlines()
            self.assertEqual(lines[0].split(), ["module", "serial", "program", "state"])
            self.assertEqual([line.split()[:2] for line in lines[1:]], [["node", str(node)] for node in range(1, 6)])
            self.assertTrue(all(line.endswith(" well") for line in lines[1:]), text.stdout)
            self.assertEqual(text.stderr, "")

    def test_every_module_comes_back(self):
        later = self.image(schema=3)
        with Bus(*SICK) as bus:
            status, report = recover(bus.tcp, "--dry-run", later)
            found = [["starts_badly"], ["starts_badly"], ["no_program"]]
            self.assertEqual((status, codes(report, "found")[:3]), (1, found), report)
            self.assertEqual(sorted(sum(codes(report, "found")[3:], [])),
                             ["duplicate_node_id", "duplicate_node_id", "newer_settings"])
            self.assertEqual([module["done"] for module in report["modules"]], [[]] * 5)

            status, report = recover(bus.tcp)
            self.assertEqual((status, report["well"], codes(report, "remains")[:3]), (1, False, found), report)
            self.assertEqual([module["node"] for module in report["modules"]], [1, 2, 3, 4, 5])
            self.assertEqual(sorted(sum(codes(report, "remains")[3:], [])), ["newer_settings"])

            text = proleg("recover", later, "--bus", bus.tcp)
            self.assertEqual(text.returncode, 0, text.stdout + text.stderr)
            self.assertEqual(text.stdout.count("gets the program 0.2.0"), 4, text.stdout)
            self.assertEqual(text.stdout.count("well; it was flashed"), 4, text.stdout)
            self.assertEqual(len(text.stderr.splitlines()), 1, "it says that it waits")
            self.assertIn("switch the robot's supply off and on", text.stderr)

            status, report = recover(bus.tcp, "--wait", "0")
            self.assertEqual((status, codes(report, "found")), (0, [[]] * 5), report)

    def test_a_program_follows_what_is_found_and_done(self):
        later = self.image(schema=3)
        with Bus("--broken", "2=no-program", "--broken", "5=duplicate:4") as bus:
            events = run_events("recover", later, "--wait", "2", "--bus", bus.tcp)
            self.assertEqual((events.process.returncode, events.errors), (0, ""))
            names = list(dict.fromkeys(events.names()))
            self.assertEqual(names, ["waits", "found", "progress", "ended", "result"])
            self.assertEqual(events.names().count("ended"), 1)
            waits = [event for event in events.all if event["event"] == "waits"]
            self.assertEqual(waits[0], {"event": "waits", "seconds": 2.0, "left_s": 2.0, "seen": waits[0]["seen"]})
            left = [event["left_s"] for event in waits]
            self.assertEqual((left, left[-1]), (sorted(left, reverse=True), 0))
            self.assertEqual(waits[-1]["seen"], 5)
            result = events.result()
            self.assertTrue(result["well"])
            found = sorted(events.all[len(waits)]["modules"], key=lambda module: module["serial"])
            self.assertEqual(found, [{"node": module["node_before"], "serial": module["serial"], "found": module["found"]}
                                     for module in sorted(result["modules"], key=lambda module: module["serial"])])
            ended = events.all[-2]["modules"]
            self.assertEqual([(module["node"], module["outcome"], module["good"]) for module in ended],
                             [(2, "runs the image", True)])

            status, report = recover(bus.tcp, "--wait", "0")
            events = run_events("recover", "--wait", "0", "--bus", bus.tcp)
            self.assertEqual((events.process.returncode, events.result()), (status, report))
            self.assertEqual(events.names(), ["found", "result"])

    def test_a_person_switches_the_supply_off_and_on_while_it_waits(self):
        later = self.image(schema=2)
        with Bus("--broken", "2=silent") as bus:
            nodes = json.loads(proleg("scan", "--bus", bus.tcp, "--json").stdout)["nodes"]
            self.assertEqual([node["node"] for node in nodes], [1, 3, 4, 5], "its program answers nothing")
            self.assertIn("found the line 'up', expected off or on", bus.say("up"))
            with Events("recover", later, "--wait", "10", "--bus", bus.tcp) as recovery:
                recovery.until("waits")
                self.assertIn("the supply of the robot is off", bus.say("off"))
                recovery.until("waits")
                self.assertIn("the supply of the robot is on", bus.say("on"))
                self.assertEqual(recovery.end(), 0, recovery.errors)
                result = recovery.result()
            self.assertEqual([module["node"] for module in result["modules"]], [1, 2, 3, 4, 5])
            self.assertEqual(codes(result, "found"), [[], ["silent_program"], [], [], []])
            self.assertEqual([module["done"] for module in result["modules"]], [[], ["it was flashed"], [], [], []])
            self.assertEqual(recover(bus.tcp, "--wait", "0")[0], 0)

    def test_a_module_that_stays_broken_is_a_result_too(self):
        with Bus("--broken", "2=no-program") as bus:
            events = run_events("recover", "--wait", "0", "--bus", bus.tcp)
            self.assertEqual((events.process.returncode, events.names()[-1]), (1, "result"))
            self.assertEqual(events.result(), recover(bus.tcp, "--wait", "0")[1])
            self.assertFalse(events.result()["well"])

    def test_a_signal_ends_the_wait(self):
        with Bus() as bus:
            for number in (signal.SIGTERM, signal.SIGINT):
                with Events("recover", "--wait", "600", "--bus", bus.tcp) as recovery:
                    self.assertEqual(recovery.next()["event"], "waits")
                    recovery.process.send_signal(number)
                    self.assertEqual((recovery.end(), set(recovery.names())), (1, {"waits"}))
                    self.assertIn("interrupted", recovery.errors)

    def test_a_person_reads_what_is_missing(self):
        with Bus("--broken", "2=no-program", "--fresh", "3") as bus:
            text = proleg("recover", "--wait", "2", "--bus", bus.tcp)
            self.assertEqual(text.returncode, 1)
            plan, result = text.stdout.split("module    serial")
            self.assertEqual(len(plan.splitlines()), 2, plan)
            self.assertIn("has no program: 'proleg recover IMAGE.pimg' flashes a program for board 1", plan)
            self.assertIn("has no node id: gets a free one", plan)
            self.assertIn("'proleg recover IMAGE.pimg'", result)
            self.assertIn("well; its node id was missing", result)

    def test_settings_of_a_later_program_are_reset_on_request(self):
        same = self.image(schema=2)
        with Bus("--broken", "4=newer-settings") as bus:
            status, report = recover(bus.tcp, "--wait", "0", same)
            self.assertEqual((status, codes(report, "remains")[3]), (1, ["newer_settings"]))
            self.assertIn("--reset-settings", report["modules"][3]["remains"][0]["to_do"])
            status, report = recover(bus.tcp, "--wait", "0", "--reset-settings")
            self.assertEqual((status, report["modules"][3]["node"], report["missing"]), (0, 4, []), report)

    def test_named_modules_are_awaited(self):
        image = self.image(schema=2)
        with Bus("--broken", "1=hangs") as bus:
            nodes = json.loads(proleg("scan", "--bus", bus.tcp, "--json").stdout)["nodes"]
            serial = next(node["serial"] for node in nodes if node["node"] == 2)
            status, report = recover(bus.tcp, "--serial", hex(serial), "--serial", "0x1", "--wait", "8", image)
            self.assertEqual((status, report["missing"]), (1, [1]), report)
            self.assertTrue(all(module["well"] for module in report["modules"]), report)
            status, report = recover(bus.tcp, "--serial", str(serial), "--wait", "300")
            self.assertEqual((status, len(report["modules"])), (0, 5), report)

    def test_a_robot_that_somebody_drives_is_not_touched(self):
        with Bus("--can-log", str(self.folder / "log")) as bus:
            drive = start_drive(bus.tcp)
            wait_for_drives(bus.pty, "operation enabled")
            text = proleg("recover", "--wait", "0", "--bus", bus.pty)
            self.assertEqual((text.returncode, text.stdout), (1, ""))
            self.assertIn("another host drives the robot", text.stderr)
            drive.kill()
            drive.communicate(timeout=LONGEST)
            wait_for_drives(bus.pty, "quick stop")
            text = proleg("recover", "--wait", "0", "--bus", bus.pty)
            self.assertEqual((text.returncode, text.stdout), (1, ""))
            self.assertIn("its servo has power", text.stderr)
            self.assertEqual(len(text.stderr.splitlines()), 1, text.stderr)
            wait_for_drives(bus.pty, "quick stop")
            self.assertIn("'proleg nmt pre-operational all'", text.stderr)
            self.assertEqual(proleg("nmt", "pre-operational", "all", "--bus", bus.pty).returncode, 0)
            self.assertEqual(recover(bus.tcp, "--wait", "0")[0], 0)

    def test_bad_words_end_it(self):
        (self.folder / "text").write_text("no image")
        for words in (("--serial", "front"), ("--wait", "-1"), ("--wait", "1000"), (str(self.folder / "text"),),
                      (str(self.folder / "missing.pimg"),), ("--bus", "nonsense:x"), ("one", "two"), ("--json", "--json-lines")):
            result = proleg("recover", *words)
            self.assertEqual(result.returncode, 2, words)
            self.assertEqual(len(result.stderr.splitlines()), 1, words)
            self.assertEqual(result.stdout, "")
        for words in (("--broken", "1=hurts"), ("--broken", "9=hangs"), ("--broken", "1"), ("--broken", "1=duplicate:1"),
                      ("--broken", "1=duplicate:9"), ("--broken", "1=hangs", "--broken", "1=faults")):
            result = proleg("bus", table.SOURCE / table.SCENARIO, "--tcp", "0", *words)
            self.assertEqual(result.returncode, 2, words)
            self.assertEqual(len(result.stderr.splitlines()), 1, words)

    def test_a_bus_that_cannot_be_reached_is_an_error(self):
        result = proleg("recover", "--wait", "0", "--bus", "tcp:127.0.0.1:1")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)


if __name__ == "__main__":
    table.SOURCE = Path(sys.argv[1])
    table.PROGRAMS = Path(sys.argv[2])
    unittest.main(argv=sys.argv[:1], verbosity=1)

#!/usr/bin/env python3
"""A robot with a 64-bit ARM computer does what it does on this one: the programs for arm64, in an emulator, give the same bits.

Usage: arm64_test.py SOURCE_FOLDER PROGRAM_FOLDER ARM64_BUILD_FOLDER SLOW_TIME_LIBRARY
"""

import json
import os
import re
import signal
import sqlite3
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from pathlib import Path

LONGEST = 1800  # s
SCENARIO = "sim/scenarios/travelling_wave/uniform.simulation.xml"
# s of the robot, for each scenario: long enough for contacts, obstacles and reflexes.
SECONDS = "10"
SECONDS_OF_LONG_CHAINS = "1"  # an emulated step of sixty joints takes too long
SLOWNESS = 5
BAUD = "@460800"  # the highest that QEMU translates; a pseudo terminal has none


def amd64(command, *words):
    return subprocess.run([PROGRAMS / f"proleg-{command}", *words], capture_output=True, text=True, timeout=LONGEST, cwd=SOURCE)


def arm64(command, *words):
    return subprocess.run([ARM64 / "emulated/proleg", command, *words], capture_output=True, text=True, timeout=LONGEST, cwd=SOURCE)


def seconds_of(file):
    return SECONDS_OF_LONG_CHAINS if "long_chain" in file else SECONDS


def in_slow_time():
    return {**os.environ, "QEMU_SET_ENV": f"LD_PRELOAD={CLOCK},PROLEG_SLOW_TIME={SLOWNESS}"}


def result_of(finished):
    """What a run computed, without what differs from run to run; where the scenario is refused, the message."""
    if finished.returncode == 0:
        result = json.loads(finished.stdout)
        for key in ("real_time_factor", "build_id", "recording"):
            result.pop(key, None)
        return result
    return {"status": finished.returncode, "message": finished.stderr}


def leaves(value, name=""):
    """All values of a JSON object, by their paths."""
    if isinstance(value, dict):
        return {path: leaf for key, part in value.items() for path, leaf in leaves(part, f"{name}/{key}").items()}
    return {name: value}


def rows_of(recording):
    """All rows of a recording, by its tables, but for that which names the build."""
    with closing(sqlite3.connect(recording)) as database:
        names = [name for name, in database.execute("SELECT name FROM sqlite_master WHERE type = 'table'")]
        return {name: [row for row in database.execute(f"SELECT * FROM {name}") if row[0] != "build_id"] for name in names}


class Arm64(unittest.TestCase):
    def in_parallel(self, compare, items):
        """The sums of what `compare` counts. It returns (numbers, differences)."""
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            results = list(pool.map(compare, items))
        differences = [difference for _, found in results for difference in found]
        self.assertEqual(differences, [], "\n" + "\n".join(differences))
        return [sum(column) for column in zip(*(numbers for numbers, _ in results))]

    def test_the_reduced_engine_gives_the_same_bits_in_every_shipped_scenario(self):
        def compare(file):
            with tempfile.TemporaryDirectory() as folder:
                words = ("simulate", file, "--engine", "reduced", "--seconds", seconds_of(file), "--json", "--record")
                expected = leaves(result_of(amd64(*words, f"{folder}/amd64.proleg")))
                found = leaves(result_of(arm64(*words, f"{folder}/arm64.proleg")))
                differences = [f"{file}: {key}: found {found.get(key)} on arm64, expected {expected.get(key)}"
                               for key in {**expected, **found} if found.get(key) != expected.get(key)]
                has_run = "/world_hash" in expected
                expected_rows, found_rows = ({}, {}) if not has_run else (rows_of(f"{folder}/{name}.proleg") for name in ("amd64", "arm64"))
                differences += [f"{file}: found other rows in table {table} of the recording on arm64"
                                for table, rows in expected_rows.items() if rows != found_rows.get(table)]
                return (1, has_run, len(expected), sum(map(len, expected_rows.values()))), differences

        scenarios, run, values, rows = self.in_parallel(compare, SCENARIOS)
        print(f"reduced engine, {SECONDS} s of {scenarios} scenarios, {run} of which it runs: equal are {3 * run} hashes, "
              f"{values} values of the results and {rows} rows of the recordings", flush=True)
        self.assertGreater(run, 25)

    def test_set_points_that_do_not_depend_on_the_world_are_the_same_with_ode(self):
        def compare(file):
            words = ("simulate", file, "--engine", "ode", "--json", "--seconds", seconds_of(file))
            expected, found = result_of(amd64(*words)), result_of(arm64(*words))
            # Another friction, another motion: the set-points of a gait that senses nothing stay.
            elsewhere = result_of(amd64(*words, "--friction", "0.05"))
            senses = elsewhere["setpoint_hash"] != expected["setpoint_hash"]
            if senses:
                print(f"{file}: senses its world, which ODE computes: set-points "
                      f"{'the same' if found['setpoint_hash'] == expected['setpoint_hash'] else 'others'}", flush=True)
                return (1, 1, 0), []
            differences = [f"{file}: {key}: found {found[key]} on arm64, expected {expected[key]}"
                           for key in ("setpoint_hash", "servo_hash") if found[key] != expected[key]]
            return (1, 0, 2), differences

        scenarios, sensing, hashes = self.in_parallel(compare, SCENARIOS)
        print(f"ODE, {SECONDS} s of {scenarios} scenarios: {hashes} hashes of set-points and pulses are equal; {sensing} scenarios sense",
              flush=True)
        self.assertGreater(hashes, 50)

    def test_scan_and_drive_reach_a_robot_over_a_serial_line(self):
        with tempfile.TemporaryFile("w+") as messages:
            bus = subprocess.Popen([ARM64 / "emulated/proleg", "bus", SCENARIO, "--pty"], stdout=subprocess.PIPE, stderr=messages,
                                   text=True, cwd=SOURCE, env=in_slow_time())
            try:
                line = bus.stdout.readline()
                messages.seek(0)
                address = re.search(r"--bus (serial:\S+)", line)
                self.assertTrue(address, line + messages.read())
                scan, drive = (
                    subprocess.run([ARM64 / "emulated/proleg", *words, "--bus", address.group(1) + BAUD, "--json"], capture_output=True,
                                   text=True, timeout=LONGEST, cwd=SOURCE, env=in_slow_time(), stdin=subprocess.DEVNULL)
                    for words in (["scan"], ["drive", SCENARIO, "--seconds", "5"]))
            finally:
                bus.send_signal(signal.SIGINT)
                bus.communicate(timeout=LONGEST)
        self.assertEqual(scan.returncode, 0, scan.stderr)
        self.assertEqual(len(json.loads(scan.stdout)["nodes"]), 5)
        self.assertEqual(drive.returncode, 0, drive.stderr)
        driven = json.loads(drive.stdout)
        simulated = json.loads(amd64("simulate", SCENARIO, "--seconds", "5", "--json").stdout)
        self.assertEqual(driven["differences"], 0)
        for key in ("setpoint_hash", "servo_hash"):
            self.assertEqual(driven[key], simulated[key])
        print(f"scan finds 5 modules; drive over a serial line: {driven['frames_compared']} frames and 2 hashes are equal", flush=True)


if __name__ == "__main__":
    SOURCE, PROGRAMS, ARM64, CLOCK = map(Path, sys.argv[1:5])
    if not (ARM64 / "bin/proleg").exists():
        print(f"not run: found no {ARM64}/bin/proleg; tools/arm64 builds it")
        sys.exit(0)
    SCENARIOS = sorted(str(file.relative_to(SOURCE)) for file in (SOURCE / "sim/scenarios").rglob("*.simulation.xml"))
    unittest.main(argv=sys.argv[:1], verbosity=1)

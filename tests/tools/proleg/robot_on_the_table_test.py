#!/usr/bin/env python3
"""A user with modules on a bus, here those of 'proleg bus': finds them, sets them, drives them, and makes mistakes.

Usage: robot_on_the_table_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import json
import os
import re
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import tty
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
sys.path.append(str(Path(__file__).resolve().parents[2] / "support"))
from waiting import LONGEST, wait_until

ENDLESS = "3600"  # seconds of a drive that something else ends
SCENARIO = "sim/scenarios/travelling_wave/uniform.simulation.xml"


class Bus:
    """'proleg bus', until the end of a test."""

    def __init__(self, *options, scenario=SCENARIO):
        self.process = subprocess.Popen([PROGRAMS / "proleg-bus", SOURCE / scenario, "--pty", "--tcp", "0", *options],
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.tcp = self.find(r"--bus (tcp:\S+)")
        self.pty = self.find(r"--bus (serial:\S+)")

    def find(self, pattern):
        line = self.process.stdout.readline()
        found = re.search(pattern, line)
        if not found:
            raise AssertionError(f"proleg bus printed {line!r} {self.process.stderr.read()!r}")
        return found.group(1)

    def say(self, line):
        """A line on its standard input: `off` and `on` switch the supply of the robot. Returns what it answers."""
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        return self.process.stderr.readline()

    def joint_with_power(self):
        """The joint whose servo gets power next; of a bus with --verbose."""
        while True:
            line = self.process.stderr.readline()
            found = re.match(r"proleg bus: (\S+) has power", line)
            if found:
                return found.group(1)
            if not line:
                raise AssertionError("proleg bus has ended")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGINT)
        self.process.communicate(timeout=LONGEST)


class Listener:
    """A program that takes all frames of an slcan channel."""

    def __init__(self, bus):
        self.socket = None
        if bus.startswith("tcp:"):
            host, port = bus.removeprefix("tcp:").split(":")
            self.socket = socket.create_connection((host, int(port)))
            self.line = self.socket.makefile("rwb", buffering=0)
        else:
            device = os.open(bus.removeprefix("serial:"), os.O_RDWR | os.O_NOCTTY)
            tty.setraw(device)
            self.line = os.fdopen(device, "r+b", buffering=0)
        self.line.write(b"C\rS8\rO\r")
        self.text = b""
        self.thread = threading.Thread(target=self.read, daemon=True)
        self.thread.start()

    def read(self):
        try:
            while part := self.line.read(4096):
                self.text += part
        except OSError:
            pass

    def end(self):
        """Of a TCP connection: the bus goes on without it."""
        self.socket.shutdown(socket.SHUT_RDWR)
        self.thread.join(LONGEST)
        self.line.close()
        self.socket.close()

    def received(self):
        """How many frames of other programs and modules were on the bus."""
        return self.text.count(b"t")

    def confirmed(self):
        """How many frames of this program were on the bus."""
        return self.text.count(b"z")

    def frames(self):
        """As in a candump log, without the '#': '18300...'."""
        return [line[1:4] + line[5:] for line in self.text.decode("ascii").split("\r") if line.startswith("t")]


class CutLine:
    """A line to a bus that is cut when a program has sent a command several times."""

    def __init__(self, bus, command, count):
        host, port = bus.removeprefix("tcp:").split(":")
        self.bus = (host, int(port))
        self.command, self.count = command, count
        self.server = socket.create_server(("127.0.0.1", 0))
        self.address = f"tcp:127.0.0.1:{self.server.getsockname()[1]}"
        self.thread = threading.Thread(target=self.serve, daemon=True)
        self.thread.start()

    def serve(self):
        program = self.server.accept()[0]
        self.server.close()  # the program finds no other line
        with program, socket.create_connection(self.bus) as bus:
            back = threading.Thread(target=self.copy, args=(bus, program), daemon=True)
            back.start()
            sent = b""
            try:
                while sent.count(self.command) < self.count and (part := program.recv(4096)):
                    sent += part
                    bus.sendall(part)
                program.shutdown(socket.SHUT_RDWR)
                bus.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass  # the program has ended
            back.join(LONGEST)

    @staticmethod
    def copy(source, target):
        try:
            while part := source.recv(4096):
                target.sendall(part)
        except OSError:
            pass

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.thread.join(LONGEST)


def proleg(name, *arguments, text=""):
    return subprocess.run([PROGRAMS / f"proleg-{name}", *arguments], input=text, capture_output=True, text=True,
                          timeout=LONGEST)


def proleg_json(name, *arguments):
    """What a program prints for machines; what it says to a person if it prints nothing."""
    finished = proleg(name, *arguments)
    if not finished.stdout:
        raise AssertionError(f"proleg {name} printed nothing; {finished.stderr}")
    return json.loads(finished.stdout)


class Events:
    """A program that reports events (--json-lines), and what it has reported."""

    def __init__(self, name, *arguments, folder=None):
        self.process = subprocess.Popen([PROGRAMS / f"proleg-{name}", *arguments, "--json-lines"], cwd=folder, text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.all = []
        self.errors = ""

    def next(self):
        """The next event; None at the end. Each line is an object."""
        line = self.process.stdout.readline()
        if not line:
            return None
        event = json.loads(line)
        self.all.append(event)
        return event

    def until(self, name):
        while event := self.next():
            if event["event"] == name:
                return event
        raise AssertionError(f"no event {name!r} in {self.all}; {self.process.stderr.read()!r}")

    def answer(self, word):
        self.process.stdin.write(word + "\n")
        self.process.stdin.flush()

    def close_input(self):
        self.process.stdin.close()
        self.process.stdin = None

    def end(self):
        """Takes the rest; the exit status."""
        while self.next():
            pass
        self.errors = self.process.communicate(timeout=LONGEST)[1]
        return self.process.returncode

    def names(self):
        return [event["event"] for event in self.all]

    def result(self):
        if "result" not in self.names()[-1:]:
            raise AssertionError(f"no result at the end of {self.all}; {self.errors!r}")
        return self.all[-1]["value"]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        for stream in (self.process.stdin, self.process.stdout, self.process.stderr):
            if stream:
                stream.close()
        self.process.wait(timeout=LONGEST)


def run_events(name, *arguments, folder=None):
    """A program that asks nothing, when it has ended."""
    with Events(name, *arguments, folder=folder) as events:
        events.close_input()
        events.end()
        return events


def drive_json(drive):
    """What a 'proleg drive' printed at its end."""
    output, errors = drive.communicate(timeout=LONGEST)
    if not output:
        raise AssertionError(f"proleg drive printed nothing; {errors}")
    return json.loads(output)


def start_drive(bus, *options):
    """Until it is ended, unless --seconds is among the options."""
    if "--seconds" not in options:
        options += ("--seconds", ENDLESS)
    return subprocess.Popen([PROGRAMS / "proleg-drive", SOURCE / SCENARIO, "--bus", bus, "--json", *options],
                            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def states(bus):
    """The states of the drives, by node."""
    return {node["node"]: node["drive"] for node in proleg_json("scan", "--bus", bus, "--json")["nodes"]}


def wait_for_drives(bus, state):
    found = {}

    def are_in_it():
        found.clear()
        found.update(states(bus))
        return len(found) == 5 and set(found.values()) == {state}

    wait_until(are_in_it, lambda: f"the drives are {found}, not {state}")


def simulated(*options):
    return proleg_json("simulate", SOURCE / SCENARIO, "--json", *options)


def with_servo_period(folder, period_ms):
    """A copy of the scenario whose servos get a pulse that often."""
    copy = Path(folder) / f"period_{period_ms}"
    shutil.copytree((SOURCE / SCENARIO).parent, copy)
    robot = copy / "caterpillar.robot.xml"
    text = robot.read_text()
    assert '<period unit="ms">1</period>' in text
    robot.write_text(text.replace('<period unit="ms">1</period>', f'<period unit="ms">{period_ms}</period>'))
    return copy / Path(SCENARIO).name


def simulated_with_real_servos(*options):
    """Each program that moves real servos gives them a pulse every 3 ms at most."""
    with tempfile.TemporaryDirectory() as folder:
        return proleg_json("simulate", with_servo_period(folder, 3), "--json", *options)


def assign_over_cut_line(bus, cut, places):
    """`proleg assign` over a line that is cut when it has stored so many node ids. On a busy computer the line passes the answers
    to a scan too late: then nothing has changed, and it begins again."""
    for _ in range(10):
        with CutLine(bus.tcp, b"t7E5817", cut) as line:
            assign = proleg("assign", SOURCE / SCENARIO, "--bus", line.address, "--places", places)
        if "no node id was changed" not in assign.stderr:
            break
    return assign


class RobotOnTheTable(unittest.TestCase):
    def test_any_program_reaches_the_modules(self):
        """The examples of docs/protocol.md, by hand over TCP."""
        with Bus() as bus:
            host, port = bus.tcp.removeprefix("tcp:").split(":")
            with socket.create_connection((host, int(port)), timeout=LONGEST) as line:
                line.sendall(b"C\rS8\rO\r")
                line.settimeout(0.2)
                received = b""

                def is_answered():
                    """A module that boots takes no request: another one follows after a pause."""
                    nonlocal received
                    line.sendall(b"t60384000100000000000\r")
                    try:
                        received += line.recv(4096)
                    except TimeoutError:
                        pass
                    return b"t58384300100092010200\r" in received

                wait_until(is_answered, lambda: f"received {received}")

    def test_scan_info_get_set_and_nmt(self):
        with Bus() as bus:
            scan = proleg_json("scan", "--bus", bus.pty, "--json")
            self.assertEqual([node["node"] for node in scan["nodes"]], [1, 2, 3, 4, 5])
            self.assertTrue(all(node["joint_module"] for node in scan["nodes"]))
            self.assertEqual(proleg("scan", "--bus", bus.pty).stdout.count("not driven"), 5, "no host has set them up")
            info = proleg("info", "3", "--bus", bus.tcp).stdout
            for line in ("Proleg joint module", "(no power)", "Max motor speed = 720 deg/s", "none: a host configures"):
                self.assertIn(line, info)
            self.assertNotIn("0x2003:1", info)
            values = {value["object"]: value for value in proleg_json("info", "3", "--bus", bus.tcp, "--json")["values"]}
            self.assertEqual(values["0x200A:1"], {
                "node": 3, "object": "0x200A:1", "name": "Over-current: Current limit", "group": "joint",
                "value": "2000 mA", "writable": True, "help": "of the servo, in mA; 0: off"})
            self.assertEqual((values["0x6041"]["writable"], values["0x1018:4"]["writable"]), (False, False))
            everything = proleg("info", "3", "--all", "--bus", bus.tcp).stdout
            self.assertIn("0x2003:1  Unique id", everything)
            self.assertNotIn("Highest sub-index", everything)
            silent = proleg("info", "3,9", "--bus", bus.tcp)
            self.assertEqual(silent.returncode, 1)
            self.assertEqual(silent.stdout.splitlines()[:3], info.splitlines()[:3])
            self.assertIn("node 9: no answer", silent.stderr)
            self.assertEqual(proleg("set", "2-4", "0x6080", "300", "--bus", bus.tcp).returncode, 0)
            values = proleg_json("get", "all", "Max motor speed", "0x1018:1", "--bus", bus.pty, "--json")
            speeds = [one["raw"] for one in values["values"] if one["object"] == "0x6080"]
            self.assertEqual(speeds, [720, 300, 300, 300, 720])
            self.assertIn("node 3 boots", proleg("nmt", "reset-node", "3", "--bus", bus.tcp).stdout)
            speeds = proleg_json("get", "2,3", "0x6080", "--bus", bus.tcp, "--json")["values"]
            self.assertEqual([one["raw"] for one in speeds], [300, 720], "the reset has restored it")

    def test_drive_ends_if_another_program_takes_the_power_of_a_joint(self):
        with Bus() as bus:
            drive = start_drive(bus.pty)
            wait_for_drives(bus.tcp, "operation enabled")
            host, port = bus.tcp.removeprefix("tcp:").split(":")
            with socket.create_connection((host, int(port)), timeout=LONGEST) as line:
                line.sendall(b"C\rS8\rO\rt60482B40600000000000\r")  # node 4, controlword 0
                output, errors = drive.communicate(timeout=LONGEST)
            self.assertEqual(drive.returncode, 1, errors)
            self.assertIn("node 4 (J2) does not follow the gait any more: no power", errors)
            self.assertLess(json.loads(output)["ticks"], 6000)
            wait_for_drives(bus.tcp, "no power")

    def test_drive_computes_what_simulate_computes(self):
        with Bus() as bus:
            for address in (bus.tcp, bus.pty):
                result = drive_json(start_drive(address, "--seconds", "2", "--set", "amplitude=20@1s"))
                self.assertEqual(result["differences"], 0)
                self.assertEqual(result["frames_compared"], 1000)
                expected = simulated_with_real_servos("--seconds", "2", "--set", "amplitude=20@1s")
                self.assertEqual(result["servo_period_ms"], 3)
                self.assertEqual(result["setpoint_hash"], expected["setpoint_hash"])
                self.assertEqual(result["setpoint_hash"], simulated("--seconds", "2", "--set", "amplitude=20@1s")["setpoint_hash"])
                self.assertEqual(result["servo_hash"], expected["servo_hash"])
                self.assertEqual(set(states(bus.tcp).values()), {"no power"})

    def test_modules_on_a_bus_never_get_a_servo_period_that_burns_servos(self):
        """Virtual modules behind a line look like real ones. Only those of sim: get the period of their file."""
        with tempfile.TemporaryDirectory() as folder:
            for period_ms, used_ms in ((1, 3), (2.999, 3), (3, 3), (20, 20)):
                scenario = with_servo_period(folder, period_ms)
                with Bus(scenario=scenario) as bus:
                    for address in (bus.tcp, bus.pty):
                        recording = Path(folder) / "driven.proleg"
                        drive = proleg("drive", scenario, "--bus", address, "--seconds", "0.5", "--record", recording, "--json")
                        self.assertEqual(drive.returncode, 0, drive.stderr)
                        line = f"found a servo period of {period_ms} ms, used {used_ms} ms"
                        self.assertEqual(drive.stderr.count(line), int(period_ms != used_ms), drive.stderr)
                        values = proleg_json("get", "all", "0x2005:3", "--bus", address, "--json")["values"]
                        self.assertEqual([one["raw"] for one in values], [used_ms * 1000] * 5)
                        result = json.loads(drive.stdout)
                        self.assertEqual((result["servo_period_ms"], result["differences"]), (used_ms, 0))
                        self.assertIn(result["servo_hash"], proleg("replay", recording).stdout)
                drive = proleg("drive", scenario, "--bus", f"sim:{scenario}", "--fast", "--seconds", "0.5", "--json")
                self.assertEqual(json.loads(drive.stdout)["servo_period_ms"], period_ms)
                self.assertNotIn("servo period", drive.stderr)

    def test_a_servo_period_that_burns_servos_is_not_set(self):
        with Bus() as bus:
            for word in ("2999", "1000", "0x64"):
                refused = proleg("set", "all", "0x2005:3", word, "--bus", bus.tcp)
                self.assertEqual(refused.returncode, 2, refused.stderr)
                self.assertIn(f"found '{word}', expected 3000 us or more: a real servo needs", refused.stderr)
            self.assertEqual(proleg("set", "all", "0x2005:3", "3000", "--bus", bus.tcp).returncode, 0)
        virtual = proleg("set", "all", "0x2005:3", "1000", "--bus", f"sim:{SOURCE / SCENARIO}")
        self.assertEqual(virtual.returncode, 0, virtual.stderr)

    def test_a_host_on_the_serial_line_of_a_module_reaches_the_robot(self):
        """It sets an object of the gateway itself and of another module, and drives; a second program is on the bus."""
        for word, pattern in (("3=0", r"node 3: --bus (tcp:\S+)"), ("2", r"node 2: --bus (serial:\S+)")):
            with Bus("--gateway", word) as bus:
                line = bus.find(pattern)
                scan = proleg_json("scan", "--bus", line, "--json")
                self.assertEqual([node["node"] for node in scan["nodes"]], [1, 2, 3, 4, 5])
                role = proleg_json("get", "all", "0x2020:1", "--bus", line, "--json")["values"]
                self.assertEqual([one["raw"] for one in role], [int(node == int(word[0])) for node in range(1, 6)])
                self.assertEqual(proleg("set", "3,4", "0x6080", "300", "--bus", line).returncode, 0)
                drive = start_drive(line, "--seconds", "3")
                wait_for_drives(bus.tcp, "operation enabled")
                output, errors = drive.communicate(timeout=LONGEST)
                self.assertEqual(drive.returncode, 0, errors)
                result = json.loads(output)
                self.assertEqual(result["differences"], 0)
                self.assertEqual(result["frames_compared"], 1500)
                expected = simulated_with_real_servos("--seconds", "3")
                self.assertEqual(result["setpoint_hash"], expected["setpoint_hash"])
                self.assertEqual(result["servo_hash"], expected["servo_hash"])

    def test_the_serial_line_of_a_gateway_has_one_program_at_its_end(self):
        with Bus("--gateway", "3=0", "--verbose") as bus:
            host, port = bus.find(r"--bus tcp:(\S+)").split(":")
            with socket.create_connection((host, int(port)), timeout=LONGEST) as first:
                first.sendall(b"\rV\r")
                received = b""
                while b"V" not in received:
                    received += first.recv(4096)
                with socket.create_connection((host, int(port)), timeout=LONGEST) as second:
                    self.assertEqual(second.recv(4096), b"", "closed at once")
            self.assertEqual(len(states(f"tcp:{host}:{port}")), 5, "the next program is let in")

    def test_every_program_sees_every_frame_in_the_order_of_the_bus(self):
        """Two programs beside the host, over TCP and a pseudo terminal, and the log of the bus itself."""
        with tempfile.TemporaryDirectory() as folder:
            log = Path(folder) / "bus.log"
            with Bus("--can-log", log) as bus:
                listeners = [Listener(bus.tcp), Listener(bus.pty)]
                drive = start_drive("tcp:" + bus.tcp.removeprefix("tcp:"), "--seconds", "4")
                self.assertEqual(drive.wait(timeout=LONGEST), 0, drive.communicate())
                listeners[0].line.write(b"t7FF0\r")  # the other program and the log have it behind all other frames
                wait_until(lambda: "7FF" in listeners[1].frames(), "the last frame")
                listeners[1].line.write(b"t7FE0\r")
                wait_until(lambda: "7FE" in listeners[0].frames(), "the last frame")
                seen = [listener.frames() for listener in listeners]
            frames = [line.split()[2].replace("#", "") for line in log.read_text().splitlines()]
            begin, end = frames.index("0008100"), frames.index("7FF")  # NMT reset node, all nodes: the host begins
            self.assertGreater(end - begin, 2000)
            for frames_of_program, last in zip(seen, ("7FE", "7FF")):
                from_the_reset = frames_of_program[frames_of_program.index("0008100"):]
                self.assertEqual(from_the_reset[:from_the_reset.index(last)],
                                 [frame for frame in frames[begin:frames.index(last)] if frame != "7FF"])

    def test_changes_are_typed_while_it_moves_and_the_recording_has_them(self):
        with Bus() as bus, tempfile.TemporaryDirectory() as folder:
            recording = Path(folder) / "driven.proleg"
            drive = subprocess.Popen([PROGRAMS / "proleg-drive", SOURCE / SCENARIO, "--bus", bus.tcp, "--json", "--record",
                                      recording, "--seconds", ENDLESS], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                     stderr=subprocess.PIPE, text=True)
            # It reads them when the gait begins, so that tick 1000 is far away.
            drive.stdin.write("amplitude=20\nfrequency=fast\namplitude:J2=10@1000\n")
            drive.stdin.flush()

            def has_taken_effect():
                values = proleg_json("get", "4", "amplitude", "--bus", bus.pty, "--json")["values"]
                return [one["value"] for one in values] == ["10 deg"] or drive.poll() is not None

            wait_for_drives(bus.pty, "operation enabled")
            wait_until(has_taken_effect, "the change for tick 1000")
            output, errors = drive.communicate("stop\n", timeout=LONGEST)
            result = json.loads(output)
            self.assertEqual(drive.returncode, 0, errors)
            self.assertEqual(result["differences"], 0)
            self.assertEqual(result["dropped_changes"], 0)
            self.assertIn("found 'fast' for parameter 'frequency'", errors)
            replay = proleg("replay", recording)
            self.assertEqual(replay.returncode, 0, replay.stderr)
            self.assertIn(result["setpoint_hash"], replay.stdout)
            plain = simulated("--seconds", f"{result['driven_s']:.2f}")
            self.assertNotEqual(result["setpoint_hash"], plain["setpoint_hash"], "the changes took effect")

    def test_only_one_host_moves_the_robot(self):
        with Bus() as bus:
            first = start_drive(bus.tcp)
            wait_for_drives(bus.pty, "operation enabled")
            second = proleg("drive", SOURCE / SCENARIO, "--bus", bus.pty)
            self.assertEqual(second.returncode, 1)
            self.assertIn("another host", second.stderr)
            self.assertEqual(proleg("nmt", "stop", "all", "--bus", bus.pty).returncode, 1)
            first.send_signal(signal.SIGINT)
            result = drive_json(first)
            self.assertEqual(first.returncode, 0)
            expected = simulated("--seconds", f"{result['driven_s']:.2f}")
            self.assertEqual(result["setpoint_hash"], expected["setpoint_hash"])

    def test_control_c_takes_the_power_after_a_ramp(self):
        with Bus() as bus:
            drive = start_drive(bus.tcp)
            wait_for_drives(bus.pty, "operation enabled")
            drive.send_signal(signal.SIGINT)
            result = drive_json(drive)
            self.assertEqual(drive.returncode, 0)
            self.assertEqual(result["differences"], 0)
            self.assertEqual(set(states(bus.pty).values()), {"no power"})

    def test_a_killed_host_leaves_a_robot_that_stops_and_the_next_host_takes_it(self):
        with Bus() as bus:
            drive = start_drive(bus.tcp)
            wait_for_drives(bus.pty, "operation enabled")
            drive.kill()
            drive.communicate(timeout=LONGEST)
            wait_for_drives(bus.pty, "quick stop")
            result = drive_json(start_drive(bus.pty, "--seconds", "1"))
            self.assertEqual(result["differences"], 0)

    def test_a_robot_that_is_not_the_one_of_the_file_does_not_move(self):
        with Bus("--fresh", "3") as bus:
            drive = proleg("drive", SOURCE / SCENARIO, "--bus", bus.tcp)
            self.assertEqual(drive.returncode, 1)
            self.assertIn("node 3 (J3): a module is missing", drive.stderr)
            self.assertEqual(set(states(bus.tcp).values()), {"no power"})
            self.assertIn("without a node id", proleg("scan", "--bus", bus.tcp).stdout)

    def test_assign_gives_every_module_its_place(self):
        """Two modules come from the factory, the others have each other's node ids; a person sees which joint moves."""
        with Bus("--shuffle", "7", "--fresh", "2,4", "--verbose") as bus:
            joints = []  # in the order in which they moved
            assign = subprocess.Popen([PROGRAMS / "proleg-assign", SOURCE / SCENARIO, "--bus", bus.tcp, "--json"],
                                      stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, bufsize=0)
            asked = b""
            while not asked.endswith(b"[y/n] "):
                character = assign.stderr.read(1)
                self.assertTrue(character, asked)
                asked += character
                if asked.endswith(b" is none of J1, J2, J3, J4, J5, none, more, quit. Which joint is it? "):
                    assign.stdin.write(joints[-1].encode() + b"\n")
                elif asked.endswith(b"Which joint is it? "):
                    joints.append(bus.joint_with_power())
                    assign.stdin.write(b"J9\n" if len(joints) == 1 else joints[-1].encode() + b"\n")
            output, errors = assign.communicate(b"y\n", timeout=LONGEST)
            self.assertEqual(assign.returncode, 0, errors)
            self.assertIn(b"'J9' is none of", asked)
            self.assertEqual(set(joints), {"J1", "J2", "J3", "J4", "J5"})
            places = {entry["joint"]: entry["node"] for entry in json.loads(output)["joints"]}
            self.assertEqual(places, {"J1": 5, "J2": 4, "J3": 3, "J4": 2, "J5": 1}, "the map of the robot's file")
            self.assertEqual(set(states(bus.tcp).values()), {"no power"})
            result = start_drive(bus.pty, "--seconds", "1").communicate(timeout=LONGEST)[0]
            self.assertEqual(json.loads(result)["differences"], 0)
            self.assertIn("no node id was changed",
                          proleg("assign", SOURCE / SCENARIO, "--bus", bus.tcp, "--places", "1=J5,2=4,3=J3,4=j2,5=J1").stdout)

    def test_assign_refuses_what_would_give_one_node_id_to_two_modules(self):
        with tempfile.TemporaryDirectory() as folder:
            named = Path(folder) / "named"
            shutil.copytree((SOURCE / SCENARIO).parent, named)
            with Bus() as bus:
                nodes = {node["node"]: node["serial"]
                         for node in proleg_json("scan", "--bus", bus.tcp, "--json")["nodes"]}
                robot = named / "caterpillar.robot.xml"
                modules = f'<module joint="J5" node="1" serial="{nodes[1]:#x}"/>' + "".join(
                    f'<module joint="J{6 - node}" node="{node}"/>' for node in range(2, 6))
                robot.write_text(robot.read_text().replace("</Robot>", modules + "</Robot>"))
                scenario = named / "uniform.simulation.xml"
                assign = proleg("assign", scenario, "--bus", bus.tcp, "--places", "2=J5")
                self.assertEqual(assign.returncode, 1, assign.stdout)
                self.assertIn("node 1 is J5", assign.stderr)
                # Those that are not named keep their places.
                assign = proleg("assign", SOURCE / SCENARIO, "--bus", bus.tcp, "--places", "2=J3,3=J4", "--json")
                self.assertEqual(assign.returncode, 0, assign.stderr)
                serials = {joint["node"]: joint["serial"] for joint in json.loads(assign.stdout)["joints"]}
                self.assertEqual(serials, {**nodes, 2: nodes[3], 3: nodes[2]})

    def test_assign_that_is_cut_while_node_ids_are_stored_prints_the_command_that_goes_on(self):
        right = {}
        with Bus() as bus:
            right = {node["serial"]: node["node"] for node in proleg_json("scan", "--bus", bus.tcp, "--json")["nodes"]}
        for cut in (1, 2, 3):
            with Bus("--shuffle", "7") as bus:
                before = {node["serial"]: node["node"]
                          for node in proleg_json("scan", "--bus", bus.tcp, "--json")["nodes"]}
                places = ",".join(f"{before[serial]}=J{6 - node}" for serial, node in right.items())
                assign = assign_over_cut_line(bus, cut, places)
                self.assertEqual(assign.returncode, 1, assign.stdout)
                for serial in right:
                    self.assertIn(f"the module with the serial number 0x{serial:08X} (J", assign.stderr)
                command = shlex.split(assign.stderr.splitlines()[-1].split("this goes on: proleg ")[1])
                command[command.index("--bus") + 1] = bus.tcp
                if cut == 2:
                    # The node ids that a scan shows are accepted, too, although the reset changes them.
                    command[command.index("--places") + 1] = places
                elif cut == 1:
                    drive = start_drive(bus.tcp, "--seconds", "1").communicate(timeout=LONGEST)[1]
                    self.assertIn("proleg assign", drive)
                again = proleg(*command)
                self.assertEqual(again.returncode, 0, again.stderr)
                after = {node["serial"]: node["node"]
                         for node in proleg_json("scan", "--bus", bus.tcp, "--json")["nodes"]}
                self.assertEqual(after, right)

    def test_assign_changes_nothing_if_it_is_not_told_the_places(self):
        with Bus("--shuffle", "7") as bus:
            before = proleg_json("scan", "--bus", bus.tcp, "--json")["nodes"]
            for text, expected in (("", "standard input has ended"), ("J1\nquit\n", "ended by the user")):
                assign = proleg("assign", SOURCE / SCENARIO, "--bus", bus.tcp, text=text)
                self.assertEqual(assign.returncode, 1, assign.stderr)
                self.assertIn(expected, assign.stderr)
            wait_for_drives(bus.tcp, "no power")
            after = proleg_json("scan", "--bus", bus.tcp, "--json")["nodes"]
            self.assertEqual([node["serial"] for node in before], [node["serial"] for node in after])

    def test_a_program_gives_modules_their_places(self):
        """It knows what happens from events only, and sees which joint moves."""
        with Bus("--shuffle", "7", "--fresh", "2,4", "--verbose") as bus, \
                Events("assign", SOURCE / SCENARIO, "--bus", bus.tcp) as assign:
            self.assertEqual(assign.next(), {"event": "numbered", "count": 2})
            places = assign.next()
            self.assertEqual([(module["node"], module["joint"]) for module in places["modules"]],
                             [(node, None) for node in range(1, 6)])
            serials = {module["node"]: module["serial"] for module in places["modules"]}
            joints = {}
            for node in range(1, 6):
                self.assertEqual(assign.next(), {"event": "moves", "node": node, "serial": serials[node], "degrees": 5.0})
                question = {"event": "question", "question": "joint", "node": node, "serial": serials[node]}
                self.assertEqual(assign.next(), question)
                joint = bus.joint_with_power()
                if node == 1:
                    for wrong in ("J9", "", "yes"):
                        assign.answer(wrong)
                        refused = assign.next()
                        self.assertEqual((refused["event"], refused["text"].split(" is none of ")[0]),
                                         ("refused", f"'{wrong}'"))
                        self.assertEqual(assign.next(), question)
                    assign.answer("more")
                    self.assertEqual(assign.next(), {"event": "moves", "node": node, "serial": serials[node], "degrees": 10.0})
                    self.assertEqual(assign.next(), question)
                    self.assertEqual(bus.joint_with_power(), joint)
                elif node == 2:
                    assign.answer(joints[serials[1]])
                    self.assertEqual(assign.next(), {"event": "refused", "text": f"{joints[serials[1]]} is node 1 already"})
                    self.assertEqual(assign.next(), question)
                joints[serials[node]] = joint
                assign.answer(joint)
                self.assertEqual(assign.next(), {"event": "places", "modules": [
                    {"serial": serials[one], "node": one, "joint": joints.get(serials[one])} for one in range(1, 6)]})
            question = assign.next()
            self.assertEqual((question["event"], question["question"]), ("question", "agree"))
            node_of = {"J5": 1, "J4": 2, "J3": 3, "J2": 4, "J1": 5}  # the map of the robot's file
            self.assertEqual(question["changes"], [
                {"serial": serial, "from": node, "to": node_of[joints[serial]], "joint": joints[serial]}
                for node, serial in serials.items() if node != node_of[joints[serial]]])
            assign.answer("perhaps")
            self.assertEqual(assign.next()["event"], "refused")
            self.assertEqual(assign.next(), question)
            assign.answer("yes")
            self.assertEqual((assign.end(), assign.errors), (0, ""))
            self.assertEqual(assign.result(), {
                "joints": [{"joint": joint, "node": node_of[joint],
                            "serial": next(serial for serial, name in joints.items() if name == joint)}
                           for joint in node_of], "changed": True, "new_modules": 2})
            self.assertEqual(set(states(bus.tcp).values()), {"no power"})

    def test_events_end_with_the_object_of_json(self):
        results = []
        for run in (proleg_json, run_events):
            with Bus("--shuffle", "7") as bus:
                word = ("--json",) if run == proleg_json else ()
                results.append(run("assign", SOURCE / SCENARIO, "--bus", bus.tcp, "--places", "1=J1,2=J2", *word))
        self.assertEqual(results[1].all, [{"event": "result", "value": results[0]}])
        self.assertTrue(results[0]["changed"])

    def test_a_joint_that_the_robot_file_gives_a_module_is_known_before_the_first_question(self):
        with Bus() as bus, tempfile.TemporaryDirectory() as folder:
            named = Path(folder) / "named"
            shutil.copytree((SOURCE / SCENARIO).parent, named)
            nodes = {node["node"]: node["serial"] for node in proleg_json("scan", "--bus", bus.tcp, "--json")["nodes"]}
            robot = named / "caterpillar.robot.xml"
            modules = f'<module joint="J5" node="1" serial="{nodes[1]:#x}"/>' + "".join(
                f'<module joint="J{6 - node}" node="{node}"/>' for node in range(2, 6))
            robot.write_text(robot.read_text().replace("</Robot>", modules + "</Robot>"))
            with Events("assign", named / Path(SCENARIO).name, "--bus", bus.tcp) as assign:
                joints = {module["node"]: module["joint"] for module in assign.until("places")["modules"]}
                self.assertEqual(joints, {1: "J5", 2: None, 3: None, 4: None, 5: None})
                self.assertEqual(assign.until("question")["node"], 2)
                assign.answer("quit")
                self.assertEqual(assign.end(), 1)
                self.assertEqual(assign.names(), ["places", "moves", "question"])
                self.assertEqual(assign.errors, "proleg assign: ended by the user; no node id was changed\n")

    def test_a_joint_that_moves_for_a_question_has_no_power_when_assign_has_ended(self):
        """By a signal, because nobody answers any more, or because nobody reads."""
        def close_output(assign):
            assign.process.stdout.close()
            assign.answer("J9")  # it reads this, and cannot write its next question

        with Bus("--verbose") as bus:
            for end, expected in ((lambda assign: assign.process.send_signal(signal.SIGTERM), "interrupted"),
                                  (lambda assign: assign.process.send_signal(signal.SIGINT), "interrupted"),
                                  (lambda assign: assign.process.send_signal(signal.SIGHUP), "interrupted"),
                                  (Events.close_input, "standard input has ended"),
                                  (close_output, "cannot write to standard output")):
                with Events("assign", SOURCE / SCENARIO, "--bus", bus.tcp) as assign:
                    assign.until("question")
                    bus.joint_with_power()
                    end(assign)
                    self.assertEqual(assign.process.wait(timeout=LONGEST), 1)
                    self.assertEqual(set(states(bus.pty).values()), {"no power"}, expected)
                    errors = assign.process.stderr.read()
                    self.assertIn(expected, errors)
                    self.assertEqual(len(errors.splitlines()), 1, errors)

    def test_a_module_that_cannot_move_is_asked_for(self):
        with Bus() as bus, Events("assign", SOURCE / SCENARIO, "--bus", bus.tcp) as assign:
            assign.until("question")
            other = Listener(bus.tcp)
            is_over = threading.Event()

            def stop_node_2():
                """A module that is Stopped answers no request. It is stopped again after each reset."""
                while not is_over.wait(0.005):
                    other.line.write(b"t00020202\r")

            thread = threading.Thread(target=stop_node_2, daemon=True)
            thread.start()
            try:
                assign.answer("J5")
                problem = assign.until("cannot_move")
            finally:
                is_over.set()
                thread.join(LONGEST)
            self.assertEqual(problem["node"], 2)
            self.assertIn("node 2", problem["problem"])
            self.assertEqual(assign.next(),
                             {"event": "question", "question": "joint", "node": 2, "serial": problem["serial"]})
            assign.answer("4")
            self.assertEqual(assign.until("question")["node"], 3)
            assign.answer("quit")
            self.assertEqual(assign.end(), 1)
            other.end()
            self.assertEqual(assign.names(), ["places", "moves", "question", "places", "cannot_move", "question", "places",
                                              "moves", "question"])
            self.assertIn("proleg assign: ended by the user; no node id was changed\n", assign.errors)
            self.assertEqual(set(states(bus.tcp).values()), {"no power"})

    def test_params_keep_the_settings_of_modules(self):
        with Bus() as bus, tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "settings.txt"
            self.assertEqual(proleg("params", "save", file, "--bus", bus.tcp).returncode, 0)
            self.assertEqual(proleg("params", "diff", file, "--bus", bus.tcp).stdout, "0 differences\n")
            proleg("set", "2", "0x6080", "300", "--bus", bus.tcp)
            diff = proleg("params", "diff", file, "--bus", bus.tcp)
            self.assertEqual(diff.returncode, 1)
            self.assertIn("node 2  0x6080  Max motor speed: found 300 deg/s, the file has 720 deg/s", diff.stdout)
            difference = {"node": 2, "object": "0x6080", "name": "Max motor speed", "found": "300 deg/s", "wanted": "720 deg/s"}
            self.assertEqual(proleg_json("params", "diff", file, "--bus", bus.tcp, "--json"), {
                "file": str(file), "modules": [1, 2, 3, 4, 5], "differences": [difference], "other_modules": [],
                "without_gait": [], "changed": 0, "stored": False})
            file.write_text(file.read_text().replace("3\t0x200A:1\t2000", "3\t0x200A:1\t1500"))
            self.assertIn("changed 2 values of 5 modules",
                          proleg("params", "load", file, "--store", "--bus", bus.tcp).stdout)
            proleg("nmt", "reset-node", "all", "--bus", bus.tcp)
            self.assertEqual(proleg("params", "diff", file, "--bus", bus.tcp).stdout, "0 differences\n")
            proleg("set", "3", "0x200A:1", "1600", "--bus", bus.tcp)
            load = proleg_json("params", "load", file, "--store", "--bus", bus.tcp, "--json")
            self.assertEqual(load["differences"], [{"node": 3, "object": "0x200A:1", "name": "Current limit", "found": "1600 mA",
                                                    "wanted": "1500 mA"}])
            self.assertEqual((load["changed"], load["stored"]), (1, True))
            again = Path(folder) / "again.txt"
            self.assertEqual(proleg_json("params", "save", again, "--nodes", "2-3", "--bus", bus.tcp, "--json"), {
                "file": str(again), "modules": [2, 3], "differences": [], "other_modules": [], "without_gait": [],
                "changed": 0, "stored": False})
            text = file.read_text()
            file.write_text(re.sub(r"(module\t1\t\S+\t)\S+", r"\g<1>0x00000001", text))
            other = proleg("params", "load", file, "--bus", bus.tcp)
            self.assertEqual(other.returncode, 1)
            self.assertIn("node 1: found core", other.stderr)
            file.write_text("nonsense")
            self.assertEqual(proleg("params", "load", file, "--bus", bus.tcp).returncode, 2)

    def test_params_of_a_gait_wait_for_a_gait_and_those_of_a_module_for_that_module(self):
        with Bus() as bus, tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "settings.txt"
            drive_json(start_drive(bus.tcp, "--seconds", "1"))
            self.assertEqual(proleg("params", "save", file, "--bus", bus.tcp).returncode, 0)
            self.assertIn("0x3040:1", file.read_text())
            proleg("nmt", "reset-node", "all", "--bus", bus.tcp)
            load = proleg("params", "load", file, "--bus", bus.tcp)
            self.assertEqual(load.returncode, 0, load.stderr)
            self.assertIn("parameters of the gait, which nodes 1, 2, 3, 4, 5 do not have now", load.stdout)
            file.write_text(re.sub(r"(module\t2\t)\S+", r"\g<1>0x00000001", file.read_text()))
            other = proleg("params", "load", file, "--bus", bus.tcp)
            self.assertEqual(other.returncode, 1)
            self.assertIn("node 2: found the serial number 0x", other.stderr)
            self.assertIn("nothing was written", other.stderr)
            self.assertEqual(proleg("params", "load", file, "--any-module", "--bus", bus.tcp).returncode, 0)
            self.assertIn("node 2: found the serial number", proleg("params", "diff", file, "--bus", bus.tcp).stdout)
            diff = proleg_json("params", "diff", file, "--bus", bus.tcp, "--json")
            self.assertEqual(diff["without_gait"], ["1", "2", "3", "4", "5"])
            self.assertRegex(diff["other_modules"][0],
                             "^node 2: found the serial number 0x[0-9A-F]{8}, the file has 0x00000001$")

    def test_nmt_reports_a_node_that_is_not_there(self):
        with Bus() as bus:
            for command in ("start", "stop", "pre-operational", "reset-node", "reset-communication"):
                there = proleg("nmt", command, "2", "--bus", bus.tcp)
                self.assertEqual(there.returncode, 0, there.stderr)
                missing = proleg("nmt", command, "3,9", "--bus", bus.tcp)
                self.assertEqual(missing.returncode, 1, command)
                self.assertIn("no sign of node 9", missing.stderr)
                self.assertEqual(len(missing.stderr.splitlines()), 1)

    def test_drive_ends_when_another_program_takes_a_joint(self):
        for take in (("nmt", "stop", "2"), ("set", "2", "0x6060", "8")):
            with Bus() as bus:
                drive = start_drive(bus.pty)
                wait_for_drives(bus.tcp, "operation enabled")
                host, port = bus.tcp.removeprefix("tcp:").split(":")
                with socket.create_connection((host, int(port)), timeout=LONGEST) as line:
                    line.sendall(b"C\rS8\rO\r" + {"nmt": b"t00020202\r", "set": b"t60282F60600008000000\r"}[take[0]])
                    out, err = drive.communicate(timeout=LONGEST)
                self.assertEqual(drive.returncode, 1, (out, err))
                self.assertIn("node 2 (J4) does not follow the gait any more", err)

    def test_monitor_shows_the_moving_robot(self):
        with Bus() as bus:
            self.assertIn("no host drives the robot",
                          proleg("monitor", "--bus", bus.pty, "--seconds", "1").stdout.splitlines()[-1])
            drive = start_drive(bus.tcp)
            wait_for_drives(bus.pty, "operation enabled")

            lines = proleg("monitor", "--bus", bus.pty, "--seconds", "5", "--json").stdout.splitlines()
            seconds = [json.loads(line) for line in lines[:-1]]
            self.assertGreaterEqual(len(seconds), 4)
            # A SYNC at the end of a second counts in this one or in the next.
            self.assertAlmostEqual(sum(second["syncs"] for second in seconds[1:]), 100 * len(seconds[1:]), delta=1)
            for second in seconds[1:]:
                self.assertTrue(second["host"])
                self.assertAlmostEqual(second["syncs"], 100, delta=1)
                self.assertTrue(0.01 < second["bus_load"] < 0.2, second["bus_load"])
            last = seconds[-1]
            self.assertEqual([node["node"] for node in last["nodes"]], [1, 2, 3, 4, 5])
            for node in last["nodes"]:
                self.assertEqual(node["drive"], "operation enabled")
                self.assertLessEqual(abs(node["setpoint_deg"]), 40.01, "the amplitude")
                self.assertGreaterEqual(node["current_ma"], 0)
                self.assertEqual(node["fault"], "")
            table = proleg("monitor", "--bus", bus.pty, "--seconds", "1").stdout
            self.assertIn("driven by a host", table)
            self.assertNotIn("no host drives", table)
            info = proleg("info", "3", "--bus", bus.pty).stdout
            self.assertIn("(PatternGenerator_sinusoidal)", info)
            self.assertIn("amplitude: slot 1 = 40 deg", info)
            amplitude = [value for value in proleg_json("info", "3", "--bus", bus.pty, "--json")["values"]
                         if value["name"] == "PatternGenerator_sinusoidal amplitude: slot 1"]
            self.assertEqual([(value["writable"], value["help"]) for value in amplitude],
                             [(True, "How far the joint swings to each side.")])
            drive.send_signal(signal.SIGINT)
            drive.communicate(timeout=LONGEST)
            self.assertEqual(drive.returncode, 0)

    def test_a_simulated_bus_of_ones_own(self):
        scan = proleg("scan", "--bus", f"sim:{SOURCE / SCENARIO}")
        self.assertEqual(scan.returncode, 0, scan.stderr)
        self.assertIn("5 nodes", scan.stdout)

    def test_a_simulated_robot_at_full_speed(self):
        drive = proleg("drive", SOURCE / SCENARIO, "--bus", f"sim:{SOURCE / SCENARIO}", "--fast", "--json", "--set",
                       "amplitude=20@1s")
        self.assertEqual(drive.returncode, 0, drive.stderr)
        result = json.loads(drive.stdout)
        self.assertEqual(result["differences"], 0)
        expected = simulated("--set", "amplitude=20@1s")
        self.assertEqual(result["setpoint_hash"], expected["setpoint_hash"])
        self.assertEqual(result["servo_hash"], expected["servo_hash"])

    def test_a_mirror_shows_how_the_robot_differs_from_its_simulation(self):
        with tempfile.TemporaryDirectory() as folder:
            weak = Path(folder) / "weak"
            shutil.copytree((SOURCE / SCENARIO).parent, weak)
            robot = weak / "caterpillar.robot.xml"
            text = robot.read_text()
            self.assertIn("<gain>50</gain>", text)
            robot.write_text(text.replace("<gain>50</gain>", "<gain>15</gain>"))
            for bus, (least, most) in ((SOURCE / SCENARIO, (0.0, 0.5)), (weak / "uniform.simulation.xml", (5.0, 40.0))):
                mirror = Path(folder) / "mirror.proleg"
                drive = proleg("drive", SOURCE / SCENARIO, "--bus", f"sim:{bus}", "--fast", "--seconds", "5", "--json",
                               "--mirror", mirror)
                self.assertEqual(drive.returncode, 0, drive.stderr)
                for joint in json.loads(drive.stdout)["mirror"]["joints"]:
                    self.assertIn(joint["measurements"], (50, 51), joint)
                    self.assertTrue(least <= joint["largest_deg"] <= most, joint)
                replay = proleg("replay", mirror)
                self.assertEqual(replay.returncode, 0, replay.stderr)
                self.assertIn("<svg", (Path(folder) / "mirror.difference.svg").read_text())
            # The simulated robot of the recording has moved as in 'proleg simulate'.
            table = proleg("export", mirror, "--out", "-").stdout.splitlines()
            self.assertEqual(len(table), 501)

    def test_the_name_of_a_joint_may_have_a_comma(self):
        with tempfile.TemporaryDirectory() as folder:
            named = Path(folder) / "named"
            shutil.copytree((SOURCE / SCENARIO).parent, named)
            for file in named.glob("*.xml"):
                file.write_text(file.read_text().replace('"J4"', '"J,4"').replace('"J3"', '"J"'))
            scenario = named / Path(SCENARIO).name
            # Only the last place is wrong, so all others have been understood.
            result = proleg("assign", scenario, "--bus", "can0", "--places", "1=J,4,0x12AB=J,3=J5,4=J9")
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn("--places: found '4=J9', expected NODE=JOINT", result.stderr)

    def test_bad_input_is_one_line_and_the_right_status(self):
        scenario = SOURCE / SCENARIO
        with socket.socket() as nobody:
            nobody.bind(("127.0.0.1", 0))
            port = nobody.getsockname()[1]
        for status, words, expected in (
            (2, ("scan", "--bus", "nonsense:x"), "nonsense:x"),
            (2, ("get", "3", "nonsense", "--bus", "can0"), "no object of this name"),
            (2, ("get", "300", "0x6064", "--bus", "can0"), "node ids from 1 to 126"),
            (2, ("set", "3", "0x6080", "5", "--bus", "can0"), "90 to 10000"),
            (2, ("nmt", "fly", "3", "--bus", "can0"), "one of start"),
            (2, ("drive", scenario, "--bus", "can0", "--set", "speed=1"), "unknown parameter"),
            (2, ("drive", "missing.simulation.xml", "--bus", "can0"), "missing.simulation.xml"),
            (2, ("assign", scenario, "--bus", "can0", "--places", "1=J9"), "the joints are J1"),
            (2, ("assign", scenario, "--bus", "can0", "--places", "1=J1,1=J2"), "each module and each joint once"),
            (2, ("assign", scenario, "--bus", "can0", "--amplitude", "90"), "from 1 to 30"),
            (2, ("assign", scenario, "--bus", "can0", "--json", "--json-lines"), "--json"),
            (2, ("assign", scenario, "--bus", "can0", "--json-lines", "--places", "1=J9"), "the joints are J1"),
            (1, ("assign", scenario, "--bus", "can77"), "can77"),
            (1, ("assign", scenario, "--bus", "can77", "--json-lines"), "can77"),
            (2, ("drive", scenario, "--bus", "can0", "--fast"), "--bus sim:FILE"),
            (2, ("bus", scenario), "no way to reach the robot"),
            (2, ("bus", scenario, "--tcp", "x"), "--tcp"),
            (2, ("bus", scenario, "--gateway", "9"), "--gateway: found node '9', expected one of 1, 2, 3, 4, 5"),
            (2, ("bus", scenario, "--gateway", "3=x"), "--gateway"),
            (2, ("bus", scenario, "--gateway", "3", "--fresh", "3"), "--gateway"),
            (2, ("bus", scenario, "--pty", "--fresh", "x"), "--fresh: found 'x', expected node ids"),
            (2, ("bus", scenario, "--tcp", "::1:0"), "[IPV6_ADDRESS]:PORT"),
            (2, ("scan", "--bus", "sim:missing.simulation.xml"), "sim:missing.simulation.xml"),
            (1, ("scan", "--bus", "can77"), "can77"),
            (1, ("scan", "--bus", "serial:/dev/missing"), "no such device"),
            (1, ("scan", "--bus", f"tcp:127.0.0.1:{port}"), "tcp:127.0.0.1"),
            (1, ("drive", scenario, "--bus", f"tcp:127.0.0.1:{port}"), "tcp:127.0.0.1"),
        ):
            result = proleg(*words)
            self.assertEqual(result.returncode, status, (words, result.stderr))
            self.assertEqual(len(result.stderr.splitlines()), 1, (words, result.stderr))
            self.assertIn(expected, result.stderr, words)
            self.assertEqual(result.stdout, "", words)


if __name__ == "__main__":
    SOURCE = Path(sys.argv[1])
    PROGRAMS = Path(sys.argv[2])
    unittest.main(argv=sys.argv[:1], verbosity=1)

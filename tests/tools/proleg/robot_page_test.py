"""`proleg ui FILE --bus`: a robot on a bus behind the page, without a browser. The robot is a simulated one, reached as a
real one would be.

Usage: robot_page_test.py SOURCE PROGRAMS [TEST]"""

import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

SOURCE, PROGRAMS = Path(sys.argv[1]), Path(sys.argv[2])
sys.path.insert(0, str(SOURCE / "tests/host/server"))
from web_client import WAIT_S, Viewer, request  # noqa: E402

UNIFORM = SOURCE / "sim/scenarios/travelling_wave/uniform.simulation.xml"
JOINTS = 5
NONE = -(1 << 31)
LIMIT_S = WAIT_S  # for what moves, with other tests beside it


class Driver(Viewer):
    """A viewer that gives signs of life while it has control."""

    def __init__(self, page, name="desk", **options):
        super().__init__(page.port, page.token, name, **options)
        self.lock = threading.Lock()
        self.is_alive = True
        self.epoch = 0
        self.pulse = threading.Thread(target=self.beat, daemon=True)
        self.pulse.start()

    def send_bytes(self, data):
        with getattr(self, "lock", threading.Lock()):
            super().send_bytes(data)

    def beat(self):
        while self.is_alive:
            try:
                self.send({"type": "beat", "age_ms": 1})
            except OSError:
                return
            time.sleep(0.1)

    def until(self, condition, limit_s=LIMIT_S):
        end = time.monotonic() + limit_s
        while not condition():
            assert time.monotonic() < end, f"the condition does not hold after {limit_s} s: {self.session()} {self.notices}"
            self.next()

    def ask(self, name, **arguments):
        return self.do(name, self.epoch, **arguments)

    def must(self, name, **arguments):
        result = self.ask(name, **arguments)
        assert result["ok"], result
        return result["value"]

    def drive(self):
        self.epoch = self.take_control()

    def session(self):
        return self.documents.get("session", {}).get("value", {})

    def bus(self):
        return self.documents["bus"]["value"]

    def until_state(self, state):
        self.until(lambda: self.session().get("state") == state)

    def watch(self, *signals):
        self.until(lambda: "telemetry" in self.documents)
        self.send({"type": "subscribe", "signals": list(signals)})

    def angles(self):
        """The newest measured angles, in degrees. Only `angle` is watched."""
        self.rows.clear()
        self.until(lambda: self.rows)
        return [None if raw == NONE else raw * 90 / (1 << 30) for raw in self.rows[-1]["values"][-1][:JOINTS]]

    def steps(self, joints):
        """How far the set-points went from each tick to the next, in degrees. A viewer that is slow does not get every tick."""
        ticks = {(message["run"], message["tick"] + i * message["stride"]): row
                 for message in self.rows for i, row in enumerate(message["values"])}
        return [abs(ticks[run, tick + 1][joint] - row[joint]) * 90 / (1 << 30)
                for (run, tick), row in ticks.items() if (run, tick + 1) in ticks for joint in joints]

    def stop_robot(self):
        count = len(self.stops)
        self.send({"type": "stop"})
        self.until(lambda: len(self.stops) > count)
        return self.stops[-1]


class Page:
    def __init__(self, folder, *options, bus=None):
        page = Path(folder, "page")
        page.mkdir(exist_ok=True)
        Path(page, "index.html").write_text("<!doctype html><title>page</title>")
        self.process = subprocess.Popen(
            [PROGRAMS / "proleg", "ui", UNIFORM, "--bus", bus or f"sim:{UNIFORM}", "--page", page, "--no-browser",
             "--recordings", folder, *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        address = re.search(r"http://127\.0\.0\.1:(\d+)/#(\S+)", self.process.stdout.readline())
        assert address, self.process.communicate()
        self.port, self.token = int(address[1]), address[2]

    def end(self):
        self.process.send_signal(signal.SIGINT)
        output, errors = self.process.communicate(timeout=LIMIT_S)
        assert self.process.returncode == 0, (output, errors)
        return errors

    def kill(self):
        self.process.kill()
        self.process.communicate()


class TcpBus:
    """A simulated robot that several programs reach."""

    def __init__(self):
        self.process = subprocess.Popen([PROGRAMS / "proleg", "bus", UNIFORM, "--tcp", "0"], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True)
        self.address = re.search(r"--bus (tcp:\S+)", self.process.stdout.readline())[1]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGINT)
        self.process.communicate(timeout=LIMIT_S)


def reset_module(bus, node):
    """As its reset by NMT: `proleg nmt` does not do that to a robot that is driven."""
    host, port = bus.address.removeprefix("tcp:").split(":")
    with socket.create_connection((host, int(port)), timeout=WAIT_S) as line:
        line.sendall(b"C\rS8\rO\r" + f"t000281{node:02X}\r".encode())
        line.recv(100)


def test_power_lets_no_joint_move(page, _):
    driver = Driver(page)
    driver.until(lambda: len(driver.documents.get("bus", {}).get("value", {}).get("modules", [])) == JOINTS)
    assert [module["joint"] for module in driver.bus()["modules"]] == list(range(JOINTS))
    driver.until_state("off")
    driver.until(lambda: [module["current_limit"] for module in driver.bus()["modules"]] == [2000] * JOINTS)
    driver.watch("angle")
    driver.drive()
    driver.until(lambda: None not in driver.angles())
    before = driver.angles()
    driver.must("power", on=True)
    driver.until_state("held")
    for _ in range(20):
        for angle, was in zip(driver.angles(), before):
            assert angle is None or abs(angle - was) < 1.0, (driver.angles(), before)
    driver.must("power", on=False)
    driver.until_state("off")
    assert driver.session()["failure"] is None, driver.session()


def test_joints_go_to_positions_at_limited_speed_and_within_their_limits(page, _):
    driver = Driver(page)
    driver.watch("setpoint")
    driver.drive()
    refused = driver.ask("pose", angles=[0] * JOINTS)
    assert refused["error"] == "the servos have no power", refused
    driver.must("power", on=True)
    driver.until_state("held")
    driver.rows.clear()
    driver.must("pose", angles=[30, None, -20, None, 90], speed=45)
    reached = lambda: driver.rows and abs(driver.rows[-1]["values"][-1][0] * 90 / (1 << 30) - 30) < 0.01
    driver.until(reached)
    driver.until(lambda: abs(driver.rows[-1]["values"][-1][2] * 90 / (1 << 30) + 20) < 0.01)
    steps = driver.steps([0])
    assert max(steps) < 45 * 0.01 + 0.001, f"at 45 degrees a second a joint moves 0.45 degrees a tick, found {max(steps)}"
    # The module has taken it: its measured angle follows.
    driver.watch("angle")
    driver.until(lambda: driver.angles()[0] is not None and abs(driver.angles()[0] - 30) < 6)
    for bad in ({"angles": [0] * 4}, {"angles": [91] + [0] * 4}, {"angles": ["x"] + [0] * 4}, {"angles": 3}, {},
                {"angles": [0] * 5, "speed": 0.5}, {"angles": [0] * 5, "speed": 1e9}):
        assert not driver.ask("pose", **bad)["ok"], bad
    assert driver.session()["state"] == "held"


def test_the_gait_runs_and_is_that_of_the_simulation(page, folder):
    driver = Driver(page)
    driver.drive()
    recording = driver.must("record", file="run.proleg")["file"]
    driver.must("run")
    driver.until_state("running")
    driver.must("set", words=["amplitude:J2=25"], gesture=1)
    driver.must("set", words=["amplitude:J2=30"], gesture=1)

    def confirmed():
        table = next(row for row in driver.documents["parameters"]["value"] if row["name"] == "amplitude")
        at = [joint["name"] for joint in driver.documents["robot"]["value"]["joints"]].index("J2")
        return table["confirmed"][at] == table["wanted"][at] != table["file"][at] and table["tick"][at] > 0
    driver.until(confirmed)
    assert not driver.ask("record", file="late.proleg")["ok"]
    driver.until(lambda: driver.session()["tick"] > 600)
    assert driver.session()["recording"] == recording
    assert driver.stop_robot()["confirmed"] == JOINTS
    driver.until_state("off")
    gait = driver.session()["gait"]
    assert gait["differences"] == 0 and gait["compared"] > 2000, gait
    assert driver.session()["stopped_by"] == "desk"
    replay = subprocess.run([PROGRAMS / "proleg", "replay", recording], capture_output=True, text=True, timeout=LIMIT_S)
    assert replay.returncode == 0, replay.stdout + replay.stderr
    driver.must("undo")
    driver.until(lambda: driver.session()["undo"] is None)


def test_the_gait_pauses_where_it_is_and_goes_on(page, _):
    driver = Driver(page)
    driver.drive()
    driver.must("run")
    driver.until(lambda: driver.session().get("tick", 0) > 150)
    driver.watch("setpoint")
    driver.until(lambda: driver.rows)
    driver.must("pause")
    driver.until_state("held")
    driver.rows.clear()
    driver.until(lambda: len(driver.rows) > 5)
    held = {tuple(row[:JOINTS]) for message in driver.rows[3:] for row in message["values"]}
    assert len(held) == 1, held
    driver.rows.clear()
    driver.must("run")
    driver.until(lambda: len(driver.rows) > 200)
    steps = driver.steps(range(JOINTS))
    assert 0.5 < max(steps) < 6, f"at most 180 degrees a second and the rest of the way, found {max(steps)} in a tick"
    assert driver.session()["state"] == "running" and driver.session()["failure"] is None, driver.session()
    assert driver.session()["gait"]["differences"] == 0


def test_stop_works_from_every_state(page, _):
    driver = Driver(page)
    driver.drive()
    driver.until(lambda: len(driver.documents.get("bus", {}).get("value", {}).get("modules", [])) == JOINTS)
    assert driver.stop_robot()["confirmed"] == JOINTS, "without power, too"
    for begin, state in (("power", "starting"), ("power", "held"), ("run", "running")):
        driver.must(begin, **({"on": True} if begin == "power" else {}))
        driver.until_state(state)
        stopped = driver.stop_robot()
        assert stopped["of"] == JOINTS
        assert state == "starting" or stopped["confirmed"] == JOINTS, (state, stopped)
        driver.until_state("off")
    body = request(page.port, "POST", "/stop", [f"Authorization: Bearer {page.token}"])[2]
    assert b'"stopped"' in body, body


def test_a_robot_without_a_driver_stops(page, _):
    driver, other = Driver(page), Driver(page, "wall")
    driver.drive()
    driver.must("run")
    other.until_state("running")
    driver.is_alive = False
    driver.sock.close()
    other.until_state("off")
    assert other.session()["stopped_by"] == "nobody drives"
    # A page that hangs, with an open connection:
    other.drive()
    other.must("power", on=True)
    other.until_state("held")
    other.is_alive = False
    other.until_state("off")
    assert other.session()["stopped_by"] == "nobody drives"


def test_control_from_the_start_gives_no_power(page, _):
    driver = Driver(page, wants_control=True)
    driver.until(lambda: driver.documents.get("control", {}).get("value", {}).get("holder") is not None)
    driver.until(lambda: [module["drive"] for module in driver.documents.get("bus", {}).get("value", {}).get("modules", [])]
                 == ["no power"] * JOINTS)
    driver.until_state("off")
    driver.epoch = driver.control()["epoch"]
    driver.must("power", on=True)
    driver.until_state("held")


def test_a_bus_that_is_lost_ends_the_run_and_not_the_page(page, _):
    driver = Driver(page)
    driver.drive()
    driver.must("run")
    driver.until_state("running")
    for status in Path("/proc").glob("[0-9]*/status"):
        try:
            if f"\nPPid:\t{page.process.pid}\n" in status.read_text():
                os.kill(int(status.parent.name), signal.SIGKILL)
        except (FileNotFoundError, ProcessLookupError):
            continue
    driver.until(lambda: driver.session()["failure"])
    driver.until_state("off")
    driver.until(lambda: not driver.bus()["connected"])
    assert driver.bus()["problem"]
    driver.until(lambda: any("stop by themselves" in notice for notice in driver.notices))
    assert not driver.ask("pose", angles=[0] * JOINTS)["ok"]


def test_a_module_that_restarts_holds_where_its_joint_is(_, folder):
    with TcpBus() as bus:
        page = Page(folder, bus=bus.address)
        try:
            driver = Driver(page)
            driver.drive()
            driver.must("power", on=True)
            driver.until_state("held")
            driver.must("pose", angles=[None, 40, None, None, None], speed=180)
            driver.watch("setpoint")
            at_40 = lambda: driver.rows and abs(driver.rows[-1]["values"][-1][1] * 90 / (1 << 30) - 40) < 0.01
            driver.until(at_40)
            reset_module(bus, 2)
            driver.until(lambda: any("node 2" in notice and "again" in notice for notice in driver.notices))
            driver.rows.clear()
            driver.until(lambda: len(driver.rows) > 3)
            assert driver.session()["state"] == "held", driver.session()
            driver.watch("setpoint", "angle")
            driver.rows.clear()
            driver.until(lambda: len(driver.rows) > 30)
            row = driver.rows[-1]["values"][-1]
            setpoint, angle = row[1] * 90 / (1 << 30), row[JOINTS + 1] * 90 / (1 << 30)
            assert abs(setpoint - angle) < 6, (setpoint, angle)
            driver.must("power", on=False)
            driver.until_state("off")
            assert driver.session()["failure"] is None
        finally:
            page.end()


def test_a_limit_of_the_current_is_read_again_when_asked(_, folder):
    with TcpBus() as bus:
        page = Page(folder, bus=bus.address)
        try:
            driver = Driver(page)
            limits = lambda: [module["current_limit"] for module in driver.bus()["modules"]]
            driver.until(lambda: "bus" in driver.documents and limits() == [2000] * JOINTS)
            subprocess.run([PROGRAMS / "proleg", "set", "3", "0x200A:1", "750", "--bus", bus.address], check=True,
                           capture_output=True, timeout=LIMIT_S)
            driver.must("scan")
            driver.until(lambda: limits() == [2000, 2000, 750, 2000, 2000])
        finally:
            page.end()


def test_a_robot_that_another_host_drives_is_left_alone_but_can_be_stopped(_, folder):
    with TcpBus() as bus:
        page = Page(folder, bus=bus.address)
        other = subprocess.Popen([PROGRAMS / "proleg", "drive", UNIFORM, "--bus", bus.address, "--seconds", "3600"],
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            driver = Driver(page)
            driver.drive()
            driver.until(lambda: driver.documents.get("bus", {}).get("value", {}).get("other_host"))
            driver.until(lambda: driver.bus()["syncs"] > 50)
            driver.must("run")
            driver.until(lambda: driver.session()["failure"])
            driver.until_state("off")
            assert "host" in driver.session()["failure"], driver.session()
            assert other.poll() is None, other.communicate()
            assert driver.stop_robot()["confirmed"] == JOINTS
            _, errors = other.communicate(timeout=LIMIT_S)
            assert other.returncode == 1 and "does not follow the gait any more" in errors, errors
        finally:
            other.kill()
            page.end()


def test_what_is_not_possible_is_refused_and_the_gait_goes_on(page, _):
    driver = Driver(page)
    driver.drive()
    driver.must("run")
    driver.until_state("running")
    assert not driver.ask("power", on=True)["ok"]
    assert not driver.ask("scan")["ok"]
    assert not driver.ask("step")["ok"]
    assert not driver.ask("set", words=["amplitude=3000"])["ok"]
    tick = driver.session()["tick"]
    driver.until(lambda: driver.session()["tick"] > tick + 100)
    assert driver.session()["state"] == "running"


def test_the_end_of_the_program_stops_the_robot_before_its_goodbye(_, folder):
    for end in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        page = Page(folder)
        try:
            driver = Driver(page)
            driver.drive()
            driver.must("run")
            driver.until_state("running")
            page.process.send_signal(end)
            driver.until_state("off")  # the connection lasts until the robot is at rest
            assert driver.session()["stopped_by"] == "the end of the program", driver.session()
            driver.is_alive = False
            page.process.communicate(timeout=LIMIT_S)
            assert page.process.returncode == 0
        finally:
            page.kill()


def main():
    tests = {name: test for name, test in globals().items() if name.startswith("test_")}
    for name, test in tests.items():
        if len(sys.argv) > 3 and sys.argv[3] not in name:
            continue
        print(name, flush=True)
        with tempfile.TemporaryDirectory() as folder:
            page = Page(folder)
            try:
                test(page, folder)
                page.end()
            finally:
                page.kill()


main()

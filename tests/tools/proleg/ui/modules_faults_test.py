"""What goes wrong with modules behind the page, and what a malicious page does: `proleg ui` and `proleg bus` as in modules_test.py.

Usage: modules_faults_test.py SOURCE PROGRAMS fast|slow|NAME"""

import faulthandler
import json
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import contextmanager, suppress
from pathlib import Path

from module_table import LONGEST, PROGRAMS, SCENARIO, SOURCE, Bus, Table, proleg, wait_until
from processes import children, runs
from web_client import Closed, Viewer, live

JOINTS = [f"J{number}" for number in range(1, 6)]
BUILT_IMAGE = PROGRAMS.parent.parent / "stm32f405/bin/proleg_stm32f405.pimg"
SLOT = 0x08020200
SLOW = set()


def slow(test):
    SLOW.add(test.__name__)
    return test


@contextmanager
def project():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copytree(SOURCE / "sim/scenarios/travelling_wave", folder, dirs_exist_ok=True)
        yield folder


@contextmanager
def page(*bus_options, is_fixed=False):
    """A bus, and a page that has it open."""
    with project() as folder, Bus(*bus_options) as bus:
        with Table(folder, ("--bus", bus.address) if is_fixed else ("--paused",)) as table:
            if not is_fixed:
                table.must("modules.open", bus=bus.address)
                table.do("modules.scan")  # modules without a host say nothing of themselves
            yield table, bus


def program(seed, size=14_000):
    """A body that looks like a program: a vector table, then anything."""
    words = [0x20000800, SLOT + 0x201] + [(seed * 2654435761 + i * 40503) & 0xFFFFFFFF for i in range(size // 4 - 2)]
    return struct.pack(f"<{len(words)}I", *words)


def make_image(table, version, content=None, board=1):
    """An image in the project; its name there."""
    body = table.folder / "body.bin"
    body.write_bytes(content or program(int(version[2])))
    name = f"v{version}.pimg"
    subprocess.run([PROGRAMS / "proleg", "image", "make", body, "--output", table.folder / name, "--board", str(board),
                    "--address", hex(SLOT), "--version", version, "--protocol", "0x0100", "--fingerprint", "12345678",
                    "--schema", "2"], check=True, capture_output=True)
    table.must("modules.look")
    return name


def drives(bus):
    """The states of the drives, by node; nothing if none answers."""
    text = proleg("scan", "--bus", bus.address, "--json")
    return {node["node"]: node["drive"] for node in json.loads(text)["nodes"]} if text else {}


def all_without_power(bus, count=5, also=()):
    """Waits for it. also: what else the drives may do."""
    found = {}

    def are_off():
        found.clear()
        found.update(drives(bus))
        return len(found) == count and not (set(found.values()) - set(also)) & {"operation enabled", "quick stop"}
    wait_until(are_off, lambda: found)
    return found


def is_well(bus):
    text = proleg("recover", "--wait", "0", "--bus", bus.address, "--json")
    return bool(text) and json.loads(text)["well"]


def begin_assign(table, bus):
    """A joint moves; the number of the job."""
    number = table.must("modules.assign")["job"]
    table.question()
    bus.joint_with_power()
    return number


def assign_all(table, bus, joints=tuple(JOINTS)):
    """Answers all questions as a person does; the job at its end."""
    table.must("modules.assign")
    question = {"number": 0}
    for _ in joints:
        question = table.question(question["number"])
        assert question["question"] == "joint", question
        table.answer(question, bus.joint_with_power())
    job = table.job(lambda job: job["state"] == "ended" or job["question"] and job["question"]["question"] == "agree")
    if job["question"]:
        table.answer(job["question"], "yes")
    return table.job()


def session(table):
    return table.fresh("session")


# 1. The robot of the program

@slow
def test_the_robot_of_the_program_is_driven_and_its_modules_are_worked_on():
    with page("--shuffle", "3", is_fixed=True) as (table, bus):
        modules = table.document("modules")
        assert modules["is_fixed"] is True and modules["bus"] == bus.address, modules
        assert modules["robot"]["document"] == "robot", modules
        assert "is open" in table.refused("modules.open", bus=bus.address)
        assert "started with" in table.refused("modules.close")
        scan = table.do("modules.scan")
        assert scan["status"] == 0 and len(scan["result"]["nodes"]) == 5, scan
        assert scan["result"]["bus"] == bus.address and "fd:" not in json.dumps(scan), scan
        assert table.must("modules.read", node=2)["values"]
        assert "= 300" in table.must("modules.set", node=2, object="0x6080", value="300")["text"]
        examined = table.do("modules.examine")
        assert examined["status"] == 0 and examined["result"]["findings"] == [], examined
        begin_assign(table, bus)
        for words in (("power", {"on": True}), ("run", {}), ("scan", {})):
            assert "a job on the modules goes on" in table.refused(words[0], **words[1]), words
        table.must("modules.cancel", job=table.document("module_job")["number"])
        table.job()
        end = assign_all(table, bus)
        assert end["status"] == 0, end

        # driven as ever, as soon as the program has looked for the modules again
        wait_until(lambda: (power := table.ask("power", on=True))["ok"] or "goes on" not in power["error"], "power")
        wait_until(lambda: session(table)["state"] == "held", lambda: table.document("session"))
        for name, arguments in (("scan", {}), ("examine", {}), ("read", {"node": 1}), ("save", {"file": "a.params"}),
                                ("assign", {}), ("calibrate", {"node": 1}), ("recover", {"dry_run": True}),
                                ("set", {"node": 1, "object": "0x6080", "value": "300"})):
            assert "power" in table.refused(f"modules.{name}", **arguments), name
        table.must("power", on=False)
        wait_until(lambda: session(table)["state"] == "off", lambda: table.document("session"))
        assert table.do("modules.scan")["status"] == 0
        table.must("run")
        wait_until(lambda: session(table).get("tick") and session(table)["tick"] > 300, lambda: table.document("session"))
        table.viewer.send({"type": "stop"})
        wait_until(lambda: session(table)["state"] == "off", lambda: table.document("session"))
        gait = table.document("session")["gait"]
        assert gait["differences"] == 0 and gait["compared"] > 500, gait
        assert table.document("session")["failure"] is None, table.document("session")
        wait_until(lambda: [module["joint"] for module in table.fresh("bus")["modules"]] == list(range(5)),
                   lambda: table.document("bus"))


def test_stop_and_a_page_that_closes_end_an_assign_of_the_robot():
    with page(is_fixed=True) as (table, bus):
        wait_until(lambda: len(table.fresh("bus")["modules"]) == 5, lambda: table.document("bus"))
        begin_assign(table, bus)
        stops = len(table.viewer.stops)
        table.viewer.send({"type": "stop"})
        table.viewer.until(lambda: len(table.viewer.stops) > stops)
        stopped = table.viewer.stops[-1]
        assert stopped["of"] == 5, stopped
        job = table.job()
        assert job["ended_by"] == "STOP by viewer", job
        all_without_power(bus)
        begin_assign(table, bus)
        table.viewer.sock.close()
        all_without_power(bus)
        table.load_page()
        job = table.job()
        assert job["ended_by"] == "nobody drives" and job["state"] == "ended", job
        assert table.do("modules.scan")["status"] == 0


# 2. Virtual chips, flash, recover

@slow
def test_virtual_chips_and_native_modules_are_one_bus():
    with page("--modules", "1,3=mcu") as (table, bus):
        scan = table.do("modules.scan")
        assert [node["node"] for node in scan["result"]["nodes"]] == [1, 2, 3, 4, 5], scan
        everything = {node: {value["object"] for value in table.must("modules.read", node=node, all=True)["values"]}
                      for node in (1, 2)}
        assert everything[1] == everything[2], everything[1] ^ everything[2]
        assert table.do("modules.save", file="chips.params", nodes="1-3")["result"]["modules"] == [1, 2, 3]
        table.must("modules.set", node=1, object="0x200A:1", value="1500")
        loaded = table.do("modules.load", file="chips.params", store=True)
        assert loaded["status"] == 0 and loaded["result"]["changed"] == 1, loaded
        wait_until(lambda: (modules := table.fresh("bus")["modules"]) and len(modules) == 5 and
                   all(module["contacts"] is not None for module in modules), lambda: table.document("bus"))
        image = make_image(table, "0.9.0", BUILT_IMAGE.read_bytes()[512:])
        job = table.do("modules.flash", image=image, canary=True)
        assert job["status"] == 0 and job["error"] is None, job
        verdicts = job["latest"]["verdicts"]
        assert verdicts["version"] == "0.9.0" and {one["action"] for one in verdicts["modules"]} == {"flash"}, verdicts
        assert [module["node"] for module in job["latest"]["ended"]["modules"]] == [2, 3, 4, 5], job
        assert all(module["part"] == 1 for module in job["latest"]["progress"]["modules"]), job
        assert {module["now"]["version"] for module in job["result"]["modules"]} == {"0.9.0"}, job
        assert all(module["now"]["running"] and module["now"]["confirmed"] for module in job["result"]["modules"]), job
        found = wait_until(lambda: (found := table.fresh("modules")["found"]) and len(found["nodes"]) == 5 and found,
                           lambda: table.document("modules"))
        assert found, found


@slow
def test_modules_that_are_broken_come_back():
    broken = {1: "hangs", 2: "faults", 3: "no-program", 4: "newer-settings", 5: "duplicate:4"}
    with page(*(word for node, kind in broken.items() for word in ("--broken", f"{node}={kind}"))) as (table, bus):
        image = make_image(table, "0.2.0")
        dry = table.do("modules.recover", image=image, wait=8, dry_run=True)
        codes = sorted(fault["code"] for module in dry["latest"]["found"]["modules"] for fault in module["found"])
        assert codes == sorted(["starts_badly"] * 2 + ["no_program", "newer_settings"] + ["duplicate_node_id"] * 2), codes
        assert dry["latest"]["waits"]["seconds"] == 8, dry
        job = table.do("modules.recover", image=image, wait=8, reset_settings=True)
        assert job["status"] == 0 and job["result"]["well"], job
        wait_until(lambda: len(drives(bus)) == 5, lambda: drives(bus))
        again = table.do("modules.recover", wait=0)
        assert again["status"] == 0 and again["result"]["well"], again


@slow
def test_a_flash_in_which_a_module_fails_says_which_one():
    with page("--broken", "2=hangs") as (table, bus):  # it is there only while its bootloader is
        image = make_image(table, "0.2.0")
        job = table.do("modules.flash", image=image, nodes="1,2,3")
        assert job["status"] == 0 and len(job["result"]["modules"]) == 3 or "node 2" in job["error"], job
    with page() as (table, bus):
        foreign = make_image(table, "0.3.0", board=2)
        job = table.do("modules.flash", image=foreign)
        assert job["status"] == 1 and {module["action"] for module in job["result"]["modules"]} == {"refuse"}, job
        job = table.do("modules.flash", image=foreign, nodes="2,9")
        assert job["status"] == 1 and job["result"] is None and "node 9" in job["error"], job


def test_a_flash_goes_on_without_its_page():
    with page() as (table, bus):
        image = make_image(table, "0.4.0", program(4, 80_000))
        table.must("modules.flash", image=image)
        table.job(lambda job: "progress" in job["latest"])
        table.viewer.sock.close()
        time.sleep(3)  # more than the second after which joints stop
        table.load_page()
        job = table.job()
        assert job["status"] == 0 and job["ended_by"] is None, job
        assert all(module["good"] for module in job["result"]["modules"]), job


@slow
def test_stop_does_not_disturb_a_job_in_which_no_joint_moves():
    with page() as (table, bus):
        image = make_image(table, "0.4.0", program(4, 80_000))
        assert table.do("modules.save", file="a.params")["status"] == 0
        for kind, arguments in (("flash", {"image": image}), ("load", {"file": "a.params", "store": True}),
                                ("save", {"file": "b.params"}), ("recover", {"wait": 2})):
            number = table.must(f"modules.{kind}", **arguments)["job"]
            while table.fresh("module_job")["state"] == "running":
                table.viewer.send({"type": "stop"})
                time.sleep(0.1)
            job = table.job(lambda job: job["number"] == number and job["state"] == "ended")
            assert job["status"] == 0 and job["ended_by"] is None, job
        all_without_power(bus)


@slow
def test_a_bus_that_says_nothing_is_no_bus():
    """The other end takes the connection, and is silent."""
    with project() as folder, Table(folder) as table, socket.create_server(("127.0.0.1", 0)) as silent:
        refusal = table.refused("modules.open", bus=f"tcp:127.0.0.1:{silent.getsockname()[1]}")
        print("  ", refusal)
        assert table.fresh("modules")["bus"] is None


# 3. The doctor

def shell_doctor(bus):
    return json.loads(proleg("doctor", "--bus", bus.address, "--json"))


def codes_of(report):
    return [finding["code"] for finding in report["findings"]]


class Sender:
    """A program that sends frames of a host that breaks the rules."""

    def __init__(self, bus, frames, period_s):
        host, port = bus.address.removeprefix("tcp:").split(":")
        self.line = socket.create_connection((host, int(port)))
        self.line.sendall(b"C\rS8\rO\r")
        self.ends = False
        self.thread = threading.Thread(target=self.run, args=(frames, period_s), daemon=True)
        self.thread.start()

    def run(self, frames, period_s):
        count = 0
        self.line.setblocking(False)
        while not self.ends:
            try:
                self.line.recv(1 << 16)
            except BlockingIOError:
                pass
            count += 1
            try:
                self.line.sendall(b"".join(frame(count) for frame in frames))
            except BlockingIOError:
                pass
            except OSError:
                return
            time.sleep(period_s)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.ends = True
        self.thread.join(LONGEST)
        self.line.close()


def the_same_findings(table, bus, expected):
    shell = shell_doctor(bus)
    job = table.do("modules.examine")
    assert job["result"], job
    assert codes_of(job["result"]) == codes_of(shell), (codes_of(job["result"]), codes_of(shell), job["result"], shell)
    assert expected in codes_of(shell), (expected, shell)
    found = [(finding["code"], finding["nodes"]) for finding in job["result"]["findings"]]
    assert found == [(finding["code"], finding["nodes"]) for finding in shell["findings"]], (job, shell)
    assert job["status"] == 1 and job["error"] is None, job


@slow
def test_the_doctor_says_what_it_says_in_a_shell():
    heartbeat = lambda _: b"t77F105\r"
    with page("--fresh", "3") as (table, bus):
        the_same_findings(table, bus, "module_without_node_id")
    with page("--broken", "5=duplicate:4") as (table, bus):
        the_same_findings(table, bus, "duplicate_node_id")
    with page() as (table, bus):
        with Sender(bus, [heartbeat], 0.04):
            the_same_findings(table, bus, "two_hosts")
        syncs = [lambda count: f"t0801{count % 240 + 1:02X}\r".encode(), lambda count: f"t0801{(count + 99) % 240 + 1:02X}\r".encode()]
        with Sender(bus, [heartbeat, *syncs], 0.1):
            the_same_findings(table, bus, "two_sync_producers")
        with Sender(bus, [lambda _: b"t00028102\r"], 0.3):
            the_same_findings(table, bus, "restarting_module")
        drive = subprocess.Popen([PROGRAMS / "proleg-drive", SCENARIO, "--bus", bus.address, "--seconds", "3600"],
                                 stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_until(lambda: set(drives(bus).values()) == {"operation enabled"}, lambda: drives(bus))
        drive.kill()
        drive.wait()
        wait_until(lambda: set(drives(bus).values()) == {"quick stop"}, lambda: drives(bus))
        the_same_findings(table, bus, "quick_stop")


# 4. The bus vanishes

def is_lost(text):
    return re.search("lost|closed the connection|not_reached", text)


def vanish(bus):
    bus.process.kill()


@slow
def test_a_bus_that_vanishes_ends_each_job_with_a_line():
    with project() as folder, Table(folder) as table:
        image = None
        for kind in ("none", "scan", "read", "save", "assign", "flash", "set", "examine"):
            with Bus() as bus:
                table.must("modules.open", bus=bus.address)
                table.do("modules.scan")  # modules without a host say nothing of themselves
                image = image or make_image(table, "0.4.0", program(4, 80_000))
                wait_until(lambda: len(table.fresh("bus")["modules"]) == 5, lambda: table.document("bus"))
                if kind == "none":
                    vanish(bus)
                elif kind == "read" or kind == "set":
                    wanted = table.viewer.start(f"modules.{kind}", table.epoch, node=2, **(
                        {"all": True} if kind == "read" else {"object": "0x6080", "value": "300", "store": True}))
                    wait_until(lambda: children(table.process.pid) or wanted in table.viewer.results, "a program", 0.001)
                    vanish(bus)
                    result = table.viewer.result(wanted)
                    assert kind == "set" or not result["ok"], result
                    assert "\n" not in result.get("error", ""), result
                    print(f"   {kind}:", result.get("error", "answered"))
                else:
                    if kind == "assign":
                        begin_assign(table, bus)
                    else:
                        arguments = {"save": {"file": "lost.params"}, "flash": {"image": image}}.get(kind, {})
                        table.must(f"modules.{kind}", **arguments)
                    if kind == "flash":
                        table.job(lambda job: "progress" in job["latest"])
                    vanish(bus)
                    job = table.job()
                    print(f"   {kind}:", job["error"] or [finding["code"] for finding in job["result"]["findings"]])
                    assert job["status"] == 1, job
                    assert is_lost(job["error"] or codes_of(job["result"])[0]), job
                wait_until(lambda: table.fresh("bus")["connected"] is False, lambda: table.document("bus"))
                assert table.document("bus")["problem"], table.document("bus")
                later = table.ask("modules.scan")
                if later["ok"]:
                    job = table.job()
                    assert job["status"] == 1 and is_lost(job["error"]) and "\n" not in job["error"], job
                wait_until(lambda: not children(table.process.pid), lambda: children(table.process.pid))
                table.must("modules.close")
        with Bus() as bus:
            table.must("modules.open", bus=bus.address)
            assert table.do("modules.scan")["status"] == 0
            assert table.fresh("bus")["connected"] is True


# 5. The program is killed

@slow
def test_the_program_ends_in_the_middle_of_a_job():
    for number in (signal.SIGKILL, signal.SIGINT, signal.SIGTERM):
        for kind in ("assign", "flash"):
            with page() as (table, bus):
                if kind == "assign":
                    begin_assign(table, bus)
                else:
                    table.must("modules.flash", image=make_image(table, "0.4.0", program(4, 80_000)))
                    table.job(lambda job: "progress" in job["latest"])
                programs = children(table.process.pid)
                assert [words[0].split("/")[-1] for words in programs.values()] == [f"proleg-{kind}"], programs
                begin = time.monotonic()
                table.process.send_signal(number)
                status = table.process.wait(timeout=LONGEST)
                assert number == signal.SIGKILL or status == 0, status
                at = time.monotonic()
                wait_until(lambda: not any(runs(process) for process in programs), lambda: programs)
                print(f"   {signal.Signals(number).name}, {kind}: the page ended after {at - begin:.1f} s, its child after "
                      f"{time.monotonic() - begin:.1f} s")
                # Nobody can take the power from a joint whose host has gone: its module holds it in the safe pose.
                held = all_without_power(bus, also=["quick stop"] if number == signal.SIGKILL else [])
                assert list(held.values()).count("quick stop") <= 1, held
                proleg("nmt", "reset-node", "all", "--bus", bus.address)
                all_without_power(bus)
                wait_until(lambda: len(drives(bus)) == 5 and is_well(bus), lambda: drives(bus))


# 6. A program of a job is killed

def test_a_program_that_is_killed_ends_its_job_alone():
    with page("--broken", "2=newer-settings") as (table, bus):
        image = make_image(table, "0.4.0", program(4, 80_000))
        for kind, arguments in (("scan", {}), ("examine", {}), ("save", {"file": "a.params"}), ("save", {"file": "b.params"}),
                                ("compare", {"file": "b.params"}), ("load", {"file": "b.params", "store": True}),
                                ("assign", {}), ("calibrate", {"node": 3}), ("recover", {"wait": 8}),
                                ("flash", {"image": image})):
            number = table.must(f"modules.{kind}", **arguments)["job"]
            if arguments.get("file") == "b.params" and kind == "save":
                assert table.job()["status"] == 0
                table.must("modules.look")
                continue
            if kind in ("assign", "calibrate"):
                table.question()
            if kind == "flash":
                table.job(lambda job: "progress" in job["latest"])
            programs = children(table.process.pid)
            assert len(programs) <= 1, programs
            for process in programs:
                with suppress(ProcessLookupError):  # it has ended by itself
                    os.kill(process, signal.SIGKILL)
            job = table.job(lambda job: job["number"] == number and job["state"] == "ended")
            has_ended_before = kind in ("compare", "load", "save") and job["status"] in (0, 1)
            assert not programs or has_ended_before or job["status"] is None and job["question"] is None and job["error"], job
            print(f"   {kind}: {job['status']}, {job['error']}")
            if kind == "assign":
                all_without_power(bus)
            following = table.do("modules.scan")
            assert following["status"] == 0, following
        wanted = table.viewer.start("modules.read", table.epoch, node=1, all=True)
        wait_until(lambda: children(table.process.pid) or wanted in table.viewer.results, "a program", 0.001)
        for process in children(table.process.pid):
            with suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        print("   read:", table.viewer.result(wanted).get("error", "answered")[:100])
        all_without_power(bus)


# 7. Words of a malicious page

HOSTILE = ["--yes", "-h", "--help", "--json-lines", "x" * 10_000, "", " ", "\n", "a\nb", "\0", "a\0b", "\x1b[2J", "\x7f", "../../etc/passwd",
           "/etc/passwd", "~/x", "..", ".", "$(id)", "`id`", ";id", "|id", "@/etc/passwd", "%s%n", "\u202e", "\u2028", "é", "1e999",
           None, True, False, 0, -1, 1.5, 1e308, -1e308, 2**31, 2**32, 2**53, 2**63, 2**64 - 1, [], {}, [1], {"a": 1}, [[[[]]]],
           "nan", "NaN", "inf", "0", "-1", "128", "1,3", "all", "1-5"]
ARGUMENTS = {
    "open": ["bus"], "read": ["node", "all"], "set": ["node", "object", "value", "store"], "save": ["file", "nodes"],
    "compare": ["file"], "load": ["file", "store", "any_module"], "assign": ["amplitude"], "calibrate": ["node"],
    "flash": ["image", "nodes", "canary", "dry_run", "force_board", "allow_downgrade"],
    "recover": ["image", "wait", "serials", "reset_settings", "dry_run"], "answer": ["job", "question", "word"], "cancel": ["job"]}


FLAG = (True, False, None)
GOOD = {"nodes": ("1,3", "all", "1-5", None), "node": (), "bus": (), "file": (), "image": (None,), "value": (), "object": (),
        "amplitude": (None,), "wait": (None,), "serials": (None,), "job": (), "question": (), "word": ()}


def test_words_of_a_malicious_page_begin_nothing():
    with page() as (table, bus):
        image = make_image(table, "0.2.0")
        (table.folder / "link.params").symlink_to("/etc/passwd")
        (table.folder / "loop.params").symlink_to("loop.params")
        (table.folder / "link.pimg").symlink_to("/etc/shadow")
        (table.folder / "out").symlink_to("/etc")
        (table.folder / "folder.params").mkdir()
        os.mkfifo(table.folder / "pipe.params")
        os.mkfifo(table.folder / "pipe.pimg")
        table.must("modules.look")
        good = {"read": {"node": 2}, "set": {"node": 2, "object": "0x6080", "value": "300"}, "save": {"file": "a.params"},
                "calibrate": {"node": 2}, "flash": {"image": image, "dry_run": True}, "recover": {"wait": 0, "dry_run": True},
                "answer": {"job": 1, "question": 1, "word": "J1"}}
        table.fresh("modules")
        assert table.document("modules")["settings"] == [], table.document("modules")
        assert [image["file"] for image in table.document("modules")["images"] if not image["file"].startswith("/")] == [image]
        begun = {}
        for name, arguments in ARGUMENTS.items():
            for argument in arguments:
                for value in HOSTILE:
                    if value in GOOD.get(argument, FLAG) and isinstance(value, (bool, str, type(None))):
                        continue
                    result = table.ask(f"modules.{name}", **{**good.get(name, {}), argument: value})
                    assert result["ok"] or "\n" not in result["error"] and 0 < len(result["error"]) < 1000, (name, argument, result)
                    assert result["ok"] or not re.search(r"[\x00-\x1f\x7f]", result["error"]), (name, argument, result)
                    if not result["ok"]:
                        continue
                    if "job" not in (result["value"] or {}):
                        begun.setdefault((name, argument), []).append((value, "answered"))
                        continue
                    if name in ("assign", "calibrate"):
                        table.ask("modules.cancel", job=result["value"]["job"])  # it may have ended
                    job = table.job()
                    assert job["status"] != 2, ("wrong words have begun a job", name, argument, value, job)
                    begun.setdefault((name, argument), []).append((value, job["status"], job["error"]))
                    for file in table.folder.glob("a.params"):
                        file.unlink()
        for key, values in begun.items():
            print("  ", key, str(values)[:1500])
        for name in ("modules.", "modules.nothing", "modules.Scan", "modules.scan ", "modules", "modules.open\0"):
            table.refused(name)
        all_without_power(bus)


def test_without_the_lease_nothing_is_changed():
    with page() as (table, bus):
        image = make_image(table, "0.2.0")
        other = Viewer(int(table.port), table.token, "other")
        lives_other = live(other)
        for name, arguments in {"open": {"bus": bus.address}, "close": {}, "set": {"node": 2, "object": "0x6080", "value": "300"},
                                "save": {"file": "a.params"}, "load": {"file": "a.params"}, "assign": {},
                                "calibrate": {"node": 1}, "flash": {"image": image}, "recover": {},
                                "answer": {"job": 1, "question": 1, "word": "J1"}, "cancel": {"job": 1}}.items():
            for epoch in (0, table.epoch - 1, table.epoch, table.epoch + 1):
                result = other.do(f"modules.{name}", epoch, **arguments)
                assert not result["ok"] and "\n" not in result["error"], (name, epoch, result)
        for name, arguments in {"look": {}, "scan": {}, "read": {"node": 1}, "compare": {"file": "a.params"}}.items():
            result = other.do(f"modules.{name}", 0, **arguments)
            assert result["ok"] or name == "compare" and "list" in result["error"] or "goes on" in result["error"], result
            table.job()
        assert table.document("modules")["bus"] == bus.address
        lives_other.clear()
        other.sock.close()


# 8. Two viewers

@slow
def test_another_viewer_takes_over_an_assign():
    with page("--shuffle", "5") as (table, bus):
        number = begin_assign(table, bus)
        other = Viewer(int(table.port), table.token, "other")
        lives_other = live(other)
        other.until(lambda: (other.documents.get("module_job", {}).get("value") or {}).get("question"))
        job = other.documents["module_job"]["value"]
        assert job == table.fresh("module_job"), (job, table.document("module_job"))
        assert job["by"] == "viewer", job
        assert not other.do("modules.answer", 0, job=number, question=job["question"]["number"], word="J1")["ok"]
        epoch = other.take_control()
        answered = other.do("modules.answer", epoch, job=number, question=job["question"]["number"], word="none")
        assert answered["ok"], answered
        assert not table.ask("modules.cancel", job=number)["ok"], "control is with the other one"
        other.until(lambda: (question := other.documents["module_job"]["value"]["question"]) and
                    question["number"] > job["question"]["number"])
        assert other.documents["module_job"]["value"]["state"] == "running", other.documents["module_job"]
        assert other.do("modules.cancel", epoch, job=number)["ok"]
        other.until(lambda: other.documents["module_job"]["value"]["state"] == "ended")
        assert other.documents["module_job"]["value"]["ended_by"] == "other", other.documents["module_job"]
        assert not other.do("modules.cancel", epoch, job=number)["ok"]
        all_without_power(bus)
        lives_other.clear()
        other.sock.close()


# 9. Many modules

@slow
def test_sixty_modules():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copytree(SOURCE / "sim/scenarios/long_chain", folder, dirs_exist_ok=True)
        shutil.copytree(SOURCE / "sim/scenarios/travelling_wave", folder.parent / "travelling_wave", dirs_exist_ok=True)
        scenario = folder / "sixty.simulation.xml"
        scenario.rename(folder / "uniform.simulation.xml")
        with Bus("--shuffle", "4", "--fresh", "7,9", scenario=folder / "uniform.simulation.xml") as bus, Table(folder) as table:
            table.must("modules.open", bus=bus.address)
            begin = time.monotonic()
            scan = table.do("modules.scan")
            count = len(scan["result"]["nodes"])
            print(f"   scan of {count} modules: {time.monotonic() - begin:.1f} s")
            wait_until(lambda: len(modules := table.fresh("bus")["modules"]) == count and
                       all(module["contacts"] is not None for module in modules), lambda: table.document("bus"))
            documents, loads, begin = 0, [], time.monotonic()
            while time.monotonic() < begin + 5:
                if table.viewer.next().get("name") == "bus":
                    documents += 1
                    loads.append(table.document("bus")["load"])
            print(f"   bus: {documents / 5:.1f} documents a second, load {min(loads):.3f} to {max(loads):.3f}, "
                  f"{len(json.dumps(table.document('bus')))} bytes each")
            assert 0 < max(loads) < 0.9, loads
            begin = time.monotonic()
            end = assign_all(table, bus, range(60))
            print(f"   assign of all: {time.monotonic() - begin:.0f} s")
            assert end["status"] == 0, end
            found = wait_until(lambda: (found := table.fresh("modules")["found"]) and len(found["nodes"]) == 60 and found)
            assert not found["fresh_modules"]


# 10. How long a flash takes

@slow
def test_how_long_a_flash_takes():
    took = {}
    for way in ("page", "shell", "page again", "shell again"):
        with page() as (table, bus):
            image = make_image(table, "0.4.0", program(4, 80_000))
            begin = time.monotonic()
            if way.startswith("page"):
                result = table.do("modules.flash", image=image)["result"]
            else:
                table.must("modules.close")
                done = subprocess.run([PROGRAMS / "proleg", "flash", table.folder / image, "--bus", bus.address, "--json"],
                                      capture_output=True, text=True, timeout=LONGEST)
                result = json.loads(done.stdout)
            assert all(module["good"] for module in result["modules"]), result
            took[way] = time.monotonic() - begin
            print(f"   {way}: {took[way]:.2f} s; transfer {result['transfer_s']:.2f} s, installation "
                  f"{result['installation_s']:.2f} s, restart {result['restart_s']:.2f} s")
    print(f"   the page takes {took['page'] / took['shell']:.2f} and {took['page again'] / took['shell again']:.2f} times as long")


def main():
    faulthandler.register(signal.SIGUSR1)
    wanted = sys.argv[3]
    tests = {name: test for name, test in globals().items() if name.startswith("test_")}
    for name, test in tests.items():
        if wanted == "fast" and name in SLOW or wanted == "slow" and name not in SLOW:
            continue
        if wanted not in ("fast", "slow") and wanted not in name:
            continue
        begin = time.monotonic()
        print(name, flush=True)
        test()
        print(f"   {time.monotonic() - begin:.1f} s", flush=True)


if __name__ == "__main__":
    main()

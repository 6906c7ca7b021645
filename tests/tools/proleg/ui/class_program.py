"""`proleg ui --class` for tests: a class, its teacher, and learners with connections of their own.

The programs that import it have the arguments SOURCE PROGRAMS."""

import json
import os
import re
import shutil
import signal
import ssl
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
SOURCE, PROGRAMS = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
sys.path[:0] = [str(SOURCE / part) for part in ("tests/host/server", "tests/support")]
import web_client  # noqa: E402
from processes import children, folder_of, runs  # noqa: E402
from served_page import make_certificate  # noqa: E402
from waiting import LONGEST, wait_until  # noqa: E402
from web_client import Closed, Viewer, live, request  # noqa: E402

SCENARIO = SOURCE / "sim/scenarios/travelling_wave/uniform.simulation.xml"
TITLES = {"class.html": "<!doctype html><title>class</title>", "index.html": "<!doctype html><title>robot</title>"}


class Learner:
    """What a browser of a learner knows after it has joined."""

    def __init__(self, program, answer):
        self.program = program
        self.seat, self.name, self.path, self.token, self.key = (answer[word] for word in ("seat", "name", "path", "token", "key"))

    def viewer(self, wants_control=True, look=False, token=None, **options):
        """An open connection to the robot. token: another one than that of the seat."""
        return Viewer(self.program.port, token or self.token, "Teacher" if look else self.name,
                      path=f"{self.path}socket{'?look' if look else ''}", wants_control=wants_control and not look, **options)

    def page(self, **options):
        """As a page, it tries again as long as the program of the seat starts."""
        def attempt():
            try:
                return SeatPage(self, **options)
            except AssertionError as refused:
                assert b" 503 " in refused.args[0], refused
                return None
            except Closed as closed:
                assert closed.code in (None, 1001), closed  # the program before has ended
                return None
        return wait_until(attempt, f"the robot of {self.name} does not start")


class SeatPage:
    """The page of a seat that drives, as that of a learner does after it was loaded."""

    def __init__(self, learner, **options):
        self.learner = learner
        self.viewer = learner.viewer(**options)
        self.viewer.until(lambda: {"control", "session", "parameters", "seat", "handed_out"} <= set(self.viewer.documents))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.viewer.sock.close()

    @property
    def epoch(self):
        return self.viewer.control()["epoch"]

    @property
    def drives(self):
        holder = self.viewer.control()["holder"]
        return holder is not None and holder["client"] == self.viewer.welcome["client"]

    def document(self, name):
        return self.viewer.documents[name]["value"]

    def ask(self, name, /, **arguments):
        return self.viewer.do(name, self.epoch, **arguments)

    def must(self, name, /, **arguments):
        result = self.ask(name, **arguments)
        assert result["ok"], (name, arguments, result)
        return result.get("value")

    def refused(self, name, /, **arguments):
        result = self.ask(name, **arguments)
        assert not result["ok"], (name, arguments, result)
        assert "\n" not in result["error"] and result["error"], result
        return result["error"]

    def until_state(self, state):
        self.viewer.until(lambda: self.document("session")["state"] == state)

    def amplitudes(self):
        """As they are wanted, in the unit of the scenario's format."""
        return next(entry for entry in self.document("parameters") if entry["name"] == "amplitude")["wanted"]

    def record(self, name):
        """A finished recording."""
        self.must("record", file=name)
        self.must("step", ticks=20) if self.document("session")["state"] == "paused" else None
        self.must("record", file=None)


class Teacher:
    """A connection of the teacher's page."""

    def __init__(self, program):
        self.viewer = Viewer(program.port, program.token, "Teacher")
        self.viewer.until(lambda: "class" in self.viewer.documents)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.viewer.sock.close()

    @property
    def document(self):
        return self.viewer.documents["class"]["value"]

    def entry(self, seat):
        entries = [self.document["teacher"], *self.document["learners"]]
        return next((entry for entry in entries if entry["seat"] == seat), None)

    def until_seat(self, learner, holds):
        """Until the entry of a learner is as it is waited for."""
        self.until(lambda: (entry := self.entry(learner.seat)) is not None and holds(entry))

    def ask(self, name, /, **arguments):
        return self.viewer.do(f"class.{name}", **arguments)

    def must(self, name, /, **arguments):
        result = self.ask(name, **arguments)
        assert result["ok"], (name, arguments, result)
        return result.get("value")

    def refused(self, name, /, **arguments):
        result = self.ask(name, **arguments)
        assert not result["ok"], (name, arguments, result)
        assert "\n" not in result["error"] and result["error"], result
        return result["error"]

    def until(self, holds):
        self.viewer.until(holds)

    def stop(self):
        count = len(self.viewer.stops)
        self.viewer.send({"type": "stop"})
        self.viewer.until(lambda: len(self.viewer.stops) > count)
        return self.viewer.stops[-1]

    def must_stop(self, confirmed, of):
        """STOP, until so many have confirmed it in the half second that the answer waits for them."""
        return wait_until(lambda: (stopped := self.stop()) and (stopped["confirmed"], stopped["of"]) == (confirmed, of) and stopped,
                          lambda: self.viewer.stops[-1])


class ClassProgram:
    """`proleg ui --class` in a folder, until the end of a test."""

    def __init__(self, folder, learners=6, options=(), scenario=SCENARIO, port=0):
        self.folder = folder / "class"
        self.learners = learners
        page = folder / "page"
        page.mkdir(exist_ok=True)
        for name, text in TITLES.items():
            (page / name).write_text(text)
        start = [scenario, "--recordings", self.folder] if scenario else [self.folder]
        if not scenario:
            self.folder.mkdir(exist_ok=True)
        self.command = [PROGRAMS / "proleg", "ui", "--class", str(learners), *start, "--page", page, "--no-browser", *options]
        self.errors = open(folder / "errors.txt", "a")
        self.environment = {**os.environ, "XDG_STATE_HOME": str(folder / "state"), "XDG_RUNTIME_DIR": str(folder)}
        self.process = None
        self.start(port)

    def start(self, port=0):
        self.process = subprocess.Popen([*self.command, "--port", str(port)], stdout=subprocess.PIPE, stderr=self.errors,
                                        text=True, env=self.environment)
        first = self.process.stdout.readline()
        found = re.search(r":(\d+)/#(\S+)", first)
        assert found, (first, self.process.wait(), (self.folder.parent / "errors.txt").read_text())
        self.port, self.token = int(found.group(1)), found.group(2)
        self.code = re.search(r"code (\d{6})$", self.process.stdout.readline().strip()).group(1)
        assert self.process.stdout.readline().startswith("folder: ")
        self.process.stdout.readline()

    def end(self, with_signal=signal.SIGINT):
        """Ends it, and waits until its programs have ended, too. Returns its exit status."""
        seats = self.seats()
        self.process.send_signal(with_signal)
        status = self.process.wait(timeout=LONGEST)
        wait_until(lambda: not any(runs(process) for process in seats), lambda: f"programs of seats that run: {seats}")
        return status

    def seats(self):
        """The processes of the seats; the program itself may be a child of `proleg`."""
        found = {}
        for process, words in children(self.process.pid).items():
            found |= {process: words} if "--seat" in words else {
                child: its for child, its in children(process).items() if "--seat" in its}
        return found

    def seat_process(self, folder):
        """The process that runs in the folder of a learner."""
        wanted = (self.folder / folder).resolve()
        return next((process for process in self.seats() if folder_of(process) == wanted), None)

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        seats = self.seats()
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
            try:
                self.process.wait(timeout=60)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
                raise
        for process in seats:  # those that a test has left stopped
            try:
                if runs(process) and kind is not None:
                    os.kill(process, signal.SIGKILL)
            except ProcessLookupError:
                pass
        self.errors.close()

    def post(self, path, body=b"", fields=(), source=None):
        first, header, content = request(self.port, "POST", path, fields, body=body, source=source)
        return int(first.split()[1]), header, content

    def ask_to_join(self, name, code=None, key=None, source=None):
        """Status and answer."""
        wish = {"name": name, "code": self.code if code is None else code, **({} if key is None else {"key": key})}
        status, header, content = self.post("/join", json.dumps(wish).encode(), source=source)
        if status != 413:
            assert header["content-type"] == "application/json", header
        return status, json.loads(content)

    def join(self, name, code=None, key=None, source=None):
        status, answer = self.ask_to_join(name, code, key, source)
        assert status == 200, (name, status, answer)
        return Learner(self, answer)

    def not_joined(self, expected, name, code=None, key=None, source=None):
        status, answer = self.ask_to_join(name, code, key, source)
        assert status == expected, (name, status, answer)
        assert set(answer) == {"error"} and answer["error"] and "\n" not in answer["error"], answer
        return answer["error"]

    def status(self, path, method="GET", fields=()):
        return int(request(self.port, method, path, fields)[0].split()[1])

    def body(self, path):
        first, _, content = request(self.port, "GET", path)
        assert first.split()[1] == "200", (path, first)
        return content.decode()

    def teacher(self):
        return Teacher(self)

    def teachers_robot(self):
        with self.teacher() as teacher:
            teacher.until(lambda: teacher.document["teacher"]["state"] == "ready")
            return Learner(self, {**teacher.document["teacher"], "key": ""})


@contextmanager
def school():
    """A folder for a class."""
    with tempfile.TemporaryDirectory() as name:
        yield Path(name)


@contextmanager
def a_class(learners=6, options=(), **more):
    with school() as folder, ClassProgram(folder, learners, options, **more) as program:
        yield program


@contextmanager
def encrypted(folder):
    """The options of a class whose connections are encrypted, as all connections of tests are inside."""
    certificate = folder / "page.pem"
    make_certificate(str(certificate), "DNS:localhost,IP:127.0.0.1")
    web_client.TLS = ssl.create_default_context(cafile=certificate)
    web_client.TLS.sslsocket_class = web_client.EncryptedSocket
    try:
        yield "--lan", "--certificate", str(certificate)
    finally:
        web_client.TLS = None


def run_tests(tests, wanted=""):
    for name, test in tests.items():
        if name.startswith("test_") and wanted in name:
            begin = time.monotonic()
            print(name, flush=True)
            test()
            print(f"   {time.monotonic() - begin:.1f} s", flush=True)


def copy_of_scenario(folder):
    """The scenario with its files, in a new folder."""
    shutil.copytree(SCENARIO.parent, folder)
    return folder / SCENARIO.name


__all__ = ["Closed", "SOURCE", "PROGRAMS", "SCENARIO", "LONGEST", "TITLES", "wait_until", "children", "runs", "Learner",
           "SeatPage", "Teacher", "ClassProgram", "school", "a_class", "encrypted", "live", "run_tests", "copy_of_scenario"]

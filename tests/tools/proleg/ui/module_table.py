"""Modules on a table for tests: `proleg bus` in the place of a robot, and a page of `proleg ui` whose person has them before them.

The programs that import it have the arguments SOURCE PROGRAMS."""

import re
import signal
import subprocess
import sys
from pathlib import Path

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
SOURCE, PROGRAMS = Path(sys.argv[1]), Path(sys.argv[2])
sys.path[:0] = [str(SOURCE / part) for part in ("tests/host/server", "tests/support")]
from ui_program import UiProgram  # noqa: E402
from waiting import LONGEST, wait_until  # noqa: E402
from web_client import live  # noqa: E402

SCENARIO = SOURCE / "sim/scenarios/travelling_wave/uniform.simulation.xml"


class Bus:
    """'proleg bus', until the end of a test."""

    def __init__(self, *options, scenario=SCENARIO):
        self.process = subprocess.Popen([PROGRAMS / "proleg-bus", scenario, "--tcp", "0", "--verbose", *options],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.address = re.search(r"--bus (tcp:\S+)", self.process.stdout.readline()).group(1)

    def joint_with_power(self):
        """The joint whose servo gets power next."""
        while line := self.process.stderr.readline():
            if found := re.match(r"proleg bus: (\S+) has power", line):
                return found.group(1)
        raise AssertionError("proleg bus has ended")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGINT)
        self.process.communicate(timeout=LONGEST)


class Table(UiProgram):
    """The page of a person with modules. While it lives, it says so twice a second, as a page does."""

    def __init__(self, folder, options=("--paused",)):
        super().__init__(PROGRAMS, folder, options)
        self.must("modules.look")

    def load_page(self):
        super().load_page()
        self.lives = live(self.viewer)

    def document(self, name):
        self.viewer.until(lambda: name in self.viewer.documents)
        return self.viewer.documents[name]["value"]

    def fresh(self, name):
        """A document as it is now: an operation was answered after it."""
        self.must("draft.refresh")
        return self.document(name)

    def job(self, is_so=lambda job: job["state"] == "ended"):
        """The job, when it is as it is waited for."""
        return wait_until(lambda: (job := self.fresh("module_job")) and is_so(job) and job,
                          lambda: self.document("module_job"))

    def do(self, name, /, **arguments):
        """Begins a job, and returns it at its end."""
        number = self.must(name, **arguments)["job"]
        return self.job(lambda job: job["number"] == number and job["state"] == "ended")

    def question(self, after=0):
        job = self.job(lambda job: job["state"] == "ended" or (job["question"] and job["question"]["number"] > after))
        assert job["state"] != "ended", job
        return job["question"]

    def answer(self, question, word):
        self.must("modules.answer", job=self.document("module_job")["number"], question=question["number"], word=word)

    def refused(self, name, /, **arguments):
        result = self.ask(name, **arguments)
        assert not result["ok"], (name, arguments, result)
        assert "\n" not in result["error"], result
        return result["error"]


def proleg(*words):
    done = subprocess.run([PROGRAMS / "proleg", *map(str, words)], capture_output=True, text=True, timeout=LONGEST)
    return done.stdout

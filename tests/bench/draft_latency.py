#!/usr/bin/env python3
"""Prints how fast a draft answers while an object is dragged, a slider is moved, or a joint comes and goes: from the
operation to the answer, to the new robot and world (the document `draft`), and to the path of the next half minute (the
document `foresight`): its first seconds, and the whole; in milliseconds. And how many paths come in a second of a drag
with 60 changes a second.

usage: tests/bench/draft_latency.py BUILD_FOLDER [STEPS], e.g. tests/bench/draft_latency.py build/host
"""

import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/host/server"))
from web_client import Viewer  # noqa: E402


class Draft:
    """The draft of a program, and how soon it answers."""

    def __init__(self, viewer):
        self.viewer = viewer
        self.epoch = viewer.take_control()
        viewer.until(lambda: self.revision("draft") == 0 and self.revision("foresight") == 0)

    def revision(self, name):
        return self.viewer.documents[name]["value"]["revision"] if name in self.viewer.documents else -1

    def start(self, name, arguments):
        layout = self.viewer.documents["draft"]["value"]["layout"]
        return self.viewer.start(name, self.epoch, layout=layout, **arguments)

    def measure(self, name, arguments):
        """Milliseconds from an operation to its answer, to the new draft, to the start of the new path and to the whole."""
        revision = self.revision("draft") + 1
        begin = time.monotonic()
        number = self.start(name, arguments)
        came = {}

        def all_came():
            now = 1000 * (time.monotonic() - begin)
            if number in self.viewer.results:
                assert self.viewer.results[number]["ok"], self.viewer.results[number]
                came.setdefault("answer", now)
            if self.revision("draft") >= revision:
                came.setdefault("draft", now)
            if self.revision("foresight") >= revision:
                came.setdefault("start", now)
                if self.viewer.documents["foresight"]["value"]["is_complete"]:
                    came.setdefault("whole", now)
            return len(came) == 4

        self.viewer.until(all_came)
        return [came[what] for what in ("answer", "draft", "start", "whole")]

    def paths_while_dragging(self, of_step, seconds):
        """How many paths came, and how many of them were whole, in a second."""
        changes_a_second = 60
        came = set()
        begin = time.monotonic()

        def note_path():
            path = self.viewer.documents["foresight"]["value"]
            came.add((path["revision"], path["is_complete"]))
            return time.monotonic() - begin >= next_change

        for step in range(seconds * changes_a_second):
            next_change = (step + 1) / changes_a_second
            name, arguments = of_step(step)
            self.viewer.start(name, self.epoch, layout=self.viewer.documents['draft']['value']['layout'], **arguments)
            self.viewer.until(note_path)
        return len(came) / seconds, sum(is_whole for _, is_whole in came) / seconds


def drag_of_box(step):
    return "world.place", {"object": 1, "pose": [0.9 + (step + 1) / 1000, 0.7, 0.01, 1, 0, 0, 0], "gesture": 7}


def slider(step):
    return "behaviour.set", {"module": 0, "parameter": "frequency", "joints": [0, 1, 2, 3, 4], "value": str(0.5 + step / 500), "gesture": 8}


def joint_more_or_less(step):
    return ("robot.duplicate" if step % 2 == 0 else "robot.remove"), {"joint": 2}


SERIES = {"a drag of a box": drag_of_box, "a slider of the gait": slider, "a joint more or less": joint_more_or_less}


def main():
    if not 2 <= len(sys.argv) <= 3:
        sys.exit(__doc__)
    steps = int(sys.argv[2]) if len(sys.argv) > 2 else 200
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(ROOT / "sim/scenarios/travelling_wave", folder, dirs_exist_ok=True)
        command = [Path(sys.argv[1]) / "bin/proleg-ui", f"{folder}/uniform.simulation.xml", "--no-browser", "--recordings", folder]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as program:
            try:
                port, token = re.search(r":(\d+)/#(\S+)", program.stdout.readline()).groups()
                with Viewer(int(port), token) as viewer:
                    draft = Draft(viewer)
                    draft.measure("world.add", {"item": "box", "values": {"height": 0.02}, "position": [0.9, 0.7, 0], "turn": 0})
                    times = {what: [draft.measure(*of_step(i)) for i in range(steps)] for what, of_step in SERIES.items()}
                    paths, whole = draft.paths_while_dragging(drag_of_box, 5)
            finally:
                program.terminate()
    print("five joints, a floor and a box, beside a simulation in real time; ms")
    for what, rows in times.items():
        print(f"{steps} steps: {what}")
        for i, name in enumerate(("answer", "draft", "first 10 s", "whole path")):
            values = sorted(row[i] for row in rows)
            print(f"  {name:<10} median {statistics.median(values):7.1f}   99 % {values[int(0.99 * len(values))]:7.1f}   most {values[-1]:7.1f}")
    print(f"a drag of a box, 60 changes a second: {paths:.0f} paths a second, {whole:.0f} of them whole")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Prints how fast a draft answers while an object is dragged: from the operation to the answer, to the new robot and world
(the document `draft`), and to the path of the next half minute (the document `foresight`); in milliseconds.

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


def drag(viewer, epoch, steps):
    """Milliseconds of each step to the answer, the draft and the foresight."""
    def revision(name):
        return viewer.documents[name]["value"]["revision"] if name in viewer.documents else -1

    def change(name, **arguments):
        return viewer.start(name, epoch, layout=viewer.documents["draft"]["value"]["layout"], **arguments)

    viewer.until(lambda: revision("draft") == 0 and revision("foresight") == 0)
    change("world.add", item="box", values={"height": 0.02}, position=[0.9, 0.7, 0], turn=0)
    viewer.until(lambda: revision("draft") == 1 and revision("foresight") == 1)
    times = []
    for step in range(steps):
        begin = time.monotonic()
        number = change("world.place", object=1, pose=[0.9 + (step + 1) / 1000, 0.7, 0.01, 1, 0, 0, 0], gesture=7)
        came = {}

        def all_came():
            now = 1000 * (time.monotonic() - begin)
            if number in viewer.results:
                assert viewer.results[number]["ok"], viewer.results[number]
                came.setdefault("answer", now)
            for name in ("draft", "foresight"):
                if revision(name) >= step + 2:
                    came.setdefault(name, now)
            return len(came) == 3

        viewer.until(all_came)
        times.append((came["answer"], came["draft"], came["foresight"]))
    return times


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
                    times = drag(viewer, viewer.take_control(), steps)
            finally:
                program.terminate()
    print(f"{steps} steps of a drag, five joints, a floor and a box, beside a simulation in real time; ms")
    for i, name in enumerate(("answer", "draft", "foresight")):
        values = sorted(row[i] for row in times)
        print(f"{name:<10} median {statistics.median(values):7.1f}   99 % {values[int(0.99 * len(values))]:7.1f}   most {values[-1]:7.1f}")


if __name__ == "__main__":
    main()

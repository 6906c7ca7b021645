#!/usr/bin/env python3
"""Prints what `proleg ui` reads from a scenario, as one JSON object: the documents `draft` and `draft_robot`, with every
joint, link, sensor, module, value, object and shape of it.

usage: scenario_contents.py PROGRAM SCENARIO, e.g. scenario_contents.py build/host/bin/proleg mine.simulation.xml
"""

import json
import re
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "server"))
from web_client import Viewer  # noqa: E402


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    command = [sys.argv[1], "ui", sys.argv[2], "--paused", "--no-browser", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as program:
        try:
            port, token = re.search(r":(\d+)/#(\S+)", program.stdout.readline()).groups()
            with Viewer(int(port), token) as viewer:
                names = ("draft", "draft_robot", "draft_meshes")
                viewer.until(lambda: all(name in viewer.documents for name in names))
                print(json.dumps({name: viewer.documents[name]["value"] for name in names}))
        finally:
            program.terminate()


if __name__ == "__main__":
    main()

"""Runs every command of docs/tutorial.md in a new folder, and compares what it prints with the lines on the page.

A line of the page must occur in the output of the commands above it. Numbers may differ by 30 %: the physics gives other digits on other processors, and a robot on a step takes another way then.

usage: tutorial_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

TOLERANCE = 0.3


def blocks(page):
    """The page's blocks in their order: (language, text)."""
    return re.findall(r"^```(sh|text)\n(.*?)^```$", page, flags=re.MULTILINE | re.DOTALL)


def as_number(word):
    try:
        return float(word)
    except ValueError:
        return None


def same(expected, found):
    expected, found = expected.rstrip(",;:"), found.rstrip(",;:")
    a, b = as_number(expected), as_number(found)
    if a is None or b is None:
        return expected == found
    return abs(a - b) <= TOLERANCE * max(abs(a), abs(b))


def occurs(line, output):
    """Whether the words of the line are the first words of a line of the output, or words in its middle."""
    wanted = line.split()
    for candidate in output.splitlines():
        words = candidate.split()
        for first in range(len(words) - len(wanted) + 1):
            if all(map(same, wanted, words[first:])):
                return True
    return False


def main():
    source, programs = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    page = (source / "docs/tutorial.md").read_text()
    environment = dict(os.environ, PATH=f"{programs}:{os.environ['PATH']}")
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "sim").symlink_to(source / "sim")
        output = ""
        for language, text in blocks(page):
            if language == "sh":
                run = subprocess.run(["bash", "-ec", text], cwd=folder, env=environment, capture_output=True, text=True)
                output = run.stdout
                if run.returncode != 0:
                    print(f"status {run.returncode}:\n{text}\n{run.stdout}\n{run.stderr}")
                    failures += 1
                continue
            for line in text.splitlines():
                if not occurs(line, output):
                    print(f"not printed: {line}\nprinted:\n{output}")
                    failures += 1
    if occurs("no such line", output) or len(blocks(page)) < 10:
        print("the test compares nothing")
        failures += 1
    return 1 if failures else 0


sys.exit(main())

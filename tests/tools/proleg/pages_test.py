"""Runs the commands of the README and the first steps, and of the tutorial, in their order, each in a new folder.

They find the programs that the target 'programs' builds and no others, as after tools/demo. Every command must succeed. Lines that the
tutorial says a command prints must occur in the output of the commands above it. Numbers may differ by 30 %: the physics gives other digits
on other processors, and a robot on a step takes another way then.

usage: pages_test.py SOURCE_FOLDER PROGRAM_FOLDER PROGRAM...
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOLERANCE = 0.3


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


# What is other in a test than for a reader: a pattern in a command, and its replacement.
IN_THE_TEST = (
    # The page stays open until it is closed. Its own tests are in tests/host/page.
    (r"^(?:build/host/bin/)?proleg ui\b.*", "proleg ui --help >/dev/null"),
    # The searches of a reader take minutes.
    (r"^proleg optimise .*?(?= *(?:#|$))", r"\g<0> --evaluations 60"),
    (r"^proleg experiment .*?(?= *(?:#|$))", r"\g<0> --evaluations 40"),
    # The reader starts the next command later.
    (r"^(proleg bus .* --tcp) 20000 &", r"\1 20000 & for _ in {1..600}; do (: </dev/tcp/127.0.0.1/20000) 2>/dev/null && break; sleep 0.1; done"),
    # The reader sees which joint moves.
    (r"^proleg assign .*", r"printf 'J5\\nJ4\\nJ3\\nJ2\\nJ1\\n' | \g<0>"),
    # tools/check has built the image.
    (r"^cmake .*", "true"),
)


def commands_of(page):
    """The commands of the page's indented blocks, without the two that build and check, and without files that it shows."""
    blocks = re.findall(r"(?:^    .*\n)+", page, flags=re.MULTILINE)
    commands = []
    for block in blocks:
        lines = re.sub(r"\\\n *", "", block.replace("\n    ", "\n")).strip().splitlines()
        if lines[0].startswith("<"):
            continue
        commands += [line for line in lines if not line.startswith(("tools/demo", "tools/check"))]
    return commands


# Subcommands that are in the program of another one.
PROGRAM_OF = {"adapt": "optimise", "atlas": "optimise", "learn-selector": "optimise"}


class PagesTest(unittest.TestCase):
    source = Path()
    programs = Path()
    names = []

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name) / "clone"
        installed = self.folder / "build/host/bin"
        installed.mkdir(parents=True)
        for name in self.names:
            shutil.copy(self.programs / name, installed / name)  # `proleg` finds the others beside its own file
        (self.folder / "sim").symlink_to(self.source / "sim")
        for built in ("stm32f405", "page", "player"):
            (self.folder / "build" / built).symlink_to(self.source / "build" / built)
        self.environment = dict(os.environ, PATH=f"{installed}:{os.environ['PATH']}")

    def run_script(self, script):
        """Runs all of it in one shell, and ends what it has left in the background."""
        with tempfile.TemporaryFile("w+") as output:
            process = subprocess.Popen(["bash", "-ec", script], cwd=self.folder, env=self.environment, stdout=output,
                                       stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, start_new_session=True)
            try:
                status = process.wait()
            finally:
                try:
                    os.killpg(process.pid, signal.SIGTERM)
                except ProcessLookupError:
                    pass
            output.seek(0)
            return status, output.read()

    def test_every_subcommand_is_among_the_programs(self):
        listed = subprocess.run([self.programs / "proleg", "--help"], stdout=subprocess.PIPE, text=True, check=True).stdout
        subcommands = re.findall(r"^  ([a-z]+) ", listed, flags=re.MULTILINE)
        self.assertGreater(len(subcommands), 20)
        self.assertEqual(sorted({"proleg"} | {f"proleg-{PROGRAM_OF.get(name, name)}" for name in subcommands}),
                         sorted(name for name in self.names if not name.endswith("-mpi")))

    def test_the_commands_of_the_readme_and_the_first_steps(self):
        commands = [command for page in ("README.md", "docs/first-steps.md") for command in commands_of((self.source / page).read_text())]
        self.assertGreater(len(commands), 30)
        changed = []
        for pattern, replacement in IN_THE_TEST:
            before = list(commands)
            commands = [re.sub(pattern, replacement, command) for command in commands]
            changed.append(commands != before)
        self.assertTrue(all(changed), f"a pattern has no command: {list(zip(IN_THE_TEST, changed))}")
        status, output = self.run_script("set -x\n" + "\n".join(commands))
        self.assertEqual(status, 0, output[-4000:])

    def test_the_commands_of_the_tutorial_print_what_it_says(self):
        page = (self.source / "docs/tutorial.md").read_text()
        blocks = re.findall(r"^```(sh|text)\n(.*?)^```$", page, flags=re.MULTILINE | re.DOTALL)
        self.assertGreater(len(blocks), 10)
        output = ""
        for language, text in blocks:
            if language == "sh":
                status, output = self.run_script(text)
                self.assertEqual(status, 0, f"{text}\n{output}")
                continue
            for line in text.splitlines():
                self.assertTrue(occurs(line, output), f"not printed: {line}\nprinted:\n{output}")
        self.assertFalse(occurs("no such line", output), "the test compares nothing")


if __name__ == "__main__":
    PagesTest.source, PagesTest.programs = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    PagesTest.names = sys.argv[3:]
    del sys.argv[1:]
    unittest.main()

"""The manual pages and completions of the programs that are built have each option that --help lists, and no other.

usage: shell_files_test.py SOURCE_FOLDER PROGRAM_FOLDER [--shells]

With --shells: what man, mandoc, zsh and fish make of the files.
"""

import os
import pty
import re
import select
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

# The words of a command that have options of their own; the other commands have none.
ACTIONS = {"image": ["info", "make", "key", "sign", "verify"], "new": ["obstacle", "algorithm"]}


def output(*command, **options):
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=120, **options)
    return result.stdout


def options_of_help(text):
    """The names of the options that a help text lists."""
    return {name for names in re.findall(r"^  (-\S+)", text, flags=re.MULTILINE) for name in names.split(",")}


def options_of_pages(folder, place):
    """The names of the options that are described in the part of a page that is about a command or an action."""
    command, _, action = place.partition(" ")
    text = (folder / f"share/man/man1/proleg-{command}.1").read_text().replace("\\-", "-")
    parts = re.split(r"^\.SH PROLEG (.*)$", text, flags=re.MULTILINE)
    part = dict(zip(parts[1::2], parts[2::2]))[place.upper()] if action else parts[0]
    heads = re.findall(r"^\.TP\n(\\fB-.*)$", part, flags=re.MULTILINE)
    return {name for head in heads for name in re.findall(r"\\fB(-[^\\]+)\\fR", head)}


def options_of_bash(folder, place):
    script = ('source "$1"; shift; COMP_WORDS=(proleg "$@" -); COMP_CWORD=$(($# + 1)); _proleg; echo "${COMPREPLY[*]}"')
    return set(output("bash", "--norc", "-c", script, "bash", folder / "share/bash-completion/completions/proleg", *place.split()).split())


def options_of_zsh(text, place):
    block = re.search(rf"^    \('{re.escape(place)}'\)\n(.*?) ;;$", text, flags=re.MULTILINE | re.DOTALL).group(1)
    return set(re.findall(r"^ +'(?:\*|\([^)]*\))?(-[^=+\[]+)[=+]?\[", block, flags=re.MULTILINE))


def options_of_fish(text, place):
    names = set()
    for line in text.splitlines():
        if line.startswith(rf"complete -c proleg -n '__proleg_at \'{place}\''"):
            names |= {("--" if kind == "l" else "-") + name for kind, name in re.findall(r" -([slo]) '([^']+)'", line.partition(" -d ")[0])}
    return names


class Files(unittest.TestCase):
    source = Path()
    programs = Path()

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = Path(cls.temporary.name) / "first"
        cls.made = cls.make(cls.folder)
        cls.listed = re.findall(r"^  ([a-z]+) ", output(cls.programs / "proleg", "--help"), flags=re.MULTILINE)
        cls.places = [place for name in cls.listed for place in (name, *(f"{name} {action}" for action in ACTIONS.get(name, [])))]
        cls.help = {place: output(cls.programs / "proleg", *place.split(), "--help") for place in cls.places}

    @classmethod
    def make(cls, folder, **variables):
        environment = {name: value for name, value in os.environ.items() if name != "SOURCE_DATE_EPOCH"}
        return output(cls.source / "tools/docs", "--shell", folder, "--programs", cls.programs, env=environment | variables)

    def text(self, path):
        return (self.folder / path).read_text()


class Options(Files):
    def test_the_files_are_written_and_nothing_is_said(self):
        self.assertEqual(self.made, "")
        self.assertGreater(len(self.listed), 25)
        found = sorted(str(path.relative_to(self.folder)) for path in self.folder.rglob("*") if path.is_file())
        self.assertEqual(found, sorted([
            "share/bash-completion/completions/proleg", "share/zsh/vendor-completions/_proleg", "share/fish/vendor_completions.d/proleg.fish",
            "share/man/man1/proleg.1", *(f"share/man/man1/proleg-{name}.1" for name in self.listed)]))

    def test_each_has_the_options_of_the_help_texts_and_no_other(self):
        zsh, fish = self.text("share/zsh/vendor-completions/_proleg"), self.text("share/fish/vendor_completions.d/proleg.fish")
        for place in self.places:
            expected = options_of_help(self.help[place])
            self.assertLessEqual({"-h", "--help"}, expected, place)
            self.assertEqual(options_of_pages(self.folder, place), expected, f"manual page of {place}")
            self.assertEqual(options_of_bash(self.folder, place), expected, f"bash, {place}")
            self.assertEqual(options_of_zsh(zsh, place), expected, f"zsh, {place}")
            self.assertEqual(options_of_fish(fish, place), expected, f"fish, {place}")

    def test_an_option_that_is_missing_is_found(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for path in (path for path in self.folder.rglob("*") if path.is_file()):
                (folder / path.relative_to(self.folder)).parent.mkdir(parents=True, exist_ok=True)
                (folder / path.relative_to(self.folder)).write_text(path.read_text().replace("--next-key", "--other").replace(
                    r"\-\-next\-key", r"\-\-other").replace("-l 'next-key'", "-l 'other'"))
            wrong = options_of_help(self.help["image sign"]) - {"--next-key"} | {"--other"}
            self.assertEqual(options_of_pages(folder, "image sign"), wrong)
            self.assertEqual(options_of_bash(folder, "image sign"), wrong)
            self.assertEqual(options_of_zsh((folder / "share/zsh/vendor-completions/_proleg").read_text(), "image sign"), wrong)
            self.assertEqual(options_of_fish((folder / "share/fish/vendor_completions.d/proleg.fish").read_text(), "image sign"), wrong)

    def test_the_subcommands_are_listed(self):
        script = 'source "$1"; COMP_WORDS=(proleg ""); COMP_CWORD=1; _proleg; echo "${COMPREPLY[*]}"'
        found = output("bash", "--norc", "-c", script, "bash", self.folder / "share/bash-completion/completions/proleg").split()
        self.assertEqual(set(found), {"-h", "--help", "--version", *self.listed})
        heads = re.findall(r"^\.TP\n\\fB([a-z]+)\\fR$", self.text("share/man/man1/proleg.1"), flags=re.MULTILINE)
        self.assertEqual(heads, self.listed)
        for name in ("PROLEG_BUS", "PROLEG_PLUGINS"):
            self.assertIn(name, self.text("share/man/man1/proleg.1"))

    def test_the_same_programs_give_the_same_bytes(self):
        again = Path(self.temporary.name) / "again"
        self.make(again)
        self.assertEqual(output("diff", "-r", self.folder, again), "")
        dated = Path(self.temporary.name) / "dated"
        self.make(dated, SOURCE_DATE_EPOCH="86400")
        self.assertIn('.TH PROLEG 1 "1970-01-02" "Proleg ', (dated / "share/man/man1/proleg.1").read_text())

    def test_bad_input_is_refused_in_one_line(self):
        self.assertRegex(self.make(Path(self.temporary.name) / "bad", SOURCE_DATE_EPOCH="today"), r"\A[^\n]*found SOURCE_DATE_EPOCH='today'.*\n\Z")
        self.assertRegex(output(self.source / "tools/docs", "--shell"), r"\A[^\n]*--shell[^\n]*\n\Z")


class Terminal:
    """A shell on a terminal, whose line a tab completes. A line is read when its expected end is there."""

    def __init__(self, folder, *command):
        process, self.descriptor = pty.fork()
        if process == 0:
            os.chdir(folder)
            os.environ["TERM"] = "dumb"
            os.execvp(command[0], command)
        self.process = process

    def says(self, text, expected):
        """Whether the shell shows what is expected after a text is typed; a minute is the longest wait."""
        os.write(self.descriptor, text.encode())
        found, end = "", time.monotonic() + 60
        while expected not in found and time.monotonic() < end:
            if select.select([self.descriptor], [], [], 1)[0]:
                # Without bells and the colours and modes of a terminal.
                found += re.sub(r"\a|\x1b\[[0-9;?]*[A-Za-z]", "", os.read(self.descriptor, 65536).decode(errors="replace"))
        os.write(self.descriptor, b"\x15")  # Ctrl-U: an empty line again
        return expected in found

    def close(self):
        os.close(self.descriptor)
        os.waitpid(self.process, 0)


LINES = (("proleg si\t", "proleg simulate "), ("proleg image si\t", "proleg image sign "), ("proleg simulate my\t", "my\\ scenario.simulation.xml"),
         ("proleg simulate caterp\t", "caterpillar "), ("proleg simulate --secon\t", "--seconds"), ("proleg bus --modules m\t", "--modules mcu"),
         ("proleg simulate --engine=mu\t", "--engine=mujoco"), ("proleg nmt --bus can0 sto\t", "can0 stop"))


class Bash(Files):
    def test_bash_completes_a_line_on_a_terminal(self):
        self.check("bash", f"source {self.folder}/share/bash-completion/completions/proleg", "bash", "--norc", "-i")

    def check(self, name, setup, *command):
        work = Path(self.temporary.name) / f"work_{name}"
        work.mkdir()
        (work / "my scenario.simulation.xml").touch()
        terminal = Terminal(work, *command)
        self.addCleanup(terminal.close)
        self.assertTrue(terminal.says(f"PATH={self.programs}:$PATH; {setup}; echo rea''dy\n", "ready"))
        for line, expected in LINES:
            self.assertTrue(terminal.says(line, expected), f"{name}: {line!r}, expected {expected!r}")


class Shells(Files):
    def test_zsh_and_fish_read_their_files(self):
        self.assertEqual(output("zsh", "-n", self.folder / "share/zsh/vendor-completions/_proleg"), "")
        self.assertEqual(output("fish", "--no-config", "-n", self.folder / "share/fish/vendor_completions.d/proleg.fish"), "")

    def test_zsh_completes_a_line_on_a_terminal(self):
        Bash.check(self, "zsh", f"PS1=; fpath=({self.folder}/share/zsh/vendor-completions $fpath); autoload -U compinit; compinit -u -D",
                   "zsh", "-f", "-i")

    def test_fish_lists_the_options_of_the_help_texts_and_no_other(self):
        with tempfile.TemporaryDirectory() as folder:
            for place in self.places:
                words = {"-h"} if place else set()
                found = output("fish", "--no-config", "-c", f"source {self.folder}/share/fish/vendor_completions.d/proleg.fish; "
                               f"complete -C '{self.programs}/proleg {place} --'", cwd=folder, env=os.environ | {"HOME": folder})
                names = {line.split("\t")[0].rstrip("=") for line in found.splitlines()}
                self.assertEqual(names | words, options_of_help(self.help[place]), place)

    def test_fish_completes_words_and_names_of_files(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "my scenario.simulation.xml").touch()
            for line, expected in (("si", "simulate"), ("image si", "sign"), ("bus --modules m", "mcu"), ("nmt --bus can0 sto", "stop"),
                                   ("simulate caterp", "caterpillar"), ("simulate my", "my scenario.simulation.xml")):
                found = output("fish", "--no-config", "-c", f"source {self.folder}/share/fish/vendor_completions.d/proleg.fish; "
                               f"complete -C '{self.programs}/proleg {line}'", cwd=folder, env=os.environ | {"HOME": folder})
                self.assertEqual([line.split("\t")[0] for line in found.splitlines()], [expected], line)

    def test_man_and_mandoc_find_nothing_wrong(self):
        for page in sorted((self.folder / "share/man/man1").iterdir()):
            self.assertEqual(output("sh", "-c", 'man --warnings -E UTF-8 -l -Tutf8 -Z "$1" 2>&1 >/dev/null', "sh", page), "", page.name)
            remarks = [line for line in output("mandoc", "-T", "lint", "-W", "warning", page).splitlines() if "missing date" not in line]
            self.assertEqual(remarks, [], page.name)


if __name__ == "__main__":
    shells = "--shells" in sys.argv
    Files.source, Files.programs = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    del sys.argv[1:]
    unittest.main(defaultTest=["Shells"] if shells else ["Options", "Bash"])

"""Manual pages and completions of made-up help texts: odd options, quotes, strokes, dots and dollars.

usage: shell_parts_test.py SOURCE_FOLDER
"""

import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(sys.argv.pop(1)).resolve() if __name__ == "__main__" else Path()
sys.path.insert(0, str(SOURCE / "tools/docs.d"))
sys.dont_write_bytecode = True
import bash_completion  # noqa: E402
import fish_completion  # noqa: E402
import help_texts  # noqa: E402
import man_pages  # noqa: E402
import zsh_completion  # noqa: E402

LONG = "a meaning of many words that no terminal shows in one line, " * 6
HELP = rf"""Counts C:\new, 'quoted' and $HOME.
.begins with a dot: see 'proleg other'.
Usage: proleg count [OPTIONS] FILE [MODE]

Positionals:
  FILE TEXT REQUIRED          scenario: a *.simulation.xml file, or a name that 'proleg scenarios' lists
  MODE TEXT Excludes: --twice one of its words: up, down or side-ways

Options:
  -h,--help                   Print this help message and exit
  -n,--number,--count N=1 REQUIRED
                              how many; a second sentence follows
                              on another line
  --just-before-the-text FILE a long one of 27 characters: it's [a] "file" of $HOME\x: `id` $(id)
  --an-option-of-width NODE REQUIRED
                              a blank may be before the column of the meanings
  --dots TEXT ...             .begins with a dot
  --apostrophe                'begins with an apostrophe
  --engine TEXT               'ode', 'reduced' or 'mujoco': what computes. More.
  --modules TEXT=native       what runs it. native: this one; mcu: a chip; 1,3=mcu: some
  --degrees ANGLES            in °, -90 to 90
  --places MODULE=JOINT,...   {LONG}
"""
PLAIN = help_texts.command_of(("count",), "count", HELP.rstrip())
ENTRIES = {argument.names[-1] if argument.names else argument.value: argument for argument in PLAIN.options + PLAIN.positionals}
ACTION = """Adds.
Usage: proleg count add [OPTIONS]

Options:
  -h,--help                   Print this help message and exit
  --by N                      number"""
COMMAND = help_texts.command_of(("count",), "count 'things'", HELP.rstrip(), {"add": ACTION})


class HelpTexts(unittest.TestCase):
    def test_an_option_has_all_its_names_and_the_form_of_its_value(self):
        number = ENTRIES["--count"]
        self.assertEqual((number.names, number.value, number.default, number.required),
                         (["-n", "--number", "--count"], "N", "1", True))
        self.assertEqual(number.meaning, "how many; a second sentence follows on another line")
        self.assertEqual((ENTRIES["--places"].value, ENTRIES["--places"].default), ("MODULE=JOINT,...", ""))
        self.assertTrue(ENTRIES["--dots"].repeated)
        self.assertEqual(ENTRIES["--apostrophe"].value, "")

    def test_one_blank_before_the_column_of_the_meanings_ends_an_argument(self):
        self.assertTrue(ENTRIES["--just-before-the-text"].meaning.startswith("a long one"))
        self.assertEqual(ENTRIES["MODE"].meaning, "one of its words: up, down or side-ways")

    def test_a_blank_in_that_column_of_a_long_argument_does_not_end_it(self):
        self.assertEqual(ENTRIES["--an-option-of-width"].text, "--an-option-of-width NODE REQUIRED")
        self.assertEqual(ENTRIES["--an-option-of-width"].meaning, "a blank may be before the column of the meanings")

    def words(self, meaning):
        return help_texts.known_words(help_texts.Argument("--a TEXT", meaning))

    def test_words_are_known_where_the_text_lists_them_in_a_regular_form(self):
        self.assertEqual(help_texts.known_words(ENTRIES["--engine"]), ["ode", "reduced", "mujoco"])
        self.assertEqual(help_texts.known_words(ENTRIES["--modules"]), ["native", "mcu"])
        self.assertEqual(self.words("what to write: robot, project, obstacle or algorithm"), ["robot", "project", "obstacle", "algorithm"])
        self.assertEqual(self.words("kind: long (a chain; of cubes); short (one)"), ["long", "short"])

    def test_words_are_not_guessed(self):
        for meaning in ("great-deluge, genetic, cma-es, or another one", "3, 1,3 or 2-5, or all", "SEED: print it; or a file",
                        "TCP port; 0: any free one", "a file, or none", ""):
            self.assertEqual(self.words(meaning), [], meaning)

    def test_the_first_sentence_is_enough_for_a_list(self):
        self.assertEqual(help_texts.brief(ENTRIES["--engine"].meaning), "what computes")
        self.assertLess(len(help_texts.brief(LONG)), 95)


class ManPages(unittest.TestCase):
    page = man_pages.page_of_command(COMMAND, ["count", "other"], "Proleg 1.2", "")

    def test_no_line_of_text_is_a_request(self):
        requests = {line.split()[0] for line in self.page.splitlines() if line.startswith((".", "'"))}
        self.assertLessEqual(requests, {".TH", ".SH", ".SS", ".TP", ".PP", ".br", ".nh", ".ad"})
        self.assertIn("\n\\&.begins with a dot\n", self.page)
        self.assertIn("\n\\(aqbegins with an apostrophe\n", self.page)

    def test_characters_with_a_meaning_are_escaped(self):
        self.assertIn(r"Counts C:\enew, \(aqquoted\(aq and $HOME.", self.page)
        self.assertIn(r"\fB\-n\fR, \fB\-\-number\fR, \fB\-\-count\fR \fIN\fR (default: 1; required)", self.page)
        self.assertIn(r"in \[u00B0], \-90 to 90", self.page)
        self.assertTrue(self.page.isascii())

    def test_an_action_is_a_section_and_a_command_that_is_named_a_reference(self):
        self.assertIn("\n.SH PROLEG COUNT ADD\n", self.page)
        self.assertIn(r"\fBproleg\-other\fR(1)", self.page)

    def test_only_the_line_of_the_title_has_the_date(self):
        dated = man_pages.page_of_command(COMMAND, ["count"], "Proleg 1.2", "2020-01-02").splitlines()
        self.assertEqual([line for line in dated if "2020" in line], [dated[0]])


class Completions(unittest.TestCase):
    def in_bash(self, *words, command=COMMAND):
        """What bash suggests for the last word."""
        with tempfile.TemporaryDirectory() as folder:
            script = Path(folder) / "proleg"
            script.write_text(bash_completion.script([command]))
            Path(folder, "a b.simulation.xml").touch()
            Path(folder, "c.txt").touch()
            Path(folder, "d e").mkdir()
            # Standard error is part of it: a completion that prints an error disturbs the line.
            return subprocess.run(
                ["bash", "--norc", "-c", 'source ./proleg; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _proleg; printf "%s\\n" "${COMPREPLY[@]}"',
                 "bash", *words], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=True).stdout.split("\n")[:-1]

    def test_bash_knows_the_names_of_options(self):
        self.assertEqual(self.in_bash("proleg", "count", "--num"), ["--number"])
        self.assertEqual(self.in_bash("proleg", "count", "add", "--"), ["--help", "--by"])

    def test_bash_knows_words_after_a_blank_and_after_an_equals_sign(self):
        self.assertEqual(self.in_bash("proleg", "count", "--modules", ""), ["native", "mcu"])
        self.assertEqual(self.in_bash("proleg", "count", "--engine", "=", "r"), ["reduced"])
        self.assertEqual(self.in_bash("proleg", "count", "--engine", "="), ["ode", "reduced", "mujoco"])

    def test_bash_counts_arguments_without_options_and_their_values(self):
        for options in ([], ["-n", "2"], ["--number", "=", "2"], ["--apostrophe"]):
            self.assertEqual(self.in_bash("proleg", "count", *options, "file", "si"), ["side-ways"], options)

    def test_bash_keeps_blanks_in_names_of_files_and_is_silent_without_the_program(self):
        self.assertEqual(self.in_bash("no-such-program", "count", "a", command=PLAIN), ["a b.simulation.xml"])
        self.assertEqual(self.in_bash("no-such-program", "count", "a\\ b", command=PLAIN), ["a b.simulation.xml"])
        self.assertEqual(sorted(self.in_bash("no-such-program", "count", "", command=PLAIN)), ["a b.simulation.xml", "d e"])
        self.assertEqual(self.in_bash("proleg", "count", "--just-before-the-text", "c", command=PLAIN), ["c.txt"])

    def test_descriptions_are_text_for_zsh_and_fish(self):
        meaning = ENTRIES["--just-before-the-text"].meaning
        self.assertIn(r"""'--just-before-the-text=[a long one of 27 characters\: it'\''s \[a\] "file" of $HOME\\x\: `id` $(id)]:FILE:_files'""",
                      zsh_completion.script([COMMAND]))
        self.assertIn("-d '" + meaning.replace("\\", "\\\\").replace("'", "\\'") + "'", fish_completion.script([COMMAND]))

    def test_no_help_text_is_part_of_the_code_for_bash(self):
        self.assertIsNone(re.search(r"\$HOME\\|characters|Counts", bash_completion.script([COMMAND])))


if __name__ == "__main__":
    unittest.main()

"""The parts of tools/docs: links of the site, addresses of pages, manuals, interfaces.

usage: parts_test.py SOURCE_FOLDER
"""

import os
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

SOURCE = Path(sys.argv.pop(1)).resolve() if __name__ == "__main__" else Path()
sys.path.insert(0, str(SOURCE / "tools/docs.d"))
sys.dont_write_bytecode = True
import commands  # noqa: E402
import finish  # noqa: E402
import interfaces  # noqa: E402
import pages  # noqa: E402

HELP = """Counts.
'proleg count up --help' explains the action up.
Usage: proleg count [OPTIONS] ACTION

Positionals:
  ACTION REQUIRED             up: one more; down: one less, see docs/a.md

Options:
  -h,--help                   Print this help message and exit
  --start NUMBER|NAME=0       the first <number>
  --a-very-long-option FOLDER=somewhere
                              what it is
"""


class Site(unittest.TestCase):
    def found(self, body):
        with tempfile.TemporaryDirectory() as folder:
            site = Path(folder)
            (site / "b.html").write_text("<h1 id='here'>b</h1>")
            (site / "a.html").write_text(body)
            return list(finish.dead_links(site))

    def test_what_is_there_or_on_the_internet_is_not_found(self):
        self.assertEqual(self.found("<p id='c'><a href='b.html#here'><a href='#c'><a href='https://d.example'><img src='b.html'>"), [])

    def test_what_is_missing_or_loaded_from_elsewhere_is_found(self):
        for tag in ("<a href='c.html'>", "<img src='c.png'>", "<a href='b.html#there'>", "<a href='#c'>", "<script src='https://d.example/e.js'>",
                    "<link href='https://d.example/e.css'>", "<img src='//d.example/e.png'>"):
            self.assertEqual(len(self.found(tag)), 1, tag)


class Pages(unittest.TestCase):
    def test_addresses_become_those_of_the_site(self):
        self.assertEqual(pages.for_site(SOURCE, "README.md", "[a](docs/page.md#make) [b](CONTRIBUTING.md)"),
                         "[a](page.md#make) [b](contributing.md)")
        self.assertEqual(pages.for_site(SOURCE, "docs/page.md", "[a](../README.md) [b](README.md) [c](https://d.example/e.md)"),
                         "[a](index.md) [b](pages.md) [c](https://d.example/e.md)")

    def test_pictures_open_and_names_of_pages_are_links_but_not_in_code(self):
        self.assertEqual(pages.for_site(SOURCE, "docs/page.md", "![two\nwords](page.png)"), "[![two\nwords](page.png)](page.png)")
        self.assertEqual(pages.for_site(SOURCE, "docs/page.md", "a (docs/sweep.md, b), `c docs/sweep.md`, docs/none.md"),
                         "a ([Sweeps](sweep.md), b), `c docs/sweep.md`, docs/none.md")
        self.assertEqual(pages.for_site(SOURCE, "docs/page.md", "See `docs/sweep.md`.\n\n    `docs/sweep.md`\n\n# `docs/sweep.md`\n"),
                         "See [Sweeps](sweep.md).\n\n    `docs/sweep.md`\n\n# `docs/sweep.md`\n")


    def test_code_in_a_table_keeps_its_bars_without_strokes(self):
        self.assertEqual(pages.bars_in_tables("| `a\\|<b>` | `c` |\n`d\\|e`"), "| <code>a&#124;&lt;b&gt;</code> | `c` |\n`d\\|e`")


class Manuals(unittest.TestCase):
    def test_a_help_text_has_its_parts(self):
        about, usage, found = commands.sections(HELP)
        self.assertEqual(about, "Counts.\n'proleg count up --help' explains the action up.")
        self.assertEqual(usage, "proleg count [OPTIONS] ACTION")
        self.assertEqual(found[0], ("Positionals", [["ACTION REQUIRED", "up: one more; down: one less, see docs/a.md"]]))
        self.assertEqual(found[1][1][1:], [["--start NUMBER|NAME=0", "the first <number>"],
                                           ["--a-very-long-option FOLDER=somewhere", "what it is"]])

    def test_a_manual_keeps_every_character_and_links_pages(self):
        text = commands.manual(HELP, {"a.md": "# The page A\n"}, 2)
        self.assertIn("| `--start NUMBER\\|NAME=0` | the first &lt;number&gt; |", text)
        self.assertIn("see [The page A](../a.md) |", text)

    def test_words_with_a_help_of_their_own_are_found(self):
        with tempfile.TemporaryDirectory() as folder:
            program = Path(folder) / "proleg"
            program.write_text("#!/bin/sh\nif [ \"$2\" = up ]; then echo 'Usage: up'; else cat <<'END'\n" + HELP + "END\nfi\n")
            os.chmod(program, 0o755)
            self.assertEqual(commands.actions_with_help(Path(folder), "count", HELP.rstrip()), {"up": "Usage: up"})


def function(name, line, about="", arguments="()"):
    """A function, as doxygen describes it."""
    return ElementTree.fromstring(
        f'<memberdef kind="function" prot="public" static="no"><type>const <ref>Frame</ref> &amp;</type><name>{name}</name>'
        f"<argsstring>{arguments}</argsstring><briefdescription><para>{about}</para></briefdescription>"
        f'<location file="a.hpp" line="{line}"/></memberdef>')


class Interfaces(unittest.TestCase):
    def test_a_declaration_has_the_spaces_of_the_project(self):
        self.assertEqual(interfaces.declaration(function("f", 1, arguments="(std::span&lt; const int &gt; a, char *b, int c=2) const =0")),
                         "const Frame& f(std::span<const int> a, char* b, int c = 2) const = 0;")

    def test_words_stand_below_the_declarations_to_which_they_belong(self):
        text = interfaces.members_text([function("second", 3), function("first", 2, "Words &lt;here&gt;."), function("other", 6)])
        self.assertEqual(text, "```cpp\nconst Frame& first();\nconst Frame& second();\n```\n\nWords \\<here\\>.\n\n"
                               "```cpp\nconst Frame& other();\n```")

    def test_what_a_class_deletes_is_not_part_of_its_interface(self):
        self.assertEqual(interfaces.members_text([function("f", 1, arguments="(int)=delete")]), "")

    def test_a_header_begins_with_its_comment(self):
        self.assertEqual(interfaces.head_comment("#pragma once\n\n// One.\n//\n// a_b.\n\n#include <c>\n"), "One.\n\na\\_b.")
        self.assertEqual(interfaces.head_comment("#pragma once\n\n/// Of a class.\n"), "")


if __name__ == "__main__":
    unittest.main()

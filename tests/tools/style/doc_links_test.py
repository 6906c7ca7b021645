"""The links between the pages of the tree: what a link or picture names exists, and so does the heading behind '#'.
Addresses on the internet are not read.

usage: doc_links_test.py SOURCE_FOLDER
"""

import re
import sys
import tempfile
import unittest
from pathlib import Path
from urllib.parse import unquote

SOURCE = Path(sys.argv.pop(1)).resolve() if __name__ == "__main__" else Path()
CODE = re.compile(r"^```.*?^```$|^ {4}(?! *[-*] ).*?$|``.+?``|`[^`\n]*(?:\n[^`\n]+)?`", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)\s]+)(?:\s+\"[^\"]*\")?\)|^\[[^\]]+\]:\s+(\S+)|<(?:a|img)\s[^>]*(?:href|src)=\"([^\"]+)\"", re.MULTILINE)


def without_code(text):
    """The text with blanks where code was, so that lines keep their numbers."""
    return CODE.sub(lambda code: re.sub(r"[^\n]", " ", code.group()), text)


def anchors(text):
    """The anchors of the headings, as code hosts and the site make them. Of two equal headings the second has none: the rules differ."""
    found = set()
    prose = re.sub(r"^```.*?^```$|^ {4}[^\n]*$", "", text, flags=re.MULTILINE | re.DOTALL)
    for heading in re.findall(r"^#+ (.+)$", prose, re.MULTILINE):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
        found.add(re.sub(r" ", "-", re.sub(r"[^\w\- ]", "", words)))
    return found


def dead_links(source, pages):
    for page in pages:
        text = without_code(page.read_text())
        for link in LINK.finditer(text):
            address = next(filter(None, link.groups()))
            if re.match(r"[a-z][a-z0-9+.-]*:", address):
                continue
            where = f"{page.relative_to(source)}:{text.count(chr(10), 0, link.start()) + 1}"
            path, _, anchor = unquote(address).partition("#")
            target = page.parent / path if path else page
            if not target.exists():
                yield f"{where}: found {address}, expected a file of the tree"
            elif anchor and (target.suffix != ".md" or anchor not in anchors(target.read_text())):
                yield f"{where}: found {address}, expected a heading of {path or page.name}"


def pages_of(source):
    return [*source.glob("*.md"), *source.glob("docs/**/*.md"), *source.glob("tests/**/*.md")]


class Tree(unittest.TestCase):
    def test_no_link_is_dead(self):
        messages = list(dead_links(SOURCE, pages_of(SOURCE)))
        self.assertEqual(messages, [], "\n".join(messages))


class Planted(unittest.TestCase):
    """The check finds what it is for."""

    def found(self, text):
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder)
            (source / "docs").mkdir()
            (source / "docs/b.md").write_text("# B\n\n## It's `proleg ui`: two words\n\n```sh\n# no heading\n```\n")
            (source / "docs/a.md").write_text(text)
            return list(dead_links(source, pages_of(source)))

    def test_live_links_are_not_found(self):
        self.assertEqual(self.found("# A\n[b](b.md) [b](b.md#its-proleg-ui-two-words) [a](#a) ![b](b.md) [c](https://d.example/e)\n"
                                    "`[d](none.md)`\n\n    [e](none.md)\n\n```text\n[f](none.md)\n```\n"), [])

    def test_dead_links_are_found_with_their_line(self):
        for link in ("[b](none.md)", "![b](none.png)", "[b](b.md#none)", "[b](b.md#no-heading)", "[b](#none)", "[b]: none.md",
                     "- [`b`](none.md)", "    - [b](none.md)", "[two\nlines](none.md)", '<img src="none.png">'):
            messages = self.found(f"# A\n\n{link}\n")
            self.assertEqual(len(messages), 1, link)
            self.assertRegex(messages[0], r"^docs/a\.md:[34]: found ")


if __name__ == "__main__":
    unittest.main()

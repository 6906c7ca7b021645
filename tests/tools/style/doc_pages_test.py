"""The pages of docs/: each is in the navigation of the site, and begins with a sentence that says what a reader can do after it.

usage: doc_pages_test.py SOURCE_FOLDER
"""

import re
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(sys.argv.pop(1)).resolve() if __name__ == "__main__" else Path()
sys.path.insert(0, str(SOURCE / "tools/docs.d"))
sys.dont_write_bytecode = True
import navigation  # noqa: E402


def wrong_start(text):
    """What is wrong with the begin of a page, or nothing."""
    blocks = re.split(r"\n{2,}", text.strip())
    if not re.fullmatch(r"# \S.*", blocks[0]):
        return f"found {blocks[0][:40]!r}, expected a title and an empty line"
    if len(blocks) < 2 or not re.match(r"[A-Za-z]", blocks[1]):
        return "found no paragraph behind the title, expected a sentence that says what a reader can do after the page"
    sentence = navigation.first_sentence(text)
    if not sentence.startswith(navigation.START) or not sentence.endswith(".") or re.search(r"\.\s", sentence):
        return f"found {sentence[:60]!r}, expected one sentence that begins with {navigation.START!r}"
    return ""


def wrong_navigation(source):
    """Pages that are not once in the navigation, and names in it that are no page."""
    files = [file for _, pages in navigation.sections_of(source) for _, file in pages]
    existing = {navigation.RENAMED.get(f"docs/{page.name}", page.name) for page in source.glob("docs/*.md")}
    existing |= {target for name, target in navigation.RENAMED.items() if (source / name).is_file()}
    for file in sorted(existing | set(files)):
        if file not in existing:
            yield f"docs/mkdocs.yml: found {file}, expected a page of docs/"
        elif files.count(file) != 1:
            yield f"docs/mkdocs.yml: found {file} {files.count(file)} times, expected it once"


class Tree(unittest.TestCase):
    def test_each_page_says_first_what_a_reader_can_do_after_it(self):
        pages = sorted(SOURCE.glob("docs/*.md"))
        self.assertGreater(len(pages), 20)
        messages = [f"docs/{page.name}: {wrong_start(page.read_text())}" for page in pages if wrong_start(page.read_text())]
        self.assertEqual(messages, [], "\n".join(messages))

    def test_each_page_is_once_in_the_navigation(self):
        self.assertEqual(list(wrong_navigation(SOURCE)), [])

    def test_the_list_of_all_pages_is_that_of_the_navigation(self):
        self.assertEqual((SOURCE / "docs/README.md").read_text(), navigation.list_of_pages(SOURCE),
                         "docs/README.md: run tools/docs --list")


class Planted(unittest.TestCase):
    """The checks find what they are for."""

    def test_a_page_that_begins_with_something_else_is_found(self):
        self.assertEqual(wrong_start("# A\n\nAfter this page you can see\nit.\n\n- a\n"), "")
        for start in ("", "- After this page you can see it.", "| a |", "## B", "    code", "```sh\ncode\n```", "Words.",
                      "After this page you can see it", "After this page you can see it. More."):
            self.assertNotEqual(wrong_start(f"# A\n\n{start}\n\nWords.\n"), "", start)

    def test_a_page_that_is_missing_in_the_navigation_or_twice_in_it_is_found(self):
        with tempfile.TemporaryDirectory() as folder:
            docs = Path(folder) / "docs"
            docs.mkdir()
            for name in ("a", "b"):
                (docs / f"{name}.md").touch()
            for pages, expected in ((("a", "b"), 0), (("a",), 1), (("a", "b", "b"), 1), (("a", "b", "c"), 1)):
                (docs / "mkdocs.yml").write_text("x: y\nnav:\n  - Start:\n" + "".join(f"      - {page}: {page}.md\n" for page in pages))
                self.assertEqual(len(list(wrong_navigation(Path(folder)))), expected, pages)


if __name__ == "__main__":
    unittest.main()

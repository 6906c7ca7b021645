"""docs_test.py SOURCE_DIR: every file or folder of the tree that a page names exists, and the glossary is in order."""

import re
import sys
from pathlib import Path

PAGES = ["README.md", "CONTRIBUTING.md", *sorted(str(page) for page in Path(sys.argv[1]).glob("docs/*.md"))]
NAMED = re.compile(r"`((?:shared|firmware|sim|tools|tests|docs)/[\w./-]*\w/?)`")


def missing(source, page):
    for number, line in enumerate((source / page).read_text().splitlines(), 1):
        for name in NAMED.findall(line.replace("shared/gait/my_algorithm.cpp", "")):  # the example of a new one
            # A name without its ending stands for header and source.
            if not (source / name).exists() and not list((source / name).parent.glob(Path(name).name + ".*")):
                yield f"{page}:{number}: found {name}, expected a file or folder of the tree"


def unsorted(source):
    text = (source / "docs/glossary.md").read_text()
    words = [re.sub(r"[^a-z0-9 ]", "", row.lower()) for row in re.findall(r"^\| (?!word|-)([^|]+) \|.*\|.*\|.*\|$", text, re.MULTILINE)]
    for first, second in zip(words, words[1:]):
        if first > second:
            yield f"docs/glossary.md: found {second!r} behind {first!r}, expected alphabetical order"
    if not words:
        yield "docs/glossary.md: found no words, expected a table of them"


def main():
    source = Path(sys.argv[1])
    messages = [message for page in PAGES for message in missing(source, page)] + list(unsorted(source))
    print("\n".join(messages))
    return 1 if messages else 0


if __name__ == "__main__":
    sys.exit(main())

"""docs_test.py SOURCE_DIR: every file or folder of the tree that a page names exists, the glossary is in order, and the
page of hazards names tests that exist."""

import re
import sys
from pathlib import Path

PAGES = ["README.md", "CONTRIBUTING.md", *sorted(str(page) for page in Path(sys.argv[1]).glob("docs/*.md"))]
NAMED = re.compile(r"`((?:shared|firmware|sim|host|tools|tests|docs)/[\w./-]*\w/?)`")


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


TEST = re.compile(r"\bTEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\)")
PYTHON_CLASS = re.compile(r"^class (\w+)(.*?)(?=^\w|\Z)", re.MULTILINE | re.DOTALL)


def untested(source):
    """Each row of a table of docs/safety.md names a test, and the tests exist."""
    tests = {".".join(test) for path in source.glob("tests/**/*_test.cpp") for test in TEST.findall(path.read_text())}
    tests |= {f"{name}.{test}" for path in source.glob("tests/**/*_test.py") for name, body in PYTHON_CLASS.findall(path.read_text())
              for test in re.findall(r"^    def (test_\w+)", body, re.MULTILINE)}
    tests |= {f"{path.stem}.{test}" for path in source.glob("tests/**/*_test.py")
              for test in re.findall(r"^def (test_\w+)", path.read_text(), re.MULTILINE)}
    for number, line in enumerate((source / "docs/safety.md").read_text().splitlines(), 1):
        if not line.startswith("|") or line.startswith(("| hazard", "| rule", "| ---")):
            continue
        named = re.findall(r"`(?:\w+/)?(\w+\.\w+)`", line.rsplit("|", 2)[1])
        if not named:
            yield f"docs/safety.md:{number}: found no test, expected one in the last column"
        for name in named:
            if name not in tests:
                yield f"docs/safety.md:{number}: found {name}, expected a test of the tree"


def main():
    source = Path(sys.argv[1])
    messages = [message for page in PAGES for message in missing(source, page)] + list(unsorted(source)) + list(untested(source))
    print("\n".join(messages))
    return 1 if messages else 0


if __name__ == "__main__":
    sys.exit(main())

"""The order of the documentation's pages, which docs/mkdocs.yml has, and the list of all pages that follows from it.

usage: navigation.py SOURCE_FOLDER: writes the list, docs/README.md
"""

import re
import sys
from pathlib import Path

# Where pages that are not in docs/, or have another name there, are in the site.
RENAMED = {"README.md": "index.md", "CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md",
           "docs/README.md": "pages.md"}
START = "After this page you can "

READERS = {
    "Start": "You are new here.",
    "Teach": "You have a class, with or without a box of modules.",
    "Research": "You study gaits.",
    "Firmware": "You build modules or boards, or connect other hardware.",
    "Reference": "You look something up. [`proleg.eds`](proleg.eds) has the objects for CANopen tools, [`proleg.dbc`](proleg.dbc) the "
                 "frames for CAN tools.",
}
HEAD = """# All pages

After this page you can find the page that your task needs.

`tools/docs` makes a site of these pages, with search, a manual of every command and the interfaces of the core. It opens from
`build/docs/site/index.html` without a network. (Written by `tools/docs --list` from `docs/mkdocs.yml` and the first sentences of the pages; a
test keeps them the same.)
"""


def sections_of(source):
    """The sections of the navigation: (name, [(title, file)]), without what tools/docs generates."""
    text = (source / "docs/mkdocs.yml").read_text().partition("\nnav:\n")[2]
    found = []
    for line in text.splitlines():
        section = re.fullmatch(r"  - (\w+):", line)
        page = re.fullmatch(r' +- "?([^"]*?)"?: ([\w-]+\.md)', line)
        if section:
            found.append((section.group(1), []))
        elif page:
            found[-1][1].append(page.groups())
    return found


def first_sentence(text):
    """What a reader can do after a page: its first paragraph, in one line."""
    return " ".join(re.split(r"\n{2,}", text.strip())[1].split())


def list_of_pages(source):
    places = {target: name for name, target in RENAMED.items()}
    parts = [HEAD]
    for section, pages in sections_of(source):
        parts.append(f"\n## {section}\n\n{READERS[section]}\n\n")
        for title, file in pages:
            path = places.get(file, f"docs/{file}")
            if path == "docs/README.md":
                continue
            link = f"../{path}" if not path.startswith("docs/") else file
            sentence = first_sentence((source / path).read_text())
            can = f": {sentence.removeprefix(START).removesuffix('.')}" if sentence.startswith(START) else ""
            parts.append(f"- [{title}]({link}){can}\n")
    return "".join(parts)


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    (folder / "docs/README.md").write_text(list_of_pages(folder))

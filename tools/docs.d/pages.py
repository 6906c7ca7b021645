"""Collects the sources of the documentation's site: the pages of docs/, those at the top of the tree, a manual for each
command and the interfaces of the core.

usage: pages.py SOURCE_FOLDER PROGRAM_FOLDER OUTPUT_FOLDER: writes pages/, theme/ and mkdocs.yml into the last one; without the
interfaces if its name ends in _installed
"""

import html
import re
import shutil
import sys
from pathlib import Path

import commands
import interfaces
from navigation import RENAMED

CODE = re.compile(r"^```.*?^```$|^    .*?$", re.MULTILINE | re.DOTALL)
PICTURE = re.compile(r"!\[([^\]]*)\]\(([^)\s]+)\)")
LINK = re.compile(r"(\]\()([^)\s#:]+)((?:#[^)\s]*)?\))")
# The name of a page: all of a piece of code, or a word of the text. Other code is taken as a whole, so that no name in it is a word.
NAMED = re.compile(r"(?<!\[)`((?:docs/)?[A-Za-z][\w-]*\.(?:md|eds|dbc))`|`[^`\n]+`|(?<![\w/(\[])\(?(docs/[\w-]+\.md)\b")
CODE_WITH_BAR = re.compile(r"`([^`\n]*\\\|[^`\n]*)`")


def title_of(text):
    return re.search(r"^# (.*)", text).group(1)


def in_site(source, page, target):
    """The address in the site for a relative one in a page of the tree."""
    path = (source / page).parent.joinpath(target).resolve().relative_to(source.resolve()).as_posix()
    return RENAMED.get(path, path.removeprefix("docs/"))


def changed_outside_of_code(text, change):
    parts, end = [], 0
    for code in CODE.finditer(text):
        parts += [change(text[end:code.start()]), code.group()]
        end = code.end()
    return "".join(parts) + change(text[end:])


def for_site(source, page, text):
    """A page of the tree with the addresses of the site. Pictures open by a click, names of pages are links."""

    def named(match):
        path = match.group(1) or match.group(2)
        if not path or not (source / path).is_file():
            return match.group()
        target = RENAMED.get(path, path.removeprefix("docs/"))
        words = title_of((source / path).read_text()) if path.endswith(".md") else f"`{Path(path).name}`"
        start = "(" if match.group().startswith("(") else ""
        return f"{start}[{words}]({target})"

    def change(part):
        part = LINK.sub(lambda match: match.group(1) + in_site(source, page, match.group(2)) + match.group(3), part)
        part = PICTURE.sub(r"[![\1](\2)](\2)", part)
        return "\n".join(line if line.startswith("#") else NAMED.sub(named, line) for line in part.split("\n"))

    return changed_outside_of_code(text, change)


def bars_in_tables(text):
    """Code with a bar in a table: mkdocs shows the stroke before the bar, code hosts do not."""

    def as_html(match):
        return f"<code>{html.escape(match.group(1).replace(chr(92) + '|', '|'), quote=False).replace('|', '&#124;')}</code>"

    return "\n".join(CODE_WITH_BAR.sub(as_html, line) if line.startswith("|") else line for line in text.split("\n"))


def main():
    source, programs, output = map(Path, sys.argv[1:4])
    pages = output / "pages"
    shutil.copytree(source / "docs", pages, ignore=shutil.ignore_patterns("*.md", "mkdocs.yml"))
    shutil.copy(source / "LICENSE", pages)
    shutil.copytree(source / "tools/docs.d/theme", output / "theme")
    names = [*RENAMED, *(f"docs/{path.name}" for path in sorted(source.glob("docs/*.md")))]
    texts = {}
    for name in dict.fromkeys(names):
        text = (source / name).read_text()
        texts[in_site(source, ".", name)] = text
        (pages / in_site(source, ".", name)).write_text(for_site(source, name, text))

    generated = {"commands": commands.write_manuals(programs, texts, pages / "commands"), "interfaces": []}
    if not output.name.endswith("_installed"):  # who reads interfaces has the sources
        generated["interfaces"] = interfaces.write_pages(source, output / "xml", pages / "interfaces")
    for page in pages.rglob("*.md"):
        page.write_text(bars_in_tables(page.read_text()))
    config = (source / "docs/mkdocs.yml").read_text()
    for folder, files in generated.items():
        if not files:
            config = re.sub(rf"^.*\[{folder}/\*\]\n", "", config, flags=re.MULTILINE)
        config = config.replace(f"{folder}/*", ", ".join(f"{folder}/{file}" for file in files))
    (output / "mkdocs.yml").write_text(config)


if __name__ == "__main__":
    main()

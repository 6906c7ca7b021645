"""Ends the site of the documentation, so that it opens from a file, and from a server that forbids scripts in pages, as `proleg ui`
does: scripts of the pages, and the index of search, become files. Removes what no page of it needs, and checks that everything to
which a page links is there.

usage: finish.py SITE_FOLDER
"""

import hashlib
import re
import shutil
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """The addresses in a page and the names to which an address can point."""

    def __init__(self, text):
        super().__init__()
        self.addresses, self.names = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("href", "src") and value is not None:
                self.addresses.append((self.getpos()[0], tag, name, value))
            elif name in ("id", "name") and value:
                self.names.add(value)


def dead_links(site):
    pages = {path: Page(path.read_text()) for path in sorted(site.rglob("*.html"))}
    for path, page in pages.items():
        for line, tag, attribute, address in page.addresses:
            where = f"{path.relative_to(site)}:{line}"
            parts = urlsplit(address)
            if parts.scheme or parts.netloc:
                if attribute == "src" or tag == "link":
                    yield f"{where}: found {address}, expected a file of the site"
                continue
            if path.name == "404.html":  # its addresses begin at the root of a server
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path.resolve()
            if target.is_dir():
                target /= "index.html"
            if not target.is_file():
                yield f"{where}: found {address}, expected a file of the site"
            elif parts.fragment and target.suffix == ".html" and parts.fragment != "__skip":
                if unquote(parts.fragment) not in pages[target].names:
                    yield f"{where}: found {address}, expected a heading of {target.relative_to(site.resolve())}"


def move_scripts(site):
    """The scripts in pages become files, each once."""
    for page in site.rglob("*.html"):
        # 404.html has addresses from the root of a server.
        base = "/" if page.name == "404.html" else "../" * (len(page.relative_to(site).parts) - 1)

        def to_file(match):
            name = f"assets/javascripts/page.{hashlib.sha256(match[1].encode()).hexdigest()[:8]}.js"
            (site / name).write_text(match[1] + "\n")
            return f'<script src="{base}{name}"></script>'

        page.write_text(re.sub(r"<script>(.*?)</script>", to_file, page.read_text(), flags=re.DOTALL))


def remove_indents(site):
    """Half of a page is its navigation, and a third of that are blanks."""
    for page in site.rglob("*.html"):
        parts = re.split(r"(<(pre|textarea|script)\b.*?</\2>)", page.read_text(), flags=re.DOTALL)
        # re.split gives for each match the whole and its name.
        text = "".join(re.sub(r"\s*\n\s*", "\n", part) if place % 3 == 0 else part if place % 3 == 1 else "" for place, part in enumerate(parts))
        page.write_text(text)


def remove_unused(site):
    """Maps for debuggers, the languages of the search beside English, and the list for search engines."""
    shutil.rmtree(site / "assets/javascripts/lunr")
    for file in [*site.rglob("*.map"), *site.glob("sitemap.xml*")]:
        file.unlink()


def main():
    site = Path(sys.argv[1]).resolve()
    index = site / "search/search_index.json"
    (site / "search/search_index.js").write_text(f"set_search_index({index.read_text()});\n")
    index.unlink()
    move_scripts(site)
    remove_indents(site)
    remove_unused(site)
    size = sum(file.stat().st_size for file in site.rglob("*") if file.is_file())
    print(f"{size / 1e6:.1f} MB", flush=True)
    messages = list(dead_links(site))
    for message in messages:
        print(message, file=sys.stderr)
    return 1 if messages else 0


if __name__ == "__main__":
    sys.exit(main())

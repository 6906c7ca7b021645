"""Ends the site of the documentation: its index of search as a script, for pages that were opened from a file; and a check
that everything to which a page links is there.

usage: finish.py SITE_FOLDER
"""

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


def main():
    site = Path(sys.argv[1]).resolve()
    index = (site / "search/search_index.json").read_text()
    (site / "search/search_index.js").write_text(f"set_search_index({index});\n")
    messages = list(dead_links(site))
    for message in messages:
        print(message, file=sys.stderr)
    return 1 if messages else 0


if __name__ == "__main__":
    sys.exit(main())

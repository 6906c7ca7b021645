"""include_circles.py SOURCE_DIR: no unit of the tree includes itself by way of others, and no folder does.

A unit is a header with the source of the same name, or a file of the page. An `import type` counts as any other import:
who reads one of the files needs the other.
Prints a shortest circle of each unit that is in one, as `a -> b -> a`, and the lines that make it.
"""

import os
import re
import sys
from collections import defaultdict, deque
from pathlib import Path

ROOMS = ["shared", "firmware", "sim", "host", "tools", "tests"]
CPP_ENDINGS = {".hpp", ".h", ".cpp", ".c"}
PAGE_ENDINGS = {".ts", ".tsx"}
NOT_OURS = {"node_modules", "__pycache__"}
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*"([^"]+)"', re.MULTILINE)
IMPORT = re.compile(
    r"""^(?:import|export)\b[^;'"]*?\bfrom\s*['"](\.[^'"]+)['"]|^import\s*['"](\.[^'"]+)['"]|\bimport\(\s*['"](\.[^'"]+)['"]\s*\)""",
    re.MULTILINE,
)


class Graph:
    """What includes what, and the first line that says so."""

    def __init__(self):
        self.edges = defaultdict(dict)

    def add(self, user, used, line):
        if user != used:
            self.edges[user].setdefault(used, line)

    def circle_through(self, start):
        """The shortest way from a node back to it; nothing if there is none."""
        came_from = {}
        pending = deque([start])
        while pending:
            node = pending.popleft()
            for used in self.edges.get(node, ()):
                if used == start:
                    circle = [node]
                    while circle[0] != start:
                        circle.insert(0, came_from[circle[0]])
                    return circle
                if used not in came_from:
                    came_from[used] = node
                    pending.append(used)
        return None

    def circles(self):
        """One for each node that is in a circle; a circle that begins elsewhere is the same."""
        found = {}
        for node in sorted(self.edges):
            if circle := self.circle_through(node):
                first = circle.index(min(circle))
                circle = circle[first:] + circle[:first]
                found[tuple(circle)] = [self.edges[a][b] for a, b in zip(circle, circle[1:] + circle[:1])]
        return found


def unit_of(path):
    return str(path.with_suffix("")) if path.suffix in CPP_ENDINGS else str(path)


class Tree:
    def __init__(self, source):
        self.source = source
        self.files = {
            path.relative_to(source)
            for room in ROOMS
            for path in sorted((source / room).rglob("*"))
            if path.suffix in CPP_ENDINGS | PAGE_ENDINGS and not NOT_OURS.intersection(path.parts)
        }
        self.by_name = defaultdict(set)
        for path in self.files:
            self.by_name[path.name].add(path)

    def included(self, user, name):
        """The file that an include names. Tests also name files of folders that CMake gives them, without a folder."""
        for path in (Path(name), user.parent / name):
            if path in self.files:
                return path
        alike = {path for path in self.by_name[Path(name).name] if str(path).endswith("/" + name)}
        return alike.pop() if len(alike) == 1 else None

    def imported(self, user, name):
        path = Path(os.path.normpath(user.parent / name))
        for candidate in (path, path.with_suffix(".ts"), path.with_suffix(".tsx")):
            if candidate in self.files:
                return candidate
        return None

    def graphs(self):
        units = Graph()
        folders = Graph()
        for user in sorted(self.files):
            text = (self.source / user).read_text()
            is_cpp = user.suffix in CPP_ENDINGS
            for match in (INCLUDE if is_cpp else IMPORT).finditer(text):
                name = next(group for group in match.groups() if group)
                used = (self.included if is_cpp else self.imported)(user, name)
                if used is None:
                    continue  # made by the build, or of a library
                line = f"{user}:{text.count(chr(10), 0, match.start()) + 1}: {' '.join(match[0].split())}"
                units.add(unit_of(user), unit_of(used), line)
                folders.add(str(user.parent) + "/", str(used.parent) + "/", line)
        return units, folders


def main():
    tree = Tree(Path(sys.argv[1]))
    if not tree.files:
        print(f"{sys.argv[1]}: found no sources, expected the folders {', '.join(ROOMS)}")
        return 1
    has_circle = False
    for graph in tree.graphs():
        for circle, lines in graph.circles().items():
            has_circle = True
            print(" -> ".join(circle + circle[:1]))
            print("".join(f"    {line}\n" for line in lines), end="")
    return 1 if has_circle else 0


if __name__ == "__main__":
    sys.exit(main())

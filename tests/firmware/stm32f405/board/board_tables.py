"""The tables of the reference module, and copies of them that a test changes."""

import random
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
FOLDER = Path(__file__).resolve().parents[4] / "firmware/stm32f405/board"
sys.path.insert(0, str(FOLDER))
NAMES = ("lqfp64.tsv", "nets.tsv", "parts.tsv", "netlist.tsv")


class Copy:
    """A copy of the tables in a folder of its own."""

    def __init__(self, test):
        folder = tempfile.TemporaryDirectory()
        test.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        for name in NAMES:
            shutil.copy(FOLDER / name, self.folder / name)

    def lines(self, name):
        return (self.folder / name).read_text().split("\n")

    def rewrite(self, name, change):
        """change: from a list of cells to a list of cells, or None to remove the row."""
        head, rows = None, []
        for line in (self.folder / name).read_text().splitlines():
            if line.startswith("#"):
                rows.append(line)
            elif head is None:
                head = line.split("\t")
                rows.append(line)
            else:
                row = dict(zip(head, line.split("\t")))
                changed = change(row)
                if changed is not None:
                    rows.append("\t".join(changed.values()))
        (self.folder / name).write_text("\n".join(rows) + "\n")

    def set(self, name, where, **cells):
        """Changes the rows that have the cells of `where`."""
        count = 0

        def change(row):
            nonlocal count
            if all(row[key] == value for key, value in where.items()):
                count += 1
                return {**row, **cells}
            return row
        self.rewrite(name, change)
        if not count:
            raise AssertionError(f"{name}: found no row with {where}")

    def set_pin(self, pin, **cells):
        part, number = pin.split(".")
        self.set("netlist.tsv", {"part": part, "pin": number}, **cells)

    def remove(self, name, **where):
        self.rewrite(name, lambda row: None if all(row[key] == value for key, value in where.items()) else row)

    def append(self, name, *cells):
        with (self.folder / name).open("a") as file:
            file.write("\t".join(cells) + "\n")

    def remove_part(self, part):
        self.remove("parts.tsv", part=part)
        self.remove("netlist.tsv", part=part)


def run(*arguments, folder=FOLDER):
    return subprocess.run([sys.executable, str(FOLDER / "board.py"), "--tables", str(folder), *map(str, arguments)], capture_output=True,
                          text=True, check=False)


def seeded(seed):
    print(f"seed {seed}", file=sys.stderr)
    return random.Random(seed)

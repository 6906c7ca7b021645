"""The schematic without KiCad: the same bytes each time, and the nets that its coordinates make are those of the tables. The reader
of this test knows nothing of the program that writes the file."""

import re
import sys
import unittest
from collections import defaultdict

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
from board_tables import FOLDER, Copy, run  # noqa: E402

import tables  # noqa: E402

TOKEN = re.compile(r'\s*(?:(\()|(\))|"((?:[^"\\]|\\.)*)"|([^\s()"]+))')


def parse(text):
    """A strict reader of s-expressions: lists and strings."""
    stack, at = [[]], 0
    text = text.rstrip()
    while at < len(text):
        match = TOKEN.match(text, at)
        if not match:
            raise ValueError(f"found {text[at:at + 20]!r} at {at}")
        at = match.end()
        if match[1]:
            stack.append([])
        elif match[2]:
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(match[4] if match[3] is None else re.sub(r"\\(.)", r"\1", match[3]))
    if len(stack) != 1 or len(stack[0]) != 1:
        raise ValueError("found brackets that do not match")
    return stack[0][0]


def all_of(node, key):
    return [child for child in node if isinstance(child, list) and child and child[0] == key]


def one_of(node, key):
    found = all_of(node, key)
    if len(found) != 1:
        raise ValueError(f"found {len(found)} {key} in {node[:2]}, expected one")
    return found[0]


def point(x, y):
    return round(float(x) * 100), round(float(y) * 100)


def nets_of(sheet):
    """Nets by connection of coordinates: {net: {part.pin}}, and the pins with a mark that they are open."""
    library = {}
    for symbol in all_of(one_of(sheet, "lib_symbols"), "symbol"):
        pins = {}
        for unit in all_of(symbol, "symbol"):
            for pin in all_of(unit, "pin"):
                at = one_of(pin, "at")
                pins[one_of(pin, "number")[1]] = point(at[1], at[2])
        library[symbol[1]] = pins
    parent = {}

    def find(node):
        parent.setdefault(node, node)
        while parent[node] != node:
            node = parent[node]
        return node

    pins = {}
    for symbol in all_of(sheet, "symbol"):
        at = one_of(symbol, "at")
        x, y = point(at[1], at[2])
        reference = next(row[2] for row in all_of(symbol, "property") if row[1] == "Reference")
        for number, (pin_x, pin_y) in library[one_of(symbol, "lib_id")[1]].items():
            pins[f"{reference}.{number}"] = (x + pin_x, y - pin_y)
    for place in pins.values():
        find(place)
    for wire in all_of(sheet, "wire"):
        ends = [point(end[1], end[2]) for end in all_of(one_of(wire, "pts"), "xy")]
        (first_x, first_y), (last_x, last_y) = ends
        # A wire connects what touches it anywhere, so nothing may cross it by accident.
        for x, y in [*pins.values(), *ends]:
            if min(first_x, last_x) <= x <= max(first_x, last_x) and min(first_y, last_y) <= y <= max(first_y, last_y):
                parent[find((x, y))] = find(ends[0])
    names = defaultdict(set)
    for label in all_of(sheet, "global_label"):
        at = one_of(label, "at")
        names[find(point(at[1], at[2]))].add(label[1])
    nets, alone = defaultdict(set), set()
    for pin, place in pins.items():
        name = names[find(place)]
        if len(name) > 1:
            raise ValueError(f"found nets {sorted(name)} at {pin}, expected one")
        (nets[next(iter(name))] if name else alone).add(pin)
    marks = {point(*one_of(mark, "at")[1:3]) for mark in all_of(sheet, "no_connect")}
    return dict(nets), alone, {pin for pin, place in pins.items() if place in marks}


class Schematic(unittest.TestCase):
    def write(self, folder=FOLDER, name="a.kicad_sch"):
        place = Copy(self).folder / name
        result = run("schematic", place, folder=folder)
        self.assertEqual(result.returncode, 0, result.stderr)
        return place

    def setUp(self):
        self.text = self.write().read_text()
        self.sheet = parse(self.text)
        self.board = tables.read_board(FOLDER)

    def test_is_a_file_of_kicad_6(self):
        self.assertEqual(self.sheet[0], "kicad_sch")
        self.assertEqual(one_of(self.sheet, "version")[1], "20211123")

    def test_has_the_same_bytes_each_time(self):
        self.assertEqual(self.write(name="b.kicad_sch").read_text(), self.text)

    def test_no_identifier_is_used_twice(self):
        found = re.findall(r"\(uuid ([0-9a-f-]{36})\)", self.text)
        self.assertEqual(len(found), len(set(found)))

    def test_each_net_has_the_pins_of_the_tables(self):
        nets, alone, marked = nets_of(self.sheet)
        wanted = {net.name: {f"{pin.part.name}.{pin.number}" for pin in net.pins} for net in self.board.nets.values()}
        found = {name: {pin for pin in pins if not pin.startswith("#")} for name, pins in nets.items()}
        self.assertEqual(found, wanted)
        self.assertEqual(alone, {f"{pin.part.name}.{pin.number}" for pin in self.board.pins if not pin.net})
        self.assertEqual(marked, alone)

    def test_each_part_has_its_value_and_footprint(self):
        found = {}
        for symbol in all_of(self.sheet, "symbol"):
            row = {entry[1]: entry[2] for entry in all_of(symbol, "property")}
            found[row["Reference"]] = (row["Value"], row["Footprint"], row.get("Article"))
        for part in self.board.parts.values():
            self.assertEqual(found[part.name], (part.value, part.footprint, part.article))

    def test_a_changed_net_changes_the_drawing(self):
        copy = Copy(self)
        copy.set_pin("JP2.1", net="VDDA")
        nets, _, _ = nets_of(parse(self.write(copy.folder).read_text()))
        self.assertIn("JP2.1", nets["VDDA"])
        self.assertNotIn("JP2.1", nets["3V3"])

    def test_tables_with_a_fault_are_not_drawn(self):
        copy = Copy(self)
        copy.set_pin("R20.1", net="VDDA")
        result = run("schematic", copy.folder / "a.kicad_sch", folder=copy.folder)
        self.assertEqual(result.returncode, 1)
        self.assertIn("U2.1 (TXD): found no resistor to 3V3", result.stderr)
        self.assertFalse((copy.folder / "a.kicad_sch").exists())

    def test_symbols_do_not_overlap(self):
        places = {}
        for symbol in all_of(self.sheet, "symbol"):
            at = one_of(symbol, "at")
            name = next(row[2] for row in all_of(symbol, "property") if row[1] == "Reference")
            self.assertNotIn((at[1], at[2]), places, f"{name} and {places.get((at[1], at[2]))}")
            places[at[1], at[2]] = name
            self.assertTrue(10 < float(at[1]) < 584 and 10 < float(at[2]) < 410, f"{name} is outside of the sheet")


class Page(unittest.TestCase):
    """The tables of docs/board.md."""

    PAGE = FOLDER.parents[2] / "docs/board.md"

    def check(self, page, *more, folder=FOLDER):
        return run("docs", *more, "--page", page, folder=folder)

    def test_is_made_from_the_tables(self):
        result = self.check(self.PAGE, "--check")
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_a_page_that_differs_fails_and_can_be_made_anew(self):
        copy = Copy(self)
        page = copy.folder / "board.md"
        page.write_text(self.PAGE.read_text().replace("| R1 |", "| R1, R2 |"))
        result = self.check(page, "--check")
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"^\S+board\.md:\d+: found a table that differs .*\n$")
        self.assertEqual(self.check(page).returncode, 0)
        self.assertEqual(page.read_text(), self.PAGE.read_text())

    def test_a_changed_table_needs_another_page(self):
        copy = Copy(self)
        copy.set("parts.tsv", {"part": "R39"}, value="330 Ω")
        self.assertEqual(self.check(self.PAGE, "--check", folder=copy.folder).returncode, 1)

    def test_a_page_without_places_for_the_tables_is_bad_input(self):
        page = Copy(self).folder / "board.md"
        page.write_text("# The board\n")
        result = self.check(page)
        self.assertEqual((result.returncode, result.stderr.count("\n")), (2, 1))
        self.assertIn("found no place for the table pins", result.stderr)


if __name__ == "__main__":
    sys.exit(unittest.main())

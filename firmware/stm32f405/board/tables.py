"""Reads the tables of the reference module: lqfp64.tsv, nets.tsv, parts.tsv, netlist.tsv. A table that is wrong in itself raises
TableError, whose text is one line with file, line, what was found and what was expected."""

import re
from dataclasses import dataclass, field
from pathlib import Path

BLOCKS = ("supply", "chip", "can", "servo", "sensors", "connectors")
# Symbols with two pins, and the names of the pins.
TWO_PINS = {"resistor": ("1", "2"), "capacitor": ("1", "2"), "polarised": ("+", "-"), "ferrite": ("1", "2"), "fuse": ("1", "2"),
            "diode": ("K", "A"), "schottky": ("K", "A"), "tvs": ("K", "A"), "led": ("K", "A"), "crystal": ("1", "2"),
            "switch": ("1", "2"), "jumper": ("1", "2")}
SYMBOLS = (*TWO_PINS, "pad", "connector", "box", "chip")
TYPES = ("power_in", "power_out", "input", "output", "bidirectional", "passive", "no_connect")
STRUCTURES = ("FT", "TTa", "RST", "B", "-")
QUESTIONS = tuple(f"B{number}" for number in range(1, 15))
NONE = "-"

COLUMNS = {
    "lqfp64.tsv": ("pin", "name", "type", "structure", "functions"),
    "nets.tsv": ("net", "volts", "what"),
    "parts.tsv": ("part", "block", "symbol", "value", "footprint", "article", "volts", "near", "answers", "why"),
    "netlist.tsv": ("part", "pin", "name", "type", "function", "program", "net", "volts", "why"),
}


class TableError(Exception):
    pass


@dataclass
class Net:
    name: str
    volts: float
    what: str
    pins: list = field(default_factory=list)


@dataclass
class Part:
    name: str
    block: str
    symbol: str
    value: str
    footprint: str
    article: str
    volts: float
    near: str
    answers: tuple
    why: str
    pins: list = field(default_factory=list)

    def pin(self, number):
        return next((pin for pin in self.pins if pin.number == str(number)), None)


@dataclass
class Pin:
    part: Part
    number: str
    name: str
    type: str
    function: str
    program: str
    net: Net  # None: not connected
    volts: float
    why: str

    def __str__(self):
        return f"{self.part.name}.{self.number} ({self.name})"


@dataclass
class PackagePin:
    name: str
    type: str
    structure: str
    functions: dict  # name: number of the alternate function, or None


@dataclass
class Board:
    parts: dict
    nets: dict
    package: dict  # number: PackagePin

    @property
    def pins(self):
        return [pin for part in self.parts.values() for pin in part.pins]

    def pin(self, name):
        """name: for example U1.19."""
        part, _, number = name.partition(".")
        return self.parts[part].pin(number) if part in self.parts else None


def quoted(text):
    return ascii(text if len(text) <= 40 else text[:40] + "...")


class Rows:
    """The rows of one table, each a dictionary of its cells."""

    def __init__(self, folder, name):
        self.path, self.columns = Path(folder) / name, COLUMNS[name]
        self.line = 0

    def fail(self, found, expected):
        place = f"{self.path}:{self.line}" if self.line else str(self.path)
        raise TableError(f"{place}: found {found}, expected {expected}")

    def __iter__(self):
        try:
            data = self.path.read_bytes()
        except OSError as error:
            self.fail(f"no readable file ({error.strerror})", f"the table {self.path.name}")
        header = None
        rows = 0
        for self.line, raw in enumerate(data.removesuffix(b"\n").split(b"\n") if data else [], 1):
            try:
                text = raw.decode()
            except UnicodeDecodeError as error:
                self.fail(f"byte 0x{raw[error.start]:02x}", "text in UTF-8")
            for character in text:
                if character != "\t" and not character.isprintable():
                    self.fail(f"character U+{ord(character):04X}", "text")
            if text.startswith("#"):
                continue
            cells = text.split("\t")
            if header is None:
                header = cells
                for wanted in self.columns:
                    if wanted not in cells:
                        self.fail(f"no column {wanted}", "the columns " + ", ".join(self.columns))
                if tuple(cells) != self.columns:
                    self.fail("the columns " + quoted(", ".join(cells)), ", ".join(self.columns))
                continue
            if len(cells) != len(self.columns):
                self.fail(f"{len(cells)} cells", f"{len(self.columns)}, divided by tabs")
            for column, cell in zip(self.columns, cells):
                if not cell or cell != cell.strip() or "  " in cell:
                    self.fail(f"{column} {quoted(cell)}", "a cell without blanks around it, or -")
            rows += 1
            yield dict(zip(self.columns, cells))
        self.line = 0
        if header is None:
            self.fail("no row", "the columns " + ", ".join(self.columns))
        if not rows:
            self.fail("no row below the columns", "at least one")

    def number(self, cell, name):
        if not re.fullmatch(r"\d{1,4}(\.\d{1,2})?", cell):
            self.fail(f"{name} {quoted(cell)}", "a voltage in V, for example 3.3")
        return float(cell)

    def one_of(self, cell, name, known):
        if cell not in known:
            self.fail(f"{name} {quoted(cell)}", "one of " + ", ".join(known))
        return cell

    def word(self, cell, name, pattern, example):
        if not re.fullmatch(pattern, cell):
            self.fail(f"{name} {quoted(cell)}", f"a name, for example {example}")
        return cell

    def new(self, name, what, known):
        if name in known:
            self.fail(f"{what} {name} a second time", "each once")
        return name


def read_package(folder):
    rows, package = Rows(folder, "lqfp64.tsv"), {}
    for row in rows:
        number = rows.new(rows.word(row["pin"], "pin", r"[1-9]\d?", "19"), "pin", package)
        functions = {}
        for text in row["functions"].split(" ") if row["functions"] != NONE else ():
            name, equals, alternate = text.partition("=")
            if not re.fullmatch(r"[A-Z][A-Z0-9_]*", name) or (equals and not re.fullmatch(r"\d|1[0-5]", alternate)):
                rows.fail(f"function {quoted(text)}", "for example CAN1_RX=9")
            functions[rows.new(name, "function", functions)] = int(alternate) if equals else None
        package[number] = PackagePin(row["name"], rows.one_of(row["type"], "type", ("S", "I", "I/O")),
                                     rows.one_of(row["structure"], "structure", STRUCTURES), functions)
    return package


def read_board(folder):
    board = Board({}, {}, read_package(folder))
    rows = Rows(folder, "nets.tsv")
    for row in rows:
        name = rows.new(rows.word(row["net"], "net", r"[A-Z0-9][A-Z0-9_]*", "CAN_H"), "net", board.nets)
        board.nets[name] = Net(name, rows.number(row["volts"], "volts"), row["what"])
    rows = Rows(folder, "parts.tsv")
    for row in rows:
        name = rows.new(rows.word(row["part"], "part", r"[A-Z]{1,2}[1-9]\d*", "R1"), "part", board.parts)
        answers = tuple(rows.one_of(answer, "answers", QUESTIONS) for answer in row["answers"].split(","))
        rows.word(row["footprint"], "footprint", r"[\w.-]+:[\w.-]+", "Resistor_SMD:R_0603_1608Metric")
        if row["near"] != NONE:
            rows.word(row["near"], "near", r"[A-Z]{1,2}\d+\.\d+", "U1.19")
        board.parts[name] = Part(name, rows.one_of(row["block"], "block", BLOCKS), rows.one_of(row["symbol"], "symbol", SYMBOLS),
                                 row["value"], row["footprint"], row["article"], rows.number(row["volts"], "volts"), row["near"],
                                 answers, row["why"])
    rows = Rows(folder, "netlist.tsv")
    for row in rows:
        if row["part"] not in board.parts:
            rows.fail(f"part {quoted(row['part'])}", "a part of parts.tsv")
        part = board.parts[row["part"]]
        number = rows.word(row["pin"], "pin", r"[1-9]\d?", "2")
        rows.new(f"{part.name}.{number}", "pin", [f"{part.name}.{pin.number}" for pin in part.pins])
        if row["net"] != NONE and row["net"] not in board.nets:
            rows.fail(f"net {quoted(row['net'])}", "a net of nets.tsv, or -")
        net = board.nets.get(row["net"])
        volts = part.volts if row["volts"] == NONE else rows.number(row["volts"], "volts")
        pin = Pin(part, number, row["name"], rows.one_of(row["type"], "type", TYPES), row["function"],
                  rows.one_of(row["program"], "program", ("now", "later", NONE)), net, volts, row["why"])
        part.pins.append(pin)
        if net:
            net.pins.append(pin)
    return board

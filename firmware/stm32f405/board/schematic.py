"""Writes the tables as a schematic for KiCad 6: symbols in it, global labels for the nets, the same bytes each time.

Lengths are in units of 0.01 mm. In a symbol y points up, on the sheet down."""

import uuid

from tables import BLOCKS, TWO_PINS

FORMAT = 20211123
SHEET = "A2"
GRID = 127
LEFT, TOP = 14 * GRID, 24 * GRID
COLUMN, ROW = 54 * GRID, 8 * GRID
COLUMNS = 8
LAYOUT = {"supply": (0,), "chip": (1, 2), "can": (3,), "servo": (4, 5), "sensors": (6, 7), "connectors": (3,)}  # block: its columns
TITLES = {"supply": "Supply", "chip": "Chip: supply, clock, reset, boot", "can": "CAN", "servo": "Servo: current, switch, pulses",
          "sensors": "Sensors, console", "connectors": "Connectors"}
NAMES = uuid.uuid5(uuid.NAMESPACE_URL, "proleg/firmware/stm32f405/board")
FONT = "(effects (font (size 1.27 1.27)))"
HIDDEN = "(effects (font (size 1.27 1.27)) hide)"
LINE = "(stroke (width 0.254) (type default) (color 0 0 0 0))"


def mm(value):
    text = f"{value / 100:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def identity(name):
    return str(uuid.uuid5(NAMES, name))


def quote(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def rectangle(left, top, right, bottom, fill="none"):
    return f"(rectangle (start {mm(left)} {mm(top)}) (end {mm(right)} {mm(bottom)}) {LINE} (fill (type {fill})))"


def polyline(*points, fill="none"):
    return f"(polyline (pts {' '.join(f'(xy {mm(x)} {mm(y)})' for x, y in points)}) {LINE} (fill (type {fill})))"


def circle(x, y, radius):
    return f"(circle (center {mm(x)} {mm(y)}) (radius {mm(radius)}) {LINE} (fill (type none)))"


DIODE = (polyline((127, 127), (127, -127), (-127, 0), (127, 127)), polyline((-254, 0), (254, 0)))
DRAWINGS = {
    "resistor": (rectangle(-254, 102, 254, -102),),
    "ferrite": (rectangle(-254, 102, 254, -102, "outline"),),
    "fuse": (rectangle(-254, 102, 254, -102), polyline((-254, 0), (254, 0))),
    "capacitor": (polyline((-64, 190), (-64, -190)), polyline((64, 190), (64, -190)), polyline((-254, 0), (-64, 0)),
                  polyline((64, 0), (254, 0))),
    "polarised": (rectangle(-102, 190, -38, -190), polyline((64, 190), (64, -190)), polyline((-254, 0), (-102, 0)),
                  polyline((64, 0), (254, 0)), polyline((-220, 90), (-140, 90)), polyline((-180, 130), (-180, 50))),
    "diode": (*DIODE, polyline((-127, 127), (-127, -127))),
    "schottky": (*DIODE, polyline((-64, 64), (-64, 127), (-127, 127), (-127, -127), (-190, -127), (-190, -64))),
    "tvs": (*DIODE, polyline((-64, 127), (-127, 127), (-127, -127), (-190, -127))),
    "led": (*DIODE, polyline((-127, 127), (-127, -127)), polyline((0, 180), (-90, 240)), polyline((90, 180), (0, 240))),
    "crystal": (rectangle(-76, 152, 76, -152), polyline((-140, 127), (-140, -127)), polyline((140, 127), (140, -127)),
                polyline((-254, 0), (-140, 0)), polyline((140, 0), (254, 0))),
    "switch": (circle(-203, 0, 51), circle(203, 0, 51), polyline((-165, 40), (190, 150))),
    "jumper": (circle(-203, 0, 51), circle(203, 0, 51), polyline((-152, 90), (0, 150), (152, 90))),
    "pad": (circle(-150, 0, 100),),
}
PREFIX = {"resistor": "R", "ferrite": "FB", "fuse": "F", "capacitor": "C", "polarised": "C", "diode": "D", "schottky": "D",
          "tvs": "D", "led": "D", "crystal": "Y", "switch": "SW", "jumper": "JP", "pad": "TP"}


def pin_text(kind, x, y, angle, length, name, number):
    return (f"(pin {kind} line (at {mm(x)} {mm(y)} {angle}) (length {mm(length)}) "
            f"(name {quote(name)} {FONT}) (number {quote(number)} {FONT}))")


def properties(reference, value, footprint, x, y, above, below, more=()):
    rows = [("Reference", reference, y - above, FONT), ("Value", value, y + below, FONT), ("Footprint", footprint, y, HIDDEN),
            ("Datasheet", "~", y, HIDDEN), *((name, text, y, HIDDEN) for name, text in more)]
    return [f"(property {quote(name)} {quote(text)} (id {number}) (at {mm(x)} {mm(place)} 0) {effects})"
            for number, (name, text, place, effects) in enumerate(rows)]


class Shape:
    """A symbol: its drawing, and where its pins are. places: number of the pin: (x, y, side)."""

    def __init__(self, name, prefix, drawing, pins, width, height, hides_names):
        self.name, self.width, self.height = name, width, height
        self.places = {number: (x, y, side) for number, _, _, x, y, side, _ in pins}
        top = [f'(symbol "Proleg:{name}" {"(pin_numbers hide) " if hides_names else ""}'
               f'(pin_names (offset {mm(0 if hides_names else 76)}){" hide" if hides_names else ""}) (in_bom yes) (on_board yes)']
        for row in properties(prefix, name, "", 0, 0, height // 2 + 127, height // 2 + 127):
            top.append("  " + row)
        top.append(f'  (symbol "{name}_0_1" {" ".join(drawing)})')
        top.append(f'  (symbol "{name}_1_1"')
        for number, label, kind, x, y, side, length in pins:
            top.append("    " + pin_text(kind, x, y, 0 if side < 0 else 180, length, label, number))
        self.text = "\n".join([*top, "  )", ")"])


def two_pins(symbol):
    pins = [(str(index + 1), name, "passive", -508 if index == 0 else 508, 0, -1 if index == 0 else 1, 254)
            for index, name in enumerate(TWO_PINS[symbol])]
    return Shape(symbol, PREFIX[symbol], DRAWINGS[symbol], pins, 1016, 508, True)


def pad():
    return Shape("pad", "TP", DRAWINGS["pad"], [("1", "1", "passive", -508, 0, -1, 254)], 762, 508, True)


def box(name, prefix, left, right, width):
    """A rectangle with pins at its left and its right side."""
    rows = max(len(left), len(right))
    top = (rows - 1) * GRID  # pins are 2.54 mm apart
    top -= top % GRID
    pins = []
    for side, column in ((-1, left), (1, right)):
        for index, pin in enumerate(column):
            pins.append((pin.number, pin.name, pin.type, side * (width // 2 + 254), top - index * 2 * GRID, side, 254))
    low = top - (rows - 1) * 2 * GRID
    return Shape(name, prefix, (rectangle(-width // 2, top + 254, width // 2, low - 254, "background"),), pins, width + 508,
                 top - low + 508, False)


# The chip's symbol: supply, reset and boot, clock, analog, and the pins for a later program at the left; signals of the program
# and free pins at the right.
AT_THE_LEFT = ("VDD", "VBAT", "VDDA", "VCAP_1", "VCAP_2", "VSS", "VSSA", "NRST", "BOOT0", "PB2", "PH0", "PH1", "PC0", "PC1", "PC2", "PC3")


def chip_sides(part):
    first = sorted((pin for pin in part.pins if pin.name in AT_THE_LEFT), key=lambda pin: AT_THE_LEFT.index(pin.name))
    later = [pin for pin in part.pins if pin.program == "later" and pin not in first]
    signals = [pin for pin in part.pins if pin.net and pin not in first and pin not in later]
    free = [pin for pin in part.pins if not pin.net]
    left = first + later
    at_left = max(0, min(len(free), len(part.pins) // 2 - len(left)))
    return left + free[:at_left], signals + free[at_left:]


def shape_of(part):
    if part.symbol in TWO_PINS:
        return two_pins(part.symbol)
    if part.symbol == "pad":
        return pad()
    prefix = part.name.rstrip("0123456789")
    if part.symbol == "connector":
        return box(f"connector_{part.name}", prefix, part.pins, [], 10 * GRID)
    if part.symbol == "chip":
        return box(part.value, prefix, *chip_sides(part), 24 * GRID)
    half = (len(part.pins) + 1) // 2
    # Counter-clockwise, as the pins of the package.
    return box(part.value, prefix, part.pins[:half], part.pins[half:][::-1], 12 * GRID)


class Sheet:
    def __init__(self):
        self.shapes, self.items, self.instances = {}, [], []

    def shape(self, part):
        shape = shape_of(part)
        return self.shapes.setdefault(shape.name, shape)

    def text(self, text, x, y, size):
        self.items.append(f"(text {quote(text)} (at {mm(x)} {mm(y)} 0) (effects (font (size {size} {size}) bold) (justify left bottom))"
                          f" (uuid {identity('text ' + text)}))")

    def label(self, net, name, x, y, side):
        """A short wire from a pin, and the label of its net."""
        end = x + side * 2 * GRID
        self.items.append(f"(wire (pts (xy {mm(x)} {mm(y)}) (xy {mm(end)} {mm(y)})) (stroke (width 0) (type default) (color 0 0 0 0))"
                          f" (uuid {identity('wire ' + name)}))")
        self.items.append(f"(global_label {quote(net)} (shape passive) (at {mm(end)} {mm(y)} {180 if side < 0 else 0}) (fields_autoplaced)"
                          f" (effects (font (size 1.27 1.27)) (justify {'right' if side < 0 else 'left'}))"
                          f" (uuid {identity('label ' + name)}))")

    def place(self, reference, value, footprint, shape, x, y, pins, more=()):
        """pins: number: net or None."""
        own = identity("symbol " + reference)
        flag = reference.startswith("#")
        edge = shape.height // 2 + (64 if shape.height <= 508 else 150)
        rows = properties(reference, value, footprint, x, y, edge, edge, more)
        if flag:
            rows = [row.replace(FONT, HIDDEN) for row in rows]
        for number, net in pins.items():
            place_x, place_y, side = shape.places[number]
            if net is None:
                self.items.append(f"(no_connect (at {mm(x + place_x)} {mm(y - place_y)}) (uuid {identity(f'open {reference}.{number}')}))")
            else:
                self.label(net, f"{reference}.{number}", x + place_x, y - place_y, side)
        numbers = " ".join(f'(pin "{number}" (uuid {identity(f"pin {reference}.{number}")}))' for number in pins)
        known = "no" if flag else "yes"
        self.items.append("\n".join([f'(symbol (lib_id "Proleg:{shape.name}") (at {mm(x)} {mm(y)} 0) (unit 1) (in_bom {known}) (on_board {known})',
                                     f"  (uuid {own})", *("  " + row for row in rows), "  " + numbers, ")"]))
        self.instances.append((own, reference, value, footprint))


def snap(value):
    return value - value % GRID


def height(shape):
    return ROW if shape.height <= 508 else snap(shape.height + 8 * GRID)


def place(sheet, part, shape, x, y):
    sheet.place(part.name, part.value, part.footprint, shape, snap(x), snap(y),
                {pin.number: pin.net.name if pin.net else None for pin in part.pins}, (("Article", part.article), ("Block", part.block)))


def flags(board):
    """Nets with supply pins and no part that supplies them by KiCad's rules: each gets a flag."""
    for net in board.nets.values():
        kinds = {pin.type for pin in net.pins}
        if "power_in" in kinds and "power_out" not in kinds:
            yield net.name


def write(board):
    sheet = Sheet()
    blocks = {block: [part for part in board.parts.values() if part.block == block] for block in BLOCKS}
    ends = [TOP] * COLUMNS  # how far each column is used
    for block in BLOCKS:
        columns = LAYOUT[block]
        top = max(ends[column] for column in columns)
        if top > TOP:
            top += 12 * GRID
        sheet.text(TITLES[block], LEFT + columns[0] * COLUMN + 2 * GRID, top - 8 * GRID, 3)
        parts = blocks[block]
        for part in parts:
            if part.symbol == "chip":
                shape = sheet.shape(part)
                place(sheet, part, shape, LEFT + columns[0] * COLUMN + len(columns) * COLUMN // 2, top + shape.height // 2)
                top += shape.height + 8 * GRID
        parts = [part for part in parts if part.symbol != "chip"]
        share = sum(height(sheet.shape(part)) for part in parts) / len(columns)
        index, y = 0, top
        for part in parts:
            if y - top >= share and index + 1 < len(columns):
                index, y = index + 1, top
            shape = sheet.shape(part)
            place(sheet, part, shape, LEFT + columns[index] * COLUMN + COLUMN // 2, y + height(shape) // 2)
            y += height(shape)
            ends[columns[index]] = y
        if block == "supply":
            flag = sheet.shapes.setdefault("flag", Shape("flag", "#FLG", (polyline((-254, 100), (-100, 0), (-254, -100), (-400, 0), (-254, 100)),
                                                                         polyline((-100, 0), (0, 0))),
                                                         [("1", "supply", "power_out", 0, 0, 1, 0)], 508, 254, True))
            for number, net in enumerate(flags(board), 1):
                sheet.place(f"#FLG{number:02}", "supplied", "", flag, snap(LEFT + COLUMN // 2), snap(y + ROW // 2), {"1": net})
                y += ROW
            ends[columns[0]] = y
    lines = [f"(kicad_sch (version {FORMAT}) (generator proleg)", "",
             f"  (uuid {identity('sheet')})", f'  (paper "{SHEET}")', "  (title_block",
             '    (title "Proleg joint module, reference board")', '    (rev "1")',
             '    (comment 1 "Made from firmware/stm32f405/board/*.tsv; nobody has built it yet")', "  )", "  (lib_symbols"]
    for shape in sheet.shapes.values():
        lines += ["    " + line for line in shape.text.split("\n")]
    lines.append("  )")
    for item in sheet.items:
        lines += ["  " + line for line in item.split("\n")]
    lines.append('  (sheet_instances (path "/" (page "1")))')
    lines.append("  (symbol_instances")
    for own, reference, value, footprint in sheet.instances:
        lines.append(f'    (path "/{own}" (reference {quote(reference)}) (unit 1) (value {quote(value)}) (footprint {quote(footprint)}))')
    return "\n".join([*lines, "  )", ")"]) + "\n"

"""The tables of docs/board.md, made from the tables of the board."""

import re

from tables import BLOCKS

TITLES = {"supply": "supply", "chip": "chip", "can": "CAN", "servo": "servo", "sensors": "sensors", "connectors": "connectors"}


class PageError(Exception):
    pass


def table(head, rows):
    return "\n".join(["| " + " | ".join(row) + " |" for row in (head, ["---"] * len(head), *rows)])


def order(name):
    return re.sub(r"\d+", "", name), int(re.sub(r"\D+", "", name) or 0)


def pins(board):
    rows = []
    chip = [part for part in board.parts.values() if part.symbol == "chip"][0]
    for program in ("now", "later"):
        for pin in sorted((pin for pin in chip.pins if pin.program == program), key=lambda pin: order(pin.name)):
            alternate = board.package[pin.number].functions.get(pin.function)
            function = "-" if pin.function == "-" else pin.function + (f" (AF{alternate})" if alternate is not None else "")
            rows.append([pin.name, pin.number, function, pin.net.name, pin.why, "" if program == "now" else "for a later program"])
    free = ", ".join(pin.name for pin in sorted((pin for pin in chip.pins if not pin.net), key=lambda pin: order(pin.name)))
    return table(["pin", "LQFP64", "function", "net", "what", "program"], rows) + f"\n\nFree: {free}."


def supplies(board):
    rows = {}
    chip = [part for part in board.parts.values() if part.symbol == "chip"][0]
    for pin in chip.pins:
        if board.package[pin.number].type == "S":
            rows.setdefault((pin.name, pin.net.name, pin.why), []).append(pin)
    beside = {}
    for part in board.parts.values():
        if part.symbol == "capacitor" and part.near.startswith("U1."):
            beside.setdefault(part.near[3:], []).append(f"{part.name} {part.value}")
    return table(["pin", "LQFP64", "net", "what", "capacitors beside it"],
                 [[name, ", ".join(pin.number for pin in found), net, why, ", ".join(text for pin in found for text in beside.get(pin.number, ["-"])) if name != "VSS" else "-"]
                  for (name, net, why), found in rows.items()])


def connectors(board):
    rows = []
    for part in board.parts.values():
        if part.symbol == "connector":
            rows.append([part.name, part.value, "; ".join(f"{pin.number} {pin.name}" for pin in part.pins), part.article, part.why])
    return table(["connector", "what", "pins", "part", "note"], rows)


def parts(board):
    texts = []
    for block in BLOCKS:
        groups = {}
        for part in board.parts.values():
            if part.block == block:
                groups.setdefault((part.value, part.article, part.footprint, part.why), []).append(part.name)
        rows = [[", ".join(names), value, article, footprint.partition(":")[2], why]
                for (value, article, footprint, why), names in groups.items()]
        texts.append(f"**{TITLES[block][0].upper() + TITLES[block][1:]}**\n\n" + table(["parts", "value", "article", "footprint", "why"], rows))
    return "\n\n".join(texts)


TABLES = {"pins": pins, "supply pins": supplies, "connectors": connectors, "parts": parts}


def update(text, board, name):
    """The text of the page with all tables made anew."""
    for key, make in TABLES.items():
        begin, end = f"<!-- {key}: from firmware/stm32f405/board -->\n", f"<!-- end of {key} -->\n"
        if text.count(begin) != 1 or text.count(end) != 1 or text.index(begin) > text.index(end):
            raise PageError(f"{name}: found no place for the table {key}, expected the line {begin.strip()} and, behind it, {end.strip()}, each once")
        before, _, rest = text.partition(begin)
        _, _, after = rest.partition(end)
        text = before + begin + "\n" + make(board) + "\n\n" + end + after
    return text

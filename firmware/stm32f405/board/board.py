#!/usr/bin/env python3
"""The reference module as tables (lqfp64.tsv, nets.tsv, parts.tsv, netlist.tsv): checks them, and makes from them the tables of
docs/board.md and a schematic for KiCad 6."""

import argparse
import sys
from pathlib import Path

sys.dont_write_bytecode = True
FOLDER = Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER))

import pages  # noqa: E402
import rules  # noqa: E402
import schematic  # noqa: E402
import tables  # noqa: E402

SOURCE = FOLDER.parent.parent.parent
EXIT_FAILED, EXIT_BAD_INPUT = 1, 2


def has_faults(board):
    faults = rules.faults(board)
    for fault in faults:
        print(fault, file=sys.stderr)
    return bool(faults)


def check(board, options):
    if has_faults(board):
        return EXIT_FAILED
    print(f"{len(board.parts)} parts, {len(board.pins)} pins, {len(board.nets)} nets: no fault")
    return 0


def docs(board, options):
    if has_faults(board):
        return EXIT_FAILED
    try:
        old = options.page.read_text()
        new = pages.update(old, board, options.page)
    except OSError as error:
        raise tables.TableError(f"{options.page}: found no readable file ({error.strerror}), expected the page of the board") from None
    except (UnicodeDecodeError, pages.PageError) as error:
        raise tables.TableError(str(error)) from None
    if options.check:
        if new != old:
            line = next(number for number, (one, other) in enumerate(zip((old + "\n\n").split("\n"), (new + "\n\n").split("\n")), 1) if one != other)
            print(f"{options.page}:{line}: found a table that differs from firmware/stm32f405/board; run firmware/stm32f405/board/board.py docs",
                  file=sys.stderr)
            return EXIT_FAILED
        return 0
    options.page.write_text(new)
    return 0


def draw(board, options):
    if has_faults(board):
        return EXIT_FAILED
    options.file.parent.mkdir(parents=True, exist_ok=True)
    options.file.write_text(schematic.write(board))
    print(options.file)
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tables", type=Path, default=FOLDER, metavar="FOLDER", help="other tables than those of the reference module")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    command = commands.add_parser("check", help="applies the rules to the tables")
    command.set_defaults(run=check)
    command = commands.add_parser("docs", help="writes the tables of docs/board.md")
    command.add_argument("--check", action="store_true", help="writes nothing; fails if they differ")
    command.add_argument("--page", type=Path, default=SOURCE / "docs/board.md")
    command.set_defaults(run=docs)
    command = commands.add_parser("schematic", help="writes a schematic for KiCad 6")
    command.add_argument("file", type=Path, nargs="?", default=SOURCE / "build/board/proleg_module.kicad_sch")
    command.set_defaults(run=draw)
    options = parser.parse_args()
    try:
        return options.run(tables.read_board(options.tables), options)
    except tables.TableError as error:
        print(error, file=sys.stderr)
        return EXIT_BAD_INPUT


if __name__ == "__main__":
    sys.exit(main())

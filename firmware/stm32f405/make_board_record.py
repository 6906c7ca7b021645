#!/usr/bin/env python3
"""Writes the contents of sectors 1 and 2 of a new module's flash: one board record, as docs/board.md and
firmware/module/board_record.hpp describe it. 32 KiB, to be flashed at 0x08004000."""

import argparse
import pathlib
import struct
import sys
import zlib

SCHEMA_VERSION = 1
SECTORS = 32 * 1024


def number(name, minimum, maximum):
    def convert(text):
        if not text.isdecimal() or not minimum <= int(text) <= maximum:
            raise argparse.ArgumentTypeError(f"{name}: found {text}, expected {minimum} to {maximum}")
        return int(text)
    return convert


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--node", type=number("node id", 1, 126), required=True, help="node id, 1 to 126")
    # 4095 is BoardRecord::max_reading of firmware/module/board_record.hpp.
    parser.add_argument("--feedback", type=number("reading", 0, 4095), nargs=2, metavar=("AT_MINUS_90", "AT_PLUS_90"),
                        help="a feedback potentiometer is fitted: what the ADC reads at -90 and +90 degrees")
    parser.add_argument("output", type=pathlib.Path)
    options = parser.parse_args()
    minus, plus = options.feedback or (0, 0)
    if options.feedback and minus == plus:
        parser.error(f"--feedback: found {minus} twice, expected two different readings")
    record = struct.pack("<IBBBBHH16x", 1, SCHEMA_VERSION, options.node, 1 if options.feedback else 0, 0, minus, plus)
    record += struct.pack("<I", zlib.crc32(record))
    options.output.write_bytes(record.ljust(SECTORS, b"\xff"))
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Writes the contents of sectors 2 and 3 of a new module's flash: one board record, as docs/board.md and
firmware/module/board_record.hpp describe it. 32 KiB, to be flashed at 0x08008000."""

import argparse
import pathlib
import struct
import sys
import zlib

SCHEMA_VERSION = 2
SECTORS = 32 * 1024
FLAG_FEEDBACK = 1
FLAG_GATEWAY = 2


def number(name, minimum, maximum):
    def convert(text):
        if not text.removeprefix("-").isdecimal() or not minimum <= int(text) <= maximum:
            raise argparse.ArgumentTypeError(f"{name}: found {text}, expected {minimum} to {maximum}")
        return int(text)
    return convert


def angle(degrees):
    """Converts degrees to 90 degrees = 2^30, rounded to the nearest."""
    return (degrees * 2**31 + 90) // 180


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--node", type=number("node id", 1, 126), required=True, help="node id, 1 to 126")
    # 4095 is BoardRecord::max_reading of firmware/module/board_record.hpp.
    parser.add_argument("--feedback", type=number("reading", 0, 4095), nargs=2, metavar=("AT_MINUS_90", "AT_PLUS_90"),
                        help="a feedback potentiometer is fitted: what the ADC reads at -90 and +90 degrees")
    parser.add_argument("--gateway", action="store_true", help="the module connects the host to the bus")
    parser.add_argument("--limits", type=number("angle", -90, 90), nargs=2, metavar=("LOWEST", "HIGHEST"),
                        default=[-90, 90], help="joint angles that the mechanics allow, in degrees; 0 is one of them")
    parser.add_argument("--current", type=number("value", 0, 65535), nargs=2, metavar=("MA", "MS"),
                        default=[2000, 500], help="over-current: limit in mA (0: off, at most 32767), time in ms")
    parser.add_argument("output", type=pathlib.Path)
    options = parser.parse_args()
    minus, plus = options.feedback or (0, 0)
    if options.feedback and minus == plus:
        parser.error(f"--feedback: found {minus} twice, expected two different readings")
    lowest, highest = options.limits
    if not lowest <= 0 <= highest:
        parser.error(f"--limits: found {lowest} to {highest}, expected a range with 0, the safe pose")
    if options.current[0] > 32767:
        parser.error(f"--current: found {options.current[0]}, expected at most 32767 mA")
    flags = (FLAG_FEEDBACK if options.feedback else 0) | (FLAG_GATEWAY if options.gateway else 0)
    record = struct.pack("<IBBBBHHiiHH4x", 1, SCHEMA_VERSION, options.node, flags, 0, minus, plus, angle(lowest),
                         angle(highest), *options.current)
    record += struct.pack("<I", zlib.crc32(record))
    options.output.write_bytes(record.ljust(SECTORS, b"\xff"))
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Prints the flash, RAM and stack that an image needs, and writes them as a table. Fails if the stack can overflow.

The worst case of the stack: reset_handler (with all that the start calls), on it the worst interrupt of each priority,
and an exception frame for each. The bounds come from tools/stack_bound.
"""

import argparse
import pathlib
import subprocess
import sys

# An exception frame: eight words and one to align (PM0214, section 2.3.7); the FPU is not used.
EXCEPTION_FRAME = 36
# Priorities of the module's program, which firmware/stm32f405/hardware.cpp sets.
PRIORITIES = [["pend_sv_handler", "tim5_handler", "dma1_stream5_handler", "dma1_stream6_handler"], ["usart2_handler"],
              ["can1_tx_handler", "can1_rx0_handler", "can1_sce_handler", "pvd_handler"]]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("bounds", type=pathlib.Path, help="table of tools/stack_bound")
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("--nm", default="arm-none-eabi-nm")
    parser.add_argument("--priority", nargs="+", action="append", metavar="HANDLER",
                        help="the interrupts of one priority; default: those of the module's program")
    options = parser.parse_args()

    listing = subprocess.run([options.nm, str(options.program)], capture_output=True, text=True, check=True).stdout
    address = {fields[-1]: int(fields[0], 16) for fields in map(str.split, listing.splitlines()) if len(fields) == 3}
    bound = dict(line.split("\t") for line in options.bounds.read_text().splitlines())

    needed = int(bound["reset_handler"]) + sum(
        EXCEPTION_FRAME + max(int(bound[handler]) for handler in handlers) for handlers in options.priority or PRIORITIES)
    stack = address["stack_top"] - address["stack_bottom"]
    rows = {
        "flash": address["image_end"] - address["image_start"],
        "flash_limit": address["max_image_size"],
        "ram": address["ram_end"] - address["stack_top"],
        "ram_limit": address["max_ram_size"],
        "stack": stack,
        "stack_bound": needed,
    }
    options.output.write_text("".join(f"{name}\t{value}\n" for name, value in rows.items()))
    print(f"{options.program.stem}: {rows['flash']} bytes of {rows['flash_limit']} in flash; RAM: {rows['ram']} "
          f"static and {stack} stack, of {rows['ram_limit']}; stack at worst: {needed}")
    if needed > stack:
        print(f"{options.program.name}: found a stack of {stack} bytes, expected the {needed} that it can need at worst",
              file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

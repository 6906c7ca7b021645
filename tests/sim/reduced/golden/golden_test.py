"""golden_test.py [--starter PROGRAM] [--contracted KERNEL] PROGRAM STEPS [SIZE]...: what PROGRAM, a build of reduced_golden,
computes is in golden.tsv, to the last bit, with each kernel that the processor has and in batches of all sizes.

--starter     runs PROGRAM, which is for another processor
--contracted  in this build the named kernel fuses multiplications and additions: it must give other bits
"""

import argparse
import re
import subprocess
import sys
from pathlib import Path

GOLDEN = Path(__file__).parent / "golden.tsv"
SIZES = [1, 2, 3, 7, 16, 64]
BASE = "SSE2 or NEON"
CHAINS = ["plane", "space"]


def read_golden(steps):
    """The rows with this number of steps, by kind of chains. Also checks that the chains do what the proof is about."""
    heading, *rows = [line.split("\t") for line in GOLDEN.read_text().splitlines()]
    result = {}
    for number, row in enumerate(rows, 2):
        found = dict(zip(heading, row))
        if found["steps"] == str(steps):
            if found["failures"] != "0" or "0" in (found["on_terrain"], found["on_itself"], found["weak_motors"]):
                sys.exit(f"{GOLDEN}:{number}: found {row}, expected contacts of each kind, weak motors and no failures")
            result[found["chains"]] = row[1:]
    if sorted(result) != sorted(CHAINS):
        sys.exit(f"{GOLDEN}: found rows for {steps} steps of {sorted(result)}, expected {CHAINS}")
    return result


def flags():
    """Of this computer's processor."""
    return set(" ".join(re.findall(r"^flags\s*:(.*)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE)).split())


def kernels(starter):
    if starter:
        return [BASE]
    return [BASE, *(name for flag, name in (("avx2", "AVX2"), ("avx512f", "AVX-512")) if flag in flags())]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--starter")
    parser.add_argument("--contracted")
    parser.add_argument("program")
    parser.add_argument("steps", type=int)
    parser.add_argument("sizes", type=int, nargs="*")
    options = parser.parse_args()
    if options.contracted and not options.starter and "fma" not in flags():
        print("not run: this processor has no instructions that fuse a multiplication and an addition")
        return 0

    command = [options.program, str(options.steps), *map(str, options.sizes)]
    if options.starter:
        command.insert(0, options.starter)
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        sys.exit(f"{' '.join(command)}: found exit status {result.returncode}, expected 0\n{result.stderr}")
    found = {tuple(line.split("\t")[:3]): line.split("\t")[3:] for line in result.stdout.splitlines()}
    golden = read_golden(options.steps)

    expected = [(kernel, str(size), chains) for kernel in kernels(options.starter)
                for size in options.sizes or SIZES for chains in CHAINS]
    if sorted(found) != sorted(expected):
        sys.exit(f"{options.program}: found lines for {sorted(found)}, expected {sorted(expected)}")
    if options.contracted and options.contracted not in kernels(options.starter):
        sys.exit(f"found no kernel {options.contracted}, expected one of {kernels(options.starter)}")
    errors = 0
    for (kernel, size, chains), row in found.items():
        name = f"{kernel}, batches of {size}, chains in {chains}"
        if kernel == options.contracted:
            if row[-1] == golden[chains][-1]:
                print(f"{name}: found the golden hash, expected another one with fused operations")
                errors += 1
        elif row != golden[chains]:
            print(f"{name}: found {row}, expected {golden[chains]} of {GOLDEN}. If the change is meant: "
                  f"build/host/bin/reduced_golden --write-golden tests/sim/reduced/golden/golden.tsv")
            errors += 1
    print(f"{len(found)} runs of {options.steps} steps, {errors} wrong")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())

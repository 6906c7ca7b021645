#!/usr/bin/env python3
"""Prints what `proleg drive --bus sim:FILE --fast` costs, as a multiple of `proleg simulate`: processor time, both in
turns, because the speed of a computer changes.

usage: tests/bench/drive_cost.py BUILD_FOLDER [SECONDS [RUNS]], e.g. tests/bench/drive_cost.py build/host
"""

import resource
import statistics
import subprocess
import sys
from pathlib import Path

SCENARIO = Path(__file__).resolve().parents[2] / "sim/scenarios/travelling_wave/uniform.simulation.xml"


def processor_time(command):
    """Of the command and its children, in seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def main():
    if not 2 <= len(sys.argv) <= 4:
        sys.exit(__doc__)
    programs = Path(sys.argv[1]) / "bin"
    seconds = sys.argv[2] if len(sys.argv) > 2 else "60"
    runs = int(sys.argv[3]) if len(sys.argv) > 3 else 12
    simulate = [programs / "proleg-simulate", SCENARIO, "--seconds", seconds]
    drive = [programs / "proleg-drive", SCENARIO, "--bus", f"sim:{SCENARIO}", "--fast", "--seconds", seconds]
    times = [(processor_time(simulate), processor_time(drive)) for _ in range(runs)]
    ratios = [driven / simulated for simulated, driven in times]
    print(f"{seconds} s of the gait, {runs} runs of each; processor time in seconds")
    print(f"simulate        {statistics.median(simulated for simulated, _ in times):6.2f}  (median)")
    print(f"drive --fast    {statistics.median(driven for _, driven in times):6.2f}")
    print(f"ratio           {statistics.median(ratios):6.3f}  (lowest {min(ratios):.3f}, highest {max(ratios):.3f})")


if __name__ == "__main__":
    main()

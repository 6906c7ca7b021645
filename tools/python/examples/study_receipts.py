"""A study that a reviewer can repeat from its receipts: how far the caterpillar comes with each amplitude and phase difference.

    study_receipts.py FOLDER           makes the study: the scenario, study.tsv with the numbers, study.receipts
    study_receipts.py --check FOLDER   repeats every run on another computer, with another processor, and compares

A receipt is a run in one line (`proleg receipt`): the hash of the scenario's files, the options, a measure, and the hash of the motion.
It needs the program `proleg` in PATH.
"""

import itertools
import subprocess
import sys
from pathlib import Path

import numpy as np
import proleg

NAMES = ["amplitude", "phase_difference"]
GRID = list(itertools.product([20, 40, 60], [60, 90, 120]))
SECONDS = 10


def receipt(*words):
    """What `proleg receipt` prints; ends the program with its message if it fails."""
    done = subprocess.run(["proleg", "receipt", *words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.stderr or done.stdout)
    return done.stdout.strip()


def words_of(line):
    return dict(word.split("=", 1) for word in line.split()[1:] if not word.startswith("set="))


def make(folder):
    folder.mkdir(parents=True, exist_ok=True)
    scenario = proleg.Scenario("caterpillar", engine="reduced")
    scenario.duration = SECONDS
    file = scenario.save(folder / "study.simulation.xml", replace=True)
    distances = proleg.evaluate(file, NAMES, GRID)
    lines = []
    for values, distance in zip(GRID, distances):
        settings = [f"--set={name}={value}" for name, value in zip(NAMES, values)]
        line = receipt(file, *settings)
        if float(words_of(line)["distance"]) != distance:
            sys.exit(f"{line}: found another distance, expected {distance!r}")
        lines.append(line)
    (folder / "study.receipts").write_text("\n".join(lines) + "\n")
    np.savetxt(folder / "study.tsv", np.column_stack([GRID, distances]), fmt=["%g", "%g", "%.17g"], delimiter="\t",
               header="\t".join([*NAMES, "distance"]), comments="")
    print(f"{len(lines)} runs; the best one crawls {distances.max():.2f} m")


def check(folder):
    table = np.genfromtxt(folder / "study.tsv", skip_header=1)
    lines = (folder / "study.receipts").read_text().splitlines()
    for row, line in zip(table, lines, strict=True):
        receipt("check", str(folder / "study.simulation.xml"), line)  # simulates the run, and compares its whole motion
        scenario = proleg.Scenario(folder / "study.simulation.xml", engine="reduced")
        for name, value in zip(NAMES, row):
            scenario[name] = value
        run = proleg.simulate(scenario, keep=())
        if run.world_hash != words_of(line)["world"] or run.measures["distance"] != row[-1]:
            sys.exit(f"{line}: the table says something else: {row}")
    print(f"{len(lines)} runs are repeated to the last bit")


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "--check":
        check(Path(sys.argv[2]))
    elif len(sys.argv) == 2:
        make(Path(sys.argv[1]))
    else:
        sys.exit(__doc__)

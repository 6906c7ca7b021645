#!/usr/bin/env python3
"""Prints how much of a map of gaits MAP-Elites, random search and CMA-ES fill with the same number of evaluations: coverage and QD
score, mean and standard deviation over some seeds. The map is that of sim/scenarios/travelling_wave/gait_map.optimise.xml, in the
reduced engine. CMA-ES searches for the distance alone (cma_es.optimise.xml, which starts again and again); the map is filled with all
its evaluations afterwards, as with those of the others. A search of 100000 evaluations takes about 20 minutes on two cores, and 15 of
them hours: --keep writes the figures of each into a file, and does not make those again that it finds there.

usage: tests/bench/atlas_figures.py BUILD_FOLDER [--evaluations N] [--seeds K] [--seconds S] [--keep FILE] [--json],
e.g. tests/bench/atlas_figures.py build/host --evaluations 10000 --seeds 5
"""

import argparse
import csv
import json
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path

SCENARIOS = Path(__file__).resolve().parents[2] / "sim/scenarios/travelling_wave"
METHODS = ("MAP-Elites", "random search", "CMA-ES")


def axes_of(file):
    """(measure, lowest, highest, cells) of each axis."""
    return [(axis.get("measure"), float(axis.get("lowest")), float(axis.get("highest")), int(axis.get("cells")))
            for axis in ElementTree.parse(file).getroot().iter("axis")]


def filled_map(folder, axes):
    """The best distance of each filled cell, from the table of all evaluations; by the definition in docs/optimisation-files.md."""
    best = {}
    with open(folder / "evaluations.tsv", newline="", encoding="utf-8") as table:
        for row in csv.DictReader(table, delimiter="\t"):
            measures = {name.split(" (")[0]: value for name, value in row.items()}
            values = [measures[axis[0]] for axis in axes]
            if row["failure"] or "" in values or float(measures["distance"]) == 0:
                continue
            cell = tuple(min(max(int((float(value) - lowest) / (highest - lowest) * cells), 0), cells - 1)
                         for value, (_, lowest, highest, cells) in zip(values, axes))
            best[cell] = max(float(measures["distance"]), best.get(cell, 0.0))
    return best


def write_files(folder, evaluations, seconds):
    """The experiments of the methods, each with room for all evaluations."""
    shutil.copytree(SCENARIOS, folder / "wave")
    wave = folder / "wave"
    if seconds:
        scenario = wave / "uniform.simulation.xml"
        scenario.write_text(re.sub(r"<duration>[^<]*</duration>", f"<duration>{seconds}</duration>", scenario.read_text()))
    text = (wave / "gait_map.optimise.xml").read_text()
    cma_es = (wave / "cma_es.optimise.xml").read_text()
    texts = {"MAP-Elites": text, "random search": re.sub(r"<first>\d+</first>", f"<first>{evaluations}</first>", text),
             "CMA-ES": re.sub(r"<generations>\d+</generations>", f"<generations>{evaluations}</generations>", cma_es)}
    files = {}
    for method in METHODS:
        files[method] = wave / f"{method.split('-')[0].split()[0].lower()}.optimise.xml"
        files[method].write_text(texts[method])
    return files


def search(proleg, file, folder, evaluations, seed):
    """The result of a search that makes so many evaluations."""
    result = subprocess.run([proleg, "optimise", file, "--engine", "reduced", "--evaluations", str(evaluations), "--seed", str(seed),
                             "--out", folder, "--json"], stdout=subprocess.PIPE, text=True, check=True)
    return json.loads(result.stdout)


def kept_figures(file):
    """The figures of searches that an earlier run has kept, by (method, seed, evaluations that were asked for, simulated seconds)."""
    kept = {}
    if file and file.exists():
        for line, text in enumerate(file.read_text().splitlines(), 1):
            try:
                row = json.loads(text)
                kept[tuple(row["search"])] = row["figures"]
            except (ValueError, KeyError, TypeError):
                sys.exit(f"{file}:{line}: found '{text[:40]}', expected a line that --keep has written")
    return kept


def figures(proleg, options):
    """For each method the figures of each seed: coverage, QD score, best distance, and number of evaluations."""
    found = {method: [] for method in METHODS}
    kept = kept_figures(options.keep)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files = write_files(folder, options.evaluations, options.seconds)
        axes = axes_of(files["MAP-Elites"])
        cells = 1
        for axis in axes:
            cells *= axis[3]
        for seed in range(1, options.seeds + 1):
            for method in METHODS:
                key = (method, seed, options.evaluations, options.seconds)
                if key in kept:
                    found[method].append(kept[key])
                    continue
                out = folder / f"{method}_{seed}"
                begin = time.monotonic()
                result = search(proleg, files[method], out, options.evaluations, seed)
                best = filled_map(out, axes)
                its = {"coverage": len(best) / cells, "qd_score": sum(best.values()), "best": max(best.values(), default=0.0),
                       "evaluations": result["evaluations"]}
                if "map" in result and (len(best) != result["map"]["filled"] or abs(its["qd_score"] - result["map"]["qd_score"]) > 1e-6):
                    sys.exit(f"atlas_figures: {method}, seed {seed}: the table has another map ({its}) than the result ({result['map']})")
                found[method].append(its)
                shutil.rmtree(out)
                if options.keep:
                    with options.keep.open("a", encoding="utf-8") as lines:
                        print(json.dumps({"search": key, "figures": its}), file=lines)
                print(f"{method}, seed {seed}: {result['evaluations']} evaluations in {time.monotonic() - begin:.0f} s, coverage "
                      f"{100 * its['coverage']:.1f} %, QD score {its['qd_score']:.1f}", file=sys.stderr, flush=True)
    return found


def text_of(values, factor, decimals):
    mean = factor * statistics.fmean(values)
    deviation = factor * statistics.stdev(values) if len(values) > 1 else 0.0
    return f"{mean:.{decimals}f} ± {deviation:.{decimals}f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--evaluations", type=int, default=10_000)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--seconds", type=float, help="simulated time of a run; default: that of the scenario")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="figures of finished searches, of one program and scenario")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    found = figures(options.build.resolve() / "bin/proleg", options)
    if options.json:
        print(json.dumps(found))
        return
    print(f"| {options.evaluations} evaluations, {options.seeds} seeds | coverage (%) | QD score | best distance (m) |")
    print("| --- | --- | --- | --- |")
    for method, its in found.items():
        print(f"| {method} | {text_of([run['coverage'] for run in its], 100, 1)} | {text_of([run['qd_score'] for run in its], 1, 1)} | "
              f"{text_of([run['best'] for run in its], 1, 3)} |")


main()

#!/usr/bin/env python3
"""proleg atlas: fills a map of gaits in the reduced engine, lets ODE judge some of its cells, and writes the scenario of any of them.

Usage: atlas_test.py SOURCE PROGRAM_FOLDER
"""

import csv
import json
import math
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
sys.path.append(str(Path(__file__).resolve().parents[2] / "support"))
from waiting import wait_until  # noqa: E402

SOURCE, PROGRAMS = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
WAVE = SOURCE / "sim/scenarios/travelling_wave"
CELLS = 25, 20


def proleg(*words):
    return subprocess.run([PROGRAMS / "proleg", *map(str, words)], capture_output=True, text=True, timeout=600)


def table(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file, delimiter="\t"))


class Atlas(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        shutil.copytree(WAVE, cls.folder / "wave")
        scenario = cls.folder / "wave/uniform.simulation.xml"
        scenario.write_text(re.sub(r"<duration>[^<]*</duration>", "<duration>2</duration>", scenario.read_text()))
        cls.file = cls.folder / "wave/gait_map.optimise.xml"
        cls.file.write_text(cls.file.read_text().replace("<first>1000</first>", "<first>150</first>").replace("<popsize>256</popsize>",
                                                                                                             "<popsize>30</popsize>"))
        cls.out = cls.folder / "out"
        cls.result = cls.search("--out", cls.out, "--evaluations", 300, "--judge", 12)

    @classmethod
    def search(cls, *words):
        finished = proleg("atlas", cls.file, *words, "--json")
        assert finished.returncode == 0, finished.stderr
        return json.loads(finished.stdout)

    def refused(self, *words):
        """The one line that says why these words are refused."""
        finished = proleg("atlas", *words)
        self.assertEqual((finished.returncode, finished.stdout, finished.stderr.count("\n")), (2, "", 1), finished.stderr)
        return finished.stderr

    def cell(self, *words, folder=None):
        finished = proleg("atlas", "--of", folder or self.out, *words, "--json")
        self.assertEqual((finished.returncode, finished.stderr), (0, ""))
        return json.loads(finished.stdout)

    @classmethod
    def map_rows(cls, folder=None):
        """The rows of the map by the numbers of their cells."""
        return {(int(row["cell:height"]), int(row["cell:duty_factor"])): row for row in table((folder or cls.out) / "map.tsv")}


class Search(Atlas):
    def test_has_the_reduced_engine_and_a_map(self):
        self.assertEqual((self.result["engine"], self.result["method"], self.result["evaluations"]), ("reduced", "map-elites", 300))
        rows = self.map_rows()
        self.assertEqual(self.result["map"]["cells"], CELLS[0] * CELLS[1])
        self.assertEqual(self.result["map"]["filled"], len(rows))
        self.assertAlmostEqual(self.result["map"]["coverage"], len(rows) / 500)
        self.assertAlmostEqual(self.result["map"]["qd_score"], sum(float(row["score:distance (m)"]) for row in rows.values()))
        for name in ("map.svg", "best.simulation.xml", "store.sqlite", "result.json"):
            self.assertTrue((self.out / name).is_file(), name)

    def test_fills_the_map_that_optimise_fills(self):
        finished = proleg("optimise", self.file, "--engine", "reduced", "--evaluations", 300, "--out", self.folder / "same", "--json")
        self.assertEqual(finished.returncode, 0, finished.stderr)
        self.assertEqual([{**row, "wall_s": ""} for row in table(self.folder / "same/map.tsv")],
                         [{**row, "wall_s": ""} for row in table(self.out / "map.tsv")])
        self.assertNotIn("judged_cells", json.loads(finished.stdout))
        self.assertFalse((self.folder / "same/judged.tsv").exists())

    def test_says_on_the_way_how_much_of_the_map_is_filled(self):
        finished = proleg("atlas", self.file, "--evaluations", 20, "--judge", 0, "--out", self.folder / "text")
        self.assertEqual(finished.returncode, 0, finished.stderr)
        self.assertRegex(finished.stdout, r"map +\d+ of 500 cells filled \(\d+\.\d %\), QD score ")
        self.assertNotIn("judged by", finished.stdout)
        self.assertFalse((self.folder / "text/judged.tsv").exists())

    def test_can_have_ode_which_then_judges_nothing(self):
        result = self.search("--engine", "ode", "--evaluations", 5, "--out", self.folder / "ode")
        self.assertEqual((result["engine"], result["judge"]), ("ode", None))
        self.assertNotIn("judged_cells", result)
        self.assertIn("--judge: found a search in ode", self.refused(self.file, "--engine", "ode", "--judge", 5, "--out", self.folder / "no"))

    def test_is_continued_after_control_c_and_by_its_folder_alone(self):
        out = self.folder / "parts"
        # Its evaluations do not end before the test interrupts it.
        search = subprocess.Popen([PROGRAMS / "proleg", "atlas", self.file, "--evaluations", "1000000", "--out", out, "--json"], stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True)
        wait_until(lambda: self.stored(out) > 40)
        search.send_signal(signal.SIGINT)
        printed, said = search.communicate(timeout=600)
        self.assertEqual(search.returncode, 1)
        self.assertEqual(json.loads(printed)["ended"], "interrupted")
        self.assertRegex(said, r"proleg atlas: interrupted after \d+ evaluations; continue with: proleg atlas .* --resume ")
        self.assertTrue((out / "map.tsv").is_file())
        self.assertTrue((out / "best.simulation.xml").is_file())
        self.assertFalse((out / "judged.tsv").exists(), "ODE judges a map that is finished")
        made = self.stored(out)
        finished = proleg("atlas", "--resume", out, "--evaluations", made + 50, "--judge", 3, "--json")
        self.assertEqual(finished.returncode, 0, finished.stderr)
        result = json.loads(finished.stdout)
        self.assertEqual((result["engine"], result["evaluations"]), ("reduced", made + 50))
        self.assertGreaterEqual(result["restored"], made, "and what workers had simulated ahead")
        self.assertEqual(result["judged_cells"]["cells"], 3)
        whole = self.search("--evaluations", made + 50, "--judge", 3, "--out", self.folder / "whole")
        self.assertEqual(whole["map"], result["map"])
        self.assertEqual(whole["judged_cells"], result["judged_cells"])
        self.assertEqual((self.folder / "whole/judged.tsv").read_text(), (out / "judged.tsv").read_text())

    @staticmethod
    def stored(folder):
        """Evaluations in a store."""
        if not (folder / "store.sqlite").exists():
            return 0
        with sqlite3.connect(folder / "store.sqlite", timeout=60) as store:
            has_table = store.execute("SELECT count(*) FROM sqlite_master WHERE name = 'evaluation'").fetchone()[0]
            return store.execute("SELECT count(*) FROM evaluation").fetchone()[0] if has_table else 0

    def test_of_another_method_is_refused_with_its_line(self):
        for words in ((self.folder / "wave/cma_es.optimise.xml",), (self.folder / "wave/cma_es.optimise.xml", "--estimate")):
            self.assertRegex(self.refused(*words), r"^proleg atlas: .*cma_es\.optimise\.xml:\d+: found the method cmaes, expected <mapElites>")
        self.assertIn("--judge: found 'x', expected a whole number", self.refused(self.file, "--judge", "x"))
        self.assertFalse(Path("gait_map").exists())


class Centroids(Atlas):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        text = re.sub(r' cells="\d+"', "", cls.file.read_text()).replace("<first>", "<centroids>60</centroids><first>")
        axis = '<axis measure="duty_factor"'
        cls.file.write_text(text.replace(axis, '<axis measure="slip" lowest="0" highest="3"/>' + axis))
        cls.around = cls.folder / "around"
        cls.of_centroids = cls.search("--out", cls.around, "--evaluations", 200, "--judge", 5)

    def test_are_the_cells_of_three_axes(self):
        rows = table(self.around / "map.tsv")
        self.assertEqual(self.of_centroids["map"]["cells"], 60)
        self.assertEqual(self.of_centroids["map"]["filled"], len(rows))
        self.assertGreater(len(rows), 5)
        self.assertEqual(len({row["cell:number"] for row in rows}), len(rows))
        self.assertEqual(self.of_centroids["judged_cells"]["cells"], len(table(self.around / "judged.tsv")))
        self.assertIn("seen along", (self.around / "map.svg").read_text())

    def test_are_named_by_their_number(self):
        row = table(self.around / "map.tsv")[0]
        cell = self.cell("--cell", row["cell:number"], folder=self.around)
        self.assertEqual(cell["cell"], [int(row["cell:number"])])
        run = json.loads(proleg("simulate", cell["scenario"], "--json").stdout)
        self.assertEqual(run["measures"]["distance"], float(row["score:distance (m)"]))
        near = self.cell("--near", ",".join(f"{name}={cell['measures'][name]}" for name in ("height", "slip", "duty_factor")),
                         folder=self.around)
        self.assertEqual(near["cell"], cell["cell"], "its own centroid is the nearest")
        self.assertIn("--cell: found '3,4', expected the numbers of a cell, as map.tsv has them: number from 1 to 60",
                      self.refused("--of", self.around, "--cell", "3,4"))


class Judge(Atlas):
    def test_simulates_cells_all_over_the_map_in_ode(self):
        rows = table(self.out / "judged.tsv")
        judged = self.result["judged_cells"]
        self.assertEqual((judged["cells"], len(rows)), (12, 12))
        of_map = self.map_rows()
        order = sorted(of_map, key=lambda place: (place[1], place[0]))
        parts = set()
        for row in rows:
            place = int(row["cell:height"]), int(row["cell:duty_factor"])
            self.assertEqual(row["evaluation"], of_map[place]["evaluation"])
            self.assertEqual(row["distance (m) (reduced)"], of_map[place]["score:distance (m)"])
            # The part p of n places among 12: from floor(p n / 12) on.
            parts.add(next(part for part in reversed(range(12)) if part * len(order) // 12 <= order.index(place)))
        self.assertEqual(len(parts), 12, "one of each twelfth of the filled cells")

    def test_finds_what_simulate_finds(self):
        row = table(self.out / "judged.tsv")[5]
        cell = self.cell("--cell", f"{row['cell:height']},{row['cell:duty_factor']}")
        run = json.loads(proleg("simulate", cell["scenario"], "--engine", "ode", "--json").stdout)
        self.assertEqual(float(row["distance (m) (ode)"]), run["measures"]["distance"])
        self.assertEqual(float(row["height (m) (ode)"]), run["measures"]["height"])
        self.assertEqual(float(row["duty_factor (ode)"]), run["measures"]["duty_factor"])

    def test_says_how_score_axes_and_cells_agree(self):
        rows, judged = table(self.out / "judged.tsv"), self.result["judged_cells"]
        pairs = [(float(row["distance (m) (reduced)"]), float(row["distance (m) (ode)"])) for row in rows]
        self.assertAlmostEqual(judged["score_ratio"], sum(ode for _, ode in pairs) / sum(reduced for reduced, _ in pairs))
        ranks = [[sorted(side).index(value) for value in side] for side in zip(*pairs)]
        squares = sum((a - b) ** 2 for a, b in zip(*ranks))
        self.assertAlmostEqual(judged["objectives"]["distance"]["rank_correlation"], 1 - 6 * squares / (12 * (12 ** 2 - 1)))
        with_place = [row for row in rows if row["judged:height"]]
        apart = [max(abs(int(row[f"cell:{axis}"]) - int(row[f"judged:{axis}"])) for axis in ("height", "duty_factor")) for row in with_place]
        self.assertEqual(judged["with_place"], len(with_place))
        self.assertEqual(judged["in_the_cell"], sum(distance == 0 for distance in apart))
        self.assertEqual(judged["near_it"], sum(distance <= 1 for distance in apart))

    def test_may_find_the_best_of_all_in_its_sample(self):
        best = max(float(row["distance (m) (ode)"]) for row in table(self.out / "judged.tsv"))
        self.assertGreaterEqual(self.result["best_score"], best)
        run = json.loads(proleg("simulate", self.out / "best.simulation.xml", "--json").stdout)
        self.assertEqual(run["measures"]["distance"], self.result["best_score"])


class Cell(Atlas):
    def test_has_a_scenario_with_the_score_of_the_map_to_the_last_bit(self):
        rows = self.map_rows()
        for place in (min(rows), max(rows), sorted(rows)[len(rows) // 2]):
            cell = self.cell("--cell", f"{place[0]},{place[1]}")
            self.assertEqual(cell["cell"], list(place))
            self.assertEqual(cell["scenario"], str(self.out / f"cell_{place[0]}_{place[1]}.simulation.xml"))
            run = json.loads(proleg("simulate", cell["scenario"], "--json").stdout)
            self.assertEqual(run["measures"]["distance"], float(rows[place]["score:distance (m)"]))
            self.assertEqual(run["measures"], cell["measures"])

    def test_is_chosen_by_measures(self):
        rows = self.map_rows()
        place = sorted(rows)[len(rows) // 3]
        middle = (place[0] - 0.5) * 0.05 / CELLS[0], 0.2 + (place[1] - 0.5) * 0.2 / CELLS[1]
        self.assertEqual(self.cell("--near", f"height={middle[0]},duty_factor={middle[1]}")["cell"], list(place))
        best_of_column = max((float(row["score:distance (m)"]), other) for other, row in rows.items() if other[0] == place[0])[1]
        self.assertEqual(self.cell("--near", f" height = {middle[0]}")["cell"], list(best_of_column), "the other axis is free")
        highest = max(place[0] for place in rows)
        self.assertEqual(self.cell("--near", "height=1000")["cell"][0], highest, "beyond the axis is its end")

    def test_that_is_empty_is_refused_with_the_nearest_filled_ones(self):
        rows = self.map_rows()
        empty = next((x, y) for x in range(1, CELLS[0] + 1) for y in range(1, CELLS[1] + 1) if (x, y) not in rows)
        said = self.refused("--of", self.out, "--cell", f"{empty[0]},{empty[1]}")
        named = re.fullmatch(rf"proleg atlas: --cell: found the empty cell {empty[0]},{empty[1]}, expected a filled one; the nearest: "
                             r"(\d+,\d+) (\d+,\d+) (\d+,\d+)\n", said)
        self.assertTrue(named, said)

        def distance(place):
            """Of the middle of the empty cell to a cell, on axes from 0 to 1."""
            return math.hypot(*(max(abs(a - b) - 0.5, 0) / cells for a, b, cells in zip(place, empty, CELLS)))

        nearest = sorted(distance(place) for place in rows)[:3]
        for text, expected in zip(named.groups(), nearest):
            self.assertAlmostEqual(distance(tuple(map(int, text.split(",")))), expected)

    def test_is_written_to_another_folder_and_again(self):
        place = min(self.map_rows())
        for _ in range(2):
            cell = self.cell("--cell", f"{place[0]},{place[1]}", "--out", self.folder / "elsewhere/deep")
        self.assertTrue(Path(cell["scenario"]).is_file())
        self.assertEqual(Path(cell["scenario"]).parent, self.folder / "elsewhere/deep")

    def test_that_a_person_has_edited_is_not_replaced(self):
        place = min(self.map_rows())
        words = "--cell", f"{place[0]},{place[1]}", "--out", self.folder / "edited"
        scenario = Path(self.cell(*words)["scenario"])
        for file in (scenario, scenario.with_name(scenario.name.replace(".simulation.", ".actuation."))):
            text = file.read_text()
            file.write_text(text + "<!-- mine -->\n")
            self.assertIn(f"{file}: found an existing file with other content, expected none; --out FOLDER names another folder",
                          self.refused("--of", self.out, *words))
            self.assertEqual(file.read_text(), text + "<!-- mine -->\n")
            file.write_text(text)
        self.cell(*words)

    def test_that_makes_no_sense_is_refused_in_one_line(self):
        for words, expected in (
                (("--of", self.out), "expected --cell or --near"),
                (("--cell", "1,1"), "expected --of FOLDER"),
                (("--of", self.out, "--cell", "0,1"), "height from 1 to 25, duty_factor from 1 to 20"),
                (("--of", self.out, "--cell", "26,1"), "height from 1 to 25"),
                (("--of", self.out, "--cell", "3"), "height from 1 to 25"),
                (("--of", self.out, "--cell", "3,4,5"), "height from 1 to 25"),
                (("--of", self.out, "--cell", "3,x"), "height from 1 to 25"),
                (("--of", self.out, "--near", "hight=1"), "found 'hight=1', expected a value of an axis"),
                (("--of", self.out, "--near", "height=nan"), "found 'height=nan'"),
                (("--of", self.out, "--near", "height"), "found 'height'"),
                (("--of", self.out, "--near", "height=1,height=2"), "found a second value of height"),
                (("--of", self.out, "--near", ""), "found ''"),
                (("--of", self.out, "--near", "height=1", "--cell", "1,1"), "--cell"),
                (("--of", self.out, "--cell", "1,1", "--resume", self.out), "found --of beside a search"),
                ((self.file, "--of", self.out, "--cell", "1,1"), "found --of beside a search"),
                (("--of", self.out, "--cell", "1,1", "--seed", "abc"), "found --of beside a search (--seed)"),
                (("--of", self.out, "--cell", "1,1", "--engine", "nope"), "found --of beside a search (--engine)"),
                (("--of", self.out, "--cell", "1,1", "--judge", 1), "found --of beside a search (--judge)"),
                (("--of", self.out, "--near", "height=1", "--out", ""), "--out: found an empty name"),
                (("--of", self.out, "--near", "height=1", "--out", "/dev/null"), "found something that is not a folder"),
                (("--of", "", "--cell", "1,1"), "--of: found an empty name"),
                (("--of", self.folder / "nowhere", "--cell", "1,1"),
                 f"--of: found no {self.folder}/nowhere/store.sqlite, expected the folder of a search that has made a map")):
            self.assertIn(expected, self.refused(*words), words)

    def test_of_a_search_without_a_map_is_refused(self):
        out = self.folder / "cma_es"
        finished = proleg("optimise", self.folder / "wave/cma_es.optimise.xml", "--engine", "reduced", "--evaluations", 3, "--out", out)
        self.assertEqual(finished.returncode, 0, finished.stderr)
        self.assertIn("found the method cmaes, expected <mapElites>", self.refused("--of", out, "--cell", "1,1"))

    def test_does_not_replace_a_file_of_the_experiment(self):
        place = min(self.map_rows())
        cell = self.cell("--cell", f"{place[0]},{place[1]}", "--out", self.folder / "next")
        experiment = self.folder / "next/again.optimise.xml"
        experiment.write_text(self.file.read_text().replace("uniform.simulation.xml", Path(cell["scenario"]).name))
        finished = proleg("atlas", experiment, "--evaluations", 20, "--judge", 0, "--out", self.folder / "next/found", "--json")
        self.assertEqual(finished.returncode, 0, finished.stderr)
        second = table(self.folder / "next/found/map.tsv")
        numbers = f"{second[0]['cell:height']},{second[0]['cell:duty_factor']}"
        scenario = self.folder / f"next/cell_{numbers.replace(',', '_')}.simulation.xml"
        if scenario != Path(cell["scenario"]):
            experiment.write_text(experiment.read_text().replace(Path(cell["scenario"]).name, scenario.name))
            scenario.write_text(Path(cell["scenario"]).read_text())
            shutil.rmtree(self.folder / "next/found")
            self.assertEqual(proleg("atlas", experiment, "--evaluations", 20, "--judge", 0, "--out", self.folder / "next/found").returncode, 0)
        before = scenario.read_text()
        self.assertIn("found a file of the experiment",
                      self.refused("--of", self.folder / "next/found", "--cell", numbers, "--out", self.folder / "next"))
        self.assertEqual(scenario.read_text(), before)


unittest.main(argv=sys.argv[:1])

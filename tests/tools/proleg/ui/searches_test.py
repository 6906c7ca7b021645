"""Searches through `proleg ui`, as a page makes them: from a form to a better gait, over the end of the program, and searches
that others have started.

Usage: searches_test.py SOURCE PROGRAMS"""

import contextlib
import json
import re
import shutil
import signal
import sqlite3
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE, PROGRAMS = Path(sys.argv[1]), Path(sys.argv[2])
sys.path[:0] = [str(SOURCE / part) for part in ("tests/host/server", "tests/tools/proleg/ui", "tests/support")]
from search_program import SECONDS, SearchProgram, experiment, rows_of  # noqa: E402
from waiting import wait_until  # noqa: E402


def simulate(file):
    output = subprocess.run([PROGRAMS / "proleg", "simulate", file, "--json"], check=True, capture_output=True, text=True).stdout
    return json.loads(output)


def a_form_becomes_a_better_gait(program):
    methods = program.viewer.documents["search_methods"]["value"]
    assert {"cmaEs", "geneticAlgorithm", "greatDeluge", "nsga2"} <= {method["tag"] for method in methods["methods"]}
    assert [method["tag"] for method in methods["methods"] if method["has_map"]] == ["mapElites"] and methods["most_axes"] == 4, methods
    assert any(measure["name"] == "distance" for measure in methods["measures"])
    form = experiment()
    checked = program.must("search.check", experiment=form)
    assert checked["names"] == [f"amplitude:J{number}" for number in (5, 4, 3, 2, 1)], checked
    assert checked["candidates"] == 121.0**5 and checked["planned"] == 40, checked
    assert checked["engine"] == "ode" and checked["reduced"] is None, checked
    estimate = program.must("search.estimate", experiment=form, workers=2)
    assert estimate["planned"] == 40 and estimate["seconds"] >= 40 * estimate["evaluation_s"] > 0, estimate

    name = program.must("search.start", name="wave", experiment=form, workers=2)["name"]
    assert name == "searches/wave"
    assert "exists" in program.refused("search.start", name="wave", experiment=form)
    search = program.when(name, lambda found: found["state"] == "ended")
    assert (search["made"], search["planned"], search["method"]) == (40, 40, "cmaes"), search
    assert search["ending"] == "all 40 evaluations made" and search["problem"] is None, search

    described = program.must("search.open", name=name)
    assert [dimension["name"] for dimension in described["dimensions"]] == checked["names"], described
    assert described["dimensions"][0] == {"name": "amplitude:J5", "unit": "deg", "count": 121, "lowest": 0, "highest": 60}
    assert described["objectives"] == [{"name": "distance", "unit": "m", "maximise": True}] and described["has_baseline"]
    rows = program.must("search.rows", name=name, **{"from": 0})
    assert rows["made"] == len(rows["scores"]) == len(rows["values"]) == len(rows["flags"]) == 40
    assert rows["values"][0] == [40] * 5, "evaluation 0 has the scenario's own values"
    assert program.must("search.rows", name=name, **{"from": 30})["scores"] == rows["scores"][30:]
    assert program.must("search.rows", name=name, **{"from": 40})["scores"] == []
    best = max(range(40), key=lambda number: (rows["scores"][number], -number))
    assert search["best"] == best and search["score"] == rows["scores"][best][0] == described["result"]["best_score"]
    assert best > 0, "the search has found no better gait"

    # The gait of the draft and that of the candidate, as they move: both to the head's way that the program measures.
    for arguments, distance in (({}, rows["scores"][0][0]), ({"name": name, "number": best}, search["score"])):
        data = program.must("search.motion", **arguments)
        tick_us, stride, count, joints = struct.unpack("<4i", data[:16])
        assert (tick_us, stride, joints) == (10000, 2, 5) and count == SECONDS * 50 + 1, (tick_us, stride, count, joints)
        values = struct.unpack(f"<{count * 12}i", data[16:])
        first, last = (values[12 * row + 5:12 * row + 7] for row in (0, count - 1))
        way = sum((b - a) ** 2 for a, b in zip(first, last)) ** 0.5 / 1e6
        assert abs(way - distance) < 0.05, (way, distance)

    # Whether they are real: the draft has the distance of the scenario, the candidate that of the search.
    for arguments, distance in (({}, rows["scores"][0][0]), ({"name": name, "number": best}, search["score"])):
        confirmed = program.must("search.confirm", **arguments)
        assert confirmed["runs"][0]["distance_m"] == distance, (confirmed["runs"][0], distance)
        assert {finding["name"] for finding in confirmed["findings"]} >= {"a finer step", "energy", "start"}, confirmed
        assert confirmed["nothing_speaks_against"] in (True, False)

    # Applied, it is one change of the draft, and what is saved has the score of the search to the last bit.
    candidate = program.must("search.candidate", name=name, number=best)
    assert candidate["scores"] == rows["scores"][best] and candidate["measures"]["distance"] == search["score"]
    assert [float(word.split("=")[1]) for word in candidate["words"]] == rows["values"][best], candidate
    before = program.draft["behaviour"]["modules"]
    program.must("behaviour.values", words=candidate["words"], label=f"candidate {best} of wave")
    assert program.draft["undo"] == f"candidate {best} of wave" and program.draft["behaviour"]["modules"] != before
    program.must("draft.undo")
    program.viewer.until(lambda: program.draft["behaviour"]["modules"] == before)
    program.must("draft.redo")
    program.must("draft.save")
    result = simulate(program.folder / "uniform.simulation.xml")
    assert result["measures"]["distance"] == search["score"], (result["measures"]["distance"], search["score"])
    program.must("draft.undo")
    program.must("draft.save")


def a_map_of_gaits_is_searched_from_a_form(program):
    file = str(SOURCE / "sim/scenarios/travelling_wave/gait_map.optimise.xml")
    form = program.must("search.read", file=file)["experiment"]
    methods = program.viewer.documents["search_methods"]["value"]["methods"]
    assert any((method["tag"], method["algorithm"]) == (form["method"], form["algorithm"] or None) for method in methods), form
    assert [axis["measure"] for axis in form["axes"]] == ["height", "duty_factor"], form
    wrong = {**form, "axes": [{**form["axes"][0], "cells": "0"}]}
    assert program.must("search.check", experiment=wrong)["problem"]["field"].startswith("axes.0")
    form = {**form, "settings": {"popsize": "4", "first": "8"}, "evaluations": "12"}
    name = program.must("search.start", name="map", experiment=form, engine="reduced", workers=2)["name"]
    program.when(name, lambda found: found["state"] == "ended")
    described = program.must("search.open", name=name)
    assert [axis["cells"] for axis in described["axes"]] == [25, 20] and described["engine"] == "reduced", described

    # Its file starts it again: with its engine, unless another one is named.
    again = str(program.folder / name / "map.optimise.xml")
    for engine, expected in ((None, "reduced"), ("ode", "ode")):
        name = program.must("search.start", name=f"again_{expected}", file=again, engine=engine, workers=2)["name"]
        program.when(name, lambda found: found["state"] == "ended")
        assert program.must("search.open", name=name)["engine"] == expected, name


def saved_files(folder):
    """Without the journal of unsaved changes, which comes and goes half a second after a change."""
    return sorted(str(path) for path in folder.rglob("*") if path.suffix != ".unsaved")


def a_search_outlives_the_program(program):
    undisturbed = program.must("search.start", name="undisturbed", experiment=experiment(evaluations="300"), workers=2)["name"]
    program.when(undisturbed, lambda found: found["state"] == "ended")
    name = program.must("search.start", name="long", experiment=experiment(evaluations="300"), workers=2)["name"]
    assert "running" in program.refused("search.resume", name=name)
    program.process.kill()
    program.process.wait()
    program.start()
    program.when(name, lambda found: found["made"] >= 10 and found["state"] in ("running", "ended"))
    program.ask("search.stop", name=name)
    search = program.when(name, lambda found: found["state"] not in ("running", "stopping"))
    if search["state"] != "ended":  # a computer that was too slow to stop it before
        assert search["state"] == "interrupted" and search["problem"] is None and search["made"] < 300, search
        assert "nothing to stop" in program.refused("search.stop", name=name)
        assert program.must("search.resume", name=name, workers=1)["name"] == name
        program.when(name, lambda found: found["state"] == "ended")
    assert rows_of(program.folder / name) == rows_of(program.folder / undisturbed)
    assert len(rows_of(program.folder / name)) == 300
    assert program.must("search.resume", name=name, evaluations="320")["name"] == name
    program.when(name, lambda found: found["state"] == "ended" and found["made"] == 320)


def searches_of_others_are_found(program):
    file = SOURCE / "sim/scenarios/travelling_wave/cma_es.optimise.xml"
    command = [PROGRAMS / "proleg", "optimise", file, "--simulation", program.folder / "uniform.simulation.xml"]
    with open(program.folder / "others.log", "w") as log:
        subprocess.run([*command, "--engine", "reduced", "--evaluations", "40", "--out", program.folder / "shell"], check=True,
                       stdout=log, stderr=log)
        search = program.when("shell", lambda found: found["state"] == "ended")
        assert search["made"] == 40 and search["method"] == "cmaes", search
        assert program.must("search.open", name="shell")["engine"] == "reduced", "an option of the command line"
        assert len(program.must("search.rows", name="shell", **{"from": 0})["scores"]) == 40
        if shutil.which("mpirun") and (PROGRAMS / "proleg-optimise-mpi").exists():
            mpirun = ["mpirun", "--oversubscribe", "--allow-run-as-root", "-n", "2"]
            process = subprocess.Popen([*mpirun, *command, "--out", program.folder / "cluster"], stdout=log, stderr=log)
            program.when("cluster", lambda found: found["state"] == "running" and found["made"] > 0)
            program.must("search.stop", name="cluster")
            program.when("cluster", lambda found: found["state"] == "interrupted")
            process.wait()
    store = sqlite3.connect(program.folder / "shell/store.sqlite")
    store.execute("PRAGMA user_version = 99")
    store.close()
    assert "format 99" in program.when("shell", lambda found: found["state"] == "unreadable")["problem"]
    assert "format 99" in program.refused("search.open", name="shell")


def bad_input_is_one_line_and_leaves_nothing(program):
    def problem(**changes):
        return program.must("search.check", experiment=experiment(**changes))["problem"]

    parameter = experiment()["parameters"][0]
    assert problem(parameters=[])["field"] == "parameters"
    assert problem(parameters=[{**parameter, "lower": "50", "upper": "10"}])["field"].startswith("parameters.0.")
    assert problem(parameters=[{**parameter, "upper": "1e99"}])["field"] == "parameters.0.upper"
    assert problem(parameters=[{**parameter, "step": "0"}])["field"] == "parameters.0.step"
    assert problem(parameters=[{**parameter, "set": ""}])["field"] == "parameters.0.set"
    assert problem(parameters=[{**parameter, "joints": [9]}])["field"] == "parameters.0.joints"
    assert problem(method="none")["field"] == "method"
    assert problem(settings={"popsize": "1"})["field"] == "settings.popsize"
    assert problem(objectives=[{"terms": []}])["field"] == "objectives.0"
    assert problem(method="nsga2", settings={})["text"].startswith("found 1 objective")
    for changes in ({"parameters": "x"}, {"settings": []}, {"seed": 1}, {"parameters": [{"joints": [400]}]}, {"trials": 1}):
        program.refused("search.check", experiment=experiment(**changes))
    before = saved_files(program.folder)
    for name in ("", "..", "a/b", ".hidden", "x" * 10_000, "a\nb", "\0"):
        program.refused("search.start", name=name, experiment=experiment())
    program.refused("search.start", name="good", experiment=experiment(evaluations="x"))
    program.refused("search.start", name="good", experiment=experiment(), workers=0)
    assert "mujocoo" in program.refused("search.start", name="good", experiment=experiment(), engine="mujocoo")
    for file in ("/etc/passwd", "../x.optimise.xml", str(program.folder / "none.optimise.xml")):
        program.refused("search.start", name="good", file=file)
        program.refused("search.read", file=file)
    for name in ("", "..", "/etc", "none", "searches", "searches/none"):
        for operation in ("open", "rows", "candidate", "stop", "resume"):
            program.refused(f"search.{operation}", name=name)
    program.refused("search.candidate", name="searches/wave", number=4000)
    program.refused("search.motion", name="searches/wave")
    program.refused("search.confirm", name="searches/wave")
    program.refused("search.confirm", name="searches/none", number=1)
    program.refused("behaviour.values", words=[], label="")
    program.refused("behaviour.values", words=["amplitude:J9=1"], label="")
    program.refused("behaviour.values", words=["amplitude=1@5"], label="")
    program.refused("search.none")
    assert saved_files(program.folder) == before, "a refusal has left a file"
    readonly = program.folder / "searches"
    readonly.rename(program.folder / "kept")
    readonly.write_text("not a folder")
    program.refused("search.start", name="good", experiment=experiment())
    readonly.unlink()
    with tempfile.TemporaryDirectory() as outside:
        readonly.symlink_to(outside)
        assert "a link to" in program.refused("search.start", name="good", experiment=experiment())
        assert not list(Path(outside).iterdir())
        readonly.unlink()
    (program.folder / "kept").rename(readonly)


def odd_stores_end_nothing(program):
    """What other programs do to the folders of searches."""
    wave = program.folder / "searches/wave"
    for name, sql in (("odd", "UPDATE evaluation SET candidate = '1 2'"), ("far", "UPDATE evaluation SET candidate = '9999 0 0 0 0'"),
                      ("empty", "DROP TABLE evaluation"), ("runs", "UPDATE evaluation SET run = 2000000000 WHERE number = 3")):
        shutil.copytree(wave, program.folder / name)
        with contextlib.closing(sqlite3.connect(program.folder / name / "store.sqlite")) as store:
            store.execute(sql)
            store.commit()
        program.when(name, lambda found: found["state"] in ("ended", "interrupted", "unreadable"))
        program.ask("search.open", name=name)
        rows = program.ask("search.rows", name=name, **{"from": 0})
        assert rows["ok"] == (name == "runs"), rows
        program.ask("search.candidate", name=name, number=1)
    shutil.copytree(wave, program.folder / "cut")
    with open(program.folder / "cut/store.sqlite", "r+b") as store:
        store.truncate(5000)
    program.when("cut", lambda found: found["state"] == "unreadable" and found["problem"])
    program.refused("search.rows", name="cut", **{"from": 0})
    for number in (2**63 - 1, 2**63, 2**64 - 1):
        assert program.must("search.rows", name="searches/wave", **{"from": number})["scores"] == []
        program.refused("search.candidate", name="searches/wave", number=number)

    # Another search under the same name has other values.
    parameter = experiment()["parameters"][0]
    for joints in ([0, 1, 2], [3, 4]):
        name = program.must("search.start", name="again", experiment=experiment(parameters=[{**parameter, "joints": joints}]))["name"]
        # The document may still be of the search before.
        wait_until(lambda: program.must("search.rows", name=name, **{"from": 0})["made"] == 40, f"{name} has not ended")
        program.when(name, lambda found: found["state"] == "ended")
        assert len(program.must("search.open", name=name)["dimensions"]) == len(joints)
        assert len(program.must("search.rows", name=name, **{"from": 0})["values"][0]) == len(joints)
        shutil.rmtree(program.folder / name)
    program.refused("search.open", name=name)

    # A search is stopped before it has begun.
    started = program.viewer.start("search.start", program.epoch, name="early", experiment=experiment(evaluations="100000"))
    program.must("search.stop", name="searches/early")
    assert program.viewer.result(started)["ok"]
    program.when("searches/early", lambda found: found["state"] == "interrupted")

    # A search that is stopped in its fresh runs has not ended: it has no result, and goes on.
    noisy = experiment(evaluations="8", trials={"count": "2", "friction": "0.1"}, confirmation={"candidates": "5", "runs": "150"})
    name = program.must("search.start", name="noisy", experiment=noisy)["name"]
    program.when(name, lambda found: found["made"] == 8)
    program.ask("search.stop", name=name)
    search = program.when(name, lambda found: found["state"] not in ("running", "stopping"))
    if search["state"] != "ended":  # a computer that was too slow to stop it before
        assert search["state"] == "interrupted" and search["left_s"] is None, search
        assert program.must("search.open", name=name)["result"] is None
        program.must("search.resume", name=name)
        program.when(name, lambda found: found["state"] == "ended")
    assert program.must("search.open", name=name)["result"]["ended"] == "all 8 evaluations made"
    assert len(program.must("search.open", name=name)["result"]["confirmations"]) >= 5

    # Several objectives: a front.
    name = program.must("search.start", name="front", experiment=experiment(
        method="nsga2", settings={"popsize": "8"}, objectives=[{"terms": [{"measure": "distance", "weight": ""}]}, {"terms": [{"measure": "mechanical_energy", "weight": ""}]}]))["name"]
    program.when(name, lambda found: found["state"] == "ended")
    described = program.must("search.open", name=name)
    assert [(its["name"], its["maximise"]) for its in described["objectives"]] == [("distance", True), ("mechanical_energy", False)]
    assert all(len(scores) == 2 for scores in program.must("search.rows", name=name, **{"from": 0})["scores"])


def adaptations_are_found_with_their_map(program):
    """What `proleg adapt` has tried on a damaged robot, beside the map that it was chosen from, as both have it in their tables."""
    def run(*words):
        subprocess.run([PROGRAMS / "proleg", *words], check=True, stdout=subprocess.DEVNULL)

    atlas, scenario = program.folder / "atlas", program.folder / "uniform.simulation.xml"
    run("atlas", program.folder / "gait_map.optimise.xml", "--evaluations", "300", "--out", atlas)
    opened = program.must("search.open", name="atlas")
    assert [(axis["name"], axis["unit"], axis["lowest"], axis["highest"], axis["cells"]) for axis in opened["axes"]] == [
        ("height", "m", 0, 0.05, 25), ("duty_factor", "", 0.2, 0.4, 20)], opened["axes"]
    assert opened["centroids"] is None
    assert program.must("search.adaptations", name="atlas") == {"adaptations": []}
    run("adapt", scenario, "--atlas", atlas, "--seconds", "1", "--trials", "3", "--alpha", "1", "--suspect", "none", "--damage", "jammed:J3=20",
        "--out", program.folder / "deep/jammed")
    run("adapt", scenario, "--atlas", atlas / "store.sqlite", "--seconds", "1", "--trials", "1", "--suspect", "none", "--suspect", "powerless:J2",
        "--out", program.folder / "intact")
    shutil.copytree(program.folder / "intact", program.folder / "elsewhere/intact")  # its path leads to no atlas
    found = program.must("search.adaptations", name="atlas")["adaptations"]
    assert [(its["name"], its["robot"]) for its in found] == [
        ("intact", "uniform.simulation.xml"), ("deep/jammed", "uniform.simulation.xml, jammed:J3=20")], found
    assert re.search(r"none \d+ %", found[0]["diagnosis"]) and f'\n# damage: {found[0]["diagnosis"]}\n' in (program.folder / "intact/trials.tsv").read_text()
    assert found[1]["diagnosis"] is None
    table = [line.split("\t") for line in (program.folder / "deep/jammed/trials.tsv").read_text().splitlines() if line[0] in "123"]
    assert len(table) == 3
    for trial, columns in zip(found[1]["trials"], table):
        assert trial["cell"] == columns[1] and trial["failure"] is None
        assert [trial["expected"], trial["deviation"], trial["measured"]] == [float(number) for number in columns[-4:-1]]
        assert trial["values"] == [float(number) for number in columns[-9:-4]]
    others = program.must("search.start", name="no map", experiment=experiment(evaluations="10"))["name"]
    program.when(others, lambda its: its["state"] == "ended")
    assert program.must("search.open", name=others)["axes"] == []
    assert program.must("search.adaptations", name=others) == {"adaptations": []}
    (program.folder / "intact/trials.tsv").write_bytes(b"\xff\0# atlas: ../atlas\n" * 100)
    assert [its["name"] for its in program.must("search.adaptations", name="atlas")["adaptations"]] == ["deep/jammed"]
    program.refused("search.adaptations", name="../atlas")

    # Cells around centroids have theirs.
    text = (program.folder / "gait_map.optimise.xml").read_text()
    text = re.sub(r' cells="\d+"', "", text).replace("<first>", "<centroids>40</centroids><first>")
    (program.folder / "centroids.optimise.xml").write_text(text)
    run("optimise", program.folder / "centroids.optimise.xml", "--engine", "reduced", "--evaluations", "20", "--out", program.folder / "round")
    opened = program.must("search.open", name="round")
    assert len(opened["centroids"]) == 40 and all(0 <= share <= 1 for centroid in opened["centroids"] for share in centroid)
    assert all(len(centroid) == len(opened["axes"]) == 2 for centroid in opened["centroids"])


def files_of_experiments_are_offered(program):
    program.searches()
    titles = {entry["title"]: entry["file"] for entry in program.document()["experiments"]}
    form = program.must("search.read", file=titles["cma_es"])["experiment"]
    assert form["method"] == "cmaEs" and form["settings"]["popsize"] == "32" and form["evaluations"] == "2000", form
    assert "problem" not in program.must("search.check", experiment=form)
    name = program.must("search.start", name="from a file", file=titles["great_deluge"], workers=2)["name"]
    program.when(name, lambda found: found["made"] > 0)
    program.must("search.stop", name=name)
    search = program.when(name, lambda found: found["state"] == "interrupted")
    assert search["method"] == "great-deluge", search


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copytree(SOURCE / "sim/scenarios/travelling_wave", folder, dirs_exist_ok=True)
        with SearchProgram(PROGRAMS, folder) as program:
            program.must("draft.save")  # the duration
            a_form_becomes_a_better_gait(program)
            bad_input_is_one_line_and_leaves_nothing(program)
            odd_stores_end_nothing(program)
            a_search_outlives_the_program(program)
            searches_of_others_are_found(program)
            files_of_experiments_are_offered(program)
            adaptations_are_found_with_their_map(program)
            a_map_of_gaits_is_searched_from_a_form(program)
            program.process.send_signal(signal.SIGINT)
            assert program.process.wait() == 0


main()

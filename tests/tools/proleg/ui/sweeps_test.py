"""Sweeps through `proleg ui`, as a page makes them: started, stopped, resumed, over the end of the program; sweeps that others
have started; and bad input.

Usage: sweeps_test.py SOURCE PROGRAMS"""

import shutil
import statistics
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE, PROGRAMS = Path(sys.argv[1]), Path(sys.argv[2])
sys.path[:0] = [str(SOURCE / part) for part in ("tests/host/server", "tests/tools/proleg/ui", "tests/support")]
from ui_program import UiProgram  # noqa: E402
from waiting import wait_until  # noqa: E402

SECONDS = 1  # of a run
HEAD = 3  # lines of a table


class SweepProgram(UiProgram):
    """`proleg ui` whose draft runs for a second, and its sweeps."""

    def __init__(self, programs, folder):
        super().__init__(programs, folder)
        self.must("draft.run", name="duration", value=SECONDS)

    def sweeps(self):
        for _ in range(2):  # an answer may come before its document, but not before that of the operation before it
            self.must("sweep.refresh")
        self.viewer.until(lambda: "sweeps" in self.viewer.documents)
        return {sweep["name"]: sweep for sweep in self.viewer.documents["sweeps"]["value"]["sweeps"]}

    def when(self, name, is_so):
        return wait_until(lambda: (found := self.sweeps().get(name)) and is_so(found) and found, lambda: f"{name}: {self.sweeps().get(name)}")

    def refused(self, name, /, **arguments):
        result = self.ask(name, **arguments)
        assert not result["ok"], (name, arguments, result)
        assert "\n" not in result["error"], result
        return result["error"]


def runs_of(folder):
    """The runs of a sweep as its table has them."""
    lines = [line.split("\t") for line in (folder / "sweep.tsv").read_text().splitlines()]
    titles = lines[HEAD - 1]
    return [dict(zip(titles, cells, strict=True)) for cells in lines[HEAD:]]


def a_map_has_the_means_of_its_runs(program):
    form = {"over": ["amplitude=20:40:10", "frequency=0.5:1:0.5", "seed=1:2"], "measure": "distance", "engine": "reduced", "workers": 2}
    checked = program.must("sweep.check", **form)
    assert checked["runs"] == 12 and checked["counts"] == [3, 2, 2], checked
    assert checked["has_equal_seeds"] is True and checked["reduced"] is None and checked["engine"] == "ode", checked
    estimate = program.must("sweep.estimate", **form)
    assert estimate["run_s"] > 0 and abs(estimate["seconds"] - 6 * estimate["run_s"]) < 1e-9, estimate

    name = program.must("sweep.start", name="my map", **form)["name"]
    assert name == "sweeps/my map"
    assert "exists" in program.refused("sweep.start", name="my map", **form)
    sweep = program.when(name, lambda found: found["state"] == "ended")
    assert (sweep["made"], sweep["planned"], sweep["measure"], sweep["unit"], sweep["problem"]) == (12, 12, "distance", "m", None), sweep
    assert [(each["name"], each["unit"], each["count"]) for each in sweep["quantities"]] == [("amplitude", "deg", 3), ("frequency", "Hz", 2), ("seed", "", 2)], sweep

    opened = program.must("sweep.open", name=name)
    assert opened["cells"] == 6 and opened["joints"] == 5 and opened["scenario_problem"] is None, opened
    assert [each["values"] for each in opened["quantities"]] == [["20", "30", "40"], ["0.5", "1"], ["1", "2"]], opened
    assert [each["is_seed"] for each in opened["quantities"]] == [False, False, True]
    runs = runs_of(program.folder / name)
    for measure in ("distance", "speed"):
        cells = program.must("sweep.cells", name=name, measure=measure)
        assert cells["made"] == 12 and len(cells["cells"]) == 6, cells
        column = next(title for title in runs[0] if title.split(" ")[0] == measure)
        for number, (mean, deviation, values, failed) in enumerate(cells["cells"]):
            amplitude, frequency = ("20", "30", "40")[number // 2], ("0.5", "1")[number % 2]
            wanted = [float(run[column]) for run in runs if run["amplitude (deg)"] == amplitude and run["frequency (Hz)"] == frequency]
            assert (values, failed) == (2, 0) and abs(mean - statistics.mean(wanted)) < 1e-12, (number, mean, wanted)
            assert abs(deviation - statistics.stdev(wanted)) < 1e-12, (number, deviation, wanted)
    assert program.must("sweep.cells", name=name)["cells"] == program.must("sweep.cells", name=name, measure="distance")["cells"]
    assert len(program.must("sweep.cells", name=name, **{"from": 4})["cells"]) == 2
    assert program.must("sweep.cells", name=name, **{"from": 10**15})["cells"] == []

    # A cell moves as its run did, and its values get into the draft as one change.
    means = [cell[0] for cell in program.must("sweep.cells", name=name)["cells"]]
    best = max(range(6), key=lambda number: means[number])
    cell = program.must("sweep.cell", name=name, cell=best)
    assert cell["words"] == [f"amplitude={(20, 30, 40)[best // 2]}", f"frequency={('0.5', '1')[best % 2]}"], cell
    assert cell["others"] == [] and cell["failure"] is None
    data = program.must("sweep.motion", name=name, cell=best)
    tick_us, stride, count, joints = struct.unpack("<4i", data[:16])
    assert (tick_us, joints) == (10000, 5) and count == SECONDS * 100 // stride + 1, (tick_us, stride, count, joints)
    before = program.draft["behaviour"]["modules"]
    program.must("behaviour.values", words=cell["words"], label="best of my map")
    assert program.draft["undo"] == "best of my map"
    program.must("draft.undo")
    program.viewer.until(lambda: program.draft["behaviour"]["modules"] == before)

    # What is of the world is no value of a gait.
    name = program.must("sweep.start", name="ground", over=["friction=0.2:0.4:0.2", "amplitude:J3=10:20:10"], measure="distance", engine="reduced")["name"]
    program.when(name, lambda found: found["state"] == "ended")
    cell = program.must("sweep.cell", name=name, cell=3)
    assert cell["words"] == ["amplitude:J3=20"] and cell["others"] == ["friction=0.4"], cell
    program.must("sweep.motion", name=name, cell=3)


LONG = {"over": ["amplitude=10:59.9:0.1", "seed=1:6"], "measure": "speed", "engine": "reduced", "workers": 1}


def a_sweep_outlives_the_program(program):
    undisturbed = program.must("sweep.start", name="undisturbed", **LONG)["name"]
    program.when(undisturbed, lambda found: found["state"] == "ended")
    name = program.must("sweep.start", name="long", **LONG)["name"]
    program.process.kill()
    program.process.wait()
    program.start()
    grown = program.when(name, lambda found: found["made"] >= 10)
    assert grown["state"] in ("running", "ended") and grown["planned"] == 3000, grown
    program.ask("sweep.stop", name=name)
    sweep = program.when(name, lambda found: found["state"] not in ("running", "stopping"))
    if sweep["state"] != "ended":  # a computer that was too slow to stop it before
        assert sweep["state"] == "interrupted" and sweep["problem"] is None and sweep["made"] < 3000, sweep
        assert program.must("sweep.cells", name=name)["made"] == sweep["made"]
        assert "nothing to stop" in program.refused("sweep.stop", name=name)
        assert program.must("sweep.resume", name=name, workers=2)["name"] == name
        program.when(name, lambda found: found["state"] == "ended")
    for file in ("sweep.tsv", "summary.tsv", "sweep.svg"):
        assert (program.folder / name / file).read_bytes() == (program.folder / undisturbed / file).read_bytes(), file
    assert not list((program.folder / name).glob("*.lock")) and not list((program.folder / name).glob("*.stop"))


def a_killed_sweep_goes_on(program):
    """Killed in its runs, and before its first one."""
    name = "sweeps/killed"
    shutil.copytree(program.folder / "sweeps/long", program.folder / name)
    folder = program.folder / name
    whole = (folder / "sweep.tsv").read_bytes()
    wanted = (folder / "summary.tsv").read_bytes()
    for kept in (whole[:len(whole) // 2], None):
        for file in ("summary.tsv", "sweep.svg", "sweep.log", "sweep.tsv"):
            (folder / file).unlink(missing_ok=True)
        if kept is not None:
            (folder / "sweep.tsv").write_bytes(kept)
        sweep = program.when(name, lambda found: found["state"] == "interrupted")
        assert (sweep["made"] == 0) == (kept is None), sweep
        program.must("sweep.resume", name=name)
        program.when(name, lambda found: found["state"] == "ended")
        assert (folder / "summary.tsv").read_bytes() == wanted


def sweeps_of_others_are_found(program):
    scenario = program.folder / "uniform.simulation.xml"
    with tempfile.TemporaryDirectory() as elsewhere:
        subprocess.run([PROGRAMS / "proleg", "sweep", scenario, "--over", "heading=0:90:45", "--set", "amplitude=30", "--seconds", "1", "--engine", "reduced",
                        "--measure", "speed", "--out", program.folder / "shell"], check=True, cwd=elsewhere, capture_output=True)
    sweep = program.when("shell", lambda found: found["state"] == "ended")
    assert (sweep["made"], sweep["measure"], sweep["scenario"]) == (3, "speed", "uniform.simulation.xml"), sweep
    cell = program.must("sweep.cell", name="shell", cell=1)
    assert cell["words"] == ["amplitude=30"] and cell["others"] == ["heading=45"], cell
    assert len(program.must("sweep.motion", name="shell", cell=1)) > 1000
    # What its scenario was, it may not be any more: the values stay, and one line says so.
    text = scenario.read_text()
    scenario.write_text(text + "<!-- changed -->\n")
    assert "have changed since" in program.must("sweep.open", name="shell")["scenario_problem"]
    scenario.write_text(text)
    assert program.must("sweep.open", name="shell")["scenario_problem"] is None

    folder = program.folder / "moved"
    shutil.copytree(program.folder / "shell", folder)
    (folder / "options.tsv").write_text((folder / "options.tsv").read_text().replace("uniform.simulation.xml", "gone.simulation.xml"))
    opened = program.must("sweep.open", name="moved")
    assert "gone.simulation.xml" in opened["scenario_problem"] and opened["joints"] is None, opened
    assert len(program.must("sweep.cells", name="moved")["cells"]) == 3
    assert "gone.simulation.xml" in program.refused("sweep.motion", name="moved", cell=1)
    # The folder of a sweep can be moved with what it has copied.
    shutil.move(program.folder / "sweeps/my map", program.folder / "my map, moved")
    program.when("my map, moved", lambda found: found["state"] == "ended")
    program.must("sweep.motion", name="my map, moved", cell=0)


def damaged_folders_end_nothing(program):
    def copy(name):
        shutil.copytree(program.folder / "shell", program.folder / name)
        return program.folder / name

    (copy("older") / "options.tsv").unlink()
    assert "older version" in program.when("older", lambda found: found["state"] == "unreadable")["problem"]
    program.refused("sweep.open", name="older")
    for name, change in (("newer", lambda text: text.replace("proleg sweep 1", "proleg sweep 2")), ("nothing", lambda text: ""),
                         ("binary", lambda text: "\0\1\2" * 1000), ("odd", lambda text: text + "unknown\t1\n"),
                         ("many", lambda text: text.replace("heading=0:90:45", "heading=0:9000000:1")), ("cut", lambda text: text[:-5]),
                         ("measure", lambda text: text.replace("measure\tspeed", "measure\tnone"))):
        file = copy(name) / "options.tsv"
        file.write_text(change(file.read_text()))
        problem = program.when(name, lambda found: found["state"] == "unreadable")["problem"]
        assert "expected" in problem and "\n" not in problem, problem
        program.refused("sweep.open", name=name)
        program.refused("sweep.cells", name=name)
        program.refused("sweep.resume", name=name)
    for name, change in (("line", lambda text: text + "45\tx\n"), ("head", lambda text: "x" + text), ("twice", lambda text: text + text.splitlines()[-1] + "\n"),
                         ("titles", lambda text: text.replace("heading (deg)", "heading (rad)"))):
        file = copy(name) / "sweep.tsv"
        file.write_text(change(file.read_text()))
        program.when(name, lambda found: found["state"] in ("ended", "interrupted"))
        error = program.refused("sweep.cells", name=name)
        assert error.startswith("sweep.tsv") and "expected" in error, error
        program.ask("sweep.open", name=name)
        program.refused("sweep.resume", name=name)
    # A line that is being written is no damage.
    file = copy("growing") / "sweep.tsv"
    file.write_bytes(file.read_bytes()[:-7])
    program.when("growing", lambda found: found["state"] == "interrupted" and found["made"] == 2)
    assert program.must("sweep.cells", name="growing")["made"] == 2
    (copy("device") / "sweep.tsv").unlink()
    (program.folder / "device/sweep.tsv").mkdir()
    program.ask("sweep.cells", name="device")
    program.ask("sweep.resume", name="device")


def bad_input_is_one_line_and_leaves_nothing(program):
    good = {"over": ["amplitude=10:20:10"], "measure": "distance", "engine": None, "workers": 1}

    def problem(**changes):
        return program.must("sweep.check", **{**good, **changes})["problem"]

    assert problem(over=[]) == {"field": "over", "text": "found no quantity, expected one at least"}
    for over, words in (("amplitude=20:10:1", "a last value below the first"), ("amplitude=1:2:0", "not above 0"), ("amplitude=::", "VALUE"),
                        ("amplitude=1:2:x", "numbers"), ("seed=1:100001", "at most 100000 runs"), ("amplitude=0:500:1", "expected"),
                        ("none=1:2", "expected"), ("amplitude:J9=1:2", "expected"), ("=1:2", "no name"), ("amplitude", "no '='")):
        found = problem(over=["frequency=1:2", over])
        assert found["field"] == "over.1" and words in found["text"] and "\n" not in found["text"], (over, found)
    assert problem(over=["amplitude=1:50:0.01", "seed=1:100"])["field"] == "over.1"
    assert "twice" in problem(over=["amplitude=10:20", "amplitude=10:20"])["text"]
    assert problem(measure="none")["field"] == "measure"
    assert problem(engine="mujocoo")["field"] == "engine"
    # As many as may be, also of what reads the files again for each value.
    assert program.must("sweep.check", **{**good, "over": ["x=0:0.99999:0.00001"]})["runs"] == 100_000
    for changes in ({"over": "x"}, {"over": [1]}, {"measure": 1}, {"workers": 0}, {"workers": "2"}, {"workers": 10**6}):
        program.refused("sweep.check", **{**good, **changes})
    before = sorted(str(path) for path in program.folder.rglob("*"))
    for name in ("", "..", "a/b", ".hidden", "x" * 10_000, "a\nb", "\0"):
        program.refused("sweep.start", **{**good, "name": name})
    assert program.refused("sweep.start", **{**good, "name": "good", "over": ["amplitude=2:1"]}).startswith("over.0: found")
    program.refused("sweep.start", **{**good, "name": "good", "over": []})
    program.refused("sweep.estimate", **{**good, "over": []})
    for name in ("", "..", "/etc", "none", "sweeps", "sweeps/none", "../" + program.folder.name + "/shell"):
        for operation in ("open", "cells", "stop", "resume"):
            program.refused(f"sweep.{operation}", name=name)
        program.refused("sweep.cell", name=name, cell=0)
        program.refused("sweep.motion", name=name, cell=0)
    for cell in (3, 2**64 - 1, -1, "1", None):
        program.refused("sweep.cell", name="shell", cell=cell)
        program.refused("sweep.motion", name="shell", cell=cell)
    program.refused("sweep.cells", name="shell", measure="none")
    program.refused("sweep.none")
    assert sorted(str(path) for path in program.folder.rglob("*")) == before, "a refusal has left a file"

    # Names are names, whatever they look like.
    for name in ("<script>alert(1)</script>", "--help", "a b; rm -rf *", "$(x)", "Größe"):
        if "/" in name:
            program.refused("sweep.start", **{**good, "name": name})
        else:
            started = program.must("sweep.start", **{**good, "name": name})["name"]
            program.when(started, lambda found: found["state"] == "ended")
    parent = program.folder / "sweeps"
    parent.rename(program.folder / "kept")
    parent.write_text("not a folder")
    program.refused("sweep.start", **{**good, "name": "good"})
    parent.unlink()
    with tempfile.TemporaryDirectory() as outside:
        parent.symlink_to(outside)
        assert "a link to" in program.refused("sweep.start", **{**good, "name": "good"})
        assert not list(Path(outside).iterdir())
        parent.unlink()
    (program.folder / "kept").rename(parent)


with tempfile.TemporaryDirectory() as directory:
    folder = Path(directory) / "project"
    shutil.copytree(SOURCE / "sim/scenarios/travelling_wave", folder)
    with SweepProgram(PROGRAMS, folder) as program:
        program.must("draft.save")  # the duration
        a_map_has_the_means_of_its_runs(program)
        sweeps_of_others_are_found(program)
        a_sweep_outlives_the_program(program)
        a_killed_sweep_goes_on(program)
        damaged_folders_end_nothing(program)
        bad_input_is_one_line_and_leaves_nothing(program)
        program.end()
print("passed")

"""A live run is the run of `proleg simulate`, to the last bit of every pose, while the gallery and the foresight of Make are
computed in the same process. 20 joints: the engine's iterative solver, whose random numbers a process has only once.

Usage: live_beside_make_test.py SOURCE PROGRAMS"""

import contextlib
import json
import sqlite3
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE, PROGRAMS = Path(sys.argv[1]), Path(sys.argv[2])
sys.path[:0] = [str(SOURCE / "tests/host/server"), str(SOURCE / "tests/tools/proleg/ui")]
from ui_program import UiProgram  # noqa: E402

SCENARIOS = SOURCE / "sim/scenarios"
SENSOR = '<AttachedSensor name="touch"><link>Head</link><sensor type="TactileSensor"/></AttachedSensor>'
TICKS = 150
FORESIGHTS = 2


def long_chain(folder):
    """The scenario with 20 joints, in one folder, under the name that UiProgram opens. Its robot has a sensor that the reduced
    engine does not have, so that gallery and foresight are computed with the engine of the run."""
    files = {"long_chain/twenty.simulation.xml": "uniform.simulation.xml", "long_chain/twenty.robot.xml": "twenty.robot.xml",
             "long_chain/twenty.actuation.xml": "twenty.actuation.xml",
             "travelling_wave/flat.environment.xml": "flat.environment.xml"}
    for shipped, name in files.items():
        (folder / name).write_text((SCENARIOS / shipped).read_text().replace("../travelling_wave/", "")
                                   .replace("<duration>10<", "<duration>2<"))
    robot = folder / "twenty.robot.xml"
    robot.write_text(robot.read_text().replace("</Robot>", SENSOR + "</Robot>"))
    (folder / "modules").symlink_to(SCENARIOS / "travelling_wave/modules")


def value(page, document):
    return page.viewer.documents.get(document, {}).get("value") or {}


def run_beside_make(folder):
    """A recorded run during which Make works; what the page says of it, and the number of its ticks."""
    with UiProgram(PROGRAMS, folder) as page:
        page.must("record", file="live.proleg")
        page.must("gallery.look")
        page.must("run")
        made = 0
        while made < FORESIGHTS or value(page, "session")["tick"] < TICKS:
            revision = page.must("behaviour.set", module=0, parameter="amplitude", joints=[1], value=str(20 + made % 9))["revision"]
            page.viewer.until(lambda: value(page, "foresight").get("revision") == revision and value(page, "foresight")["is_complete"])
            made += 1
        page.must("pause")
        told = page.must("command_line")
        page.must("record", file=None)
        page.end()
    with contextlib.closing(sqlite3.connect(folder / "live.proleg")) as recording:
        (ticks,), = recording.execute("SELECT count(DISTINCT tick) FROM pose")
    return told, ticks


def program(*words):
    done = subprocess.run([PROGRAMS / "proleg", *map(str, words)], capture_output=True, text=True)
    assert done.returncode == 0, (words, done.stdout, done.stderr)
    return done.stdout


with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    long_chain(folder)
    told, ticks = run_beside_make(folder)
    assert ticks >= TICKS, ticks
    alone = json.loads(program("simulate", folder / "uniform.simulation.xml", "--seconds", f"{ticks / 100:.2f}",
                               "--record", folder / "alone.proleg", "--json"))
    with contextlib.closing(sqlite3.connect(folder / "live.proleg")) as recordings:
        recordings.execute("ATTACH ? AS alone", (str(folder / "alone.proleg"),))
        differing = recordings.execute("SELECT tick, link FROM main.pose EXCEPT SELECT tick, link FROM (SELECT * FROM main.pose "
                                       "INTERSECT SELECT * FROM alone.pose) ORDER BY 1, 2").fetchall()
    assert not differing, f"{len(differing)} of {21 * ticks} poses differ, first (tick, link) {differing[0]}"
    for hashed in ("setpoint_hash", "servo_hash", "motion_hash"):
        assert told[hashed] == alone[hashed], hashed
    replayed = json.loads(program("replay", folder / "live.proleg", "--json"))
    assert (replayed["differences"], replayed["motion"]["compared_ticks"]) == (0, ticks), replayed
    assert replayed["motion"]["hash"] == alone["motion_hash"]
print(f"{ticks} ticks beside {FORESIGHTS} foresights or more: all poses are those of proleg simulate")

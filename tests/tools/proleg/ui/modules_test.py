"""Modules on a table through `proleg ui`, as a page does it: with `proleg bus` in the place of a robot.

Usage: modules_test.py SOURCE PROGRAMS"""

import json
import shutil
import subprocess
import tempfile
from pathlib import Path

from module_table import PROGRAMS, SOURCE, Bus, Table, proleg, wait_until

JOINTS = [f"J{number}" for number in range(1, 6)]


def a_bus_is_opened_and_shows_what_is_on_it(table, bus):
    assert table.document("modules")["bus"] is None
    assert "no bus is open" in table.refused("modules.scan")
    silent = table.do("modules.examine", bus="tcp:127.0.0.1:1")
    assert [finding["code"] for finding in silent["result"]["findings"]] == ["bus_not_reached"], silent
    assert silent["command"] == "proleg doctor --bus tcp:127.0.0.1:1", silent
    for arguments in ({}, {"bus": "auto"}, {"bus": "fd:3"}, {"bus": "--help"}):
        table.refused("modules.examine", **arguments)
    for address in ("auto", "fd:0", "tcp:nowhere", "", "--help", 3, None, "tcp:127.0.0.1:1"):
        table.refused("modules.open", bus=address)
    table.must("modules.open", bus=bus.address)
    assert table.fresh("modules")["bus"] == bus.address
    assert "is open" in table.refused("modules.open", bus=bus.address)
    scan = table.do("modules.scan")
    assert scan["status"] == 0 and scan["kind"] == "scan" and scan["result"]["bus"] == bus.address, scan
    found = table.fresh("modules")["found"]
    assert [node["node"] for node in found["nodes"]] == [1, 4, 5] and found["fresh_modules"], found
    wait_until(lambda: [module["node"] for module in table.fresh("bus")["modules"]] == [1, 4, 5],
               lambda: table.document("bus"))
    module = wait_until(lambda: (modules := table.fresh("bus")["modules"]) and None not in (modules[0]["drive"], modules[0]["temperature"]) and modules[0],
                        lambda: table.document("bus"))
    assert module["drive"] == "no power" and module["joint"] is None and module["temperature"] == 25, module
    wait_until(lambda: table.fresh("bus")["modules"][0]["contacts"] is not None, lambda: table.document("bus"))


def objects_are_read_and_set(table):
    values = table.must("modules.read", node=4)["values"]
    temperature = next(value for value in values if value["object"] == "0x2009:2")
    assert temperature["value"] == "25 degC" and temperature["writable"] is False and temperature["help"], temperature
    assert len(table.must("modules.read", node=4, all=True)["values"]) > len(values)
    assert "= 300" in table.must("modules.set", node=4, object="0x6080", value="300")["text"]
    assert any(value["object"] == "0x6080" and value["value"].startswith("300")
               for value in table.must("modules.read", node=4)["values"])
    for arguments in ({"node": 0}, {"node": 127}, {"node": "3"}, {}):
        table.refused("modules.read", **arguments)
    assert "no answer" in table.refused("modules.read", node=77)
    for object_, value in (("0x6080", "fast"), ("0x6080", "100000000"), ("0x6041", "3"), ("nothing", "1"), ("--help", "1"),
                           ("0x6080", "1\n2"), ("0x6080", "x" * 10000)):
        table.refused("modules.set", node=4, object=object_, value=value)
    table.refused("modules.set", node=4, object="0x6080", value="-5")


def settings_are_kept_in_files(table, folder):
    for name in ("../a.params", "a.txt", ".params", "a/b.params", "x" * 100 + ".params", ""):
        table.refused("modules.save", file=name)
    saved = table.do("modules.save", file="table.params")
    assert saved["status"] == 0 and saved["result"]["modules"] == [1, 4, 5], saved
    assert (folder / "table.params").is_file() and table.fresh("modules")["settings"] == ["table.params"]
    assert "exists" in table.refused("modules.save", file="table.params")
    assert table.do("modules.compare", file="table.params")["result"]["differences"] == []
    table.must("modules.set", node=5, object="0x200A:1", value="1500", store=True)
    compared = table.do("modules.compare", file="table.params")
    assert compared["status"] == 1 and compared["error"] is None, compared
    difference, = compared["result"]["differences"]
    assert difference["node"] == 5 and difference["object"] == "0x200A:1" and "1500" in difference["found"], difference
    loaded = table.do("modules.load", file="table.params", store=True)
    assert loaded["status"] == 0 and loaded["result"]["changed"] == 1, loaded
    assert table.do("modules.compare", file="table.params")["result"]["differences"] == []
    table.refused("modules.compare", file="other.params")
    table.refused("modules.load", file="../table.params")


def modules_get_their_places(table, bus):
    joint_of = {joint["node"]: joint["name"] for joint in table.document("modules")["robot"]["joints"]}
    assert sorted(joint_of.values()) == JOINTS, joint_of
    assert table.document("modules")["robot"]["document"] == "draft_robot"
    number = table.must("modules.assign", amplitude=5)["job"]
    assert "another job goes on" in table.refused("modules.scan")
    seen, question = set(), {"number": 0}
    while (question := table.question(question["number"]))["question"] == "joint":
        joint = bus.joint_with_power()
        moves = table.document("module_job")["latest"]["moves"]
        assert moves["node"] == question["node"] and moves["degrees"] == 5, (moves, question)
        if not seen:  # a wrong word does not end it
            table.answer(question, "J77")
            question = table.question(question["number"])
            assert "J77" in table.document("module_job")["latest"]["refused"]["text"]
        seen.add(joint)
        table.answer(question, joint)
        table.refused("modules.answer", job=number, question=question["number"], word=joint)
    assert question["question"] == "agree" and question["changes"], question
    table.answer(question, "yes")
    end = table.job()
    assert end["status"] == 0 and end["result"], end
    found = wait_until(lambda: (found := table.fresh("modules")["found"]) and not found["fresh_modules"] and found,
                       lambda: table.document("modules"))
    assert [node["node"] for node in found["nodes"]] == [1, 2, 3, 4, 5], found
    table.must("modules.assign")
    number = 0
    for _ in JOINTS:  # now the node ids are those of the robot's file
        question = table.question(number)
        number = question["number"]
        assert bus.joint_with_power() == joint_of[question["node"]], question
        table.answer(question, joint_of[question["node"]])
    end = table.job()
    places = {place["node"]: place["joint"] for place in end["latest"]["places"]["modules"]}
    assert end["status"] == 0 and places == joint_of, end


def a_joint_stops_when_nobody_looks(table, bus):
    """By STOP, by the word of its driver, and because the driver has gone."""
    for end in ("cancel", "stop", "quit", "silence"):
        table.must("modules.assign")
        question = table.question()
        bus.joint_with_power()
        if end == "cancel":
            table.must("modules.cancel", job=table.document("module_job")["number"])
        elif end == "stop":
            table.viewer.send({"type": "stop"})
        elif end == "silence":
            table.lives.clear()
        else:
            table.answer(question, "quit")
        job = table.job()
        assert job["status"] in (1, None), job
        assert bool(job["ended_by"]) == (end != "quit"), job
        no_servo_has_power(bus)
    assert job["ended_by"] == "nobody drives", job
    table.lives.set()


def no_servo_has_power(bus):
    def states():
        return json.loads(proleg("get", "all", "statusword", "--bus", bus.address, "--json"))["values"]
    wait_until(lambda: len(now := states()) == 5 and all(state["raw"] & 0x6F not in (0x27, 0x07) for state in now), states)


def a_potentiometer_is_calibrated(table, bus):
    """Nobody turns the simulated joint: it stays at 0 degrees, so both readings are equal. Its module came without a
    node id, and knows no potentiometer."""
    table.must("modules.calibrate", node=2)
    lower = table.question()
    assert lower["question"] == "lower" and lower["node"] == 2, lower
    reading = table.job(lambda job: "reading" in job["latest"])["latest"]["reading"]
    assert reading["reading"] == 2048 and reading["angle"] is None, reading
    table.answer(lower, "here")
    upper = table.question(lower["number"])
    assert upper["question"] == "upper", upper
    table.answer(upper, "here")
    job = table.job()
    assert job["status"] == 1 and "is a potentiometer wired" in job["error"], job


def an_image_is_flashed(table, bus, folder):
    assert not [image for image in table.document("modules")["images"] if image["file"] == "broken.pimg"]
    (folder / "broken.pimg").write_bytes(b"PIMG nothing")
    (folder / "images").mkdir()
    other = subprocess.run([PROGRAMS / "proleg", "image", "--help"], capture_output=True, text=True).stdout
    assert other
    table.must("modules.look")
    images = {image["file"]: image for image in table.fresh("modules")["images"]}
    assert images["broken.pimg"]["problem"] and images["broken.pimg"]["version"] is None, images
    table.refused("modules.flash", image="broken.pimg")
    table.refused("modules.flash", image="/etc/passwd")
    built = [image for image in images.values() if image["problem"] is None]
    if not built:
        return  # the image of the modules was not built beside these programs
    dry = table.do("modules.flash", image=built[0]["file"], dry_run=True)
    assert dry["status"] == 0 and len(dry["latest"]["verdicts"]["modules"]) == 5, dry
    one = table.do("modules.flash", image=built[0]["file"], canary=True, force_board=True, allow_downgrade=True)
    assert {module["serial"] for module in one["result"]["modules"]} == \
        {module["serial"] for module in dry["latest"]["verdicts"]["modules"]}, one


def the_doctor_says_what_is_wrong(table):
    job = table.do("modules.examine")
    assert job["status"] in (0, 1) and isinstance(job["result"]["findings"], list), job
    recover = table.do("modules.recover", dry_run=True, wait=0)
    assert recover["status"] == 0 and len(recover["result"]["modules"]) == 5, recover


def with_a_bus_of_viewers(folder):
    with Bus("--shuffle", "7", "--fresh", "2,4") as bus:
        with Table(folder) as table:
            a_bus_is_opened_and_shows_what_is_on_it(table, bus)
            objects_are_read_and_set(table)
            settings_are_kept_in_files(table, folder)
            modules_get_their_places(table, bus)
            a_joint_stops_when_nobody_looks(table, bus)
            a_potentiometer_is_calibrated(table, bus)
            an_image_is_flashed(table, bus, folder)
            the_doctor_says_what_is_wrong(table)
            table.must("modules.close")
            assert table.fresh("modules")["bus"] is None


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copytree(SOURCE / "sim/scenarios/travelling_wave", folder, dirs_exist_ok=True)
        with_a_bus_of_viewers(folder)


if __name__ == "__main__":
    main()

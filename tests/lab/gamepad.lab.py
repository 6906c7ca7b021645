#!/usr/bin/python3
"""A gamepad drives the simulated robot of `proleg ui`: a stick moves a parameter, a held button runs the robot, and
unplugging is letting go. The gamepads are devices that the kernel makes itself (uinput)."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

sys.dont_write_bytecode = True
CHECKS = Path(os.environ["PROLEG_LAB_CHECKS"])
sys.path[:0] = [str(CHECKS), str(CHECKS.parent / "host" / "server")]
from gamepad_device import ABS_X, ABS_Y, BTN_EAST, BTN_SOUTH, EV_ABS, EV_KEY, Gamepad  # noqa: E402
from web_client import Viewer  # noqa: E402


def expect(found, expected, what):
    if found != expected:
        sys.exit(f"{what}: found {found}, expected {expected}")


def figure(text):
    with open("figures", "a", encoding="utf-8") as file:
        print(text, file=file)


def own_scenario():
    """The robot that floats, in this folder, where bindings can be saved."""
    tree = CHECKS.parents[1]
    for name in ("five.simulation.xml", "floating.environment.xml"):
        text = (CHECKS / "floating" / name).read_text()
        Path(name).write_text(text.replace("../../../sim/", f"{tree}/sim/"))
    Path("page").mkdir()
    Path("page/index.html").write_text("<!doctype html><title>page</title>")
    return "five.simulation.xml"


class Ui:
    """`proleg ui`, and a viewer that has control."""

    def __init__(self, scenario):
        program = Path(os.environ["PROLEG_BIN"]) / "proleg-ui"
        self.process = subprocess.Popen([program, scenario, "--paused", "--no-browser", "--page", "page"],
                                        stdout=subprocess.PIPE, text=True)
        port, token = re.search(r":(\d+)/#(\S+)", self.process.stdout.readline()).groups()
        self.viewer = Viewer(int(port), token)
        self.epoch = self.viewer.take_control()

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        expect(self.process.wait(30), 0, "exit status of proleg ui")

    def do(self, name, **arguments):
        """Beats while it waits, as a page does: a holder who is silent is away."""
        return self.finish(self.viewer.start(name, self.epoch, **arguments))

    def finish(self, number):
        self.until(lambda: number in self.viewer.results, f"an answer to operation {number}")
        result = self.viewer.results[number]
        expect(result["ok"], True, result.get("error"))
        return result.get("value")

    def until(self, condition, what):
        end = time.monotonic() + 60
        last_beat = 0
        while not condition():
            now = time.monotonic()
            if now > end:
                sys.exit(f"found no {what}; documents: {self.viewer.documents}")
            if now - last_beat > 0.1:
                self.viewer.send({"type": "beat", "age_ms": 1})
                last_beat = now
            if self.viewer.has_data(0.05):
                self.viewer.next()

    def document(self, name):
        return self.viewer.documents[name]["value"] if name in self.viewer.documents else None

    def amplitudes(self):
        """Wanted and confirmed amplitude of all joints, in whole degrees."""
        parameter = next(value for value in self.document("parameters") if value["name"] == "amplitude")
        return {round(raw * parameter["scale"]) for raw in parameter["wanted"] + parameter["confirmed"]}

    def devices(self):
        remote = self.document("remote")
        return remote and [device["name"] for device in remote["devices"]]

    def state(self):
        return self.document("session")["state"]


def learn(ui, move):
    number = ui.viewer.start("remote.learn", ui.epoch)
    ui.until(lambda: ui.document("remote")["learning"], "learning")
    move()
    return ui.finish(number)


def check_parameter(ui, pad):
    learned = learn(ui, lambda: pad.stick(ABS_X, 1))
    expect(learned, {"device": "Lab pad", "element": "ABS_X", "kind": "axis"}, "the learned element")
    pad.stick(ABS_X, -1)
    ui.do("remote.bind", binding={"device": "Lab pad", "element": "ABS_X", "parameters": ["amplitude"],
                                  "lower": 0, "upper": 80, "step": 1})
    of_file = ui.amplitudes()
    ui.do("run")
    for position in (-0.9, -0.5, 0, 0.5):
        pad.stick(ABS_X, position)
    ui.until(lambda: ui.amplitudes() == {60}, "amplitude of 60 degrees that all joints have confirmed")
    ui.do("undo")
    ui.until(lambda: ui.amplitudes() == of_file, "amplitude of the file after undo")
    pad.stick(ABS_X, 0.6)  # above the present value: it has to be taken up again
    started = time.monotonic()
    pad.stick(ABS_X, -0.5)
    ui.until(lambda: ui.amplitudes() == {20}, "amplitude of 20 degrees that all joints have confirmed")
    figure(f"stick to confirmed parameter: {1000 * (time.monotonic() - started):.0f} ms")
    ui.do("pause")


def check_hold_to_run(ui, pad):
    learned = learn(ui, lambda: pad.button(BTN_SOUTH, True))
    expect(learned["element"], "BTN_SOUTH", "the learned button")
    pad.button(BTN_SOUTH, False)
    ui.do("remote.bind", binding={"device": "Lab pad", "element": "BTN_SOUTH", "action": "hold_to_run"})
    ui.until(lambda: ui.state() == "paused", "paused robot")
    pad.button(BTN_SOUTH, True)
    ui.until(lambda: ui.state() == "running", "robot that runs while the button is held")
    pad.button(BTN_SOUTH, False)
    ui.until(lambda: ui.state() == "paused", "pause when the button is released")


def check_dropped_events(ui, pad):
    """More events than the kernel keeps, and the release among them: it must be found again."""
    pad.button(BTN_SOUTH, True)
    ui.until(lambda: ui.state() == "running", "robot that runs while the button is held")
    ui.process.send_signal(signal.SIGSTOP)
    pad.write((EV_KEY, BTN_SOUTH, 0))
    for i in range(2000):
        pad.write((EV_ABS, ABS_Y, i))
    ui.process.send_signal(signal.SIGCONT)
    ui.until(lambda: ui.state() == "paused", "pause, although the event of the release was dropped")
    expect(ui.document("remote")["active"], True, "effect of the remote control")


def check_unplugging(ui, pad):
    pad.button(BTN_SOUTH, True)
    ui.until(lambda: ui.state() == "running", "robot that runs while the button is held")
    started = time.monotonic()
    pad.unplug()
    ui.until(lambda: ui.state() == "paused", "pause when the gamepad is unplugged")
    figure(f"unplugged to paused: {1000 * (time.monotonic() - started):.0f} ms")
    ui.until(lambda: ui.devices() == [], "remote control without devices")


def check_without_control(ui, pad):
    ui.do("remote.bind", binding={"device": "Lab pad", "element": "BTN_EAST", "action": "stop"})
    ui.do("run")
    amplitudes = ui.amplitudes()
    ui.do("control.release")
    ui.until(lambda: not ui.document("remote")["active"], "remote control without effect")
    pad.stick(ABS_X, 1)
    pad.stick(ABS_X, -1)
    pad.button(BTN_EAST, True)
    ui.until(lambda: ui.state() == "stopped", "STOP by the gamepad, without control")
    expect(ui.document("session")["stopped_by"], "Lab pad", "who has stopped the robot")
    expect(ui.amplitudes(), amplitudes, "amplitude, which nobody may change")
    pad.button(BTN_EAST, False)
    ui.epoch = ui.viewer.take_control()


def main():
    subprocess.run(["modprobe", "-a", "uinput", "evdev"], check=True)
    scenario = own_scenario()
    ui = Ui(scenario)
    ui.until(lambda: ui.devices() == [], "remote control without devices, although this computer has a keyboard")
    with Gamepad() as pad:
        ui.until(lambda: ui.devices() == ["Lab pad"], "gamepad that was plugged in")
        check_parameter(ui, pad)
        check_hold_to_run(ui, pad)
        check_dropped_events(ui, pad)
        check_unplugging(ui, pad)
    with Gamepad() as pad:
        ui.until(lambda: ui.devices() == ["Lab pad"], "gamepad that was plugged in again")
        check_without_control(ui, pad)
        ui.do("remote.save")
        bindings = ui.document("remote")["bindings"]
        ui.end()
        ui = Ui(scenario)
        ui.until(lambda: ui.devices() == ["Lab pad"], "gamepad that was there before")
        expect(ui.document("remote")["bindings"], bindings, "bindings of the next start")
    with Gamepad("Nintendo Wii Remote Accelerometer", keys=(), axes=(ABS_X,)):
        ui.until(lambda: "Nintendo Wii Remote Accelerometer" in ui.devices(), "a part of a Wiimote")
    ui.end()


if __name__ == "__main__":
    main()

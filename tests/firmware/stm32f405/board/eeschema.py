"""KiCad 6's schematic editor without a screen. It has no command line, so keys open its menus, under Xvfb."""

import json
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

# Programs and the Debian packages that have them.
PROGRAMS = {"eeschema": "kicad", "Xvfb": "xvfb", "xdotool": "xdotool"}
LONGEST = 120  # seconds that a window or a file may take
ATTEMPTS = 12
PDF = 4  # KiCad's number of the format
# Places in the menu File of KiCad 6.0, counted from its first entry.
EXPORT, PLOT = 7, 11


def missing_packages():
    return [package for program, package in PROGRAMS.items() if not shutil.which(program)]


class Eeschema:
    """Opens a schematic. folder: for settings, and for what KiCad writes."""

    def __init__(self, folder, schematic):
        self.folder, self.schematic = Path(folder), Path(schematic)
        self.processes = []

    def __enter__(self):
        try:
            self.start()
        except BaseException:
            self.stop()
            raise
        return self

    def __exit__(self, *_):
        self.stop()

    def start(self):
        settings = self.folder / "home/.config/kicad/6.0"
        settings.mkdir(parents=True)
        # Without these files KiCad asks questions at its first start.
        (settings / "sym-lib-table").write_text("(sym_lib_table\n)\n")
        (settings / "fp-lib-table").write_text("(fp_lib_table\n)\n")
        (settings / "kicad_common.json").write_text(json.dumps({"meta": {"filename": "kicad_common.json", "version": 3}, "do_not_show_again": {
            "zone_fill_warning": True, "env_var_overwrite_warning": True, "scaled_3d_models_warning": True, "data_collection_prompt": True}}))
        (settings / "eeschema.json").write_text(json.dumps({"meta": {"filename": "eeschema.json", "version": 1}, "plot": {
            "format": PDF, "color": True, "frame_reference": True}}))
        self.environment = {**os.environ, "HOME": str(self.folder / "home"), "LC_ALL": "C.UTF-8"}
        for name in ("XDG_CONFIG_HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME", "XDG_DATA_HOME", "KICAD_CONFIG_HOME"):
            self.environment.pop(name, None)
        reader, writer = os.pipe()
        self.run(["Xvfb", "-displayfd", str(writer), "-nolisten", "tcp", "-screen", "0", "1600x1200x24"], pass_fds=(writer,))
        os.close(writer)
        with os.fdopen(reader) as display:
            self.environment["DISPLAY"] = ":" + display.readline().strip()
        self.run(["eeschema", str(self.schematic)])
        self.window = self.wait_for_window("Schematic Editor")

    def run(self, command, **more):
        with (self.folder / f"{command[0]}.log").open("w") as log:
            self.processes.append(subprocess.Popen(command, env=self.environment, stdout=log, stderr=log, start_new_session=True, **more))

    def stop(self):
        for process in reversed(self.processes):
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            process.wait()
        self.processes = []

    def xdotool(self, *arguments):
        return subprocess.run(["xdotool", *map(str, arguments)], env=self.environment, capture_output=True, text=True, check=False).stdout

    def windows(self):
        found = self.xdotool("search", "--onlyvisible", "--name", ".").split()
        return {self.xdotool("getwindowname", window).strip(): window for window in found}

    def wait(self, what, condition):
        end = time.monotonic() + LONGEST
        while time.monotonic() < end:
            value = condition()
            if value:
                return value
            for process in self.processes:
                if process.poll() is not None:
                    raise RuntimeError(f"{process.args[0]} ended with status {process.returncode}: see {self.folder}/{process.args[0]}.log")
            time.sleep(0.2)
        raise RuntimeError(f"found windows {', '.join(self.windows())} after {LONGEST} s, expected {what}")

    def wait_for_window(self, name):
        window = self.wait(f"the window {name}", lambda: next((number for title, number in self.windows().items() if name in title), None))
        self.wait(f"the focus of {name}", lambda: self.xdotool("windowfocus", window, "getwindowfocus").strip() == window)
        return window

    def keys(self, *names):
        self.xdotool("key", "--delay", "60", *names)
        time.sleep(0.5)

    def wait_for_file(self, path):
        def is_complete():
            size = path.stat().st_size if path.exists() else 0
            time.sleep(0.3)
            return size > 0 and path.stat().st_size == size
        self.wait(f"the file {path.name}", is_complete)
        return path

    def wait_for_close(self, name):
        self.wait(f"no window {name}", lambda: not any(name in title for title in self.windows()))
        self.wait_for_window("Schematic Editor")

    def open_dialog(self, name, *keys):
        """Keys that come while KiCad draws are lost, so they are repeated."""
        for _ in range(ATTEMPTS):
            self.wait_for_window("Schematic Editor")
            self.keys("Escape", "alt+f")
            self.keys(*keys)
            end = time.monotonic() + LONGEST / ATTEMPTS
            while time.monotonic() < end:
                if any(name in title for title in self.windows()):
                    return self.wait_for_window(name)
                time.sleep(0.2)
        raise RuntimeError(f"found windows {', '.join(self.windows())} after {ATTEMPTS} attempts, expected {name}")

    def export_netlist(self):
        self.open_dialog("Export Netlist", *["Down"] * EXPORT, "Right", "Down", "Return")
        self.keys("Return")
        self.wait_for_window("Save Netlist File")
        self.keys("Return")
        path = self.wait_for_file(self.schematic.with_suffix(".net"))
        self.wait_for_close("Export Netlist")
        return path

    def plot(self):
        self.open_dialog("Plot Schematic", *["Down"] * PLOT, "Return")
        self.keys("Return")
        path = self.wait_for_file(self.schematic.with_suffix(".pdf"))
        self.keys("Escape")
        self.wait_for_close("Plot Schematic")
        return path

"""A viewer with the secret of the page sends as much as it may, again and again: the memory of `proleg ui` grows by no more than
64 MiB, and the robot still answers.

Usage: client_memory_test.py SOURCE PROGRAMS"""

import base64
import math
import random
import re
import shutil
import struct
import sys
import tempfile
from pathlib import Path

SOURCE, PROGRAMS = Path(sys.argv[1]), Path(sys.argv[2])
SEED = 48
MOST = 64  # MiB
LARGEST_PART = 45_000  # bytes; a message has at most 64 KiB
sys.path[:0] = [str(SOURCE / place) for place in ("tests/host/server", "tests/support", "tests/tools/proleg/ui")]
from ui_program import UiProgram  # noqa: E402
from waiting import wait_until  # noqa: E402


def sphere(meridians):
    """A binary STL file of a closed sphere of 80 mm: meridians * (meridians - 2) triangles."""
    rings = meridians // 2

    def corner(ring, meridian):
        if ring in (0, rings):
            return 0.0, 0.0, 40.0 if ring == 0 else -40.0
        across, around = math.pi * ring / rings, 2 * math.pi * (meridian % meridians) / meridians
        return 40 * math.sin(across) * math.cos(around), 40 * math.sin(across) * math.sin(around), 40 * math.cos(across)

    triangles = []
    for ring in range(rings):
        for meridian in range(meridians):
            a, b = corner(ring, meridian), corner(ring, meridian + 1)
            c, d = corner(ring + 1, meridian + 1), corner(ring + 1, meridian)
            triangles += [(a, d, b)] * (ring > 0) + [(b, d, c)] * (ring < rings - 1)
    faces = [struct.pack("<12fH", 0, 0, 0, *a, *b, *c, 0) for a, b, c in triangles]
    return bytes(80) + struct.pack("<I", len(faces)) + b"".join(faces)


class Client(UiProgram):
    def memory(self):
        """MiB that the program has now (proc(5))."""
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(re.search(r"VmRSS:\s+(\d+) kB", status)[1]) / 1024

    def send(self, name, data, share=1.0):
        """A mesh; with a share below 1 its transfer is never ended."""
        mesh = self.must("mesh.begin", files=[{"name": name, "bytes": len(data)}])["mesh"]
        for at in range(0, int(share * len(data)), LARGEST_PART):
            part = base64.b64encode(data[at : at + LARGEST_PART]).decode()
            self.must("mesh.part", mesh=mesh, file=0, at=at, data=part)
        return mesh


def main():
    random.seed(SEED)
    large, largest = sphere(282), sphere(316)
    fit = {"factor": 0.001, "quarters": [0, 0, 0], "colour": [0.6, 0.5, 0.4]}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copytree(SOURCE / "sim/scenarios/travelling_wave", folder, dirs_exist_ok=True)
        with Client(PROGRAMS, folder) as program:
            program.must("draft.refresh")
            start = program.memory()
            figures = {}

            def note(what):
                # What it is computing ends, and the journal is written.
                wait_until(lambda: program.memory() - start <= MOST,
                           lambda: f"{what}: found {program.memory() - start:.0f} MiB more, expected at most {MOST}")
                figures[what] = round(program.memory() - start, 1)

            added = 0
            for number in range(6):
                mesh = program.send(f"m{number}.stl", struct.pack("<I", number) + large[4:])
                program.must("mesh.look", mesh=mesh)
                words = {"mesh": mesh, **fit, "sheet": False, "position": [0, 1 + number, 0], "turn": 0}
                added += program.ask("world.add_mesh", **words)["ok"]
            assert added == 1, f"{added} meshes of {len(large) // 50} triangles"
            note("meshes in the world")
            module = {"mesh": mesh, **fit, "name": "shell", "length": 0.07, "mass": 0.1}
            assert not program.ask("robot.own_module", **module)["ok"]
            for _ in range(4):
                assert program.ask("draft.undo")["ok"]
                assert program.ask("robot.own_module", **module)["ok"]
                assert program.ask("draft.undo")["ok"]
                words["factor"] = round(random.uniform(0.0005, 0.002), 6)
                assert program.ask("world.add_mesh", **words)["ok"]
            note("meshes taken back and added again")
            program.must("load_draft")
            program.must("step", ticks=20)
            note("simulated")
            for number in range(3):
                mesh = program.send(f"n{number}.stl", struct.pack("<I", number) + largest[4:])
                program.must("mesh.look", mesh=mesh)
            note("meshes that are not used")
            for _ in range(3):
                program.send("never.obj", bytes(16 << 20), share=0.9)
            note("transfers that never end")
            for number in range(200):
                assert program.ask("world.rename", object=0, name="x" * (number % 50 + 1))["ok"]
            note("200 changes")
            program.must("step", ticks=20)
            print(f"seed {SEED}, MiB more than the {start:.0f} at the start: {figures}")
            program.end()


main()

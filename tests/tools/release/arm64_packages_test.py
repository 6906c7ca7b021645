#!/usr/bin/env python3
"""The Debian packages for arm64, such as Raspberry Pi OS: they are those for amd64 but for the processor, and run with what they depend on.

usage: arm64_packages_test.py SOURCE_FOLDER

tools/release makes the packages, unless the variable PROLEG_DEBS names a folder with them. apt for arm64 chooses and fetches what they depend
on, and unpacks all of it into a folder; PRoot and QEMU run the programs there. Needs a mirror of Debian, and is skipped without it.
"""

import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from urllib.error import URLError
from urllib.request import urlopen

MIRROR = "http://deb.debian.org/debian"
LONGEST = 1800  # s, of one command: the emulator is much slower than a processor
LARGEST = 60e6  # bytes installed
ELF = b"\x7fELF"
AARCH64 = 183  # e_machine, at byte 18
LARGEST_PAGE = 65536  # bytes; a Raspberry Pi 5 has pages of 16384
ENVIRONMENT = {"PATH": "/usr/bin:/bin", "HOME": "/tmp"}
# What differs in control files of one package.
OF_AN_ARCHITECTURE = ("Architecture", "Depends", "Installed-Size")


def run(*command, **options):
    result = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST, check=False, **options)
    if result.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}: {result.returncode}\n{result.stdout[-4000:]}{result.stderr[-4000:]}")
    return result.stdout


def names_of(text):
    """Names of the packages in a field of dependencies, without versions."""
    return {re.split(r"[ (|:]", word.strip())[0] for word in text.split(",")}


def files_below(folder):
    """Files by their places. Python's modules have the processor in their names."""
    return {str(path.relative_to(folder)).replace("x86_64-linux-gnu.so", "aarch64-linux-gnu.so"): path
            for path in folder.rglob("*") if path.is_symlink() or not path.is_dir()}


def is_program(path):
    return not path.is_symlink() and path.read_bytes()[:4] == ELF


class Arm64Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        try:
            urlopen(MIRROR + "/dists/bookworm/Release", timeout=30).close()
        except (URLError, OSError) as error:
            print(f"skipped: found no answer of {MIRROR}: {error}", flush=True)
            raise unittest.SkipTest("no mirror of Debian") from error
        cls.folder = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        debs = os.environ.get("PROLEG_DEBS")
        if not debs:
            debs = cls.folder / "debs"
            run(SOURCE / "tools/release", "--debs", debs)
        # By architecture and package.
        cls.debs, cls.trees = {"amd64": {}, "arm64": {}}, {"amd64": {}, "arm64": {}}
        for deb in sorted(Path(debs).resolve().glob("*.deb")):
            package, _, architecture = deb.stem.split("_")
            if architecture in cls.debs:
                cls.debs[architecture][package] = deb
                cls.trees[architecture][package] = cls.folder / architecture / package
                cls.trees[architecture][package].mkdir(parents=True)
                run("dpkg-deb", "--raw-extract", deb, cls.trees[architecture][package])
        # apt installs packages whose dependencies it finds, or fails.
        cls.root = cls.folder / "debian"
        place = shlex.quote(str(Path(debs).resolve()))
        run("mmdebstrap", "--quiet", "--mode=chrootless", "--variant=extract", "--architectures=arm64",
            *(f"--include={deb}" for deb in cls.debs["arm64"].values()),
            f'--setup-hook=mkdir -p "$1"{place} && cp {place}/*.deb "$1"{place}', "bookworm", cls.root)

    @classmethod
    def fields(cls, architecture, package):
        text = run("dpkg-deb", "--field", cls.debs[architecture][package])
        return dict(re.findall(r"(?m)^([\w-]+): (.*(?:\n .*)*)", text))

    @classmethod
    def programs(cls):
        """The programs and libraries for arm64, by their places, without the programs of modules."""
        for tree in cls.trees["arm64"].values():
            for name, path in files_below(tree).items():
                if name.startswith("usr/lib/") and is_program(path):
                    yield name, path

    @classmethod
    def command(cls, *words, emulator="qemu-aarch64"):
        return ["proot", "-q", emulator, "-r", cls.root, "-b", "/proc", "-b", "/dev", "-w", "/tmp", *words]

    @classmethod
    def emulated(cls, *words, **options):
        return run(*cls.command(*words, **options), env=ENVIRONMENT)

    def here(self, *words):
        return run(self.trees["amd64"]["proleg"] / "usr/bin/proleg", *words)

    def test_they_have_the_files_of_amd64_but_for_the_processor_of_the_programs(self):
        self.assertEqual(set(self.debs["arm64"]), set(self.debs["amd64"]))
        for package in self.debs["arm64"]:
            expected, found = (files_below(self.trees[architecture][package]) for architecture in ("amd64", "arm64"))
            self.assertEqual(sorted(found), sorted(expected), package)
            equal = 0
            for name, path in found.items():
                self.assertEqual(path.lstat().st_mode, expected[name].lstat().st_mode, name)
                if path.is_symlink():
                    self.assertEqual(os.readlink(path), os.readlink(expected[name]), name)
                elif not name.startswith("DEBIAN/") and not (name.startswith("usr/lib/") and is_program(path)):
                    self.assertEqual(path.read_bytes(), expected[name].read_bytes(), name)
                    equal += 1
            size = int(self.fields("arm64", package)["Installed-Size"]) * 1024
            print(f"{package}: {len(found)} files, {equal} of which are equal; {self.debs['arm64'][package].stat().st_size / 1e6:.1f} MB, "
                  f"installed {size / 1e6:.1f} MB", flush=True)
            self.assertLessEqual(size, LARGEST, package)

    def test_their_control_files_differ_in_the_versions_of_libraries_alone(self):
        for package in self.debs["arm64"]:
            # Nothing that apt or dpkg would have to run on the robot, but what Python's modules need.
            scripts = ["postinst", "prerm"] if package == "python3-proleg" else []
            self.assertEqual(sorted(path.name for path in (self.trees["arm64"][package] / "DEBIAN").iterdir()), ["control", "md5sums", *scripts])
            expected, found = (self.fields(architecture, package) for architecture in ("amd64", "arm64"))
            self.assertEqual(found["Architecture"], "arm64")
            self.assertEqual({name for name in {**found, **expected} if found.get(name) != expected.get(name)} - set(OF_AN_ARCHITECTURE), set())
            self.assertEqual(names_of(found["Depends"]), names_of(expected["Depends"]))
            print(f"{package}: Depends: {found['Depends']}", flush=True)

    def test_every_program_is_for_arm64_and_for_pages_of_any_size(self):
        programs = dict(self.programs())
        self.assertGreater(len(programs), 30)
        for name, path in programs.items():
            header = path.read_bytes()[:20]
            self.assertEqual(int.from_bytes(header[18:20], "little"), AARCH64, name)
            segments = re.findall(r"(?m)^ +LOAD .* (0x[0-9a-f]+)$", run("readelf", "--program-headers", "--wide", path))
            self.assertGreater(len(segments), 1, name)
            self.assertEqual({int(alignment, 16) % LARGEST_PAGE for alignment in segments}, {0}, name)
            self.assertNotIn(".symtab", run("readelf", "--sections", "--wide", path), name)

    def test_every_library_that_they_need_comes_with_what_they_depend_on(self):
        present = {path.name for folder in ("lib", "usr/lib") for path in (self.root / folder / "aarch64-linux-gnu").iterdir()}
        present.add("ld-linux-aarch64.so.1")
        needed = set()
        for name, path in self.programs():
            libraries = set(re.findall(r"\(NEEDED\).*\[(.*)\]", run("readelf", "--dynamic", "--wide", path)))
            self.assertEqual(libraries - present, set(), name)
            needed |= libraries
        self.assertIn("libode.so.8", needed)
        print(f"{len(needed)} libraries are needed and come with the packages", flush=True)

    def test_every_program_starts(self):
        self.assertIn("simulate", self.emulated("proleg", "--help"))
        for name, path in self.programs():
            if name.startswith("usr/lib/proleg/bin/"):
                # The optimiser on a cluster starts by mpirun alone, and says so.
                found, expected = (subprocess.run([*command, "--help"], capture_output=True, text=True, timeout=LONGEST, env=ENVIRONMENT, check=False)
                                   for command in (self.command(f"/{name}"), [str(path).replace("/arm64/", "/amd64/")]))
                self.assertEqual((found.returncode, found.stdout, found.stderr), (expected.returncode, expected.stdout, expected.stderr), name)

    def test_a_robot_crawls_with_the_bits_of_amd64(self):
        self.assertEqual(self.emulated("proleg", "scenarios"), self.here("scenarios").replace(str(self.trees["amd64"]["proleg"]), ""))
        for engine, hashes in (("ode", ("setpoint_hash", "servo_hash")), ("reduced", ("setpoint_hash", "servo_hash", "world_hash"))):
            words = ("simulate", "caterpillar", "--seconds", "5", "--engine", engine, "--json")
            found, expected = json.loads(self.emulated("proleg", *words)), json.loads(self.here(*words))
            self.assertEqual([found[name] for name in hashes], [expected[name] for name in hashes], engine)

    def test_python_has_the_bits_of_amd64(self):
        code = "import proleg; run = proleg.simulate('caterpillar', seconds=2, engine='reduced'); print(run.setpoint_hash, run.servo_hash, run.world_hash)"
        expected = json.loads(self.here("simulate", "caterpillar", "--seconds", "2", "--engine", "reduced", "--json"))
        # The scripts of packages have not run here: no links name the libraries that update-alternatives chooses.
        of_numpy = {**ENVIRONMENT, "LD_LIBRARY_PATH": "/usr/lib/aarch64-linux-gnu/blas:/usr/lib/aarch64-linux-gnu/lapack"}
        self.assertEqual(run(*self.command("python3", "-c", code), env=of_numpy).split(),
                         [str(expected[name]) for name in ("setpoint_hash", "servo_hash", "world_hash")])

    def test_modules_and_the_flashed_image_repeat_it_also_with_pages_of_16_kib(self):
        words = ("hil", "caterpillar", "--modules", "1=mcu", "--seconds", "0.5", "--json")
        expected = json.loads(self.here(*words))
        for emulator in ("qemu-aarch64", "qemu-aarch64 -p 16384"):
            found = json.loads(self.emulated("proleg", *words, emulator=emulator))
            self.assertEqual(found["differences"], 0, emulator)
            for name in ("setpoint_hash", "servo_hash"):
                self.assertEqual(found[name], expected[name], emulator)

    def test_the_page_answers(self):
        with subprocess.Popen(self.command("proleg", "ui", "caterpillar", "--no-browser", "--recordings", "/tmp"), env=ENVIRONMENT,
                              stdout=subprocess.PIPE, text=True, start_new_session=True) as program:
            try:
                address = re.search(r"http://\S+", program.stdout.readline()).group().split("#")[0]
                with urlopen(address, timeout=LONGEST) as answer:
                    self.assertEqual(answer.read(), (self.root / "usr/share/proleg/page/index.html").read_bytes())
            finally:
                os.killpg(program.pid, signal.SIGINT)  # as a terminal does; PRoot passes no signal on
                self.assertEqual(program.wait(LONGEST), 0)


if __name__ == "__main__":
    SOURCE = Path(sys.argv[1]).resolve()
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])

#!/usr/bin/env python3
"""The Debian packages on an empty Debian 12: what a user has after `apt install ./proleg_*.deb`, and after `apt purge proleg`.

usage: debian_packages_test.py SOURCE_FOLDER

tools/release makes the packages, unless the variable PROLEG_DEBS names a folder with them. Needs root, debootstrap and a mirror of Debian; says
which of them is missing, and is skipped then. PROLEG_DEBIAN names a folder with a Debian that debootstrap has made before; it is used as it is.
"""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from urllib.error import URLError
from urllib.request import urlopen

sys.dont_write_bytecode = True
sys.path.append(str(Path(__file__).resolve().parents[1] / "proleg"))
from own_algorithm_commands import OrdinaryUser, commands_of, in_the_test, parts_of  # noqa: E402

MIRROR = "http://deb.debian.org/debian"
LONGEST = 1200  # s, of one command
LARGEST = 60e6  # bytes installed
# What apt and dpkg keep of any package, what runs, and what users write.
NOT_OF_A_PACKAGE = ("proc", "sys", "dev", "run", "tmp", "var/cache", "var/log", "var/lib/apt", "var/lib/dpkg")
OWN = ("proleg", "proleg-dev", "python3-proleg")  # the packages whose files must go


def run(*command, **options):
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=LONGEST, check=False, **options)
    if result.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}: {result.returncode}\n{result.stdout[-4000:]}")
    return result.stdout


def missing_here():
    """Why an empty Debian cannot be made here, or nothing."""
    if os.geteuid() != 0:
        return "this user is not root"
    if "PROLEG_DEBIAN" not in os.environ and shutil.which("debootstrap") is None:
        return "found no debootstrap (Debian's package of that name)"
    try:
        urlopen(MIRROR + "/dists/bookworm/Release", timeout=30).close()
    except (URLError, OSError) as error:
        return f"found no answer of {MIRROR}: {error}"
    return ""


class DebianPackages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        reason = missing_here()
        if reason:
            print(f"skipped: {reason}", flush=True)
            raise unittest.SkipTest(reason)
        cls.folder = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        debs = os.environ.get("PROLEG_DEBS")
        if not debs:
            debs = cls.folder / "debs"
            run(SOURCE / "tools/release", "--debs", debs)
        kinds = (run("dpkg", "--print-architecture").strip(), "all")
        cls.packages = {deb.stem.split("_")[0]: deb for deb in Path(debs).glob("*.deb") if deb.stem.endswith(kinds)}
        cls.root = Path(os.environ.get("PROLEG_DEBIAN", cls.folder / "debian"))
        if not cls.root.exists():
            run("debootstrap", "--variant=minbase", "bookworm", cls.root, MIRROR)
        # The programs find their data by /proc/self/exe.
        run("mount", "-t", "proc", "proc", cls.root / "proc")
        cls.addClassCleanup(run, "umount", cls.root / "proc")
        shutil.copy("/etc/resolv.conf", cls.root / "etc/resolv.conf")
        for deb in cls.packages.values():
            shutil.copy(deb, cls.root / "tmp")
        cls.inside("apt-get", "-o", "Acquire::Check-Date=false", "update")
        # A reader of manual pages, and what the packages depend on: the rest is own work.
        cls.inside("apt-get", "install", "-y", "--no-install-recommends", "man-db")
        for package in OWN:
            needed = cls.field(package, "Depends")
            needed = re.sub(r"proleg \([^)]*\), ", "", needed)  # without the package of the programs
            if package == "proleg-dev":
                needed += ", " + cls.field(package, "Recommends")  # the compiler for modules
            cls.inside("apt-get", "satisfy", "-y", "--no-install-recommends", needed)
        cls.before = cls.files()

    @classmethod
    def field(cls, package, name):
        return run("dpkg-deb", "--field", cls.packages[package], name).strip()

    @classmethod
    def command(cls, *words):
        return ["chroot", cls.root, "env", "-i", "PATH=/usr/sbin:/usr/bin:/sbin:/bin", "HOME=/tmp", "LC_ALL=C.UTF-8",
                "DEBIAN_FRONTEND=noninteractive", *words]

    @classmethod
    def inside(cls, *words):
        return run(*cls.command(*words))

    @classmethod
    def files(cls):
        """All files and folders of this Debian that a package can have."""
        found = set()
        for folder, folders, files in os.walk(cls.root):
            below = os.path.relpath(folder, cls.root)
            if below in NOT_OF_A_PACKAGE:
                folders.clear()
                continue
            found.update(os.path.normpath(os.path.join(below, name)) for name in folders + files)
        return found

    def test_1_the_installed_package_has_at_most_60_mb(self):
        for package in self.packages:
            size = int(self.field(package, "Installed-Size")) * 1024
            print(f"{package}: {self.packages[package].stat().st_size / 1e6:.1f} MB, installed {size / 1e6:.1f} MB", flush=True)
            self.assertLessEqual(size, LARGEST, package)

    def test_2_it_is_installed_and_shows_a_robot(self):
        begin = time.monotonic()
        self.inside("apt-get", "install", "-y", "--no-install-recommends", *(f"/tmp/{self.packages[package].name}" for package in OWN))
        installed = time.monotonic()
        with subprocess.Popen(self.command("proleg", "ui", "caterpillar", "--no-browser", "--recordings", "/tmp"),
                              stdout=subprocess.PIPE, text=True) as program:
            address = re.search(r"http://\S+", program.stdout.readline()).group().split("#")[0]
            with urlopen(address, timeout=LONGEST) as answer:
                self.assertEqual(answer.read(), (self.root / "usr/share/proleg/page/index.html").read_bytes())
            answered = time.monotonic()
            program.send_signal(signal.SIGTERM)
            self.assertEqual(program.wait(LONGEST), 0)
        print(f"from the deb on disk to a page that answers: {answered - begin:.1f} s, {installed - begin:.1f} s of them apt", flush=True)

    def test_3_the_commands_run(self):
        begin = time.monotonic()
        self.assertIn("simulate", self.inside("proleg", "--help"))
        print(f"proleg --help, with chroot: {1e3 * (time.monotonic() - begin):.0f} ms", flush=True)
        self.assertIn("caterpillar", self.inside("proleg", "scenarios"))
        self.assertIn(" m", self.inside("proleg", "simulate", "caterpillar", "--seconds", "5"))
        self.assertRegex(self.inside("proleg", "hil", "caterpillar", "--modules", "1=mcu", "--seconds", "0.5"),
                         r"(?m)^differences +0 ")

    def test_4_every_command_has_a_manual_page(self):
        self.assertIn("caterpillar", self.inside("man", "proleg-simulate") + self.inside("proleg", "scenarios"))
        for name in re.findall(r"^  (\w+) ", self.inside("proleg", "--help"), re.MULTILINE):
            self.assertIn(f"proleg {name}", self.inside("man", f"proleg-{name}"), name)

    def test_5_an_ordinary_user_makes_an_algorithm_and_its_image(self):
        user = OrdinaryUser(self.root / "home/user", "/usr", root=self.root)
        begin = time.monotonic()
        first, rest = parts_of(commands_of(SOURCE / "docs/user-algorithms.md"))
        for command in first + rest[:3]:  # the others are about a bus, not about the packages
            result = user.run(in_the_test(command), LONGEST)
            self.assertEqual(result.returncode, 0, command + "\n" + result.stdout + result.stderr)
        self.assertIn("differences       0 against", result.stdout)
        print(f"the algorithm in its image, with a proof of two cases: {time.monotonic() - begin:.0f} s", flush=True)
        shutil.rmtree(user.home)

    def test_6_python_has_the_bits_of_the_command(self):
        code = "import proleg; run = proleg.simulate('caterpillar', seconds=5); print(run.setpoint_hash, run.servo_hash)"
        result = json.loads(self.inside("proleg", "simulate", "caterpillar", "--seconds", "5", "--json"))
        self.assertEqual(self.inside("python3", "-c", code).split(), [str(result[name]) for name in ("setpoint_hash", "servo_hash")])

    def test_7_purged_they_leave_nothing(self):
        self.inside("apt-get", "purge", "-y", *OWN)
        self.assertEqual(sorted(self.files() ^ self.before), [])
        self.assertEqual([str(path) for path in (self.root / "var/lib/dpkg").rglob("*proleg*")], [])


if __name__ == "__main__":
    SOURCE = Path(sys.argv[1]).resolve()
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])

#!/usr/bin/env python3
"""Users' algorithms, images for modules and plug-ins from an installation, without a checkout: docs/user-algorithms.md and
docs/robot-control.md, as an ordinary user who cannot write to the prefix.

Usage: development_files_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import contextlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
from own_algorithm_commands import NAME, OrdinaryUser, commands_of, hashes_below, in_the_test, parts_of  # noqa: E402

LONGEST = 1500  # s


class Installed(unittest.TestCase):
    """An installation in a folder with blanks, which was moved there, and one user with an empty home for all tests."""

    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp())
        cls.folder.chmod(0o755)
        cls.addClassCleanup(cls.remove)
        stage = cls.folder / "a stage"
        result = subprocess.run(["cmake", "--install", PROGRAMS.parent, "--strip", "--prefix", stage], capture_output=True, text=True)
        assert result.returncode == 0, result.stdout + result.stderr
        cls.prefix = cls.folder / "a place for Proleg"
        stage.rename(cls.prefix)
        cls.sources = cls.prefix / "src/proleg"
        cls.set_writable(cls.prefix, False)
        cls.user = OrdinaryUser(cls.folder / "home", cls.prefix)
        cls.first, cls.rest = parts_of(commands_of(SOURCE / "docs/user-algorithms.md"))
        # What all tests of a class have: the algorithm, built.
        before = hashes_below(cls.prefix)
        for command in cls.first:
            result = cls.user.run(in_the_test(command), LONGEST)
            assert result.returncode == 0, command + "\n" + result.stdout + result.stderr
        assert hashes_below(cls.prefix) == before, "nothing is written to the prefix"
        cls.algorithm = cls.user.home / NAME

    @classmethod
    def remove(cls):
        cls.set_writable(cls.folder, True)
        shutil.rmtree(cls.folder)

    @staticmethod
    def set_writable(folder, is_writable):
        subprocess.run(["chmod", "-R", "u+w" if is_writable else "a-w", folder], check=True)

    @contextlib.contextmanager
    def changed_prefix(self):
        self.set_writable(self.prefix, True)
        try:
            yield
        finally:
            self.set_writable(self.prefix, False)

    def run_command(self, command, status=0, **options):
        result = self.user.run(command, LONGEST, **options)
        self.assertEqual(result.returncode, status, command + "\n" + result.stdout + result.stderr)
        return result

    def assert_one_line(self, result, *parts):
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        for part in parts:
            self.assertIn(part, result.stderr)


class DevelopmentFiles(Installed):
    def test_the_page_was_followed_up_to_the_proof(self):
        self.assertEqual([command.split()[0] for command in self.first[:4]], ["proleg", "cmake", "cmake", "ctest"])
        self.assertGreaterEqual(len(self.first), 8)
        self.assertTrue((self.algorithm / f"build/{NAME}.so").exists())

    def test_an_error_of_the_compiler_names_file_and_line_of_the_user(self):
        self.run_command("proleg new algorithm broken")
        file = self.user.home / "broken/broken.cpp"
        lines = file.read_text().splitlines()
        line = next(i for i, text in enumerate(lines) if "return instance;" in text)
        lines[line] = lines[line].replace("instance", "instanse")
        file.write_text("\n".join(lines) + "\n")
        message = f"{file}:{line + 1}:"
        self.run_command("cmake -S broken -B broken/build -G Ninja")
        self.assertIn(message, self.run_command("cmake --build broken/build", status=1).stdout)
        self.assert_one_line(self.run_command("proleg verify broken", status=2), message, "all of it is in",
                             "/broken/build/verify/library.log")

        # In a folder that cannot be written, builds are in the cache, and then there is no folder at all.
        self.set_writable(file.parent, False)
        shutil.rmtree(file.parent / "build")
        result = self.run_command("proleg verify broken", status=2, environment={"XDG_CACHE_HOME": f"{self.user.home}/cache"})
        place = f"{self.user.home}/cache/proleg/verify{file.parent}"
        self.assertIn(f"builds are in {place}\n", result.stderr)
        self.assertIn(f"{place}/library.log", result.stderr)
        empty = self.folder / "home of another"
        empty.mkdir(mode=0o555, exist_ok=True)
        result = self.run_command("proleg verify broken", status=2, environment={"HOME": str(empty)})
        self.assert_one_line(result, f"found no folder for builds: {file.parent}/build/verify: Permission denied",
                             f"{empty}/.cache/proleg/verify{file.parent}: Permission denied", "set XDG_CACHE_HOME")
        # ccache has no folder there either.
        self.run_command(f"cmake -S {NAME} -B elsewhere -G Ninja && cmake --build elsewhere --target tested_algorithm",
                         environment={"HOME": str(empty)})

    def test_a_plugin_is_built_and_found(self):
        page = (SOURCE / "docs/robot-control.md").read_text()
        source = re.search(r"```c\n(.*?)```", page, re.DOTALL).group(1)
        build = re.search(r"```cmake\n(.*?)```", page, re.DOTALL).group(1)
        folder = self.user.home / "example"
        self.run_command("mkdir example && cp -r steep_wave/robot example")
        for name, text in (("example.c", source), ("CMakeLists.txt", build)):
            self.run_command(f"cat >example/{name} <<'END'\n{text}END")
        self.run_command("cmake -S example -B example/build -G Ninja && cmake --build example/build")
        robot = folder / "robot/robot.robot.xml"
        text = re.sub(r"(<Robot [^>]*>)", r'\1\n<robot_control plugin="example"/>', robot.read_text(), count=1)
        robot.write_text(text)
        drive = f"proleg drive example/robot/robot.simulation.xml --algorithms steep_wave/build/{NAME}.so --seconds 1"
        self.run_command(drive, environment={"PROLEG_PLUGINS": str(folder / "build")})
        self.assertIn("found no proleg-example.so in", self.run_command(drive, status=2).stderr)
        # The same header without CMake.
        self.run_command(f"cc -std=c99 -shared -fPIC -I '{self.prefix}/include/proleg' example/example.c -o proleg-example.so")

    def test_another_version_is_refused_by_cmake(self):
        self.run_command("mkdir versions")
        for version, status in (("0.2", 0), ("0.1", 1), ("0.3", 1), ("1.0", 1)):
            text = f"cmake_minimum_required(VERSION 3.25)\\nproject(p LANGUAGES C)\\nfind_package(Proleg {version} REQUIRED)\\n"
            self.run_command(f"printf '{text}' >versions/CMakeLists.txt && rm -rf versions/build && cmake -S versions -B versions/build",
                             status=status)

    def test_without_the_sources_the_package_is_named(self):
        commands = ("proleg new algorithm other", f"proleg verify {NAME}")
        with self.changed_prefix():
            self.sources.rename(self.sources.with_name("away"))
        for command in commands:
            self.assert_one_line(self.run_command(command, status=2), f"found no sources of Proleg in {self.sources}",
                                 "sudo apt install proleg-dev")
        with self.changed_prefix():
            self.sources.with_name("away").rename(self.sources)

    def test_sources_of_another_version_are_refused(self):
        file = self.sources / "build_id_text.hpp"
        text = file.read_text()
        for other, found in (('#define PROLEG_BUILD_ID "0.1.9-abc"\n', '"0.1.9-abc"'), ("", "without a version")):
            with self.changed_prefix():
                file.write_text(other)
            self.assert_one_line(self.run_command(f"proleg verify {NAME}", status=2), f"found the sources of Proleg {found} in",
                                 text.split('"')[1], "of one version")
        with self.changed_prefix():
            file.write_text(text)

    def test_a_missing_compiler_is_named_with_its_package(self):
        tools = self.folder / "tools"
        tools.mkdir()
        for name in ("bash", "cmake", "ninja", "python3"):
            (tools / name).symlink_to(shutil.which(name))
        result = self.run_command(f"cmake --build {NAME}/build --target module-image", status=1, environment={"PATH": str(tools)})
        self.assertIn("sudo apt install gcc-arm-none-eabi libstdc++-arm-none-eabi-newlib", " ".join(result.stderr.split()))
        (tools / "ninja").unlink()
        result = self.run_command(f"'{self.prefix}/bin/proleg' verify {NAME}", status=2, environment={"PATH": str(tools)})
        self.assert_one_line(result, "found no ninja", "sudo apt install ninja-build")


class Proof(Installed):
    """The rest of the page, which compiles for minutes."""

    def test_the_page_to_its_end_and_the_bytes_of_the_checkout(self):
        before = hashes_below(self.prefix)
        proof, image, hil, bus, refused, flash, drive = map(in_the_test, self.rest)
        self.assertIn("verified: the same bits everywhere", self.run_command(proof).stdout)
        self.run_command(image)
        self.assertIn("differences       0 against", self.run_command(hil).stdout)

        built = self.algorithm / "build/image/bin/proleg_stm32f405.pimg"
        build = self.folder / "image"
        for command in (["cmake", "--preset", "stm32f405", "-B", build, f"-DPROLEG_USER_ALGORITHMS={self.algorithm}"],
                        ["cmake", "--build", build, "--target", "proleg_stm32f405", "proleg_boot_stm32f405"]):
            done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST, cwd=SOURCE)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(built.read_bytes(), (build / "bin/proleg_stm32f405.pimg").read_bytes())
        self.assertEqual(built.with_name("proleg_boot_stm32f405.bin").read_bytes(),
                         (build / "bin/proleg_boot_stm32f405.bin").read_bytes())

        # The bus of the page is in the background until the end.
        server = self.user.start("exec " + bus.removesuffix(" &").replace("--tcp 20000", "--tcp 0"))
        try:
            port = re.search(r"--bus tcp:127.0.0.1:(\d+)", server.stdout.readline()).group(1)
            with_port = lambda command: command.replace(":20000", f":{port}")
            self.assertIn(f"found none, expected the algorithm '{NAME}'", self.run_command(with_port(refused), status=1).stderr)
            self.run_command(with_port(flash))
            self.assertIn("0 differences", self.run_command(with_port(drive)).stdout)
        finally:
            server.send_signal(signal.SIGINT)
            server.communicate(timeout=LONGEST)
        self.assertEqual(hashes_below(self.prefix), before, "nothing is written to the prefix")


if __name__ == "__main__":
    SOURCE, PROGRAMS = (Path(argument).resolve() for argument in sys.argv[1:3])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

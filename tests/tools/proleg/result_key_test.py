#!/usr/bin/env python3
"""A search can be resumed by every program that is made of the same sources: the key of the program must change with the
sources that it links, with what they include, and with the settings of the build, and with nothing else.

Usage: result_key_test.py SCRIPT NINJA SOURCE_FOLDER BUILD_FOLDER (SCRIPT: tools/cmake/write_result_key.cmake)"""

import hashlib
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

NOT_LINKED = pathlib.Path("tools/cmake/precompiled_headers.cpp")  # an empty source, with which the precompiled headers are made


class ResultKey(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.tree = pathlib.Path(self.folder.name) / "tree"
        for path, text in {
                "sim/ode/world.cpp": '#include "sim/ode/world.hpp"\n',
                "sim/ode/world.hpp": '#include <vector>\n#include "sim/physics/world.hpp"\n',
                "sim/physics/world.hpp": "",
                "tools/main.cpp": '#include "main.hpp"\n#include "written_by_the_build.hpp"\n',
                "tools/main.hpp": "",
                "tools/other.cpp": "",
                "build/tables.cpp": "",
                "docs/notes.md": ""}.items():
            (self.tree / path).parent.mkdir(parents=True, exist_ok=True)
            (self.tree / path).write_text(text)
        self.list_sources("source sim/ode/world.cpp -O2", "source tools/main.cpp -O2", "generated tables.cpp -O2")

    def tearDown(self):
        self.folder.cleanup()

    def list_sources(self, *lines):
        (self.tree / "build/sources.txt").write_text("".join(line + "\n" for line in lines))

    def change(self, path):
        with open(self.tree / path, "a", encoding="utf-8") as file:
            file.write("// changed\n")

    def key(self, settings="gcc 12.2;-O2;ODE 0.16.2"):
        output = pathlib.Path(self.folder.name) / "key.hpp"
        subprocess.run(["cmake", f"-DSOURCE_DIR={self.tree}", f"-DBINARY_DIR={self.tree}/build",
                        f"-DSOURCES={self.tree}/build/sources.txt", f"-DSETTINGS={settings}", f"-DOUTPUT={output}", "-P",
                        SCRIPT], check=True)
        return output.read_text()

    def test_changes_with_each_source_and_with_what_it_includes(self):
        keys = {self.key()}
        for path in ["sim/ode/world.cpp", "sim/ode/world.hpp", "sim/physics/world.hpp", "tools/main.cpp",
                     "tools/main.hpp", "build/tables.cpp"]:
            before = len(keys)
            self.change(path)
            keys.add(self.key())
            self.assertEqual(len(keys), before + 1, path)

    def test_changes_with_the_list_of_sources_and_their_options(self):
        keys = {self.key()}
        self.list_sources("source sim/ode/world.cpp -O2", "source tools/main.cpp -O2")
        keys.add(self.key())
        self.list_sources("source sim/ode/world.cpp -O2", "source tools/main.cpp -O3")
        keys.add(self.key())
        (self.tree / "sim/ode/world.cpp").rename(self.tree / "sim/ode/renamed.cpp")
        self.list_sources("source sim/ode/renamed.cpp -O2", "source tools/main.cpp -O3")
        keys.add(self.key())
        self.assertEqual(len(keys), 4)

    def test_changes_with_compiler_flags_and_libraries(self):
        settings = ["gcc 12.2;-O2;ODE 0.16.2", "gcc 12.3;-O2;ODE 0.16.2", "gcc 12.2;-O3;ODE 0.16.2",
                    "gcc 12.2;-O2;ODE 0.16.3"]
        self.assertEqual(len({self.key(each) for each in settings}), 4)

    def test_changes_with_a_library_of_the_system(self):
        sources = "source sim/ode/world.cpp -O2"
        keys = set()
        for libraries in [(), ("library libassimp.so.5.2.5",), ("library libassimp.so.5.2.6",)]:
            self.list_sources(*libraries, sources)
            keys.add(self.key())
        self.assertEqual(len(keys), 3)

    def test_stays_when_other_files_change_or_the_tree_moves(self):
        key = self.key()
        for path in ["tools/other.cpp", "docs/notes.md"]:
            self.change(path)
            self.assertEqual(self.key(), key, path)
        self.tree = self.tree.rename(self.tree.parent / "elsewhere")
        self.assertEqual(self.key(), key)

    def test_an_equal_key_does_not_touch_the_header(self):
        self.key()
        header = pathlib.Path(self.folder.name) / "key.hpp"
        before = header.stat().st_mtime_ns
        self.key()
        self.assertEqual(header.stat().st_mtime_ns, before)


class KeyOfTheProgram(unittest.TestCase):
    """The key in the build folder, compared with the files that Ninja knows to be in proleg-optimise."""

    def setUp(self):
        self.hashed = (BUILD / "build_id_text/result_key_text.hpp.txt").read_bytes()

    @staticmethod
    def ninja(*arguments):
        return subprocess.run([NINJA, "-C", str(BUILD), "-t", *arguments], check=True, text=True,
                              capture_output=True).stdout.splitlines()

    def files_of_program(self):
        inputs = self.ninja("inputs", "bin/proleg-optimise")
        objects = [path for path in inputs if path.endswith(".cpp.o") or path.endswith(".cxx.o")]
        included = [line.strip() for line in self.ninja("deps", *objects) if line.startswith("    ")]
        files = {(BUILD / path).resolve() for path in inputs + included}
        return {path.relative_to(SOURCE) for path in files
                if path.is_relative_to(SOURCE) and not path.is_relative_to(BUILD) and path.suffix in (".cpp", ".hpp")}

    def test_is_the_hash_of_the_listed_files(self):
        header = (BUILD / "build_id_text/result_key_text.hpp").read_text()
        self.assertIn(hashlib.sha256(self.hashed).hexdigest(), header)

    def test_lists_every_library_that_the_program_loads(self):
        of_the_compiler = re.compile(r"lib(stdc\+\+|m|gcc_s|c|pthread|asan|ubsan)\.so|ld-linux")
        dynamic = subprocess.run(["readelf", "--dynamic", "--wide", BUILD / "bin/proleg-optimise"], check=True, text=True,
                                 capture_output=True).stdout
        listed = re.findall(r"^library (\S+)$", self.hashed.decode(), re.MULTILINE)
        loaded = [name for name in re.findall(r"NEEDED.*\[(\S+)\]", dynamic) if not of_the_compiler.match(name)]
        for expected in ["libode", "libpagmo", "libga", "libassimp", "libqhull_r"]:
            self.assertTrue(any(name.startswith(expected) for name in loaded), expected)
        for name in loaded:
            with self.subTest(name):
                self.assertTrue(any(file.startswith(name) for file in listed), listed)

    def test_lists_every_file_of_the_program_with_its_hash(self):
        listed = dict(re.findall(r"^(\S+) ([0-9a-f]{64})$", self.hashed.decode(), re.MULTILINE))
        files = self.files_of_program() - {NOT_LINKED}
        for expected in ["sim/sensor/attached_sensors.cpp", "sim/sensor/attached_sensors.hpp", "shared/gait/hopf.cpp",
                         "tools/proleg/search/optimisation.cpp"]:
            self.assertIn(pathlib.Path(expected), files)
        for path in sorted(files):
            with self.subTest(path):
                self.assertEqual(listed.get(str(path)), hashlib.sha256((SOURCE / path).read_bytes()).hexdigest())


if __name__ == "__main__":
    SCRIPT, NINJA = sys.argv[1:3]
    SOURCE, BUILD = (pathlib.Path(each).resolve() for each in sys.argv[3:5])
    unittest.main(argv=sys.argv[:1])

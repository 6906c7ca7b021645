"""A result of tools/run_test and tools/tidy is used again for the same inputs, and for no others.

Builds a small program as the tree is built, and changes one input after the other.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOOLS = Path(__file__).resolve().parents[3] / "tools"

PROGRAM = """
#include <cstdlib>
#include <fstream>
#include <string>
#include "limit.hpp"
int main() {
  std::ifstream golden("golden.tsv");
  std::ofstream("runs", std::ios::app) << "x";
  std::string value;
  golden >> value;
  return value == "wrong" || LIMIT < MINIMUM;
}
"""


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path


class TestResults(Folder):
    def setUp(self):
        super().setUp()
        self.write("program.cpp", PROGRAM)
        self.write("limit.hpp", "#define LIMIT 3\n")
        self.write("golden.tsv", "right\n")
        self.write("reader", "#!/bin/sh\nexit 0\n").chmod(0o755)
        self.build()

    def build(self, *flags):
        subprocess.run(["g++", "-DMINIMUM=1", *flags, "program.cpp", "-o", "program"], cwd=self.folder, check=True)

    def run_test(self, *options, **environment):
        return subprocess.run(
            [TOOLS / "run_test", "--name", "room/subject", "--results", "results", "--program", "reader",
             "--data", "golden.tsv", *options, "--", "./program"],
            cwd=self.folder, capture_output=True, text=True, check=False,
            env={**os.environ, "PROLEG_REUSE_RESULTS": "1", "PROLEG_AUDIT_INPUTS": "0", **environment})

    def runs(self):
        runs = self.folder / "runs"
        return len(runs.read_text()) if runs.exists() else 0

    def expect_new_run(self, *options, **environment):
        before = self.runs()
        self.run_test(*options, **environment)
        self.assertEqual(self.runs(), before + 1)

    def expect_reuse(self, *options):
        before = self.runs()
        finished = self.run_test(*options)
        self.assertEqual((finished.returncode, self.runs()), (0, before))
        self.assertIn("REUSED", finished.stdout)

    def test_the_same_inputs_are_not_tested_twice(self):
        self.expect_new_run()
        self.expect_reuse()
        self.build()  # the same bytes again, in a new file
        self.expect_reuse()

    def test_a_changed_golden_table_is_tested(self):
        self.expect_new_run()
        self.write("golden.tsv", "wrong\n")
        self.assertEqual(self.run_test().returncode, 1)

    def test_a_change_that_keeps_size_and_time_is_tested(self):
        self.expect_new_run()
        golden = self.folder / "golden.tsv"
        times = (golden.stat().st_atime_ns, golden.stat().st_mtime_ns)
        self.write("golden.tsv", "wrong\n")
        os.utime(golden, ns=times)
        self.assertEqual(self.run_test().returncode, 1)

    def test_a_changed_header_is_tested(self):
        self.expect_new_run()
        self.write("limit.hpp", "#define LIMIT 0\n")
        self.build()
        self.assertEqual(self.run_test().returncode, 1)

    def test_a_changed_flag_is_tested(self):
        self.expect_new_run()
        self.build("-UMINIMUM", "-DMINIMUM=4")
        self.assertEqual(self.run_test().returncode, 1)

    def test_another_version_of_a_tool_is_tested(self):
        self.expect_new_run()
        self.write("reader", "#!/bin/sh\nexit 0 # version 2\n").chmod(0o755)
        self.expect_new_run()

    def test_another_version_of_a_library_is_tested(self):
        self.write("library.cpp", "int version() { return 1; }\n")
        library = ["g++", "-shared", "-fPIC", "library.cpp", "-o", "libversion.so"]
        subprocess.run(library, cwd=self.folder, check=True)
        self.build("-Wl,--no-as-needed", "-L.", "-lversion", f"-Wl,-rpath,{self.folder}")
        self.expect_new_run()
        self.expect_reuse()
        self.write("library.cpp", "int version() { return 2; }\n")
        subprocess.run(library, cwd=self.folder, check=True)
        self.expect_new_run()

    def test_a_source_counts_where_the_test_compiles_it(self):
        self.write("sources/room.cpp", "int one();\n")
        for options, expect in ((("--data", "sources"), self.expect_reuse),
                                (("--data", "sources", "--compiles"), self.expect_new_run)):
            self.expect_new_run(*options)
            self.write("sources/room.cpp", f"int two();  // {options}\n")
            expect(*options)

    def test_another_environment_is_tested(self):
        self.expect_new_run()
        self.expect_new_run(GTEST_SHARD_INDEX="1")

    def test_a_failure_is_never_kept(self):
        self.write("golden.tsv", "wrong\n")
        self.expect_new_run()
        self.expect_new_run()

    def test_results_are_not_used_unless_asked_for(self):
        self.expect_new_run()
        self.expect_new_run(PROLEG_REUSE_RESULTS="0")

    def test_an_input_that_is_not_declared_is_found(self):
        checkout = self.folder / "checkout"
        shutil.copytree(TOOLS, checkout / "tools")
        (checkout / "docs").mkdir()
        (checkout / "docs" / "page.md").write_text("text")
        command = [checkout / "tools" / "run_test", "--name", "reads", "--results", "results"]
        reads = ["--", shutil.which("cat"), str(checkout / "docs" / "page.md")]
        environment = {**os.environ, "PROLEG_AUDIT_INPUTS": "1"}

        def audit(*declared):
            return subprocess.run([*command, *declared, *reads], cwd=self.folder, capture_output=True, text=True,
                                  check=False, env=environment)

        self.assertEqual(audit("--data", str(checkout / "docs")).returncode, 0)
        finished = audit()
        self.assertEqual(finished.returncode, 1)
        self.assertIn("page.md is read", finished.stdout)

        module = checkout / "page" / "node_modules" / "three" / "index.js"
        module.parent.mkdir(parents=True)
        module.write_text("text")
        reads = ["--", shutil.which("cat"), str(module)]
        self.assertEqual(audit("--data", str(checkout / "page" / "package-lock.json")).returncode, 0)
        self.assertEqual(audit().returncode, 1)


class TidyResults(Folder):
    CHECKS = "Checks: '-*,modernize-use-nullptr'\nWarningsAsErrors: '*'\n"
    CHECKS += "HeaderFilterRegex: '.*'\n"

    def setUp(self):
        super().setUp()
        self.write(".clang-tidy", self.CHECKS)
        self.write("shared/pointer.hpp", "inline int* pointer() { return nullptr; }\n")
        self.write("shared/one.cpp", '#include "pointer.hpp"\nint one() { return *pointer(); }\n')
        self.write("shared/two.cpp", '#include "pointer.hpp"\nint two() { return *pointer(); }\n')
        self.configure()

    def configure(self, flag="-DLIMIT=1"):
        commands = [{"directory": str(self.folder), "file": str(self.folder / "shared" / f"{name}.cpp"),
                     "command": f"/usr/bin/c++ {flag} -std=c++20 -o CMakeFiles/room.dir/{name}.o -c {name}.cpp"}
                    for name in ("one", "two")]
        self.write("build/compile_commands.json", json.dumps(commands))

    def tidy(self, tool="clang-tidy"):
        finished = subprocess.run([TOOLS / "tidy", "--build", "build", "--source", ".", "--clang-tidy", tool],
                                  cwd=self.folder, capture_output=True, text=True, check=False,
                                  env={**os.environ, "PROLEG_REUSE_RESULTS": "1"})
        return finished.returncode, finished.stdout

    def expect_read(self, reused):
        self.assertEqual(self.tidy(), (0, f"2 files, {reused} of them unchanged since they were clean\n"))

    def test_the_same_inputs_are_not_read_twice(self):
        self.expect_read(reused=0)
        self.expect_read(reused=2)

    def test_a_changed_header_is_read(self):
        self.expect_read(reused=0)
        self.write("shared/pointer.hpp", "inline int* pointer() { return 0; }\n")
        status, out = self.tidy()
        self.assertEqual(status, 1)
        self.assertIn("pointer.hpp:1", out)
        self.assertEqual(self.tidy()[0], 1)  # and again: what was found is not kept as clean

    def test_a_comment_that_silences_clang_tidy_counts(self):
        self.write("shared/pointer.hpp", "inline int* pointer() { return 0; }  // NOLINT\n")
        self.expect_read(reused=0)
        self.write("shared/pointer.hpp", "inline int* pointer() { return 0; }  // why\n")
        self.assertEqual(self.tidy()[0], 1)

    def test_a_changed_flag_is_read(self):
        self.expect_read(reused=0)
        self.configure("-DLIMIT=2")
        self.expect_read(reused=0)

    def test_changed_checks_are_read(self):
        self.expect_read(reused=0)
        self.write(".clang-tidy", self.CHECKS.replace("use-nullptr", "use-override"))
        self.expect_read(reused=0)

    def test_another_version_of_clang_tidy_reads(self):
        self.expect_read(reused=0)
        tool = self.write("other-tidy", f'#!/bin/sh\nexec {shutil.which("clang-tidy")} "$@"\n')
        tool.chmod(0o755)
        self.assertIn("0 of them", self.tidy(str(tool))[1])

    def test_sources_that_do_not_compile_as_one_are_read_apart(self):
        for name in ("one", "two"):
            self.write(f"shared/{name}.cpp", f"namespace {{ struct Same {{ int {name}; }}; }}\n"
                                             f"int* {name}(Same) {{ return 0; }}\n")
        status, out = self.tidy()
        self.assertEqual(status, 1)
        for name in ("one", "two"):
            self.assertIn(f"{name}.cpp:2", out)

    def test_the_sources_of_a_text_that_cmake_has_made_are_read(self):
        text = self.write("build/CMakeFiles/room.dir/Unity/unity_0_cxx.cxx", "/* generated by CMake */\n\n" + "".join(
            f'#include "{self.folder / "shared" / name}.cpp"\n\n' for name in ("one", "two")))
        commands = [{"directory": str(self.folder), "file": str(text),
                     "command": f"/usr/bin/c++ -std=c++20 -o CMakeFiles/room.dir/{text.name}.o -c {text}"}]
        self.write("build/compile_commands.json", json.dumps(commands))
        self.expect_read(reused=0)
        self.write("shared/two.cpp", "int* two() { return 0; }\n")
        status, out = self.tidy()
        self.assertEqual(status, 1)
        self.assertIn("two.cpp:1", out)

    def test_a_using_declaration_is_unused_although_the_next_file_uses_the_name(self):
        self.write("shared/pointer.hpp", "#pragma once\nnamespace room { struct Thing {}; }\n")
        include = '#include "pointer.hpp"\n'
        self.write("shared/one.cpp", f"{include}using room::Thing;  // a Thing\n")
        self.write("shared/two.cpp", f"{include}using room::Thing;\nint two(Thing*);\n")
        status, out = self.tidy()
        self.assertEqual(status, 1)
        self.assertIn("one.cpp:2", out)
        self.assertNotIn("two.cpp", out)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)

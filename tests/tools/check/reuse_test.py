"""A result of tools/run_test and tools/tidy is used again for the same inputs, and for no others.

Builds a small program as the tree is built, and changes one input after the other.
"""

import importlib.machinery
import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

# This interpreter runs them: a version manager may put a script before it that takes longer than they do.
TOOLS = Path(__file__).resolve().parents[3] / "tools"
sys.dont_write_bytecode = True
sys.path.insert(0, str(TOOLS))
from content_hash import ContentHash  # noqa: E402

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
    @classmethod
    def setUpClass(cls):
        cls.built = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.built)
        (cls.built / "program.cpp").write_text(PROGRAM)
        (cls.built / "limit.hpp").write_text("#define LIMIT 3\n")
        (cls.built / "golden.tsv").write_text("right\n")
        (cls.built / "reader").write_text("#!/bin/sh\nexit 0\n")
        (cls.built / "reader").chmod(0o755)
        cls.build_in(cls.built)

    def setUp(self):
        super().setUp()
        shutil.copytree(self.built, self.folder, dirs_exist_ok=True)

    @staticmethod
    def build_in(folder, *flags):
        subprocess.run(["g++", "-DMINIMUM=1", *flags, "program.cpp", "-o", "program"], cwd=folder, check=True)

    def build(self, *flags):
        self.build_in(self.folder, *flags)

    def run_test(self, *options, **environment):
        return subprocess.run(
            [sys.executable, TOOLS / "run_test", "--name", "room/subject", "--results", "results", "--program", "reader",
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

    def test_a_test_does_not_see_what_the_programs_of_the_user_keep(self):
        (self.folder / "print").write_text("#!/bin/sh\necho state:$XDG_STATE_HOME\n")
        (self.folder / "print").chmod(0o755)
        finished = subprocess.run([sys.executable, TOOLS / "run_test", "--name", "state", "--results", "results", "--", "./print"],
                                  cwd=self.folder, capture_output=True, text=True, check=True, env={**os.environ, "XDG_STATE_HOME": str(self.folder)})
        state = Path(re.search("state:(.*)", finished.stdout)[1])
        self.assertTrue(state.is_absolute() and state != self.folder)
        self.assertFalse(state.exists(), "it is removed at the end")

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

    def test_what_cmake_installs_is_an_input(self):
        self.write("build/cmake_install.cmake", f'include("{self.folder}/build/room/cmake_install.cmake")\n')
        script = 'file(INSTALL DESTINATION "share" TYPE FILE FILES "%s/docs" "%s/golden.tsv")\n' % (self.folder, self.folder)
        self.write("build/room/cmake_install.cmake", script)
        self.write("docs/page.md", "one")
        options = ("--installs", "build")
        self.expect_new_run(*options)
        self.expect_reuse(*options)
        self.write("docs/page.md", "two")
        self.expect_new_run(*options)
        self.write("build/room/cmake_install.cmake", script + "# of another version of CMake\n")
        self.expect_new_run(*options)
        self.write("elsewhere.md", "text")
        self.expect_reuse(*options)

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
        command = [sys.executable, checkout / "tools" / "run_test", "--name", "reads", "--results", "results"]
        reads = ["--", shutil.which("cat"), str(checkout / "docs" / "page.md")]
        environment = {**os.environ, "PROLEG_AUDIT_INPUTS": "1"}

        def audit(*declared):
            return subprocess.run([*command, *declared, *reads], cwd=self.folder, capture_output=True, text=True,
                                  check=False, env=environment)

        self.assertEqual(audit("--data", str(checkout / "docs")).returncode, 0)
        finished = audit()
        self.assertEqual(finished.returncode, 1)
        self.assertIn("page.md is read", finished.stdout)

        reads = ["--", "sh", "-c", f"echo text >{checkout / 'docs' / 'written.md'}"]
        self.assertEqual(audit().returncode, 0, "a file that is only written is no input")

        module = checkout / "page" / "node_modules" / "three" / "index.js"
        module.parent.mkdir(parents=True)
        module.write_text("text")
        reads = ["--", shutil.which("cat"), str(module)]
        self.assertEqual(audit("--data", str(checkout / "page" / "package-lock.json")).returncode, 0)
        self.assertEqual(audit().returncode, 1)


class TidySources(Folder):
    CHECKS = "Checks: '-*,modernize-use-nullptr,misc-unused-using-decls,misc-unused-alias-decls'\nWarningsAsErrors: '*'\n"
    CHECKS += "HeaderFilterRegex: '.*'\n"
    FINDING = "inline int* pointer() { return 0; }"

    @classmethod
    def setUpClass(cls):
        """clang-tidy and its libraries, 200 MB, are read once: each test begins with their hashes in its memory."""
        folder = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, folder)
        cls.memory = folder / "files"
        hashes = ContentHash(cls.memory)
        hashes.program(shutil.which("clang-tidy-14") or "clang-tidy")
        hashes.save()

    def setUp(self):
        super().setUp()
        (self.folder / "build/clean").mkdir(parents=True)
        shutil.copy(self.memory, self.folder / "build/clean")
        self.write(".clang-tidy", self.CHECKS)
        self.write(".gitignore", "/build/\n/bin/\n")
        self.write("shared/pointer.hpp", "inline int* pointer() { return nullptr; }\n")
        self.write("shared/one.cpp", '#include "pointer.hpp"\nint one() { return *pointer(); }\n')
        self.write("shared/two.cpp", '#include "pointer.hpp"\nint two() { return *pointer(); }\n')
        self.configure()
        self.git("init", "--quiet", "--initial-branch", "main")
        self.commit()

    def configure(self, flag="-DLIMIT=1"):
        commands = [{"directory": str(self.folder), "file": str(self.folder / "shared" / f"{name}.cpp"),
                     "command": f"/usr/bin/c++ {flag} -std=c++20 -o CMakeFiles/room.dir/{name}.o -c shared/{name}.cpp"}
                    for name in ("one", "two")]
        self.write("build/compile_commands.json", json.dumps(commands))

    def git(self, *arguments):
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=b", *arguments], cwd=self.folder, check=True)

    def commit(self, count=1):
        """The changes, and commits without changes after them."""
        self.git("add", ".")
        for _ in range(count):
            self.git("commit", "--quiet", "--allow-empty", "--message", "commit")

    def tidy(self, *options, **environment):
        finished = subprocess.run([sys.executable, TOOLS / "tidy", "--build", "build", *options],
                                  cwd=self.folder, capture_output=True, text=True, check=False,
                                  env={**os.environ, "PROLEG_REUSE_RESULTS": "1", **environment})
        return finished.returncode, finished.stdout

    def expect_clean(self, *options, read, reused):
        self.assertEqual(self.tidy(*options),
                         (0, f"{read} of 2 sources, {reused} of them unchanged since they were clean\n"))

    def expect_finding(self, place, *options):
        status, out = self.tidy(*options)
        self.assertEqual(status, 1)
        self.assertIn(place, out)
        return out


class TidyResults(TidySources):
    def expect_all_read(self, reused):
        self.expect_clean("--all", read=2, reused=reused)

    def test_the_same_inputs_are_not_read_twice(self):
        self.expect_all_read(reused=0)
        self.expect_all_read(reused=2)

    def test_what_was_found_is_not_kept_as_clean(self):
        self.expect_all_read(reused=0)
        self.write("shared/pointer.hpp", self.FINDING)
        self.expect_finding("pointer.hpp:1", "--all")
        self.expect_finding("pointer.hpp:1", "--all")

    def test_a_comment_that_silences_clang_tidy_counts(self):
        self.write("shared/pointer.hpp", f"{self.FINDING}  // NOLINT\n")
        self.expect_all_read(reused=0)
        self.write("shared/pointer.hpp", f"{self.FINDING}  // why\n")
        self.expect_finding("pointer.hpp:1", "--all")

    def test_a_changed_flag_is_read(self):
        self.expect_all_read(reused=0)
        self.configure("-DLIMIT=2")
        self.expect_all_read(reused=0)

    def test_changed_checks_are_read(self):
        self.expect_all_read(reused=0)
        self.write(".clang-tidy", self.CHECKS.replace("use-nullptr", "use-override"))
        self.expect_all_read(reused=0)

    def test_another_version_of_clang_tidy_reads(self):
        self.expect_all_read(reused=0)
        real = shutil.which("clang-tidy-14") or shutil.which("clang-tidy")
        self.write("bin/clang-tidy-14", f'#!/bin/sh\nexec {real} "$@"\n').chmod(0o755)
        out = self.tidy("--all", PATH=f"{self.folder}/bin:{os.environ['PATH']}")[1]
        self.assertIn("0 of them", out)

    def test_a_name_is_unused_although_the_next_file_uses_it(self):
        self.write("shared/pointer.hpp", "#pragma once\nnamespace room { namespace inner { struct Thing {}; } }\n")
        include = '#include "pointer.hpp"\n'
        for declaration, name in (("using room::inner::Thing;", "Thing"), ("namespace short_name = room::inner;", "short_name::Thing")):
            self.write("shared/one.cpp", f"{include}{declaration}  // a Thing\n")
            self.write("shared/two.cpp", f"{include}{declaration}\nint two({name}*);\n")
            out = self.expect_finding("one.cpp:2", "--all")
            self.assertNotIn("two.cpp", out)


class TidyChanges(TidySources):
    """Without --all what changed is read. A finding in two.cpp that is older than the last 20 commits is not."""

    def setUp(self):
        super().setUp()
        self.write("shared/two.cpp", "int* two() { return 0; }\n")
        self.commit(21)

    def test_a_file_that_did_not_change_is_left_to_the_slow_suite(self):
        self.expect_clean(read=0, reused=0)
        self.expect_finding("two.cpp:1", "--all")

    def test_an_edit_is_read(self):
        self.write("shared/one.cpp", "int* one() { return 0; }\n")
        out = self.expect_finding("one.cpp:1")
        self.assertNotIn("two.cpp", out)

    def test_sources_that_include_an_edited_header_are_read(self):
        self.write("shared/pointer.hpp", self.FINDING)
        out = self.expect_finding("pointer.hpp:1")
        self.assertIn("1 of 2 sources", out)

    def test_a_new_file_is_read(self):
        self.write("shared/new.hpp", "inline int* new_one() { return 0; }\n")
        self.write("shared/one.cpp", '#include "new.hpp"\n')
        self.commit()
        self.expect_finding("new.hpp:1")

    def test_commits_that_the_upstream_branch_lacks_are_read(self):
        self.git("branch", "upstream")
        self.git("branch", "--quiet", "--set-upstream-to", "upstream")
        self.write("shared/one.cpp", "int* one() { return 0; }\n")
        self.commit(30)
        self.expect_finding("one.cpp:1")

    def test_a_fresh_clone_reads_its_last_commits(self):
        self.write("shared/one.cpp", "int* one() { return 0; }\n")
        self.commit()
        self.git("branch", "upstream")
        self.git("branch", "--quiet", "--set-upstream-to", "upstream")
        self.expect_finding("one.cpp:1")

    def test_a_source_that_does_not_compile_is_read(self):
        (self.folder / "shared/pointer.hpp").unlink()
        self.expect_finding("'pointer.hpp' file not found")

    def test_the_files_that_changed_are_read_first(self):
        loader = importlib.machinery.SourceFileLoader("tidy", str(TOOLS / "tidy"))
        tidy = importlib.util.module_from_spec(importlib.util.spec_from_loader("tidy", loader))
        loader.exec_module(tidy)
        reads = {"a.cpp": {"a.cpp", "x.hpp", "y.hpp"}, "b.cpp": {"b.cpp", "y.hpp"}, "x.cpp": {"x.cpp", "x.hpp"},
                 "z.cpp": {"z.cpp"}}
        self.assertEqual(tidy.sources_to_read(reads, ["x.hpp", "b.cpp", "y.hpp"]), ["b.cpp", "x.cpp", "a.cpp"])
        self.assertEqual(tidy.sources_to_read(reads, ["z.cpp", "y.hpp"]), ["z.cpp", "a.cpp", "b.cpp"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)

"""tools/stack_bound against small programs whose stack is known. Argument 1: the tool."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOL = pathlib.Path(sys.argv.pop(1)).resolve()


class StackBound(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def bound(self, text, function, *options):
        """Compiles a program and runs the tool on it."""
        source = self.folder / "program.cpp"
        source.write_text(text)
        subprocess.run(["arm-none-eabi-g++", "-mcpu=cortex-m4", "-mthumb", "-std=c++20", "-O1", "-fno-inline",
                        "-fno-exceptions", "-fno-rtti", "-ffreestanding", "-fcallgraph-info=su", "-c", str(source),
                        "-o", str(self.folder / "program.o")], check=True, cwd=self.folder)
        subprocess.run(["arm-none-eabi-g++", "-mcpu=cortex-m4", "-mthumb", "-nostartfiles", "-Wl,--entry=0",
                        str(self.folder / "program.o"), "-o", str(self.folder / "program.elf")], check=True)
        return subprocess.run([sys.executable, str(TOOL), "--program", str(self.folder / "program.elf"), "--build",
                               str(self.folder), "--source", str(self.folder), *options, function],
                              capture_output=True, text=True, check=False)

    def bytes_of(self, text, function, *options):
        result = self.bound(text, function, *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return int(result.stdout.split()[0])

    def expect_error(self, text, function, message):
        result = self.bound(text, function)
        self.assertEqual(result.returncode, 1)
        self.assertIn(message, result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1)

    FILL = "void use(volatile char* p); void use(volatile char* p) { *p = 1; }\n"

    def test_the_deepest_of_the_called_functions_counts(self):
        small = self.FILL + "void leaf() { volatile char a[40]; use(a); }\n"
        large = small + "void deep() { volatile char a[400]; use(a); }\n"
        one = self.bytes_of(small + "void root() { leaf(); }", "root")
        both = self.bytes_of(large + "void root() { leaf(); deep(); }", "root")
        self.assertGreaterEqual(one, 40)
        self.assertEqual(both - one, 360)

    def test_a_virtual_call_counts_as_the_worst_overriding_function(self):
        text = self.FILL + """
struct Base { virtual void step() = 0; virtual void other() = 0; };
struct Small : Base { void step() override { volatile char a[40]; use(a); } void other() override {} };
struct Large : Base {
  void step() override { volatile char a[400]; use(a); }
  void other() override { volatile char a[4000]; use(a); }
};
extern "C" void __cxa_pure_virtual() {}
Small small; Large large;
void root(Base& base) {
  base.step();
}
"""
        found = self.bytes_of(text, "root")
        self.assertGreaterEqual(found, 400)
        self.assertLess(found, 500)

    def test_a_header_is_found_although_the_build_folder_is_elsewhere(self):
        call = "void call(Base& base) { base.step(); }\n"
        (self.folder / "call.hpp").write_text(call)
        text = self.FILL + """
struct Base { virtual void step() = 0; };
struct Small : Base { void step() override { volatile char a[40]; use(a); } };
extern "C" void __cxa_pure_virtual() {}
Small small;
""" + f'#line 1 "build/other/rooms/room/call.hpp"\n{call}#line 100 "program.cpp"\nvoid root() {{ call(small); }}\n'
        self.assertGreaterEqual(self.bytes_of(text, "root"), 40)

    def test_a_function_of_a_library_counts_by_its_disassembly(self):
        text = "long long quotient(long long a, long long b) { return a / b; }"
        self.assertGreaterEqual(self.bytes_of(text, "quotient"), 8 + 16)

    def test_recursion_has_no_bound(self):
        text = "int root(int n); int other(int n) { return n + root(n - 1) * n; }\n"
        text += "int root(int n) { return n < 1 ? 1 : n + other(n) * n; }"
        self.expect_error(text, "root", "recursion: ")

    def test_a_frame_of_variable_size_has_no_bound(self):
        text = self.FILL + "void root(unsigned n) { use(static_cast<char*>(__builtin_alloca(n))); }"
        self.expect_error(text, "root", "its frame is dynamic")

    def test_an_unknown_function_pointer_has_no_bound(self):
        text = "void root(int (*f)(int), int* n) {\n  *n += f(*n);\n}"
        self.expect_error(text, "root", "unknown target of the indirect call at ")

    def test_a_call_through_a_table_counts_as_the_worst_function_in_it(self):
        text = self.FILL + """
namespace { void small() { volatile char a[40]; use(a); } void large() { volatile char a[400]; use(a); } }
namespace tables { extern void (*const steps[])(); void (*const steps[])() = {small, large}; }
void root(int i) { tables::steps[i](); }
"""
        found = self.bytes_of(text, "root", "--table=tables::steps")
        self.assertGreaterEqual(found, 400)
        self.assertLess(found, 500)
        self.expect_error(text, "root", "unknown target of the indirect call at ")

    def test_a_table_counts_for_calls_in_files_that_name_it(self):
        (self.folder / "deep.hpp").write_text("""
namespace { void large() { volatile char a[400]; use(a); } }
namespace tables { extern void (*const deep[])(); void (*const deep[])() = {large}; }
void call_deep(int i) { tables::deep[i](); }
""")
        text = self.FILL + """
#include "deep.hpp"
namespace { void small() { volatile char a[40]; use(a); } }
namespace tables { extern void (*const flat[])(); void (*const flat[])() = {small}; }
void root(int i) { tables::flat[i](); }
"""
        tables = ["--table=tables::flat", "--table=tables::deep"]
        self.assertLess(self.bytes_of(text, "root", *tables), 100)
        self.assertGreaterEqual(self.bytes_of(text, "call_deep", *tables), 400)

    def test_functions_of_other_folders_than_those_named_do_not_count(self):
        shallow, deep = (self.FILL + f"void root() {{ volatile char a[{size}]; use(a); }}" for size in (40, 400))
        small = self.bytes_of(shallow, "root")
        other = self.folder / "other"
        other.mkdir()
        self.folder, named = other, self.folder
        self.assertGreaterEqual(self.bytes_of(deep, "root"), 400)
        tool = [sys.executable, str(TOOL), "--program", str(named / "program.elf"), "--source", str(named)]
        (named / "one").mkdir()
        (named / "program.ci").rename(named / "one/program.ci")
        for folders, expected in ([["one"], small], [["one", "other"], 400]):
            options = [text for folder in folders for text in ("--build", str(named / folder))]
            found = subprocess.run([*tool, *options, "root"], capture_output=True, text=True, check=True).stdout
            self.assertGreaterEqual(int(found.split()[0]), expected)
            self.assertEqual(int(found.split()[0]) == small, folders == ["one"])

    def test_an_unknown_function_is_an_error(self):
        self.expect_error("void root() {}", "branch", "found no function branch")


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
"""A user writes an algorithm outside of the tree, runs it, and makes every mistake that it can have.

Usage: user_algorithms_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import contextlib
import json
import os
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(sys.argv[1])
PROGRAMS = Path(sys.argv[2])
sys.path.insert(0, str(SOURCE / "tests/host/server"))
from web_client import Viewer  # noqa: E402

sys.path.append(str(Path(__file__).resolve().parents[2] / "support"))
from waiting import wait_until  # noqa: E402

LONGEST = 1500  # seconds; a proof compiles the core six times
NAME = "steep_wave"
BAD_TICK = 100
BAD_JOINT = 2

# What goes wrong in advance(), at one tick of one joint, and what the message says behind the name of the algorithm.
MISTAKES = {
    "throws": ("throw std::runtime_error(\"no idea\");", "throws an exception: no idea"),
    "throws_a_number": ("throw 7;", "throws an exception"),
    "null": ("*volatile_null = 1;", "uses memory that does not exist or is not its own, at the address 0"),
    "loop": ("for (volatile int i = 0;; i = i + 1) {}", "does not return within a second of processor time"),
    "writes_behind": ("for (int i = 0; i < 4; ++i) { next[i] = i; }",
                      "uses elements of its array 'next' that do not exist (it has 3)"),
    "writes_in_front": ("next[-1] = 1;", "writes in front of its array 'next'"),
    "writes_far_in_front": ("next[-2000] = 1;", "uses elements in front of its array 'next'"),
    "reads_behind": ("next[0] = state[5];", "uses elements of its array 'state' that do not exist (it has 3)"),
    "reads_far_behind": ("next[0] = tuning.parameters[500];",
                         "uses elements of its array 'parameters' that do not exist (it has 4)"),
    "changes_its_state": ("const_cast<std::int32_t*>(state)[0] = 1;",
                          "writes to its array 'state', which it may only read"),
    "divides_by_zero": ("volatile int quotient = state[0] / volatile_zero;", "divides by zero"),
    "sends_itself_a_signal": ("std::raise(SIGSEGV);", "sends itself the signal SIGSEGV"),
    "aborts": ("std::abort();", "calls abort()"),
    "overflows_the_stack": ("next[0] = deep(volatile_zero);", "uses memory that does not exist or is not its own"),
    "ends_in_terminate": ("[]() noexcept { throw 7; }();", "throws an exception out of a function that is noexcept"),
}
# Mistakes that leave the C library locked: the program cannot end its run in order.
LOCKING_MISTAKES = {
    "locks_loop": ("flockfile(stdout); for (volatile int i = 0;; i = i + 1) {}",
                   "does not return within a second of processor time"),
    "locks_null": ("flockfile(stdout); *volatile_null = 1;", "uses memory"),
    "locks_error": ("flockfile(stderr); *volatile_null = 1;", "uses memory"),
}
# Each of these has a test of its own.
OTHER_MISTAKES = {
    "prints": "for (;;) { std::printf(\" \"); }",
    "exits": "std::exit(0);",
    "exits_quickly": "std::quick_exit(0);",
    "exits_late": "std::atexit([] { for (volatile int i = 0;; i = i + 1) {} });",
    "rounds": "std::fesetround(FE_UPWARD);",
    "sleeps": "sleep(1000);",
    "ignores_signals": "std::signal(SIGINT, SIG_IGN);",
    "blocks_signals": "sigset_t all; sigfillset(&all); pthread_sigmask(SIG_SETMASK, &all, nullptr);",
    "blocks_signals_and_loops": "sigset_t all; sigfillset(&all); pthread_sigmask(SIG_SETMASK, &all, nullptr); "
                                "for (volatile int i = 0;; i = i + 1) {}",
    "thread_exits": "std::thread([] { std::exit(0); }).join();",
    "thread_crashes": "std::thread([] { *volatile_null = 1; }).join();",
    "forks": "static_cast<void>(fork());",
}
# Libraries that do this in each call.
IGNORES_SIGNALS = "for (const int number : {SIGINT, SIGTERM, SIGHUP}) { std::signal(number, SIG_IGN); }\n"
THREAD_IGNORES_SIGNALS = ("static const bool runs = [] { std::thread([] { for (;;) { " + IGNORES_SIGNALS +
                          " usleep(20); } }).detach(); return true; }();\n")
# One library has them all, since each would take a second to compile. This variable of the environment chooses one.
MISTAKE = "PROLEG_TEST_MISTAKE"

TOOLS = """
#include <unistd.h>
#include <cfenv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <thread>
namespace {
int* volatile volatile_null = nullptr;
volatile int volatile_zero = 0;
const char* const mistake = std::getenv("%s");
const std::string_view chosen_mistake = mistake == nullptr ? "" : mistake;
int deep(int n) { volatile char room[4096]; room[0] = 1; return n > 1'000'000'000 ? n : deep(n + room[0]) + room[0]; }
}
""" % MISTAKE


def proleg(name, *arguments, cwd=None, mistake=""):
    return subprocess.run([PROGRAMS / f"proleg-{name}", *map(str, arguments)], capture_output=True, text=True,
                          timeout=LONGEST, cwd=cwd, env={**os.environ, MISTAKE: mistake})


class UserAlgorithms(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        cls.algorithm = cls.folder / NAME
        made = proleg("new", "algorithm", NAME, "--out", cls.algorithm)
        assert made.returncode == 0, made.stderr
        cls.build = cls.algorithm / "build"
        for command in (["cmake", "-S", cls.algorithm, "-B", cls.build, "-G", "Ninja"], ["cmake", "--build", cls.build]):
            done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST)
            assert done.returncode == 0, done.stdout + done.stderr
        cls.library = cls.build / f"{NAME}.so"
        cls.scenario = cls.algorithm / "robot/robot.simulation.xml"
        cls.source = (cls.algorithm / f"{NAME}.cpp").read_text()
        cls.wrapper = (cls.build / f"{NAME}.algorithm.cpp").read_text()
        cls.mistakes = cls.library_with_mistakes()

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def compile(cls, name, source=None, wrapper=None):
        """A library from other sources."""
        file = cls.folder / f"{name}.cpp"
        file.write_text(cls.source if source is None else source)
        outer = cls.folder / f"{name}.library.cpp"
        outer.write_text((wrapper or cls.wrapper).replace(str(cls.algorithm / f"{NAME}.cpp"), str(file)))
        library = cls.folder / f"{name}.so"
        done = subprocess.run(["g++", "-std=c++20", "-O1", "-fPIC", "-shared", "-fno-rtti", "-fvisibility=hidden", "-w",
                               "-I", SOURCE, outer, cls.build / "libproleg_core.a", "-Wl,--exclude-libs,ALL", "-o",
                               library], capture_output=True, text=True, timeout=LONGEST)
        assert done.returncode == 0, done.stderr
        return library

    @classmethod
    def library_with_mistakes(cls):
        """The algorithm with every mistake, at a tick of a joint."""
        begin = "std::int32_t* next) const override {\n"
        assert cls.source.count(begin) == 1
        source = cls.source.replace("Surroundings& /*surroundings*/, const Tuning& tuning, const std::int32_t* state,\n",
                                    "Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,\n")
        mistakes = {name: code for name, (code, _) in {**MISTAKES, **LOCKING_MISTAKES}.items()} | OTHER_MISTAKES
        choice = "".join(f'if (chosen_mistake == "{name}") {{ {code} }}\n' for name, code in mistakes.items())
        source = source.replace(begin, begin + f"if (surroundings.tick == {BAD_TICK} && surroundings.context.joint == "
                                               f"{BAD_JOINT}) {{\n{choice}}}\n")
        return cls.compile("mistakes", TOOLS + source)

    def simulate(self, library, *options, program="simulate"):
        return proleg(program, self.scenario, "--algorithms", library, *options)

    def simulate_mistake(self, mistake, *options, program="simulate"):
        return proleg(program, self.scenario, "--algorithms", self.mistakes, "--seconds", "5", *options, mistake=mistake)

    def assert_one_line(self, result, *parts):
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        for part in parts:
            self.assertIn(str(part), result.stderr)

    # The way of a user.

    def test_the_template_moves_a_robot_and_follows_its_equation(self):
        test = subprocess.run(["ctest", "--test-dir", self.build, "--output-on-failure"], capture_output=True, text=True,
                              timeout=LONGEST)
        self.assertEqual(test.returncode, 0, test.stdout)
        result = self.simulate(self.library, "--seconds", "10", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertGreater(json.loads(result.stdout)["displacement_m"], 0.3)

    def test_modules_compute_what_the_simulation_does(self):
        simulated = json.loads(self.simulate(self.library, "--seconds", "4", "--json").stdout)
        result = self.simulate(self.library, "--seconds", "4", "--losses", "7:5%", "--json", program="hil")
        self.assertEqual(result.returncode, 0, result.stderr)
        native = json.loads(self.simulate(self.library, "--seconds", "4", "--json", program="hil").stdout)
        self.assertEqual(native["setpoint_hash"], simulated["setpoint_hash"])

    def test_a_recording_is_recomputed_with_the_library_and_read_without(self):
        recording = self.folder / "run.proleg"
        self.assertEqual(self.simulate(self.library, "--seconds", "1", "--record", recording).returncode, 0)
        replayed = proleg("replay", recording, "--algorithms", self.library)
        self.assertEqual(replayed.returncode, 0, replayed.stderr)
        self.assertIn("differences       0", replayed.stdout)
        without = proleg("replay", recording)
        self.assertEqual(without.returncode, 2)
        self.assert_one_line(without, f"found algorithm '{NAME}'", "expected an algorithm that this program has")
        other = self.compile("other", wrapper=re.sub(r"(#define PROLEG_ALGORITHM_SOURCES) \S+", r"\1 0xCAFEU", self.wrapper))
        replayed = proleg("replay", recording, "--algorithms", other)
        self.assertEqual(replayed.returncode, 0, replayed.stderr)
        self.assert_one_line(replayed, f"the recording was made with the user's algorithm {NAME} 0x",
                             f"this program has loaded {NAME} 0x0000CAFE; both compute the same")
        self.assertEqual(proleg("plot", recording, "--out", self.folder / "run.svg").returncode, 0)
        self.assertEqual(self.recorded_ticks(recording), 100)

    def recorded_ticks(self, recording):
        table = proleg("export", recording, "--out", "-")
        self.assertEqual(table.returncode, 0, table.stderr)
        return sum(line[0].isdigit() for line in table.stdout.splitlines())

    def test_parameters_are_those_of_the_declaration(self):
        listed = proleg("algorithms", NAME, "--algorithms", self.library)
        self.assertIn("steepness, 0 to 1, default 0.25", listed.stdout)
        result = self.simulate(self.library, "--seconds", "0.1", "--set", "steepness=2")
        self.assertEqual(result.returncode, 2)
        self.assert_one_line(result, "steepness")

    def test_workers_of_a_search_have_it(self):
        result = self.optimise(self.library, self.folder / "search")
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_a_simulated_bus_that_drive_starts_has_it(self):
        for options in (("--fast",), ()):
            with self.subTest(options=options):
                done = proleg("drive", self.scenario, "--algorithms", self.library, "--bus", f"sim:{self.scenario}",
                              "--seconds", "1", *options)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertIn("0 differences", done.stdout)

    def test_modules_that_run_it_describe_its_parameters(self):
        declared = re.search(r'\{"steepness".*?"([^"]+)"\}', self.source, re.DOTALL).group(1)
        bus = subprocess.Popen([PROGRAMS / "proleg-bus", self.scenario, "--tcp", "0", "--algorithms", self.library],
                               stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        try:
            address = re.search(r"--bus (tcp:\S+)", bus.stdout.readline()).group(1)
            done = proleg("drive", self.scenario, "--algorithms", self.library, "--bus", address, "--seconds", "1")
            self.assertEqual(done.returncode, 0, done.stderr)
            info = proleg("info", "1", "--algorithms", self.library, "--bus", address, "--json")
            values = {value["name"]: value for value in json.loads(info.stdout)["values"]}
            steepness = values[f"{NAME} steepness: slot 1"]
            self.assertEqual((steepness["writable"], steepness["help"]), (True, declared))
        finally:
            bus.send_signal(signal.SIGINT)
            bus.communicate(timeout=LONGEST)

    # Commands that are printed so that the user repeats them.

    def run_printed(self, command):
        """As a user pastes it."""
        self.assertTrue(command.startswith("proleg "), command)
        return subprocess.run([f"exec {PROGRAMS}/{command}"], shell=True, capture_output=True, text=True, timeout=LONGEST,
                              cwd=self.folder)

    def evaluations(self):
        """How many the search has stored."""
        try:
            # Without `mode` a file would be made, which the search takes for the store of another one.
            with contextlib.closing(sqlite3.connect(f"file:{self.folder}/parts/store.sqlite?mode=rw", uri=True)) as store:
                return store.execute("SELECT count(*) FROM evaluation").fetchone()[0]
        except sqlite3.OperationalError:  # it has not made its store yet, or is writing
            return 0

    def test_the_command_that_continues_a_search_loads_the_library(self):
        experiment = self.experiment()
        experiment.write_text(experiment.read_text().replace("<generations>2<", "<generations>100000<"))
        search = subprocess.Popen([PROGRAMS / "proleg-optimise", experiment, "--algorithms", self.library, "--out", "parts",
                                   "--evaluations", "100000"], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True,
                                  cwd=self.folder)
        self.addCleanup(search.kill)
        wait_until(lambda: search.poll() is not None or self.evaluations() >= 5, "evaluations of the search")
        search.send_signal(signal.SIGINT)
        _, errors = search.communicate(timeout=LONGEST)
        self.assertIn("continue with: ", errors)
        command = errors.partition("continue with: ")[2].splitlines()[0]
        continued = self.run_printed(command.replace(" 100000 ", " 20 ") + " --json")
        self.assertEqual(continued.returncode, 0, continued.stderr)
        self.assertGreaterEqual(json.loads(continued.stdout)["evaluations"], 20)

    def test_the_command_that_the_page_shows_loads_the_library(self):
        page = self.folder / "page"
        page.mkdir()
        (page / "index.html").write_text("<!doctype html><title>page</title>")
        server = subprocess.Popen([PROGRAMS / "proleg-ui", self.scenario, "--algorithms", self.library, "--no-browser", "--page",
                                   page], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=self.folder)
        self.addCleanup(server.communicate)
        self.addCleanup(server.kill)
        address = re.search(r"http://127\.0\.0\.1:(\d+)/#(\S+)", server.stdout.readline())
        with Viewer(int(address[1]), address[2]) as viewer:
            command = "--seconds 0"
            while command.endswith("--seconds 0"):
                command = viewer.do("command_line")["value"]["text"]
        repeated = self.run_printed(command)
        self.assertEqual(repeated.returncode, 0, repeated.stderr)

    def optimise(self, library, out, mistake=""):
        return proleg("optimise", self.experiment(), "--algorithms", library, "--workers", "2", "--out", out, mistake=mistake)

    def experiment(self):
        file = self.algorithm / "search.optimise.xml"
        file.write_text(f"""<cmaEs>
  <simulation>robot/robot.simulation.xml</simulation>
  <properties>
    <popsize>6</popsize>
    <generations>2</generations>
    <numOfParametersToOptimize>1</numOfParametersToOptimize>
    <registeredParameters>
      <parameter number="0" controlAlgorithm="{NAME}" parameter="steepness"/>
    </registeredParameters>
  </properties>
  <genome>
    <genomeConfig number="0" allJoints="1" genomeType="1" valueType="1" valueSpace="1" activeJoints="11111">
      <lowerBounds>0</lowerBounds>
      <upperBounds>1</upperBounds>
      <boundsIncrements>0.1</boundsIncrements>
      <lowerBoundTypes>1</lowerBoundTypes>
      <upperBoundTypes>1</upperBoundTypes>
      <uniform>0</uniform>
    </genomeConfig>
  </genome>
  <fitness><objective measure="distance"/></fitness>
  <evaluation>
    <evaluations>12</evaluations>
    <seed>1</seed>
  </evaluation>
</cmaEs>
""")
        return file

    # Names and folders.

    def test_new_refuses_what_it_cannot_make(self):
        existing = self.folder / "existing"
        existing.mkdir(exist_ok=True)
        for arguments, part in ((("9lives",), "9lives"), (("a-b",), "a-b"), (("",), "NAME"), (("class",), "C++"),
                                (("x" * 41,), "letters"), (("my_test",), "_test"),
                                (("PatternGenerator_sinusoidal",), "built-in"), (("directjointaccess",), "built-in"),
                                (("wave", "--out", existing), "existing"), (("wave", "--id", "95"), "96 to 126"),
                                (("wave", "--id", "127"), "96 to 126"), (("wave", "--source", existing), "--source")):
            with self.subTest(arguments):
                result = proleg("new", "algorithm", *arguments, cwd=self.folder)
                self.assertEqual(result.returncode, 2)
                self.assert_one_line(result, part)
        self.assertFalse((self.folder / "wave").exists(), "nothing was written")

    def test_without_the_library_the_scenario_names_the_algorithm(self):
        for program, options in (("simulate", ()), ("hil", ()), ("bus", ("--pty",))):
            result = proleg(program, self.scenario, *options)
            self.assertEqual(result.returncode, 2)
            self.assert_one_line(result, "robot.actuation.xml:4", f"unknown algorithm '{NAME}'",
                                 "or that of a library (--algorithms)")

    # Mistakes while the robot moves.

    def test_each_mistake_is_one_line_and_keeps_the_run_before_it(self):
        for name, (_, text) in MISTAKES.items():
            with self.subTest(name):
                recording = self.folder / f"{name}.proleg"
                result = self.simulate_mistake(name, "--record", recording)
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assert_one_line(result, f"proleg simulate: {self.mistakes}: the algorithm '{NAME}' ", text,
                                     f"in advance() at tick {BAD_TICK}, joint {BAD_JOINT} (0 is at the head)",
                                     f"the run until then is in {recording}")
                self.assertEqual(self.recorded_ticks(recording), BAD_TICK, "the ticks before it")

    def test_a_mistake_that_leaves_the_c_library_locked_ends_the_program(self):
        for name, (_, text) in LOCKING_MISTAKES.items():
            with self.subTest(name):
                result = self.simulate_mistake(name)
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assert_one_line(result, f"the algorithm '{NAME}' {text}", "in advance()", "the program ends")

    def test_a_loop_that_prints_ends(self):
        for attempt in range(3):  # where the loop is interrupted is chance
            with self.subTest(attempt):
                result = self.simulate_mistake("prints")
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assert_one_line(result, f"the algorithm '{NAME}' does not return within a second")

    def test_exit_is_no_success(self):
        result = self.simulate_mistake("exits")
        self.assertEqual(result.returncode, 1)
        self.assert_one_line(result, f"the algorithm '{NAME}' calls exit(), in advance()")

        result = self.simulate_mistake("exits_quickly")
        self.assertEqual(result.returncode, 1)
        self.assert_one_line(result, f"the algorithm '{NAME}' calls quick_exit(), in advance()")

    def test_a_call_that_sleeps_is_one_line(self):
        result = self.simulate_mistake("sleeps")
        self.assertEqual(result.returncode, 1)
        self.assert_one_line(result, f"the algorithm '{NAME}' does not return within 20 s: does it wait or sleep?")

    def test_a_loop_that_blocks_all_signals_ends(self):
        result = self.simulate_mistake("blocks_signals_and_loops")
        self.assertEqual(result.returncode, 1)
        self.assert_one_line(result, f"the algorithm '{NAME}' does not return within a second", "it blocks signals")

    def test_a_mode_of_floating_point_changes_nothing(self):
        constructor = self.compile("rounding", "#include <cfenv>\n" + self.source + "\nnamespace { const struct First { "
                                   "First() { std::fesetround(FE_UPWARD); } } first; }\n")
        runs = [self.simulate(self.library, "--seconds", "5", "--json"), self.simulate_mistake("rounds", "--json"),
                self.simulate(constructor, "--seconds", "5", "--json")]
        measures = [json.loads(run.stdout)["measures"] for run in runs]
        self.assertEqual(measures[0], measures[1])
        self.assertEqual(measures[0], measures[2])

    def test_signals_end_the_program_although_the_library_changes_them(self):
        constructor = self.compile("ignoring", "#include <csignal>\n" + self.source + "\nnamespace { const struct First { "
                                   "First() { std::signal(SIGINT, SIG_IGN); sigset_t all; sigfillset(&all); "
                                   "pthread_sigmask(SIG_SETMASK, &all, nullptr); } } first; }\n")
        for library, mistake in ((constructor, ""), (self.mistakes, "ignores_signals"), (self.mistakes, "blocks_signals")):
            with self.subTest(mistake or "constructor"):
                recording = self.folder / f"signals_{mistake}.proleg"
                run = subprocess.Popen([PROGRAMS / "proleg-simulate", self.scenario, "--algorithms", library, "--seconds",
                                        "50000", "--record", recording], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                       text=True, env={**os.environ, MISTAKE: mistake})
                self.addCleanup(run.kill)
                wait_until(lambda: Path(f"{recording}-wal").exists() and Path(f"{recording}-wal").stat().st_size > 1e5)
                run.send_signal(signal.SIGINT)
                self.assertIn("interrupted after", run.communicate(timeout=LONGEST)[1])
                self.assertEqual(run.returncode, 1)

    def test_one_control_c_stops_a_robot_although_the_library_ignores_it_always(self):
        begin = "std::int32_t* next) const override {\n"
        for name, code in (("in_each_call", IGNORES_SIGNALS), ("in_a_thread", THREAD_IGNORES_SIGNALS)):
            library = self.compile(f"ignores_{name}", TOOLS + self.source.replace(begin, begin + code))
            for program, options in (("drive", ("--bus", f"sim:{self.scenario}", "--seconds", "3600")),
                                     ("simulate", ("--seconds", "50000"))):
                with self.subTest(f"{program}, {name}"):
                    recording = self.folder / f"{program}_{name}.proleg"
                    run = subprocess.Popen([PROGRAMS / f"proleg-{program}", self.scenario, "--algorithms", library, *options,
                                            "--record", recording], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                           stderr=subprocess.PIPE, text=True)
                    self.addCleanup(run.kill)
                    wait_until(lambda: Path(f"{recording}-wal").exists() and Path(f"{recording}-wal").stat().st_size > 1e5)
                    run.send_signal(signal.SIGINT)
                    output, errors = run.communicate(timeout=LONGEST)
                    self.assertEqual(run.returncode, 0 if program == "drive" else 1, output + errors)
                    self.assertIn("0 differences" if program == "drive" else "interrupted after", output + errors)

    def test_a_copy_of_the_program_that_the_library_makes_ends(self):
        result = self.simulate_mistake("forks")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout.count("set-point hash"), 1, result.stdout)
        self.assert_one_line(result, self.mistakes, "calls fork()", "the copy of the program ends")

    def test_exit_in_a_thread_of_the_library_is_no_success(self):
        result = self.simulate_mistake("thread_exits")
        self.assertEqual(result.returncode, 1)
        self.assert_one_line(result, self.mistakes, "a thread that this library started calls exit()")

    def test_a_destructor_that_does_not_return_does_not_keep_the_program(self):
        for name, body, text in (("loops", "for (volatile int i = 0;; i = i + 1) {}", "does not end with the program"),
                                 ("crashes", "*volatile_null = 1;", "crashes (SIGSEGV) at the end of the program")):
            with self.subTest(name):
                library = self.compile(f"destructor_{name}", TOOLS + self.source + "namespace { struct Last { ~Last() { " +
                                       body + " } } last; }\n")
                result = self.simulate(library, "--seconds", "1")
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assert_one_line(result, library, text)
                self.assertIn("displacement", result.stdout, "the results are written before")
        result = self.simulate_mistake("exits_late")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assert_one_line(result, self.mistakes, "does not end with the program")

    def test_a_crash_of_a_thread_of_the_library_names_it(self):
        result = self.simulate_mistake("thread_crashes")
        self.assertEqual(result.returncode, 1)
        self.assert_one_line(result, "the program has crashed (SIGSEGV)", self.mistakes, "a thread")

    def test_modules_report_it_too(self):
        result = self.simulate_mistake("null", program="hil")
        self.assertEqual(result.returncode, 1)
        self.assert_one_line(result, f"the algorithm '{NAME}' uses memory", f"at tick {BAD_TICK}, joint {BAD_JOINT}")

    def test_a_mistake_in_output_names_the_joint(self):
        begin = "const std::int32_t* state) const override {\n    const auto theta"
        self.assertEqual(self.source.count(begin), 1)
        library = self.compile("output", self.source.replace(
            begin, begin.replace("\n", "\n    if (state[0] == state[40]) { return 1; }\n")))
        result = self.simulate(library, "--seconds", "5")
        self.assertEqual(result.returncode, 1)
        self.assert_one_line(result, "uses elements of its array 'state'", "in output()", "joint 0")

    def test_a_mistake_ends_a_search_and_keeps_its_store(self):
        out = self.folder / "failed_search"
        result = self.optimise(self.mistakes, out, mistake="throws")
        self.assertEqual(result.returncode, 1)
        self.assertIn(f"the algorithm '{NAME}' throws an exception: no idea", result.stderr)
        self.assertTrue(any(out.iterdir()))

    # Sources that do not become a library.

    def test_floating_point_ends_the_build_with_its_reason(self):
        for name, code in (("double", "static_cast<std::int32_t>(state[0] * 0.37)"),
                           ("float", "static_cast<std::int32_t>(std::sqrt(static_cast<float>(state[0])))")):
            with self.subTest(name):
                folder = self.folder / f"floating_{name}"
                self.assertEqual(proleg("new", "algorithm", f"floating_{name}", "--out", folder).returncode, 0)
                file = folder / f"floating_{name}.cpp"
                text = file.read_text()
                step = "next[current_phase] = "
                self.assertEqual(text.count(step), 1)
                file.write_text("#include <cmath>\n" + text.replace(step, f"{step}{code} + "))
                build = folder / "build"
                subprocess.run(["cmake", "-S", folder, "-B", build, "-G", "Ninja"], check=True, capture_output=True)
                done = subprocess.run(["cmake", "--build", build], capture_output=True, text=True, timeout=LONGEST)
                self.assertNotEqual(done.returncode, 0)
                self.assertRegex(done.stdout, rf"{re.escape(str(file))}: found\s+floating point")

    # Libraries that cannot be used.

    def test_bad_libraries_are_named_before_anything_runs(self):
        export = "const proleg::AlgorithmInterface proleg_algorithm_interface ="
        self.assertIn(export, self.wrapper)
        text = self.folder / "text.so"
        text.write_text("no library\n")
        plain = self.folder / "plain.so"
        subprocess.run(["g++", "-shared", "-fPIC", "-x", "c++", "/dev/null", "-o", plain], check=True)

        def changed(name, change):
            wrapper = re.sub(r"(const proleg::AlgorithmInterface proleg_algorithm_interface =)\s*(proleg::interface_of.*?);",
                             r"\1 [] { auto made = \2; " + change + r" return made; }();", self.wrapper, flags=re.S)
            return self.compile(name, wrapper=wrapper)

        def other(name, old, new):
            self.assertIn(old, self.source)
            return self.compile(name, self.source.replace(old, new))

        with_id = re.search(r"\n    (\d+), \"" + NAME, self.source).group(1)
        cases = {
            "missing": (self.folder / "missing.so", "found no such file"),
            "folder": (self.folder, "found a folder"),
            "device": ("/dev/zero", "found a device, a pipe or a socket"),
            "text": (text, "found no library that can be loaded"),
            "no_symbol": (plain, "found no object proleg_algorithm_interface"),
            "version": (changed("version", "made.version = 2;"),
                        "found version 2 of the interface of algorithms, expected version 1"),
            "layout": (changed("layout", "made.layout[2] += 8;"), "bytes of Declaration, expected"),
            "core": (changed("core", "made.core ^= 1;"), "found a library for the core"),
            "mark": (changed("mark", "made.mark[0] = 'x';"), "found another object"),
            "sources": (changed("sources", "made.sources ^= 1;"), "PROLEG_ALGORITHM_SOURCES"),
            "id": (other("id", f"\n    {with_id}, \"{NAME}\"", f"\n    12, \"{NAME}\""), "found algorithm id 12"),
            "built_in": (other("built_in", f"{with_id}, \"{NAME}\"", f"{with_id}, \"PatternGenerator_sinusoidal\""),
                         "expected another name and id than those of 'PatternGenerator_sinusoidal'"),
            "range": (other("range", "raw(Unit::ratio, 1, 4), 0,", "raw(Unit::ratio, 1, 4), raw(Unit::ratio, 1, 2),"),
                      "parameter 'steepness' with minimum"),
            "name": (other("name", '"steepness"', '"amplitude"'), "two parameters with the name 'amplitude'"),
            "frame": (other("frame", "current_phase, 4}}", "current_phase, 4}, FrameField{9, 1}}"),
                      "the internal value number 9"),
            "constructor": (self.compile("constructor", self.source + "\n#include <cstdlib>\n"
                                         "static const int dead = (std::abort(), 1);\n"),
                            "found a library that, while it is loaded, calls abort()"),
        }
        for name, (library, text) in cases.items():
            with self.subTest(name):
                recording = self.folder / f"bad_{name}.proleg"
                result = self.simulate(library, "--record", recording)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assert_one_line(result, f"proleg simulate: {library}: ", text)
                self.assertFalse(recording.exists())
        twice = self.simulate(self.library, "--algorithms", self.library)
        self.assertEqual(twice.returncode, 2)
        self.assert_one_line(twice, f"expected another name and id than those of '{NAME}'")

    def test_a_damaged_library_is_one_line(self):
        whole = self.library.read_bytes()
        damaged = self.folder / "damaged.so"
        for size in range(64, len(whole), len(whole) // 25):
            with self.subTest(size):
                damaged.write_bytes(whole[:size])
                result = self.simulate(damaged, "--seconds", "0.1")
                if result.returncode == 0:
                    self.assertGreater(size, len(whole) * 0.7, "nothing that is loaded may be missing")
                else:
                    self.assertEqual(result.returncode, 2, result.stderr)
                    self.assert_one_line(result, f"proleg simulate: {damaged}: found ", "expected ")

    def test_a_library_that_ends_or_keeps_the_program_while_it_is_loaded_is_one_line(self):
        for name, body, text in (
                ("ends", "_exit(0);", "ends the program with exit status 0"),
                ("is_killed", "raise(SIGKILL);", "ends the program with SIGKILL"),
                ("waits", "sigset_t all; sigfillset(&all); pthread_sigmask(SIG_SETMASK, &all, nullptr); "
                          "for (;;) { sleep(1); }", "does not end within 10 s")):
            with self.subTest(name):
                library = self.compile(f"constructor_{name}", "#include <csignal>\n#include <unistd.h>\n" + self.source +
                                       "\nnamespace { const struct First { First() { " + body + " } } first; }\n")
                result = self.simulate(library)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assert_one_line(result, f"{library}: found a library that, while it is loaded, {text}, expected one")


class Verify(unittest.TestCase):
    """Proofs take a quarter of a minute each, and more the first time."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.algorithm = Path(temporary.name) / NAME
        self.assertEqual(proleg("new", "algorithm", NAME, "--out", self.algorithm).returncode, 0)
        self.file = self.algorithm / f"{NAME}.cpp"

    def change(self, old, new):
        text = self.file.read_text()
        self.assertEqual(text.count(old), 1, old)
        self.file.write_text(text.replace(old, new))

    def test_the_template_is_verified(self):
        result = proleg("verify", self.algorithm, "--cases", "5")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        for row in ("g++ -O0", "g++ -O2", "clang++ -O0", "clang++ -O2", "Cortex-M4", "Cortex-M0"):
            self.assertRegex(result.stdout, re.escape(row) + r" +five +[0-9a-f]{12} +[0-9a-f]{12} +equal")
        self.assertRegex(result.stdout, r"cost +\d+ instructions a tick at worst")
        self.assertRegex(result.stdout, r"stack +\d+ bytes at most")

    def test_char_has_its_sign_on_every_processor(self):
        self.change("next[current_phase] = add_wrapping(", "next[current_phase] = static_cast<char>(state[0]) + add_wrapping(")
        result = proleg("verify", self.algorithm, "--cases", "2")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def verify_json(self, *options):
        result = proleg("verify", self.algorithm, "--json", *options)
        return result, json.loads(result.stdout)

    def test_the_object_has_what_the_table_has(self):
        result, proof = self.verify_json("--cases", "3")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertEqual((proof["algorithm"], proof["cases"], proof["ticks"]), (NAME, 3, 1000))
        self.assertIs(proof["verified"], True)
        self.assertEqual([(build["build"], build["kernels"]) for build in proof["builds"]],
                         [("library", 1)] +
                         [(f"{compiler} {level}", kernels) for compiler in ("g++", "clang++") for level in ("-O0", "-O2")
                          for kernels in (1, 5)] + [("Cortex-M4", 5), ("Cortex-M0", 5)])
        self.assertEqual({build["result"] for build in proof["builds"][1:]}, {"equal"})
        self.assertEqual({build["ticks"] for build in proof["builds"]}, {3000})
        self.assertEqual(len({build["setpoint_hash"] for build in proof["builds"]}), 1)
        self.assertEqual(proof["forbidden"], [])
        self.assertTrue(0 < proof["instructions"]["worst"] <= proof["instructions"]["limit"])
        self.assertTrue(0 < proof["stack"]["bytes"] <= proof["stack"]["limit"])
        self.assertTrue(100 < proof["flash_bytes"] < 5000)
        self.assertTrue(proof["test"]["passed"])
        steps = re.findall(r"^proleg verify: (\d+) of (\d+): ", result.stderr, re.M)
        self.assertEqual([int(done) for done, _ in steps], list(range(1, int(steps[0][1]) + 1)))

        # What the algorithm prints does not come between; a difference is named.
        self.change("namespace proleg::user {\nnamespace {",
                    "#include <cstdio>\n#include <cstdlib>\nnamespace proleg::user {\nnamespace {")
        self.change("next[current_phase] = add_wrapping(",
                    "std::puts(\"printed\");\n    next[current_phase] = std::rand() + add_wrapping(")
        result, proof = self.verify_json("--cases", "1", "--leave-out-missing")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIs(proof["verified"], False)
        self.assertTrue(any("rand" in each for each in proof["forbidden"]), proof["forbidden"])
        bad = [build for build in proof["builds"] if build["result"] in ("differs", "failed")]
        self.assertTrue(bad and all(build["text"] for build in bad), proof["builds"])

    def test_bad_input_is_one_line_without_an_object(self):
        for arguments, text in (((self.algorithm.parent,), "found 0 sources"), ((self.algorithm, "--cases", "0"), "--cases")):
            result = proleg("verify", *arguments, "--json")
            self.assertEqual(result.returncode, 2)
            self.assertEqual(result.stdout, "")
            self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
            self.assertIn(text, result.stderr)

    def test_floating_point_and_variables_are_found(self):
        self.change("next[current_phase] = add_wrapping(", "static int calls = 0;\n    calls += 1;\n    "
                    "next[current_phase] = calls + static_cast<std::int32_t>(0.3F * static_cast<float>(state[0])) + "
                    "add_wrapping(")
        result = proleg("verify", self.algorithm, "--cases", "2")
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        self.assertIn("uses floating point (__aeabi_f", result.stdout)
        self.assertIn("keeps a value in the variable", result.stdout)
        self.assertIn("NOT verified", result.stdout)

    def test_random_numbers_of_the_library_are_found(self):
        self.change("namespace proleg::user {\nnamespace {", "#include <cstdlib>\nnamespace proleg::user {\nnamespace {")
        self.change("next[current_phase] = add_wrapping(", "next[current_phase] = std::rand() + add_wrapping(")
        result = proleg("verify", self.algorithm, "--cases", "2")
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        self.assertIn("uses rand, which is not of the core", result.stdout)
        self.assertIn("DIFFERS: case 0, tick ", result.stdout)

    def test_a_source_that_does_not_compile_is_one_line(self):
        self.change("return instance;", "return instanse;")
        result = proleg("verify", self.algorithm)
        self.assertEqual(result.returncode, 2)
        line = [each for each in result.stderr.splitlines() if each.startswith("proleg verify:")]
        self.assertEqual(len(line), 1, result.stderr)
        self.assertIn(f"{NAME}.cpp:", line[0])

    def test_a_missing_compiler_is_named(self):
        tools = self.algorithm.parent / "tools"
        tools.mkdir()
        for name in ("cmake", "ninja", "sh", "g++", "c++", "cc", "gcc", "ld", "as", "ar", "ranlib"):
            if path := shutil.which(name):
                (tools / name).symlink_to(path)
        for options, status in (((), 1), (("--leave-out-missing",), 0)):
            result = subprocess.run([PROGRAMS / "proleg-verify", self.algorithm, "--cases", "1", *options],
                                    capture_output=True, text=True, timeout=LONGEST, env={"PATH": str(tools)})
            self.assertEqual(result.returncode, status, result.stdout + result.stderr)
            self.assertRegex(result.stdout, r"clang\+\+ -O2 .* not run: no clang\+\+")
            self.assertRegex(result.stdout, r"Cortex-M4 .* not run: no arm-none-eabi-g\+\+")
            command = "sudo apt install clang gcc-arm-none-eabi libstdc++-arm-none-eabi-newlib"
            self.assertEqual(command in result.stdout, not options)


class Image(unittest.TestCase):
    """The algorithm in the image that is flashed."""

    def build(self, folder, algorithms):
        for command in (["cmake", "--preset", "stm32f405", "-B", folder, f"-DPROLEG_USER_ALGORITHMS={algorithms}"],
                        ["cmake", "--build", folder, "--target", "proleg_stm32f405", "proleg_boot_stm32f405"]):
            done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST, cwd=SOURCE)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return folder / "bin/proleg_stm32f405.elf"

    def test_virtual_chips_crawl_with_it_and_refuse_it_where_they_do_not_have_it(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            algorithm = folder / NAME
            self.assertEqual(proleg("new", "algorithm", NAME, "--out", algorithm).returncode, 0)
            for command in (["cmake", "-S", algorithm, "-B", algorithm / "build", "-G", "Ninja"],
                            ["cmake", "--build", algorithm / "build"]):
                subprocess.run(command, check=True, capture_output=True, timeout=LONGEST)
            run = ("hil", algorithm / "robot/robot.simulation.xml", "--algorithms", algorithm / f"build/{NAME}.so",
                   "--modules", "mcu", "--seconds", "3", "--image")
            image = self.build(folder / "image", algorithm)
            self.assertRegex(proleg("image", "info", image.with_suffix(".pimg")).stdout, r"commit .* \+ changes\n",
                             "the version shows that the image has more than the commit")
            result = proleg(*run, image)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn("differences       0 against the gait in memory", result.stdout)

            source = algorithm / f"{NAME}.cpp"
            source.write_text(source.read_text().replace("a sine with a second harmonic", "another sine"))
            subprocess.run(["cmake", "--build", algorithm / "build"], check=True, capture_output=True, timeout=LONGEST)
            result = proleg(*run, image)
            self.assertEqual(result.returncode, 1)
            self.assertIn("found one of other sources (0x", result.stderr)
            self.assertIn(f"expected the algorithm '{NAME}'", result.stderr)

            result = proleg(*run, self.build(folder / "image", ""))
            self.assertEqual(result.returncode, 1)
            self.assertIn(f"found none, expected the algorithm '{NAME}'", result.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

"""tools/lab: what comes back from a command in the virtual machine, and what is reported if the machine fails.

One test boots a guest. The others, in virtual time, start a program in QEMU's place that speaks with tools/lab as the guest
does, or run the script that the guest would run. The checks in tests/lab show the rest.

Usage: lab_test.py CLASS...
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[3]
# This interpreter runs it: a version manager may put a script before it that takes longer than most tests.
LAB = (sys.executable, SOURCE / "tools" / "lab")
sys.dont_write_bytecode = True
sys.path.insert(0, str(SOURCE / "tools" / "lab.d"))
import guest  # noqa: E402
import kernel  # noqa: E402

LAB_FAILED = 125
TIMEOUT_S = 200

FAKE_QEMU = f"#!{sys.executable}" + """
import os, re, sys, time
line = " ".join(sys.argv)
channel = {name: int(fd) for name, fd in re.findall(r"socket,id=(\\w+),fd=(\\d+)", line)}
def write(name, content):
    content = content.encode()
    while content:
        content = content[os.write(channel[name], content):]
"""


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)


class Messages(Folder):
    """With a program in QEMU's place."""

    def start(self, behaviour, *options):
        fake = self.folder / "qemu-system-x86_64"
        fake.write_text(FAKE_QEMU + behaviour)
        fake.chmod(0o755)
        return subprocess.Popen([*LAB, "--no-kvm", "--keep-log", self.folder / "log", *options, "--", "command"],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                env={**os.environ, "PATH": f"{self.folder}:{os.environ['PATH']}"})

    def run_lab(self, behaviour, *options):
        process = self.start(behaviour, *options)
        out, err = process.communicate(timeout=TIMEOUT_S)
        return process.returncode, out, err

    def expect_failure(self, text, *run):
        status, out, err = self.run_lab(*run)
        self.assertEqual((status, out), (LAB_FAILED, ""))
        self.assertRegex(err, f"^lab: .*{text}.*\n$")

    def test_the_status_of_the_command_comes_back(self):
        for status in (0, 1, 2, 3, 77, 124, 127, 255):
            with self.subTest(status):
                ended = f"write('reports', 'booted\\nstarted\\nended {status} 0 0\\n'); time.sleep(1000)"
                self.assertEqual(self.run_lab(ended), (status, "", ""))

    def test_the_status_that_means_a_failed_lab_comes_back_as_1(self):
        status, _, err = self.run_lab("write('reports', 'started\\nended 125 0 0\\n'); time.sleep(1000)")
        self.assertEqual(status, 1)
        self.assertIn("left with status 125", err)

    def test_output_and_errors_come_back_apart_and_complete_although_they_arrive_after_the_status(self):
        status, out, err = self.run_lab("""
write('reports', 'started\\nended 0 3000000 6\\n')
time.sleep(0.5)
write('out', 'output' * 500000)
write('err', 'errors')
time.sleep(1000)
""")
        self.assertEqual((status, out == "output" * 500000, err), (0, True, "errors"))

    def test_a_panic_is_a_failure_of_the_lab(self):
        self.expect_failure("the guest's kernel panicked: Attempted to kill init!",
                            "write('log', 'Kernel panic - not syncing: Attempted to kill init!\\r\\n')")

    def test_a_machine_that_does_not_start_is_a_failure_of_the_lab(self):
        self.expect_failure("QEMU ended with status 1 before the command had ended: cannot set up guest memory",
                            "print('cannot set up guest memory', file=sys.stderr); sys.exit(1)")

    def test_a_guest_that_does_not_boot_is_a_failure_of_the_lab(self):
        self.expect_failure("had not started the command after 1 s", "time.sleep(1000)", "--time-out", "1")

    def test_a_command_that_does_not_end_is_a_failure_of_the_lab(self):
        self.expect_failure("the command had not ended after 20 s", "write('reports', 'started\\n'); time.sleep(1000)",
                            "--time-out", "20")

    def test_a_guest_that_cannot_be_set_up_is_a_failure_of_the_lab(self):
        self.expect_failure("hci0 could not be brought up",
                            "write('reports', 'booted\\nfailed hci0 could not be brought up\\n'); time.sleep(1000)")

    def test_the_log_of_the_kernel_is_kept(self):
        self.run_lab("write('log', 'Linux version'); write('reports', 'started\\nended 0 0 0\\n'); time.sleep(1000)")
        self.assertEqual((self.folder / "log").read_text(), "Linux version")

    def test_a_signal_ends_the_machine(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number):
                process = self.start("write('out', f'{os.getpid()}\\n'); time.sleep(1000)")
                machine = int(process.stdout.readline())
                process.send_signal(number)
                process.communicate(timeout=TIMEOUT_S)
                self.assertEqual(process.returncode, -number)
                self.assertFalse(Path(f"/proc/{machine}").exists())

    def test_wrong_words_are_no_status_of_a_command(self):
        for words in ([], ["--memory", "much", "--", "true"], ["--results", "/no/such/folder", "--", "true"],
                      ["--prepare", "true"]):
            with self.subTest(words):
                finished = subprocess.run([*LAB, *words], capture_output=True, text=True, check=False, timeout=TIMEOUT_S)
                self.assertEqual(finished.returncode, LAB_FAILED)
                self.assertRegex(finished.stderr, r"lab: .*found|lab: .*expected|lab: .*invalid")


class Job(Folder):
    """The script that starts the command in the guest, here run on this computer."""

    def run_job(self, command, **environment):
        with unittest.mock.patch.dict(os.environ, environment):
            here = os.getcwd()
            os.chdir(self.folder)
            try:
                job = guest.job_script(kernel.Kernel(kernel.cache_folder() / "current"), command, None, False)
            finally:
                os.chdir(here)
        finished = subprocess.run(["sh", "-c", job + "run_command"], cwd="/", env={}, capture_output=True, text=True,
                                  check=False)
        return finished.returncode, finished.stdout

    def test_every_status_is_that_of_the_command(self):
        for status in (0, 1, 3, 77):
            self.assertEqual(self.run_job(["sh", "-c", f"exit {status}"])[0], status)

    def test_a_command_that_is_not_found_has_the_shells_status(self):
        self.assertEqual(self.run_job(["no_such_program"])[0], 127)

    def test_a_command_that_cannot_be_started_has_the_shells_status(self):
        self.assertEqual(self.run_job(["/etc/passwd"])[0], 126)

    def test_words_arrive_as_they_are(self):
        words = ["a b", "it's", '"', "$HOME", "\\n", "line\nline", "*", ";", "", "-n", "x=1"]
        self.assertEqual(self.run_job(["printf", "%s|", *words])[1], "".join(word + "|" for word in words))

    def test_the_command_runs_in_the_folder_of_the_caller(self):
        self.assertEqual(self.run_job(["pwd"])[1], f"{self.folder}\n")

    def test_variables_of_the_caller_arrive_but_for_those_of_its_session(self):
        _, out = self.run_job(["env"], PROLEG_SOME="it's $1", DISPLAY=":0", TMPDIR="/var/tmp")
        self.assertIn("PROLEG_SOME=it's $1\n", out)
        self.assertIn("TMPDIR=/tmp\n", out)
        self.assertIn("PROLEG_LAB=", out)
        self.assertNotIn("DISPLAY", out)


class Offer:
    """apt with these packages."""

    def __init__(self, *names):
        self.names = names

    def search(self, command):
        pattern = command[-1]
        return "".join(f"{name} - Linux\n" for name in self.names if re.search(pattern, name))


class Choice(unittest.TestCase):
    """Which of the kernels that apt offers is used."""

    def choose(self, *names):
        with unittest.mock.patch.object(kernel, "run", Offer(*names).search):
            return kernel.choose(kernel.Apt())

    def test_the_newest_of_the_wanted_series_by_number(self):
        names = [f"linux-image-6.12.{number}+deb12-amd64" for number in (99, 117, 111)]
        self.assertEqual(self.choose(*names, "linux-image-6.1.0-52-amd64"), (names[1], ""))

    def test_no_debug_symbols_and_no_unsigned_image(self):
        self.assertIsNone(self.choose("linux-image-6.12.117+deb12-amd64-dbg", "linux-image-6.12.117+deb12-amd64-unsigned"))

    def test_without_the_wanted_series_the_newest_older_one_that_is_not_known_bad(self):
        name, reason = self.choose("linux-image-6.1.0-9-amd64", "linux-image-6.1.0-52-amd64", "linux-image-6.1.0-56-amd64")
        self.assertEqual(name, "linux-image-6.1.0-52-amd64")
        self.assertIn("bookworm-security main` to the apt sources", reason)

    def test_a_kernel_that_is_known_bad_is_used_if_there_is_no_other_and_the_reason_is_named(self):
        name, reason = self.choose("linux-image-6.1.0-56-amd64")
        self.assertEqual(name, "linux-image-6.1.0-56-amd64")
        self.assertIn("panics when RFCOMM", reason)

    def test_none_where_none_is_offered(self):
        self.assertIsNone(self.choose("linux-image-5.10.0-1-amd64"))

    def test_a_file_that_is_no_kernel_is_refused(self):
        with self.assertRaisesRegex(kernel.Failure, "expected zstd or xz"):
            kernel.vmlinux_of(bytes(4096))


class Boot(Folder):
    """The first lines of the command show that it ran; the panic that follows must not look like its end. In virtual time
    the output has left the guest when ten seconds are over, also on a busy computer."""

    COMMAND = """
cat given; echo output; echo errors >&2; echo result >"$PROLEG_LAB_RESULTS/file"
(echo written >given) 2>/dev/null && echo "found that the current folder can be written"
sync; sleep 10; echo c >/proc/sysrq-trigger; sleep 1000
"""

    def test_a_panic_while_the_command_runs_is_reported(self):
        results = self.folder / "results"
        results.mkdir()
        (self.folder / "given").write_text("a file below /tmp\n")
        finished = subprocess.run(
            [*LAB, "--virtual-time", "--time-out", str(TIMEOUT_S), "--results", results, "--keep-log", self.folder / "log",
             "--", "sh", "-c", self.COMMAND],
            cwd=self.folder, capture_output=True, text=True, check=False, timeout=TIMEOUT_S + 30)
        log = (self.folder / "log").read_text(errors="replace")
        self.assertEqual(finished.stdout, "a file below /tmp\noutput\n", log)
        self.assertRegex(finished.stderr, "^errors\nlab: the guest's kernel panicked: sysrq triggered crash; log: .*\n$")
        self.assertEqual(finished.returncode, LAB_FAILED)
        self.assertEqual((results / "file").read_text(), "result\n")


if __name__ == "__main__":
    unittest.main()

"""page_command_test.py PROLEG_UI: the command `proleg ui` without a browser: what it refuses, and `--lan` from the refusal on."""

import os
import re
import shutil
import signal
import socket
import ssl
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
import urllib.request
from pathlib import Path

PROLEG_UI = Path(sys.argv.pop(1)).resolve()
SCENARIOS = Path(__file__).resolve().parents[3] / "sim/scenarios"
WAIT_S = 300  # a limit for a test that fails, not a requirement


class PageTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / "page").mkdir()
        (self.folder / "page/index.html").write_text("<!doctype html><title>page</title>")

    def start(self, *options):
        process = subprocess.Popen([PROLEG_UI, "--no-browser", "--page", "page", *options], cwd=self.folder, text=True, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, env={**os.environ, "XDG_RUNTIME_DIR": str(self.folder)})
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def refused(self, *options):
        process = self.start(*options)
        output, errors = process.communicate(timeout=WAIT_S)
        self.assertEqual((process.returncode, output, errors.count("\n")), (2, "", 1), errors)
        return errors


class AlgorithmThatIsNotLoaded(PageTest):
    """A scenario names an algorithm of the user's own, and --algorithms is missing."""

    def setUp(self):
        super().setUp()
        shutil.copytree(SCENARIOS / "travelling_wave", self.folder / "mine")
        gait = self.folder / "mine/uniform.actuation.xml"
        gait.write_text(gait.read_text().replace("PatternGenerator_sinusoidal", "my_wave"))
        self.scenario = "mine/uniform.simulation.xml"

    def write_source(self, folder):
        (folder / "my_wave").mkdir()
        (folder / "my_wave/CMakeLists.txt").write_text("proleg_algorithm_project()\n")
        (folder / "my_wave/my_wave.cpp").write_text("\n")

    def test_if_its_source_is_in_the_project_the_page_offers_to_build_it(self):
        self.write_source(self.folder)
        for options in ((), ("--paused",)):
            process = self.start(self.scenario, *options)
            self.assertIn("page: http://", process.stdout.readline())
            text = "".join(process.stdout.readline() for _ in range(3))
            self.assertIn("This scenario needs an algorithm of this folder: my_wave. The page Make offers to build it.", text)
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=WAIT_S)
            self.assertEqual((process.returncode, errors), (0, ""))
        self.assertFalse((self.folder / "my_wave/build").exists(), "nothing is built before a person wants it")

    def test_without_its_source_the_error_says_what_is_missing(self):
        self.assertIn("found unknown algorithm 'my_wave'", self.refused(self.scenario))

    def test_a_source_that_is_near_is_named(self):
        self.write_source(self.folder)
        library = self.folder.resolve() / "my_wave/build/my_wave.so"
        (self.folder / "elsewhere").mkdir()
        for options in (("--recordings", "elsewhere"), ("--set", "amplitude=30"), ("--bus", "can0")):
            self.assertTrue(self.refused(self.scenario, *options).endswith(f"add --algorithms {library}\n"))

    def test_where_no_code_is_taken_it_is_an_error(self):
        self.write_source(self.folder)
        command = re.search("openssl req .*", self.refused("--lan"))[0]
        subprocess.run(command.replace("$(hostname)", "localhost"), shell=True, cwd=self.folder, check=True, capture_output=True)
        lan = ("--lan", "--certificate", "page.pem")
        self.assertIn("build it, then add --algorithms", self.refused(self.scenario, *lan))
        process = self.start(self.scenario, *lan, "--allow-code")
        self.assertIn("page: https://", process.stdout.readline())


class PageForOthers(PageTest):
    def make_certificate(self):
        """With the command that the refusal prints."""
        command = re.search("openssl req .*", self.refused("--lan"))[0]
        subprocess.run(command.replace("$(hostname)", "localhost"), shell=True, cwd=self.folder, check=True, capture_output=True)

    def test_the_refusal_prints_a_command_that_makes_a_certificate(self):
        self.make_certificate()
        process = self.start("--lan", "--certificate", "page.pem")
        url = re.fullmatch("page: (https://localhost:[0-9]+)/#(.+)\n", process.stdout.readline())
        context = ssl.create_default_context(cafile=self.folder / "page.pem")
        # A new machine may have no /etc/hosts, and then no localhost.
        resolve = socket.getaddrinfo
        local = unittest.mock.patch("socket.getaddrinfo", lambda host, *rest: resolve("127.0.0.1" if host == "localhost" else host, *rest))
        self.addCleanup(local.stop)
        local.start()
        with urllib.request.urlopen(url[1] + "/", context=context, timeout=WAIT_S) as page:
            self.assertIn(b"<title>page</title>", page.read())
            self.assertIn(url[1].replace("https", "wss"), page.headers["Content-Security-Policy"])
        stop = urllib.request.Request(url[1] + "/stop", b"", {"Authorization": f"Bearer {url[2]}"})
        with urllib.request.urlopen(stop, context=context, timeout=WAIT_S) as answer:
            self.assertEqual(answer.read(), b'{"stopped": true}')
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=WAIT_S)
        self.assertEqual((process.returncode, errors), (0, ""))

    def test_a_key_that_others_can_read_is_a_warning(self):
        self.make_certificate()
        (self.folder / "page.pem").rename(self.folder / "key.pem")
        (self.folder / "key.pem").chmod(0o644)
        (self.folder / "certificate.pem").write_text((self.folder / "key.pem").read_text())
        process = self.start("--lan", "--certificate", "certificate.pem", "--key", "key.pem")
        self.assertIn("page: https://", process.stdout.readline())
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=WAIT_S)
        self.assertEqual((process.returncode, errors),
                         (0, "proleg ui: warning: key.pem: others can read the key: 'chmod 600' prevents it\n"))

    def test_options_that_do_not_fit_are_refused(self):
        self.assertIn("--certificate: found no --lan, expected --lan beside it", self.refused("--certificate", "page.pem"))
        self.assertIn("--key: found no --lan, expected --lan beside it", self.refused("--key", "page.pem"))
        self.assertIn("none.pem: found no such file, expected a certificate", self.refused("--lan", "--certificate", "none.pem"))


class WithoutHelpOfADesktop(PageTest):
    """No browser, no display, no place to write: the page is served all the same, and one line says what is missing."""

    def said(self, *options, **environment):
        """What the command writes to standard error until it serves the page and has been ended."""
        kept = {name: value for name, value in os.environ.items()
                if name not in ("DISPLAY", "WAYLAND_DISPLAY", "XDG_STATE_HOME", "TMPDIR")}
        home = self.folder / "home"
        home.mkdir(exist_ok=True)
        process = subprocess.Popen([PROLEG_UI, "--page", self.folder / "page", *options], cwd=self.folder, text=True, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, env={**kept, "XDG_RUNTIME_DIR": str(self.folder), "HOME": str(home), **environment})
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        url = re.fullmatch("page: (http://.*)/#.*\n", process.stdout.readline())
        with urllib.request.urlopen(url[1] + "/", timeout=WAIT_S) as page:
            self.assertIn(b"<title>page</title>", page.read())
        first = "" if "--no-browser" in options else process.stderr.readline()  # it may come from a program that ends later
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=WAIT_S)
        self.assertEqual(process.returncode, 0)
        return first + errors

    def program(self, text):
        """A folder for $PATH with the program that opens pages, if there is one."""
        folder = self.folder / "bin"
        folder.mkdir()
        if text:
            (folder / "xdg-open").write_text("#!/bin/sh\n" + text)
            (folder / "xdg-open").chmod(0o755)
        return str(folder)

    def test_no_display(self):
        self.assertEqual(self.said(), "proleg ui: there is no desktop with a browser here; open the address yourself\n")

    def test_a_display_and_nothing_that_opens_pages(self):
        self.assertEqual(self.said(DISPLAY=":9", PATH=self.program("")),
                         "proleg ui: there is no desktop with a browser here; open the address yourself\n")

    def test_a_desktop_without_a_browser(self):
        self.assertEqual(self.said(WAYLAND_DISPLAY="wayland-9", PATH=self.program("exit 3\n")),
                         "proleg ui: the desktop found no browser; open the address yourself\n")

    def test_no_folder_for_the_file_that_leads_to_the_page(self):
        self.assertEqual(self.said(DISPLAY=":9", XDG_RUNTIME_DIR="/proc", TMPDIR="/proc"),
                         "proleg ui: cannot write the file that leads a browser to the page; open the address yourself\n")

    def test_a_home_that_is_read_only(self):
        shutil.copytree(SCENARIOS / "travelling_wave", self.folder / "mine")
        self.assertRegex(self.said("mine/uniform.simulation.xml", "--no-browser", HOME="/proc"),
                         r"\Aproleg ui: warning: the list of what was opened cannot be kept: .*\n\Z")

    def test_the_menu_of_a_desktop_has_a_folder_in_the_home(self):
        self.assertEqual(self.said("--desktop", "--no-browser"), "")
        self.assertTrue((self.folder / "home/Proleg").is_dir())
        self.assertEqual(self.said("--desktop", "--no-browser"), "", "the folder is there")

    def test_the_menu_of_a_desktop_and_a_home_that_is_read_only(self):
        self.assertEqual(self.said("--desktop", "--no-browser", HOME="/proc", TMPDIR=str(self.folder)),
                         "proleg ui: warning: cannot write in /proc/Proleg, the folder of robots and recordings; what you save goes to "
                         f"{self.folder}\n")

    def test_the_menu_starts_no_class_and_no_bus(self):
        for options in (("--class", "3"), ("--bus", "can0")):
            self.assertIn("--desktop: found an option of a class or a bus", self.refused("--desktop", *options))


class BadInput(PageTest):
    """One line each, status 2, before anything listens."""

    def refused_for(self, *options):
        return self.refused(*options).removeprefix("proleg ui: ").removesuffix("\n")

    def test_files(self):
        (self.folder / "text.proleg").write_text("garbage")
        (self.folder / "empty.proleg").touch()
        (self.folder / "bytes.simulation.xml").write_bytes(b"\x00\xff" * 100)
        (self.folder / "text.simulation.xml").write_text("garbage")
        expected = "expected a recording, as the option --record makes it"
        self.assertEqual(self.refused_for("text.proleg"), "text.proleg: found no recording, " + expected)
        self.assertEqual(self.refused_for("empty.proleg"), "empty.proleg: found no recording, " + expected)
        self.assertEqual(self.refused_for("none.proleg"), "none.proleg: found no file, " + expected)
        self.assertRegex(self.refused_for("none.simulation.xml"), "^none.simulation.xml: found no file that can be read")
        self.assertRegex(self.refused_for("bytes.simulation.xml"), "^bytes.simulation.xml:1: found a byte 0")
        self.assertRegex(self.refused_for("text.simulation.xml"), "^text.simulation.xml:1: found malformed XML")
        self.assertRegex(self.refused_for("--recordings", "none"), "^--recordings: found 'none', expected a folder")

    def test_options(self):
        self.assertRegex(self.refused_for("--port", "70000"), "^--port: found '70000', expected 0 to 65535")
        self.assertRegex(self.refused_for("--set", "amplitude=999"), "found '999' for parameter 'amplitude', expected a number from 0 to 90 deg")
        self.assertRegex(self.refused_for("--bus", "elsewhere:1"), "expected a bus: a CAN interface such as can0")
        self.assertRegex(self.refused_for("--bus", "sim:none.xml"), "^--bus: found 'sim:none.xml', expected sim:FILE")
        self.assertRegex(self.refused_for(".", "--paused"), "^found an option of a robot with .")
        self.assertEqual(self.refused_for("--engine", "bullet"), "--engine: found 'bullet', expected 'ode', 'reduced' or 'mujoco'")

    def test_a_robot_that_the_engine_does_not_have(self):
        wave = self.folder / "wave"
        shutil.copytree(Path(__file__).resolve().parents[3] / "sim/scenarios/travelling_wave", wave)
        segment = wave / "modules/segment.kinbody.xml"
        sphere = '<Geom type="sphere"><translation>0 0.036 0</translation><radius>0.026</radius>'
        text = re.sub(r'<Geom type="box">\s*<translation>0 0.036 0</translation>\s*<extents>[^<]*</extents>', sphere, segment.read_text(), count=1)
        segment.write_text(text)
        self.assertRegex(self.refused_for("wave/uniform.simulation.xml", "--engine", "reduced"),
                         "found link '4Seg' with a sphere, expected what the reduced engine has: .*--engine ode")


unittest.main()

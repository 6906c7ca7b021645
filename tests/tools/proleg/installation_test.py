#!/usr/bin/env python3
"""What `cmake --install` makes runs from its prefix, wherever that is, with the data that it has there.

Usage: installation_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from urllib.request import urlopen
from xml.etree import ElementTree

sys.dont_write_bytecode = True  # the folder of the tests may be read-only

sys.path[:0] = [str(Path(__file__).resolve().parents[2] / part) for part in ("host/server", "tools/proleg/ui", "support")]
from search_program import experiment  # noqa: E402
from waiting import wait_until  # noqa: E402
from web_client import Viewer, request, status  # noqa: E402

LONGEST = 300  # s
LARGEST = 60e6  # bytes
# What is in other Debian packages than proleg: proleg-dev, python3-proleg, proleg-mpi.
OF_OTHER_PACKAGES = ("src/", "include/", "share/cmake/", "lib/python3/", "share/doc/python3-proleg/", "lib/proleg/bin/proleg-optimise-mpi")


class Installation(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp())
        built = cls.folder / "a stage"
        cls.prefix = cls.folder / "a place for Proleg"
        result = subprocess.run(["cmake", "--install", PROGRAMS.parent, "--strip", "--prefix", built], capture_output=True, text=True)
        assert result.returncode == 0, result.stdout + result.stderr
        built.rename(cls.prefix)
        cls.work = cls.folder / "work"
        cls.work.mkdir()

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def proleg(self, *words, status=0):
        # Neither a home nor a checkout is needed.
        result = subprocess.run([self.prefix / "bin/proleg", *words], capture_output=True, text=True, timeout=LONGEST,
                                cwd=self.work, env={**os.environ, "HOME": "/nonexistent"})
        self.assertEqual(result.returncode, status, result.stdout + result.stderr)
        return result

    def test_a_user_has_one_program_and_all_its_subcommands(self):
        self.assertEqual([file.name for file in (self.prefix / "bin").iterdir()], ["proleg"])
        names = re.findall(r"^  (\w+) ", self.proleg("--help").stdout, re.MULTILINE)
        self.assertGreater(len(names), 30)
        for name in names:
            self.assertIn(f"proleg {name}", self.proleg(name, "--help").stdout)
            self.assertTrue((self.prefix / "share/man/man1" / f"proleg-{name}.1").exists(), name)
        self.assertTrue((self.prefix / "share/bash-completion/completions/proleg").exists())

    def test_it_has_at_most_60_mb(self):
        sizes = {}
        for file in self.prefix.rglob("*"):
            is_of_proleg = not str(file.relative_to(self.prefix)).startswith(OF_OTHER_PACKAGES)
            if file.is_file() and not file.is_symlink() and is_of_proleg:
                part = "/".join(file.relative_to(self.prefix).parts[:3])
                sizes[part] = sizes.get(part, 0) + file.stat().st_size
        for part, size in sorted(sizes.items(), key=lambda item: -item[1]):
            print(f"{size / 1e6:6.1f} MB  {part}")
        print(f"{sum(sizes.values()) / 1e6:6.1f} MB  in all", flush=True)
        self.assertLessEqual(sum(sizes.values()), LARGEST)

    def test_the_shipped_scenarios_are_those_of_the_installation_and_have_names(self):
        shipped = json.loads(self.proleg("scenarios", "--json").stdout)["scenarios"]
        files = {Path(scenario["file"]) for scenario in shipped}
        self.assertEqual(files, set((self.prefix / "share/proleg/scenarios").rglob("*.simulation.xml")))
        self.assertEqual(len({scenario["name"] for scenario in shipped}), len(files))
        listed = self.proleg("scenarios").stdout
        for scenario in shipped:
            self.assertRegex(listed, rf"(?m)^  {scenario['name']} ")
            self.proleg("objects", "--dbc", scenario["name"])

    def test_a_run_is_that_of_the_checkout_bit_for_bit(self):
        for name, file in {"caterpillar": "travelling_wave/uniform", "robots/snake/robot": "robots/snake/robot"}.items():
            here = json.loads(self.proleg("simulate", name, "--seconds", "2", "--json").stdout)
            there = json.loads(subprocess.run(
                [PROGRAMS / "proleg", "simulate", SOURCE / f"sim/scenarios/{file}.simulation.xml", "--seconds", "2",
                 "--json"], capture_output=True, text=True, check=True).stdout)
            for result in (here, there):
                del result["scenario"], result["real_time_factor"]
            self.assertEqual(here, there)

    def test_a_word_that_is_no_scenario_is_named_with_what_it_may_mean(self):
        error = self.proleg("simulate", "caterpilar", status=2).stderr
        self.assertIn("'caterpilar'", error)
        self.assertIn("'proleg scenarios'", error)
        self.assertIn("did you mean caterpillar?", error)
        self.assertNotIn("proleg scenarios", self.proleg("simulate", "./caterpilar", status=2).stderr)

    def test_a_file_of_the_user_comes_before_a_shipped_one(self):
        (self.work / "snake").write_text("no scenario")
        self.assertIn("snake", self.proleg("simulate", "snake", status=2).stderr)
        (self.work / "snake").unlink()
        self.proleg("simulate", "snake", "--seconds", "0.1")

    def test_virtual_chips_run_the_installed_image(self):
        result = json.loads(self.proleg("hil", "caterpillar", "--modules", "1=mcu", "--seconds", "0.3", "--json").stdout)
        self.assertEqual(result["differences"], 0)

    def test_a_recording_becomes_a_page(self):
        self.proleg("simulate", "caterpillar", "--seconds", "0.5", "--record", "run.proleg")
        self.proleg("export", "run.proleg", "--html")
        self.assertIn("<html", (self.work / "run.html").read_text())

    def test_the_page_is_the_installed_one(self):
        with subprocess.Popen([self.prefix / "bin/proleg", "ui", "caterpillar", "--paused", "--no-browser", "--recordings",
                               self.work], stdout=subprocess.PIPE, text=True, cwd=self.work) as program:
            address = re.search(r"http://\S+", program.stdout.readline()).group().split("#")[0]
            with urlopen(address, timeout=LONGEST) as answer:
                self.assertEqual(answer.read(), (self.prefix / "share/proleg/page/index.html").read_bytes())
            program.send_signal(signal.SIGINT)
            self.assertEqual(program.wait(LONGEST), 0)

    def serve(self, prefix, *words):
        """`proleg ui` of a prefix: the process and a viewer. It keeps its state in the folder of the test."""
        process = subprocess.Popen([prefix / "bin/proleg", "ui", *words, "--paused", "--no-browser", "--recordings", self.work],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=self.work,
                                   env={**os.environ, "XDG_STATE_HOME": str(self.folder / "state")})
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        port, token = re.search(r":(\d+)/#(\S+)", process.stdout.readline()).groups()
        viewer = Viewer(int(port), token)
        self.addCleanup(viewer.sock.close)
        return process, viewer, int(port)

    def end(self, process):
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(LONGEST), 0)
        return process.stderr.read()

    def own_copy(self, name):
        copy = self.folder / name
        shutil.copytree(self.prefix, copy, symlinks=True)
        self.addCleanup(shutil.rmtree, copy)
        return copy

    def test_an_update_under_a_running_page_is_said_and_nothing_is_lost(self):
        prefix = self.own_copy("updated")
        shutil.copytree(prefix / "share/proleg/scenarios/travelling_wave", self.work / "mine")
        process, viewer, port = self.serve(prefix, "mine/uniform.simulation.xml")
        epoch = viewer.take_control()
        viewer.until(lambda: viewer.documents.get("draft", {}).get("value") and "program" in viewer.documents)
        self.assertFalse(viewer.documents["program"]["value"]["is_replaced"])
        paths = ["/", "/app.js", "/style.css"]
        before = [request(port, path=path) for path in paths]

        def must(name, /, **arguments):
            result = viewer.do(name, epoch, **arguments)
            self.assertTrue(result["ok"], result)
            return result["value"]

        def search(name):
            must("search.refresh")
            viewer.until(lambda: "searches" in viewer.documents)
            return next(one for one in viewer.documents["searches"]["value"]["searches"] if one["name"] == name)

        must("search.start", name="during", experiment=experiment(evaluations="100000"), workers=1)
        while search("searches/during")["made"] == 0:
            pass
        shutil.rmtree(prefix)
        shutil.copytree(self.prefix, prefix, symlinks=True)
        (prefix / "share/proleg/page/index.html").write_text("another version")
        shutil.rmtree(prefix / "share/proleg/scenarios/robots")
        shutil.rmtree(prefix / "share/proleg/images")

        viewer.until(lambda: viewer.documents["program"]["value"]["is_replaced"])
        self.assertEqual([request(port, path=path) for path in paths], before, "never half of each")
        made = search("searches/during")["made"]
        while search("searches/during")["made"] <= made:
            pass
        must("gallery.look")
        must("search.stop", name="searches/during")
        wait_until(lambda: (self.work / "searches/during/best.simulation.xml").exists(), "the best gait of the search")
        wait_until(lambda: search("searches/during")["state"] == "interrupted", "the end of the search")
        errors = self.end(process)
        self.assertRegex(errors, r"\Aproleg ui: warning: its files were replaced or removed.*\n\Z")
        shutil.rmtree(self.work / "mine")
        shutil.rmtree(self.work / "searches")

    def test_two_versions_run_at_the_same_time(self):
        other = self.own_copy("other version")
        (other / "share/proleg/page/index.html").write_text("other version")
        shutil.copytree(self.prefix / "share/proleg/scenarios/travelling_wave", self.work / "two")
        one, other = self.serve(self.prefix, "two/uniform.simulation.xml"), self.serve(other, "two/coupled.simulation.xml")
        self.assertNotEqual(one[2], other[2])
        self.assertEqual(request(one[2])[2], (self.prefix / "share/proleg/page/index.html").read_bytes())
        self.assertEqual(request(other[2])[2], b"other version")
        for process, *_ in (one, other):
            self.assertEqual(self.end(process), "")
        recent = json.loads((self.folder / "state/proleg/recent.json").read_text())["paths"]
        self.assertEqual(sorted(recent)[-2:], [str(self.work / "two" / f"{name}.simulation.xml") for name in ("coupled", "uniform")])
        shutil.rmtree(self.work / "two")

    def test_the_page_has_the_documentation_that_is_installed(self):
        site = self.prefix / "share/doc/proleg/html"
        was_made = site.exists()
        if not was_made:
            site.mkdir()
            (site / "index.html").write_text("the documentation")
        (site / "link.html").symlink_to("/etc/passwd")
        process, viewer, port = self.serve(self.prefix, "caterpillar")
        viewer.until(lambda: "program" in viewer.documents)
        self.assertTrue(viewer.documents["program"]["value"]["has_documentation"])
        for path in ("/docs/", "/docs/index.html"):
            first, fields, content = request(port, path=path)
            self.assertEqual((first.split()[1], fields["content-type"], content),
                             ("200", "text/html; charset=utf-8", (site / "index.html").read_bytes()))
            self.assertIn("script-src 'self'", fields["content-security-policy"])
        for path in ("/docs/none.html", "/docs/link.html", "/docs/../page/index.html", "/docs/%2e%2e/copyright", "/docs//etc/passwd"):
            self.assertIn(status(port, path=path), (400, 404), path)
        if was_made:
            for file in site.rglob("*"):
                if file.is_file() and not file.is_symlink():
                    content = request(port, path=f"/docs/{file.relative_to(site)}")[2]
                    self.assertEqual(content, file.read_bytes(), file)
        self.end(process)
        (site / "link.html").unlink()
        away = site.with_name("away")
        site.rename(away)
        process, viewer, port = self.serve(self.prefix, "caterpillar")
        viewer.until(lambda: "program" in viewer.documents)
        self.assertFalse(viewer.documents["program"]["value"]["has_documentation"])
        self.assertEqual(status(port, path="/docs/index.html"), 404)
        self.end(process)
        if was_made:
            away.rename(site)
        else:
            shutil.rmtree(away)

    def test_the_menu_of_a_desktop_starts_the_page(self):
        entry = self.prefix / "share/applications/proleg.desktop"
        if shutil.which("desktop-file-validate"):
            result = subprocess.run(["desktop-file-validate", entry], capture_output=True, text=True)
            self.assertEqual((result.returncode, result.stdout), (0, ""))
        values = dict(line.split("=", 1) for line in entry.read_text().splitlines()[1:])
        program, command, *options = values["Exec"].split()
        self.assertTrue((self.prefix / "bin" / program).exists())
        self.assertEqual(values["Terminal"], "false")
        for option in options:
            self.assertIn(option, self.proleg(command, "--help").stdout)
        icon = ElementTree.parse(self.prefix / f"share/icons/hicolor/scalable/apps/{values['Icon']}.svg").getroot()
        self.assertEqual(icon.tag, "{http://www.w3.org/2000/svg}svg")

    def test_udev_finds_its_rules(self):
        rules = self.prefix / "lib/udev/rules.d/70-proleg.rules"
        self.assertEqual(rules.read_bytes(), (SOURCE / "host/udev/70-proleg.rules").read_bytes())

    def test_an_installation_without_its_page_says_so(self):
        page = self.prefix / "share/proleg/page"
        page.rename(page.with_name("away"))
        error = self.proleg("ui", "--no-browser", status=2).stderr
        page.with_name("away").rename(page)
        self.assertIn("found no page in", error)
        self.assertIn("install Proleg again", error)


if __name__ == "__main__":
    SOURCE, PROGRAMS = (Path(argument).resolve() for argument in sys.argv[1:3])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

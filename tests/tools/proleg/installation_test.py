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

LONGEST = 300  # s
LARGEST = 60e6  # bytes


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
            self.assertTrue((self.prefix / "lib/proleg/bin" / f"proleg-{name}").exists(), name)
            self.assertTrue((self.prefix / "share/man/man1" / f"proleg-{name}.1").exists(), name)
        self.assertTrue((self.prefix / "share/bash-completion/completions/proleg").exists())

    def test_it_has_at_most_60_mb(self):
        sizes = {}
        for file in self.prefix.rglob("*"):
            if file.is_file() and not file.is_symlink():
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

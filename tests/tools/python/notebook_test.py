"""What a notebook shows of a run and of a recording is what `proleg plot` and `proleg export --html` make of it.

    notebook_test.py PROGRAM_FOLDER
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path
from unittest import mock

import proleg
import proleg.player

PROGRAMS = Path(sys.argv.pop(1))
PLAYER = "<!doctype html>\n<!-- A recording of Proleg -->\n<body><!-- the recording --></body>\n"  # without scripts


def run_program(program, *words):
    subprocess.run([program, *words], check=True, capture_output=True, text=True)


class Attributes(HTMLParser):
    """The attributes of the only element of a kind."""

    def __init__(self, kind, text):
        super().__init__()
        self.kind, self.found = kind, []
        self.feed(text)
        (self.only,) = self.found

    def handle_starttag(self, tag, attributes):
        if tag == self.kind:
            self.found.append(dict(attributes))


class InAFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, "/")
        os.chdir(folder.name)
        # A program finds the player two folders above its own.
        Path("player").mkdir()
        Path("player/player.html").write_text(PLAYER)
        Path("host/bin").mkdir(parents=True)
        shutil.copy(PROGRAMS / "proleg-export", "host/bin")
        patch = mock.patch.object(proleg.player, "player_file", lambda: "player/player.html")
        patch.start()
        self.addCleanup(patch.stop)


class Shown(InAFolder):
    def test_of_a_run_is_that_of_the_command_line(self):
        run = proleg.simulate("caterpillar", 3, engine="reduced", losses="7:5%", record="uniform.proleg")
        run_program(PROGRAMS / "proleg-plot", "uniform.proleg")
        run_program("host/bin/proleg-export", "uniform.proleg", "--html")
        recording = proleg.open("uniform.proleg")
        for shown in (run, recording):
            with self.subTest(type(shown).__name__):
                self.assertEqual(shown._repr_svg_(), Path("uniform.svg").read_text())
                self.assertIn(shown._repr_svg_(), shown._repr_html_())
                self.assertEqual(shown.player().html, Path("uniform.html").read_text())

    def test_of_a_player_is_its_page_in_a_frame(self):
        player = proleg.simulate("caterpillar", 1, engine="reduced").player(height=300)
        frame = Attributes("iframe", player._repr_html_()).only
        self.assertEqual(frame["srcdoc"], player.html)
        self.assertIn("height: 300px", frame["style"])

    def test_is_bounded(self):
        player = proleg.Player("x" * (proleg.player.MAX_IN_NOTEBOOK + 1))
        self.assertLess(len(player._repr_html_()), 1000)
        self.assertIn("save", player._repr_html_())

    def test_of_names_is_text(self):
        folder = Path("<b>&quot;\"")
        folder.mkdir()
        file = proleg.Scenario("caterpillar").save(folder / "a.simulation.xml")
        shown = proleg.simulate(file, 1, engine="reduced")._repr_html_()
        self.assertNotIn("<b>", shown)
        self.assertIn("&lt;b&gt;&amp;quot;&quot;", shown)

    def test_of_a_run_without_a_picture_is_its_figures(self):
        run = proleg.simulate("caterpillar", 0.01, engine="reduced")
        self.assertIsNone(run._repr_svg_())
        self.assertIn(run.setpoint_hash, run._repr_html_())

    def test_is_a_picture_for_what_shows_no_html(self):
        """rsvg-convert, or what has its name, gets the picture."""
        run = proleg.simulate("caterpillar", 1, engine="reduced")
        Path("bin").mkdir()
        program = Path("bin/rsvg-convert")
        program.write_text("#!/bin/sh\nprintf PNG; cat\n")
        program.chmod(0o755)
        with mock.patch.dict(os.environ, {"PATH": f"{Path('bin').absolute()}:{os.environ['PATH']}"}):
            self.assertEqual(run._repr_png_(), b"PNG" + run._repr_svg_().encode())
        with mock.patch.dict(os.environ, {"PATH": "/nowhere"}):
            self.assertIsNone(run._repr_png_())


class AFile(InAFolder):
    def test_replaces_a_page_and_nothing_else(self):
        player = proleg.simulate("caterpillar", 1, engine="reduced").player()
        for _ in range(2):
            self.assertEqual(Path(player.save("run.html")).read_text(), player.html)
        Path("thesis.html").write_text("my only copy")
        with self.assertRaisesRegex(proleg.InputError, "thesis.html"):
            player.save("thesis.html")
        self.assertEqual(Path("thesis.html").read_text(), "my only copy")
        with self.assertRaisesRegex(proleg.FileError, "nowhere"):
            player.save("nowhere/run.html")


class WhatCannotBeShown(InAFolder):
    def test_is_a_player_that_was_not_built(self):
        with mock.patch.object(proleg.player, "player_file", lambda: None), self.assertRaisesRegex(proleg.InputError, "tools/page"):
            proleg.simulate("caterpillar", 1, engine="reduced").player()
        Path("player/player.html").write_text("<!doctype html>")
        with self.assertRaisesRegex(proleg.InputError, "player/player.html"):
            proleg.simulate("caterpillar", 1, engine="reduced").player()

    def test_is_a_run_that_cannot_be_repeated(self):
        losses = Path("losses.txt")
        losses.write_text("5 J2 J1\n")
        run = proleg.simulate("coupled", 1, engine="reduced", losses=losses.name)
        run.player()
        losses.write_text("50 J2 J1\n")
        with self.assertRaisesRegex(proleg.RunError, "another motion"):
            run.player()
        losses.unlink()
        with self.assertRaises(proleg.InputError):
            run.player()

    def test_leaves_no_file(self):
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(tempfile, "tempdir", folder):
            proleg.simulate("caterpillar", 1, engine="reduced")._repr_html_()
            self.assertEqual(os.listdir(folder), [])


if __name__ == "__main__":
    unittest.main()

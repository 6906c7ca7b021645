"""The film of README.md: the first thing that a reader sees moves, without an end and without haste, and is small.

usage: film_test.py SOURCE_FOLDER
"""

import re
import struct
import sys
import unittest
from pathlib import Path

SOURCE = Path(sys.argv.pop(1)).resolve()
LARGEST = 1_500_000  # bytes
FEWEST_S = 1
LONGEST_S = 10


def chunks(data):
    """Of a RIFF file (https://developers.google.com/speed/webp/docs/riff_container): name and contents."""
    at = 0
    while at < len(data):
        name, size = struct.unpack_from("<4sI", data, at)
        yield name.decode(), data[at + 8:at + 8 + size]
        at += 8 + size + size % 2


def number(data):
    return int.from_bytes(data, "little")


class Film(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        pictures = re.findall(r"!\[([^\]]*)\]\(([^)]*)\)|<img ", (SOURCE / "README.md").read_text())
        cls.words, name = pictures[0]
        cls.file = SOURCE / name
        cls.data = cls.file.read_bytes()

    def test_is_in_docs_and_small(self):
        self.assertEqual(self.file.parent, SOURCE / "docs")
        self.assertLessEqual(len(self.data), LARGEST)

    def test_says_in_words_what_it_shows(self):
        self.assertGreater(len(self.words.split()), 5)

    def test_is_an_animation_of_some_seconds_that_begins_again(self):
        self.assertEqual((self.data[:4], self.data[8:12]), (b"RIFF", b"WEBP"))
        parts = list(chunks(self.data[12:]))
        loops = [number(part[4:6]) for name, part in parts if name == "ANIM"]
        self.assertEqual(loops, [0], "0: without an end")
        pauses = [number(part[12:15]) for name, part in parts if name == "ANMF"]  # ms
        self.assertGreater(len(pauses), 1)
        self.assertGreaterEqual(min(pauses), 20, "browsers show shorter ones for longer")
        self.assertTrue(FEWEST_S <= sum(pauses) / 1000 <= LONGEST_S, sum(pauses))


if __name__ == "__main__":
    unittest.main()

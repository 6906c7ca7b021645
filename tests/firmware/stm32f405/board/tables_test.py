"""The reader of the board's tables: bad input is one line with file, line, what was found and what was expected, and exit status 2."""

import re
import sys
import unittest

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
from board_tables import FOLDER, NAMES, Copy, run, seeded  # noqa: E402

import tables  # noqa: E402

LINE = re.compile(r"^\S+\.tsv(:\d+)?: found .+, expected .+$")


class BadInput(unittest.TestCase):
    def setUp(self):
        self.copy = Copy(self)

    def path(self, name):
        return self.copy.folder / name

    def expect(self, name, text, line=None):
        with self.assertRaises(tables.TableError) as caught:
            tables.read_board(self.copy.folder)
        message = str(caught.exception)
        self.assertRegex(message, LINE)
        self.assertTrue(message.startswith(str(self.path(name))), message)
        self.assertIn(text, message)
        if line:
            self.assertIn(f"{name}:{line}:", message)

    def number_of(self, name, start):
        return next(number for number, line in enumerate(self.copy.lines(name), 1) if line.startswith(start))

    def test_the_program_prints_one_line_and_exits_with_2(self):
        self.path("nets.tsv").write_bytes(b"")
        result = run("check", folder=self.copy.folder)
        self.assertEqual(result.returncode, 2)
        self.assertEqual(result.stdout, "")
        self.assertEqual(result.stderr, f"{self.path('nets.tsv')}: found no row, expected the columns net, volts, what\n")

    def test_each_command_rejects_bad_tables(self):
        self.path("parts.tsv").unlink()
        for command in (["check"], ["docs", "--check"], ["schematic", self.copy.folder / "a.kicad_sch"]):
            result = run(*command, folder=self.copy.folder)
            self.assertEqual((result.returncode, result.stderr.count("\n")), (2, 1), result.stderr)

    def test_missing_file(self):
        for name in NAMES:
            with self.subTest(name=name):
                self.setUp()
                self.path(name).unlink()
                self.expect(name, "no readable file")

    def test_empty_file_and_file_without_rows(self):
        for name in NAMES:
            with self.subTest(name=name):
                self.setUp()
                self.path(name).write_bytes(b"")
                self.expect(name, "no row")
                self.path(name).write_text("\t".join(tables.COLUMNS[name]) + "\n")
                self.expect(name, "no row below the columns")

    def test_missing_column(self):
        for name in NAMES:
            for column in tables.COLUMNS[name]:
                with self.subTest(name=name, column=column):
                    self.setUp()
                    self.path(name).write_text("\t".join(other for other in tables.COLUMNS[name] if other != column) + "\n")
                    self.expect(name, f"no column {column}", 1)

    def test_columns_in_another_order(self):
        self.path("nets.tsv").write_text("volts\tnet\twhat\n")
        self.expect("nets.tsv", "the columns", 1)

    def test_missing_cell(self):
        self.copy.append("netlist.tsv", "R1", "3")
        self.expect("netlist.tsv", "2 cells", len(self.copy.lines("netlist.tsv")) - 1)

    def test_blanks(self):
        for cell in ("", " ", " GND", "GND ", "G  D"):
            with self.subTest(cell=cell):
                self.setUp()
                self.copy.append("nets.tsv", "NEW", "3.3", cell)
                self.expect("nets.tsv", "what", len(self.copy.lines("nets.tsv")) - 1)

    def test_blank_line(self):
        self.path("nets.tsv").write_text(self.path("nets.tsv").read_text() + "\n")
        self.expect("nets.tsv", "1 cells")

    def test_binary_garbage(self):
        line = self.number_of("parts.tsv", "R1\t")
        for garbage, text in ((b"\xff\xfe", "byte 0xff"), (b"\0", "U+0000"), (b"\x1b[31m", "U+001B"), ("\u202e".encode(), "U+202E"), (b"\r", "U+000D")):
            with self.subTest(garbage=garbage):
                self.setUp()
                self.path("parts.tsv").write_bytes(self.path("parts.tsv").read_bytes().replace(b"\nR1\t", b"\nR1" + garbage + b"\t"))
                self.expect("parts.tsv", text, line)

    def test_the_same_twice(self):
        for name, start, text in (("lqfp64.tsv", "19\t", "pin 19 a second time"), ("nets.tsv", "GND\t", "net GND a second time"),
                                  ("parts.tsv", "R1\t", "part R1 a second time"), ("netlist.tsv", "R1\t1\t", "pin R1.1 a second time")):
            with self.subTest(name=name):
                self.setUp()
                row = self.copy.lines(name)[self.number_of(name, start) - 1]
                self.copy.append(name, *row.split("\t"))
                self.expect(name, text, len(self.copy.lines(name)) - 1)

    def test_unknown_names(self):
        cases = (("netlist.tsv", {"part": "R1", "pin": "1"}, {"part": "R999"}, "part 'R999'"),
                 ("netlist.tsv", {"part": "R1", "pin": "1"}, {"net": "3v3"}, "net '3v3'"),
                 ("netlist.tsv", {"part": "R1", "pin": "1"}, {"type": "pasive"}, "type 'pasive'"),
                 ("netlist.tsv", {"part": "U1", "pin": "21"}, {"program": "soon"}, "program 'soon'"),
                 ("netlist.tsv", {"part": "R1", "pin": "1"}, {"pin": "0"}, "pin '0'"),
                 ("parts.tsv", {"part": "R1"}, {"block": "power"}, "block 'power'"),
                 ("parts.tsv", {"part": "R1"}, {"symbol": "inductor"}, "symbol 'inductor'"),
                 ("parts.tsv", {"part": "R1"}, {"answers": "B1,B15"}, "answers 'B15'"),
                 ("parts.tsv", {"part": "R1"}, {"footprint": "0603"}, "footprint '0603'"),
                 ("parts.tsv", {"part": "R1"}, {"near": "U1"}, "near 'U1'"),
                 ("parts.tsv", {"part": "R1"}, {"part": "R01"}, "part 'R01'"),
                 ("parts.tsv", {"part": "R1"}, {"volts": "50 V"}, "volts '50 V'"),
                 ("nets.tsv", {"net": "GND"}, {"volts": "-1"}, "volts '-1'"),
                 ("nets.tsv", {"net": "GND"}, {"volts": "nan"}, "volts 'nan'"),
                 ("lqfp64.tsv", {"pin": "21"}, {"structure": "TT"}, "structure 'TT'"),
                 ("lqfp64.tsv", {"pin": "21"}, {"functions": "GPIO TIM2_CH1=16"}, "function 'TIM2_CH1=16'"),
                 ("lqfp64.tsv", {"pin": "21"}, {"functions": "GPIO GPIO"}, "function GPIO a second time"))
        for name, where, cells, text in cases:
            with self.subTest(name=name, text=text):
                self.setUp()
                self.copy.set(name, where, **cells)
                self.expect(name, text)

    def test_random_damage_is_read_or_rejected_with_one_line(self):
        source = seeded(20261128)
        originals = {name: (FOLDER / name).read_bytes() for name in NAMES}
        rejected = 0
        for _ in range(400):
            name = source.choice(NAMES)
            data = bytearray(originals[name])
            for _ in range(source.randint(1, 4)):
                at = source.randrange(len(data))
                kind = source.randrange(5)
                if kind == 0:
                    data[at] = source.randrange(256)
                elif kind == 1:
                    del data[at:at + source.randint(1, 60)]
                elif kind == 2:
                    data[at:at] = source.choice((b"\t", b"\n", b" ", b"\0", b"-", bytes(source.randrange(256) for _ in range(8))))
                elif kind == 3:
                    other = source.randrange(len(data))
                    data[at:at] = data[other:other + source.randint(1, 200)]
                else:
                    del data[at:]
                data = data or bytearray(b"\n")
            self.path(name).write_bytes(data)
            try:
                tables.read_board(self.copy.folder)
            except tables.TableError as error:
                rejected += 1
                self.assertRegex(str(error), LINE)
                self.assertNotIn("\n", str(error))
            self.path(name).write_bytes(originals[name])
        self.assertGreater(rejected, 200)


if __name__ == "__main__":
    sys.exit(unittest.main())

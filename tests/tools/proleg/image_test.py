#!/usr/bin/env python3
"""'proleg image' against a reader of the header that is written after the table of docs/flashing.md, with the checksums of
zlib and hashlib.

Usage: image_test.py PROGRAM_FOLDER
"""

import contextlib
import hashlib
import json
import random
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

SEED = 5
HEADER_SIZE = 512
ADDRESS = 0x08020200
COMMIT = "0123456789abcdef0123456789abcdef01234567"
LONGEST = 300  # s; nothing here takes a second on an idle computer


def program(size, address=ADDRESS):
    """Bytes that begin with a vector table."""
    start = struct.pack("<4I", 0x20000800, address + 0x11, address + 0x21, address + 0x31)
    return (start + random.Random(SEED).randbytes(size))[:size]


def parse(image):
    """The fields of an image as 'proleg image info --json' names them."""
    (magic, form, size, board, lowest, highest, major, minor, patch, protocol, fingerprint, schema, flags, reserved,
     address, length, crc, commit, key, digest, signature) = struct.unpack_from("<4s3H2B4HI2BHIII20sI32s64s", image)
    header_crc, = struct.unpack_from("<I", image, 508)
    body = image[HEADER_SIZE:]
    assert (magic, form, size, reserved) == (b"PIMG", 1, HEADER_SIZE, 0)
    assert not any(image[166:168]) and not any(image[200:508])
    minimum = struct.unpack_from("<3H", image, 160)
    next_key = image[168:200]
    assert header_crc == zlib.crc32(image[:508])
    assert (length, crc, digest) == (len(body), zlib.crc32(body), hashlib.sha256(body).digest())
    return {
        "board": board, "lowest_revision": lowest, "highest_revision": highest, "version": f"{major}.{minor}.{patch}",
        "commit": commit.hex() if any(commit) else None, "changed_sources": flags == 1, "protocol": protocol,
        "core_fingerprint": fingerprint, "settings_schema": schema, "address": address, "length": length,
        "slot_percent": 100 * length / (90112 - HEADER_SIZE), "crc32": crc, "sha256": digest.hex(),
        "key_id": f"{key:08x}" if key else None,
        "minimum_version": "{}.{}.{}".format(*minimum) if any(minimum) else None,
        "next_key_id": key_id(next_key) if any(next_key) else None}


def key_id(public_key):
    return hashlib.sha256(public_key).hexdigest()[:8]


def changed(image, at, value):
    """Other bytes in a header whose CRC is right."""
    header = bytearray(image[:508])
    header[at:at + len(value)] = value
    return bytes(header) + struct.pack("<I", zlib.crc32(header)) + image[HEADER_SIZE:]


class Image(unittest.TestCase):
    programs = None

    def setUp(self):
        stack = contextlib.ExitStack()
        self.addCleanup(stack.close)
        self.folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))

    def run_image(self, *words):
        return subprocess.run([self.programs / "proleg", "image", *words], cwd=self.folder, capture_output=True,
                              text=True, timeout=LONGEST)

    def write(self, name, content):
        (self.folder / name).write_bytes(content)
        return name

    def make(self, body="body.bin", output="module.pimg", **options):
        """An option that is None is left out."""
        values = {"board": "1", "address": hex(ADDRESS), "version": "1.20.300", "protocol": "0x0100",
                  "fingerprint": "87932128", "schema": "2", **options}
        words = [word for name, value in values.items() if value is not None for word in (f"--{name}", value)]
        return self.run_image("make", body, "--output", output, *words)

    def image(self, size=1000, **options):
        """The bytes of an image of module.pimg."""
        self.write("body.bin", program(size))
        result = self.make(**options)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        return (self.folder / "module.pimg").read_bytes()

    def expect_refused(self, result, message):
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertIn(message, result.stderr)

    def test_info_shows_what_another_reader_reads(self):
        for options in ({}, {"commit": COMMIT}, {"revisions": "2:5"}, {"revisions": "7:7"},
                        {"board": "65535", "version": "65535.0.65535", "protocol": "65535", "fingerprint": "0xFFFFFFFF",
                         "schema": "255", "revisions": "255:255"},
                        {"board": "0x1", "version": "0.0.0", "protocol": "0", "fingerprint": "00000000", "schema": "0"}):
            with self.subTest(**options):
                image = self.image(**options)
                self.assertEqual(image[HEADER_SIZE:], program(1000))
                result = self.run_image("info", "--json", "module.pimg")
                self.assertEqual((result.returncode, result.stderr), (0, ""))
                self.assertEqual(json.loads(result.stdout), {
                    "images": [{"file": "module.pimg", "intact": True, "error": None, **parse(image)}]})

    def test_make_writes_the_options(self):
        fields = parse(self.image(revisions="2:5", commit=COMMIT))
        self.assertEqual({name: fields[name] for name in fields if name not in ("crc32", "sha256", "slot_percent")}, {
            "board": 1, "lowest_revision": 2, "highest_revision": 5, "version": "1.20.300", "commit": COMMIT,
            "changed_sources": False, "protocol": 0x0100, "core_fingerprint": 0x87932128, "settings_schema": 2,
            "address": ADDRESS, "length": 1000, "key_id": None, "minimum_version": None,
            "next_key_id": None})
        result = self.run_image("make", "body.bin", "--output", "module.pimg", "--board", "1", "--address", "0x08020200",
                                "--version", "1.2.3", "--protocol", "256", "--fingerprint", "87932128", "--schema", "2",
                                "--commit", COMMIT, "--changed-sources")
        self.assertEqual((result.returncode, result.stdout), (0, "written  module.pimg, 1512 bytes\n"))
        self.assertTrue(parse((self.folder / "module.pimg").read_bytes())["changed_sources"])

    def test_a_body_is_filled_up_to_a_multiple_of_four(self):
        for size in range(100, 108):
            image = self.image(size)
            self.assertEqual(len(image) % 4, 0)
            self.assertEqual(image[HEADER_SIZE:], program(size) + b"\xFF" * (-size % 4))
            parse(image)

    def test_info_shows_a_table(self):
        image = self.image(52_460, revisions="2:5", commit=COMMIT)
        fields = parse(image)
        self.assertEqual(self.run_image("info", "module.pimg").stdout, f"""\
module.pimg
  board             1 (reference), hardware revisions 2 to 5
  version           1.20.300
  commit            {COMMIT}
  protocol version  1.0
  core fingerprint  0x87932128
  settings schema   2
  address           0x08020200
  length            52460 bytes, 58.5 % of the 89600 of a slot
  CRC-32            0x{fields["crc32"]:08X}
  SHA-256           {fields["sha256"]}
  signature         none
  body              intact
""")
        lines = {}
        for name, options in (("all", {}), ("one", {"revisions": "7:7"})):
            self.image(**options)
            lines[name] = self.run_image("info", "module.pimg").stdout
        self.assertIn("\n  board             1 (reference), all hardware revisions\n", lines["all"])
        self.assertIn("\n  commit            not known\n", lines["all"])
        self.assertIn("\n  board             1 (reference), hardware revision 7\n", lines["one"])
        # Bits that 'proleg image make' never writes, or only together with others.
        flagged = changed(image, 25, b"\x01")
        self.write("flagged.pimg", flagged)
        self.assertIn(f"\n  commit            {COMMIT} + changes\n", self.run_image("info", "flagged.pimg").stdout)
        signed = changed(image, 60, struct.pack("<I", 77) + image[64:96] + b"\x5A" * 64)
        self.write("signed.pimg", signed)
        self.assertIn("\n  signature         with key 0000004d, not checked: 'proleg image verify' does that\n",
                      self.run_image("info", "signed.pimg").stdout)

    def test_several_files_are_shown_one_after_the_other(self):
        image = self.image()
        self.write("again.pimg", image)
        self.write("cut.pimg", image[:-4])
        self.write("text.pimg", b"a remark\n")
        result = self.run_image("info", "module.pimg", "again.pimg")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        tables = result.stdout.split("\n\n")
        self.assertEqual([table.splitlines()[0] for table in tables], ["module.pimg", "again.pimg"])
        result = self.run_image("info", "text.pimg", "cut.pimg", "module.pimg")
        self.assertEqual(result.returncode, 2)
        self.assertEqual(result.stderr.splitlines(), [
            "proleg image info: text.pimg: found a file of an unknown format, expected an image (.pimg), which begins with "
            "PIMG",
            "proleg image info: cut.pimg: found 996 bytes behind the header, expected 1000, as the header says: the file is "
            "cut off"])
        tables = result.stdout.split("\n\n")
        self.assertEqual([table.splitlines()[0] for table in tables], ["cut.pimg", "module.pimg"])
        self.assertIn("\n  body              not intact", tables[0])
        result = self.run_image("info", "--json", "text.pimg", "cut.pimg", "module.pimg")
        self.assertEqual(result.returncode, 2)
        images = json.loads(result.stdout)["images"]
        self.assertEqual([(one["file"], one["intact"]) for one in images],
                         [("text.pimg", False), ("cut.pimg", False), ("module.pimg", True)])
        self.assertEqual(["proleg image info: " + one["error"] for one in images[:2]], result.stderr.splitlines())
        self.assertEqual(set(images[0]), {"file", "intact", "error"})
        self.assertEqual(images[1]["length"], 1000)

    def test_what_is_no_intact_image_is_refused(self):
        image = self.image()
        body = image[HEADER_SIZE:]
        for content, message in (
                (b"", "found an empty file"),
                (b"text", "found a file of an unknown format"),
                (image[:100], "found the first 100 bytes of an image"),
                (image[:HEADER_SIZE], "found 0 bytes behind the header, expected 1000"),
                (image + b"\n", "found 1001 bytes behind the header, expected 1000"),
                (image[:-1] + b"\0", "found a body with the CRC-32"),
                (image[:40] + b"\xAA" + image[41:], "found a header with the CRC-32"),
                (changed(image, 4, b"\x02"), "found an image of format 2"),
                (changed(image, 26, b"\x01"), "found a header with an impossible value"),
                (changed(image, 64, b"\0\0\0\0"), "found a body with another SHA-256"),
                (image + bytes(1 << 20), "found more than 1048576 bytes"),
                (b"\x7FELF" + bytes(3 << 20), "found an ELF file"),
                (b":020000040802F0\r\n", "found an Intel HEX file"),
                (b"S0030000FC\r\n", "found a file of S-records"),
                (body, "found a raw binary, which begins with a vector table")):
            with self.subTest(message=message):
                result = self.run_image("info", self.write("bad.pimg", content))
                self.expect_refused(result, f"proleg image info: bad.pimg: {message}")
                self.assertIn(", expected ", result.stderr)
        self.expect_refused(self.run_image("info", "."), "found a folder")
        self.expect_refused(self.run_image("info", "missing.pimg"), "found no file that can be read")
        self.expect_refused(self.run_image("info"), "found no FILE")

    def test_impossible_values_are_refused_and_nothing_is_written(self):
        self.write("body.bin", program(1000))
        for option, value in (
                ("board", "0"), ("board", "65536"), ("board", "-1"), ("board", "one"),
                ("address", "0"), ("address", "0x08020204"), ("address", "0x100000000"), ("address", "here"),
                ("version", "1.2"), ("version", "1.2.3.4"), ("version", "1.2.65536"), ("version", "1..3"),
                ("version", "v1.2.3"), ("version", "1.2.-3"),
                ("protocol", "65536"), ("protocol", "1.0"),
                ("fingerprint", "8793212"), ("fingerprint", "087932128"), ("fingerprint", "8793212g"),
                ("fingerprint", "0x"), ("schema", "256"), ("schema", "-1"),
                ("revisions", "5:2"), ("revisions", "0:256"), ("revisions", "3"), ("revisions", ":"), ("revisions", "1:2:3"),
                ("commit", COMMIT[1:]), ("commit", COMMIT + "0"), ("commit", "x" * 40), ("commit", "0" * 40),
                ("commit", "-1" * 20)):
            with self.subTest(option=option, value=value):
                result = self.run_image("make", "body.bin", "--output", "module.pimg", *[
                    f"--{name}={word}" for name, word in {
                        "board": "1", "address": hex(ADDRESS), "version": "1.2.3", "protocol": "1", "schema": "2",
                        "fingerprint": "87932128", option: value}.items()])
                self.expect_refused(result, f"--{option}: found '{value}', expected")
        for option in ("board", "address", "version", "protocol", "fingerprint", "schema"):
            self.expect_refused(self.make(**{option: None}), f"found no --{option}")
        self.expect_refused(self.run_image("make", "body.bin", "--output", "module.pimg", "--board", "1", "--address",
                                           hex(ADDRESS), "--version", "1.2.3", "--protocol", "1", "--schema", "2",
                                           "--fingerprint", "87932128", "--changed-sources"), "--changed-sources")
        self.assertEqual([path.name for path in self.folder.iterdir()], ["body.bin"])

    def test_a_body_that_is_no_program_is_refused(self):
        image = self.image()
        (self.folder / "module.pimg").unlink()
        for content, message in (
                (b"", "found an empty file"),
                (image, "found an image, expected the raw binary of a program, without a header"),
                (b"\x7FELF" + bytes(100), "found an ELF file"),
                (b":020000040802F0\r\n", "found an Intel HEX file"),
                (b"S0030000FC\r\n", "found a file of S-records"),
                (b"\0\x08\0\x20", "found 4 bytes"),
                (program((1 << 20) - HEADER_SIZE + 1), "found more than 1048064 bytes"),
                (program(1000, ADDRESS + 0x60000), "found the reset vector 0x08080211"),
                (program(1000, ADDRESS - 1), "found the reset vector 0x08020210"),
                (program(1000, ADDRESS - 0x20), "found the reset vector 0x080201F1")):
            with self.subTest(message=message):
                self.write("bad.bin", content)
                self.expect_refused(self.make("bad.bin"), f"proleg image make: bad.bin: {message}")
        self.write("body.bin", program(1024, 0xFFFFFE00))
        self.expect_refused(self.make(address="0xFFFFFE00"), "--address: found 0xFFFFFE00, expected")
        self.expect_refused(self.make("."), "found a folder")
        self.expect_refused(self.make("missing.bin"), "found no file that can be read")
        self.assertEqual({path.name for path in self.folder.iterdir()}, {"bad.bin", "body.bin"})

    def test_an_image_replaces_an_image_and_nothing_else(self):
        first = self.image(version="1.0.0")
        self.assertNotEqual(self.image(version="2.0.0"), first)
        self.write("notes.txt", b"precious\n")
        self.expect_refused(self.make(output="notes.txt"), "found a file that is no image")
        self.assertEqual((self.folder / "notes.txt").read_bytes(), b"precious\n")
        self.expect_refused(self.make(output="body.bin"), "found a file that is no image")
        self.assertEqual((self.folder / "body.bin").read_bytes(), program(1000))
        self.expect_refused(self.make(output="."), "found a folder")
        self.expect_refused(self.make(output=""), "found an empty name")
        self.expect_refused(self.make(output="missing/module.pimg"), "--output")
        self.assertEqual({path.name for path in self.folder.iterdir()}, {"body.bin", "module.pimg", "notes.txt"})

    def test_words_that_are_no_action_are_refused(self):
        self.expect_refused(self.run_image(), "found no ACTION")
        self.expect_refused(self.run_image("inof", "module.pimg", "--json"),
                            "proleg image: ACTION: found 'inof', expected info, make, key, sign or verify")
        self.expect_refused(self.run_image("--json"), "found no ACTION")
        self.expect_refused(self.run_image("info", "x.pimg", "--jsno"), "did you mean --json?")
        for words in (("--help",), ("info", "--help"), ("make", "--help"), ("key", "--help"), ("sign", "--help"),
                      ("verify", "--help")):
            result = self.run_image(*words)
            self.assertEqual(result.returncode, 0)
            self.assertIn(" ".join(("Usage: proleg image", *words[:-1])), result.stdout)


if __name__ == "__main__":
    Image.programs = Path(sys.argv.pop()).resolve()
    unittest.main()

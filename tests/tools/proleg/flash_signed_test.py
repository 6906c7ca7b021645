#!/usr/bin/env python3
"""A user gives the modules of 'proleg bus' a key, and flashes images that are signed, or not, or with another key.

Usage: flash_signed_test.py SOURCE_FOLDER PROGRAM_FOLDER
"""

import json
import struct
import sys
import unittest
import zlib
from pathlib import Path

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
import flash_test
import robot_on_the_table_test as table
from robot_on_the_table_test import Bus, proleg

ALL = flash_test.ALL


class SignedFlash(unittest.TestCase):
    setUpClass = classmethod(flash_test.Flash.setUpClass.__func__)
    tearDownClass = classmethod(flash_test.Flash.tearDownClass.__func__)
    make_image = classmethod(flash_test.Flash.make_image.__func__)
    setUp = flash_test.Flash.setUp
    start = flash_test.Flash.start
    flash = flash_test.Flash.flash
    assert_all_run = flash_test.Flash.assert_all_run

    def key(self, name):
        """Makes a pair of keys; returns its id."""
        result = proleg("image", "key", Path(self.work.name) / f"{name}.pem")
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout.split()[-1]

    def public(self, name):
        return Path(self.work.name) / f"{name}.pub.pem"

    def sign(self, version, key, *options):
        signed = Path(self.work.name) / f"{version}_{key}.pimg"
        result = proleg("image", "sign", self.images[version], "--key", Path(self.work.name) / f"{key}.pem", "--output",
                        signed, *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return str(signed)

    def set_key(self, bus, name, status=0):
        result = proleg("flash", "--bus", bus, "--public-key", self.public(name))
        self.assertEqual(result.returncode, status, result.stderr + result.stdout)
        return result.stdout

    def keys(self, bus):
        """What 'proleg scan' says of each module."""
        return [node["images"] for node in json.loads(proleg("scan", "--bus", bus, "--json").stdout)["nodes"]]

    def reasons(self, report):
        """Why the modules refuse: one reason for all."""
        texts = {module["outcome"] or module["reason"] for module in report["modules"]}
        self.assertEqual(len(texts), 1, texts)
        return texts.pop()

    def test_modules_with_a_key_take_only_signed_images_and_all_programs_say_so(self):
        one, other = self.key("one"), self.key("other")
        with Bus() as bus:
            self.assertEqual(self.keys(bus.tcp), ["takes any image"] * len(ALL))
            self.assertIn("any image", proleg("doctor", "--bus", bus.tcp).stdout)
            self.assertIn("takes any image", proleg("info", "--bus", bus.tcp, "3").stdout)
            self.assert_all_run(self.flash(bus.tcp, "0.1.0"), "0.1.0")

            self.assertEqual(self.set_key(bus.tcp, "one").count(f"signed with key {one}"), len(ALL))
            self.assertEqual(self.keys(bus.tcp), [f"key {one}"] * len(ALL))
            self.assertIn(f"key {one}", proleg("doctor", "--bus", bus.tcp).stdout)
            self.assertIn(f"key {one}", proleg("info", "--bus", bus.tcp, "3").stdout)

            refused = self.reasons(self.flash(bus.tcp, "0.2.0", status=1))
            self.assertIn("the image is not signed", refused)
            refused = self.reasons(self.flash(bus.tcp, self.sign("0.2.0", "other"), status=1))
            self.assertIn(f"the image is signed with another key (id {other}, expected {one})", refused)
            # Only the module itself finds out that a signature is not valid.
            signed = Path(self.sign("0.2.0", "one"))
            forged = bytearray(signed.read_bytes())
            forged[100] ^= 1
            forged[508:512] = struct.pack("<I", zlib.crc32(forged[:508]))
            signed.write_bytes(forged)
            refused = self.reasons(self.flash(bus.tcp, str(signed), status=1))
            self.assertIn("its signature is not valid", refused)
            self.assert_all_run(self.flash(bus.tcp, self.sign("0.2.0", "one")), "0.2.0")

    def test_a_key_over_the_bus_is_only_the_first_one(self):
        one = self.key("one")
        self.key("other")
        with Bus() as bus:
            self.set_key(bus.tcp, "one")
            self.assertEqual(self.set_key(bus.tcp, "other", status=1).count(f"has the key {one} already"), len(ALL))
            self.assertEqual(self.set_key(bus.tcp, "one").count(f"signed with key {one}"), len(ALL), "it is there")
            self.assertEqual(self.keys(bus.tcp), [f"key {one}"] * len(ALL))

    def test_an_image_raises_the_lowest_version_and_exchanges_the_key(self):
        self.key("one")
        other = self.key("other")
        with Bus() as bus:
            self.set_key(bus.tcp, "one")
            self.assert_all_run(self.flash(bus.tcp, self.sign("0.2.0", "one", "--minimum-version", "0.2.0")), "0.2.0")
            refused = self.reasons(self.flash(bus.tcp, self.sign("0.1.0", "one"), "--allow-downgrade", status=1))
            self.assertIn("its version is below the lowest", refused)
            refused = self.reasons(self.flash(bus.tcp, self.sign("0.1.0", "one"), "--allow-downgrade", status=1))
            self.assertIn("takes no version below 0.2.0, the image is 0.1.0", refused)

            exchange = self.sign("0.3.0", "one", "--next-key", self.public("other"))
            self.assert_all_run(self.flash(bus.tcp, exchange), "0.3.0")
            refused = self.reasons(self.flash(bus.tcp, self.sign("0.2.0", "one"), "--allow-downgrade", status=1))
            self.assertIn("it is signed with another key than the module expects", refused)
            self.assertEqual(self.keys(bus.tcp), [f"key {other}"] * len(ALL))
            self.assert_all_run(self.flash(bus.tcp, self.sign("0.2.0", "other"), "--allow-downgrade"), "0.2.0")

    def test_a_key_and_a_signed_image_reach_all_modules_through_the_serial_line_of_a_gateway(self):
        one = self.key("one")
        with Bus("--gateway", "3=0") as bus:
            line = bus.find(r"--bus (\S+)$")
            self.assertEqual(self.set_key(line, "one").count(f"signed with key {one}"), len(ALL))
            self.assertEqual(self.keys(line), [f"key {one}"] * len(ALL))
            self.assertIn("the image is not signed", self.reasons(self.flash(line, "0.2.0", status=1)))
            self.assert_all_run(self.flash(line, self.sign("0.2.0", "one")), "0.2.0")


if __name__ == "__main__":
    table.PROGRAMS = Path(sys.argv.pop()).resolve()
    table.SOURCE = Path(sys.argv.pop()).resolve()
    unittest.main()

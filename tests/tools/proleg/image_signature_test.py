#!/usr/bin/env python3
"""Keys and signatures of 'proleg image' against the program openssl.

Usage: image_signature_test.py PROGRAM_FOLDER
"""

import json
import os
import struct
import subprocess
import sys
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # the folder of the tests may be read-only
import image_test
from image_test import HEADER_SIZE, changed, key_id, parse


def signed_bytes(image):
    """What docs/flashing.md says that a signature covers."""
    return image[:96] + bytes(64) + image[160:508]


class Signatures(unittest.TestCase):
    programs = None
    setUp = image_test.Image.setUp
    run_image = image_test.Image.run_image
    write = image_test.Image.write
    make = image_test.Image.make
    image = image_test.Image.image
    expect_refused = image_test.Image.expect_refused

    def openssl(self, *words):
        return subprocess.run(["openssl", *words], cwd=self.folder, capture_output=True, timeout=image_test.LONGEST)

    def key(self, name):
        """Makes a pair of keys; returns the 32 bytes of the public one."""
        result = self.run_image("key", f"{name}.pem")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        public = self.openssl("pkey", "-pubin", "-in", f"{name}.pub.pem", "-outform", "DER").stdout[-32:]
        self.assertIn(f"key id   {key_id(public)}", result.stdout)
        return public

    def sign(self, *options, key="one", output="signed.pimg"):
        result = self.run_image("sign", "module.pimg", "--key", f"{key}.pem", "--output", output, *options)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        return (self.folder / output).read_bytes()

    def test_openssl_reads_the_keys_and_finds_that_they_belong_together(self):
        public = self.key("one")
        self.assertEqual(os.stat(self.folder / "one.pem").st_mode & 0o777, 0o600)
        self.assertEqual(self.openssl("pkey", "-in", "one.pem", "-pubout", "-outform", "DER").stdout[-32:], public)

    def test_a_private_key_that_others_can_read_is_a_warning(self):
        self.key("one")
        self.image()
        self.sign()
        for mode in (0o640, 0o604, 0o666):
            (self.folder / "one.pem").chmod(mode)
            sign = self.run_image("sign", "module.pimg", "--key", "one.pem", "--output", "signed.pimg")
            make = self.make(key="one.pem")
            for result in (sign, make):
                self.assertEqual((result.returncode, result.stderr),
                                 (0, "proleg image: warning: one.pem: others can read the key: 'chmod 600' prevents it\n"), oct(mode))

    def test_a_private_key_is_not_replaced_without_force(self):
        first = self.key("one")
        private = (self.folder / "one.pem").read_bytes()
        self.expect_refused(self.run_image("key", "one.pem"), "one.pem: found a file that exists")
        self.assertEqual((self.folder / "one.pem").read_bytes(), private)
        self.assertEqual(self.run_image("key", "one.pem", "--force").returncode, 0)
        self.assertNotEqual((self.folder / "one.pem").read_bytes(), private)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["one.pem", "one.pub.pem"])
        self.write("other.pub.pem", b"text")
        self.expect_refused(self.run_image("key", "other.pem"), "other.pub.pem")
        self.assertFalse((self.folder / "other.pem").exists())
        self.assertNotEqual(first, bytes(32))

    def test_openssl_verifies_the_signature_of_an_image(self):
        public = self.key("one")
        plain = self.image()
        for image in (self.sign(), self.sign("--minimum-version", "1.20.0")):
            fields = parse(image)
            self.assertEqual(fields["key_id"], key_id(public))
            self.assertEqual(image[HEADER_SIZE:], plain[HEADER_SIZE:])
            self.write("message", signed_bytes(image))
            self.write("signature", image[96:160])
            result = self.openssl("pkeyutl", "-verify", "-pubin", "-inkey", "one.pub.pem", "-rawin", "-in", "message",
                                  "-sigfile", "signature")
            self.assertEqual(result.returncode, 0, result.stderr)
        result = self.run_image("make", "body.bin", "--output", "made.pimg", "--board", "1", "--address", "0x08020200",
                                "--version", "1.20.300", "--protocol", "256", "--fingerprint", "87932128", "--schema",
                                "2", "--key", "one.pem")
        self.assertEqual(result.stdout, f"written  made.pimg, 1512 bytes, signed with key {key_id(public)}\n")
        self.assertEqual((self.folder / "made.pimg").read_bytes(), self.sign())  # Ed25519 has no random numbers

    def test_verify_takes_what_openssl_has_signed(self):
        self.openssl("genpkey", "-algorithm", "ed25519", "-out", "one.pem")
        self.openssl("pkey", "-in", "one.pem", "-pubout", "-out", "one.pub.pem")
        public = self.openssl("pkey", "-in", "one.pem", "-pubout", "-outform", "DER").stdout[-32:]
        image = changed(self.image(), 60, struct.pack("<I", int(key_id(public), 16)))
        self.write("message", signed_bytes(image))
        self.openssl("pkeyutl", "-sign", "-inkey", "one.pem", "-rawin", "-in", "message", "-out", "signature")
        self.write("signed.pimg", changed(image, 96, (self.folder / "signature").read_bytes()))
        result = self.run_image("verify", "signed.pimg", "--key", "one.pub.pem")
        self.assertEqual((result.returncode, result.stdout),
                         (0, f"signed.pimg: signed with key {key_id(public)}\n"))

    def test_verify_refuses_every_other_image(self):
        public, other = self.key("one"), self.key("other")
        self.image()
        image = self.sign()
        body = bytearray(image[HEADER_SIZE:])
        body[100] ^= 1
        header = bytearray(image[:HEADER_SIZE])
        for name, content, message in (
                ("module.pimg", None, "found no signature"),
                ("version.pimg", changed(image, 12, b"\x09"), "found a signature that is not valid"),
                ("cut.pimg", image[:-4], "found 996 bytes behind the header"),
                ("body.pimg", bytes(header) + bytes(body), "found a body with the CRC-32"),
                ("signature.pimg", changed(image, 100, b"\0\0\0\0"), "found a signature that is not valid")):
            with self.subTest(name):
                if content:
                    self.write(name, content)
                result = self.run_image("verify", name, "--key", "one.pub.pem")
                self.expect_refused(result, f"proleg image verify: {name}: {message}")
        self.expect_refused(self.run_image("verify", "signed.pimg", "--key", "other.pub.pem"),
                            f"found a signature with another key (id {key_id(public)}), expected one with key "
                            f"{key_id(other)}")

    def test_info_shows_key_lowest_version_and_next_key(self):
        public, other = self.key("one"), self.key("other")
        self.image()
        fields = parse(self.sign("--minimum-version", "1.20.300", "--next-key", "other.pub.pem"))
        self.assertEqual((fields["key_id"], fields["minimum_version"], fields["next_key_id"]),
                         (key_id(public), "1.20.300", key_id(other)))
        result = self.run_image("info", "--json", "signed.pimg")
        self.assertEqual(json.loads(result.stdout)["images"][0], {
            "file": "signed.pimg", "intact": True, "error": None, **fields})
        text = self.run_image("info", "signed.pimg").stdout
        self.assertIn(f"  signature         with key {key_id(public)}, ", text)
        self.assertIn("  minimum version   1.20.300, ", text)
        self.assertIn(f"  next key          {key_id(other)}, ", text)

    def test_what_is_no_key_is_refused(self):
        self.key("one")
        self.image()
        self.openssl("genpkey", "-algorithm", "ed448", "-out", "ed448.pem")
        self.openssl("pkey", "-in", "one.pem", "-aes256", "-passout", "pass:secret", "-out", "locked.pem")
        # The key of the neutral point fits signatures of anybody.
        small = bytes.fromhex("302a300506032b6570032100") + b"\x01" + bytes(31)
        self.write("small.der", small)
        self.openssl("pkey", "-pubin", "-inform", "DER", "-in", "small.der", "-out", "small.pem")
        for name, private, message in (
                ("missing.pem", True, "found no file"), ("module.pimg", True, "found no key in PEM"),
                ("one.pub.pem", True, "found a public key"), ("one.pem", False, "found a private key"),
                ("ed448.pem", True, "found a key of another kind"),
                ("locked.pem", True, "found a key that a passphrase protects"),
                ("small.pem", False, "found a key that fits signatures of anybody")):
            with self.subTest(name):
                words = ("sign", "--output", "x.pimg") if private else ("verify",)
                result = self.run_image(words[0], "module.pimg", *words[1:], "--key", name)
                self.expect_refused(result, f"{name}: {message}")

    def test_options_that_no_module_would_follow_are_refused(self):
        self.key("one")
        self.image()
        self.expect_refused(self.run_image("sign", "module.pimg", "--output", "x.pimg"), "found no --key")
        self.expect_refused(self.make(**{"minimum-version": "1.0.0"}), "--minimum-version: found it without --key")
        self.expect_refused(self.make(**{"next-key": "one.pub.pem"}), "--next-key: found it without --key")
        # No module would take the image itself after that.
        self.expect_refused(self.run_image("sign", "module.pimg", "--output", "x.pimg", "--key", "one.pem",
                                           "--minimum-version", "1.20.301"),
                            "--minimum-version: found 1.20.301, expected at most the version of the image, 1.20.300")
        self.assertFalse((self.folder / "x.pimg").exists())


if __name__ == "__main__":
    Signatures.programs = Path(sys.argv.pop()).resolve()
    unittest.main()

"""Starts host_counting_robot for the tests of this folder, and runs them: the functions of a test file whose names begin
with test_."""

import os
import ssl
import subprocess
import sys
import tempfile
from pathlib import Path

import web_client
from web_client import WAIT_S, Viewer

FILES = {"index.html": b"<!doctype html><title>page</title>", "app.js": b"'use strict';" + b" " * 300000, "icons/a.svg": b"<svg/>"}


class Server:
    def __init__(self, program, folder, certificate=None):
        # AddressSanitizer keeps freed memory for a while; the tests look at the memory in use.
        sanitizer = ":".join(filter(None, [os.environ.get("ASAN_OPTIONS"), "quarantine_size_mb=4"]))
        self.process = subprocess.Popen([program, folder, *([certificate] if certificate else [])], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                        text=True, env={**os.environ, "ASAN_OPTIONS": sanitizer})
        port, self.token, self.origin = self.process.stdout.readline().split()
        self.port = int(port)

    def viewer(self, name="viewer", **options):
        return Viewer(self.port, self.token, name, **options)

    def end(self):
        """Ends the server in an orderly way; returns what it wrote."""
        _, errors = self.process.communicate(timeout=WAIT_S)
        assert self.process.returncode == 0, errors
        return errors


def make_certificate(file, names="DNS:localhost,IP:127.0.0.1", days=1):
    """A certificate that signs itself, with its key in the same file."""
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", str(days),
                    "-subj", "/CN=test", "-addext", f"subjectAltName={names}", "-keyout", file, "-out", file],
                   check=True, capture_output=True)


def run_tests(tests, names=None):
    """Runs each test with a server of its own, which must end without an error. With the names of a certificate, or the word --tls
    on the command line, the connections are encrypted."""
    words = [word for word in sys.argv[1:] if word != "--tls"]
    with tempfile.TemporaryDirectory() as folder:
        for name, content in FILES.items():
            path = Path(folder, "page", name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        Path(folder, "secret.txt").write_text("not a file of the page")
        certificate = None
        if names or "--tls" in sys.argv:
            certificate = str(Path(folder, "page.pem"))
            make_certificate(certificate, names or "DNS:localhost")
            web_client.TLS = ssl.create_default_context(cafile=certificate)
            web_client.TLS.sslsocket_class = web_client.EncryptedSocket
        for name, test in tests.items():
            if not name.startswith("test_") or (len(words) > 1 and words[1] not in name):
                continue
            print(name, flush=True)
            server = Server(words[0], str(Path(folder, "page")), certificate)
            try:
                test(server)
                errors = server.end()
                assert errors == "ended\n", errors
            finally:
                server.process.kill()

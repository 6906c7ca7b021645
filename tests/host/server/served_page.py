"""Starts host_counting_robot for the tests of this folder, and runs them: the functions of a test file whose names begin
with test_."""

import subprocess
import sys
import tempfile
from pathlib import Path

from web_client import WAIT_S, Viewer

FILES = {"index.html": b"<!doctype html><title>page</title>", "app.js": b"'use strict';" + b" " * 300000, "icons/a.svg": b"<svg/>"}


class Server:
    def __init__(self, program, folder):
        self.process = subprocess.Popen([program, folder], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True)
        port, self.token = self.process.stdout.readline().split()
        self.port = int(port)

    def viewer(self, name="viewer", **options):
        return Viewer(self.port, self.token, name, **options)

    def end(self):
        """Ends the server in an orderly way; returns what it wrote."""
        _, errors = self.process.communicate(timeout=WAIT_S)
        assert self.process.returncode == 0, errors
        return errors


def run_tests(tests):
    """Runs each test with a server of its own, which must end without an error."""
    with tempfile.TemporaryDirectory() as folder:
        for name, content in FILES.items():
            path = Path(folder, "page", name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        Path(folder, "secret.txt").write_text("not a file of the page")
        for name, test in tests.items():
            if not name.startswith("test_") or (len(sys.argv) > 2 and sys.argv[2] not in name):
                continue
            print(name, flush=True)
            server = Server(sys.argv[1], str(Path(folder, "page")))
            try:
                test(server)
                errors = server.end()
                assert errors == "ended\n", errors
            finally:
                server.process.kill()

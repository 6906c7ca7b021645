"""`proleg ui` for tests that use its drafts as a page does. The folder of web_client.py is in sys.path."""

import re
import signal
import subprocess

from web_client import Viewer


class UiProgram:
    """`proleg ui` with the scenario of a folder, and a viewer that has control."""

    def __init__(self, programs, folder, options=("--paused",)):
        self.folder = folder
        page = folder / "page"
        page.mkdir(exist_ok=True)
        (page / "index.html").write_text("<!doctype html><title>page</title>")
        self.command = [programs / "proleg", "ui", folder / "uniform.simulation.xml", "--page", page, "--no-browser",
                        "--recordings", folder, *options]
        self.start()

    def start(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, text=True)
        self.port, self.token = re.search(r":(\d+)/#(\S+)", self.process.stdout.readline()).groups()
        self.viewer = None
        self.load_page()

    def load_page(self):
        if self.viewer is not None:
            self.viewer.sock.close()
        self.viewer = Viewer(int(self.port), self.token)
        self.epoch = self.viewer.take_control()
        self.viewer.until(lambda: self.viewer.documents.get("draft", {}).get("value") is not None)

    def end(self):
        self.process.send_signal(signal.SIGINT)
        assert self.process.wait() == 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()

    @property
    def draft(self):
        return self.viewer.documents["draft"]["value"]

    def ask(self, name, /, **arguments):
        if name.split(".")[0] in ("world", "robot", "behaviour"):
            arguments["layout"] = self.draft["layout"]
        result = self.viewer.do(name, self.epoch, **arguments)
        # An answer may come before the documents.
        if result["ok"] and isinstance(result.get("value"), dict) and "revision" in result["value"]:
            self.viewer.until(lambda: self.draft["revision"] >= result["value"]["revision"])
        return result

    def must(self, name, /, **arguments):
        result = self.ask(name, **arguments)
        assert result["ok"], (name, arguments, result)
        return result["value"]

"""Hashes by which a result of a check is known to be of the same inputs (tools/run_test, tools/tidy)."""

import hashlib
import json
import os
import re
import shutil
import subprocess
from pathlib import Path


class ContentHash:
    """SHA-256 of files. A file that has the same size, inode, modification time and change time as when it was read last
    is not read again: nothing but a clock that is set back can hide a change from that, since every write sets the change
    time. `memory`: the file that holds what was read."""

    def __init__(self, memory):
        self.memory = Path(memory)
        self.known = {}
        self.changed = False
        try:
            self.known = json.loads(self.memory.read_text())
        except (OSError, ValueError):
            pass

    def file(self, path):
        """Hash of the bytes of a file; 'missing' if it cannot be read."""
        path = os.path.realpath(path)
        try:
            status = os.stat(path)
            stamp = [status.st_size, status.st_ino, status.st_mtime_ns, status.st_ctime_ns]
            known = self.known.get(path)
            if known is None or known[0] != stamp:
                with open(path, "rb") as file:
                    known = [stamp, hashlib.sha256(file.read()).hexdigest()]
                self.known[path] = known
                self.changed = True
            return known[1]
        except OSError:
            return "missing"

    def tree(self, path, skip=r"$^"):
        """Hash of a file, or of the names and bytes of all files below a folder whose names do not match `skip`."""
        path = Path(path)
        if not path.is_dir():
            return self.file(path)
        digest = hashlib.sha256()
        for name in sorted(file for file in path.rglob("*") if file.is_file()):
            if not re.search(skip, name.name):
                digest.update(f"{name.relative_to(path)}\0{self.file(name)}\0".encode())
        return digest.hexdigest()

    def program(self, program):
        """Hash of a program and of the shared libraries that the loader gives it."""
        path = shutil.which(program) or program
        digest = hashlib.sha256(self.file(path).encode())
        listing = subprocess.run(["ldd", path], capture_output=True, text=True, check=False).stdout
        for library in sorted(set(re.findall(r"(/\S+) \(0x", listing))):
            digest.update(f"{library}\0{self.file(library)}\0".encode())
        return digest.hexdigest()

    def save(self):
        """Keeps what was read. Two that save at the same time: the later one wins, and the other reads again."""
        if self.changed:
            self.memory.parent.mkdir(parents=True, exist_ok=True)
            temporary = self.memory.with_suffix(f".{os.getpid()}")
            temporary.write_text(json.dumps(self.known))
            temporary.replace(self.memory)


def machine():
    """What a program can find out about the processor, as one string."""
    model = ""
    try:
        with open("/proc/cpuinfo", encoding="utf-8", errors="replace") as info:
            model = "".join(sorted({line for line in info if line.startswith(("model name", "flags"))}))
    except OSError:
        pass
    return os.uname().machine + model

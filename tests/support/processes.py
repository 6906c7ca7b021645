"""The processes of this computer, for tests that stop or count the programs that another one has started."""

import re
from pathlib import Path


def children(process):
    """The programs that another one has started and that have not ended, by process, with their arguments."""
    found = {}
    for status in Path("/proc").glob("[0-9]*/status"):
        try:
            text = status.read_text()
            if re.search(rf"\nPPid:\t{process}\n", text) and not re.search(r"\nState:\tZ", text):
                found[int(status.parent.name)] = (status.parent / "cmdline").read_text().split("\0")[:-1]
        except (FileNotFoundError, ProcessLookupError):
            continue
    return found


def folder_of(process):
    """The folder that a program runs in; nothing after it has ended."""
    try:
        return Path(f"/proc/{process}/cwd").readlink()
    except (FileNotFoundError, ProcessLookupError):
        return None


def runs(process):
    try:
        return not re.search(r"\nState:\t[ZX]", Path(f"/proc/{process}/status").read_text())
    except (FileNotFoundError, ProcessLookupError):
        return False

"""The commands of docs/user-algorithms.md as a user types them, and a user who can write in his home alone."""

import os
import re
import subprocess
from pathlib import Path

NOBODY = 65534
NAME = "steep_wave"


def commands_of(page):
    """Commands of the indented blocks, in their order; not what they print."""
    blocks = re.findall(r"(?:^    .*\n)+", page.read_text(), flags=re.MULTILINE)
    lines = re.sub(r"\\\n *", "", "".join(blocks).replace("\n    ", "\n").removeprefix("    ")).splitlines()
    return [line for line in lines if re.match(r"(?:proleg|cmake|ctest) ", line) and not re.match(r"proleg \w+:", line)]


def parts_of(commands):
    """Those that build and run the algorithm, and those that prove it and bring it into modules."""
    proof = next(i for i, command in enumerate(commands) if command.startswith("proleg verify"))
    return commands[:proof], commands[proof:]


def in_the_test(command):
    """What is other in a test than for a reader: the page would stay open, and fifty cases take long."""
    command = re.sub(r"^proleg ui\b.*", "proleg ui --help >/dev/null", command)
    return re.sub(r"^proleg verify .*", r"\g<0> --cases 2 --leave-out-missing", command)


class OrdinaryUser:
    """Runs commands in a home, with the programs of a prefix. If this process is root, they run as another user: root could
    write everywhere. root: the folder of another system, which then is theirs."""

    def __init__(self, home, prefix, root=None):
        self.home = home
        home.mkdir()
        seen = home if root is None else Path("/") / home.relative_to(root)
        self.environment = {"PATH": f"{prefix}/bin:{os.environ['PATH']}", "HOME": str(seen), "LC_ALL": "C.UTF-8"}
        self.words = ["bash", "-c"]
        if root is not None:
            self.words = ["chroot", f"--userspec={NOBODY}:{NOBODY}", "--groups=", root, "bash", "-c", f'cd "{seen}"; eval "$0"']
        self.identity = {}
        if os.geteuid() == 0:
            os.chown(home, NOBODY, NOBODY)
            if root is None:
                self.identity = {"user": NOBODY, "group": NOBODY, "extra_groups": []}

    def start(self, command, **options):
        """command: a line for a shell."""
        environment = {**self.environment, **options.pop("environment", {})}
        return subprocess.Popen([*self.words, command], cwd=self.home, env=environment, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **self.identity, **options)

    def run(self, command, timeout, **options):
        with self.start(command, **options) as process:
            output, errors = process.communicate(timeout=timeout)
            return subprocess.CompletedProcess(command, process.returncode, output, errors)


def hashes_below(folder):
    """What can tell that a folder was written: each file with its size and time."""
    return {str(path.relative_to(folder)): (path.lstat().st_size, path.lstat().st_mtime_ns) for path in Path(folder).rglob("*")}

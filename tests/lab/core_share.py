#!/usr/bin/python3
"""core_share.py FILE COMMAND...: runs a command and writes its time on a core, user and system, over its run time, in
percent, to FILE. The exit status is that of the command."""

import resource
import subprocess
import sys
import time

started = time.monotonic()
status = subprocess.run(sys.argv[2:], check=False).returncode
elapsed = time.monotonic() - started
used = resource.getrusage(resource.RUSAGE_CHILDREN)
with open(sys.argv[1], "w", encoding="ascii") as file:
    file.write(f"{100 * (used.ru_utime + used.ru_stime) / elapsed:.1f}\n")
sys.exit(status)

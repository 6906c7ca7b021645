"""Manual pages and completions of the commands, from their help texts: what belongs below the prefix of an installation.

usage: shell_files.py PROGRAM_FOLDER OUTPUT_FOLDER

Writes below OUTPUT_FOLDER share/man/man1/proleg*.1, share/bash-completion/completions/proleg,
share/zsh/vendor-completions/_proleg and share/fish/vendor_completions.d/proleg.fish. The same programs give the same bytes. The pages
have a date only if SOURCE_DATE_EPOCH (seconds) gives one.
"""

import os
import re
import subprocess
import sys
import time
from pathlib import Path

import bash_completion
import fish_completion
import man_pages
import zsh_completion
from help_texts import read_commands


def version_of(programs):
    """'Proleg 0.1.0': without the build, so that the pages change with the help texts only."""
    said = subprocess.run([programs / "proleg", "--version"], stdout=subprocess.PIPE, text=True, check=True, timeout=60).stdout
    number = re.match(r"proleg (\d+(?:\.\d+)*)", said)
    return f"Proleg {number.group(1)}" if number else "Proleg"


def files_of(commands, version, date):
    """The text of each file, by its path."""
    names = [command.words[0] for command in commands]
    files = {"share/man/man1/proleg.1": man_pages.page_of_all(commands, version, date)}
    for command in commands:
        files[f"share/man/man1/proleg-{command.words[0]}.1"] = man_pages.page_of_command(command, names, version, date)
    files["share/bash-completion/completions/proleg"] = bash_completion.script(commands)
    files["share/zsh/vendor-completions/_proleg"] = zsh_completion.script(commands)
    files["share/fish/vendor_completions.d/proleg.fish"] = fish_completion.script(commands)
    return files


def main(arguments):
    if arguments == ["--help"]:
        print(__doc__.strip())
        return 0
    if len(arguments) != 2:
        print(f"shell_files.py: found {len(arguments)} arguments, expected PROGRAM_FOLDER OUTPUT_FOLDER", file=sys.stderr)
        return 2
    programs, output = Path(arguments[0]).resolve(), Path(arguments[1])
    if not (programs / "proleg").is_file():
        print(f"shell_files.py: found no {programs / 'proleg'}, expected the programs", file=sys.stderr)
        return 2
    seconds = os.environ.get("SOURCE_DATE_EPOCH", "")
    if seconds and not re.fullmatch(r"\d{1,11}", seconds):
        print(f"shell_files.py: found SOURCE_DATE_EPOCH={seconds!r}, expected seconds since 1970", file=sys.stderr)
        return 2
    date = time.strftime("%Y-%m-%d", time.gmtime(int(seconds))) if seconds else ""
    for path, text in files_of(read_commands(programs), version_of(programs), date).items():
        (output / path).parent.mkdir(parents=True, exist_ok=True)
        (output / path).write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

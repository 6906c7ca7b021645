"""Where the package finds what ships with Proleg."""

from __future__ import annotations

from pathlib import Path


def shipped_folder() -> str | None:
    """The folder with the shipped scenarios; None if there is none.

    Beside the package (pip), below the prefix in which it is installed (a Debian package), or in the checkout in which it
    was built.
    """
    package = Path(__file__).absolute().parent
    for folder in (package, *package.parents):
        for below in ("scenarios" if folder == package else "share/proleg/scenarios", "sim/scenarios"):
            if (folder / below / "travelling_wave").is_dir():
                return str(folder / below)
    return None


def player_file() -> str | None:
    """The page that plays recordings: beside the package (pip), installed with the programs, or built by tools/page."""
    return _find("player/player.html", "share/proleg/player/player.html")


def bus_program() -> str | None:
    """The program `proleg-bus`, which simulates a robot of modules: installed, or of the build in which the package is."""
    return _find("lib/proleg/bin/proleg-bus", "bin/proleg-bus")


def _find(*places: str) -> str | None:
    """The first of some files that is in the folder of the package or in one above it."""
    package = Path(__file__).absolute().parent
    for folder in (package, *package.parents):
        for place in places:
            if (folder / place).is_file():
                return str(folder / place)
    return None

"""What a notebook shows of a run or a recording: the picture of `proleg plot`, and the player of `proleg export --html`."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from proleg import _core
from proleg._checks import path
from proleg._places import player_file

#: A player above this size, in characters, is not put into a notebook: save() it instead.
MAX_IN_NOTEBOOK = 20_000_000

_BEGIN = "<!doctype html>\n<!-- A recording of Proleg"  #: of every page


@dataclass(frozen=True)
class Player:
    """A page that plays a recording in a browser, in 3D, offline. A notebook shows it; save() makes a file of it."""

    html: str = field(repr=False)  #: the whole page, in one file
    height: int = 640  #: pixels in a notebook

    def save(self, file: str | os.PathLike[str]) -> str:
        """Writes the page, and returns its path. It replaces a page of a recording and no other file."""
        target = Path(path("file", file))
        try:
            if target.exists():
                with target.open(encoding="utf-8", errors="replace") as found:
                    if found.read(len(_BEGIN)) != _BEGIN:
                        raise _core.InputError(f"{target}: found another file, expected a new name, or a page of a recording")
            target.write_text(self.html, encoding="utf-8")
        except OSError as error:
            raise _core.FileError(f"{target}: {error.strerror}") from None
        return str(target)

    def _repr_html_(self) -> str:
        from html import escape

        if len(self.html) > MAX_IN_NOTEBOOK:
            return (f"<p>The page has {len(self.html) / 1e6:.0f} MB, too much for a notebook. <code>player.save('run.html')</code> "
                    "makes a file of it, for a browser.</p>")
        return (f'<iframe srcdoc="{escape(self.html)}" style="width: 100%; height: {self.height}px; border: 0" '
                'title="Player of a recording"></iframe>')


class Shown:
    """What a notebook shows of an object that has, or can make, a recording."""

    def _recording(self) -> AbstractContextManager[str]:
        """The path of a recording, for the time of a `with` block."""
        raise NotImplementedError

    def _facts(self) -> Mapping[str, str]:
        raise NotImplementedError

    def player(self, height: int = 640) -> Player:
        """The page that plays it in 3D, as `proleg export --html` writes it; a notebook shows it.

        height: pixels in a notebook. Raises InputError if the player was not built: in a checkout, tools/page builds it.
        """
        player = player_file()
        if player is None:
            raise _core.InputError("player: found no player/player.html beside the package, expected the one of the Debian package "
                                   "proleg, or one that tools/page has built in the checkout")
        from proleg import _notebook

        with self._recording() as recording:
            return Player(_notebook.page(recording, player), height)

    def picture(self) -> str:
        """The picture of `proleg plot`, as SVG: the robot in a stride, angles and contacts over time, and its path."""
        from proleg import _notebook

        with self._recording() as recording:
            return _notebook.picture(recording)

    def _repr_svg_(self) -> str | None:
        try:
            return self.picture()
        except _core.Error:
            return None  # too short for a picture

    def _repr_png_(self) -> bytes | None:
        """Only with the program rsvg-convert (Debian: librsvg2-bin); for what shows neither HTML nor SVG."""
        import shutil
        import subprocess

        program = shutil.which("rsvg-convert")
        svg = self._repr_svg_() if program else None
        if program is None or svg is None:
            return None
        made = subprocess.run([program, "--format", "png", "--zoom", "2"], input=svg.encode(), capture_output=True, check=False)
        return made.stdout if made.returncode == 0 else None

    def _repr_html_(self) -> str:
        from html import escape

        rows = "".join(f'<tr><th style="text-align: left">{escape(name)}</th><td style="text-align: left">{escape(value)}'
                       "</td></tr>" for name, value in self._facts().items())
        return f"<div><table>{rows}</table>{self._repr_svg_() or ''}</div>"


@contextmanager
def temporary_recording(name: str, write: Callable[[str], None]) -> Iterator[str]:
    """A recording that lasts as long as the block. name: its file's, which a page shows."""
    import tempfile

    with tempfile.TemporaryDirectory(prefix="proleg-") as folder:
        recording = str(Path(folder) / f"{name}.proleg")
        write(recording)
        yield recording

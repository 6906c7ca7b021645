"""Arguments of the right types, or an InputError that names what was found and what was expected."""

from __future__ import annotations

import numbers
import os
from collections.abc import Iterable

from proleg import _core


def _refuse(name: str, found: object, expected: str) -> _core.InputError:
    shown = repr(found)
    if len(shown) > 60:
        shown = shown[:57] + "..."
    return _core.InputError(f"{name}: found {shown} ({type(found).__name__}), expected {expected}")


def number(name: str, value: object) -> float:
    """A real number; a bool is none. What is not finite is refused where its range is known."""
    if isinstance(value, numbers.Real) and not isinstance(value, bool):
        try:
            return float(value)
        except OverflowError:
            pass
    if getattr(value, "ndim", None) == 0 and getattr(getattr(value, "dtype", None), "kind", "") in "iuf":
        return float(value)  # type: ignore[arg-type]
    raise _refuse(name, value, "a number")


def whole(name: str, value: object) -> int:
    if isinstance(value, numbers.Integral) and not isinstance(value, bool):
        return int(value)
    raise _refuse(name, value, "a whole number")


def text(name: str, value: object) -> str:
    if isinstance(value, str) and "\0" not in value:
        return value
    raise _refuse(name, value, "a text")


def texts(name: str, value: object) -> list[str]:
    """One text, or several."""
    if isinstance(value, str):
        return [text(name, value)]
    if isinstance(value, Iterable) and getattr(value, "ndim", 1) > 0:
        return [text(name, one) for one in value]
    raise _refuse(name, value, "texts")


def path(name: str, value: object) -> str:
    return text(name, os.fspath(value) if isinstance(value, os.PathLike) else value)

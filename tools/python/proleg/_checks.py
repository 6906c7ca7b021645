"""Arguments of the right types, or an InputError that names what was found and what was expected."""

from __future__ import annotations

import numbers
import os
from collections.abc import Iterable, KeysView, Set
from typing import NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from proleg import _core


def _refuse(name: str, found: object, expected: str) -> _core.InputError:
    shown = repr(found)
    if len(shown) > 60:
        shown = shown[:57] + "..."
    return _core.InputError(f"{name}: found {shown} ({type(found).__name__}), expected {expected}")


def number(name: str, value: object) -> float:
    """A real number; a bool is none. What is not finite is refused where its range is known."""
    if isinstance(value, numbers.Real) and not isinstance(value, (bool, np.timedelta64)):
        try:
            return float(value)
        except (OverflowError, TypeError, ValueError):
            pass
    if getattr(value, "ndim", None) == 0 and getattr(getattr(value, "dtype", None), "kind", "") in "iuf" and not _is_masked(value):
        return float(value)  # type: ignore[arg-type]
    raise _refuse(name, value, "a number")


def whole(name: str, value: object) -> int:
    if isinstance(value, numbers.Integral) and not isinstance(value, (bool, np.timedelta64)):
        return int(value)
    raise _refuse(name, value, "a whole number")


def array(name: str, given: ArrayLike, expected: str) -> NDArray[np.float64]:
    """Numbers of any shape. What has no number at a place is refused: a mask, an object, a date, a truth value."""
    if _is_masked(given):
        raise _core.InputError(f"{name}: found masked values, expected {expected}: without them, or .filled(nan) where nan is allowed")
    try:
        numbers_ = np.asarray(given)
    except (TypeError, ValueError):  # rows of different lengths
        raise _core.InputError(f"{name}: found rows of different lengths, expected {expected}") from None
    if numbers_.size == 0:
        return np.empty(numbers_.shape)
    if numbers_.dtype.kind not in "iuf":
        hint = "; of a pandas table: .to_numpy(float)" if hasattr(given, "to_numpy") else ""
        raise _core.InputError(f"{name}: found an array of shape {numbers_.shape} of {numbers_.dtype}, expected {expected}{hint}")
    with np.errstate(over="ignore"):  # infinity is refused where the range is known
        return np.asarray(numbers_, dtype=np.float64)


def _is_masked(given: object) -> bool:
    """Whether numpy would give the number below a mask, here or in a row."""
    if isinstance(given, np.ma.MaskedArray):
        return bool(np.ma.is_masked(given))
    return isinstance(given, (list, tuple)) and any(map(_is_masked, given))


def text(name: str, value: object) -> str:
    if isinstance(value, str) and "\0" not in value:
        try:
            value.encode()
            return value
        except UnicodeEncodeError:
            pass
    raise _refuse(name, value, "a text")


def texts(name: str, value: object) -> list[str]:
    """One text, or several."""
    if isinstance(value, str):
        return [text(name, value)]
    if isinstance(value, Iterable) and getattr(value, "ndim", 1) > 0:
        return [text(name, one) for one in value]
    raise _refuse(name, value, "texts")


def columns(name: str, value: object) -> list[str]:
    """Texts that name the columns of a table: in an order, each once."""
    if isinstance(value, Set) and not isinstance(value, KeysView):
        raise _core.InputError(f"{name}: found a {type(value).__name__}, expected texts in an order")
    names = texts(name, value)
    for one in names:
        if names.count(one) > 1:
            raise _core.InputError(f"{name}: found {one!r} twice, expected each name once")
    return names


class Unique:
    """What has threads, files or a world that a copy cannot have, here or in another process."""

    def __reduce_ex__(self, protocol: object) -> NoReturn:
        name = type(self).__name__
        raise TypeError(f"{name}: found a copy or a pickle of one, expected a new {name}(...) in the process that uses it")


def path(name: str, value: object) -> str:
    return text(name, os.fspath(value) if isinstance(value, os.PathLike) else value)

"""Conversions of number lists between bytes, `ctypes`, numpy and plain Python."""

from __future__ import annotations

from ctypes import POINTER, c_double, c_int, cast
from typing import Any

from .errors import DataError


def array_of(data: bytes, whole: bool) -> Any:
    """A `ctypes` array with a copy of these numbers."""
    number, size = (c_int, 4) if whole else (c_double, 8)
    return (number * (len(data) // size)).from_buffer_copy(data)


def pointer_to(data: bytes, cols: int) -> Any:
    """A pointer to a copy of these numbers, `p[i]` or `p[i][j]`."""
    row = c_double if cols == 1 else c_double * cols
    block = array_of(data, False)
    looks: Any = cast(block, POINTER(row))
    looks._block = block
    return looks


def as_bytes(data: Any, whole: bool, what: str) -> bytes:
    """The bytes of numbers given as a list, a `ctypes` or numpy array, or anything with a buffer.

    Numbers with fractions are refused as integers; integers are accepted as doubles.
    """
    number = c_int if whole else c_double
    try:
        looks: Any = memoryview(data)
    except TypeError:
        return _listed(data, number, what)
    kind = looks.format.lstrip("<>=@!")
    if kind == ("i" if whole else "d"):
        return looks.tobytes()
    if kind in ("b", "B", "h", "H", "i", "I", "l", "L", "q", "Q", "f", "d", "?"):
        if whole and kind in ("f", "d"):
            raise DataError(f"`{what}` are whole numbers, and these have fractions ({kind!r})")
        return _listed(memoryview(looks.tobytes()).cast(kind).tolist(), number, what)
    raise DataError(f"`{what}` are numbers, not a buffer of {looks.format!r}")


def _listed(data: Any, number: Any, what: str) -> bytes:
    try:
        flat = list(data)
        if any(hasattr(a, "__len__") and not isinstance(a, str) for a in flat):
            flat = [b for a in flat for b in a]
        if number is c_int:
            for a in flat:
                if not hasattr(a, "__index__"):
                    raise DataError(f"`{what}` are whole numbers, not {a!r}")
                if not -(2**31) <= int(a) < 2**31:
                    raise DataError(f"{a} of `{what}` does not fit into 32 bits")
        return bytes((number * len(flat))(*flat))
    except TypeError as e:
        raise DataError(f"`{what}` are numbers: {e}") from None

"""Arrays that are views of a scene's memory and raise an error once they are stale."""

from __future__ import annotations

from ctypes import POINTER, c_double, c_int, cast
from typing import Any

from .errors import StaleError


def pointer(memory: Any) -> Any:
    """A ``ctypes`` pointer into a column: ``p[i]`` or ``p[i][j]``. It keeps the memory alive; when stale it reads NaN."""
    number = c_int if memory.whole else c_double
    row = number if memory.width == 1 else number * memory.width
    looks: Any = cast(memory.address, POINTER(row))
    looks._memory = memory
    return looks


def view(memory: Any) -> Any:
    """A numpy array that is a view of a column."""
    import numpy

    looks = numpy.asarray(memory).view(_class())
    looks._memory = memory
    return looks


_made = None


def _class() -> Any:
    """The class of such arrays; created on first use, because nothing else needs numpy."""
    global _made
    if _made is None:
        _made = _make()
    return _made


def _make() -> Any:
    import numpy

    def fresh(array: Any) -> Any:
        """The array without its guard, if it is not stale."""
        memory = getattr(array, "_memory", None)
        if memory is not None and memory.stale is not None:
            raise StaleError(f"this array of `{memory.name}` is stale: {memory.stale}; extract it anew")
        return array.view(numpy.ndarray)

    def plain(value: Any) -> Any:
        if isinstance(value, View):
            return fresh(value)
        if isinstance(value, (tuple, list)):
            return type(value)(plain(v) for v in value)
        if isinstance(value, dict):
            return {k: plain(v) for k, v in value.items()}
        return value

    class View(numpy.ndarray):
        """A view of a scene's memory: later steps change its numbers, and changes of them take effect.

        It becomes stale when particles are added, deleted or reordered, or when the scene is closed: using it then raises
        ``StaleError``; code that bypasses this check reads NaN. ``copy()`` returns an independent array.
        """

        _memory: Any = None

        def __array_finalize__(self, parent: Any) -> None:
            # an array that owns its data is not a view
            self._memory = None if self.base is None else getattr(parent, "_memory", None)

        def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
            out = options.get("out")
            given = {k: plain(v) for k, v in options.items()}
            result = getattr(ufunc, method)(*plain(inputs), **given)
            if out is not None:
                return out[0] if len(out) == 1 else out
            return result

        def __array_function__(self, function: Any, types: Any, args: Any, options: Any) -> Any:
            return function(*plain(args), **plain(options))

        def __getitem__(self, key: Any) -> Any:
            fresh(self)
            return super().__getitem__(key)

        def __setitem__(self, key: Any, value: Any) -> None:
            fresh(self)
            super().__setitem__(key, plain(value))

        def __iter__(self) -> Any:
            fresh(self)
            return super().__iter__()

        def __repr__(self) -> str:
            return repr(fresh(self))

        def __str__(self) -> str:
            return str(fresh(self))

        def __reduce__(self) -> Any:
            return fresh(self).copy().__reduce__()

        @property
        def stale(self) -> bool:
            """Whether it is stale."""
            return self._memory is not None and self._memory.stale is not None

    def guarded(name: str) -> Any:
        def method(self: Any, *args: Any, **options: Any) -> Any:
            return getattr(fresh(self), name)(*args, **options)

        method.__name__ = name
        method.__doc__ = getattr(numpy.ndarray, name).__doc__
        return method

    for name in (
        "all any argmax argmin argsort astype byteswap choose clip compress copy cumprod cumsum diagonal dot dump dumps "
        "fill flatten item max mean min nonzero prod ptp put repeat round searchsorted sort std sum take tobytes tofile "
        "tolist trace var __copy__ __deepcopy__ __contains__ __float__ __int__ __bool__ __complex__"
    ).split():
        if hasattr(numpy.ndarray, name):
            setattr(View, name, guarded(name))
    return View

"""Functions that numba compiles once and keeps on disk; where nothing can be kept, anew in each process."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import cached_property
from inspect import getsource
from threading import Event
from types import ModuleType
from typing import Any
from zlib import crc32

OPTIONS: dict[str, Any] = {"nogil": True, "fastmath": {"contract"}, "error_model": "numpy"}


class Compiled:
    """A function that is compiled when it is first called: who does not call it does not wait for numba.

    Args:
        function: which raises nothing by itself.
        loose: whether sums may be taken in any order, which makes vectors of them.
        modules: beside its own, those of the functions that it calls: what is kept is out of date when one has changed.
    """

    broken = Event()  # the directory of what is compiled is of no use to this process

    def __init__(self, function: Callable[..., Any], *modules: ModuleType, loose: bool = False) -> None:
        self.function, self.modules = function, modules
        self.options: dict[str, Any] = OPTIONS | ({"fastmath": {"contract", "reassoc", "nsz"}} if loose else {})
        self.__doc__ = function.__doc__

    def __call__(self, *arguments: Any) -> Any:
        if not self.broken.is_set():
            try:
                return self._kept(*arguments)
            except Exception:  # what is kept is spoilt, or cannot be kept on a full disk: numba says it in many ways
                self.broken.set()
                with suppress(Exception):
                    self._kept._cache.flush()  # so that the next run keeps it again
        return self._own(*arguments)

    @cached_property
    def _kept(self) -> Any:
        from numba import njit

        try:
            made: Any = njit(cache=True, **self.options)(self.function)
        except RuntimeError:  # no directory to keep it in
            return self._own
        with suppress(AttributeError):  # numba itself looks at the function's own file only
            kept = made._cache._cache_file
            kept._source_stamp = (kept._source_stamp, *(crc32(getsource(module).encode()) for module in self.modules))
        return made

    @cached_property
    def _own(self) -> Any:
        from numba import njit

        return njit(**self.options)(self.function)

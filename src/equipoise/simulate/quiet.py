"""The engine's warnings are counted with its state; it would write them to a log file in the working folder as well.

The hook that keeps it from that belongs to the whole process. It is there only while an engine works, whoever else
works at the same time, and then the one before is back.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock
from typing import Any


class _Quiet:
    def __init__(self) -> None:
        self._lock, self._working, self._before = Lock(), 0, None

    @contextmanager
    def __call__(self, mujoco: Any) -> Iterator[None]:
        """No log file while this lasts."""
        with self._lock:
            if not self._working:
                self._before = mujoco.get_mju_user_warning()
                mujoco.set_mju_user_warning(lambda message: None)
            self._working += 1
        try:
            yield
        finally:
            with self._lock:
                self._working -= 1
                if not self._working:
                    mujoco.set_mju_user_warning(self._before)


quiet = _Quiet()

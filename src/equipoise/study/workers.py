"""Who works on a study: processes of this machine.

Each process of this machine is a pool of one, so that the death of one says which batch it had and takes no other
with it. They end with the program that started them, however that ends.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing import get_context, parent_process
from typing import Protocol

from ..model.errors import EquipoiseError
from .batch import Batch, Rows, rows

START = (
    "a worker process cannot be started: is there enough memory? A script calls `study` under if __name__ == '__main__'"
)
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""What tells numerical libraries how many threads to start; read when they are imported."""


class WorkerLost(Exception):
    """The process that worked on a batch has died."""


class Workers(Protocol):
    """Gives batches to workers."""

    @property
    def room(self) -> int:
        """How many batches may be on their way at a time; 0 while there is nobody to work on them."""
        ...

    def submit(self, batch: Batch) -> Future[Rows]:
        """Begin a batch."""
        ...

    def taken(self, future: Future[Rows]) -> Rows:
        """The rows of a batch that is done.

        Raises:
            WorkerLost: its worker died; EquipoiseError: there are no workers any more.
        """
        ...

    def close(self) -> None:
        """End at once what is still worked on."""
        ...


class Processes:
    """Processes of this machine, each with one numerical thread."""

    def __init__(self, plan: bytes, count: int) -> None:
        self.plan, self.count = plan, count
        self._free: list[tuple[ProcessPoolExecutor, int]] = []
        self._busy: dict[Future[Rows], tuple[ProcessPoolExecutor, int]] = {}

    @property
    def room(self) -> int:
        return self.count

    def submit(self, batch: Batch) -> Future[Rows]:
        worker = self._free.pop() if self._free else _started()
        try:
            future = worker[0].submit(rows, self.plan, batch)
        except BrokenProcessPool:  # it was killed while it had nothing to do
            worker = _started()
            future = worker[0].submit(rows, self.plan, batch)
        self._busy[future] = worker
        return future

    def taken(self, future: Future[Rows]) -> Rows:
        worker = self._busy.pop(future)
        try:
            found = future.result()
        except BrokenProcessPool:
            worker[0].shutdown(wait=False)
            raise WorkerLost from None
        self._free.append(worker)
        return found

    def close(self) -> None:
        for pool, number in (*self._free, *self._busy.values()):
            pool.shutdown(wait=False, cancel_futures=True)
            with suppress(ProcessLookupError):
                os.kill(number, signal.SIGTERM)
        self._free, self._busy = [], {}


def _started() -> tuple[ProcessPoolExecutor, int]:
    """A process and its number."""
    with _one_thread():
        pool = ProcessPoolExecutor(1, get_context("spawn"), _prepare)
        try:
            return pool, pool.submit(os.getpid).result()
        except BrokenProcessPool:
            raise EquipoiseError(START) from None


def _prepare() -> None:
    """In a worker: an interrupt is for the program that started it, whose end is its own."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextmanager
def _one_thread() -> Iterator[None]:
    """Processes that start meanwhile use one numerical thread each."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name, None) if value is None else os.environ.update({name: value})

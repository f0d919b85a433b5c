"""The workers of a Dask cluster that is there already."""

from __future__ import annotations

import time
from concurrent.futures import CancelledError, Future
from contextlib import suppress
from typing import Any

from ..model.errors import EquipoiseError, InputError
from .batch import Batch, Rows, rows
from .workers import WorkerLost

AHEAD = 2  # batches for each thread of a worker: one to work on, one that waits beside it
ASKED = 2.0  # [s] for so long the number of workers is believed
ANSWER = 10.0  # [s] within which a scheduler answers


class Cluster:
    """Gives batches to the workers of a scheduler; those that join or leave meanwhile are counted.

    Raises:
        InputError: the extra is missing, or no scheduler answers there.
    """

    def __init__(self, plan: bytes, address: str) -> None:
        try:
            from distributed import Client
        except ImportError:
            raise InputError("--scheduler needs Dask: pip install 'equipoise[study]'") from None
        self.plan, self.address = plan, address
        try:
            self._client = Client(address, timeout=ANSWER, set_as_default=False)
        except (OSError, ValueError) as error:
            raise InputError(f"no Dask scheduler answers at '{address}': {str(error).splitlines()[0]}") from None
        self._pool: Any = self._client.get_executor(pure=False)
        self._threads, self._asked = 0, 0.0

    @property
    def room(self) -> int:
        if time.monotonic() - self._asked > ASKED:
            try:
                threads: Any = self._client.nthreads()
            except (OSError, TimeoutError):
                raise self._gone() from None
            self._threads, self._asked = sum(threads.values()), time.monotonic()
        return AHEAD * self._threads

    def submit(self, batch: Batch) -> Future[Rows]:
        return self._pool.submit(rows, self.plan, batch)

    def taken(self, future: Future[Rows]) -> Rows:
        from distributed import KilledWorker

        try:
            return future.result()
        except KilledWorker:
            raise WorkerLost from None
        except (CancelledError, OSError):
            raise self._gone() from None
        except ImportError as error:
            raise EquipoiseError(f"a worker of the cluster lacks the program: {error}") from None

    def close(self) -> None:
        with suppress(OSError, TimeoutError):
            self._client.close(timeout=2)

    def _gone(self) -> EquipoiseError:
        return EquipoiseError(f"the Dask scheduler at '{self.address}' is gone")

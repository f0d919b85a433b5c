"""From batches to rows in a folder: as many on their way as there is room for, each written when it is done.

A batch whose worker dies is given out again, then in halves: a design that takes down its process every time ends as
a row that says so, and no other design is lost with it.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import suppress

from ..model.errors import EquipoiseError
from ..model.progress import Progress
from .batch import Batch, Rows, pieces
from .dataset import Dataset
from .plan import Plan
from .workers import WorkerLost, Workers

PATIENCE = 1.0  # [s] after which workers are counted anew
TRIES = 2  # of a batch, before it is halved
DEATHS = 30  # of workers on end, without a batch done: nothing works here
DIED = "the process that worked on it died, {tries} times: is there enough memory?"


def drive(plan: Plan, dataset: Dataset, workers: Workers, size: int, progress: Progress) -> None:
    """Work on all that is missing. Whatever ends it, the rows of the batches that are done are written.

    Args:
        size: designs in a batch.

    Raises:
        InputError: rows cannot be written.
        EquipoiseError: there are no workers any more.
    """
    missing = dataset.missing()
    pace = _Pace(dataset.designs, sum(stop - start for start, stop in missing), progress)
    todo, again = pieces(missing, size), list[Batch]()
    tries, deaths = Counter[Batch](), 0
    pending: dict[Future[Rows], Batch] = {}
    try:
        while True:
            pace.room = workers.room
            while len(pending) < pace.room and (batch := _next(todo, again)) is not None:
                pending[workers.submit(batch)] = batch
            if not pending and pace.room:
                return
            pace.tell()
            if not pending:
                time.sleep(PATIENCE)
                continue
            for future in wait(pending, PATIENCE, FIRST_COMPLETED).done:
                batch = pending.pop(future)
                try:
                    rows = workers.taken(future)
                except WorkerLost:
                    tries[batch] += 1
                    deaths += 1
                    if deaths > DEATHS:
                        raise EquipoiseError("the workers die one after the other, and nothing gets done") from None
                    parts = _again(batch, tries)
                    again += parts
                    if not parts:
                        why = DIED.format(tries=tries[batch])
                        dataset.write(batch, [plan.lost(batch[0], why)])
                        pace.done += 1
                    continue
                dataset.write(batch, rows)
                deaths = 0
                pace.done += batch[1] - batch[0]
    finally:
        for future, batch in pending.items():
            if future.done():
                with suppress(Exception):  # the reason for the end is told, not this
                    dataset.write(batch, workers.taken(future))
        workers.close()


def _next(todo: Iterator[Batch], again: list[Batch]) -> Batch | None:
    return again.pop() if again else next(todo, None)


def _again(batch: Batch, tries: Counter[Batch]) -> list[Batch]:
    """What to do for a batch whose worker has died: the same, or its halves, or nothing for a single design."""
    start, stop = batch
    if tries[batch] < TRIES:
        return [batch]
    if stop - start == 1:
        return []
    half = (start + stop) // 2
    for part in ((start, half), (half, stop)):
        tries[part] = TRIES - 1 if part[1] - part[0] > 1 else 0
    return [(start, half), (half, stop)]


class _Pace:
    """How far it is, how fast it goes, and how long it will take."""

    def __init__(self, designs: int, missing: int, progress: Progress) -> None:
        self.designs, self.before, self.done, self.room = designs, designs - missing, 0, 0
        self._start, self._report = time.monotonic(), progress

    def tell(self) -> None:
        """Report it."""
        there = self.before + self.done
        text = f"{there:,} of {self.designs:,} designs"
        if not self.room:
            text += ", waiting for workers"
        elif self.done:
            rate = self.done / (time.monotonic() - self._start)
            text += f", {rate:.3g} a second, {duration((self.designs - there) / rate)} left"
        self._report(text, there / self.designs)


def duration(seconds: float) -> str:
    """A time as people say it: ``40 s``, ``5 min``, ``7 h``, ``3 days``."""
    for size, unit in ((86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 2 * size:
            return f"{seconds / size:.0f} {unit}"
    return f"{seconds:.2g} s" if seconds < 10 else f"{seconds:.0f} s"

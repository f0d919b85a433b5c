"""A batch of designs, which a worker does at a time: the same code on this machine and on a cluster."""

from __future__ import annotations

import json
import threading
import zlib
from collections.abc import Iterable, Iterator
from functools import lru_cache
from typing import Any

from .plan import Plan

Rows = list[dict[str, Any]]
Batch = tuple[int, int]
"""The numbers of its designs, from the first to before the second."""

_ONE = threading.Lock()  # a worker of a cluster may have several threads; warnings are the process's own


def packed(plan: Plan) -> bytes:
    """A plan as it is sent to workers."""
    return zlib.compress(json.dumps(plan.document).encode())


def rows(plan: bytes, batch: Batch) -> Rows:
    """The rows of a batch."""
    with _ONE:
        own = _unpacked(plan)
        return [own.row(number) for number in range(*batch)]


def pieces(missing: Iterable[Batch], size: int) -> Iterator[Batch]:
    """Intervals cut into batches of at most `size`."""
    for start, stop in missing:
        for first in range(start, stop, size):
            yield first, min(first + size, stop)


@lru_cache(maxsize=2)
def _unpacked(plan: bytes) -> Plan:
    return Plan.of(json.loads(zlib.decompress(plan)))

"""Statistics of energy and torque over any number of poses, in one pass and constant memory.

Quantiles come from a histogram whose bins are a fixed share of their value wide, so that it never has to be changed
and two of them can be added.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np

from ..kinematics.sampling import sample
from ..kinematics.tree import Tree
from ..model.arrays import Array, Integers
from ..model.errors import Fault, InputError, UnsupportedError, nearest
from ..model.mechanism import Mechanism
from ..model.validate import whole_number
from .kernel import Kernel

CHUNK = 16_384  # poses held at a time
FINE = 8  # bits: a bin is 2^-8 of its value wide
LOWEST, HIGHEST = -64, 64  # powers of two that the bins cover [N m or N]
BINS = (HIGHEST - LOWEST) << FINE
QUANTILES = (0.5, 0.9, 0.99, 0.999)


@dataclass(frozen=True)
class Statistics:
    """What is true of a stream of poses. Torques are magnitudes, per coordinate [N m or N].

    Attributes:
        poses: that were finite; `skipped` were not.
        energy: smallest, mean and largest [J].
        max, rms: (n,) of the torque.
        quantiles: {share: (n,)} torques that this share of the poses stays below, within 0.2 %.
        worst: (n, n) row j is the pose [rad or m] where coordinate j's torque is largest.
    """

    poses: int
    skipped: int
    energy: tuple[float, float, float]
    max: Array
    rms: Array
    quantiles: dict[float, Array]
    worst: Array


def statistics(
    mechanism: Mechanism,
    source: Iterable[Array] | str | PathLike[str] | int,
    *,
    quantiles: Sequence[float] = QUANTILES,
    seed: int = 0,
    threads: int = 1,
) -> Statistics:
    """Energy and torque statistics of a mechanism without loops.

    Args:
        source: arrays (N, n) of poses [rad or m], each of any size; or a Parquet file with a column for each
            coordinate; or how many random poses inside the joint ranges to draw.
        seed: of the random poses, which are the same whatever the number of threads.

    Raises:
        InputError: the file lacks a column, there is no pose, or a quantile is not between 0 and 1.
        UnsupportedError: the mechanism has loops.
    """
    for share in quantiles:
        if not 0 < share < 1:
            raise InputError(Fault(("quantiles",), f"must be between 0 and 1, found {share:g}"))
    kernel = Kernel.of(mechanism)
    total = _Tally(kernel.tree.n)
    for part in _in_order(kernel, _sources(kernel.tree, source, seed), max(1, threads)):
        total.merge(part)
    if not total.poses:
        raise InputError(f"no pose to take statistics of: {total.skipped} were not finite")
    return total.statistics(quantiles)


def _sources(tree: Tree, source: Any, seed: int) -> Iterator[Any]:
    """Functions that give the next poses, a chunk each: random ones are drawn by the thread that needs them."""
    if isinstance(source, int):
        whole_number("poses", source, 1)
        for part, start in enumerate(range(0, source, CHUNK)):
            count = min(CHUNK, source - start)
            yield lambda part=part, count=count: sample(tree, count, (seed, part))
        return
    arrays = _parquet(tree, source) if isinstance(source, str | PathLike) else source
    for array in arrays:
        for start in range(0, len(array), CHUNK):
            yield lambda q=array[start : start + CHUNK]: q


def _parquet(tree: Tree, path: str | PathLike[str]) -> Iterator[Array]:
    try:
        from pyarrow import parquet
    except ImportError:
        raise UnsupportedError("reading a Parquet file needs pyarrow: install 'equipoise[study]'") from None
    with parquet.ParquetFile(path) as file:
        for name in tree.coordinates:
            if name not in file.schema_arrow.names:
                message = f"no column {nearest(name, file.schema_arrow.names)} for this coordinate"
                raise InputError(Fault((str(path),), message, tuple(file.schema_arrow.names)))
        for batch in file.iter_batches(batch_size=CHUNK, columns=list(tree.coordinates)):
            columns = [batch.column(name).to_numpy(zero_copy_only=False) for name in tree.coordinates]
            yield np.array(columns, float).reshape(tree.n, len(batch)).T


def _in_order(kernel: Kernel, sources: Iterator[Any], threads: int) -> Iterator[_Tally]:
    """The tally of each source, in their order whatever the threads do, with few of them under way at a time."""

    def work(source: Any) -> _Tally:
        tally = _Tally(kernel.tree.n)
        tally.add(np.asarray(source(), float), kernel)
        return tally

    if threads == 1:
        yield from map(work, sources)
        return
    with ThreadPoolExecutor(threads) as pool:
        waiting: deque[Future[_Tally]] = deque()
        for source in sources:
            waiting.append(pool.submit(work, source))
            if len(waiting) > 2 * threads:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()


class _Tally:
    """Sums, extremes and histograms so far."""

    def __init__(self, n: int) -> None:
        self.poses = self.skipped = 0
        self.energy = np.array([np.inf, 0.0, -np.inf])  # smallest, sum, largest
        self.square, self.max = np.zeros(n), np.full(n, -np.inf)
        self.worst = np.zeros((n, n))
        self.bins: Integers = np.zeros((n, BINS), np.int64)

    def add(self, q: Array, kernel: Kernel) -> None:
        """Count the poses q (N, n)."""
        energy, torque = kernel(q)
        size = np.abs(torque.T)
        good = np.isfinite(energy) & np.isfinite(size).all(axis=0)
        if not good.all():
            q, energy, size = q[good], energy[good], size[:, good]
        self.skipped += len(good) - len(q)
        self.poses += len(q)
        if not len(q):
            return
        self.energy = np.array([energy.min(), energy.sum(), energy.max()])
        for j, row in enumerate(size):
            self.square[j] = row @ row
            at = int(row.argmax())
            self.max[j], self.worst[j] = row[at], q[at]
            self.bins[j] = np.bincount(_bin(row), minlength=BINS)

    def merge(self, other: _Tally) -> None:
        """Take in what another has counted."""
        self.poses += other.poses
        self.skipped += other.skipped
        low, mean, high = other.energy
        self.energy = np.array([min(self.energy[0], low), self.energy[1] + mean, max(self.energy[2], high)])
        self.square += other.square
        higher = other.max > self.max
        self.max, self.worst = np.where(higher, other.max, self.max), np.where(higher[:, None], other.worst, self.worst)
        self.bins += other.bins

    def statistics(self, quantiles: Sequence[float]) -> Statistics:
        """What it comes to."""
        below = np.cumsum(self.bins, axis=1)
        found = {}
        for share in quantiles:
            at = np.array([int(np.searchsorted(row, share * self.poses)) for row in below], int)
            found[share] = np.minimum(_middle(at), self.max)
        low, total, high = self.energy.tolist()
        energy = (low, total / self.poses, high)
        rms = np.sqrt(self.square / self.poses)
        return Statistics(self.poses, self.skipped, energy, self.max, rms, found, self.worst)


def _bin(x: Array) -> Integers:
    """(N,) the bin of each positive number: its exponent and first bits; the first and last are open-ended."""
    bits = x.view(np.int64) >> (52 - FINE)
    return np.clip(bits - ((1023 + LOWEST) << FINE), 0, BINS - 1)


def _middle(number: Integers) -> Array:
    """The middle of each bin; of the first 0."""
    bits = (number.astype(np.int64) + ((1023 + LOWEST) << FINE)) << (52 - FINE)
    return np.where(number > 0, (bits + (1 << (51 - FINE))).view(np.float64), 0.0)

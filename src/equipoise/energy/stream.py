"""Statistics of energy and torque over any number of poses, in one pass; memory grows by 100 bytes for 32,768 poses.

Quantiles come from a histogram whose bins are a fixed share of their value wide, so that it never has to be changed
and two of them can be added.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from os import PathLike
from queue import SimpleQueue
from typing import Any

import numpy as np

from ..kinematics.sampling import bounds, sample
from ..kinematics.tree import Tree
from ..model.arrays import Array, frozen
from ..model.errors import Fault, InputError, UnsupportedError, nearest
from ..model.mechanism import Mechanism
from ..model.validate import whole_number
from .kernel import Kernel
from .tally import Poses, Sums, Tally, draw

CHUNK = 32_768  # poses that a thread takes at a time
QUANTILES = (0.5, 0.9, 0.99, 0.999)


@frozen
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
    tallies = [Tally(kernel) for _ in range(max(1, threads))]
    sums = list(_in_order(tallies, _sources(kernel.tree, source, seed)))
    total, *others = tallies
    for other in others:
        total.merge(other)
    poses, skipped = sum(part.poses for part in sums), sum(part.skipped for part in sums)
    if not poses:
        raise InputError(f"no pose to take statistics of: {skipped} were not finite")
    energy, square = np.array([part.energy for part in sums]), np.array([part.square for part in sums])
    return Statistics(
        poses,
        skipped,
        (float(energy[:, 0].min()), float(energy[:, 1].sum() / poses), float(energy[:, 2].max())),
        total.max,
        np.sqrt(square.sum(axis=0) / poses),
        {share: total.quantile(share) for share in quantiles},
        total.worst,
    )


def _sources(tree: Tree, source: Any, seed: int) -> Iterator[tuple[int, Poses]]:
    """The next poses, a chunk each: how many, and a function that gives those from one number up to another (n, N).

    So random ones are drawn by the thread that needs them, as it needs them.
    """
    if isinstance(source, int):
        whole_number("poses", source, 1)
        lower, upper = bounds(tree)
        dependent = np.setdiff1d(np.arange(len(tree.lower)), tree.coordinate_rows)
        limited = bool(np.isfinite([tree.lower[dependent], tree.upper[dependent]]).any())
        mixed = np.random.SeedSequence(seed).generate_state(1, np.uint64)[0]

        def drawn(first: int, start: int, stop: int) -> Array:
            if limited:  # a dependent joint's range leaves some out
                return np.ascontiguousarray(sample(tree, stop - start, (seed, first + start)).T)
            q = np.empty((tree.n, stop - start))
            draw(mixed, first + start, lower, upper - lower, q)
            return q

        for first in range(0, source, CHUNK):
            yield min(CHUNK, source - first), partial(drawn, first)
        return
    arrays = _parquet(tree, source) if isinstance(source, str | PathLike) else source
    for array in arrays:
        for first in range(0, len(array), CHUNK):
            part = np.asarray(array[first : first + CHUNK], float)
            yield len(part), lambda start, stop, part=part: part[start:stop].T


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


def _in_order(tallies: list[Tally], sources: Iterator[tuple[int, Poses]]) -> Iterator[Sums]:
    """The sums of each source, in their order whatever the threads do, with few of them under way at a time."""
    idle: SimpleQueue[Tally] = SimpleQueue()
    for tally in tallies:
        idle.put(tally)

    def work(number: int, source: tuple[int, Poses]) -> Sums:
        tally = idle.get()
        try:
            return tally.add(number, *source)
        finally:
            idle.put(tally)

    if len(tallies) == 1:
        yield from (work(*one) for one in enumerate(sources))
        return
    with ThreadPoolExecutor(len(tallies)) as pool:
        waiting: deque[Future[Sums]] = deque()
        for number, source in enumerate(sources):
            waiting.append(pool.submit(work, number, source))
            if len(waiting) > 2 * len(tallies):
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()

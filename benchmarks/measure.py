"""Measuring side by side: the things compared take turns, so that what else the machine does hits all of them."""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable

import numpy as np

from equipoise.energy.kernel.generated import Generated
from equipoise.energy.kernel.trace import Trace, Value
from equipoise.model.arrays import Array


def seconds(*tasks: Callable[[], object], repeat: int = 7, best: bool = False) -> list[float]:
    """Median (or least) time of each task, the tasks taken in turn."""
    times: list[list[float]] = [[] for _ in tasks]
    for _ in range(repeat + 1):
        for task, row in zip(tasks, times, strict=True):
            start = time.perf_counter()
            task()
            row.append(time.perf_counter() - start)
    pick = min if best else statistics.median
    return [pick(row[1:]) for row in times]  # the first round warms up


def cpu_seconds(task: Callable[[], object], repeat: int = 7) -> float:
    """The least processor time of a task on one thread: what others do counts less."""
    times = []
    for _ in range(repeat + 1):
        start = time.thread_time()
        task()
        times.append(time.thread_time() - start)
    return min(times[1:])


def machine() -> str:
    """The machine by its size only."""
    import llvmlite.binding as llvm

    features = llvm.get_host_cpu_features()
    vectors = "AVX-512" if features.get("avx512f") else "AVX2" if features.get("avx2") else "128-bit vectors"
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return f"{os.cpu_count()} cores, {vectors}, {memory:.0f} GB"


def operations() -> float:
    """Products with a sum per second and core [lanes], from the registers: the best of several ways to keep it busy."""
    return max(_operations(rows) for rows in (6, 8, 10, 12))


def _operations(rows: int, steps: int = 100) -> float:
    t = Trace()
    q = [t.input(row) for row in range(rows)]
    x: list[Value] = list(q)
    for _ in range(steps):  # of all rows in turn: none waits for another
        x = [t.add(t.mul(a, b), b) for a, b in zip(x, q, strict=True)]
    return rows * steps / _seconds(t, x)


SINCOS = 24
"""Operations of a sine with its cosine, as `Lanes.sincos` writes them: 21 of arithmetic, and 3 on bits."""


def _seconds(t: Trace, outputs: list[Value]) -> float:
    """Processor time per pose."""
    N, program = 4096, t.program(outputs)
    run, out = Generated(program), np.zeros((len(outputs), N))
    q = np.random.default_rng(0).uniform(-1, 1, (program.inputs, N))
    return cpu_seconds(lambda: [run(q, out) for _ in range(10)]) / (10 * N)


def bandwidth() -> float:
    """Bytes per second that one core reads and writes where nothing is in a cache."""
    a: Array = np.zeros(20_000_000)
    b = np.zeros_like(a)
    return 2 * a.nbytes / cpu_seconds(lambda: np.copyto(b, a))

"""Statistics of blocks of poses, in compiled loops: random poses in, sums, extremes and histograms out.

Random numbers are SplitMix64's (Steele, Lea and Flood 2014): number k of a seed is a function of both, so that whoever
draws it gets the same.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..model.arrays import Array
from ..model.compiled import Compiled
from .kernel import Kernel

BLOCK = 8192  # poses: with their torques they stay in the second cache
FINE = 8  # bits: a bin is 2^-8 of its value wide
LOWEST, HIGHEST = -64, 64  # powers of two that the bins cover [N m or N]
BINS = (HIGHEST - LOWEST) << FINE
SMALLEST = 2.0**LOWEST
FIRST = (1023 + LOWEST) << FINE  # the number of the first bin by exponent and first bits of a double

STEP, MIX_A, MIX_B = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_27, _30, _31, _11 = np.uint64(27), np.uint64(30), np.uint64(31), np.uint64(11)


def _draw(seed, first, lower, width, q):
    """Poses number `first` on, uniform in a box, as columns of q (n, N)."""
    n, N = q.shape
    for j in range(n):
        number = np.uint64(first * n + j + 1)
        for i in range(N):
            z = seed + (number + np.uint64(i) * np.uint64(n)) * STEP
            z = (z ^ (z >> _30)) * MIX_A
            z = (z ^ (z >> _27)) * MIX_B
            z = z ^ (z >> _31)
            q[j, i] = lower[j] + width[j] * (np.float64(np.int64(z >> _11)) * 2.0**-53)


def _spoilt(out, bad):
    """Marks poses with a number that is not finite in out (rows, N); returns how many."""
    bad[:] = False
    for j in range(out.shape[0]):
        for i in range(out.shape[1]):
            bad[i] |= not abs(out[j, i]) < np.inf
    count = 0
    for i in range(out.shape[1]):
        count += bad[i]
    return count


def _count(out, bits, energy, square, most, bins):
    """Adds poses in out (1 + n, N), whose bits are `bits`, to the sums; `most` (n,) becomes their largest torques."""
    N = out.shape[1]
    low, total, high = np.inf, 0.0, -np.inf
    for i in range(N):
        low, high = min(low, out[0, i]), max(high, out[0, i])
        total += out[0, i]
    energy[0], energy[1], energy[2] = min(energy[0], low), energy[1] + total, max(energy[2], high)
    for j in range(len(square)):
        total, high = 0.0, 0.0
        for i in range(N):
            x = out[1 + j, i]
            total += x * x
            high = max(high, abs(x))
        square[j] += total
        most[j] = high
        if high < SMALLEST:
            bins[j, 0] += N
            continue
        for i in range(N):
            number = ((bits[1 + j, i] & 0x7FFFFFFFFFFFFFFF) >> (52 - FINE)) - FIRST
            bins[j, min(max(number, 0), BINS - 1)] += 1


draw, spoilt, count = Compiled(_draw), Compiled(_spoilt), Compiled(_count, loose=True)


Poses = Callable[[int, int], Array]
"""From the number of a first pose and that after a last to these poses, as columns (n, N)."""


class Sums(NamedTuple):
    """Of some poses: how many count and how many do not, least, sum and largest energy, sum of each torque's square."""

    poses: int
    skipped: int
    energy: Array
    square: Array


class Tally:
    """What does not depend on the order: extremes and histograms of the poses that one thread has met."""

    def __init__(self, kernel: Kernel) -> None:
        n = kernel.tree.n
        self.kernel, self.n = kernel, n
        self.max, self.worst = np.full(n, -np.inf), np.zeros((n, n))
        self.found = np.zeros(n, int)  # the number of the source that the largest is from
        self.bins = np.zeros((n, BINS), np.int64)
        self._room, self._bad = np.empty((1 + n, BLOCK)), np.empty(BLOCK, bool)

    def add(self, number: int, length: int, source: Poses) -> Sums:
        """Count the poses of a source."""
        poses, energy, square = 0, np.array([np.inf, 0.0, -np.inf]), np.zeros(self.n)
        for start in range(0, length, BLOCK):
            block = source(start, min(start + BLOCK, length))
            out = self._room[:, : block.shape[1]]
            self.kernel(block.T, out=out)
            bad = self._bad[: block.shape[1]]
            if spoilt(out, bad):
                block, out = block[:, ~bad], np.ascontiguousarray(out[:, ~bad])
            if not block.shape[1]:
                continue
            most = np.empty(self.n)
            count(out, out.view(np.int64), energy, square, most, self.bins)
            poses += block.shape[1]
            for j in np.flatnonzero((most > self.max) | ((most == self.max) & (number < self.found))):
                self.max[j], self.found[j] = most[j], number
                self.worst[j] = block[:, int(np.abs(out[1 + j]).argmax())]
        return Sums(poses, length - poses, energy, square)

    def merge(self, other: Tally) -> None:
        """Take in what another has met."""
        higher = (other.max > self.max) | ((other.max == self.max) & (other.found < self.found))
        self.max, self.found = np.where(higher, other.max, self.max), np.where(higher, other.found, self.found)
        self.worst = np.where(higher[:, None], other.worst, self.worst)
        self.bins += other.bins

    def quantile(self, share: float) -> Array:
        """(n,) the torque that this share of the poses stays below, within half a bin."""
        below = np.cumsum(self.bins, axis=1)
        at = np.array([int(np.searchsorted(row, share * row[-1])) for row in below], np.int64)
        middle = ((at + FIRST) << (52 - FINE)) + (1 << (51 - FINE))
        return np.minimum(np.where(at > 0, middle.view(np.float64), 0.0), self.max)

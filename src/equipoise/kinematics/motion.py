"""Motions: every coordinate goes from rest to rest along cubics (Lin, Shieh and Chen 2010, Eq. 26)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..model.arrays import Array
from ..model.errors import Fault, InputError, nearest


@dataclass(frozen=True)
class CubicMove:
    """One coordinate goes from value `first` to `last` [rad or m] between the times `start` and `end` [s]."""

    coordinate: str
    start: float
    end: float
    first: float
    last: float

    def at(self, t: Array) -> Array:
        """(T,) the value at times `t` (T,) [s]: held before and after, a cubic with no speed at its ends between."""
        s = np.clip((t - self.start) / (self.end - self.start), 0.0, 1.0)
        return self.first + (self.last - self.first) * s**2 * (3 - 2 * s)


def follow(coordinates: Sequence[str], moves: Iterable[CubicMove], t: Array) -> Array:
    """(T, n) the configurations at times `t` (T,) [s]; the moves of one coordinate come in the order of time.

    A coordinate that no move names stays at 0.

    Raises:
        InputError: a move names no coordinate.
    """
    q, begun = np.zeros((len(t), len(coordinates))), set()
    for move in moves:
        if move.coordinate not in coordinates:
            problem = f"there is no coordinate {nearest(move.coordinate, coordinates)}"
            raise InputError(Fault(("moves",), problem, tuple(coordinates)))
        j = coordinates.index(move.coordinate)
        late = t >= move.start if j in begun else np.ones(len(t), dtype=bool)
        q[late, j] = move.at(t[late])
        begun.add(j)
    return q

"""Moves the ends of chosen springs to where they leave least, their parts as they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...model.arrays import Array
from .slots import Judge, Slot

STEP = 1e-6  # of a region's half side: for slopes
STIFF = 30.0  # times the unbalanced torque that a limit passed by all of its range counts
LEVELLING = 8  # rounds in which the largest residual is lowered
EVALUATIONS = 60


def polish(
    judge: Judge,
    slots: Sequence[Slot],
    load: Array,
    *,
    peak: bool = False,
    rounds: int = EVALUATIONS,
    aim: float = 0.0,
) -> tuple[Slot, ...]:
    """A local minimum of the root mean square torque, or of the largest.

    Args:
        load: (N * n,) torque besides these springs.
        peak: whether the largest counts: poses where much is left count more, again and again (Lawson's method).
        aim: how much more than the margin that they must keep is aimed at.
    """
    from scipy.optimize import least_squares

    size = float(np.sqrt(np.mean(load**2))) or 1.0
    x = np.concatenate([_free(slot) for slot in slots])
    weight = np.full(len(load), 1 / np.sqrt(len(load)))
    best, least = tuple(slots), _left(judge, slots, load, peak)

    def made(x: Array) -> tuple[Slot, ...]:
        found, at = [], 0
        for slot in slots:
            n = len(_free(slot))
            own = slot.x.copy()
            own[:n] = x[at : at + n]
            found.append(replace(slot, x=own))
            at += n
        return tuple(found)

    def values(x: Array, slopes: bool) -> Array:
        """The residual vector, or its derivatives."""
        torque, limits, columns = load.copy(), [], []
        for slot in made(x):
            n = len(_free(slot))
            own = np.concatenate([np.zeros((1, n)), STEP * np.eye(n)]) if slopes else np.zeros((1, n))
            own = slot.x + np.pad(own, ((0, 0), (0, 7 - n)))
            doing = judge.doing(slot.mount, slot.row, own, aim)
            over = STIFF * np.maximum(doing.passed, 0.0)
            torque = torque + doing.torque[0]
            limits.append(over)
            if slopes:
                columns.append((doing.torque[1:] - doing.torque[0]).T / STEP)
        if not slopes:
            return np.concatenate([weight * torque / size, *(over[0] for over in limits)])
        rows = np.hstack([weight[:, None] * column / size for column in columns])
        below = [(over[1:] - over[0]).T / STEP for over in limits]
        wide = np.zeros((sum(map(len, below)), rows.shape[1]))
        r = c = 0
        for block in below:
            wide[r : r + block.shape[0], c : c + block.shape[1]] = block
            r, c = r + block.shape[0], c + block.shape[1]
        return np.vstack([rows, wide])

    for level in range(1 + (LEVELLING if peak else 0)):
        found = least_squares(
            lambda x: values(x, False),
            x,
            jac=lambda x: values(x, True),  # pyright: ignore[reportArgumentType]  # a function too
            method="trf",
            max_nfev=rounds,
            x_scale=0.1,
        )
        x = found.x
        moved = tuple(judge.inside(slot) for slot in made(x))
        left = _left(judge, moved, load, peak)
        if left < least:
            best, least = moved, left
        elif level > 2:
            break
        residual = np.abs(load + sum(judge.torque(slot) for slot in moved))
        weight = weight * np.sqrt(residual / (residual.max() or 1.0) + 1e-3)
        weight /= np.linalg.norm(weight)
    return best


def left(judge: Judge, slots: Sequence[Slot], load: Array, peak: bool) -> float:
    """The torque that is left [N m, scaled]: the largest, or the root mean square over poses of all coordinates."""
    return torque_size(load + sum(judge.torque(slot) for slot in slots), len(judge.field.q), peak)


def torque_size(torque: Array, poses: int, peak: bool) -> float:
    """Of torques (N * n,): the largest, or the root mean square over the poses of all coordinates together."""
    return float(np.abs(torque).max()) if peak else float(np.sqrt(np.sum(torque**2) / poses))


def _left(judge: Judge, slots: Sequence[Slot], load: Array, peak: bool) -> float:
    return left(judge, slots, load, peak) if all(judge.may(slot) for slot in slots) else np.inf


def _free(slot: Slot) -> Array:
    return slot.x if slot.mount.cabled else slot.x[:6]

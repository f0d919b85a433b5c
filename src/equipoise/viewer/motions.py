"""Motions that the viewer plays: a paper's own where there is one, and motions that every mechanism has."""

from __future__ import annotations

import numpy as np

from ..kinematics import Tree, sample
from ..kinematics.motion import CubicMove, follow
from ..kinematics.sampling import bounds, inside
from ..model.arrays import Array
from ..model.mechanism import Mechanism

RATE = 25  # frames a second
LEG = 2.0  # [s] from one pose to the next
POSES = 5  # of the tour
SWING = 0.8  # of a coordinate's range, each joint in turn


def motions(mechanism: Mechanism, rest: Array) -> dict[str, Array]:
    """Name -> configurations (T, n) at `RATE` a second, all of them reachable; they start at `rest` (n,)."""
    tree = Tree.of(mechanism)
    found = {}
    found |= _papers(mechanism, tree)
    if tree.n:
        found["each joint in turn"] = _in_turn(tree, rest)
        found["tour of random poses"] = _through(np.vstack([rest, sample(tree, POSES, seed=1), rest]))
    reachable = {name: q[inside(tree, q, slack=1e-9)] for name, q in found.items()}
    return {name: q for name, q in reachable.items() if len(q) > 1}


def _papers(mechanism: Mechanism, tree: Tree) -> dict[str, Array]:
    """The motions of papers whose arm this is."""
    from ..reproduce import MOTIONS, motion

    found = {}
    for paper in MOTIONS:
        name, time, coordinates, q = motion(paper)
        if mechanism.name == name and set(coordinates) <= set(tree.coordinates):
            t = np.arange(time[0], time[-1] + 0.5 / RATE, 1 / RATE)
            found[paper] = np.tile(tree.rest, (len(t), 1))
            for j, values in zip(coordinates, q.T, strict=True):
                found[paper][:, tree.coordinates.index(j)] = np.interp(t, time, values)
    return found


def _in_turn(tree: Tree, rest: Array) -> Array:
    """Each coordinate goes up, down and back, the others rest."""
    low, high = bounds(tree)
    low, high = np.maximum(low, -np.pi), np.minimum(high, np.pi)
    q = [rest]
    for j in range(tree.n):
        for end in (high[j], low[j], rest[j]):
            there = rest.copy()
            there[j] = rest[j] + SWING * (end - rest[j])
            q.append(there)
    return _through(np.array(q))


def _through(q: Array) -> Array:
    """(T, n) through the poses `q` (K, n), at rest in each."""
    t = np.arange(0, LEG * (len(q) - 1) + 0.5 / RATE, 1 / RATE)
    names = [str(j) for j in range(q.shape[1])]
    moves = [
        CubicMove(names[j], LEG * k, LEG * (k + 1), q[k, j], q[k + 1, j])
        for k in range(len(q) - 1)
        for j in range(q.shape[1])
    ]
    return follow(names, moves, t)

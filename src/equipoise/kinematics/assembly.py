"""A first closed pose of a mechanism with loops, how many ways it can move, and which coordinates to steer it by."""

from __future__ import annotations

from collections.abc import Container, Iterable
from dataclasses import dataclass

import numpy as np

from ..model.arrays import Array
from ..model.errors import Fault, InputError
from .closure import Closure
from .continuation import Split
from .tolerances import CLOSED
from .tree import Tree

STARTS = 40  # random ones, when the guess does not lead to a closed pose
STEPS = 200
RANK = 1e-8  # singular values below this share of the largest, or of 1, are redundancy
NEARBY = 1e-2  # [rad, or share of the size] how far the poses are that tell whether the assembly pose is singular
STEERS = (0.03, 1e-2, 1e-4, 1e-6)
"""What a column must add to the dependent ones, as a share of its length: the first with which enough of them do."""


@dataclass(frozen=True)
class Mobility:
    """How many ways a mechanism can move.

    Attributes:
        gruebler: coordinates of the tree less the number of loop equations.
        numerical: coordinates of the tree less the rank of these equations: the truth.
        redundant: equations that follow from the others; numerical - gruebler.
    """

    gruebler: int
    numerical: int
    redundant: int


def assemble(closure: Closure) -> Array:
    """(n,) a closed pose near the mechanism's `assembly` values, inside the joint ranges.

    Raises:
        InputError: none is found; says which loop stays open and by how much, or which range is left.
    """
    tree, rng = closure.tree, np.random.default_rng(0)
    rows = tree.coordinate_rows
    free = np.where(tree.turns, np.pi, closure.size)
    lower, upper = (np.where(np.isinf(end), x, end) for end, x in ((tree.lower[rows], -free), (tree.upper[rows], free)))
    guess = np.where((lower <= 0) & (upper >= 0), 0.0, 0.5 * (lower + upper))
    for name, value in tree.mechanism.assembly:
        guess[tree.coordinates.index(name)] = value
    best, gap, outside = guess, np.inf, None
    for i in range(1 + STARTS):
        q = _descend(closure, guess if i == 0 else rng.uniform(lower, upper))
        size = float(np.abs(closure.at(q[None])[0]).max())
        if size < CLOSED:
            s = tree.values(q[None])[0]
            if ((s >= tree.lower - 1e-9) & (s <= tree.upper + 1e-9)).all():
                return q
            outside = q if outside is None else outside
        elif size < gap:
            best, gap = q, size
    raise InputError(_not_assembled(closure, best, outside))


def _not_assembled(closure: Closure, best: Array, outside: Array | None) -> Fault:
    tree = closure.tree
    if outside is not None:
        s = tree.values(outside[None])[0]
        wrong = int(np.argmax(np.maximum(tree.lower - s, s - tree.upper)))
        joint = tree.motions[wrong]
        found, low, high = (f"{joint.scale * x:.4g}" for x in (s[wrong], tree.lower[wrong], tree.upper[wrong]))
        unit = joint.shown_unit
        message = f"they close only with joint '{joint}' at {found} {unit}, outside its range of {low} to "
        return Fault(("loops",), f"{message}{high} {unit}; give 'assembly' values near a closed pose, or widen it")
    gaps = closure.gaps(best[None])[0]
    i = int(gaps.argmax())
    loop = tree.mechanism.loops[i]
    message = f"the mechanism cannot be assembled: the loop between '{loop.body_a}' and '{loop.body_b}' stays open by "
    return Fault(("loops", i), f"{message}{1e3 * gaps[i]:.3g} mm at best; give 'assembly' values near a closed pose")


def _descend(closure: Closure, q: Array) -> Array:
    """Damped least squares over all coordinates: short steps far from a solution, Newton's of least length near it."""
    damping = 1e-3
    residual, J = (x[0] for x in closure.at(q[None]))
    for _ in range(STEPS):
        if np.abs(residual).max() < CLOSED / 10:
            break
        U, S, Vt = np.linalg.svd(J, full_matrices=False)
        keep = RANK * S.max(initial=1.0) < S
        if not keep.any():
            break
        S = S[keep]
        step = -(Vt[keep].T * (S / (S**2 + damping * np.abs(residual).max() ** 2))) @ (U[:, keep].T @ residual)
        trial = q + step * min(1.0, 0.5 / np.abs(step).max(initial=1e-300)) * closure.scale
        new, new_J = (x[0] for x in closure.at(trial[None]))
        if np.linalg.norm(new) < np.linalg.norm(residual):
            q, residual, J, damping = trial, new, new_J, max(damping / 10, 1e-12)
        elif damping > 1e12:
            break
        else:
            damping *= 10
    return q


def mobility(closure: Closure, q: Array) -> Mobility:
    """Of the mechanism near its closed pose `q`.

    Raises:
        InputError: the pose is singular: nearby closed poses have fewer ways to move.
    """
    n, rng = closure.tree.n, np.random.default_rng(0)
    J = closure.at(q[None])[1][0]
    rank = _rank(J)
    _, _, Vt = np.linalg.svd(J)
    for _ in range(4):
        if rank == n:
            break
        way = rng.normal(size=n - rank) @ Vt[rank:]
        near = _descend(closure, q + NEARBY * way / np.abs(way).max() * closure.scale)
        residual, there = closure.at(near[None])
        if np.abs(residual).max() < CLOSED and np.abs((near - q) / closure.scale).max() < 10 * NEARBY:
            higher = _rank(there[0])
            if higher > rank:
                raise InputError(
                    Fault(
                        ("assembly",),
                        f"the mechanism is assembled in a singular pose, where it can move in {n - rank} ways and "
                        f"beside it in {n - higher}: choose another 'assembly'",
                    )
                )
    return Mobility(n - closure.count, n - rank, closure.count - rank)


def _rank(J: Array) -> int:
    S = np.linalg.svd(J, compute_uv=False)
    return int((RANK * S.max(initial=1.0) < S).sum())


def choose(closure: Closure, q: Array, freedom: int) -> Split:
    """The independent coordinates: those of the file, else the first in its order that can be, balls last.

    Raises:
        InputError: those of the file are too few, too many, or do not determine the others.
    """
    J = closure.at(q[None])[1][0]
    n, names = closure.tree.n, closure.tree.coordinates
    given = closure.tree.mechanism.independent
    if given:
        if len(given) != freedom:
            needed = "1 coordinate is" if freedom == 1 else f"{freedom} coordinates are"
            found = f"{needed} independent, found {len(given)}: {', '.join(given)}"
            free = _automatic(closure.tree, J, freedom, {names.index(name) for name in given})
            missing = [names[j] for j in free if names[j] not in given]
            more = f"; {', '.join(missing)} would stay free" if len(given) < freedom else ""
            raise InputError(Fault(("independent",), found + more))
        independent = sorted(names.index(name) for name in given)
        split = _split(independent, n)
        free = _dependent(J[:, split.dependent], STEERS[-1], range(n - len(independent)))
        if len(free) < n - freedom:
            loose = next(names[j] for i, j in enumerate(split.dependent) if i not in free)
            message = f"{', '.join(given)} do not determine the others ('{loose}' stays free); try"
            automatic = [names[j] for j in _automatic(closure.tree, J, freedom)]
            raise InputError(Fault(("independent",), f"{message} {', '.join(automatic)}"))
        return split
    return _split(_automatic(closure.tree, J, freedom), n)


def _automatic(tree: Tree, J: Array, freedom: int, given: Container[int] = ()) -> list[int]:
    """Coordinates that can be independent, those `given` before all others."""
    balls = {
        f"{joint.name}.{letter}" for joint in tree.mechanism.joints if joint.type == "spherical" for letter in "xyz"
    }
    order = sorted(range(tree.n), key=lambda j: (j in given, tree.coordinates[j] not in balls, -j))
    dependent = []
    for share in STEERS:
        dependent = _dependent(J, share, order)
        if len(dependent) == tree.n - freedom:
            break
    return [j for j in range(tree.n) if j not in dependent]


def _split(independent: list[int], n: int) -> Split:
    dependent = [j for j in range(n) if j not in independent]
    return Split(np.array(independent, int), np.array(dependent, int))


def _dependent(J: Array, share: float, order: Iterable[int]) -> list[int]:
    """Columns, in this order, each of which adds a new direction to those before it."""
    basis, found = np.zeros((len(J), 0)), []
    for j in order:
        rest = J[:, j]
        for _ in range(2):  # once more for the rounding of the first
            rest = rest - basis @ (basis.T @ rest)
        if np.linalg.norm(rest) > share * max(np.linalg.norm(J[:, j]), RANK * max(1.0, float(np.linalg.norm(J)))):
            basis = np.column_stack([basis, rest / np.linalg.norm(rest)])
            found.append(j)
    return found

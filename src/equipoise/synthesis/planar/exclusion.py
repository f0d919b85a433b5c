"""Proofs that no springs of a layout balance a planar arm, and their check in exact arithmetic.

With mass centres and attachments on the link lines everything is real. A spring between links i < k has ``K = s w w'``
with ``w = (.., alpha, 1, .., 1, beta, ..)``: stiffness s > 0 and alpha, beta not 0, or the spring would act from the
neighbouring link and belong to another layout. The blocks off the diagonal are linear in

    s,  s alpha,  s beta,  s alpha beta

and must vanish, except that in the ground's row the springs must give what gravity takes: `K_12 > K_13 > .. > K_1n > 0`
for every arm whose mass centres lie on their links, between the joints (Eq. (24); the end link, whose length only
scales, counted long enough). So a proof holds for all such arms at once.

Once alpha and beta are confined to intervals, their products are bounded linearly; `prove` splits these by sign until
each case has a Motzkin certificate: multipliers y of the equations and z >= 0 of the inequalities, some strict one of
them, whose combination of the left sides is identically zero. It would read 0 > 0. `verify` checks such a proof, with
intervals of any kind, in exact arithmetic.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf
from typing import Literal

import numpy as np

Layout = tuple[tuple[int, int], ...]
Interval = tuple[float, float]  # powers of two, zero or infinite, of one sign; open where it ends at 0 or infinity
Box = tuple[tuple[Interval, Interval], ...]  # of (alpha, beta) for each spring
Row = dict[int, Fraction]  # unknown number -> coefficient
FREE: Interval = (-inf, inf)


@dataclass(frozen=True)
class Leaf:
    """A case refuted by a combination: weights of the rows of `rows`, by number."""

    equalities: tuple[tuple[int, Fraction], ...]
    inequalities: tuple[tuple[int, Fraction], ...]


@dataclass(frozen=True)
class CaseSplit:
    """A case divided: the interval of `spring`'s alpha (0) or beta (1) cut at `at`."""

    spring: int
    which: Literal[0, 1]
    at: float
    below: Proof
    above: Proof


Proof = Leaf | CaseSplit


@dataclass(frozen=True)
class CaseRows:
    """What the unknowns of a case satisfy: each row of `zero` is 0, of `positive` > 0, of `least` >= 0."""

    zero: list[Row]
    positive: list[Row]
    least: list[Row]


def start(layout: Layout) -> Box:
    """Everything that needs to be looked at."""
    box = [[FREE, FREE] for _ in layout]
    for s, (i, k) in enumerate(layout):
        if k == i + 1:
            box[s][0] = (1.0, 1.0)  # only the product counts
    return tuple((alpha, beta) for alpha, beta in box)


def rows(layout: Layout, n: int, box: Box) -> CaseRows:
    """The linear conditions on (s, s alpha, s beta, s alpha beta) of every spring: unknowns 4 s .. 4 s + 3."""
    one = Fraction(1)
    block: dict[tuple[int, int], Row] = {(u, v): {} for u in range(1, n + 1) for v in range(u + 1, n + 1)}
    for s, (i, k) in enumerate(layout):
        for (u, v), row in block.items():
            if i <= u and v <= k:
                row[4 * s + (u == i) + 2 * (v == k)] = one
    ground = [block[1, v] for v in range(2, n + 1)]
    positive = [_minus(a, b) for a, b in zip(ground, [*ground[1:], {}], strict=True)]
    zero = [row for (u, _), row in block.items() if u > 1]
    least: list[Row] = []
    for s, (alpha, beta) in enumerate(box):
        positive.append({4 * s: one})
        # x = s, y = s alpha: in the interval's cone; so are s beta, s alpha beta
        for (lower, upper), (x, y), other in (
            (alpha, (4 * s, 4 * s + 1), (4 * s + 2, 4 * s + 3, beta)),
            (beta, (4 * s, 4 * s + 2), (4 * s + 1, 4 * s + 3, alpha)),
        ):
            _cone(x, y, lower, upper, 1, positive, least)
            third, fourth, (low, high) = other
            if low >= 0 or high <= 0:
                _cone(third, fourth, lower, upper, 1 if low >= 0 else -1, positive, least)
    return CaseRows(zero, positive, least)


def _cone(x: int, y: int, lower: float, upper: float, sign: int, positive: list[Row], least: list[Row]) -> None:
    """lower x <= y <= upper x, where sign x > 0."""
    unit = Fraction(sign)
    for bound, side in ((lower, 1), (upper, -1)):
        if bound == 0:
            positive.append({y: side * unit})
        elif abs(bound) < inf:
            least.append({y: side * unit, x: -side * unit * Fraction(bound)})


def _minus(a: Row, b: Row) -> Row:
    return {j: value for j in {*a, *b} if (value := a.get(j, Fraction(0)) - b.get(j, Fraction(0)))}


def verify(layout: Layout, n: int, proof: Proof, box: Box | None = None) -> bool:
    """Whether a proof holds, in exact arithmetic and from the layout alone."""
    box = start(layout) if box is None else box
    if isinstance(proof, CaseSplit):
        lower, upper = box[proof.spring][proof.which]
        if not lower < proof.at < upper:
            return False
        below, above = (_with(box, proof.spring, proof.which, part) for part in ((lower, proof.at), (proof.at, upper)))
        return verify(layout, n, proof.below, below) and verify(layout, n, proof.above, above)
    given = rows(layout, n, box)
    bounds = [*given.positive, *given.least]
    total: Row = {}
    for source, weights in ((given.zero, proof.equalities), (bounds, proof.inequalities)):
        for number, weight in weights:
            for j, value in source[number].items():
                total[j] = total.get(j, Fraction(0)) + weight * value
    strict = any(weight > 0 for number, weight in proof.inequalities if number < len(given.positive))
    return strict and all(weight >= 0 for _, weight in proof.inequalities) and not any(total.values())


def _with(box: Box, spring: int, which: int, interval: Interval) -> Box:
    pair = list(box[spring])
    pair[which] = interval
    return (*box[:spring], (pair[0], pair[1]), *box[spring + 1 :])


def prove(layout: Layout, n: int, cases: int = 2000) -> Proof | None:
    """A proof by the signs of alpha and beta that a layout balances no arm of n links; None when it is left open.

    Args:
        cases: at most so many are looked at.
    """
    left = iter(range(cases))

    def case(box: Box) -> Proof | None:
        if next(left, None) is None:
            return None
        leaf = refute(layout, n, box)
        if leaf is not None:
            return leaf
        for spring, pair in enumerate(box):
            for which in (1, 0):
                if pair[which] == FREE:
                    below = case(_with(box, spring, which, (-inf, 0.0)))
                    above = None if below is None else case(_with(box, spring, which, (0.0, inf)))
                    return None if below is None or above is None else CaseSplit(spring, which, 0.0, below, above)
        return None

    return case(start(layout))


def refute(layout: Layout, n: int, box: Box) -> Leaf | None:
    """A certificate that a case has no solution, None when the linear relaxation allows one."""
    from scipy.optimize import linprog

    given = rows(layout, n, box)
    bounds = [*given.positive, *given.least]
    E, Z, P = len(given.zero), len(bounds), len(given.positive)
    A = np.zeros((4 * len(layout) + 1, E + Z))
    for column, row in enumerate([*given.zero, *bounds]):
        for j, value in row.items():
            A[j, column] = float(value)
    A[-1, E : E + P] = 1.0
    right = np.zeros(len(A))
    right[-1] = 1.0
    cost = np.concatenate([np.zeros(E), np.ones(Z)])
    found = linprog(cost, A_eq=A, b_eq=right, bounds=[(None, None)] * E + [(0, None)] * Z, method="highs-ds")
    if found.status != 0:
        return None
    x = found.x / abs(found.x).max()
    exact = [Fraction(float(value)).limit_denominator(5000) for value in x]
    leaf = Leaf(
        tuple((j, value) for j, value in enumerate(exact[:E]) if value),
        tuple((j, value) for j, value in enumerate(exact[E:]) if value),
    )
    return leaf if verify(layout, n, leaf, box) else None

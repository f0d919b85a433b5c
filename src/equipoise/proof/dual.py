"""A lower bound of the torque that any springs leave, and the numbers that prove it (docs/certificates.md).

The program is that of docs/theory.md, section 4, with a limit on the sum of all stiffnesses: springs of any stiffness
could make use of axes that miss each other by a rounding error. Its dual solution is a trial torque, and for each pair
of bodies multipliers of what its regions keep from being negative. Both are rounded, and what they prove is enclosed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from ..model.arrays import Array, Integers
from ..synthesis.convex.semidefinite import conic_solver
from ..synthesis.convex.spring_block import SpringBlock, Upper, svec
from .enclosure import Enclosure, Key, Terms

SIDE, ONE = 7, 3  # of y = [u_a, 1, u_b], with what a flat region fixes, and where the 1 is
ORDER = [ONE, 0, 1, 2, 4, 5, 6]  # of y = [u_a, 1, u_b] as a certificate counts: [1, u_a, u_b]
SLACK = 1e-13  # of the largest entry: what double precision may miss of an eigenvalue
TOLERANCE = 1e-10

Multiplier = tuple[str, int, int, int, int]
"""("ball", i, 0, i, 0): 1 - |u|^2 of the end of coordinate i. ("box", i, s, j, t): (1 + s u_i) (1 + t u_j)."""


@dataclass(frozen=True)
class LowerBound:
    """At least `least` [N m] is left, as a root mean square; `proof` is what a certificate holds for it."""

    least: Fraction
    proof: dict[str, Any]


def multipliers(block: SpringBlock) -> list[Multiplier]:
    """What is not negative for ends inside the regions of a pair."""
    found: list[Multiplier] = []
    for first, region in ((1, block.region_a), (4, block.region_b)):
        own = [first + i for i in range(3) if region.half[i]]
        if region.shape == "ball":
            found.append(("ball", first, 0, first, 0))
        else:
            found += [("box", i, 1, i, -1) for i in own]
    boxed = [
        first + i
        for first, region in ((1, block.region_a), (4, block.region_b))
        for i in range(3)
        if region.half[i] and region.shape == "box"
    ]
    found += [("box", i, s, j, t) for i in boxed for j in boxed if i < j for s in (1, -1) for t in (1, -1)]
    return found


def matrix(one: Multiplier) -> Array:
    """(7, 7) of such a form in y = [1, u_a, u_b]."""
    kind, i, s, j, t = one
    M = np.zeros((SIDE, SIDE))
    M[0, 0] = 1.0
    if kind == "ball":
        M[range(i, i + 3), range(i, i + 3)] = -1.0
        return M
    for x, y, factor in ((0, i, s), (0, j, t), (i, j, s * t)):
        M[x, y] += factor / 2
        M[y, x] += factor / 2
    return M


class Rows:
    """The terms of the energy of all springs and of the load, those of opposite frequency once.

    Attributes:
        weight: (terms,) their size as torques, squared.
        forms: for each pair (terms, 7, 7) complex in y = [1, u_a, u_b] [m^2]; load: (terms,) complex [J].
    """

    def __init__(self, enclosure: Enclosure, forms: Sequence[Terms], scale: Array) -> None:
        self.enclosure, self.exact, self.exact_load = enclosure, forms, enclosure.load()
        n = len(enclosure.names)
        every = {key for terms in (*forms, self.exact_load) for key in terms if key > enclosure.zero}
        self.keys: list[Key] = sorted(every)
        frequencies: Integers = np.array(self.keys, int).reshape(-1, 2 * n)[:, :n]
        self.weight = ((frequencies * scale / enclosure.unit) ** 2).sum(axis=1)
        zero = np.zeros((SIDE, SIDE))
        self.forms = [np.array([_double(terms[k]) if k in terms else zero for k in self.keys]) for terms in forms]
        self.load = np.array([complex(self.exact_load.get(k, 0)) for k in self.keys])

    @property
    def columns(self) -> tuple[list[Array], Array]:
        """Real rows: for each pair (rows, 28) and the load (rows,) as torques [N m]."""
        root = np.sqrt(2 * self.weight)

        def real(values: Any) -> Array:
            weighted = values * root.reshape(-1, *[1] * (values.ndim - 1))
            return np.concatenate([weighted.real, weighted.imag])

        back = np.argsort(ORDER)
        return [real(svec(form[:, back][:, :, back])) for form in self.forms], real(self.load)

    def trial(self, y: Array) -> list[list[str]]:
        """Of a trial torque on these rows (rows,): the energy that it is the derivative of, as text."""
        root = np.sqrt(2 * np.where(self.weight > 0, self.weight, np.inf))
        a, b = y.reshape(2, -1) / root
        n = len(self.enclosure.names)
        return [
            [*map(str, key[:n]), repr(float(x)), repr(float(z))]
            for key, x, z in zip(self.keys, a, b, strict=True)
            if x or z
        ]

    def mean(self, trial: Mapping[Key, Any], weight: Mapping[Key, Any], terms: Mapping[Key, Any]) -> Any:
        """The mean product of two torques, enclosed: a number, or a matrix of them."""
        total = None
        for key, e in trial.items():
            if key in terms:
                for one in _real_parts(terms[key], e, weight[key]):
                    total = one if total is None else total + one
        return total


def _real_parts(c: Any, e: Any, weight: Any) -> Iterator[Any]:
    """Twice the real part of conj(e) c, times the weight: c and what has the opposite frequency."""
    product = c * (e.conjugate() * weight)
    yield product + product.conjugate()


def _double(M: Any) -> Any:
    """Of y = [u_a, 1, u_b], in the certificate's order."""
    values = np.array([complex(x) for x in M.entries()]).reshape(SIDE, SIDE)
    return values[np.ix_(ORDER, ORDER)]


def lower_bound(
    enclosure: Enclosure, blocks: Sequence[SpringBlock], scale: Array, stiffness: float
) -> LowerBound | None:
    """What springs of these blocks leave at least, while their stiffnesses add up to at most `stiffness` [N/m].

    Args:
        scale: (n,) what each coordinate's torque counts.

    Returns:
        None where that is nothing.
    """
    forms = [enclosure.form(block.body_a, block.body_b, _lift(block).tolist()) for block in blocks]
    rows = Rows(enclosure, forms, scale)
    limits = [multipliers(block) for block in blocks]
    y, amounts, shift = _solved(rows, limits, stiffness)
    trial = rows.trial(y)
    names = len(enclosure.names)
    exact = {
        (*map(int, one[:names]), *enclosure.zero[names:]): enclosure.number(one[names], one[names + 1]) for one in trial
    }
    factors = [Fraction(float(x)) for x in scale]
    weight = {
        key: enclosure.number(sum((f * k / enclosure.unit) ** 2 for f, k in zip(factors, key, strict=False)))
        for key in exact
    }
    pairs = []
    for block, own, found, terms in zip(blocks, limits, amounts, forms, strict=True):
        half = np.array([1.0, *block.region_a.half, *block.region_b.half]) > 0
        mean = rows.mean(exact, weight, terms)
        S = np.zeros((SIDE, SIDE)) if mean is None else _double(mean).real / 1
        found = np.maximum(found, 0.0)
        rest = S - sum((x * matrix(one) for x, one in zip(found, own, strict=True)), np.zeros((SIDE, SIDE)))
        rest[0, 0] += shift
        least = float(np.linalg.eigvalsh(rest[np.ix_(half, half)])[0])
        # a little more of every multiplier lifts the ends, and the shift pays for it
        more = max(0.0, -least) + SLACK * max(float(np.abs(rest).max()), 1e-300)
        squares = [kind == "ball" or (i, s) == (j, -t) for kind, i, s, j, t in own]
        found = found + more * np.array(squares)
        pairs.append((own, found, (1 + sum(squares)) * more))
    shift += max(extra for _, _, extra in pairs)
    torque, size = rows.mean(exact, weight, rows.exact_load), rows.mean(exact, weight, exact)
    if torque is None:
        return None
    least = (
        torque.real - enclosure.number(repr(shift)).real * enclosure.number(repr(stiffness)).real
    ) / size.real.sqrt()
    value = enclosure.lower(least)
    proof = {
        "trial": trial,
        "pairs": [[[*one, repr(float(x))] for one, x in zip(own, found, strict=True) if x] for own, found, _ in pairs],
        "shift": repr(shift),
    }
    return LowerBound(value, proof) if value > 0 else None


def _lift(block: SpringBlock) -> Array:
    """(7, 7) maps y to z = [p_a; 1; p_b] in the bodies' coordinates."""
    L = np.zeros((SIDE, SIDE))
    L[:4, :4] = block.region_a.lift
    L[4:, 4:], L[4:, ONE] = block.region_b.lift[:3, :3], block.region_b.lift[:3, 3]
    return L


def _solved(rows: Rows, limits: Sequence[Sequence[Multiplier]], stiffness: float) -> tuple[Array, list[Array], float]:
    """The dual solution in double precision: a trial torque, each pair's multipliers, and that of the stiffness."""
    from scipy import sparse

    clarabel = conic_solver()
    columns, load = rows.columns
    unit = float(np.linalg.norm(load)) or 1.0
    Q, R = np.linalg.qr(np.column_stack([*columns, load]), mode="reduced")
    upper, back = Upper.of(SIDE), np.argsort(ORDER)
    many = len(upper.row)
    scale = [1 / max(float(np.linalg.norm(own)), 1e-300) for own in columns]
    width = many * len(columns) + 1
    A, b, cones = [], [], []

    def rows_of(block: Array, start: int) -> Any:
        full = sparse.lil_matrix((len(block), width))
        full[:, start : start + block.shape[1]] = block
        return full

    for p in range(len(columns)):  # with the smaller number of unknowns: x = scale * unit * what is solved for
        A.append(rows_of(-np.eye(many), p * many))
        b.append(np.zeros(many))
        cones.append(clarabel.PSDTriangleConeT(SIDE))
    for p, own in enumerate(limits):
        forms = np.array([svec(matrix(one)[np.ix_(back, back)]) for one in own])
        A.append(rows_of(-forms, p * many))
        b.append(np.zeros(len(own)))
        cones.append(clarabel.NonnegativeConeT(len(own)))
    middle = ((upper.row == ONE) & (upper.column == ONE)) * 1.0
    cap = np.concatenate([*(s * unit / stiffness * middle for s in scale), [0.0]])
    A.append(sparse.lil_matrix(cap[None]))
    b.append(np.ones(1))
    cones.append(clarabel.NonnegativeConeT(1))
    torque = np.hstack([R[:, p * many : (p + 1) * many] * s for p, s in enumerate(scale)])
    A += [
        sparse.lil_matrix(-np.eye(1, width, width - 1)),
        sparse.lil_matrix(np.hstack([-torque, np.zeros((len(R), 1))])),
    ]
    b += [np.zeros(1), R[:, -1] / unit]
    cones.append(clarabel.SecondOrderConeT(1 + len(R)))
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_threads = False, 1
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = TOLERANCE
    objective = np.append(np.zeros(width - 1), 1.0)
    solver = clarabel.DefaultSolver(
        sparse.csc_matrix((width, width)), objective, sparse.vstack(A).tocsc(), np.concatenate(b), cones, settings
    )
    z = np.array(solver.solve().z)
    start, amounts = many * len(columns), []
    for own, s in zip(limits, scale, strict=True):
        amounts.append(z[start : start + len(own)] / s)
        start += len(own)
    shift = float(z[start]) * unit / stiffness
    return -Q @ z[start + 2 :], amounts, max(0.0, shift)

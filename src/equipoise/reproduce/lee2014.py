"""Y.-Y. Lee and D.-Z. Chen, "Determination of spring installation configuration on statically balanced planar
articulated manipulators", Mechanism and Machine Theory 74 (2014): Tables 2 to 5 and Fig. 10.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from math import radians

import numpy as np

from ..balance import check
from ..energy.evaluate import Potential
from ..kinematics.motion import CubicMove, follow
from ..model.arrays import Array
from ..model.errors import EquipoiseError
from ..model.mechanism import Body, Joint, Mechanism
from ..synthesis.planar.arm import Installation, PlanarArm
from ..synthesis.planar.criteria import LayoutObjective, failures, sign_failures
from ..synthesis.planar.exclusion import Layout
from ..synthesis.planar.installing import STIFFNESS, A, B, Equations, Fixed, upward
from ..synthesis.planar.layouts import LayoutSearch, labels, name, search, span
from ..synthesis.planar.stiffness_blocks import StiffnessBlocks
from .record import Plot, Reproduction, Row, spread

PAPER = "lee2014"
CITATION = (
    'Y.-Y. Lee, D.-Z. Chen, "Determination of spring installation configuration on statically balanced planar '
    'articulated manipulators", Mechanism and Machine Theory 74 (2014)'
)

# Table 4: m [kg], r [m], s [m]
TABLE_4 = {2: (0.848, 0.180, 0.090), 3: (0.848, 0.180, 0.090), 4: (1.330, 0.070, 0.060)}


@dataclass(frozen=True)
class Printed:
    """A row of Table 5: a, b [m] as printed; k [N/m] was chosen, and the angles in quarter turns."""

    i: int
    k: int
    stiffness: float
    a: str
    b: str
    alpha: int
    beta: int

    def installed(self, a: float, b: float) -> Installation:
        """The spring with ends `a` and `b` [m] from their joints."""
        return Installation(self.i, self.k, self.stiffness, a * 1j**self.alpha, b * 1j**self.beta)


@dataclass(frozen=True)
class Case:
    """One half of Table 5.

    Attributes:
        energy: [N m] the total that is printed.
        free: (row, A or B) lengths that the design equations leave free; the others follow from them.
    """

    letter: str
    rows: tuple[Printed, ...]
    energy: str
    free: tuple[tuple[int, int], ...]

    @property
    def layout(self) -> Layout:
        return tuple((row.i, row.k) for row in self.rows)

    @property
    def free_texts(self) -> list[str]:
        return [(self.rows[s].a, self.rows[s].b)[which - A] for s, which in self.free]


CASES = (
    Case(
        "a",
        (
            Printed(1, 3, 590, "0.010", "0.073", 1, 2),
            Printed(1, 4, 78, "0.190", "0.063", 1, 0),
            Printed(1, 4, 160, "0.030", "0.031", 1, 2),
        ),
        "20.56",
        ((1, B),),
    ),
    Case(
        "b",
        (
            Printed(1, 2, 93, "0.134", "0.120", 1, 0),
            Printed(1, 4, 128, "0.134", "0.045", 1, 0),
            Printed(2, 4, 320, "0.072", "0.045", 0, 0),
            Printed(3, 4, 400, "0.262", "0.035", 2, 2),
        ),
        "27.27",
        ((0, B), (3, A)),
    ),
)

# Tables 2 and 3; to the latter, as far as it can be read, the layouts with springs 23 and 24, or 24 and 34,
# that the last but one paragraph of section 7.2 adds
TABLE_2 = {2: ("12",), 3: ("13,23", "13,13"), 4: ("13,14,24", "13,14,14"), 5: ("13,14,15,25", "13,14,15,15")}
TABLE_3 = {
    3: ("13,23",),
    4: ("13,14,24", "12,14,23,24", "12,14,24,34"),
    5: ("13,14,15,25", "12,14,15,23,25", "13,15,23,24,25", "13,15,24,25,34"),
}
THIRD = ((1, 2), (1, 3), (1, 5), (2, 4), (2, 5), (3, 5), (4, 5))  # Table 3, n = 5, third matrix as printed

# Section 8: theta_2, theta_3, theta_4 [deg] at the times 0, 1 and 2
POSES = ((135, 225, 270), (90, 270, 270), (90, 315, 45))
TIMES = np.linspace(0, 2, 401)


def arm() -> Mechanism:
    """The bare arm: Table 4."""
    links = {1: "world"} | {j: f"link {j}" for j in TABLE_4}
    reach = {2: 0.0} | {j + 1: r for j, (_, r, _) in TABLE_4.items()}
    return Mechanism(
        "Lee and Chen's arm",
        bodies=tuple(Body(links[j], m, (s, 0, 0)) for j, (m, _, s) in TABLE_4.items()),
        joints=tuple(
            Joint(f"joint {j}", "revolute", links[j - 1], links[j], (reach[j], 0, 0), axis=(0, -1, 0)) for j in TABLE_4
        ),
    )


@cache
def planar() -> PlanarArm:
    """The same as links of complex numbers."""
    return PlanarArm.of(arm(), end=TABLE_4[4][1])


def printed(case: Case) -> Mechanism:
    """The arm with the springs of Table 5, rounded as they are."""
    return _with(tuple(row.installed(float(row.a), float(row.b)) for row in case.rows))


def completed(case: Case, *free: float) -> tuple[Installation, ...]:
    """The springs of Table 5 with the lengths that were free as given or printed; the others exact, by (39)-(54)."""
    values = free or tuple(map(float, case.free_texts))
    fixed: Fixed = {(s, STIFFNESS): row.stiffness for s, row in enumerate(case.rows)}
    for (s, which), value in zip(case.free, values, strict=True):
        fixed |= {(s, which): _along(case.rows[s], which, value)}
    equations = Equations(planar(), case.layout, fixed=fixed)
    start = [
        (0.0, *(_along(row, which, float(text)) / equations.size for which, text in ((A, row.a), (B, row.b))))
        for row in case.rows
    ]
    x = equations.newton(equations.held(np.array(start)))
    springs = None if x is None else equations.installed(x)
    if springs is None:
        raise EquipoiseError(f"the design equations of Table 5({case.letter}) were not solved")
    return springs


def balanced(case: Case) -> Mechanism:
    """The arm with the springs of Table 5, completed."""
    return _with(completed(case))


def motion() -> Array:
    """(T, 3) the joint angles of section 8 at `TIMES` [rad]."""
    moves = [
        CubicMove(f"joint {j}", start, start + 1.0, radians(POSES[start][j - 2]), radians(POSES[start + 1][j - 2]))
        for j in TABLE_4
        for start in range(2)
    ]
    return follow(arm().coordinates, moves, TIMES)


def reproduction() -> Reproduction:
    """Everything the paper prints."""
    rows = (*_table_2(), *_table_3(), _unbalanced(), *(row for case in CASES for row in _table_5(case)))
    return Reproduction(PAPER, CITATION, rows, tuple(_figure_10(case) for case in CASES))


def _table_2() -> Iterator[Row]:
    for n, published in TABLE_2.items():
        found = _search(n, "springs")
        note = _LIN_2012 if n == 5 else ""
        yield Row(PAPER, f"fewest springs for n = {n} (29)", str(n - 1), len(found.feasible[0].layout), note=note)
        yield from _same("Table 2", n, published, found)
    few = sum(i == 1 for i, _ in ((1, 3), (2, 3)))
    yield Row(PAPER, "ground springs of 13,23, Table 2; G3 in print: more than 1", "2", few, erratum=_G3)


def _table_3() -> Iterator[Row]:
    for n, published in TABLE_3.items():
        found = _search(n, "span")
        least = (n * n + n - 6) // 2
        yield Row(PAPER, f"smallest span for n = {n} (33)", str(least), span(found.feasible[0].layout))
        yield from _same("Table 3 and Fig. 8", n, published, found)
    yield Row(PAPER, "span of the third matrix for n = 5, Table 3", "12", span(THIRD), erratum=_THIRD)


_LIN_2012 = (
    "stiffnesses are free and links may share several springs; where stiffnesses are given and each pair of links has "
    "at most one spring, the paper says ceil(n(n-1)/4) = 5, after Lin et al. (2012)"
)
_G3 = (
    "'greater than' ceil((n-1)/2) has to read 'at least': the paper's own matrix for n = 3 has ceil(2/2) = 1, and an "
    "exact design"
)
_THIRD = (
    "the matrix, as far as it can be read 12,13,15,24,25,35,45, spans more than Eq. (33) says; without its rows 3 and "
    "4 it is 12,13,15,24,25, which spans 12 and is feasible"
)


def _same(table: str, n: int, published: tuple[str, ...], found: LayoutSearch) -> Iterator[Row]:
    """The layouts in print that the search finds, each exact by the certificate, and how many more it finds."""
    names = [name(one.layout) for one in found.feasible]
    both = [layout for layout in published if layout in names]
    more = [layout for layout in names if layout not in published]
    counts = (
        f"searched {found.candidates}: {sum(map(len, found.pruned.values()))} pruned by criteria, {len(found.proved)} "
        f"proved infeasible, {len(found.open)} open"
    )
    yield Row(PAPER, f"layouts for n = {n}, {table}", str(len(published)), len(both), note="; ".join((*both, counts)))
    if more:
        yield Row(PAPER, f"further layouts for n = {n}", None, len(more), note="; ".join(more))


@cache
def _search(n: int, objective: LayoutObjective) -> LayoutSearch:
    return search(n, objective)


def _unbalanced() -> Row:
    return Row(PAPER, "largest unbalanced torque, Table 4", None, check(arm()).unbalanced.max.max(), "N m")


def _table_5(case: Case) -> Iterator[Row]:
    where = f"Table 5({case.letter})"
    springs = completed(case)
    for s, (label, row) in enumerate(zip(labels(case.layout), case.rows, strict=True)):
        for which, letter, text in ((A, "a", row.a), (B, "b", row.b)):
            free = (s, which) in case.free
            yield Row(PAPER, f"{letter}^{label}, {where}", text, _length(springs[s], which), "m",
                      _spread(case, s, which), note="free" if free else "")  # fmt: skip
    failed = [*failures(case.layout, 4), *sign_failures(planar(), springs)]
    yield Row(PAPER, f"criteria that the springs fail, {where}", "0", len(failed))
    balance = check(printed(case))
    low, high = balance.total
    yield Row(
        PAPER, f"mean total energy, {where} as printed", case.energy, balance.constant, "J", _rounding(case), note=_MEAN
    )
    yield Row(PAPER, f"lowest total energy over all poses, {where} as printed", None, low, "J")
    yield Row(PAPER, f"highest total energy over all poses, {where} as printed", None, high, "J")
    yield Row(PAPER, f"largest residual torque, {where} as printed", None, balance.residual.max.max(), "N m",
              note="what the rounding of Table 5 leaves")  # fmt: skip
    yield Row(PAPER, f"total energy, {where} completed", case.energy, _mean(springs), "J",
              spread(lambda *x: _mean(completed(case, *x)), case.free_texts), note=_COMPLETED)  # fmt: skip
    exact = check(balanced(case))
    yield Row(PAPER, f"largest Fourier coefficient of the energy that varies, {where} completed", None,
              exact.certificate.max_coefficient or 0.0, "J", note="a proof of balance at every pose")  # fmt: skip
    if case.letter == "b":
        wrong = _with(tuple(replace(one, a=one.a - planar().lengths[one.i - 1]) if one.i > 1 else one
                            for one in springs))  # fmt: skip
        low, high = check(wrong).total
        yield Row(PAPER, f"variation of the total energy, {where} with a from the joint of link i", None, high - low,
                  "J", erratum=_DISTAL)  # fmt: skip


_MEAN = "over all poses, gravity counted from the first joint"
_COMPLETED = (
    "constant: from the printed stiffnesses and one or two printed lengths, the others by the design equations "
    "(39)-(43) or (49)-(54)"
)
_DISTAL = (
    "section 2 measures a 'from the joint' of link i; the blocks (7) and Table 5 hold only if that is the joint at its "
    "far end, to link i + 1"
)


def _spread(case: Case, s: int, which: int) -> float:
    """How far the rounding of the free lengths may move a length that follows from them."""
    free = (s, which) in case.free
    return 0.0 if free else spread(lambda *x: _length(completed(case, *x)[s], which), case.free_texts)


def _rounding(case: Case) -> float:
    """How far the rounding of Table 5 may move the mean energy."""

    def mean(*x: float) -> float:
        return _mean(tuple(row.installed(x[2 * s], x[2 * s + 1]) for s, row in enumerate(case.rows)))

    return spread(mean, [text for row in case.rows for text in (row.a, row.b)])


def _mean(springs: tuple[Installation, ...]) -> float:
    """[J] the mean energy over all poses: half the blocks on the diagonal, for the others average out."""
    K = StiffnessBlocks.total(planar(), springs).K.diagonal().real
    return float(0.5 * K @ planar().lengths ** 2)


def _along(row: Printed, which: int, value: float) -> float:
    """A length as `installing` counts it: along the link, the ground's upwards."""
    turn = 1j**row.alpha / upward(row.i) if which == A else 1j**row.beta
    return value * complex(turn).real


def _length(one: Installation, which: int) -> float:
    return float(abs(one.a if which == A else one.b))


def _with(springs: tuple[Installation, ...]) -> Mechanism:
    return arm().with_springs(planar().springs(springs))


def _figure_10(case: Case) -> Plot:
    state = Potential(balanced(case))(motion())
    poses = ", then ".join(f"({', '.join(f'{angle}' for angle in pose)})" for pose in POSES)
    return Plot(
        f"fig10{case.letter}",
        f"Lee and Chen (2014), Fig. 10({case.letter}): energies over the motion of section 8",
        "moves done",
        "energy [J]",
        TIMES,
        {"gravity": state.gravity, "springs": state.springs.sum(axis=1), "total": state.energy},
        note=f"joint angles {poses} deg; gravity counted from the first joint",
    )

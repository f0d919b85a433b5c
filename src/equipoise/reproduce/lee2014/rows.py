"""Everything that lee2014 prints, beside what the method finds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from ...balance import check
from ...energy.evaluate import Potential
from ...synthesis import design
from ...synthesis.planar.arm import Installation
from ...synthesis.planar.criteria import failures, sign_failures
from ...synthesis.planar.installing import A, B
from ...synthesis.planar.layouts import labels
from ...synthesis.planar.stiffness_blocks import StiffnessBlocks
from ..record import Plot, Reproduction, Row, proved, spread
from .arm import arm, balanced, completed, motion, planar, printed, with_springs
from .layouts import equivalent, fewest_springs, smallest_span
from .tables import CASES, POSES, TABLE_4, TIMES, Case

PAPER = "lee2014"
CITATION = (
    'Y.-Y. Lee, D.-Z. Chen, "Determination of spring installation configuration on statically balanced planar '
    'articulated manipulators", Mechanism and Machine Theory 74 (2014)'
)
G = 9.81  # [m/s^2]
LONGEST = 0.5  # [m]

# over all poses, by the certificate's series and by hand: mean, least and most energy [J] and residual [N m] of the
# rounded table, and the energy [J] of the completed one
GOLDEN = {"a": ("20.58", "20.52", "20.63", "0.0554", "20.557"), "b": ("27.24", "27.17", "27.29", "0.0502", "27.261")}


def reproduction() -> Reproduction:
    """Everything the paper prints."""
    cases = [partial(_table_5, case) for case in CASES]
    sections = (_blocks, equivalent, fewest_springs, smallest_span, _unbalanced, *cases, _distal_joint, _elongation)
    return Reproduction.of(PAPER, CITATION, sections, [partial(_figure_10, case) for case in CASES])


def _blocks() -> Iterator[Row]:
    """The stiffness blocks (7)-(8), (18), (34)."""
    gravity = StiffnessBlocks.gravity(planar())
    for j, weight in _weights().items():
        yield Row(PAPER, f"K_1{j} of gravity (34), over -I'", None, -gravity.block(1, j).imag, "N", golden=weight)
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (200, 3))
    r = np.column_stack([np.ones(200), np.exp(1j * np.cumsum(q, axis=1)) * planar().lengths[1:]])
    for case in CASES:
        state = Potential(printed(case))(q)
        springs = tuple(row.installed(float(row.a), float(row.b)) for row in case.rows)
        K = StiffnessBlocks.total(planar(), springs).K
        energy = 0.5 * np.einsum("ni,ij,nj->n", r.conj(), K, r).real
        off = float(np.abs(energy - state.energy).max()) / float(np.ptp(state.gravity))
        yield Row(
            PAPER,
            f"energy by the blocks (22) against the mechanism's, Table 5({case.letter}), over gravity's",
            None,
            off,
            golden="<= 1e-12",
        )


def _weights() -> dict[int, float]:
    """(34a-c) without I' [N]."""
    (m2, r2, s2), (m3, r3, s3), (m4, r4, s4) = (TABLE_4[j] for j in (2, 3, 4))
    return {2: (s2 / r2 * m2 + m3 + m4) * G, 3: (s3 / r3 * m3 + m4) * G, 4: s4 / r4 * m4 * G}


def _by_hand(case: Case) -> list[tuple[float, float]]:
    """(a, b) [m] of each spring of Table 5 by (39)-(43) or (49)-(54), one after the other."""
    r2, r3, r4 = (TABLE_4[j][1] for j in (2, 3, 4))
    W2, W3, W4 = _weights().values()
    k = [float(row.stiffness) for row in case.rows]
    if case.letter == "a":
        b14 = float(case.rows[1].b)
        b142, b13 = k[1] * b14 / k[2], (k[1] + k[2]) * r3 / k[0]  # (43), (42)
        A = [[k[0], k[1], k[2]], [-k[0] * b13 / r3, k[1], k[2]], [0, k[1] * b14 / r4, -k[2] * b142 / r4]]
        a13, a141, a142 = np.linalg.solve(A, [W2, W3, W4]).tolist()  # (39)-(41)
        return [(a13, b13), (a141, b14), (a142, b142)]
    b12, a34 = float(case.rows[0].b), float(case.rows[3].a)
    a14 = W3 / k[1]  # (50)
    b14 = W4 * r4 / (k[1] * a14)  # (51)
    a24 = k[1] * r2 / k[2]  # (52)
    b24 = k[1] * b14 * r2 / (k[2] * a24)  # (53)
    b34 = (k[1] * b14 + k[2] * b24) * r3 / (k[3] * a34)  # (54)
    return [((W2 - W3) * r2 / (k[0] * b12), b12), (a14, b14), (a24, b24), (a34, b34)]  # the first by (49)


def _unbalanced() -> Iterator[Row]:
    """The arm without springs, Table 4."""
    largest = sum(TABLE_4[j][1] * weight for j, weight in _weights().items())  # stretched out, level
    yield Row(PAPER, "largest unbalanced torque, Table 4", None, float(check(arm()).unbalanced.max.max()), "N m",
              golden=f"{largest:.4f}")  # fmt: skip


def _table_5(case: Case) -> Iterator[Row]:
    """The springs of Table 5 and the energies of Fig. 10."""
    where = f"Table 5({case.letter})"
    springs = completed(case)
    named = zip(labels(case.layout), case.rows, springs, _by_hand(case), strict=True)
    for s, (label, row, spring, hand) in enumerate(named):
        yield Row(PAPER, f"k^{label}, {where}", f"{row.stiffness:g}", spring.stiffness, "N/m", exact=True)
        for which, letter, text, true in ((A, "a", row.a, hand[0]), (B, "b", row.b, hand[1])):
            free = (s, which) in case.free
            yield Row(PAPER, f"{letter}^{label}, {where}", text, _length(spring, which), "m", _spread(case, s, which),
                      exact=free, golden=true, note="free" if free else "")  # fmt: skip
    failed = [*failures(case.layout, 4), *sign_failures(planar(), springs)]
    yield Row(PAPER, f"criteria that the springs fail, {where}", "0", len(failed), exact=True)
    balance = check(printed(case))
    low, high = balance.total
    mean, least, most, residual, complete = GOLDEN[case.letter]
    yield Row(PAPER, f"mean total energy, {where} as printed", case.energy, balance.constant, "J", _rounding(case),
              golden=mean, note=_MEAN)  # fmt: skip
    yield Row(PAPER, f"lowest total energy over all poses, {where} as printed", None, low, "J", golden=least)
    yield Row(PAPER, f"highest total energy over all poses, {where} as printed", None, high, "J", golden=most)
    yield Row(PAPER, f"largest residual torque, {where} as printed", None, float(balance.residual.max.max()), "N m",
              golden=residual, note="what the rounding of Table 5 leaves")  # fmt: skip
    yield Row(
        PAPER,
        f"total energy, {where} completed",
        case.energy,
        _mean(springs),
        "J",
        spread(lambda *x: _mean(completed(case, *x)), case.free_texts),
        golden=complete,
        note=_COMPLETED,
    )
    state = Potential(balanced(case))(motion())
    yield Row(PAPER, f"total energy over the motion of Fig. 10({case.letter}), completed: largest less smallest", "0",
              float(np.ptp(state.energy)), "J", exact=True)  # fmt: skip
    yield Row(PAPER, f"mean total energy over the motion of Fig. 10({case.letter}), completed", case.energy,
              float(state.energy.mean()), "J", spread(lambda *x: _mean(completed(case, *x)), case.free_texts),
              golden=complete)  # fmt: skip
    yield proved(PAPER, f"{where} completed", check(balanced(case)), "0")


def _distal_joint() -> Iterator[Row]:
    """From where a is measured, section 2."""
    case = CASES[1]
    springs = completed(case)
    wrong = with_springs(tuple(
        replace(one, a=one.a - planar().lengths[one.i - 1]) if one.i > 1 else one for one in springs
    ))  # fmt: skip
    low, high = check(wrong).total
    yield Row(
        PAPER,
        "variation of the total energy, Table 5(b) with a from the joint of link i",
        "0",
        high - low,
        "J",
        exact=True,
        golden="26.20",
        against="erratum",
        why=_DISTAL,
        proof=check(balanced(case)).exact,
    )


def _elongation() -> Iterator[Row]:
    """A limit on the springs' elongation, section 8."""
    found = design(arm(), "planar", longest=LONGEST).balance
    longest = max(use.path[1] for use in found.use)
    yield Row(PAPER, f"longest spring of 13,14,24 where {LONGEST:g} m are allowed", None, longest, "m",
              golden=f"<= {LONGEST:g}")  # fmt: skip
    yield proved(PAPER, f"13,14,24 with springs of at most {LONGEST:g} m", found)


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


def _length(one: Installation, which: int) -> float:
    return float(abs(one.a if which == A else one.b))


def _figure_10(case: Case) -> Iterator[Plot]:
    """Fig. 10."""
    state = Potential(balanced(case))(motion())
    poses = ", then ".join(f"({', '.join(f'{angle}' for angle in pose)})" for pose in POSES)
    yield Plot(
        f"fig10{case.letter}",
        f"Lee and Chen (2014), Fig. 10({case.letter}): energies over the motion of section 8",
        "moves done",
        "energy [J]",
        TIMES,
        {"gravity": state.gravity, "springs": state.springs.sum(axis=1), "total": state.energy},
        note=f"joint angles {poses} deg; gravity counted from the first joint",
    )

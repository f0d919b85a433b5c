"""P.-Y. Lin, W.-B. Shieh and D.-Z. Chen, "Design of a gravity-balanced general spatial serial-type manipulator".

J. Mechanisms Robotics 2 (2010): the industrial arm of Sec. 6, balanced by the method `pseudobase`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from math import pi

import numpy as np
from numpy.polynomial import Polynomial

from ..balance import check
from ..energy.evaluate import Potential
from ..energy.reference import State
from ..io.dh import expand
from ..io.schema import DhRow, DhTable
from ..kinematics import Tree
from ..kinematics.motion import CubicMove, follow
from ..model.arrays import Array
from ..model.elements import lines
from ..model.mechanism import Body, Mechanism
from ..synthesis import Design, design
from ..synthesis.arms.moments import Lump, Moment, Segment, moments, segments
from ..synthesis.pseudobase.parallelograms import mobility
from .record import Plot, Reproduction, Row, spread, vector

PAPER = "lin2010"
CITATION = (
    'P.-Y. Lin, W.-B. Shieh, D.-Z. Chen, "Design of a Gravity-Balanced General Spatial Serial-Type Manipulator", '
    "Journal of Mechanisms and Robotics 2 (2010), doi 10.1115/1.4001816"
)

Printed = tuple[str, str, str]

# Table 1: d [m], a [m], alpha; auxiliary link 1 is 0.1 m above link 1, the others lie along theirs.
TABLE_1 = {
    1: (0.0, 0.1, pi / 2),
    2: (0.0, 0.4, 0.0),
    3: (0.0, 0.0, pi / 2),
    4: (0.5, 0.0, -pi / 2),
    5: (0.0, 0.0, pi / 2),
    6: (0.27, 0.0, 0.0),
}
HEIGHT = 0.1  # [m] d of frame 1^ less that of frame 1


@dataclass(frozen=True)
class Link:
    """A row of Table 2: masses [kg] and points in frame i [m], as printed; a number without a point is exact.

    Where such a number is a result, the zero of sigma_i.x, it is written here with the digits of its row.
    """

    m: str
    m_base: str  # of the pseudobase
    m_hat: str  # of the auxiliary link
    s: Printed
    s_hat: Printed
    c: Printed
    mu: str
    sigma: Printed


TABLE_2 = {
    2: Link("23.21", "0.47", "2.38", ("-0.20", "0.00", "-0.1"), ("-0.17", "0.07", "0.06"), ("-0.3", "0.1", "-0.1"),
            "105.92", ("0.25", "0.00", "-0.02")),
    3: Link("24.51", "0.47", "0.81", ("0", "0", "0"), ("0", "0.02", "0.10"), ("0", "0.06", "0.09"),
            "79.59", ("0.00", "0.00", "0.00")),
    4: Link("15.13", "0.47", "1.58", ("0", "0.16", "0.00"), ("0", "0.13", "0.00"), ("0", "0.21", "0.06"),
            "45.21", ("0.00", "-0.25", "0.00")),
    5: Link("6.12", "0.47", "1.32", ("0", "0.02", "0.11"), ("0", "0.01", "0.09"), ("0", "-0.1", "0.1"),
            "18.76", ("0.00", "0.00", "0.05")),
    6: Link("2.20", "0.47", "0.27", ("0", "0.00", "-0.02"), ("0", "-0.02", "-0.08"), ("0", "-0.06", "-0.06"),
            "5.88", ("0.00", "-0.01", "0.12")),
}  # fmt: skip


@dataclass(frozen=True)
class Balancer:
    """A row of Table 3: K [N/m] and l_CA [m] are chosen, l_CB [m] and the ends in frame i [m] follow."""

    K: float
    l_CA: float
    l_CB: str
    a: Printed
    b: Printed


TABLE_3 = {
    2: Balancer(20e3, 0.1, "0.13", ("-0.2", "0.1", "-0.1"), ("-0.17", "0.10", "-0.11")),
    3: Balancer(2e3, 0.08, "0.01", ("0.08", "0.06", "0.09"), ("0.00", "0.06", "0.09")),
    4: Balancer(15e3, 0.08, "0.09", ("0.08", "0.21", "0.06"), ("0.00", "0.12", "0.06")),
    5: Balancer(2e3, 0.08, "0.05", ("0.08", "-0.1", "0.1"), ("0.00", "-0.09", "0.15")),
    6: Balancer(1e3, 0.08, "0.09", ("0.08", "-0.06", "-0.06"), ("0.00", "-0.06", "0.03")),
}

# Table 4: t_I, t_F [s], theta_I, theta_F [rad], and the coefficients of the cubic as printed
TABLE_4 = {
    1: (0, 5, 1.57, -0.42, ("1.57", "0.0000", "-0.2388", "0.0318")),
    2: (0, 5, 1.57, 0.57, ("1.57", "0.0000", "-0.12", "0.016")),
    3: (0, 5, 0, 1, ("0", "0", "0.12", "-0.016")),
    4: (1, 3, 0, 1, ("1", "-2.25", "1.5", "-0.25")),
    5: (5, 9, 0, 1.2, ("10.3125", "-5.0625", "0.7875", "-0.0375")),
    6: (5, 9, 0, 2.5, ("21.4844", "-10.5429", "1.6406", "-0.0781")),
}
UNFOLDED = {2: 2.8, 3: -0.85, 4: -2.5, 5: 0.8, 6: 2.7}  # [rad] a pose in which no module is nearly folded
SWING = 0.3  # [rad] either way
TIMES = np.linspace(0, 10, 1001)  # [s]


def arm() -> Mechanism:
    """The bare arm: Tables 1 and 2. The mass of link 1, which no height depends on, is not printed."""
    bodies = [Body("link 1")]
    bodies += [Body(f"link {i}", float(row.m), _point(row.s)) for i, row in TABLE_2.items()]
    rows = [DhRow(name=f"joint {i}", a=a, alpha=alpha, d=d, theta=0.0) for i, (d, a, alpha) in TABLE_1.items()]
    all_bodies, joints = expand(DhTable(convention="standard", rows=rows), bodies)
    return Mechanism("industrial arm", tuple(body for body, _ in all_bodies), tuple(joint for joint, _ in joints))


@cache
def balanced(real: bool = False) -> Design:
    """The arm balanced by the method, with the masses of Table 2 and the K and l_CA of Table 3.

    Args:
        real: with the joints of Fig. 3, ball joints and all, over ranges in which no module folds.
    """
    bare = arm()
    if real:
        ranges = {f"joint {i}": (q - SWING, q + SWING) for i, q in UNFOLDED.items()}
        joints = (replace(joint, range=ranges.get(joint.name)) for joint in bare.joints)
        bare = replace(bare, joints=tuple(joints))
    return design(
        bare,
        "pseudobase",
        height=HEIGHT,
        stiffness={f"link {i}": row.K for i, row in TABLE_3.items()},
        l_CA={f"link {i}": row.l_CA for i, row in TABLE_3.items()},
        centre={f"link {i}": _point(row.c) for i, row in TABLE_2.items()},
        auxiliary_mass={f"link {i}": float(row.m_hat) for i, row in TABLE_2.items()},
        auxiliary_com={f"link {i}": _point(row.s_hat) for i, row in TABLE_2.items()},
        pseudobase={f"link {i}": float(row.m_base) for i, row in TABLE_2.items()},
        planar=(),  # the paper's modules are all RSSR
        real=real,
    )


def motion() -> Array:
    """(T, 6) the joint angles of Eq. (26) at `TIMES` [rad]."""
    return follow(arm().coordinates, moves().values(), TIMES)


def moves() -> dict[int, CubicMove]:
    """The moves of Table 4."""
    return {i: CubicMove(f"joint {i}", *row[:4]) for i, row in TABLE_4.items()}


def reproduction() -> Reproduction:
    """Everything the paper prints."""
    rows = (*_mobility(), *_table_2(), *_table_3(), *_table_4(), *_energies())
    return Reproduction(PAPER, CITATION, rows, (_figure_9(),))


def _point(printed: Printed) -> tuple[float, float, float]:
    x, y, z = map(float, printed)
    return x, y, z


def _mobility() -> Iterator[Row]:
    note = "one active freedom and one idle, the spin of the coupler, for each module"
    yield Row(PAPER, "Eq. (19), freedoms of one RSSR module", "2", sum(mobility(1, 1)), note=note)
    yield Row(PAPER, "Eq. (20), freedoms of an arm with n = 6, 2n", "12", sum(mobility(6, 6)), note=note)
    found = balanced().free_parameters["mobility"]
    note = "link 1 turns about the vertical and needs no module; those of links 2 and 3 could be planar four-bars"
    yield Row(PAPER, "active freedoms of the arm of Fig. 8", "6", found["active"])
    yield Row(PAPER, "idle freedoms of the arm of Fig. 8", None, found["idle"], note=note)


def _table_2() -> Iterator[Row]:
    printed = _numbers()
    for i, row in TABLE_2.items():
        item = f"mu_{i} (24), Table 2"
        note = "within what the rounding of the printed masses allows" if row.mu in ("105.92", "79.59") else ""
        yield Row(PAPER, item, row.mu, _moment(i, *map(float, printed)).mass, "kg",
                  _spread(lambda *x, i=i: _moment(i, *x).mass), note=note)  # fmt: skip
    for i, row in TABLE_2.items():
        for axis, text in enumerate(row.sigma):
            yield Row(PAPER, f"sigma_{i}.{'xyz'[axis]} (25), Table 2", text, _sigma(i, axis, *map(float, printed)), "m",
                      _spread(lambda *x, i=i, axis=axis: _sigma(i, axis, *x)))  # fmt: skip


def _table_3() -> Iterator[Row]:
    found = balanced().mechanism
    springs = {spring.name: spring for spring in lines(found, "the paper")}
    tree = Tree.of(found)
    start = tree.poses(motion()[:1])
    pose = (
        "in frame i at the initial pose of Table 4, where x_i points up: the only pose at which the printed one holds"
    )
    for i, row in TABLE_3.items():
        spring = springs[f"link {i} spring"]
        C = np.array(_point(TABLE_2[i].c))
        l_CB = float(np.linalg.norm(np.array(spring.p_b) - C))
        yield Row(PAPER, f"l_CB,{i} (16), Table 3", row.l_CB, l_CB, "m")
        body, base = tree.index[spring.body_b], tree.index[spring.body_a]
        A = start.point(base, np.array(spring.p_a)) - start.p[:, body]
        yield from vector(PAPER, f"a_{i} (13), Table 3", row.a, A[0] @ start.R[0, body], unit="m", note=pose)
        for end in vector(PAPER, f"b_{i} (14), Table 3", row.b, spring.p_b, unit="m"):
            same = i == 3 and end.verdict == "differs"
            yield Row(**{**vars(end), "erratum": _B_3 if same else ""})


_B_3 = (
    "the printed b_3 is c_3, as if from the sigma_3 in print, which is zero; but the printed l_CB,3 is not, so B_3 is "
    "not C_3"
)


def _table_4() -> Iterator[Row]:
    for i, (first, last, start, end, printed) in TABLE_4.items():
        s = Polynomial([-first, 1]) / (last - first)
        cubic = start + (end - start) * s**2 * (3 - 2 * s)
        for power, (text, value) in enumerate(zip(printed, cubic.coef, strict=True)):
            row = Row(
                PAPER, f"a_{power} of joint {i} (26), Table 4", text, float(value), f"rad/s^{power}" if power else "rad"
            )
            if (i, power) == (6, 1):
                left = sum(float(a) * first**n for n, a in enumerate(printed))
                note = f"misprint of -10.5469: with -10.5429 the move starts at {left:.4f} rad, not at 0"
                row = Row(**{**vars(row), "erratum": note})
            yield row


def _energies() -> Iterator[Row]:
    exact = _over_motion(balanced().mechanism)
    gravity, springs, total = exact.gravity, exact.springs.sum(axis=1), exact.energy
    yield Row(
        PAPER, "gravity's energy over the motion, largest less smallest, Fig. 9", None, float(np.ptp(gravity)), "J"
    )
    yield Row(PAPER, "the springs' energy over the motion, largest less smallest, Fig. 9", None, float(np.ptp(springs)),
              "J", note="the mirror image of gravity's")  # fmt: skip
    yield Row(PAPER, "total energy, Fig. 9", None, float(total.mean()), "J", note="gravity counted from O_0")
    yield Row(PAPER, "variation of the total energy over the motion, as a share of gravity's, Fig. 9", None,
              float(np.ptp(total) / np.ptp(gravity)), note="constant, with computed values")  # fmt: skip
    certificate = balanced().balance.certificate
    yield Row(PAPER, "largest Fourier coefficient of the energy that varies", None, certificate.max_coefficient or 0.0,
              "J", note="a proof of balance at every configuration")  # fmt: skip
    found = balanced().mechanism
    without = found.with_springs(spring for spring in found.springs if spring.name != "link 3 spring")
    rounded = found.with_springs(
        spring.changed(p_b=_point(row.b)) for spring, row in zip(found.springs, TABLE_3.values(), strict=True)
    )
    over = "variation of the total energy over all poses"
    yield Row(PAPER, f"{over}, without spring 3", None, _variation(without), "J", erratum=_SIGMA_3)
    yield Row(PAPER, f"{over}, with the b of Table 3", None, _variation(rounded), "J", note=_ROUNDED)


_SIGMA_3 = (
    "sigma_3 is zero in print, and a link whose moment is zero needs no spring; but the true one is not, and without "
    "its spring the energy varies (not over the motion of Eq. (26), which keeps theta_2 + theta_3 constant)"
)
_ROUNDED = "what the rounding of the printed ends leaves, b_3 = c_3 among them"


def _variation(mechanism: Mechanism) -> float:
    low, high = check(mechanism).total
    return high - low


def _over_motion(mechanism: Mechanism) -> State:
    return Potential(mechanism)(motion())


def _figure_9() -> Plot:
    state = _over_motion(balanced().mechanism)
    return Plot(
        "fig9",
        "Lin, Shieh and Chen (2010), Fig. 9: energies over the motion of Eq. (26)",
        "time [s]",
        "energy [J]",
        TIMES,
        {"gravity": state.gravity, "springs": state.springs.sum(axis=1), "total": state.energy},
        note="gravity counted from O_0",
    )


# Table 2 as one list of printed numbers: how its rounding moves mu and sigma. Points C_i are chosen, hence exact.


def _numbers() -> list[str]:
    """The masses and mass centres of Table 2; see `_moment`."""
    return [text for row in TABLE_2.values() for text in (row.m, row.m_base, row.m_hat, *row.s, *row.s_hat)]


def _spread(f: Callable[..., float]) -> float:
    """`spread` of a function of `_numbers` over those of them that are rounded."""
    texts = _numbers()
    rounded = [n for n, text in enumerate(texts) if "." in text]

    def of_rounded(*x: float) -> float:
        numbers = [float(text) for text in texts]
        for n, value in zip(rounded, x, strict=True):
            numbers[n] = value
        return f(*numbers)

    return spread(of_rounded, [texts[n] for n in rounded])


def _moment(i: int, *numbers: float) -> Moment:
    """mu_i and sigma_i by (24)-(25) of the numbers of Table 2, in the order of `_numbers`."""
    per_link = np.reshape(numbers, (len(TABLE_2), 9))
    lumps: dict[int, list[Lump]] = {}
    for (number, row), (m, m_base, m_hat, *points) in zip(TABLE_2.items(), per_link, strict=True):
        origin = _skeleton()[number].origin
        masses = ((m, np.array(points[:3])), (m_hat, np.array(points[3:])), (m_base, np.array(_point(row.c))))
        lumps[number] = [(mass, p - origin) for mass, p in masses]
    return moments(_skeleton(), lumps)[i]


def _sigma(i: int, axis: int, *numbers: float) -> float:
    return float(_moment(i, *numbers).position[axis])


@cache
def _skeleton() -> tuple[Segment, ...]:
    """The links of the arm without their masses: number 0 is the ground, number i is link i."""
    return tuple(replace(link, lumps=()) for link in segments(arm()))

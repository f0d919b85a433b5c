"""Everything that lin2010 prints, beside what the method finds."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache

import numpy as np
from numpy.polynomial import Polynomial

from ...balance import check
from ...energy.evaluate import Potential
from ...energy.reference import State
from ...kinematics import Tree
from ...model.elements import lines
from ...model.mechanism import Mechanism
from ...synthesis.arms.moments import Lump, Moment, Segment, moments, segments
from ...synthesis.pseudobase.parallelograms import mobility
from ..record import Plot, Reproduction, Row, proved, spread, vector
from .arm import TIMES, arm, balanced, motion
from .folds import folds
from .tables import PAPER, TABLE_2, TABLE_3, TABLE_4, point

CITATION = (
    'P.-Y. Lin, W.-B. Shieh, D.-Z. Chen, "Design of a Gravity-Balanced General Spatial Serial-Type Manipulator", '
    "Journal of Mechanisms and Robotics 2 (2010), doi 10.1115/1.4001816"
)
G = 9.81  # [m/s^2]

# recomputed from Table 2 in a second way: mu [kg], sigma [m], l_CB [m]
GOLDEN = {
    2: ("105.94", ("0.2526", "0.0020", "-0.0210"), "0.13174"),
    3: ("79.61", ("0.0000", "0.0006", "0.0015"), "0.00804"),
    4: ("45.21", ("0.0000", "-0.2497", "0.0006"), "0.09230"),
    5: ("18.76", ("0.0000", "0.0047", "0.0447"), "0.05173"),
    6: ("5.88", ("0.0000", "-0.0057", "0.1190"), "0.08594"),
}


def reproduction() -> Reproduction:
    """Everything the paper prints."""
    sections = (_mobility, _bare_moments, _table_2, _table_3, _table_4, _energies, _spring_3, folds)
    return Reproduction.of(PAPER, CITATION, sections, (_figure_9,))


def _mobility() -> Iterator[Row]:
    """The freedoms (19)-(20)."""
    note = "one active freedom and one idle, the spin of the coupler, for each module"
    yield Row(PAPER, "Eq. (19), freedoms of one RSSR module", "2", sum(mobility(1, 1)), exact=True, note=note)
    yield Row(PAPER, "Eq. (20), freedoms of an arm with n = 6, 2n", "12", sum(mobility(6, 6)), exact=True, note=note)
    found = balanced().free_parameters["mobility"]
    note = "link 1 turns about the vertical and needs no module; those of links 2 and 3 could be planar four-bars"
    yield Row(PAPER, "active freedoms of the arm of Fig. 8", "6", found["active"], exact=True)
    yield Row(PAPER, "idle freedoms of the arm of Fig. 8", None, found["idle"], golden=5.0, note=note)


def _bare_moments() -> Iterator[Row]:
    """The moments of the arm alone (7)-(8)."""
    bare = moments(segments(arm()))
    masses = {i: float(row.m) for i, row in TABLE_2.items()}
    ends = {i: np.array(segment.tip) for i, segment in enumerate(segments(arm()))}
    for i, row in TABLE_2.items():
        beyond = sum(m for j, m in masses.items() if j > i)
        yield Row(
            PAPER, f"mu_{i} (7), without auxiliary links", None, bare[i].mass, "kg", golden=2 * masses[i] + beyond
        )
        own = np.array(point(row.s)) - _skeleton()[i].origin
        true = masses[i] * own + beyond * (ends[i + 1] if i + 1 in ends else np.zeros(3))
        left = float(np.abs(bare[i].vector - true).max())
        yield Row(
            PAPER, f"mu_{i} sigma_{i} (8) against its sum, largest component", None, left, "kg m", golden="<= 1e-12"
        )


def _table_2() -> Iterator[Row]:
    """mu and sigma (24)-(25), Table 2."""
    printed = _numbers()
    for i, row in TABLE_2.items():
        yield Row(PAPER, f"mu_{i} (24), Table 2", row.mu, _moment(i, *map(float, printed)).mass, "kg",
                  _spread(lambda *x, i=i: _moment(i, *x).mass), golden=GOLDEN[i][0])  # fmt: skip
    for i, row in TABLE_2.items():
        for axis, (text, golden) in enumerate(zip(row.sigma, GOLDEN[i][1], strict=True)):
            yield Row(PAPER, f"sigma_{i}.{'xyz'[axis]} (25), Table 2", text, _sigma(i, axis, *map(float, printed)), "m",
                      _spread(lambda *x, i=i, axis=axis: _sigma(i, axis, *x)), golden=golden)  # fmt: skip


def _table_3() -> Iterator[Row]:
    """The springs and where they end (13)-(16), Table 3."""
    found = balanced().mechanism
    springs = {spring.name: spring for spring in lines(found, "the paper")}
    tree = Tree.of(found)
    upright = tree.poses(np.rint(motion()[:1] / (np.pi / 2)) * np.pi / 2)
    pose = "in frame i where x_i points up, as at the initial pose of Table 4: the only pose at which the print holds"
    for i, row in TABLE_3.items():
        spring = springs[f"link {i} spring"]
        C = np.array(point(TABLE_2[i].c))
        l_CA, l_CB = float(np.linalg.norm(spring.p_a)), float(np.linalg.norm(np.array(spring.p_b) - C))
        moment = _moment(i, *map(float, _numbers()))
        yield Row(PAPER, f"K_{i}, Table 3", f"{row.K / 1e3:g}", spring.stiffness / 1e3, "kN/m", exact=True)
        yield Row(PAPER, f"l_CA,{i}, Table 3", f"{row.l_CA:g}", l_CA, "m", exact=True)
        yield Row(PAPER, f"l_CB,{i} (16), Table 3", row.l_CB, l_CB, "m", golden=GOLDEN[i][2])
        yield Row(PAPER, f"K l_CA l_CB over mu g |sigma| of link {i} (16)", "1",
                  spring.stiffness * l_CA * l_CB / (G * float(np.linalg.norm(moment.vector))), exact=True)  # fmt: skip
        body, base = tree.index[spring.body_b], tree.index[spring.body_a]
        A = upright.point(base, np.array(spring.p_a)) - upright.p[:, body]
        yield from vector(
            PAPER, f"a_{i} (13), Table 3", row.a, A[0] @ upright.R[0, body], unit="m", exact=True, note=pose
        )
        for end in vector(PAPER, f"b_{i} (14), Table 3", row.b, spring.p_b, unit="m"):
            yield (
                end
                if end.item != "b_3 (14), Table 3.z"
                else replace(end, golden="0.09756", against="erratum", why=_B_3, proof=_wrong_b_3())
            )


_B_3 = (
    "the printed b_3 is c_3, as if from the sigma_3 in print, which is zero; but the printed l_CB,3 is not, so B_3 is "
    "not C_3, and a spring that ends at C_3 does nothing: without it the energy varies"
)


def _wrong_b_3() -> bool:
    """Whether the printed b_3 contradicts the printed l_CB,3, and a spring that ends there does not balance."""
    same = [*map(float, TABLE_3[3].b)] == [*map(float, TABLE_2[3].c)]
    return same and float(TABLE_3[3].l_CB) > 0 and _variation(_without_spring_3()) > 1


def _without_spring_3() -> Mechanism:
    found = balanced().mechanism
    return found.with_springs(spring for spring in found.springs if spring.name != "link 3 spring")


def _table_4() -> Iterator[Row]:
    """The cubics of the motion (26), Table 4."""
    for i, (first, last, start, end, printed) in TABLE_4.items():
        s = Polynomial([-first, 1]) / (last - first)
        cubic = start + (end - start) * s**2 * (3 - 2 * s)
        for power, (text, value) in enumerate(zip(printed, cubic.coef, strict=True)):
            unit = f"rad/s^{power}" if power else "rad"
            row = Row(PAPER, f"a_{power} of joint {i} (26), Table 4", text, float(value), unit, exact="." not in text)
            if (i, power) == (6, 1):
                left = sum(float(a) * first**n for n, a in enumerate(printed))
                why = f"misprint of -10.5469: with -10.5429 the move starts at {left:.4f} rad, not at {start:g}"
                row = replace(row, golden="-10.546875", against="erratum", why=why, proof=abs(left - start) > 0.01)
            yield row
        moving = (first <= TIMES) & (last > TIMES)
        off = float(np.abs(motion()[moving, i - 1] - cubic(TIMES[moving])).max())
        yield Row(
            PAPER, f"motion of joint {i} against its cubic, largest difference", None, off, "rad", golden="<= 1e-12"
        )


def _energies() -> Iterator[Row]:
    """The energies over the motion, Fig. 9."""
    exact = _over_motion(balanced().mechanism)
    gravity, springs, total = exact.gravity, exact.springs.sum(axis=1), exact.energy
    size = float(np.ptp(gravity))
    yield Row(
        PAPER, "gravity's energy over the motion, largest less smallest, Fig. 9", None, size, "J", golden="119.805"
    )
    mirrored = float(np.corrcoef(gravity, springs)[0, 1])
    yield Row(
        PAPER,
        "correlation of the springs' energy with gravity's, its mirror image in Fig. 9",
        "-1",
        mirrored,
        exact=True,
    )
    yield Row(
        PAPER,
        "the springs' energy over gravity's, largest less smallest, Fig. 9",
        "1",
        float(np.ptp(springs)) / size,
        exact=True,
    )
    yield Row(PAPER, "total energy, Fig. 9", None, float(total.mean()), "J", golden="415.260",
              note="gravity counted from O_0")  # fmt: skip
    yield Row(PAPER, "variation of the total energy over the motion, as a share of gravity's, Fig. 9", "0",
              float(np.ptp(total)) / size, exact=True, golden="<= 1e-12")  # fmt: skip
    yield proved(PAPER, "Sec. 6", balanced().balance, "0")


def _spring_3() -> Iterator[Row]:
    """What the rounding of sigma_3 and b would do."""
    over = "variation of the total energy over all poses"
    found = balanced().mechanism
    rounded = found.with_springs(
        spring.changed(p_b=point(row.b)) for spring, row in zip(found.springs, TABLE_3.values(), strict=True)
    )
    across = 0.81 * 0.10 + 0.47 * 0.09  # [kg m] of links 3 and 3^ across joint 3: the rest of sigma_3 stays level
    yield Row(
        PAPER,
        f"{over}, without spring 3",
        None,
        _variation(_without_spring_3()),
        "J",
        golden=f"{2 * G * across:.4f}",
        note=_SIGMA_3,
    )
    yield Row(PAPER, f"{over}, with the b of Table 3", None, _variation(rounded), "J", golden="15.29", note=_ROUNDED)


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


def _figure_9() -> Iterator[Plot]:
    """Fig. 9."""
    state = _over_motion(balanced().mechanism)
    yield Plot(
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
        masses = ((m, np.array(points[:3])), (m_hat, np.array(points[3:])), (m_base, np.array(point(row.c))))
        lumps[number] = [(mass, p - origin) for mass, p in masses]
    return moments(_skeleton(), lumps)[i]


def _sigma(i: int, axis: int, *numbers: float) -> float:
    return float(_moment(i, *numbers).position[axis])


@cache
def _skeleton() -> tuple[Segment, ...]:
    """The links of the arm without their masses: number 0 is the ground, number i is link i."""
    return tuple(replace(link, lumps=()) for link in segments(arm()))

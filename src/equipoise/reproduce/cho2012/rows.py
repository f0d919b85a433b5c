"""Everything that cho2012 prints, beside what the method finds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import cos, pi, sin, sqrt

import numpy as np

from ...balance import check
from ...energy.certificate import fourier_form
from ...energy.evaluate import Potential
from ...kinematics import Tree
from ...model.elements import lines
from ...model.errors import InfeasibleError
from ...model.mechanism import Mechanism
from ...synthesis import design
from ...synthesis.bevel.differential import (
    ARRANGEMENTS,
    SIDES,
    balanced_spring_energy,
    balanced_spring_torque,
    differential,
    gravity_energy,
    gravity_torque,
    single_stiffness,
    spring_energy,
    spring_torque,
    stiffness,
    stretch_squared,
)
from ..record import Reproduction, Row, half_unit, proved, spread
from .figures import figures, maps
from .shoulder import GRID, JOINTS, SOFT, TABLE_1, B, G, H, L, M, arm, balanced, scaled

PAPER = "cho2012"
CITATION = (
    'C. Cho, W. Lee, J. Lee, S. Kang, "A 2-dof gravity compensator with bevel gears", '
    "Journal of Mechanical Science and Technology 26 (2012)"
)
K = "1.59"  # [kN/m] as printed
PRINTED_2J = {"near": (("-1", "-1"), ("1", "-1")), "far": (("1", "-1"), ("-1", "-1"))}  # (11) and below
RATIOS = {0.5: "0.84368", 2.0: 1.0}  # of gears, the paper's is 1 -> the exact share of the torque that is left
NODES = 64  # of the quadrature over each joint's range


def reproduction() -> Reproduction:
    """Everything the paper prints."""
    sections = (_differential, _stiffness, _ends, _closed_forms, _constant, _table_1, _errors, _ratios)
    return Reproduction.of(PAPER, CITATION, sections, (figures, maps))


def _weight() -> float:
    return float(M) * G * float(L)


def _true_stiffness() -> float:
    """k = m g l / (2 b h) [N/m] of the printed data."""
    return _weight() / (2 * float(B) * float(H))


def _differential() -> Iterator[Row]:
    """How the disks turn (11)."""
    for arrangement in ARRANGEMENTS:
        m = balanced(arrangement).mechanism
        tree = Tree.of(m)
        links = {link.joint.name: link for link in tree.links}
        for i, side in enumerate(SIDES):
            found = tree.C[links[f"{side} disk"].motions[0].row]
            for j, printed in enumerate(PRINTED_2J[arrangement][i]):
                item = f"2J.{i + 1}{j + 1} (11), fixed gear {arrangement}"
                yield Row(PAPER, item, printed, float(found[j]), exact=True)


def _stiffness() -> Iterator[Row]:
    """The stiffness (7), (23)."""
    k = balanced().mechanism.springs[0].strength[0]

    def of(m: float, l: float, b: float, h: float) -> float:  # noqa: E741  # the paper's letters
        return stiffness(m * G * l, b, h) / 1e3

    inputs = (M, L, B, H)
    low, high = (1e3 * float(K) / k * G + sign * 1e3 * half_unit(K) / k * G for sign in (-1, 1))
    other = float(M) - half_unit(M)
    note = (
        f"the rounding of the printed m, l, b, h moves k by up to {spread(of, inputs):.2g} kN/m: m = {other:.2f} kg "
        f"would give {of(other, *map(float, inputs[1:])):.3f}; g would have to be {low:.2f} to {high:.2f} m/s^2"
    )
    yield Row(PAPER, "k = m g l / (2 b h) (23), Sec. 4.1", K, of(*map(float, inputs)), "kN/m", spread(of, inputs),
              golden=_true_stiffness() / 1e3, note=note)  # fmt: skip
    springs = [
        (arrangement, spring) for arrangement in ARRANGEMENTS for spring in balanced(arrangement).mechanism.springs
    ]
    for arrangement, spring in springs:
        item = f"k of the {spring.name}, fixed gear {arrangement} (23)"
        yield Row(PAPER, item, None, spring.strength[0] / 1e3, "kN/m", golden=_true_stiffness() / 1e3)
    one = single_stiffness(_weight(), float(B), float(H))
    yield Row(PAPER, "k of one joint's one spring (7)", None, one / 1e3, "kN/m", golden=2 * _true_stiffness() / 1e3)
    yield Row(PAPER, "k of (23) over that of one joint's one spring (7), Sec. 5", "0.5", k / one, exact=True)
    total = sum(spring.strength[0] for spring in balanced().mechanism.springs)
    yield Row(PAPER, "both springs' stiffness over that of the one spring, Sec. 3.2", "1", total / one, exact=True)


def _ends() -> Iterator[Row]:
    """Where the springs end (12)."""
    for spring in lines(balanced().mechanism, "the paper"):
        m = balanced().mechanism
        hinge = next(joint for joint in m.joints if joint.child == spring.body_a)
        for letter, printed, end in (("h", H, spring.p_a), ("b", B, np.array(spring.p_b) - hinge.xyz)):
            yield Row(PAPER, f"{letter} of the {spring.name} (12), Sec. 4.1", printed, float(np.linalg.norm(end)), "m",
                      exact=True)  # fmt: skip


def _closed_forms() -> Iterator[Row]:
    """Energies and torques in closed form (2)-(3), (13)-(18), (24)-(28) against the mechanism's."""
    weight, k, b, h = _weight(), _true_stiffness(), float(B), float(H)
    theta = np.stack(np.meshgrid(*GRID), axis=-1).reshape(-1, 2)
    for arrangement in ARRANGEMENTS:
        m, J = balanced(arrangement).mechanism, differential(arrangement)
        state = Potential(m)(theta)
        pairs = {
            "V_m (3)": (gravity_energy(weight, theta), state.gravity, weight),
            "tau_m (2)": (gravity_torque(weight, theta), -state.gravity_torque, weight),
            "s_i^2 (13)-(14)": (stretch_squared(b, h, theta @ J.T), state.path**2, b * h),
            "V_k (15)-(16)": (spring_energy(k, b, h, theta, J), state.springs.sum(axis=1), weight),
            "V_k (17)-(18)": (balanced_spring_energy(k, b, h, theta), state.springs.sum(axis=1), weight),
            "tau_s (24)-(26)": (spring_torque(k, b, h, theta, J), -state.spring_torque, weight),
            "tau_s (27)": (balanced_spring_torque(k, b, h, theta), -state.spring_torque, weight),
        }
        for name, (formula, mechanism, size) in pairs.items():
            item = f"{name} against the mechanism over the hemisphere, fixed gear {arrangement}: largest difference"
            yield Row(PAPER, item, None, float(np.abs(formula - mechanism).max()) / size, "of m g l or b h",
                      golden="<= 1e-12")  # fmt: skip
        total = gravity_torque(weight, theta) + balanced_spring_torque(k, b, h, theta)
        yield Row(
            PAPER, f"tau_m + tau_s (28), fixed gear {arrangement}", "0", float(np.abs(total).max()), "N m", exact=True
        )
        yield proved(PAPER, f"fixed gear {arrangement} (19)-(22)", balanced(arrangement).balance, "0")


def _constant() -> Iterator[Row]:
    """The constant of the springs' energy (17)."""
    m, k = balanced().mechanism, balanced().mechanism.springs[0].strength[0]
    series, _ = fourier_form(replace(m, gravity=(0.0, 0.0, 0.0)))
    size = k * (float(B) ** 2 + float(H) ** 2)
    constant = float("nan") if series is None else float(series.c[~series.varies].sum().real)
    level = float(Potential(m)(np.array([[pi / 2, 0.0]])).springs.sum())  # where c_1 c_2 = 0: V_k is C
    why = (
        "V_k = (k s_1^2 + k s_2^2) / 2 (15), and each s_i^2 (13) has the constant b^2 + h^2: together k (b^2 + h^2), "
        f"and not twice that. Where c_1 c_2 = 0 the springs store {level / size:.6g} k (b^2 + h^2). A constant does "
        "not matter to the balance"
    )
    yield Row(
        PAPER,
        "C of (17) over k (b^2 + h^2)",
        "2",
        constant / size,
        exact=True,
        golden=1.0,
        against="erratum",
        why=why,
        proof=abs(level / size - 1) < 1e-9,
    )


def _table_1() -> Iterator[Row]:
    """Holding torques at the poses of Table 1."""
    poses = np.array(list(TABLE_1.values()))
    before, after = Potential(arm())(poses).torque, Potential(balanced().mechanism)(poses).torque
    for (pose, (t_1, t_2)), bare, sprung in zip(TABLE_1.items(), before, after, strict=True):
        true = _weight() * sin(t_1) * cos(t_2), _weight() * cos(t_1) * sin(t_2)
        for j, name in enumerate(JOINTS):
            where = f"of theta_{j + 1} ({name}) at pose {pose}, Table 1"
            yield Row(PAPER, f"static torque {where}", None, float(bare[j]), "N m", golden=true[j] + 0.0,
                      note="" if pose > 1 else _STATIC[j])  # fmt: skip
            yield Row(PAPER, f"the same with springs {where}", "0", float(sprung[j]), "N m", exact=True)


_STATIC = (
    "what the actuator holds, minus tau_m of (2): m g l s_1 c_2; the text of Sec. 4.2 prints 't_1 = mgl_1 c_2'",
    "m g l c_1 s_2; the text prints 't_2 = mgl_2 c_2'",
)


def _errors() -> Iterator[Row]:
    """What springs that are a little wrong leave (28)."""
    residual = float(check(scaled(1 - SOFT)).residual.max.max())
    yield Row(PAPER, "peak residual over m g l, both springs 1 % soft", None, residual / _weight(), golden=SOFT,
              note="of either joint: it is (2 k b h - m g l) (s_1 c_2, c_1 s_2), (28)")  # fmt: skip
    yield Row(PAPER, "friction that holds every pose then", None, residual, "N m", golden=SOFT * _weight())
    share = 1e3 * float(K) / balanced().mechanism.springs[0].strength[0]
    left = float(check(scaled(share)).residual.max.max())
    yield Row(PAPER, "friction that holds every pose with the printed k", None, left, "N m",
              golden=abs(1e3 * float(K) / _true_stiffness() - 1) * _weight(),
              note="if the printed m, l, b and h were exact")  # fmt: skip


def _ratios() -> Iterator[Row]:
    """Gear ratios other than 1, beyond the paper."""
    for ratio, golden in RATIOS.items():
        item = f"residual rms torque over unbalanced, gear ratio {ratio:g}"
        note = f"the best springs; they give cos({ratio:g} theta_1 +- theta_2), gravity has cos(theta_1 +- theta_2)"
        try:
            share = _mean_share(design(arm(), "bevel", gear_ratio=ratio).mechanism)
        except InfeasibleError:  # orthogonal over whole turns of theta_1
            share, note = 1.0, f"{note}: no spring helps over whole turns of theta_1"
        yield Row(PAPER, item, None, share, golden=golden, note=note)


def _mean_share(m: Mechanism) -> float:
    """Residual over unbalanced root mean square torque of both joints, integrated exactly over the hemisphere."""
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    theta = np.stack(np.meshgrid(pi * nodes, pi / 2 * (nodes - 1), indexing="ij"), axis=-1).reshape(-1, 2)
    state = Potential(m)(theta)
    mean = np.outer(weights, weights).ravel()
    left, whole = (float(mean @ (torque**2).sum(axis=1)) for torque in (state.torque, state.gravity_torque))
    return sqrt(left / whole)

"""C. Cho, W. Lee, J. Lee and S. Kang, "A 2-dof gravity compensator with bevel gears".

J. Mechanical Science and Technology 26 (2012): the shoulder of Sec. 4, balanced by the method `bevel`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from math import pi

import numpy as np

from ..balance import check, fourier_form
from ..energy.evaluate import Potential
from ..kinematics import Tree
from ..model.arrays import Array
from ..model.errors import InfeasibleError
from ..model.mechanism import Body, Joint, Mechanism
from ..synthesis import Design, design
from ..synthesis.bevel.differential import ARRANGEMENTS, SIDES, single_stiffness, stiffness
from .record import Map, Reproduction, Row, half_unit, spread

PAPER = "cho2012"
CITATION = (
    'C. Cho, W. Lee, J. Lee, S. Kang, "A 2-dof gravity compensator with bevel gears", '
    "Journal of Mechanical Science and Technology 26 (2012)"
)
G = 9.81  # [m/s^2]
M, L, H, B = "6.7", "0.164", "0.0685", "0.049"  # [kg, m, m, m] Sec. 4.1
K = "1.59"  # [kN/m] as printed
ARRANGEMENT = "far"  # "the fixed bevel gear were located at the opposite side"

# Table 1: theta_1, theta_2 [rad]
TABLE_1 = {1: (0, -pi / 4), 2: (0, -3 * pi / 4), 3: (pi / 4, -3 * pi / 4), 4: (3 * pi / 4, -3 * pi / 4)}
PRINTED_2J = {"near": (("-1", "-1"), ("1", "-1")), "far": (("1", "-1"), ("-1", "-1"))}  # (11) and below
SOFT = 0.01
RATIOS = (0.5, 2.0)  # of gears; the paper's is 1
GRID = (np.linspace(-pi, pi, 121), np.linspace(-pi, 0, 61))  # theta_1, theta_2 over the hemisphere [rad]


def shoulder() -> Mechanism:
    """The bare shoulder: roll about z_0, pitch about y_1, gravity along x_0; the ranges are the hemisphere."""
    return Mechanism(
        "roll-pitch shoulder",
        (Body("link 1"), Body("link 2", float(M), (float(L), 0.0, 0.0))),
        (
            Joint("roll", "revolute", "world", "link 1", axis=(0.0, 0.0, 1.0), range=(-pi, pi)),
            Joint("pitch", "revolute", "link 1", "link 2", axis=(0.0, 1.0, 0.0), range=(-pi, 0.0)),
        ),
        gravity=(G, 0.0, 0.0),
    )


@cache
def balanced(arrangement: str = ARRANGEMENT) -> Design:
    """The shoulder balanced by the method, with the paper's b and h."""
    return design(shoulder(), "bevel", b=float(B), h=float(H), arrangement=arrangement)


def scaled(share: float) -> Mechanism:
    """The balanced shoulder with the stiffness of both springs times a share."""
    m = balanced().mechanism
    return m.with_springs(spring.scaled(share) for spring in m.springs)


def reproduction() -> Reproduction:
    """Everything the paper prints."""
    rows = (*_differential(), *_stiffness(), *_energy(), *_table_1(), *_errors(), *_ratios())
    return Reproduction(PAPER, CITATION, rows, _maps())


def _weight() -> float:
    return float(M) * G * float(L)


def _differential() -> Iterator[Row]:
    for arrangement in ARRANGEMENTS:
        m = balanced(arrangement).mechanism
        tree = Tree.of(m)
        links = {link.joint.name: link for link in tree.links}
        for i, side in enumerate(SIDES):
            found = tree.C[links[f"{side} disk"].motions[0].row]
            for j, printed in enumerate(PRINTED_2J[arrangement][i]):
                yield Row(PAPER, f"2J.{i + 1}{j + 1} (11), fixed gear {arrangement}", printed, float(found[j]))


def _stiffness() -> Iterator[Row]:
    k = balanced().mechanism.springs[0].strength[0]

    def of(m: float, l: float, b: float, h: float) -> float:  # noqa: E741  # the paper's letters
        return stiffness(m * G * l, b, h) / 1e3

    inputs = (M, L, B, H)
    low, high = (1e3 * float(K) / k * G + sign * 1e3 * half_unit(K) / k * G for sign in (-1, 1))
    other = float(M) - half_unit(M)
    note = (
        f"1 % more than in print, within what the rounding of the printed m, l, b, h allows: m = {other:.2f} kg would "
        f"give {of(other, *map(float, inputs[1:])):.3f}; no g would: {low:.2f} to {high:.2f} m/s^2"
    )
    yield Row(PAPER, "k = m g l / (2 b h) (23), Sec. 4.1", K, k / 1e3, "kN/m", spread(of, inputs), note=note)
    one = single_stiffness(_weight(), float(B), float(H))
    yield Row(PAPER, "k of (23) over that of one joint's one spring (7), Sec. 5", "0.5", k / one)


def _energy() -> Iterator[Row]:
    m, k = balanced().mechanism, balanced().mechanism.springs[0].strength[0]
    series, _ = fourier_form(replace(m, gravity=(0.0, 0.0, 0.0)))
    assert series is not None  # the ratios are whole
    constant = float(series.c[~series.varies].sum().real)
    yield Row(PAPER, "C of (17) over k (b^2 + h^2)", "2", constant / (k * (float(B) ** 2 + float(H) ** 2)), erratum=_C)
    for arrangement in ARRANGEMENTS:
        certificate = balanced(arrangement).balance.certificate
        yield Row(PAPER, f"largest Fourier coefficient that varies, fixed gear {arrangement} (22)", None,
                  certificate.max_coefficient or 0.0, "J", note="proof of balance at every configuration")  # fmt: skip


_C = (
    "V_k = (k s_1^2 + k s_2^2) / 2 (15), and each s_i^2 (13) has the constant b^2 + h^2: together k (b^2 + h^2), and "
    "not twice that. A constant does not matter to the balance"
)


def _table_1() -> Iterator[Row]:
    poses = np.array(list(TABLE_1.values()))
    before, after = Potential(shoulder())(poses).torque, Potential(balanced().mechanism)(poses).torque
    for (pose, _), bare, sprung in zip(TABLE_1.items(), before, after, strict=True):
        for j, name in enumerate(("roll", "pitch")):
            where = f"of theta_{j + 1} ({name}) at pose {pose}, Table 1"
            yield Row(PAPER, f"static torque {where}", None, float(bare[j]), "N m", note="" if pose > 1 else _STATIC[j])
            yield Row(PAPER, f"the same with springs {where}", None, float(sprung[j]), "N m")


_STATIC = (
    "what the actuator holds, minus tau_m of (2): m g l s_1 c_2; the text of Sec. 4.2 prints 't_1 = mgl_1 c_2'",
    "m g l c_1 s_2; the text prints 't_2 = mgl_2 c_2'",
)


def _errors() -> Iterator[Row]:
    residual = float(check(scaled(1 - SOFT)).residual.max.max())
    yield Row(PAPER, "peak residual over m g l, both springs 1 % soft", None, residual / _weight(),
              note="of either joint: it is (2 k b h - m g l) (s_1 c_2, c_1 s_2), (28)")  # fmt: skip
    yield Row(PAPER, "friction that holds every pose then", None, residual, "N m")
    k = balanced().mechanism.springs[0].strength[0]
    printed = float(check(scaled(1e3 * float(K) / k)).residual.max.max())
    yield Row(PAPER, "friction that holds every pose with the printed k", None, printed, "N m",
              note="if the printed m, l, b and h were exact")  # fmt: skip


def _ratios() -> Iterator[Row]:
    for ratio in RATIOS:
        item = f"residual rms torque over unbalanced, gear ratio {ratio:g}"
        note = f"the best springs; they give cos({ratio:g} theta_1 +- theta_2), gravity has cos(theta_1 +- theta_2)"
        try:
            found = design(shoulder(), "bevel", gear_ratio=ratio)
            share = found.residual / found.unbalanced
        except InfeasibleError:  # orthogonal over whole turns of theta_1
            share, note = 1.0, f"{note}: no spring helps over whole turns of theta_1"
        yield Row(PAPER, item, None, share, note=note)


def _maps() -> tuple[Map, ...]:
    before, after, soft = map(_over_hemisphere, (shoulder(), balanced().mechanism, scaled(1 - SOFT)))
    pictures = {
        "torque": ("without springs and balanced", {"no springs": before, "balanced": after}),
        "soft": ("with both springs 1 % soft", {"1 % soft": soft}),
    }
    return tuple(
        Map(
            name,
            f"Cho et al. (2012): holding torque over the hemisphere, {title}",
            "theta_1 [rad]",
            "theta_2 [rad]",
            "torque [N m]",
            *GRID,
            {f"of theta_{j + 1}, {label}": torque[..., j] for label, torque in torques.items() for j in range(2)},
            note=f"largest: {', '.join(f'{label} {_largest(torque)}' for label, torque in torques.items())}",
        )
        for name, (title, torques) in pictures.items()
    )


def _over_hemisphere(m: Mechanism) -> Array:
    """(theta_2, theta_1, 2) holding torque [N m]."""
    theta = np.stack(np.meshgrid(*GRID), axis=-1)
    return Potential(m)(theta.reshape(-1, 2)).torque.reshape(theta.shape)


def _largest(torque: Array) -> str:
    peak = float(np.abs(torque).max())
    return f"{peak:.3g} N m" if peak > 1e-9 else "below 1e-9 N m"

"""The exact constructions of simionescu2015: the rocker (1)-(3), the two-axis rocker (4)-(8), the robot (9)-(12)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ...balance import Balance, check
from ...energy.certificate import fourier_form
from ...energy.evaluate import Potential
from ...kinematics import Tree
from ...model.mechanism import Body, Joint, Mechanism
from ...synthesis import design
from ...synthesis.delta.legs import delta_legs
from ...synthesis.delta.method import full
from ...synthesis.delta.robot import DeltaRobot
from ...synthesis.delta.rocker import Guide, rocker_spring
from ..record import Row, proved
from .example import AV, AW, M7, PAPER, G

M4, CG4 = 1.2, 0.25  # [kg, m] of a two-axis rocker
DATA = f"BF = CS = 0.1 m, m4 = {M4} kg, CG4 = {CG4} m"

# a robot of which nothing is special, and its additional links
ROBOT = DeltaRobot(base=0.25, platform=0.1, upper=0.4, lower=0.7, com_2=0.15, com_4=0.3)
WEIGHTS = {"link_8": 0.3, "link_9": 0.2, "frame": 0.4, "spring_10": 0.5, "spring_11": 0.6}
LINK_2P = 0.35  # [kg]
# k11 [N/m] for BF = 0.12 and 0.2 m, CS = 0.1 m: literal, mended, exact
K11 = {0.12: ("2651.6", "2101.4", "1298.83"), 0.2: ("2688.3", "2138.1", "2138.1")}
NAMES = {
    "literal": "Eq. (10) literally",
    "mended": "Eq. (10), misprints mended (m5, m11U)",
    "exact": "exact, with BF/(2 CS)",
}


def rocker() -> Iterator[Row]:
    """A rocker about one horizontal axis (1)-(3)."""
    mass, com = 2.0, 0.2  # [kg, m]
    spring = rocker_spring(
        "7", np.array([mass * com, 0.0, 0.0]), "link 2", np.array([0.0, 0, 1]), np.zeros(3), (AV, AW), G, (M7, 0.5)
    )
    hinge = Joint("A", "revolute", "world", "link 2", axis=(0.0, 1.0, 0.0))
    m = Mechanism("rocker", (Body("link 2", mass, (com, 0.0, 0.0)),), (hinge,), springs=(spring,))
    true = (mass * com + 0.5 * M7 * AV) * G / (AV * AW)
    yield Row(
        PAPER, "k7 of a rocker (3)", None, spring.strength[0], "N/m", golden=true, note=f"m2 = {mass} kg, AG2 = {com} m"
    )
    yield proved(PAPER, "rocker (3), any phi", check(m), "0")


def two_axis_rocker(BF: float, CS: float, equation_10: str = "exact", **guide: float) -> tuple[Mechanism, Balance]:
    """A two-axis rocker by itself (section 4), by the method, and its verdict."""
    bare = Mechanism(
        "two-axis rocker",
        (Body("link 3"), Body("link 4", M4, (0.0, 0.0, -CG4))),
        (
            Joint("B", "revolute", "world", "link 3", axis=(0.0, 1.0, 0.0)),
            Joint("C", "revolute", "link 3", "link 4", axis=(1.0, 0.0, 0.0)),
        ),
    )
    given: dict[str, Any] = {"BF": BF, "CS": CS, "equation_10": equation_10, **guide}
    found = design(bare, "delta", variant="rocker", **given)
    return found.mechanism, found.balance


def two_axes() -> Iterator[Row]:
    """A rocker about two axes (4)-(8)."""
    m, exact = two_axis_rocker(0.1, 0.1)
    tree = Tree.of(m)
    q = np.random.default_rng(0).uniform(-1, 1, (200, 2))
    poses = tree.poses(q)
    H = poses.p[:, tree.index["slider 9"]]
    off = np.einsum("ni,ni->n", H, poses.R[:, tree.index["link 3"], :, 0]), H[:, 1]
    yield Row(PAPER, "slider 9 off the bar of link 3 (4)-(6), largest of 200 poses", "0", float(np.abs(off).max()), "m",
              exact=True)  # fmt: skip
    short = 1 - np.linalg.norm(tree.poses(np.array([[0.523599, 0.0]])).p[0, tree.index["slider 9"]]) / 0.2
    yield Row(PAPER, "BH shorter at psi = 0.523599 rad, section 4", "13.39", 100 * float(short), "%", spread=0.01,
              golden=100 * (1 - np.cos(0.523599)))  # fmt: skip
    ten, eleven = m.springs
    yield Row(PAPER, "k10 (7)", None, ten.strength[0], "N/m", golden=G * M4 * CG4 / (0.1 * 0.2), note=DATA)
    FU, FT = Guide().FU, Guide().FT
    true = ten.strength[0] * 0.1**2 / (FU * FT)
    yield Row(PAPER, "k11 exact, from the energy", None, eleven.strength[0], "N/m", golden=true, note=DATA)
    yield proved(PAPER, "two-axis rocker, exact", exact)
    mended, balance = two_axis_rocker(0.1, 0.1, "mended")
    twice = two_axis_rocker(0.2, 0.1, "mended")[1]
    proof = exact.exact and twice.exact
    yield Row(PAPER, "k11 (8)", None, mended.springs[1].strength[0], "N/m", golden=G * M4 * CG4 / (FU * FT), note=DATA)
    psi = np.column_stack([np.linspace(-1, 1, 201), np.zeros(201)])
    for item, value, golden in (
        ("over psi = +-1 rad", float(np.ptp(Potential(mended)(psi).energy)), "2.084"),
        ("over all poses", balance.total[1] - balance.total[0], "2.943"),
    ):
        yield Row(PAPER, f"Eq. (8) as printed, energy variation {item}", "0", value, "J", exact=True, golden=golden,
                  against="erratum", why=_EQUATION_8, proof=proof, note=DATA)  # fmt: skip
    yield proved(PAPER, "Eq. (8) as printed with BF = 2 CS", twice, "0")
    odd = two_axis_rocker(0.07, 0.13, link_8=0.3, link_9=0.2, m3Q=0.1, spring_10=0.5, spring_11=0.6)[1]
    yield proved(PAPER, "two-axis rocker with a guide that has masses, m3Q among them, exact", odd)


_EQUATION_8 = (
    "exact only if BF = 2 CS: g (m4 CG4 + m10S CS) stands where the energy has k10 BF^2, and is BF/(2 CS) times that; "
    "with BF = 2 CS, and with the factor, the balance is proved"
)


def _robot(BF: float, equation_10: str = "exact", m3Q: float = 0.0, bare: Mechanism | None = None) -> Mechanism:
    guide = Guide(BF=BF, CS=0.1, equation_10=equation_10, m3Q=m3Q, **WEIGHTS)
    return full(bare or ROBOT.mechanism(), guide, AV, AW, M7, 0.5, LINK_2P)


def whole_robot() -> Iterator[Row]:
    """Full balancing of the robot (9)-(12)."""
    r = ROBOT
    rods = 2 * r.link_4 * 0.3 + (r.link_5 + r.link_6 / 3) * r.lower + 0.5 * WEIGHTS["spring_10"] * 0.1  # [kg m]
    bare = Tree.of(r.mechanism())
    places = np.random.default_rng(0).uniform([-0.2, -0.2, -0.9], [0.2, 0.2, -0.5], (300, 3))
    u = np.column_stack([leg.actuator(places) for leg in delta_legs(bare.mechanism)[0]])
    lift = float(np.ptp(Potential(bare.mechanism)(u).gravity))
    for BF, golden in K11.items():
        robots = {name: _robot(BF, name) for name in NAMES}
        series, why = fourier_form(robots["exact"])
        k = {spring.name: spring.strength[0] for spring in robots["exact"].springs}
        true = G * rods / (0.1 * 2 * BF)
        yield Row(PAPER, f"k10 (9), BF = {BF:g} m", None, k["spring 10 1"], "N/m", golden=true)
        yield Row(PAPER, f"k7 (11)-(12), BF = {BF:g} m", None, k["spring 7 1"], "N/m", golden="411.03")
        amplitude = float("nan") if series is None else float(series.amplitude.max(initial=0)) / lift
        yield Row(
            PAPER,
            f"largest Fourier coefficient that varies over gravity's energy, full balance, BF = {BF:g} m",
            "0",
            amplitude,
            exact=True,
            golden="<= 1e-12",
            note=why or "proved at every configuration",
        )
        for name, text in zip(NAMES, golden, strict=True):
            m = robots[name]
            k11 = next(spring.strength[0] for spring in m.springs if spring.name == "spring 11 1")
            yield Row(PAPER, f"k11, {NAMES[name]}, BF = {BF:g} m", None, k11, "N/m", golden=text)
            left = float(np.ptp(Potential(m)(u).energy)) / lift
            item = f"energy left over gravity's in 300 places, {NAMES[name]}, BF = {BF:g} m"
            wrong = name == "literal" or (name == "mended" and BF != 0.2)
            if not wrong:
                yield Row(PAPER, item, "0", left, exact=True, golden="<= 1e-12")
                continue
            yield Row(
                PAPER,
                item,
                "0",
                left,
                exact=True,
                golden=LEFT[BF, name],
                against="erratum",
                why=_EQUATION_10[name],
                proof=series is not None and series.exact,
            )


LEFT = {(0.12, "literal"): "0.4855", (0.12, "mended"): "0.2880", (0.2, "literal"): "0.1975"}
_EQUATION_10 = {
    "literal": "BF = 2 CS is missing, m4 + m6/3 has to be m5 + m6/3, and m11 m11U; the exact form is proved",
    "mended": "BF = 2 CS is missing; the exact form is proved",
}


def bar() -> Iterator[Row]:
    """The bar of link 3 (8), m3Q."""
    hanging = _robot(0.12, m3Q=0.15)
    plain, loaded = ({s.name: s.strength[0] for s in m.springs} for m in (_robot(0.12), hanging))
    FU, FT = Guide().FU, Guide().FT
    yield Row(PAPER, "k11 that m3Q = 0.15 kg adds (8), (10)", None, loaded["spring 11 1"] - plain["spring 11 1"], "N/m",
              golden=G * 0.15 * 0.12 / (FU * FT))  # fmt: skip
    robot = ROBOT.mechanism()
    bodies = (replace(body, com=(0.0, 0.0, 0.05)) if "link 3" in body.name else body for body in robot.bodies)
    heavy = _robot(0.12, bare=replace(robot, bodies=tuple(bodies)))
    cases = {
        "m3Q = 0.15 kg at Q": hanging,
        "a bar that is fixed to link 3, its mass centre 50 mm above B, with a spring of (3) for it": heavy,
    }
    for name, m in cases.items():
        series, why = fourier_form(m)
        left = float("nan") if series is None else float(series.amplitude.max(initial=0))
        yield Row(PAPER, f"largest Fourier coefficient that varies, {name}", None, left, "J", golden="<= 1e-10",
                  note=why or "proved at every configuration")  # fmt: skip

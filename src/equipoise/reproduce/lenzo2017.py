"""B. Lenzo, "Gravity balancing of a spatial serial 4-dof arm without auxiliary links using minimum number of springs".

AIMETA 2017: the arm of Fig. 3, balanced by the method `no-auxiliary` in all layouts of Fig. 5. The paper prints
equations and conditions but no numbers; masses and lengths here are those of a golden case computed apart from this
program.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ..balance import Balance, check
from ..energy.evaluate import Potential
from ..kinematics.motion import CubicMove, follow
from ..model.arrays import Array
from ..model.errors import InfeasibleError
from ..model.mechanism import Body, Joint, Mechanism, Workspace
from ..synthesis import Design, design
from .record import Plot, Reproduction, Row

PAPER = "lenzo2017"
CITATION = (
    'B. Lenzo, "Gravity balancing of a spatial serial 4-dof arm without auxiliary links using minimum number of '
    'springs", XXIII Conference of the Italian Association of Theoretical and Applied Mechanics (AIMETA), Salerno, 2017'
)
M1, L1, H1, M2, H2 = 2.0, 0.3, 0.15, 1.2, 0.12  # [kg, m, m, kg, m]
G = 9.81  # [m/s^2]
CHOSEN = {"k2": 400.0, "a12": 0.05, "b12": 0.36}  # [N/m, m, m]
GOLDEN = {"a2": ("0.053955", "m"), "b2": ("0.0654545", "m"), "k12": ("2618.18", "N/m")}
LAYOUTS = "abcd"
POSES = 2000
TIMES = np.linspace(0, 6, 601)  # [s]

_GOLDEN_NOTE = "golden case, computed apart from this program: the paper prints no numbers"


def arm(h2: float = H2, ball_elbow: bool = False) -> Mechanism:
    """The arm of Fig. 3: a ball joint at the shoulder, a hinge at the elbow; the mass of link 2 at h2 from it [m]."""
    elbow = Joint("elbow", "revolute", "link 1", "link 2", (L1, 0.0, 0.0), axis=(0.0, -1.0, 0.0))
    return Mechanism(
        "anthropomorphic arm",
        (Body("link 1", M1, (H1, 0.0, 0.0)), Body("link 2", M2, (h2, 0.0, 0.0))),
        (
            Joint("shoulder", "spherical", "world", "link 1"),
            replace(elbow, type="spherical") if ball_elbow else elbow,
        ),
        workspace=Workspace(POSES),
    )


def balanced(h2: float = H2, **options: Any) -> Design:
    """The arm balanced by the method; x2 points along +x of link 2."""
    return design(arm(h2), "no-auxiliary", direction=(1.0, 0.0, 0.0), **options)


def motion() -> Array:
    """(T, 4) shoulder and elbow at `TIMES` [rad]: one after the other, then all together."""
    moves = (
        CubicMove("shoulder.y", 0, 2, 0.0, -1.2),
        CubicMove("elbow", 1, 3, 0.0, 1.9),
        CubicMove("shoulder.x", 3, 5, 0.0, 0.8),
        CubicMove("shoulder.z", 3, 6, 0.0, 1.1),
        CubicMove("shoulder.y", 4, 6, -1.2, 0.9),
        CubicMove("elbow", 4, 6, 1.9, 0.4),
    )
    return follow(arm().coordinates, moves, TIMES)


def reproduction() -> Reproduction:
    """The equations in numbers, the four layouts, and what is refused."""
    rows = (*_golden(), *_exact(), *_needed(), *_conditions(), *_energies())
    return Reproduction(PAPER, CITATION, rows, (_figure(),))


def _golden() -> Iterator[Row]:
    yield Row(PAPER, "m1 g h1 + m2 g l1 (11)", None, M1 * G * H1 + M2 * G * L1, "N m")
    yield Row(PAPER, "m2 g h2 (11)", None, M2 * G * H2, "N m")
    found = balanced(layout="b", **CHOSEN).free_parameters
    for name, (text, unit) in GOLDEN.items():
        yield Row(PAPER, f"{name} (15), layout b", text, found[name], unit, note=_GOLDEN_NOTE)


def _exact() -> Iterator[Row]:
    """What is left by each layout, with h2 of the sign that it needs."""
    what = f"largest residual torque over {POSES} random poses"
    for layout in LAYOUTS:
        h2 = _suiting(layout)
        unbalanced = float(balanced(h2, layout=layout).balance.unbalanced.max.max())
        note = f"of {unbalanced:.4g} N m unbalanced, h2 = {h2} m"
        for springs, equation in ((2, 15), (3, 14)):
            of = balanced(h2, layout=layout, springs=springs).balance
            yield Row(PAPER, f"{what}, layout {layout}, {springs} springs ({equation})", None, _largest(of), "N m",
                      note=f"{note}; {'proved exact' if of.exact else 'not exact'}")  # fmt: skip
    golden = balanced(layout="b", **CHOSEN).balance
    yield Row(PAPER, f"{what}, golden case", None, _largest(golden), "N m", note="unrounded values")
    rounded = balanced(layout="b", **CHOSEN).mechanism
    ends = {"k2": {"p_a": (0.0, 0.0, 0.053955), "p_b": (0.0654545, 0.0, 0.0)}, "k12": {"stiffness": 2618.18}}
    rounded = rounded.with_springs(spring.changed(**ends[spring.name]) for spring in rounded.springs)
    yield Row(PAPER, f"{what}, golden case as printed", None, _largest(check(rounded)), "N m", note="rounded values")


def _needed() -> Iterator[Row]:
    """Without spring k12, Fig. 4a, the term k2 b2 l1 x1.x2 of (12) is left."""
    whole = balanced(layout="b", springs=3)
    found = whole.free_parameters
    without = whole.mechanism.with_springs(spring for spring in whole.mechanism.springs if spring.name != "k12")
    low, high = check(without).total
    yield Row(PAPER, "variation of the energy without spring k12, Fig. 4a", None, high - low, "J",
              note=f"2 k2 b2 l1 = {2 * found['k2'] * found['b2'] * L1:.6g} J: x1.x2 goes from -1 to 1")  # fmt: skip
    yield Row(PAPER, "springs of layout b", "2", len(balanced().mechanism.springs))
    free = design(arm(ball_elbow=True), "no-auxiliary").free_parameters
    yield Row(PAPER, "fewest springs with ball joints at shoulder and elbow", "2", free["fewest"],
              note="the paper gives 2 for this arm; the bound is proved for links that turn freely")  # fmt: skip


def _conditions() -> Iterator[Row]:
    for h2, sign, suit in ((H2, ">", "a and b"), (-H2, "<", "c and d")):
        refused = [text for layout in LAYOUTS if (text := _refusal(h2, layout=layout))]
        yield Row(PAPER, f"layouts that exist with h2 {sign} 0, Sec. 3.2", "2", len(LAYOUTS) - len(refused),
                  note=f"{suit}; {'; '.join(refused)}")  # fmt: skip
    heights = -np.geomspace(0.01, 1.0, 5)  # [m]
    found = [_refusal(H2, a2=float(a2)) for a2 in heights]
    yield Row(PAPER, "designs with a2 < 0, five heights from -10 mm to -1 m, Sec. 3.2", "0",
              sum(text is None for text in found), note=found[0] or "")  # fmt: skip


def _energies() -> Iterator[Row]:
    state = Potential(balanced(layout="b", **CHOSEN).mechanism)(motion())
    spread = float(np.ptp(state.gravity))
    yield Row(PAPER, "gravity's energy over a motion of shoulder and elbow, largest less smallest", None, spread, "J")
    yield Row(PAPER, "variation of the total energy over it, as a share of gravity's", None,
              float(np.ptp(state.energy)) / spread)  # fmt: skip


def _suiting(layout: str) -> float:
    """h2 [m] of the sign that a layout needs."""
    return H2 if layout in "ab" else -H2


def _refusal(h2: float, **options: Any) -> str | None:
    """Why there is no such design with two springs; None when there is one."""
    try:
        balanced(h2, springs=2, **options)
    except InfeasibleError as error:
        return str(error)
    return None


def _largest(balance: Balance) -> float:
    return float(balance.residual.max.max())


def _figure() -> Plot:
    found = balanced(layout="b", **CHOSEN).mechanism
    state = Potential(found)(motion())
    springs = {f"spring {spring.name}": state.springs[:, i] for i, spring in enumerate(found.springs)}
    return Plot(
        "energy",
        "Lenzo (2017), layout b: energies while shoulder and elbow move",
        "time [s]",
        "energy [J]",
        TIMES,
        {"gravity": state.gravity, **springs, "total": state.energy},
        note="golden case; gravity counted from the shoulder",
    )

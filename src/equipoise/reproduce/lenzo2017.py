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
from ..model.elements import lines
from ..model.errors import InfeasibleError
from ..model.mechanism import Body, Joint, Mechanism, Workspace
from ..synthesis import Design, design
from .record import Picture, Plot, Reproduction, Row, proved

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
SIGNS = {"a": "--+", "b": "+++", "c": "+--", "d": "-+-"}  # of a12, b12 - l1 and b2, Fig. 5
HINGE = (0.0, -1.0, 0.0)
POSES = 2000
TIMES = np.linspace(0, 6, 601)  # [s]

_GOLDEN_NOTE = "golden case, computed apart from this program: the paper prints no numbers"


def arm(h2: float = H2, ball_elbow: bool = False) -> Mechanism:
    """The arm of Fig. 3: a ball joint at the shoulder, a hinge at the elbow; the mass of link 2 at h2 from it [m]."""
    elbow = Joint("elbow", "revolute", "link 1", "link 2", (L1, 0.0, 0.0), axis=HINGE)
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
    """The equations in numbers, the layouts, and what is refused."""
    sections = (_one_link, _two_hinges, _moments, _golden, _exact, _needed, _conditions, _energies)
    return Reproduction.of(PAPER, CITATION, sections, (_figure, _drawings))


def one_link() -> Design:
    """The link of Fig. 1, m1 and h1, on a hinge, with the spring of (7)."""
    bare = replace(arm(), bodies=(arm().bodies[0],), joints=(Joint("O", "revolute", "world", "link 1", axis=HINGE),))
    return design(bare, "no-auxiliary")


def two_hinges() -> Design:
    """The two links of Fig. 2 on hinges: spring k2 from the four-bar, which stays upright."""
    shoulder = Joint("shoulder", "revolute", "world", "link 1", axis=HINGE)
    return design(replace(arm(), joints=(shoulder, arm().joints[1])), "pseudobase", planar=("link 1", "link 2"))


def _one_link() -> Iterator[Row]:
    """One link with one spring (1)-(7), Fig. 1."""
    found = one_link()
    (spring,) = lines(found.mechanism, "the paper")
    a, b = (float(np.linalg.norm(end)) for end in (spring.p_a, spring.p_b))
    item = "k a b / (m g h) (7), Fig. 1"
    yield Row(PAPER, item, "1", spring.stiffness * a * b / (M1 * G * H1), exact=True)
    yield proved(PAPER, "Fig. 1 (6)", found.balance, "0")


def _two_hinges() -> Iterator[Row]:
    """Two links with a four-bar (8)-(10), Fig. 2."""
    found = two_hinges()
    free = found.free_parameters
    moments = {"1": M1 * G * H1 + M2 * G * L1, "2": M2 * G * H2}
    for link, moment in moments.items():
        spring = lines(found.mechanism, "the paper")[int(link) - 1]
        C = np.array(free["centre"][f"link {link}"])
        a, b = float(np.linalg.norm(spring.p_a)), float(np.linalg.norm(spring.p_b - C))
        item = f"k{link} a{link} b{link} over gravity's moment (10), Fig. 2"
        yield Row(PAPER, item, "1", spring.stiffness * a * b / moment, exact=True)
    yield proved(PAPER, "Fig. 2 (8)-(9)", found.balance, "0")


def _moments() -> Iterator[Row]:
    """The moments of (8) and (11)."""
    q = np.zeros((2, 4))
    q[1, 3] = np.pi  # link 2 folded back
    state = Potential(replace(arm(), gravity=(-G, 0.0, 0.0)))(q).gravity  # both links straight up
    yield Row(PAPER, "m1 g h1 + m2 g l1 (11)", None, float(state.mean()), "N m", golden="6.4746")
    yield Row(PAPER, "m2 g h2 (11)", None, float(state[0] - state[1]) / 2, "N m", golden="1.41264")


def _golden() -> Iterator[Row]:
    """Layout b with k2, a12 and b12 chosen (15)."""
    found = balanced(layout="b", **CHOSEN).free_parameters
    for name, (text, unit) in GOLDEN.items():
        yield Row(PAPER, f"{name} (15), layout b", None, found[name], unit, golden=text, note=_GOLDEN_NOTE)


def _exact() -> Iterator[Row]:
    """What each layout leaves (14), (15), with h2 of the sign that it needs."""
    for layout in LAYOUTS:
        h2 = _suiting(layout)
        for springs, equation in ((2, 15), (3, 14)):
            found = balanced(h2, layout=layout, springs=springs)
            what = f"layout {layout}, {springs} springs ({equation})"
            signs = "".join("+" if found.free_parameters[name] > 0 else "-" for name in ("a12", "b2"))
            past = "+" if found.free_parameters["b12"] > L1 else "-"
            yield Row(PAPER, f"springs of {what}", str(springs), len(found.mechanism.springs), exact=True)
            right = signs[0] + past + signs[1] == SIGNS[layout]
            yield Row(PAPER, f"signs of a12, b12 - l1, b2 as in Fig. 5, {what}: 1 if so", "1", int(right), exact=True,
                      note=f"found {signs[0]}{past}{signs[1]}, printed {SIGNS[layout]}; h2 = {h2} m")  # fmt: skip
            yield _residual(f"{what}", found.balance)
            yield proved(PAPER, what, found.balance, "0")
            yield from _equations(what, found)
    golden = balanced(layout="b", **CHOSEN)
    yield _residual("golden case", golden.balance)
    ends = {"k2": {"p_a": (0.0, 0.0, 0.053955), "p_b": (0.0654545, 0.0, 0.0)}, "k12": {"stiffness": 2618.18}}
    rounded = golden.mechanism.with_springs(spring.changed(**ends[spring.name]) for spring in golden.mechanism.springs)
    yield Row(PAPER, f"{_WHAT}, golden case, values rounded", None, _largest(check(rounded)), "N m", golden="9.81e-7")


_WHAT = f"largest residual torque over {POSES} random poses"


def _residual(what: str, balance: Balance) -> Row:
    unbalanced = float(balance.unbalanced.max.max())
    return Row(PAPER, f"{_WHAT}, {what}", "0", _largest(balance), "N m", exact=True, golden="<= 1e-12",
               note=f"of {unbalanced:.4g} N m unbalanced")  # fmt: skip


def _equations(what: str, found: Design) -> Iterator[Row]:
    """The three lines of (14) or (15), measured on the springs of the mechanism, over their largest term."""
    springs = {spring.name: spring for spring in lines(found.mechanism, "the paper")}
    k2, k12, k1 = (springs[name].stiffness if name in springs else 0.0 for name in ("k2", "k12", "k1"))
    a2, b2 = springs["k2"].p_a[2], springs["k2"].p_b[0]
    b12, a12 = springs["k12"].p_a[0], springs["k12"].p_b[0]
    a1, b1 = (springs["k1"].p_a[2], springs["k1"].p_b[0]) if "k1" in springs else (0.0, 0.0)
    h2 = found.mechanism.bodies[1].com[0]
    terms_of = {
        "first": (M1 * G * H1 + M2 * G * L1, -k1 * a1 * b1, -k2 * a2 * L1),
        "second": (M2 * G * h2, -k2 * a2 * b2),
        "third": (k2 * b2 * L1, k12 * a12 * (L1 - b12)),
    }
    for line, terms in terms_of.items():
        left = abs(sum(terms)) / max(map(abs, terms))
        yield Row(PAPER, f"{line} line of (14)-(15), {what}", "0", left, exact=True, golden="<= 1e-12")


def _needed() -> Iterator[Row]:
    """What spring k12 is for (12), (13), and how many springs there are."""
    whole = balanced(layout="b", springs=3)
    found = whole.free_parameters
    without = whole.mechanism.with_springs(spring for spring in whole.mechanism.springs if spring.name != "k12")
    low, high = check(without).total
    left = 2 * found["k2"] * found["b2"] * L1
    yield Row(
        PAPER,
        "variation of the energy without spring k12, Fig. 4a (12)",
        None,
        high - low,
        "J",
        golden=f"{left:.5g}",
        note=f"k2 b2 l1 x1.x2 is left, and x1.x2 goes from -1 to 1: 2 k2 b2 l1 = {left:.6g} J",
    )
    bend = np.zeros((3, 4))
    bend[:, 3] = (0.0, np.pi / 2, np.pi)
    energy = Potential(without)(bend).energy
    yield Row(PAPER, "half the energy between a straight and a folded elbow without k12, over k2 b2 l1 (12)", "1",
              float(energy[0] - energy[2]) / left, exact=True)  # fmt: skip
    yield Row(PAPER, "springs of layout b", "2", len(balanced().mechanism.springs), exact=True)
    free = design(arm(ball_elbow=True), "no-auxiliary").free_parameters
    yield Row(PAPER, "fewest springs with ball joints at shoulder and elbow", "2", free["fewest"], exact=True,
              note="the paper gives 2 for this arm; the bound is proved for links that turn freely")  # fmt: skip


def _conditions() -> Iterator[Row]:
    """Which layouts exist (Sec. 3.2)."""
    for h2, sign, suit in ((H2, ">", "ab"), (-H2, "<", "cd")):
        reasons = {layout: _refusal(h2, layout=layout) for layout in LAYOUTS}
        exist = "".join(layout for layout, text in reasons.items() if text is None)
        refused = "; ".join(text for text in reasons.values() if text)
        yield Row(PAPER, f"layouts that exist with h2 {sign} 0, Sec. 3.2", "2", len(exist), exact=True,
                  note=f"{' and '.join(exist)}; {refused}")  # fmt: skip
        yield Row(PAPER, f"of them {' and '.join(suit)}, as in print", "2", len(set(exist) & set(suit)), exact=True)
    heights = -np.geomspace(0.01, 1.0, 5)  # [m]
    found = [_refusal(H2, a2=float(a2)) for a2 in heights]
    yield Row(PAPER, "designs with a2 < 0, five heights from -10 mm to -1 m, Sec. 3.2", "0",
              sum(text is None for text in found), exact=True, note=found[0] or "")  # fmt: skip


def _energies() -> Iterator[Row]:
    """The energies over a motion."""
    state = Potential(balanced(layout="b", **CHOSEN).mechanism)(motion())
    spread = float(np.ptp(state.gravity))
    yield Row(PAPER, "gravity's energy over a motion of shoulder and elbow, largest less smallest", None, spread, "J",
              golden="7.318")  # fmt: skip
    yield Row(PAPER, "variation of the total energy over it, as a share of gravity's", "0",
              float(np.ptp(state.energy)) / spread, exact=True, golden="<= 1e-12")  # fmt: skip


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


def _figure() -> Iterator[Plot]:
    """The energies over the motion."""
    found = balanced(layout="b", **CHOSEN).mechanism
    state = Potential(found)(motion())
    springs = {f"spring {spring.name}": state.springs[:, i] for i, spring in enumerate(found.springs)}
    yield Plot(
        "energy",
        "Lenzo (2017), layout b: energies while shoulder and elbow move",
        "time [s]",
        "energy [J]",
        TIMES,
        {"gravity": state.gravity, **springs, "total": state.energy},
        note="golden case; gravity counted from the shoulder",
    )


def _drawings() -> Iterator[Picture]:
    """Figs. 1 to 5: the arms with the paper's letters on their springs."""
    three = balanced(layout="b", springs=3).mechanism
    without = three.with_springs(spring for spring in three.springs if spring.name != "k12")
    pictures = {
        "fig1": ("one link", one_link().mechanism),
        "fig2": ("two links with a four-bar", two_hinges().mechanism),
        "fig3": ("the arm", arm()),
        "fig4a": ("springs k1 and k2: not balanced", without),
        "fig4b": ("three springs", three),
        **{
            f"fig5{layout}": (f"layout {layout}", balanced(_suiting(layout), layout=layout).mechanism)
            for layout in LAYOUTS
        },
    }
    for name, (title, mechanism) in pictures.items():
        yield Picture(name, f"Lenzo (2017), {name.replace('fig', 'Fig. ')}: {title}", mechanism)

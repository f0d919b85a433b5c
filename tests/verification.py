"""The verification manual: sourced numbers beside ours, each with a mutation of the source that it catches.

    .venv/bin/python tests/verification.py --write      makes docs/verification.md; exit code 1 when a case is off
    .venv/bin/python tests/verification.py --only 3,4   only says whether these hold

`test_verification.py` makes each mutation in a copy of the source and asks its case.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from importlib import import_module
from math import radians
from pathlib import Path

import numpy as np
from test_mutations import MUTATIONS, Mutation

import equipoise as eq
from equipoise.energy.reference import Reference
from equipoise.hardware import WIRES, CompressionSpring, ExtensionSpring
from equipoise.model.elements import laws
from equipoise.reproduce.record import Row

PAGE = Path(__file__).parents[1] / "docs" / "verification.md"
NOTHING = 1e-9  # shown as 0: rounding, which differs from machine to machine
BAR = "\\|"  # in a cell
INCH, PSI, LBF = 0.0254, 6894.757, 4.448222


@dataclass(frozen=True)
class Case:
    """A number that somebody else has printed.

    Attributes:
        what: it is, with its unit.
        source: where it stands.
        target: as printed.
        tolerance: absolute; half a unit of the last digit where nothing else is said.
        compute: ours.
        mutation: of the source, after which ours is off.
    """

    what: str
    source: str
    target: float
    tolerance: float
    compute: Callable[[], float]
    mutation: Mutation

    def holds(self) -> bool:
        """Whether ours is the printed one; not where the source is so broken that there is none."""
        try:
            return bool(abs(self.compute() - self.target) <= self.tolerance * (1 + 1e-9))
        except Exception:
            return False


def _mutation(function: str, old: str, new: str) -> Mutation:
    return Mutation("manual", function, old, new)


SHIGLEY = "Budynas and Nisbett, *Shigley's Mechanical Engineering Design*, 10th ed., Example 10-1"


def _music_wire() -> CompressionSpring:
    """Number 16 music wire, outer diameter 7/16 in, 12 1/2 coils with squared ends."""
    wire = replace(WIRES["SH"], shear_modulus=11.85e6 * PSI)
    d = 0.037 * INCH
    return CompressionSpring(wire, d, 0.400 * INCH, 10.5, 2.0 * INCH)


def _stainless() -> ExtensionSpring:
    wire = WIRES["1.4310"]
    return ExtensionSpring(wire, 1.6e-3, 11.1e-3, 21, 175e6, 7.6e-3)


def _surge() -> float:
    steel = replace(WIRES["SH"], shear_modulus=11.5e6 * PSI)
    return float(replace(_music_wire(), wire=steel, d=2e-3, D=20e-3, n=10).frequency)


def _strength(grade: str, d: float) -> Callable[[], float]:
    return lambda: float(WIRES[grade].strength(1e-3 * d)) / 1e6


def _gas(**values: float) -> laws.Gas:
    return laws.Gas(**{"force": 200.0, "longest": 0.4, "shortest": 0.25, "progression": 1.3} | values)


def _torque(mechanism: eq.Mechanism, *q: float) -> float:
    return float(Reference(mechanism)(np.array([q])).torque[0, 0])


def _hinged(mass: float, com: float, *springs: eq.Spring | eq.TorsionSpring) -> eq.Mechanism:
    arm = eq.Body("arm", mass, (com, 0, 0))
    return eq.Mechanism(
        "arm", (arm,), (eq.Joint("hinge", "revolute", "world", "arm", axis=(0, -1, 0)),), springs=springs
    )


def _sprung_joint(q: float) -> Callable[[], float]:
    """5 N m/rad at rest at 1.2 rad, a load of 5.886 N m cos q."""
    return lambda: _torque(_hinged(2.0, 0.3, eq.TorsionSpring("joint spring", (("hinge", 1.0),), 5.0, 1.2)), q)


def _hatch() -> float:
    strut = eq.Spring("strut", "world", (0.05, 0, -0.25), "arm", (0.25, 0, -0.02), 400.0, 0.9)
    return _torque(_hinged(8.0, 0.4, strut), 0.0)


@cache
def _gantry() -> eq.Design:
    carriage = eq.Mechanism(
        "vertical axis",
        (eq.Body("carriage", 6.0),),
        (eq.Joint("z", "prismatic", "world", "carriage", axis=(0, 0, 1), range=(0.0, 0.4)),),
    )
    return eq.design(carriage, pairs=[("world", "carriage")], radius=0.3, springs=1)


HANDBOOK = (
    Case("rate of a compression spring [lbf/in]", SHIGLEY, 4.13, 0.005, lambda: _music_wire().rate / (LBF / INCH),
         _mutation("Helical.rate", "8 * self.D ** 3 * self.n", "4 * self.D ** 3 * self.n")),
    Case("Bergsträsser factor at C = 10.8", SHIGLEY, 1.124, 5e-4, lambda: float(_music_wire().correction),
         _mutation("Helical.correction", "w - 0.75", "w - 0.5")),
    Case("corrected stress at 6.46 lbf [kpsi], printed as the yield strength", SHIGLEY, 146, 0.5,
         lambda: float(_music_wire().corrected(6.46 * LBF)) / PSI / 1e3,
         _mutation("Helical.stress", "8 * self.D * force", "4 * self.D * force")),
    Case("rate of an extension spring, 1.6 × 11.1 mm, 21 coils [N/mm]", "EN 13906-2, Eq. (9.5), by hand", 1.997, 5e-4,
         lambda: _stainless().rate / 1e3, _mutation("Helical.rate", "self.d ** 4", "self.d ** 3.9")),
    Case("its initial tension at 175 MPa [N]", "EN 13906-2, by hand", 25.4, 0.05,
         lambda: float(_stainless().initial_tension),
         _mutation("Helical.force_at", "pi * self.d ** 3 * stress", "1.1 * pi * self.d ** 3 * stress")),
    Case("its body length [mm]", "EN 13906-2: n + 1 coils lie side by side", 35.2, 0.05,
         lambda: 1e3 * float(_stainless().body), _mutation("ExtensionSpring.body", "self.n + 1", "self.n")),
    Case("surge of a steel spring, d = 2, D = 20 mm, n = 10 [Hz]: 356 000 d / (n D²)", "Wahl, *Mechanical Springs*",
         178, 1.0, _surge,
         _mutation("Helical.frequency", "2 * pi * self.n * self.D ** 2", "pi * self.n * self.D ** 2")),
    Case("strength of SL wire of 1 mm [MPa]", "EN 10270-1, Table 3", 1720, 0.5, _strength("SL", 1.0),
         _mutation("Wire.strength", "a - b * np.log10(d_mm)", "a - b * np.log10(d_mm) + 10.0")),
    Case("strength of DH wire of 2 mm [MPa]", "EN 10270-1, Table 3", 1980, 0.5, _strength("DH", 2.0),
         _mutation("Wire.strength", "b * np.log10(d_mm)", "1.1 * b * np.log10(d_mm)")),
    Case("strength of DH wire of 10 mm [MPa]", "EN 10270-1, Table 3", 1410, 0.5, _strength("DH", 10.0),
         _mutation("Wire.strength", "np.log10(d_mm)", "np.log(d_mm) / 2.4")),
    Case("strength of 1.4310 wire of 1.6 mm [MPa]", "EN 10270-3, Table 2", 1900, 0.5, _strength("1.4310", 1.6),
         _mutation("Wire.strength", "np.searchsorted(upto, d_mm - 1e-9)", "np.searchsorted(upto, d_mm - 1e-9) + 1")),
    Case("strength of 1.4310-NS wire of 1.5 mm [MPa], the end of a row", "EN 10270-3, Table 2", 1800, 0.5,
         _strength("1.4310-NS", 1.5), _mutation("Wire.strength", "d_mm - 1e-9", "d_mm + 1e-9")),
    Case("gas spring, force at 30 °C over that at 20 °C", "vendors' sheets: 3.4 % for 10 K", 1.034, 5e-4,
         lambda: _gas(temperature=303.15).pull(np.array([0.4]))[0] / _gas().pull(np.array([0.4]))[0],
         _mutation("Gas.warmth", "self.temperature / STATED", "1.0")),
    Case("gas spring of 200 N and progression 1.3, pushed in [N]", "vendors' sheets: progression is F2 / F1", 260, 0.5,
         lambda: -float(_gas().pull(np.array([0.25]))[0]), _mutation("Gas.slope", "inmost - self.force", "inmost")),
)  # fmt: skip
FIELD = (
    Case("holding torque of a joint with a torsion spring at 0 rad [N m]", "field case 9: 5.886 cos q + 5 (q - 1.2)",
         -0.114,         5e-4, _sprung_joint(0.0), _mutation("Linear.pull", "s - self.free_length", "s")),
    Case("the same at -1 rad [N m]", "field case 9", -7.82, 5e-3, _sprung_joint(-1.0),
         _mutation("OnJoints.path", "ratio * poses.s[:, tree.rows[joint]]",
                   "abs(ratio * poses.s[:, tree.rows[joint]])")),
    Case("torque of a hatch on a strut that pushes, closed [N m]", "field case 13, by numpy", -16.64698, 5e-5, _hatch,
         _mutation("Reference._chunk", "np.einsum('i,nij->nj', self._g, velocities.point(poses, body, p))",
                   "0.9 * np.einsum('i,nij->nj', self._g, velocities.point(poses, body, p))")),
    Case("least rms force that springs leave on a vertical axis [N]", "field case 3, by hand", 16.325, 5e-4,
         lambda: _gantry().residual, _mutation("_derivative", "part.coef * power[:, None]",
                                                "part.coef * (power[:, None] > 0)")),
    Case("stiffness of the one spring that does [N/m]", "field case 3, by hand: mean(L) W / mean(L²)", 135.8, 0.05,
         lambda: _gantry().mechanism.springs[0].strength[0],
         _mutation("gravity_series", "frames.linear(g, frames.moment(_masses(frames.tree))).scaled(-1)",
                   "frames.linear(g, frames.moment(_masses(frames.tree))).scaled(-1.1)")),
    Case("bound of the same [N]: no springs leave less", "field case 3, by hand", 16.325, 5e-4,
         lambda: float(_gantry().bound or 0),
         _mutation("mean_products", "scale[j] * _together(found, ends, ends[len(parts) - loads])",
                   "0.9 * scale[j] * _together(found, ends, ends[len(parts) - loads])")),
    Case("torque that holds a link of 2 kg at 0.3 m level [N m]", "statics: m g l", 5.886, 5e-4,
         lambda: _torque(_hinged(2.0, 0.3), 0.0), _mutation("Tree.axes", "poses.R[:, link.body] @ link.motions[0].axis",
                                                      "-(poses.R[:, link.body] @ link.motions[0].axis)")),
    Case("the same at 60 deg [N m]", "statics: m g l cos q", 2.943, 5e-4,
         lambda: _torque(_hinged(2.0, 0.3), radians(60)),
         _mutation("Tree.poses", "np.cos(s.T)[..., None, None]", "np.sin(s.T)[..., None, None]")),
)  # fmt: skip


@dataclass(frozen=True)
class Printed:
    """A row of a reproduction as a case: `section` of a module of `equipoise.reproduce` makes it."""

    section: str
    item: str
    mutation: Mutation

    @property
    def row(self) -> Row:
        return _rows(self.section)[self.item]

    def case(self) -> Case:
        """With the print as target, or where it prints none what its equations give."""
        row = self.row
        held = row.own if row.published is None or row.against else row.printed
        assert held is not None
        unit = f" [{row.unit}]" if row.unit else ""
        paper = f"[{self.mutation.paper}](papers/{self.mutation.paper}.md)"
        source = f"{paper}, by its equations" if held is row.own else paper
        return Case(row.item + unit, source, held.value, held.tolerance, lambda: row.computed, self.mutation)

    def holds(self) -> bool:
        """Whether the row is what it should be; not where the source is so broken that there is none."""
        try:
            return self.row.verdict != "FAILS"
        except Exception:
            return False


@cache
def _rows(section: str) -> dict[str, Row]:
    """The rows that a section yields before it breaks, where it does."""
    module, _, name = section.partition(":")
    found: dict[str, Row] = {}
    try:
        for row in getattr(import_module(f"equipoise.reproduce.{module}"), name)():
            found[row.item] = row
    except Exception:
        return found
    return found


PRINTS = (  # (section, item, function, what is broken in it) of a mutation of `test_mutations`
    ("lin2010.rows:_table_3", "K_2, Table 3", "Builder.build", "K"),
    ("lin2010.rows:_table_3", "l_CA,2, Table 3", "Builder.build", "a * up"),
    ("lin2010.rows:_table_3", "b_2 (14), Table 3.x", "Builder.build", "C + b * towards"),
    ("lin2010.rows:_table_2", "mu_2 (24), Table 2", "moments", "mass + beyond[i]"),
    ("lin2010.rows:_table_2", "sigma_2.x (25), Table 2", "moments", "beyond[i] * link.tip"),
    ("lin2010.rows:_table_3", "l_CB,2 (16), Table 3", "Module.lumps", "(self.coupler, self.centre)"),
    ("lin2010.rows:_table_3", "K l_CA l_CB over mu g |sigma| of link 2 (16)", "Module.lumps", "(self.mass, self.com)"),
    ("lin2010.rows:_mobility", "Eq. (19), freedoms of one RSSR module", "mobility", "freedoms - modules"),
    ("lin2010.rows:_mobility", "Eq. (20), freedoms of an arm with n = 6, 2n", "mobility", "3 * spherical"),
    ("lin2010.rows:_table_4", "motion of joint 1 against its cubic, largest difference", "CubicMove.at", "3 - 2 * s"),
    ("lin2010.rows:_table_3", "l_CB,3 (16), Table 3", "design", "g * float(np.linalg.norm(whole[i].vector))"),
    ("lenzo2017:_needed", "half the energy between a straight and a folded elbow without k12, over k2 b2 l1 (12)",
     "springs", "arm.l1 + values['b2'] * arm.x2"),
    ("lenzo2017:_needed", "variation of the energy without spring k12, Fig. 4a (12)", "springs", "values['a2'] * up"),
    ("lenzo2017:_golden", "b2 (15), layout b", "_products", "S2 / lift"),
    ("lenzo2017:_golden", "a2 (15), layout b", "_lift", "arm.chain.weight * link.along"),
    ("lenzo2017:_needed", "fewest springs with ball joints at shoulder and elbow",
     "fewest_springs", "2 if link.off_line(chain.near) else 1"),
    ("lenzo2017:_one_link", "k a b / (m g h) (7), Fig. 1", "springs", "_End(last, k, D, g * last.moment / (k * D))"),
    ("simionescu2015.full:two_axes", "Eq. (8) as printed, energy variation over psi = +-1 rad",
     "Guide.stiffness_11", "self.BF / (2 * self.CS)"),
    ("simionescu2015.full:bar", "largest Fourier coefficient that varies, m3Q = 0.15 kg at Q",
     "full", "(leg.load + guide.mass + link_2p / 2) * leg.B + leg.moment_2"),
    ("simionescu2015.rows:_example", "k7, stiffness of the example (15)",
     "best_springs", "_least_squares(on_axis[:, 1:3])"),
    ("simionescu2015.full:two_axes", "Eq. (8) as printed, energy variation over all poses",
     "Guide.stiffness_10", "self.CS * 2 * self.BF"),
    ("simionescu2015.full:bar", "k11 that m3Q = 0.15 kg adds (8), (10)",
     "Guide.stiffness_11", "self.link_9 + self.m3Q"),
    ("simionescu2015.full:two_axes", "BH shorter at psi = 0.523599 rad, section 4",
     "TwoAxisRocker.coupling", "2 * ratio"),
    ("simionescu2015.full:rocker", "largest Fourier coefficient that varies over gravity's energy, rocker (3), any phi",
     "rocker_spring", "size + share * m7 * AV"),
    ("simionescu2015.rows:_example", "largest driving moment over the range of theta_11, on the axis",
     "DeltaLeg.actuator", "self.upper ** 2 + reach ** 2 - lower ** 2"),
    ("simionescu2015.rows:_example", "m~ (22) on the axis, mean", "DeltaRobot._bodies", "self.upper / 2"),
    ("simionescu2015.rows:_example", "share of the spring's mass at V that gives the printed k7",
     "_springs", "size / AW"),
    ("cho2012.rows:_ends", "b of the left spring (12), Sec. 4.1", "_disk_spring", "vec3(B)"),
    ("cho2012.rows:_closed_forms",
     "largest Fourier coefficient that varies over gravity's energy, fixed gear near (19)-(22)",
     "_disk_spring", "cos(pi + phase)"),
    ("cho2012.rows:_differential", "2J.11 (11), fixed gear far", "differential", "-gear_ratio"),
    ("cho2012.rows:_differential", "2J.22 (11), fixed gear near", "differential", "[roll, -1.0]"),
    ("cho2012.rows:_stiffness", "k = m g l / (2 b h) (23), Sec. 4.1", "stiffness", "weight / 2"),
    ("cho2012.rows:_stiffness", "k of (23) over that of one joint's one spring (7), Sec. 5",
     "single_stiffness", "weight / (b * h)"),
    ("cho2012.rows:_closed_forms",
     "tau_m (2) against the mechanism over the hemisphere, fixed gear near: largest difference",
     "gravity_torque", "c[..., 0] * s[..., 1]"),
    ("cho2012.rows:_closed_forms",
     "s_i^2 (13)-(14) against the mechanism over the hemisphere, fixed gear near: largest difference",
     "stretch_squared", "2 * b * h"),
    ("cho2012.rows:_closed_forms",
     "tau_s (24)-(26) against the mechanism over the hemisphere, fixed gear near: largest difference",
     "disk_torque", "np.sin(theta_b)"),
    ("cho2012.rows:_closed_forms",
     "V_k (17)-(18) against the mechanism over the hemisphere, fixed gear near: largest difference",
     "balanced_spring_energy", "k * (b ** 2 + h ** 2)"),
    ("cho2012.rows:_stiffness", "both springs' stiffness over that of the one spring, Sec. 3.2",
     "_cosines", "s.weight / 2"),
    ("lee2014.rows:_blocks", "K_12 of gravity (34), over -I'", "StiffnessBlocks.gravity", "-1j * arm.gravity"),
    ("lee2014.layouts:equivalent", "blocks that (28a) changes, over the largest",
     "vector", "-one.a / arm.lengths[one.i - 1]"),
    ("lee2014.layouts:equivalent", "(28a): one of two springs 14 becomes 24: 1 if so", "exchanged", "end == 'lower'"),
    ("lee2014.layouts:equivalent",
     "blocks that spring 12 at (270, 180) instead of (90, 0) deg, Fig. 7 changes, over the largest",
     "turned", "one.b * exp(1j * angle)"),
    ("lee2014.layouts:equivalent", "blocks that spring 12 with both lengths doubled changes, over the largest",
     "resized", "a * b"),
    ("lee2014.rows:_distal_joint", "variation of the total energy, Table 5(b) with a from the joint of link i",
     "upward", "1j if i == 1 else 1.0"),
)  # fmt: skip


def _made(section: str, function: str, old: str) -> Mutation:
    paper = section.partition(":")[0].partition(".")[0]
    (found,) = (m for m in MUTATIONS if (m.paper, m.function, m.old) == (paper, function, old))
    return found


PAPERS = tuple(Printed(section, item, _made(section, function, old)) for section, item, function, old in PRINTS)
CASES: tuple[Case | Printed, ...] = (*HANDBOOK, *FIELD, *PAPERS)


def shown(x: float, digits: int = 6) -> str:
    """So many digits, and 0 for what is rounding."""
    return "0" if abs(x) < NOTHING else f"{x:.{digits}g}"


def page() -> Iterator[str]:
    """The manual in Markdown."""
    yield from HEAD.splitlines()
    for number, one in enumerate(CASES, 1):
        case = one.case() if isinstance(one, Printed) else one
        broken = f"`{case.mutation.function}`: `{case.mutation.old}` → `{case.mutation.new}`"
        tolerance = f"{case.tolerance:.1g}"
        cells = (number, case.what, case.source, shown(case.target, 7), shown(case.compute()), tolerance, broken)
        yield f"| {' | '.join(str(cell).replace('|', BAR) for cell in cells)} |"


HEAD = """\
# Verification manual

Numbers that others have printed, or that follow by hand from a rule of theirs, beside what this program computes. Each
line catches a mistake: the one in its last column is made in a copy of the source by `tests/test_verification.py`, and
the line then fails. `make verification` makes this page. The [papers](index.md) have pages of their own, and `equipoise
reproduce` has all of their numbers. A field case is a mechanism of a user, whose answer was worked out by hand.

| | what | source | printed | computed | tolerance | a mistake that it catches |
|---|---|---|---|---|---|---|
"""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="make the page")
    parser.add_argument("--only", default="", help="numbers of cases")
    given = parser.parse_args()
    chosen = [int(number) for number in given.only.split(",")] if given.only else range(1, len(CASES) + 1)
    off = [number for number in chosen if not CASES[number - 1].holds()]
    for number in off:
        one = CASES[number - 1]
        what = one.item if isinstance(one, Printed) else f"{one.what}: {one.target}"
        print(f"case {number} is off: {what}", file=sys.stderr)
    if given.write:
        PAGE.write_text("\n".join(page()) + "\n", encoding="utf-8")
    return 1 if off else 0


if __name__ == "__main__":
    sys.exit(main())

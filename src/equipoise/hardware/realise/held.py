"""Springs of a file that are real already: parts as bought, hooked, gas and torsion springs, behind a cable or not.

What is bought keeps what its list says; what is not is wound to do the same. Each with its margins over the workspace.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from math import degrees, inf
from typing import Any

import numpy as np

from ...balance import Balance
from ...energy.reference import Reference
from ...energy.spring_use import SpringUse
from ...kinematics import Tree, sample
from ...model.elements import Element, LineElement, Spring, TorsionSpring
from ...model.elements.guides import Pulley
from ...model.elements.laws import Compression, Extension, Gas
from ...model.elements.laws.gas import STATED
from ...model.mechanism import Mechanism
from ..sizing.torsion import torsion
from ..sizing.winding import Need, Winding, compression, extension
from ..sizing.wire import MM
from ..stock.part import Stock, endurance
from .realisations import FRICTION, Options

WARMER = 20.0  # [K] about 20 C that a gas spring is judged at
POSES = 512


@dataclass(frozen=True)
class Held:
    """A real spring and its margins.

    Attributes:
        order: what to order or wind.
        force: least and largest [N or N m]. static, fatigue: margins, None where they are not known.
        notes: what else there is to know. faults: why it will not do.
    """

    name: str
    kind: str
    part: str
    realisation: str
    order: str
    force: tuple[float, float]
    unit: str
    static: float | None
    fatigue: float | None
    notes: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()


@dataclass(frozen=True)
class Kit:
    """All springs of a mechanism whose springs are real."""

    balance: Balance
    items: tuple[Held, ...]
    options: Options

    @property
    def complete(self) -> bool:
        """Whether every spring holds what is asked of it."""
        return not any(item.faults for item in self.items)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is wrong, by spring."""
        return tuple(f"{item.name} {fault}" for item in self.items for fault in item.faults)

    def to_dict(self) -> dict[str, Any]:
        """The JSON object of ``equipoise hardware --json``."""
        return {
            "mechanism": self.balance.mechanism.name,
            "complete": self.complete,
            "springs": [asdict(item) for item in self.items],
            "warnings": list(self.warnings),
            "residual": {"design": self.balance.residual.max.tolist(), "design_share": self.balance.relative},
        }


def real(mechanism: Mechanism) -> bool:
    """Whether any spring of a mechanism is more than a line on paper."""
    return any(not isinstance(s, Spring) or s.part for s in mechanism.springs)


def kit(balance: Balance, options: Options | None = None) -> Kit:
    """The springs of a judged mechanism with their margins; those without a part are wound, as `options` say."""
    options, mechanism = options or Options(), balance.mechanism
    known = {one["part"]: _part(one) for one in mechanism.provenance.get("parts", ()) if isinstance(one, Mapping)}
    items = [
        _held(balance, i, spring, use, known.get(getattr(spring, "part", "")), options)
        for i, (spring, use) in enumerate(zip(mechanism.springs, balance.use, strict=True))
    ]
    return Kit(balance, tuple(items), options)


def _part(values: Mapping[str, Any]) -> Stock:
    names = {f.name for f in fields(Stock)}
    return Stock(**{name: value for name, value in values.items() if name in names and value is not None})


def _held(balance: Balance, i: int, spring: Element, use: SpringUse, part: Stock | None, options: Options) -> Held:
    limits = options.limits
    least, most = sorted(map(abs, use.force)) if use.force[0] * use.force[1] >= 0 else (0.0, max(map(abs, use.force)))
    order, static, fatigue, notes, faults = "", None, None, [], []
    law, realisation = spring.law, getattr(spring, "realisation", "")
    if part is not None:
        order = f"part {part.part}"
        if part.kind in ("extension", "compression"):
            static = part.max_force / most if most else inf
            top, bottom = endurance(part, limits)
            fatigue = limits.fatigue / (top * most - bottom * least) if top else None
        elif part.kind == "torsion":
            static = part.max_torque / most if most else inf
    elif isinstance(spring, TorsionSpring):
        order, static, fatigue, faults = _coiled(spring, use, least, most, options)
    elif isinstance(law, (Extension, Compression)):
        winding = _wound(law, least, most, options)
        s = winding.spring
        size = f"d {s.d / MM:.3g} mm, De {s.outer / MM:.4g} mm, {s.n:.4g} coils, L0 {s.free_length / MM:.4g} mm"
        order = f"wind {s.wire.name}, {size}"
        if not winding.feasible:
            faults.append(winding.reason)
        static, fatigue = float(s.static_margin(most, limits)), float(s.fatigue_margin(least, most, limits))
    elif isinstance(spring, Spring):
        faults.append("is a spring on paper; `equipoise stock` or `design --realise` makes it real")
    else:
        order = f"{law.noun.split(' ', 1)[1]}, {law.words()}"
    if isinstance(law, Gas):
        order = order or f"gas spring, {law.words()}"
        notes.append(_temperature(balance, i))
    notes += _cable(balance, spring)
    for name, value, asked in (("static", static, limits.safety), ("fatigue", fatigue, limits.fatigue)):
        if value is not None and value < asked * (1 - 1e-6) and not faults:
            faults.append(f"has a {name} margin of {value:.2f}, less than {asked:g}")
    faults += [f"is {one.state.name} in {100 * one.share:.3g} % of the poses" for one in use.reached if one.state.limit]
    notes += [f"{one.state.name} in {100 * one.share:.3g} % of the poses" for one in use.reached if not one.state.limit]
    return Held(
        spring.name, spring.kind, getattr(spring, "part", ""), realisation, order, use.force, spring.force_unit, static,
        fatigue, tuple(notes), tuple(faults),
    )  # fmt: skip


def _wound(law: Extension | Compression, least: float, most: float, options: Options) -> Winding:
    if isinstance(law, Compression):
        return compression(Need(law.stiffness, least, most), options.wires, options.limits, options.envelope)
    need = Need(law.stiffness, max(least, law.initial_tension), most)
    free = law.body_length - law.initial_tension / law.stiffness
    return extension(
        need, options.wires, options.limits, options.envelope, free=free, closed=law.body_length * (1 + 1e-9)
    )


def _coiled(
    spring: TorsionSpring, use: SpringUse, least: float, most: float, options: Options
) -> tuple[str, float | None, float | None, list[str]]:
    if min(use.force) < -1e-9 * most and max(use.force) > 1e-9 * most:
        why = "turns through its rest, and a coil may only be wound up: two against each other or another rest would do"
        return "", None, None, [why]
    found = torsion(spring.stiffness, least, most, options.wires, options.limits, options.envelope.outer)
    s, turned = found.spring, most / spring.stiffness
    order = (
        f"wind {s.wire.name}, d {s.d / MM:.3g} mm, De {s.outer / MM:.4g} mm, {s.n:.4g} coils, {1000 * s.mass:.4g} g, "
        f"turned {degrees(least / spring.stiffness):.0f} to {degrees(turned):.0f} deg, on a mandrel of "
        f"{s.mandrel(turned) / MM:.3g} mm, {s.body(turned) / MM:.3g} mm long"
    )
    return order, found.static, found.fatigue, []


def _temperature(balance: Balance, i: int) -> str:
    """What warmth does to a gas spring, and to the torque that is left."""
    tree = Tree.of(balance.mechanism)
    law = balance.mechanism.springs[i].law
    own = balance.mechanism.with_springs([balance.mechanism.springs[i]])
    torque = np.abs(Reference(own)(sample(tree, POSES)).spring_torque).max(axis=0)
    share = WARMER / STATED
    moved = ", ".join(
        f"{c} {share * t / law.warmth:.3g} {c.load_unit}" for c, t in zip(tree.coordinates, torque, strict=True) if t
    )
    return (
        f"its force is {100 * (1 - share):.1f} % at 0 degC and {100 * (1 + share):.1f} % at 40 degC of that at "
        f"20 degC, which moves the torque by up to {moved}"
    )


def _cable(balance: Balance, spring: Element) -> list[str]:
    """What its cable's guides cost: friction, and of a pulley that its length is not the distance to the centre."""
    if not isinstance(spring, LineElement) or not spring.via:
        return []
    tree, notes = Tree.of(balance.mechanism), []
    poses = tree.poses(sample(tree, POSES))
    for guide in spring.via:
        kind = "pulley" if isinstance(guide, Pulley) else "eyelet"
        notes.append(f"friction at its {kind} is {100 * FRICTION[kind]:g} % of its force, assumed")
        if isinstance(guide, Pulley) and len(spring.via) == 1:
            centre, end = (
                poses.point(tree.index[body], np.array(p))
                for body, p in ((guide.body, guide.point), (spring.body_b, spring.p_b))
            )
            off = spring.path(tree, poses) - np.linalg.norm(end - centre, axis=1)
            notes.append(
                f"the pulley's error: its length is within {1e3 * np.ptp(off) / 2:.3g} mm of the distance to the "
                "pulley's centre and a constant; what is left counts it"
            )
    return notes

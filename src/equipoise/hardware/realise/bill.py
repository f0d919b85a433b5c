"""The bill of materials of a design: for every spring what to wind or buy and how to install it, and what is left then.

The finished mechanism is judged as it is built: all springs stretched by the laws of their realisations, with their
masses.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from ...balance import Balance, judged
from ...energy.spring_use import SpringUse
from ...io import Source
from ...model.elements import Spring, lines
from ...model.errors import Fault, InputError, nearest
from ...model.mechanism import Mechanism
from ...model.notebook import Shown
from ...model.progress import Progress, silent
from ..sizing.compression import CompressionSpring
from ..sizing.extension import ExtensionSpring
from ..sizing.limits import SOURCES, Limits
from ..sizing.winding import NO_TENSION
from .installed import InstalledTorque, installed_torque
from .realisations import KINDS, Options, Realisation, rank, realisations
from .remedies import remedies
from .stretch import Straight


@dataclass(frozen=True)
class BillItem:
    """A spring of the design and the ways to make it, the best first.

    Attributes:
        remedies: where it cannot be made, what alone would make it possible.
    """

    spring: Spring
    use: SpringUse
    ways: tuple[Realisation, ...]
    remedies: tuple[str, ...] = ()

    @property
    def chosen(self) -> Realisation | None:
        """The best that works."""
        return self.ways[0] if self.ways[0].works else None

    @property
    def hopeless(self) -> str:
        """Why it cannot be made, and what would help."""
        return f"cannot be made: {self.ways[0].reason}. What would help: {'; or '.join(self.remedies)}"

    def forces(self, way: Realisation) -> tuple[float, float]:
        """Least and largest force of each of the springs side by side, made in this way [N]."""
        # a free length that is left makes the spring pull less
        free = way.stretch.free_length if isinstance(way.stretch, Straight) else self.spring.free_length
        k = self.spring.stiffness / way.winding.count
        most = k * (self.use.max_length - free)
        least = k * max(self.use.min_length - free, 0.0)
        return (least if least > NO_TENSION * most else 0.0), most


@dataclass(frozen=True)
class Bill(Shown):
    """The bill of materials.

    Attributes:
        balance: of the design as it stands on paper.
        built: the mechanism with the springs' masses; None when some spring cannot be made.
        left: what is left unbalanced when it is built; None likewise.
    """

    balance: Balance
    items: tuple[BillItem, ...]
    options: Options
    built: Mechanism | None
    left: InstalledTorque | None

    @property
    def complete(self) -> bool:
        """Whether every spring can be made."""
        return all(item.chosen for item in self.items)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What whoever builds it has to know: springs that cannot be made, and those that will break."""
        found = [f"{item.spring.name} {item.hopeless}" for item in self.items if not item.chosen]
        limits = self.options.limits
        margins = {i.spring.name: way_dict(i, i.chosen, limits)["fatigue_margin"] for i in self.items if i.chosen}
        weak = [f"{name} ({margin:.2f})" for name, margin in margins.items() if margin < 1]
        if weak:
            found.append(
                f"will break before {limits.cycles:g} cycles over its whole range (fatigue margin under 1): "
                f"{', '.join(weak)}; --fatigue 1 asks for springs that endure"
            )
        return tuple(found)

    @property
    def mass(self) -> float:
        """[kg] of all springs that can be made."""
        return sum(item.chosen.winding.mass for item in self.items if item.chosen)

    def to_dict(self) -> dict[str, Any]:
        """The JSON object of ``equipoise hardware --json``."""
        return {
            "mechanism": self.balance.mechanism.name,
            "complete": self.complete,
            "mass": self.mass,
            "springs": [_item(item, self.options.limits) for item in self.items],
            "warnings": list(self.warnings),
            "residual": {"design": self.balance.residual.max.tolist(), "design_share": self.balance.relative}
            | (_left(self.left) if self.left else {}),
            "limits": {
                name: {"value": value, "source": SOURCES[name]} for name, value in asdict(self.options.limits).items()
            },
        }


def bill(
    balance: Balance | Source,
    options: Options | None = None,
    kind: str | None = None,
    progress: Progress | None = None,
) -> Bill:
    """The bill of a judged design.

    Args:
        kind: the realisation of every spring, one of `KINDS`; by default the one that leaves least, then the lightest.

    Raises:
        InputError: no springs, or an unknown kind.
    """
    options, balance = options or Options(), judged(balance)
    mechanism = balance.mechanism
    if not mechanism.springs:
        raise InputError(Fault(("springs",), f"mechanism '{mechanism.name}' has none; design some first"))
    if kind is not None and kind not in KINDS:
        raise InputError(Fault(("realise",), f"unknown realisation {nearest(kind, KINDS)}", KINDS))
    items, springs, report = [], lines(mechanism, "hardware"), progress or silent
    for i, (spring, use) in enumerate(zip(springs, balance.use, strict=True)):
        report(f"spring {i + 1} of {len(springs)}", i / (len(springs) + 1))
        ways = sorted(realisations(balance, i, options), key=rank)
        if kind is not None:
            ways.sort(key=lambda way: way.kind != kind)
        helped = () if ways[0].works else remedies(balance, i, options, kind)
        items.append(BillItem(spring, use, tuple(ways), helped))
    chosen = [item.chosen for item in items]
    made = [way for way in chosen if way is not None]
    if len(made) < len(chosen):
        return Bill(balance, tuple(items), options, None, None)
    built = mechanism.with_springs(_heavy(spring, way) for spring, way in zip(springs, made, strict=True))
    report("judging what is built", 1 - 1 / (len(chosen) + 1))
    left = installed_torque(built, [way.stretch for way in made], [way.friction for way in made])
    return Bill(balance, tuple(items), options, built, left)


def _heavy(spring: Spring, way: Realisation) -> Spring:
    """With its free length and mass; a spring that a cable pulls stays with A's body, any other is split evenly."""
    free = way.stretch.free_length if isinstance(way.stretch, Straight) else spring.free_length
    split = 1.0 if way.kind in ("pulley", "eyelet") else 0.5
    return replace(spring, free_length=free, mass=spring.mass + way.winding.mass, mass_split=split)


def _item(item: BillItem, limits: Limits) -> dict[str, Any]:
    return {
        "name": item.spring.name,
        "rate": item.spring.stiffness,
        "free_length": item.spring.free_length,
        "min_length": item.use.min_length,
        "max_length": item.use.max_length,
        "max_force": item.use.max_force,
        "chosen": item.chosen.kind if item.chosen else None,
        "remedies": list(item.remedies),
        "realisations": [way_dict(item, way, limits) for way in item.ways],
    }


def way_dict(item: BillItem, way: Realisation, limits: Limits) -> dict[str, Any]:
    """All about one realisation; forces, sizes and mass are of each of the springs side by side."""
    s, count = way.winding.spring, way.winding.count
    least, most = item.forces(way)
    extension = isinstance(s, ExtensionSpring)
    return {
        "kind": way.kind,
        "works": way.works,
        "reason": way.reason or None,
        "spring": "extension" if extension else "compression",
        "count": count,
        "wire": f"{s.wire.standard} {s.wire.name}",
        "wire_diameter": s.d,
        "coil_diameter": s.D,
        "outer_diameter": s.outer,
        "index": s.index,
        "coils": s.n,
        "rate": s.rate,
        "free_length": s.free_length,
        "length_in_use": sorted((float(s.length(least)), float(s.length(most)))),
        "initial_tension": s.initial_tension if isinstance(s, ExtensionSpring) else None,
        "left_over": s.left_over if isinstance(s, ExtensionSpring) else None,
        "solid_length": s.solid_length if isinstance(s, CompressionSpring) else None,
        "buckling_stroke": _finite(s.buckling_stroke()) if isinstance(s, CompressionSpring) else None,
        "max_force": most,
        "stress": s.stress(most),
        "corrected_stress": s.corrected(most),
        "strength": s.strength,
        "static_margin": s.static_margin(most, limits),
        "hook_margin": float(s.hook_margin(most, limits)) if isinstance(s, ExtensionSpring) else None,
        "fatigue_margin": s.fatigue_margin(least, most, limits),
        "natural_frequency": float(s.frequency),
        "mass": s.mass,
        "case_behind": way.behind,
        "friction": way.friction,
        "residual": None if way.residual is None else way.residual.tolist(),
        "residual_share": way.share,
    }


def _left(left: InstalledTorque) -> dict[str, Any]:
    return {"built": left.residual.tolist(), "built_share": left.share, "friction": left.friction.tolist()}


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None

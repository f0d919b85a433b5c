"""Inverse design: the lightest spring that can be wound, by enumeration of all preferred wires and coil diameters.

Every pair of a preferred wire diameter and a coil diameter in steps of `STEP` is tried, with just as many coils as the
rate asks for: on that grid the answer is exact. Where one spring cannot do it, equal springs side by side share it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from math import inf
from typing import TypeVar

import numpy as np

from ...model.arrays import Array
from ...model.errors import Fault, InputError
from ...model.units import AmountField
from .compression import CompressionSpring, least_free_length
from .extension import LOOP, ExtensionSpring
from .helical import Helical, coils_for
from .limits import Limits
from .wire import MM, Wire

STEP = 0.1 * MM  # of the mean coil diameter
MOST_PARALLEL = 8
S = TypeVar("S", ExtensionSpring, CompressionSpring)
NOTHING = 1e-3  # of the largest force: less initial tension than this is none
SAME = 1e-9  # margins this close to what is asked for reach it


@dataclass(frozen=True)
class Need:
    """What a spring must do.

    Attributes:
        rate: [N/m].
        least, most: [N] the forces between which it works.
    """

    rate: float
    least: float
    most: float

    def __post_init__(self) -> None:
        if not (0 < self.rate < inf and 0 <= self.least <= self.most < inf and self.most > 0):
            found = f"rate {self.rate:g} N/m, forces {self.least:g} to {self.most:g} N"
            raise InputError(Fault(("need",), f"a spring needs a positive rate and a range of forces, found {found}"))

    def shared(self, count: int) -> Need:
        """What each of `count` equal springs side by side must do."""
        return Need(self.rate / count, self.least / count, self.most / count)


@dataclass(frozen=True)
class Envelope:
    """The room for each spring: greatest outer diameter and greatest length in use [m]."""

    outer: AmountField = AmountField("length", inf)
    length: AmountField = AmountField("length", inf)


@dataclass(frozen=True)
class Winding:
    """The answer of the enumeration.

    Attributes:
        spring: the lightest that can do it; where none can, the one that comes nearest.
        count: equal springs side by side, of which `spring` is one.
        margins: what it reaches of everything that is asked for; all at least 1 when it can do it.
        tried: candidates.
    """

    spring: ExtensionSpring | CompressionSpring
    count: int
    margins: Mapping[str, float]
    tried: int

    @property
    def feasible(self) -> bool:
        """Whether it can do what it must."""
        return min(self.margins.values()) >= 1 - SAME

    @property
    def mass(self) -> float:
        """[kg] of all of them."""
        return float(self.count * self.spring.mass)

    @property
    def reason(self) -> str:
        """Why no spring can do it; empty when one can."""
        if self.feasible:
            return ""
        short = ", ".join(
            f"{name.replace('_', ' ')} {value:.3g}" for name, value in self.margins.items() if value < 1 - SAME
        )
        s = self.spring
        nearest = f"d {s.d / MM:.3g} mm, D {s.D / MM:.4g} mm, {s.n:.3g} coils of {s.wire.name}"
        many = "one spring" if self.count == 1 else f"{self.count} springs side by side"
        return f"{many} cannot: of {self.tried:,} candidates the nearest ({nearest}) reaches of what is needed: {short}"


Order = Callable[[ExtensionSpring], Array]


def extension(
    need: Need,
    wires: Sequence[Wire],
    limits: Limits | None = None,
    envelope: Envelope | None = None,
    *,
    free: float = 0.0,
    closed: float = inf,
    order: Order | None = None,
) -> Winding:
    """The lightest extension spring: open at all forces, with as much initial tension as that and its index allow.

    Args:
        free: the free length [m] of the line F = k (L - free) that is wanted; see `ExtensionSpring.left_over`.
        closed: greatest length [m] between the loops of the unloaded spring.
        order: what is least of all, before the mass.
    """
    limits, envelope = limits or Limits(), envelope or Envelope()

    def candidates(coils: Helical) -> tuple[ExtensionSpring, dict[str, Array]]:
        least = need.least if need.least > NOTHING * need.most else 0.0
        stress = np.minimum(limits.initial_stress(coils.index, coils.strength), coils.stress(least))
        tension = coils.force_at(stress)
        # loops may be drawn out until the line is the one that is wanted
        hook = np.maximum(LOOP * coils.inner, (free + tension / need.rate - (coils.n + 1) * coils.d) / 2)
        spring = ExtensionSpring(coils.wire, coils.d, coils.D, coils.n, stress, hook)
        return spring, _margins(
            limits,
            coils=coils.n / limits.coils_extension,
            stress=spring.static_margin(need.most, limits) / limits.safety,
            hooks=spring.hook_margin(need.most, limits) / limits.safety,
            fatigue=spring.fatigue_margin(need.least, need.most, limits) if limits.fatigue else None,
            length=envelope.length / spring.length(need.most),
            closed_length=closed / spring.free_length,
        )

    return _lightest([candidates(coils) for coils in _grid(need.rate, wires, limits, envelope)], order)


def compression(
    need: Need,
    wires: Sequence[Wire],
    limits: Limits | None = None,
    envelope: Envelope | None = None,
) -> Winding:
    """The lightest compression spring whose stroke is enough for the largest force."""
    limits, envelope = limits or Limits(), envelope or Envelope()

    def candidates(coils: Helical) -> tuple[CompressionSpring, dict[str, Array]]:
        length = least_free_length(coils, need.most / need.rate)
        spring = CompressionSpring(coils.wire, coils.d, coils.D, coils.n, length)
        return spring, _margins(
            limits,
            coils=coils.n / limits.coils_compression,
            stress=spring.static_margin(need.most, limits) / limits.safety,
            fatigue=spring.fatigue_margin(need.least, need.most, limits) if limits.fatigue else None,
            length=envelope.length / length,
            free_length=limits.free_length / length,
            slenderness=limits.slenderness * coils.D / length,
        )

    return _lightest([candidates(coils) for coils in _grid(need.rate, wires, limits, envelope)], None)


def side_by_side(wind: Callable[[Need], Winding], need: Need, most: int = MOST_PARALLEL) -> Winding:
    """The fewest equal springs that can do it together; of `most` where even they cannot."""
    found = wind(need)
    for count in range(2, most + 1):
        if found.feasible:
            break
        found = replace(wind(need.shared(count)), count=count)
    return found


def _grid(rate: float, wires: Sequence[Wire], limits: Limits, envelope: Envelope) -> list[Helical]:
    """For each wire, every preferred diameter with every coil diameter of a permitted index."""
    found = []
    for wire in wires:
        d = wire.preferred
        low, high = limits.index
        steps = np.arange(np.ceil(low * d[0] / STEP), np.floor(min(high * d[-1], envelope.outer) / STEP) + 1) * STEP
        d_all, D_all = (x.ravel() for x in np.meshgrid(d, steps))
        slack = 1e-9
        good = (D_all >= low * d_all * (1 - slack)) & (D_all <= high * d_all * (1 + slack))
        good &= D_all + d_all <= envelope.outer * (1 + slack)
        d_all, D_all = d_all[good], D_all[good]
        if len(d_all):
            found.append(Helical(wire, d_all, D_all, coils_for(wire, d_all, D_all, rate)))
    if not found:
        names = ", ".join(wire.name for wire in wires)
        thinnest = f"no preferred {names} wire can be wound within an outer diameter of {envelope.outer / MM:g} mm"
        raise InputError(Fault(("envelope",), f"{thinnest} and an index from {limits.index[0]:g}"))
    return found


def _margins(limits: Limits, fatigue: Array | None = None, **margins: Array) -> dict[str, Array]:
    return margins if fatigue is None else {**margins, "fatigue": fatigue / limits.fatigue}


def _lightest(candidates: Sequence[tuple[S, dict[str, Array]]], order: Callable[[S], Array] | None) -> Winding:
    tried = sum(len(spring.d) for spring, _ in candidates)
    best = []
    for spring, margins in candidates:
        least = np.minimum(np.min(np.stack(list(margins.values())), axis=0), 1 - SAME)
        first = np.zeros_like(least) if order is None else order(spring)
        # the nearest to feasible, then the first in order, then the lightest
        i = int(np.lexsort((spring.mass, first, -least))[0])
        found = Winding(_one(spring, i), 1, {name: float(values[i]) for name, values in margins.items()}, tried)
        best.append(((-least[i], first[i], spring.mass[i]), found))
    return min(best, key=lambda item: item[0])[1]


def _one(springs: S, i: int) -> S:
    """One spring of an array of them."""
    arrays = {f.name: getattr(springs, f.name) for f in fields(springs) if f.name != "wire"}
    return replace(springs, **{name: float(values[i]) for name, values in arrays.items()})

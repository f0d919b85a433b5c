"""A payload, or a range of payloads, at one point of a link: what to balance, and what fixed springs leave.

The residual torque at a pose is linear in the payload less the balanced one. So its peak over the workspace is the
same at both ends of a range when the middle is balanced, and by the triangle inequality no fixed springs leave less at
the worse end: the middle is the minimax choice, whatever the workspace.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..balance import check
from ..io import Source, loaded
from ..io.text import Names
from ..model.arrays import Array, frozen
from ..model.elements import Element
from ..model.errors import Fault, InputError, nearest
from ..model.mechanism import Mechanism, PointMass
from ..model.units import Amount, quantity
from .arms.shoulder import Shoulder
from .given import number, vectors


@frozen
class Payload:
    """From `low` to `high` [kg] at `place` (3,) [m] in the frame of `link`; both zero without one."""

    link: str
    low: float
    high: float
    place: Array

    @staticmethod
    def of(shoulder: Shoulder, masses: Sequence[Amount] | None, place: Sequence[Amount] | None) -> Payload:
        """One mass or a range, at a point of the pitch link or at its mass centre.

        Raises:
            InputError: not one or two masses, or not a point.
        """
        link = shoulder.pitch
        if place is None:
            own = sum(m for m, _ in link.lumps)
            at = link.origin + (sum((m * p for m, p in link.lumps), np.zeros(3)) / own if own else 0.0)
        else:
            at = vectors("payload_at", {link.name: place}, [link.name])[link.name]
        low, high = _range((0.0,) if masses is None else masses)
        return Payload(link.name, low, high, at)

    @staticmethod
    def at(
        mechanism: Source, masses: Amount | Sequence[Amount], body: str, place: Sequence[Amount] = (0, 0, 0)
    ) -> Payload:
        """One mass or a range [kg] at a point [m] of any body that moves.

        Raises:
            InputError: not one or two masses, no such body, or not a point.
        """
        names = loaded(mechanism).body_names
        if body not in names:
            raise InputError(Fault(("payload_on",), f"there is no body {nearest(body, names)}", names))
        low, high = _range((masses,) if isinstance(masses, (str, float, int)) else masses)
        point = [quantity(x, "length", "payload_at", body) for x in place]
        return Payload(body, low, high, vectors("payload_at", {body: point}, [body])[body])

    @property
    def middle(self) -> float:
        """[kg] what to balance."""
        return (self.low + self.high) / 2

    @property
    def span(self) -> list[float]:
        """The mass, or the smallest and largest [kg]."""
        return [self.low] if self.low == self.high else [self.low, self.high]

    def on(self, mechanism: Mechanism, mass: float) -> Mechanism:
        """The mechanism with this mass [kg] of payload."""
        if not mass:
            return mechanism
        x, y, z = self.place.tolist()
        name = Names(point.name for point in mechanism.masses).new("payload")
        return mechanism.with_masses((*mechanism.masses, PointMass(name, self.link, mass, (x, y, z))))

    def residual(self, mechanism: Mechanism, springs: Sequence[Element]) -> dict[str, float]:
        """Peak residual torque of each coordinate [N m] that springs leave at either end of the range."""
        low, high = (check(self.on(mechanism, mass).with_springs(springs)) for mass in (self.low, self.high))
        return dict(zip(low.coordinates, np.maximum(low.residual.max, high.residual.max).tolist(), strict=True))


def _range(masses: Sequence[Amount]) -> tuple[float, float]:
    if len(masses) not in (1, 2):
        raise InputError(Fault(("payload",), f"must be one mass, or the smallest and largest, found {[*masses]}"))
    low, high = (number("payload", quantity(m, "mass", "payload"), positive=False) for m in (masses[0], masses[-1]))
    if high < low:
        raise InputError(Fault(("payload",), f"the smallest comes first, found {low:g} kg, {high:g} kg"))
    return low, high

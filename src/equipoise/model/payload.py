"""A payload, or a range of payloads, at one point of a link: what to balance, and what fixed springs leave.

The residual torque at a pose is linear in the payload less the balanced one. So its peak over the workspace is the
same at both ends of a range when the middle is balanced, and by the triangle inequality no fixed springs leave less at
the worse end: the middle is the minimax choice, whatever the workspace.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .arrays import Array, frozen
from .errors import Fault, InputError, nearest
from .goal import masses as mass_range
from .mechanism import Mechanism, PointMass
from .names import Names
from .units import Amount, point


@frozen
class Payload:
    """From `low` to `high` [kg] at `place` (3,) [m] in the frame of `link`; both zero without one."""

    link: str
    low: float
    high: float
    place: Array

    @staticmethod
    def at(
        mechanism: Mechanism, masses: Amount | Sequence[Amount], body: str, place: Sequence[Amount] = (0, 0, 0)
    ) -> Payload:
        """One mass or a range [kg] at a point [m] of any body that moves.

        Raises:
            InputError: not one or two masses, no such body, or not a point.
        """
        if body not in mechanism.body_names:
            problem = f"there is no body {nearest(body, mechanism.body_names)}"
            raise InputError(Fault(("payload_on",), problem, mechanism.body_names))
        low, high = mass_range(masses)
        return Payload(body, low, high, np.array(point(place, "payload_at", body)))

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

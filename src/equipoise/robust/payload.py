"""A design under a range of payloads: what fixed springs leave at each, and which payload is best to balance.

The residual torque at a pose is linear in the payload, so its peak is convex in it: over a range it is largest at an
end, and at half way between two payloads at most the mean of theirs.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..balance import Balance, check
from ..errors import Fault, InputError, nearest
from ..io.text import Names
from ..mechanism import Mechanism, PointMass
from ..spring import Vec3
from ..validate import whole_number


@dataclass(frozen=True)
class Sweep:
    """The verdict at each payload [kg]."""

    payloads: tuple[float, ...]
    balances: tuple[Balance, ...]

    @property
    def worst(self) -> Balance:
        """The verdict at the payload with the largest residual torque."""
        return max(self.balances, key=lambda balance: float(balance.residual.max.max(initial=0)))

    def to_dict(self) -> dict[str, Any]:
        return {
            "payloads": list(self.payloads),
            "residual": [balance.residual.max.tolist() for balance in self.balances],
            "exact": [balance.exact for balance in self.balances],
        }


def sweep(
    mechanism: Mechanism, low: float, high: float, body: str, place: Vec3 = (0.0, 0.0, 0.0), *, steps: int = 5
) -> Sweep:
    """Judge fixed springs at `steps` payloads from `low` to `high` [kg] at `place` [m] in the frame of `body`.

    Raises:
        InputError: no such body, or no such range.
    """
    whole_number("steps", steps, 2, 1000)
    if body not in mechanism.body_names:
        problem = f"there is no body {nearest(body, mechanism.body_names)}"
        raise InputError(Fault(("payload_on",), problem, mechanism.body_names))
    if not 0 <= low <= high < np.inf:
        raise InputError(Fault(("payload",), f"must be at least 0 kg, the smallest first, found {low:g} to {high:g}"))
    payloads = np.linspace(low, high, steps if high > low else 1).tolist()
    return Sweep(tuple(payloads), tuple(check(loaded(mechanism, mass, body, place)) for mass in payloads))


def loaded(mechanism: Mechanism, mass: float, body: str, place: Vec3) -> Mechanism:
    """The mechanism with so much payload [kg]."""
    name = Names(point.name for point in mechanism.masses).new("payload")
    return mechanism.with_masses((*mechanism.masses, PointMass(name, body, mass, place))) if mass else mechanism

"""Load cases: what has to be balanced, each a way in which the mechanism is loaded, and how much it counts."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from ..model.elements import Vec3
from ..model.mechanism import Mechanism, PointMass
from .given import number


@dataclass(frozen=True)
class Load:
    """Masses that hang on the mechanism beside its own, and the gravity that acts on all of them.

    Attributes:
        weight: what its mean square torque counts, relative to that of the other loads.
        masses: payloads, tools.
        gravity: in the world's frame [m/s^2], of a tilted base for example; None is the mechanism's own.

    Raises:
        InputError: a weight that is not more than 0.
    """

    name: str
    weight: float = 1.0
    masses: tuple[PointMass, ...] = ()
    gravity: Vec3 | None = None

    def __post_init__(self) -> None:
        number("weight", self.weight, positive=True)
        object.__setattr__(self, "masses", tuple(self.masses))

    def on(self, mechanism: Mechanism) -> Mechanism:
        """The mechanism loaded like this.

        Raises:
            InputError: it has no such body, or a mass of that name already.
        """
        if self.masses:
            mechanism = mechanism.with_masses((*mechanism.masses, *self.masses))
        return mechanism if self.gravity is None else replace(mechanism, gravity=self.gravity)

    def to_dict(self) -> dict[str, Any]:
        """As plain data."""
        masses = [
            {"name": mass.name, "body": mass.body, "mass": mass.mass, "position": list(mass.position)}
            for mass in self.masses
        ]
        gravity = None if self.gravity is None else list(self.gravity)
        return {"name": self.name, "weight": self.weight, "masses": masses, "gravity": gravity}


OWN = Load("own")
"""The mechanism as it is."""

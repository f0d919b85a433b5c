"""The counterweights of a design, and how much they have to weigh for how little to be left."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from ..model.mechanism import PointMass


@dataclass(frozen=True)
class MassRow:
    """A point of the front: `mass` [kg] is enough to leave at most `residual` [N m] rms, less than `bound` is not."""

    residual: float
    mass: float
    bound: float


@dataclass(frozen=True)
class Counterweights:
    """The weights of a design.

    Attributes:
        weights: as masses of the mechanism.
        bound: [kg] no weights of less in total, with any springs of the problem, leave as little.
        residual: [N m] rms that was to be left at most; 0 for exact balance.
        front: mass against residual, from no weights to `residual`, when it was asked for.
    """

    weights: tuple[PointMass, ...]
    bound: float
    residual: float
    front: tuple[MassRow, ...] = ()

    @property
    def mass(self) -> float:
        """[kg] of all together."""
        return sum(weight.mass for weight in self.weights)

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        weights = [{"name": w.name, "body": w.body, "mass": w.mass, "position": list(w.position)} for w in self.weights]
        rows = [asdict(row) for row in self.front]
        return {"mass": self.mass, "bound": self.bound, "residual": self.residual, "weights": weights, "front": rows}

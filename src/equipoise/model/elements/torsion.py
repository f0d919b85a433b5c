"""The torsion spring: the angle of a joint, or a sum of several with ratios, as path, times the linear law."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import degrees
from typing import Any

from .element import Range
from .laws import Torsional
from .on_joints import OnJoints


@dataclass(frozen=True)
class TorsionSpring(OnJoints):
    """A linear spring on the angle of a joint, or on ``sum(ratio * angle)`` of several.

    Its energy is ``stiffness/2 * (angle - rest)**2``: it turns back both ways.

    Attributes:
        joints: (name, ratio) of each revolute joint.
        stiffness: [N m/rad], positive.
        rest: the angle at which it exerts nothing [rad].
        part: what it is ordered by.
    """

    name: str
    joints: tuple[tuple[str, float], ...]
    stiffness: float
    rest: float = 0.0
    part: str = ""

    @property
    def law(self) -> Torsional:
        return Torsional(self.stiffness, self.rest)

    @property
    def keys(self) -> dict[str, Any]:
        own = {"part": self.part} if self.part else {}
        return {"joints": dict(self.joints), "stiffness": self.stiffness, "rest": self.rest, **own}

    def sentence(self, path: Range, force: Range) -> str:
        low, high = (degrees(angle) for angle in path)
        use = f"{low:.1f} to {high:.1f} deg, up to {max(map(abs, force)):.3g} N m"
        rest = f"relaxed at {degrees(self.rest):.4g} deg"
        part = f", part {self.part}" if self.part else ""
        return f"{self.name}: {self.stiffness:.5g} N m/rad on {self.where}, {rest}, {use}{part}"

    def scaled(self, factor: float) -> TorsionSpring:
        return replace(self, stiffness=factor * self.stiffness)

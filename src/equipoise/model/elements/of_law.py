"""Elements of any law: along a line or on joints."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

from ..errors import Fault
from .along_line import AlongLine
from .element import Vec3
from .guides import Guide, Pulley
from .laws import Law
from .laws.law import plain
from .on_joints import OnJoints

if TYPE_CHECKING:
    from ..mechanism import Mechanism


@dataclass(frozen=True)
class LineElement(AlongLine):
    """A law on the distance of point `p_a` of `body_a` and point `p_b` of `body_b`, or on the length of a cable.

    Attributes:
        p_a, p_b: its ends [m], each in its body's frame.
        law: its force as a function of its length.
        via: what the cable runs through from a to b.
        mass: [kg], lumped at the two ends.
        mass_split: the share of `mass` at `p_a`; the rest is at `p_b`.
        diameter: outside [m], to be drawn.
        part: what it is ordered by.
        realisation: how it is built in: direct, eyelet, pulley.
    """

    name: str
    body_a: str
    p_a: Vec3
    body_b: str
    p_b: Vec3
    law: Law
    via: tuple[Guide, ...] = ()
    mass: float = 0.0
    mass_split: float = 0.5
    diameter: float = 0.0
    part: str = ""
    realisation: str = ""

    @property
    def noun(self) -> str:
        return f"{self.law.noun}{' along a cable' if self.via else ''}"

    @property
    def guides(self) -> tuple[Guide, ...]:
        return self.via

    def faults(self, mechanism: Mechanism) -> Iterator[Fault]:
        yield from super().faults(mechanism)
        bodies = tuple(dict.fromkeys(mechanism.body_names))
        for i, guide in enumerate(self.via):
            for fault in guide.faults(bodies):
                yield replace(fault, path=("via", i, *fault.path))
            if i and isinstance(guide, Pulley) and isinstance(self.via[i - 1], Pulley):
                yield Fault(("via", i), "follows another pulley: give a guide point between them, as MuJoCo needs one")

    @property
    def keys(self) -> dict[str, Any]:
        via = [{f.name: plain(getattr(guide, f.name)) for f in fields(guide)} for guide in self.via]
        return {**super().keys, **({"via": via} if via else {}), **self.law.values()}

    def scaled(self, factor: float) -> LineElement:
        return replace(self, law=self.law.scaled(factor))


@dataclass(frozen=True)
class JointElement(OnJoints):
    """A law on the angle of a joint, or on ``sum(ratio * angle)`` of several.

    Attributes:
        joints: (name, ratio) of each revolute joint.
        law: its torque as a function of that angle.
    """

    name: str
    joints: tuple[tuple[str, float], ...]
    law: Law

    def scaled(self, factor: float) -> JointElement:
        return replace(self, law=self.law.scaled(factor))

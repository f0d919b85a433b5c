"""Everything elastic: a path, a scalar s(q), times a law, a force f(s). Paths are classes here, laws are in `laws`."""

from __future__ import annotations

from . import laws
from .along_line import AlongLine
from .element import Element, Vec3
from .guides import Guide, Pulley
from .of_law import JointElement, LineElement
from .on_joints import OnJoints
from .spring import Spring, lines
from .torsion import TorsionSpring

__all__ = [
    "AlongLine",
    "Element",
    "Guide",
    "JointElement",
    "LineElement",
    "OnJoints",
    "Pulley",
    "Spring",
    "TorsionSpring",
    "Vec3",
    "laws",
    "lines",
]

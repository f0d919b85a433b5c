"""Laws: the force of an element as a function of its path. One file per law, and all listed here."""

from __future__ import annotations

from .cam import Cam
from .compression import Compression
from .constant import ConstantForce, ConstantTorque
from .extension import Extension
from .gas import Gas
from .law import Law, State
from .linear import Linear, Torsional
from .table import Table

ON_LINES: dict[str, type[Law]] = {law.kind: law for law in (Linear, Extension, Compression, Gas, ConstantForce, Table)}
"""Laws along a line or a cable by their kind in a mechanism file."""
ON_JOINTS: dict[str, type[Law]] = {law.kind: law for law in (ConstantTorque, Table, Cam)}
"""Laws on the angle of a joint, or on a sum of angles, beside the torsion spring."""

__all__ = [
    "ON_JOINTS",
    "ON_LINES",
    "Cam",
    "Compression",
    "ConstantForce",
    "ConstantTorque",
    "Extension",
    "Gas",
    "Law",
    "Linear",
    "State",
    "Table",
    "Torsional",
]

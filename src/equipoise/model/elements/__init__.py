"""Everything elastic: a path, a scalar s(q), times a law, a force f(s). One file per kind, and all listed here."""

from __future__ import annotations

from .element import Element, Vec3
from .spring import Spring, lines
from .torsion import TorsionSpring

KINDS: dict[str, type[Element]] = {kind.kind: kind for kind in (Spring, TorsionSpring)}
"""The kinds by their name in a mechanism file."""

__all__ = ["KINDS", "Element", "Spring", "TorsionSpring", "Vec3", "lines"]

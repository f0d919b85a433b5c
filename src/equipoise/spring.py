"""The spring: a frozen value."""

from __future__ import annotations

from dataclasses import dataclass

Vec3 = tuple[float, float, float]


@dataclass(frozen=True)
class Spring:
    """A linear spring between point `p_a` of `body_a` and point `p_b` of `body_b`.

    Its energy is ``stiffness/2 * (length - free_length)**2``, so it also pushes when shorter than its free length.

    Attributes:
        p_a, p_b: attachment points [m], each in its body's frame.
        stiffness: [N/m], positive.
        free_length: [m]; 0, the default, is the zero-free-length spring of static balancing.
        mass: [kg], lumped at the two ends.
        mass_split: the share of `mass` at `p_a`; the rest is at `p_b`.
        diameter: outside of the coils [m], for clearance only.
    """

    name: str
    body_a: str
    p_a: Vec3
    body_b: str
    p_b: Vec3
    stiffness: float
    free_length: float = 0.0
    mass: float = 0.0
    mass_split: float = 0.5
    diameter: float = 0.0

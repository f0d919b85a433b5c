"""The spring between two points: the distance of its ends as path, times the linear law."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..errors import NoFourierForm, UnsupportedError
from .along_line import AlongLine, millimetres
from .element import Range, Vec3
from .laws import Linear

if TYPE_CHECKING:
    from ...energy.fourier.frames import Frames
    from ...energy.fourier.series import Series
    from ...energy.span.nodes import Nodes
    from ..mechanism import Mechanism


@dataclass(frozen=True)
class Spring(AlongLine):
    """A linear spring between point `p_a` of `body_a` and point `p_b` of `body_b`.

    Its energy is ``stiffness/2 * (length - free_length)**2``, so it also pushes when shorter than its free length.

    Attributes:
        p_a, p_b: attachment points [m], each in its body's frame.
        stiffness: [N/m], positive.
        free_length: [m]; 0, the default, is the zero-free-length spring of static balancing; below 0 it is tightened
            beyond zero length, as a cable behind a pulley can.
        mass: [kg], lumped at the two ends.
        mass_split: the share of `mass` at `p_a`; the rest is at `p_b`.
        diameter: outside of the coils [m], for clearance only.
        part: what it is ordered by.
        realisation: how it is built in.
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
    part: str = ""
    realisation: str = ""

    @property
    def law(self) -> Linear:
        return Linear(self.stiffness, self.free_length)

    def series(self, frames: Frames) -> Series:
        """The energy [J] of a zero-free-length spring (docs/theory.md, section 1); coefficients (T, 1, 1).

        Raises:
            NoFourierForm: it has a free length.
        """
        if self.free_length:
            raise NoFourierForm(f"spring '{self.name}' has a free length")
        index, z = frames.tree.index, np.array([*self.p_a, 1.0, *self.p_b])[:, None]
        V = frames.stretch(index[self.body_a], index[self.body_b])
        return frames.quadratic({X: v @ frames.constant(z) for X, v in V.items()}).scaled(self.stiffness / 2)

    def affine(self, nodes: Nodes) -> Array:
        if self.free_length:
            raise NoFourierForm(f"spring '{self.name}' has a free length")
        (a, p_a), (b, p_b) = ((nodes.tree.index[body], np.array(p)) for body, p in self.ends)
        return np.sqrt(self.stiffness) * nodes.between(a, p_a, b, p_b)

    def to_dict(self, path: Range, force: Range) -> dict[str, Any]:
        return {
            "name": self.name,
            "kind": self.kind,
            **self.keys,
            "stiffness": self.stiffness,
            "free_length": self.free_length,
            "max_length": path[1],
            "min_length": path[0],
            "max_force": max(map(abs, force)),
        }

    def sentence(self, path: Range, force: Range) -> str:
        free = f", free length {1e3 * self.free_length:.4g} mm" if self.free_length else ""
        ends = " to ".join(f"{body} {millimetres(p)}" for body, p in self.ends)
        most = f"up to {1e3 * path[1]:.0f} mm, {max(map(abs, force)):.3g} N"
        return f"{self.name}: {self.stiffness:.5g} N/m{free}, {ends} mm, {most}{self.bought}"

    def scaled(self, factor: float) -> Spring:
        return replace(self, stiffness=factor * self.stiffness)


def lines(mechanism: Mechanism, what: str) -> tuple[Spring, ...]:
    """The elements of a mechanism, all of them springs between two points.

    Raises:
        UnsupportedError: another kind, which `what` does not cover; the message names it.
    """
    for element in mechanism.springs:
        if not isinstance(element, Spring):
            raise UnsupportedError(
                f"'{element.name}' is {element.noun}: {what} covers linear springs between two points only"
            )
    return tuple(element for element in mechanism.springs if isinstance(element, Spring))

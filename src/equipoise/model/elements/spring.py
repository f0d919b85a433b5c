"""The spring between two points: the distance of its ends as path, times the linear law."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..arrays import Array
from ..errors import Fault, NoFourierForm, UnsupportedError, at_least, finite, known, positive
from .element import Element, End, Knob, Pens, Range, Tendon, Vec3
from .law import Linear

if TYPE_CHECKING:
    from ...energy.fourier.frames import Frames
    from ...energy.fourier.series import Series
    from ...energy.kernel.trace import Trace, Value
    from ...energy.span.nodes import Nodes
    from ...kinematics import Poses, Tree, Velocities
    from ..mechanism import Mechanism


@dataclass(frozen=True)
class Spring(Element):
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

    kind: ClassVar[str] = "linear"
    noun: ClassVar[str] = "a spring between two points"
    knobs: ClassVar[tuple[Knob, ...]] = (Knob("stiffness", "stiffness [N/m]"),)
    path_unit: ClassVar[str] = "m"
    force_unit: ClassVar[str] = "N"

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

    @property
    def law(self) -> Linear:
        return Linear(self.stiffness, self.free_length)

    @property
    def ends(self) -> tuple[End, End]:
        return (self.body_a, self.p_a), (self.body_b, self.p_b)

    def path(self, tree: Tree, poses: Poses) -> Array:
        return _length(self._stretch(tree, poses))

    def state(self, tree: Tree, poses: Poses, velocities: Velocities) -> tuple[Array, Array]:
        d = self._stretch(tree, poses)
        length = _length(d)
        pull = d * self.law.over(length)[:, None]
        return length, np.einsum("ni,nij->nj", pull, self._rate(tree, poses, velocities))

    def lever_arms(self, tree: Tree, poses: Poses, velocities: Velocities) -> Array:
        """(N, n) change of the length per unit of each coordinate [m/rad or 1]."""
        d = self._stretch(tree, poses)
        rate = np.einsum("ni,nij->nj", d, self._rate(tree, poses, velocities))
        return rate / np.maximum(_length(d), 1e-12)[:, None]

    def _stretch(self, tree: Tree, poses: Poses) -> Array:
        (A, p_a), (B, p_b) = ((tree.index[body], np.array(p)) for body, p in self.ends)
        return poses.point(B, p_b) - poses.point(A, p_a)

    def _rate(self, tree: Tree, poses: Poses, velocities: Velocities) -> Array:
        (A, p_a), (B, p_b) = ((tree.index[body], np.array(p)) for body, p in self.ends)
        return velocities.point(poses, B, p_b) - velocities.point(poses, A, p_a)

    def series(self, frames: Frames) -> Series:
        """The energy [J] of a zero-free-length spring (THEORY section 1); coefficients (T, 1, 1).

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

    def symbols(self, t: Trace, pens: Pens) -> tuple[Value, Value]:
        d, pull = pens.line(self.ends, self.law.scale)
        length, energy, share = self.law.of_square(t, t.dot(d, d))
        pull(share)
        return length, energy

    def lumps(self) -> Iterator[tuple[str, float, Vec3]]:
        yield self.body_a, self.mass * self.mass_split, self.p_a
        yield self.body_b, self.mass * (1 - self.mass_split), self.p_b

    def faults(self, mechanism: Mechanism) -> Iterator[Fault]:
        bodies = tuple(dict.fromkeys(mechanism.body_names))
        yield from finite(("p_a",), self.p_a)
        yield from finite(("p_b",), self.p_b)
        yield from positive(("stiffness",), self.stiffness, "N/m")
        yield from at_least(("free_length",), self.free_length, 0, "m")
        yield from at_least(("mass",), self.mass, 0, "kg")
        yield from at_least(("diameter",), self.diameter, 0, "m")
        if not 0 <= self.mass_split <= 1:
            yield Fault(("mass_split",), f"must be between 0 and 1, found {self.mass_split:g}")
        yield from known(("body_a",), self.body_a, "body", bodies)
        yield from known(("body_b",), self.body_b, "body", bodies)
        if self.body_a == self.body_b:
            yield Fault(("body_b",), f"both ends are on '{self.body_a}': such a spring does nothing")

    def to_dict(self, path: Range, force: Range) -> dict[str, Any]:
        return {
            "name": self.name,
            "kind": self.kind,
            "body_a": self.body_a,
            "p_a": list(self.p_a),
            "body_b": self.body_b,
            "p_b": list(self.p_b),
            "stiffness": self.stiffness,
            "free_length": self.free_length,
            "max_length": path[1],
            "min_length": path[0],
            "max_force": max(map(abs, force)),
        }

    def mjcf(self) -> Tendon:
        # one number would leave a slack range from 0 to it
        numbers = {"stiffness": [self.stiffness], "springlength": [self.free_length] * 2}
        return "spatial", numbers, [("site", {"site": f"{self.name}.{letter}"}) for letter in "ab"]

    @property
    def where(self) -> str:
        return f"{self.body_a} – {self.body_b}"

    @property
    def between(self) -> str:
        return f"from {self.body_a} to {self.body_b}"

    @property
    def strength(self) -> tuple[float, str]:
        return self.stiffness, "N/m"

    @property
    def free(self) -> float:
        return self.free_length

    def sentence(self, path: Range, force: Range) -> str:
        free = f", free length {1e3 * self.free_length:.4g} mm" if self.free_length else ""
        ends = " to ".join(f"{body} {_millimetres(p)}" for body, p in self.ends)
        most = f"up to {1e3 * path[1]:.0f} mm, {max(map(abs, force)):.3g} N"
        return f"{self.name}: {self.stiffness:.5g} N/m{free}, {ends} mm, {most}"

    def scaled(self, factor: float) -> Spring:
        return replace(self, stiffness=factor * self.stiffness)


def lines(mechanism: Mechanism, what: str) -> tuple[Spring, ...]:
    """The elements of a mechanism, all of them springs between two points.

    Raises:
        UnsupportedError: another kind, which `what` does not cover; the message names it.
    """
    for element in mechanism.springs:
        if not isinstance(element, Spring):
            raise UnsupportedError(f"'{element.name}' is {element.noun}: {what} covers springs between two points only")
    return tuple(element for element in mechanism.springs if isinstance(element, Spring))


def _length(d: Array) -> Array:
    return np.sqrt(np.einsum("ni,ni->n", d, d))


def _millimetres(p: Vec3) -> str:
    return "(" + ", ".join(f"{round(1e3 * value, 1) + 0.0:.1f}" for value in p) + ")"

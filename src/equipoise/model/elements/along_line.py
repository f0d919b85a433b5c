"""Elements along a line: the distance of two points, or the length of a cable through guide points, as path."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..arrays import Array
from ..errors import Fault, NoFourierForm, at_least, finite, known
from .element import Element, End, Pens, Range, Tendon, Vec3
from .guides import Guide, Pulley, Wrap
from .laws import State

if TYPE_CHECKING:
    from ...energy.fourier.frames import Frames
    from ...energy.fourier.series import Series
    from ...energy.kernel.trace import Trace, Value
    from ...energy.span.nodes import Nodes
    from ...kinematics import Poses, Tree, Velocities
    from ..mechanism import Mechanism

Segment = tuple[End, End]
FLEET = float(np.radians(2.0))
"""[rad] a cable may be askew to the plane of its pulley before that is reported."""
LEAST_WRAP = 1e-6
"""[rad] of a pulley that a cable lies on at least, where it does."""


class AlongLine(Element):
    """An element from point `p_a` of `body_a` to point `p_b` of `body_b`, straight or through the points of `via`."""

    path_unit: ClassVar[str] = "m"
    force_unit: ClassVar[str] = "N"

    if TYPE_CHECKING:
        body_a: str
        p_a: Vec3
        body_b: str
        p_b: Vec3
        mass: float
        mass_split: float
        diameter: float
        part: str
        realisation: str

    @property
    def guides(self) -> tuple[Guide, ...]:
        """The points between its ends that it runs through, and the pulleys that it lies on."""
        return ()

    @property
    def ends(self) -> tuple[End, End]:
        return (self.body_a, self.p_a), (self.body_b, self.p_b)

    @property
    def places(self) -> tuple[tuple[str, End], ...]:
        a, b = self.ends
        guides = ((g.body, g.side if isinstance(g, Pulley) else g.point) for g in self.guides)
        return ("a", a), *((str(i), guide) for i, guide in enumerate(guides, start=1)), ("b", b)

    @property
    def wheels(self) -> tuple[tuple[str, Pulley], ...]:
        """The pulleys that it lies on, each with its mark, which is that of its side in `places`."""
        return tuple((str(i), g) for i, g in enumerate(self.guides, start=1) if isinstance(g, Pulley))

    @property
    def compiled(self) -> bool:
        return not self.wheels

    @property
    def segments(self) -> Iterator[Segment]:
        """Its straight parts, those over pulleys left out."""
        stops: list[End | None] = [None if isinstance(g, Pulley) else (g.body, g.point) for g in self.guides]
        a, b = self.ends
        return ((p, q) for p, q in pairwise([a, *stops, b]) if p is not None and q is not None)

    def _wraps(self, tree: Tree, poses: Poses) -> Iterator[tuple[Pulley, End, End, Wrap]]:
        """Its parts over pulleys, each with the points before and behind it."""
        points = [end for _, end in self.places]
        for mark, pulley in self.wheels:
            before, behind = points[int(mark) - 1], points[int(mark) + 1]
            x_a, x_b = (poses.point(tree.index[body], np.array(p)) for body, p in (before, behind))
            yield pulley, before, behind, pulley.wrap(tree, poses, x_a, x_b)

    def touches(self, tree: Tree, poses: Poses) -> dict[str, tuple[Array, Array]]:
        """Of each pulley by its mark, where the cable meets it and leaves it, (N, 3) each in the world [m].

        Where it does not touch, these are its next points behind and before it.
        """
        found = {}
        for (mark, _), (_, *ends, wrap) in zip(self.wheels, self._wraps(tree, poses), strict=True):
            x_a, x_b = (poses.point(tree.index[body], np.array(p)) for body, p in ends)
            a, b = x_a - wrap.free_a[:, None] * wrap.pull_a, x_b - wrap.free_b[:, None] * wrap.pull_b
            found[mark] = a, b
        return found

    def routing(self, tree: Tree, poses: Poses) -> list[tuple[State, Array]]:
        """What is to be reported of its pulleys: a state, and the angle (N,) [rad] that it is about."""
        found = []
        for (mark, _), (_, _, _, wrap) in zip(self.wheels, self._wraps(tree, poses), strict=True):
            found.append((State(f"off its pulley {mark}", LEAST_WRAP, False, False, "rad"), wrap.angle))
            found.append((State(f"askew on its pulley {mark}", FLEET, True, False, "rad"), wrap.fleet))
        return found

    # physics

    def path(self, tree: Tree, poses: Poses) -> Array:
        straight = (_length(_stretch(part, tree, poses)) for part in self.segments)
        round_ = (wrap.length for *_, wrap in self._wraps(tree, poses))
        return sum((*straight, *round_), np.zeros(len(poses.s)))

    def lever_arms(self, tree: Tree, poses: Poses, velocities: Velocities) -> Array:
        found = [
            np.einsum("ni,nij->nj", _unit(_stretch(part, tree, poses)), _rate(part, tree, poses, velocities))
            for part in self.segments
        ]
        for pulley, *ends, wrap in self._wraps(tree, poses):
            for (body, p), pull in zip(ends, (wrap.pull_a, wrap.pull_b), strict=True):
                B, at = tree.index[body], np.array(p)
                own = velocities.point(poses, B, at)
                rate = own - pulley.velocity(tree, poses, velocities, poses.point(B, at))
                found.append(np.einsum("ni,nij->nj", pull, rate))
        return np.sum(found, axis=0)

    def state(self, tree: Tree, poses: Poses, velocities: Velocities) -> tuple[Array, Array]:
        if self.guides:
            return super().state(tree, poses, velocities)
        d = _stretch(self.ends, tree, poses)
        length = _length(d)
        pull = d * self.law.over(length)[:, None]
        return length, np.einsum("ni,nij->nj", pull, _rate(self.ends, tree, poses, velocities))

    def series(self, frames: Frames) -> Series:
        raise NoFourierForm(f"'{self.name}' is {self.noun}: its energy is no finite sum of sines")

    def affine(self, nodes: Nodes) -> Array:
        raise NoFourierForm(f"'{self.name}' is {self.noun}: its energy is no square of a distance")

    def symbols(self, t: Trace, pens: Pens) -> tuple[Value, Value]:
        if not self.guides:
            d, pull = pens.line(self.ends, self.law.scale)
            length, energy, share = self.law.of_square(t, t.dot(d, d))
            pull(share)
            return length, energy
        parts = [(*pens.line(part, 1.0), part) for part in self.segments if part[0][0] != part[1][0]]
        sizes = [t.sqrt(t.dot(d, d)) for d, _, _ in parts]
        fixed = [float(np.linalg.norm(np.subtract(b[1], a[1]))) for a, b in self.segments if a[0] == b[0]]
        length = t.total([*fixed, *sizes])
        energy, force = self.law.of_path(t, length)
        for (_, pull, _), size in zip(parts, sizes, strict=True):
            pull(t.mul(force, t.inverse(size)))
        return length, energy

    def lumps(self) -> Iterator[tuple[str, float, Vec3]]:
        yield self.body_a, self.mass * self.mass_split, self.p_a
        yield self.body_b, self.mass * (1 - self.mass_split), self.p_b

    # files

    def faults(self, mechanism: Mechanism) -> Iterator[Fault]:
        bodies = tuple(dict.fromkeys(mechanism.body_names))
        yield from finite(("p_a",), self.p_a)
        yield from finite(("p_b",), self.p_b)
        yield from self.law.faults()
        yield from at_least(("mass",), self.mass, 0, "kg")
        yield from at_least(("diameter",), self.diameter, 0, "m")
        if not 0 <= self.mass_split <= 1:
            yield Fault(("mass_split",), f"must be between 0 and 1, found {self.mass_split:g}")
        yield from known(("body_a",), self.body_a, "body", bodies)
        yield from known(("body_b",), self.body_b, "body", bodies)
        if len({body for _, (body, _) in self.places}) == 1:
            yield Fault(("body_b",), f"both ends are on '{self.body_a}': such a spring does nothing")

    @property
    def keys(self) -> dict[str, Any]:
        (body_a, p_a), (body_b, p_b) = self.ends
        own = {name: value for name in ("part", "realisation") if (value := getattr(self, name))}
        return {"body_a": body_a, "p_a": list(p_a), "body_b": body_b, "p_b": list(p_b), **own}

    @property
    def bought(self) -> str:
        """Which part it is and how it is built in, as the end of a sentence."""
        return (f", part {self.part}" if self.part else "") + (f", {self.realisation}" if self.realisation else "")

    def mjcf(self) -> Tendon:
        numbers = self.law.mjcf() or {}
        if min(numbers.get("springlength", [0.0])) < 0:
            numbers = {}  # the engine takes a length below zero for "as in the model's zero pose"
        wheels, names = dict(self.wheels), [(mark, f"{self.name}.{mark}") for mark, _ in self.places]
        along = [
            ("geom", {"geom": name, "sidesite": name}) if mark in wheels else ("site", {"site": name})
            for mark, name in names
        ]
        return "spatial", numbers, along

    # pictures and words

    def outline(self, tree: Tree) -> tuple[End, ...]:
        """Along it; a pulley's rim is drawn from its side all around."""
        wheels = dict(self.wheels)
        parts = ([(end[0], p) for p in wheels[mark].circle()] if mark in wheels else [end] for mark, end in self.places)
        return tuple(point for part in parts for point in part)

    @property
    def where(self) -> str:
        return f"{self.body_a} – {self.body_b}"

    @property
    def between(self) -> str:
        return f"from {self.body_a} to {self.body_b}"

    def sentence(self, path: Range, force: Range) -> str:
        ends = " to ".join(f"{body} {millimetres(p)}" for body, p in self.ends)
        low, high = (1e3 * length for length in path)
        through = f" through {len(self.guides)} guide{'s' * (len(self.guides) > 1)}" if self.guides else ""
        use = f"{low:.1f} to {high:.1f} mm, {force[0]:.4g} to {force[1]:.4g} N"
        return (
            f"{self.name}: {self.law.noun.split(' ', 1)[1]}, {self.law.words()}, {ends} mm{through}, {use}{self.bought}"
        )


def _stretch(part: Segment, tree: Tree, poses: Poses) -> Array:
    (A, p_a), (B, p_b) = ((tree.index[body], np.array(p)) for body, p in part)
    return poses.point(B, p_b) - poses.point(A, p_a)


def _rate(part: Segment, tree: Tree, poses: Poses, velocities: Velocities) -> Array:
    (A, p_a), (B, p_b) = ((tree.index[body], np.array(p)) for body, p in part)
    return velocities.point(poses, B, p_b) - velocities.point(poses, A, p_a)


def _length(d: Array) -> Array:
    return np.sqrt(np.einsum("ni,ni->n", d, d))


def _unit(d: Array) -> Array:
    return d / np.maximum(_length(d), 1e-12)[:, None]


def millimetres(p: Vec3) -> str:
    return "(" + ", ".join(f"{round(1e3 * value, 1) + 0.0:.1f}" for value in p) + ")"

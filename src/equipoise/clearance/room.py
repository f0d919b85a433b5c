"""What takes room, as capsules between points of bodies: springs, cables, weights, auxiliary links, and the links.

Springs, weights and auxiliary links are ours: they are judged against each other and against the links. Links among
themselves are the robot's own business.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ..kinematics import Tree
from ..model.arrays import Array
from ..model.elements import AlongLine
from ..model.mechanism import Mechanism
from .solids import Solid, solids

STEEL = 7850.0  # [kg/m^3]
WEIGHT, LINK, AUXILIARY, SPRING = "weight", "link", "auxiliary", "spring"


@dataclass(frozen=True, eq=False)
class Part:
    """A capsule, or what lies in one.

    Attributes:
        name: of the spring, weight, body or shape that it is a part of.
        kind: "spring", "weight", "link", or "auxiliary": a link that was added.
        bodies: numbers of those that its two ends are on.
        ends: (2, 3) in their frames [m].
        radius: [m].
        solid: what lies in it, when it is no capsule.
        held: numbers of the bodies that it may touch.
        pulleys: of a cable's part, which of its two ends is where it touches a pulley; the cable; the pulley's mark.
    """

    name: str
    kind: str
    bodies: tuple[int, int]
    ends: Array
    radius: float
    held: frozenset[int]
    solid: Solid | None = None
    pulleys: tuple[tuple[int, AlongLine, str], ...] = ()

    def judged_with(self, other: Part) -> bool:
        """Whether it must keep its distance from another part: a spring may touch what it is fixed to."""
        ours = {self.kind, other.kind} - {LINK}
        if not ours or (self.name, self.kind) == (other.name, other.kind):
            return False
        if self.kind == other.kind == SPRING:
            return True
        if SPRING in ours:
            spring, thing = (self, other) if self.kind == SPRING else (other, self)
            if thing.kind != WEIGHT:
                return thing.bodies[0] not in spring.held
            mounted = (np.linalg.norm(p - thing.ends[0]) for p, body in zip(spring.ends, spring.bodies, strict=True)
                       if body == thing.bodies[0])  # fmt: skip
            return all(apart > thing.radius for apart in mounted)
        return self.bodies[0] != other.bodies[0]


@dataclass(frozen=True, eq=False)
class Room:
    """The parts of a mechanism, its springs first, in order.

    Attributes:
        parts: all.
        neighbours: pairs of bodies that a joint or a loop holds together.
        sizeless, missing: springs of which no size is known, and meshes that are not there, with the reason.
        links: whether anything says how large the links are.
    """

    parts: tuple[Part, ...]
    neighbours: frozenset[frozenset[int]]
    sizeless: tuple[str, ...]
    missing: tuple[str, ...]
    links: bool

    @staticmethod
    def of(mechanism: Mechanism) -> Room:
        """The room that a mechanism takes.

        Raises:
            InputError: a shape needs the collision library, and it is missing.
        """
        tree = Tree.of(mechanism)
        springs = [part for s in mechanism.springs if isinstance(s, AlongLine) for part in _strands(tree, s)]
        sizeless = [f"{s.name} ({s.noun}: no size is known)" for s in mechanism.springs if not isinstance(s, AlongLine)]
        found, missing = solids(mechanism.shapes)
        links = [_on(tree.index[c.body], c.name, LINK, (c.p_a, c.p_b), c.radius) for c in mechanism.capsules]
        links += [_on(tree.index[s.body], s.name, LINK, one.ends, one.radius, one)
                  for s in mechanism.shapes if (one := found.get(s.name)) is not None]  # fmt: skip
        parts = (*springs, *_weights(tree), *_auxiliary(tree, {part.bodies[0] for part in links}), *links)
        joined = {frozenset((tree.index[j.parent], tree.index[j.child])) for j in mechanism.joints}
        joined |= {frozenset((tree.index[one.body_a], tree.index[one.body_b])) for one in mechanism.loops}
        return Room(parts, frozenset(joined), tuple(sizeless), tuple(missing), bool(links))

    def pairs(self) -> Iterator[tuple[int, int]]:
        """Numbers of the parts that must keep their distance."""
        for i, one in enumerate(self.parts):
            for j, other in enumerate(self.parts[i + 1 :], start=i + 1):
                joined = frozenset((one.bodies[0], other.bodies[0])) in self.neighbours
                links = SPRING not in (one.kind, other.kind) and AUXILIARY in (one.kind, other.kind)
                if one.judged_with(other) and not (links and joined):
                    yield i, j


def _on(body: int, name: str, kind: str, ends: ArrayLike, radius: float, solid: Solid | None = None) -> Part:
    """A part that is fixed in one body."""
    return Part(name, kind, (body, body), np.array(ends, float), radius, frozenset((body,)), solid)


def _strands(tree: Tree, element: AlongLine) -> Iterator[Part]:
    """The straight parts of a spring or a cable."""
    wheels = dict(element.wheels)
    numbers = [tree.index[body] for _, (body, _) in element.places]
    for i, ((mark_a, (_, a)), (mark_b, (_, b))) in enumerate(pairwise(element.places)):
        pulleys = tuple((e, element, mark) for e, mark in enumerate((mark_a, mark_b)) if mark in wheels)
        # where it leaves a pulley, it goes straight to what comes behind it
        held = frozenset(numbers[max(0, i - (mark_a in wheels)) : i + 2 + (mark_b in wheels)])
        bodies = numbers[i], numbers[i + 1]
        yield Part(element.name, SPRING, bodies, np.array([a, b]), element.diameter / 2, held, pulleys=pulleys)


def _weights(tree: Tree) -> Iterator[Part]:
    """Payloads and counterweights as balls of steel."""
    for mass in tree.mechanism.masses:
        radius = float(np.cbrt(3 * mass.mass / (4 * np.pi * STEEL)))
        yield _on(tree.index[mass.body], mass.name, WEIGHT, (mass.position, mass.position), radius)


def _auxiliary(tree: Tree, known: set[int]) -> Iterator[Part]:
    """Links without a size that hang on parallelograms or in loops: lines from their origin to what they carry."""
    mechanism = tree.mechanism
    tied = {tree.index[j.child] for j in mechanism.joints if j.type == "parallelogram"}
    tied |= {tree.index[body] for loop in mechanism.loops for body in (loop.body_a, loop.body_b)}
    for number in sorted(tied - known - {0}):
        body = mechanism.bodies[number - 1]
        reached = [j.xyz for j in mechanism.joints if j.parent == body.name]
        reached += [p for one in mechanism.loops for name, p in ((one.body_a, one.p_a), (one.body_b, one.p_b))
                    if name == body.name]  # fmt: skip
        reached += [p for spring in mechanism.springs for name, p in spring.ends if name == body.name]
        reached += [body.com] * bool(body.mass)
        for p in dict.fromkeys(reached):
            if any(p):
                yield _on(number, body.name, AUXILIARY, ((0.0, 0.0, 0.0), p), 0.0)

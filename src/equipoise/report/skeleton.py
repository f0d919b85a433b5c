"""A mechanism as a picture sees it: bars, joints, spring ends and payloads, each fixed in a body."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from ..kinematics import Poses, Tree
from ..model.arrays import Array
from ..model.elements.cam_outline import Track
from ..model.elements.element import End
from ..model.elements.laws.law import Look
from ..model.mechanism import Mechanism

COINCIDE = 1e-6  # [m] points closer than this are drawn as one


class Point(NamedTuple):
    """A point `p` (3,) [m] fixed in body number `body`."""

    body: int
    p: Array

    def at(self, poses: Poses) -> Array:
        """(N, 3) its place in the world."""
        return poses.point(self.body, self.p)


class Moving(NamedTuple):
    """A point that moves in a body with the angles of joints."""

    tree: Tree
    track: Track

    def at(self, poses: Poses) -> Array:
        """(N, 3) its place in the world."""
        return self.track.at(self.tree, poses)


class Bar(NamedTuple):
    """A straight line from `a` to `b`, part of body number `body`."""

    body: int
    a: Point
    b: Point


@dataclass(frozen=True)
class Skeleton:
    """What is drawn of a mechanism.

    Attributes:
        bars: the bodies, from joint to joint or loop end, and of a last body to its centre of mass or payload.
        brackets: thin lines from a body to the spring ends and payloads that are not on it.
        joints: of joints that move.  base: where the mechanism stands.
        springs: the line along which each is drawn, from end to end.  looks: how.  masses: one per point mass.
        fixed: numbers of the bodies that cannot move, the world among them.
    """

    bars: tuple[Bar, ...]
    brackets: tuple[Bar, ...]
    joints: tuple[Point, ...]
    base: tuple[Point, ...]
    springs: tuple[tuple[Point | Moving, ...], ...]
    looks: tuple[Look, ...]
    masses: tuple[Point, ...]
    fixed: frozenset[int]

    @staticmethod
    def of(mechanism: Mechanism) -> Skeleton:
        """The skeleton of `mechanism`.

        Raises:
            InputError: its loops cannot be closed.
        """
        tree = Tree.of(mechanism)
        fixed = {0}
        for link in tree.links:
            if link.joint.type == "fixed" and link.parent in fixed:
                fixed.add(link.body)
        springs = tuple(tuple(_point(tree, end) for end in spring.outline(tree)) for spring in mechanism.springs)
        masses = tuple(Point(tree.index[m.body], np.array(m.position)) for m in mechanism.masses)
        bars = _bars(tree, masses)
        met = _met(tree)
        base = (*(Point(0, link.p0) for link in tree.links if link.parent == 0), *(end for end in met if not end.body))
        rest = tree.poses(tree.rest[None])
        ends = [Point(tree.index[body], np.array(p)) for spring in mechanism.springs for body, p in spring.ends]
        brackets = [_bracket(end, bars, base, fixed, rest) for end in (*ends, *masses)]
        return Skeleton(
            bars=bars,
            brackets=tuple(bar for bar in brackets if _length(bar, rest) > COINCIDE),
            joints=(*(Point(link.parent, link.p0) for link in tree.links if link.joint.type != "fixed"), *met),
            base=base,
            springs=springs,
            looks=tuple(spring.law.look for spring in mechanism.springs),
            masses=masses,
            fixed=frozenset(fixed),
        )

    def points(self, poses: Poses) -> Array:
        """(N, K, 3) every point that is drawn."""
        points = [*self.base, *self.joints, *self.masses]
        points += [end for bar in (*self.bars, *self.brackets) for end in (bar.a, bar.b)]
        points += [point for line in self.springs for point in line]
        if not points:
            return np.zeros((len(poses.p), 1, 3))
        return np.stack([point.at(poses) for point in points], axis=1)

    def corners(self, poses: Poses) -> Array:
        """(N, K, 3) the distinct ends of moving bars: points that a good view keeps apart."""
        found = [end for bar in self.bars if bar.body not in self.fixed for end in (bar.a, bar.b)]
        if not found:
            return np.zeros((len(poses.p), 0, 3))
        places = np.stack([end.at(poses) for end in found], axis=1)
        coincide = {j for i, j in combinations(range(len(found)), 2) if _apart(places[:, i] - places[:, j]) < COINCIDE}
        return places[:, [i for i in range(len(found)) if i not in coincide]]

    def ends(self, poses: Poses) -> Array:
        """(N, springs, 2, 3) where each begins and ends."""
        if not self.springs:
            return np.zeros((len(poses.p), 0, 2, 3))
        return np.stack([np.stack([a.at(poses), b.at(poses)], axis=1) for a, *_, b in self.springs], axis=1)


def _point(tree: Tree, end: End | Track) -> Point | Moving:
    return Moving(tree, end) if isinstance(end, Track) else Point(tree.index[end[0]], np.array(end[1]))


def _met(tree: Tree) -> tuple[Point, ...]:
    """Both ends of every loop."""
    ends = (
        (body, p) for loop in tree.mechanism.loops for body, p in ((loop.body_a, loop.p_a), (loop.body_b, loop.p_b))
    )
    return tuple(Point(tree.index[body], np.array(p)) for body, p in ends)


def _bars(tree: Tree, masses: tuple[Point, ...]) -> tuple[Bar, ...]:
    origin, bars = np.zeros(3), []
    for link in tree.links:
        if link.parent and np.linalg.norm(link.p0) > COINCIDE:
            bars.append(Bar(link.parent, Point(link.parent, origin), Point(link.parent, link.p0)))
        if link.slide is not None:
            bars.append(Bar(link.body, Point(link.parent, link.p0), Point(link.body, origin)))
    met = [end for end in _met(tree) if end.body]
    bars += [Bar(end.body, Point(end.body, origin), end) for end in met if np.linalg.norm(end.p) > COINCIDE]
    parents = {link.parent for link in tree.links}
    closed = {end.body for end in met}
    for i, body in enumerate(tree.mechanism.bodies, start=1):
        loads = [mass.p for mass in masses if mass.body == i] + (
            [np.array(body.com)] if body.mass and i not in closed else []
        )
        tip = max(loads, key=lambda p: float(np.linalg.norm(p)), default=origin)
        if i not in parents and np.linalg.norm(tip) > COINCIDE:
            bars.append(Bar(i, Point(i, origin), Point(i, tip)))
    return tuple(bars)


def _bracket(end: Point, bars: tuple[Bar, ...], base: tuple[Point, ...], fixed: set[int], rest: Poses) -> Bar:
    """From the nearest place on the body of `end` to it; all fixed bodies count as one."""
    group = fixed if end.body in fixed else {end.body}
    here = end.at(rest)[0]
    feet = [rest.p[0, end.body], *(point.at(rest)[0] for point in base if 0 in group)]
    foot = min(feet, key=lambda p: float(np.linalg.norm(here - p)))
    for bar in bars:
        if bar.a.body in group and bar.b.body in group:
            a, b = bar.a.at(rest)[0], bar.b.at(rest)[0]
            along = np.clip((here - a) @ (b - a) / max(float((b - a) @ (b - a)), COINCIDE**2), 0, 1)
            near = a + along * (b - a)
            if np.linalg.norm(here - near) < np.linalg.norm(here - foot):
                foot = near
    return Bar(end.body, Point(end.body, rest.R[0, end.body].T @ (foot - rest.p[0, end.body])), end)


def _length(bar: Bar, poses: Poses) -> float:
    return _apart(bar.a.at(poses) - bar.b.at(poses))


def _apart(difference: Array) -> float:
    return float(np.linalg.norm(difference, axis=-1).max())

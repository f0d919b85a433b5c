"""The loop equations of a mechanism and their analytic Jacobian, at the coordinates of its spanning tree.

A point closure is three equations, the gap between its two points. A hinge adds two: its axes a and b stay parallel,

    2 a . e / (1 + a . b) = 0    for the two unit vectors e of body_b that are normal to b,

which is twice the tangent of half the angle between them: zero for parallel axes only, and infinite for opposite ones,
so that no solver turns a hinge round. Everything is dimensionless: lengths are shares of the mechanism's size.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..mechanism import Loop
from .tree import Poses, Tree, Velocities

OPPOSITE = 1e-3  # least 1 + a . b: beyond it the equation of a hinge is continued linearly


@dataclass(frozen=True)
class Hinge:
    """`axis` (3,) in body number `a` stays parallel to ``cross(*normals)`` of body `b`; unit vectors."""

    a: int
    axis: Array
    b: int
    along: Array
    normals: Array

    @staticmethod
    def of(tree: Tree, loop: Loop) -> Hinge | None:
        """The hinge of a loop, None where it only joins points."""
        if loop.axis_a is None or loop.axis_b is None:
            return None
        axis, along = (np.array(v) / np.abs(v).max() for v in (loop.axis_a, loop.axis_b))
        axis, along = axis / np.linalg.norm(axis), along / np.linalg.norm(along)
        first = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
        first /= np.linalg.norm(first)
        normals = np.stack([first, np.cross(along, first)])
        return Hinge(tree.index[loop.body_a], axis, tree.index[loop.body_b], along, normals)


class Closure:
    """The equations that close the loops of `tree.mechanism`.

    Attributes:
        tree: the spanning tree, whose n coordinates the equations are in.
        size: [m] of the mechanism: what lengths are measured in.
        scale: (n,) unit of each coordinate: 1 rad, or the size for a slide.
        count: the number of equations.
    """

    def __init__(self, tree: Tree) -> None:
        self.tree = tree
        self.loops = tree.mechanism.loops
        self.size = _size(tree)
        self.scale = np.where(tree.turns, 1.0, self.size)
        self._points = [(tree.index[o.body_a], np.array(o.p_a), tree.index[o.body_b], np.array(o.p_b)) for o in self.loops]
        self._hinges = [Hinge.of(tree, loop) for loop in self.loops]
        self.count = sum(3 if hinge is None else 5 for hinge in self._hinges)

    def residual(self, poses: Poses) -> Array:
        """(N, count) what is left of the equations, as shares of the size."""
        parts = []
        for (A, p_a, B, p_b), hinge in zip(self._points, self._hinges, strict=True):
            parts.append((poses.point(B, p_b) - poses.point(A, p_a)) / self.size)
            if hinge is not None:
                a, b, normals = self._axes(poses, hinge)
                x, c = np.einsum("ni,nki->nk", a, normals), np.einsum("ni,ni->n", a, b)
                parts.append(2 * x / np.maximum(1 + c, OPPOSITE)[:, None])
        return np.concatenate(parts, axis=1)

    def jacobian(self, poses: Poses, velocities: Velocities) -> Array:
        """(N, count, n) derivative of the equations by the coordinates in their units `scale`."""
        parts = []
        for (A, p_a, B, p_b), hinge in zip(self._points, self._hinges, strict=True):
            parts.append((velocities.point(poses, B, p_b) - velocities.point(poses, A, p_a)) / self.size)
            if hinge is not None:
                a, b, normals = self._axes(poses, hinge)
                x, c = np.einsum("ni,nki->nk", a, normals), np.einsum("ni,ni->n", a, b)
                w = velocities.w[:, hinge.a] - velocities.w[:, hinge.b]  # of a as body_b sees it
                across = np.cross(a[:, None], np.concatenate([normals, b[:, None]], axis=1))  # (w x a) . e = w . (a x e)
                rate = across @ w
                down = np.maximum(1 + c, OPPOSITE)[:, None, None]
                parts.append(2 * rate[:, :2] / down - 2 * x[:, :, None] * rate[:, 2:] / down**2 * (down > OPPOSITE))
        return np.concatenate(parts, axis=1) * self.scale

    def at(self, q: Array) -> tuple[Array, Array]:
        """Residual (N, count) and Jacobian (N, count, n) at coordinates `q` (N, n) of the tree."""
        poses = self.tree.poses(q)
        return self.residual(poses), self.jacobian(poses, self.tree.velocities(q, poses))

    def gaps(self, q: Array) -> Array:
        """(N, loops) how far each loop is open [m]; an angle between the axes of a hinge counts at the size."""
        residual, ends = self.residual(self.tree.poses(q)), np.cumsum([3 if h is None else 5 for h in self._hinges])
        return self.size * np.stack([np.linalg.norm(part, axis=1) for part in np.split(residual, ends[:-1], axis=1)], axis=1)

    @staticmethod
    def _axes(poses: Poses, hinge: Hinge) -> tuple[Array, Array, Array]:
        """The axes (N, 3) of both bodies and the two normals (N, 2, 3), in the world."""
        R = poses.R[:, hinge.b]
        return poses.R[:, hinge.a] @ hinge.axis, R @ hinge.along, hinge.normals @ np.swapaxes(R, 1, 2)


def _size(tree: Tree) -> float:
    """[m] the largest distance between joints or loop ends of a body, 1 where all are at its origin."""
    lengths = [float(np.linalg.norm(link.p0)) for link in tree.links]
    for loop in tree.mechanism.loops:
        lengths += [float(np.linalg.norm(p)) for p in (loop.p_a, loop.p_b)]
    return max(lengths, default=0.0) or 1.0

"""The loop equations of a mechanism and their analytic Jacobian, at the coordinates of its spanning tree.

A point closure is three equations, the gap between its two points. A hinge adds two: its axes a and b stay parallel,

    2 a . e / (1 + a . b) = 0    for the two unit vectors e of body_b that are normal to b,

which is twice the tangent of half the angle between them: zero for parallel axes only, and infinite for opposite ones,
so that no solver turns a hinge round. Everything is dimensionless: lengths are shares of the mechanism's size.
"""

from __future__ import annotations

import numpy as np

from ..model.arrays import Array, Booleans
from ..model.mechanism import Loop
from .tree import Poses, Tree

OPPOSITE = 1e-3  # least 1 + a . b: beyond it the equation of a hinge is continued linearly


class Closure:
    """The equations that close the loops of `tree.mechanism`: first the gaps of all loops, then the hinges.

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
        index = tree.index
        self._a = np.array([index[loop.body_a] for loop in self.loops])
        self._b = np.array([index[loop.body_b] for loop in self.loops])
        self._p_a = np.array([loop.p_a for loop in self.loops], float)
        self._p_b = np.array([loop.p_b for loop in self.loops], float)
        hinges = [i for i, loop in enumerate(self.loops) if loop.axis_a is not None]
        self._hinges = np.array(hinges, int)
        self._axes_a = np.array([_unit(self.loops[i].axis_a) for i in hinges]).reshape(-1, 3)
        self._frames_b = np.array([_frame(self.loops[i]) for i in hinges]).reshape(-1, 3, 3)
        self.count = 3 * len(self.loops) + 2 * len(hinges)

        turning, levers, sliding = _supports(tree)
        points = len(tree.names) + 2 * len(self.loops)  # the bodies' origins, then p_a and then p_b of all loops
        lever = np.zeros((len(self.loops), len(tree.motions), points))
        for i, (A, B) in enumerate(zip(self._a, self._b, strict=True)):
            for sign, body, point in ((-1, A, i), (1, B, len(self.loops) + i)):
                lever[i, :, : len(tree.names)] += sign * levers[body]
                lever[i, turning[body], len(tree.names) + point] += sign
                lever[i, turning[body], body] -= sign
        lever = lever.reshape(-1, points)
        self._turned = np.flatnonzero(lever.any(axis=1))  # loop and motion in one number: where a motion turns an end
        self._lever = lever[self._turned].T
        self._slides = sliding[self._b].astype(float) - sliding[self._a]  # (loops, motions)
        self._turns = (
            turning[self._a[hinges]].astype(float) - turning[self._b[hinges]]
        )  # (hinges, motions): a seen by b

    def residual(self, poses: Poses) -> Array:
        """(N, count) what is left of the equations, as shares of the size."""
        a, b = self._points(poses)
        gaps = ((b - a) / self.size).reshape(len(a), 3 * len(self.loops))
        if not len(self._hinges):
            return gaps
        x = self._cosines(*self._axes(poses))
        tangents = 2 * x[:, :, :2] / np.maximum(1 + x[:, :, 2:], OPPOSITE)
        return np.hstack([gaps, tangents.reshape(len(a), 2 * len(self._hinges))])

    def jacobian(self, q: Array, poses: Poses) -> Array:
        """(N, count, n) derivative of the equations by the coordinates in units of `scale`, at `q` with its `poses`."""
        N, motions = len(q), len(self.tree.motions)
        axes = np.swapaxes(self.tree.axes(q, poses), 1, 2)
        points = np.concatenate([np.swapaxes(poses.p, 1, 2), *self._points(poses)], axis=2)
        lever = (points.reshape(3 * N, len(self._lever)) @ self._lever).reshape(N, 3, len(self._turned))
        rows = self._slides * axes[:, :, None]  # (N, 3, loops, motions)
        flat = rows.reshape(N, 3, len(self.loops) * motions)
        flat[:, :, self._turned] += _cross(axes[:, :, self._turned % motions], lever)
        J = flat.reshape(N, 3 * len(self.loops), motions) / self.size
        if len(self._hinges):
            axis, frame = self._axes(poses)
            x = self._cosines(axis, frame)
            across = _cross(axis[:, :, :, None], np.swapaxes(frame, 2, 3), axis=2)
            rate = (np.swapaxes(across, 2, 3) @ axes[:, None]) * self._turns[:, None]
            down = np.maximum(1 + x[:, :, 2], OPPOSITE)[:, :, None, None]
            bent = 2 * rate[:, :, :2] / down - (2 * (down > OPPOSITE) / down**2) * x[:, :, :2, None] * rate[:, :, 2:]
            J = np.concatenate([J, bent.reshape(N, 2 * len(self._hinges), motions)], axis=1)
        return J @ (self.tree.C * self.scale)

    def at(self, q: Array) -> tuple[Array, Array]:
        """Residual (N, count) and Jacobian (N, count, n) at coordinates `q` (N, n) of the tree."""
        poses = self.tree.poses(q)
        return self.residual(poses), self.jacobian(q, poses)

    def gaps(self, q: Array) -> Array:
        """(N, loops) how far each loop is open [m]; an angle between the axes of a hinge counts at the size."""
        residual, points = self.residual(self.tree.poses(q)), 3 * len(self.loops)
        square = (residual[:, :points].reshape(len(q), 3, len(self.loops)) ** 2).sum(axis=1)
        square[:, self._hinges] += (residual[:, points:].reshape(len(q), len(self._hinges), 2) ** 2).sum(axis=2)
        return self.size * np.sqrt(square)

    def _points(self, poses: Poses) -> tuple[Array, Array]:
        """The two points (N, 3, loops) of every loop in the world [m]."""
        ends = ((self._a, self._p_a), (self._b, self._p_b))
        a, b = (np.swapaxes(poses.p[:, i] + (poses.R[:, i] @ p[..., None])[..., 0], 1, 2) for i, p in ends)
        return a, b

    def _axes(self, poses: Poses) -> tuple[Array, Array]:
        """Of every hinge in the world: axis a (N, hinges, 3), and the rows (N, hinges, 3, 3) e, e and b."""
        R_a, R_b = poses.R[:, self._a[self._hinges]], poses.R[:, self._b[self._hinges]]
        return (R_a @ self._axes_a[..., None])[..., 0], self._frames_b @ np.swapaxes(R_b, 2, 3)

    @staticmethod
    def _cosines(axis: Array, frame: Array) -> Array:
        """(N, hinges, 3) a . e, a . e and a . b."""
        return (frame @ axis[..., None])[..., 0]


def _supports(tree: Tree) -> tuple[Booleans, Array, Booleans]:
    """How motions move bodies.

    Returns:
        (bodies, motions) whether the motion turns the body; (bodies, motions, bodies) the lever of its origin, as
        whole multiples of the bodies' origins; (bodies, motions) whether the motion shifts the origin.
    """
    bodies, motions = len(tree.names), len(tree.motions)
    turning, sliding = np.zeros((bodies, motions), bool), np.zeros((bodies, motions), bool)
    levers = np.zeros((bodies, motions, bodies))
    for link in tree.links:
        B, P = link.body, link.parent
        turning[B], sliding[B], levers[B] = turning[link.base], sliding[P], levers[P]
        levers[B, turning[P], B] += 1
        levers[B, turning[P], P] -= 1
        for motion in link.motions:
            (turning if motion.rotates else sliding)[B, motion.row] = True
    return turning, levers, sliding


def _cross(a: Array, b: Array, axis: int = 1) -> Array:
    """``a x b`` over an axis: quicker than the general one."""
    (x, y, z), (u, v, w) = (np.moveaxis(c, axis, 0) for c in (a, b))
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=axis)


def _unit(axis: tuple[float, float, float] | None) -> Array:
    v: Array = np.array(axis, float)
    v /= np.abs(v).max()
    return v / float(np.linalg.norm(v))


def _frame(loop: Loop) -> Array:
    """(3, 3) rows: two unit vectors normal to the axis of body_b, and the axis."""
    along = _unit(loop.axis_b)
    first = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))]).astype(float)
    first /= float(np.linalg.norm(first))
    return np.stack([first, np.cross(along, first), along])


def _size(tree: Tree) -> float:
    """[m] the largest distance between joints or loop ends of a body, 1 where all are at its origin."""
    lengths = [float(np.linalg.norm(link.p0)) for link in tree.links]
    for loop in tree.mechanism.loops:
        lengths += [float(np.linalg.norm(p)) for p in (loop.p_a, loop.p_b)]
    return max(lengths, default=0.0) or 1.0

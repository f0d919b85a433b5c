"""Attachments that move outwards and inwards, and what that does to the energy.

Each attachment of a spring may move along its ray, from the nearest joint through the attachment. With stiffness k and
distances a and b along the two rays the energy of a spring of zero free length is, up to a constant, ::

    k |t|^2 / 2  -  k a (t . e_a)  +  k b (t . e_b)  -  k a b (e_a . e_b)

where t runs between the two rays' origins: linear in (k, ka, kb, kab). Springs do the same as those of a design when
these four numbers of all springs together give the same energy, up to a constant: linear equations.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...kinematics import Poses, Tree, sample
from ...model.arrays import Array, frozen, vec3
from ...model.elements import Spring, lines
from ...model.errors import Fault, InputError, UnsupportedError
from ...model.mechanism import Mechanism
from ...model.units import AmountField

LEAST = 0.005  # [m]
RANK = 1e-9  # of the largest singular value: smaller ones are rounding
POSES_PER_TERM = 40


@frozen
class Ray:
    """Where an attachment may be: `origin` + distance `direction`, in the body's frame; `length` [m] is now."""

    body: str
    origin: Array
    direction: Array
    length: float

    def at(self, share: float) -> tuple[float, float, float]:
        """The point at `share` of the present distance."""
        return vec3(self.origin + share * self.length * self.direction)


@dataclass(frozen=True)
class Travel:
    """How far attachments may be moved: `low` to `high` times the present distance from the joint, to `reach` [m], and
    no nearer to it than `least` [m] where they are farther now."""

    low: float = 0.25
    high: float = 4.0
    reach: AmountField = AmountField("length", np.inf)
    least: AmountField = AmountField("length", LEAST)

    def __post_init__(self) -> None:
        if not 0 < self.low <= 1 <= self.high < np.inf:
            found = f"must hold low <= 1 <= high, both positive, found {self.low:g} and {self.high:g}"
            raise InputError(Fault(("travel",), found))

    def of(self, ray: Ray) -> tuple[float, float]:
        """(low, high) share of the present distance; an attachment on its joint stays there."""
        if ray.length == 0:
            return 1.0, 1.0
        return max(self.low, min(1.0, self.least / ray.length)), max(1.0, min(self.high, self.reach / ray.length))


class Movable:
    """The springs of a design whose attachments may move.

    All quantities are relative: stiffness to the design's, distances to the design's, so that the design is all ones.

    Attributes:
        springs: the design's.
        rays: of A and B of each.
        low, high: (springs, 2) range of the relative distances.
        rows: (r, springs, 4) independent equations: the sum of rows * [k, ka, kb, kab] is what it is for all ones.
        size: (springs, 3) of [k, ka, kb] in force per length: what one of each counts.
    """

    def __init__(self, mechanism: Mechanism, travel: Travel | None = None) -> None:
        travel = travel or Travel()
        if not mechanism.springs:
            raise InputError(Fault(("springs",), f"mechanism '{mechanism.name}' has none"))
        springs = lines(mechanism, "stock")
        for spring in springs:
            if spring.free_length:
                raise UnsupportedError(f"spring '{spring.name}' has a free length; stock rates need zero free length")
        self.mechanism = mechanism
        self.springs = springs
        self.tree = Tree.of(mechanism)
        zero = self.tree.poses(sample(self.tree, 1))
        self.rays = tuple(
            (self._ray(s.body_a, s.p_a, s.body_b, zero), self._ray(s.body_b, s.p_b, s.body_a, zero))
            for s in self.springs
        )
        ranges = np.array([[travel.of(ray) for ray in pair] for pair in self.rays])
        self.low, self.high = ranges[..., 0], ranges[..., 1]
        k = np.array([s.stiffness for s in self.springs])
        a, b = np.array([[ray.length for ray in pair] for pair in self.rays]).T
        self.size = np.stack([k, k * a, k * b], axis=1)
        q = sample(self.tree, max(mechanism.workspace.samples, 4 * len(k) * POSES_PER_TERM))
        t, e_a, e_b = self.directions(q[: 4 * len(k) * POSES_PER_TERM])
        dot = lambda x, y: np.einsum("nsi,nsi->ns", x, y)  # noqa: E731
        terms = np.stack([dot(t, t) / 2, -dot(t, e_a), dot(t, e_b), -dot(e_a, e_b)], axis=2)
        terms *= np.stack([k, k * a, k * b, k * a * b], axis=1)
        terms -= terms.mean(axis=0)
        _, size, V = np.linalg.svd(terms.reshape(len(terms), -1), full_matrices=False)
        kept = size > RANK * size[0]
        self.rows = V[kept].reshape(-1, len(k), 4)
        self.poses = q

    def directions(self, q: Array) -> tuple[Array, Array, Array]:
        """(N, springs, 3) in the world: from origin to origin [m], and the unit vectors of both rays."""
        poses = self.tree.poses(q)
        t, e_a, e_b = (np.empty((len(q), len(self.springs), 3)) for _ in range(3))
        for i, (ray_a, ray_b) in enumerate(self.rays):
            A, B = self.tree.index[ray_a.body], self.tree.index[ray_b.body]
            t[:, i] = poses.point(B, ray_b.origin) - poses.point(A, ray_a.origin)
            e_a[:, i], e_b[:, i] = poses.R[:, A] @ ray_a.direction, poses.R[:, B] @ ray_b.direction
        return t, e_a, e_b

    def reach(self, q: Array, shares: Array) -> Array:
        """(N, springs, 3) [m] from A to B in the world, with the attachments at relative distances (springs, 2)."""
        t, e_a, e_b = self.directions(q)
        a, b = shares.T * np.array([[ray.length for ray in pair] for pair in self.rays]).T
        return t - a[:, None] * e_a + b[:, None] * e_b

    def error(self, k: Array, shares: Array) -> Array:
        """(r,) how far stiffnesses (springs,) and distances (springs, 2), both relative, are from doing the same."""
        a, b = shares.T
        return np.einsum("rsf,sf->r", self.rows, np.stack([k, k * a, k * b, k * a * b], axis=1) - 1)

    def solve(self, k: Array, shares: Array) -> Array | None:
        """The nearest relative distances (springs, 2) that do exactly the same; None where Newton's method fails."""
        shares = shares.copy()
        for _ in range(40):
            a, b = shares.T
            error = self.error(k, shares)
            if not np.isfinite(error).all():
                return None
            if np.abs(error).max(initial=0) < 1e-13 * (1 + np.abs(k).max()):
                return shares
            R = self.rows
            by_a, by_b = k * (R[:, :, 1] + b * R[:, :, 3]), k * (R[:, :, 2] + a * R[:, :, 3])
            J = np.stack([by_a, by_b], axis=2) * (self.high > self.low)
            step = np.linalg.lstsq(J.reshape(len(R), -1), -error, rcond=1e-10)[0]
            shares += step.reshape(-1, 2)
        return shares if np.abs(self.error(k, shares)).max(initial=0) < 1e-11 * (1 + np.abs(k).max()) else None

    def inside(self, shares: Array) -> bool:
        """Whether all distances are within their ranges."""
        return bool(((shares >= self.low * (1 - 1e-9)) & (shares <= self.high * (1 + 1e-9))).all())

    def moved(self, stiffness: Array, shares: Array) -> Mechanism:
        """The mechanism with stiffnesses (springs,) [N/m] and attachments at relative distances (springs, 2)."""
        springs: list[Spring] = [
            replace(s, stiffness=float(k), p_a=ray_a.at(share[0]), p_b=ray_b.at(share[1]))
            for s, k, (ray_a, ray_b), share in zip(self.springs, stiffness, self.rays, shares, strict=True)
        ]
        return self.mechanism.with_springs(springs)

    def _ray(self, body: str, p: tuple[float, float, float], other: str, zero: Poses) -> Ray:
        origin = self._joint(body, other, zero)
        d = np.array(p) - origin
        length = float(np.linalg.norm(d))
        if length < 1e-12 * (1 + float(np.linalg.norm(origin))):
            return Ray(body, np.array(p), np.zeros(3), 0.0)
        return Ray(body, origin, d / length, length)

    def _joint(self, body: str, other: str, zero: Poses) -> Array:
        """(3,) [m] in the frame of `body`, the joint nearest to it on the way to `other`."""
        above = {link.body: link for link in self.tree.links}
        up = lambda i: [i, *up(above[i].parent)] if i in above else [i]  # noqa: E731
        here, there = self.tree.index[body], self.tree.index[other]
        mine, theirs = up(here), up(there)
        common = next(i for i in mine if i in theirs)
        way = mine[: mine.index(common)] + theirs[: theirs.index(common)][::-1]
        moving = [i for i in way if above[i].motions or above[i].base != above[i].parent]
        at = zero.p[0, moving[0]] if moving else zero.p[0, here]
        return zero.R[0, here].T @ (at - zero.p[0, here])

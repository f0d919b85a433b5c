"""Forward kinematics of trees, batched over configurations. A mechanism with loops is a `Linkage` over its tree.

A mechanism is compiled once to a `Tree`: bodies in an order in which each comes after its parent, and every joint
as elementary motions (a spherical joint is three). The elementary joint values are ``s = C q + s0``: that one line
is all there is to couplings.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property, lru_cache, reduce

import numpy as np
from numpy.typing import ArrayLike

from ..model.arrays import Array, Booleans, Integers, frozen
from ..model.errors import InputError
from ..model.mechanism import SINGLE, Joint, Mechanism
from ..model.rotation import about, from_rpy, harmonics


@frozen
class Motion:
    """One elementary motion: a rotation about (or a translation along) the unit vector `axis`, by value `row` of s."""

    axis: Array
    row: int
    rotates: bool


@frozen
class Link:
    """How body `body` hangs on its parent: ``R_WB = R_W,base R0 R(motions)``, ``p_WB = p_W,parent + R_W,parent ...``.

    `base` is the body that carries the orientation: the parent, except for a parallelogram joint.
    """

    body: int
    parent: int
    base: int
    joint: Joint
    R0: Array
    p0: Array
    motions: tuple[Motion, ...]

    @property
    def slide(self) -> Motion | None:
        """The prismatic motion, when there is one."""
        return next((motion for motion in self.motions if not motion.rotates), None)


@frozen
class Poses:
    """Orientation `R` (N, bodies, 3, 3) and origin `p` (N, bodies, 3) [m] of each body in the world; body 0 is it.

    And the elementary joint values `s` (N, motions) [rad or m] that they come from.
    """

    R: Array
    p: Array
    s: Array

    def point(self, body: int, p: Array) -> Array:
        """World position (N, 3) of the point `p` (3,) fixed in `body`."""
        return self.p[:, body] + self.R[:, body] @ p


@frozen
class Velocities:
    """Angular `w` and origin `v` velocities (N, bodies, 3, n) in the world, for unit rate of each coordinate.

    And the rates `s` (N, motions, n) of the elementary joint values.
    """

    w: Array
    v: Array
    s: Array

    def point(self, poses: Poses, body: int, p: Array) -> Array:
        """Velocity (N, 3, n) of the point `p` (3,) fixed in `body`."""
        arm = poses.R[:, body] @ p
        return self.v[:, body] + np.cross(self.w[:, body], arm[:, :, None], axis=1)


class Tree:
    """A mechanism compiled for kinematics, its loops left open. Make it with `Tree.of`, which remembers the last few.

    Attributes:
        names: body names, the world first; `index` maps a name to its number.
        motions: what each elementary motion is measured by; `rows` maps a name to its row.
        coordinates: those of q.
        links: one per body but the world, parents before children.
        C: (motions, n) elementary joint values are ``s = C q + s0``.
        s0: (motions,) [rad or m].
        lower: (motions,) lower end of the range [rad or m], -inf where there is none.
        upper: (motions,) upper end, inf where there is none.
        rotates: (motions,) whether it is a rotation.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.names = mechanism.body_names
        self.index = {name: i for i, name in enumerate(self.names)}
        self.coordinates = mechanism.coordinates
        self.n = len(self.coordinates)
        self.motions = tuple(c for joint in mechanism.joints for c in joint.coordinates)
        self.rows: dict[str, int] = {name: row for row, name in enumerate(self.motions)}
        self.links = tuple(self._links(self.rows))
        self.C, self.s0 = _couplings(mechanism, self.rows)
        ranges = {j.name: j.range for j in mechanism.joints if j.range is not None}
        self.lower = np.array([ranges.get(name, (-np.inf, np.inf))[0] for name in self.motions])
        self.upper = np.array([ranges.get(name, (-np.inf, np.inf))[1] for name in self.motions])
        self.rotates = np.array([motion.turns for motion in self.motions], dtype=bool)

    @staticmethod
    @lru_cache(maxsize=32)
    def of(mechanism: Mechanism) -> Tree:
        """`mechanism` compiled: a `Linkage` where it has loops.

        Raises:
            InputError: its loops cannot be closed.
        """
        if mechanism.loops:
            from .linkage import Linkage

            return Linkage(mechanism)
        return Tree(mechanism)

    def _links(self, rows: dict[str, int]) -> Iterator[Link]:
        placed, waiting = {0}, list(self.mechanism.joints)
        while waiting:
            later = []
            for joint in waiting:
                parent, base = self.index[joint.parent], self.index[joint.follows or joint.parent]
                if parent in placed and base in placed:
                    placed.add(self.index[joint.child])
                    R0, p0 = from_rpy(joint.rpy), np.array(joint.xyz, float)
                    yield Link(self.index[joint.child], parent, base, joint, R0, p0, _motions(joint, rows))
                else:
                    later.append(joint)
            waiting = later

    @cached_property
    def link_of(self) -> dict[int, Link]:
        """Body number -> its link."""
        return {link.body: link for link in self.links}

    @cached_property
    def coordinate_rows(self) -> Integers:
        """(n,) the motion row that is coordinate j itself."""
        return np.array([self.rows[name] for name in self.coordinates], dtype=int)

    @property
    def turns(self) -> Booleans:
        """(n,) whether each coordinate is an angle."""
        return self.rotates[self.coordinate_rows]

    @property
    def rest(self) -> Array:
        """(n,) a configuration in which it can be: all zero, or as its loops are assembled."""
        return np.zeros(self.n)

    def batch(self, q: ArrayLike) -> Array:
        """Configurations as (N, n), from (N, n) or (n,) for one.

        Raises:
            InputError: another shape.
        """
        q = np.atleast_2d(np.asarray(q, float))
        if q.shape[1:] != (self.n,):
            raise InputError(f"q has shape {q.shape}, expected (N, {self.n}) for {self.coordinates}")
        return q

    def values(self, q: Array) -> Array:
        """(N, motions) every elementary joint value [rad or m] at `q` (N, n), dependent ones included."""
        return q @ self.C.T + self.s0

    def narrow(self, lower: Array, upper: Array) -> tuple[Array, Array]:
        """The part of a box of configurations (n,), (n,) that it can reach: all of it, unless loops limit it."""
        return lower, upper

    def poses(self, q: Array) -> Poses:
        """Body poses at configurations `q` (N, n) [rad or m]."""
        N, s = len(q), self.values(q)
        constant, cosine, sine = self.turning
        turns = constant[:, None] + cosine[:, None] * np.cos(s.T)[..., None, None]
        turns += sine[:, None] * np.sin(s.T)[..., None, None]  # (motions, N, 3, 3)
        R = np.empty((N, len(self.names), 3, 3))
        p = np.empty((N, len(self.names), 3))
        R[:, 0], p[:, 0] = np.eye(3), 0.0
        for link in self.links:
            turn, shift = link.R0, link.p0
            rotations = [turns[motion.row] for motion in link.motions if motion.rotates]
            if rotations:
                turn = reduce(np.matmul, rotations)  # the first has R0 in it
            if link.slide:
                shift = shift + s[:, link.slide.row, None] * (link.R0 @ link.slide.axis)
            R[:, link.body] = R[:, link.base] @ turn
            p[:, link.body] = p[:, link.parent] + (R[:, link.parent] @ shift[..., None])[..., 0]
        return Poses(R, p, s)

    @cached_property
    def turning(self) -> tuple[Array, Array, Array]:
        """(motions, 3, 3) each: what is constant, times the cosine and times the sine in each motion's rotation.

        The orientation at zero is in the first rotation of a joint.
        """
        found = np.zeros((3, len(self.motions), 3, 3))
        for link in self.links:
            before = link.R0
            for motion in link.motions:
                if motion.rotates:
                    A0, A1 = harmonics(motion.axis)
                    found[:, motion.row] = before @ np.stack([A0, 2 * A1.real, -2 * A1.imag])
                    before = np.eye(3)
        constant, cosine, sine = found
        return constant, cosine, sine

    def axes(self, q: Array, poses: Poses) -> Array:
        """(N, motions, 3) unit axes of the elementary motions in the world, at `q` (N, n) with its `poses`."""
        axes, s = np.empty((len(q), len(self.motions), 3)), None
        for link in self.links:
            if len(link.motions) == 1:  # an axis stays in place when its body turns about it
                axes[:, link.motions[0].row] = poses.R[:, link.body] @ link.motions[0].axis
            elif link.motions:
                s = self.values(q) if s is None else s
                R = poses.R[:, link.base] @ link.R0
                for motion in link.motions:
                    axes[:, motion.row] = R @ motion.axis
                    R = R @ about(motion.axis, s[:, motion.row])
        return axes

    def velocities(self, q: Array, poses: Poses) -> Velocities:
        """Analytic body velocities per unit rate of each coordinate, at `q` (N, n) with its `poses`."""
        axes = self.axes(q, poses)
        w = np.zeros((len(q), len(self.names), 3, self.n))
        v = np.zeros_like(w)
        for link in self.links:
            B, P = link.body, link.parent
            w[:, B] = w[:, link.base]
            v[:, B] = v[:, P] + np.cross(w[:, P], (poses.p[:, B] - poses.p[:, P])[:, :, None], axis=1)
            for motion in link.motions:
                (w if motion.rotates else v)[:, B] += axes[:, motion.row, :, None] * self.C[motion.row]
        return Velocities(w, v, np.broadcast_to(self.C, (len(q), *self.C.shape)))


def _motions(joint: Joint, rows: dict[str, int]) -> tuple[Motion, ...]:
    if joint.type == "spherical":
        return tuple(Motion(axis, rows[name], True) for axis, name in zip(np.eye(3), joint.coordinates, strict=True))
    if joint.type in SINGLE:
        axis = np.array(joint.axis, float)
        axis /= np.abs(axis).max()  # first, so that a very long or short axis does not overflow
        return (Motion(axis / np.linalg.norm(axis), rows[joint.name], joint.type == "revolute"),)
    return ()


def _couplings(mechanism: Mechanism, rows: dict[str, int]) -> tuple[Array, Array]:
    coordinates = mechanism.coordinates
    C, s0 = np.zeros((len(rows), len(coordinates))), np.zeros(len(rows))
    for j, name in enumerate(coordinates):
        C[rows[name], j] = 1.0
    waiting = {coupling.joint: coupling for coupling in mechanism.couplings}
    while waiting:  # a coupling may name another dependent joint; validation has excluded rings
        ready = [c for c in waiting.values() if not any(name in waiting for name, _ in c.terms)]
        for coupling in ready:
            row = rows[coupling.joint]
            s0[row] = coupling.offset
            for name, ratio in coupling.terms:
                C[row] += ratio * C[rows[name]]
                s0[row] += ratio * s0[rows[name]]
            del waiting[coupling.joint]
    return C, s0

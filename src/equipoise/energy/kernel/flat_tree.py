"""A tree flattened for computing: frames that turn, origins that move, and where every point is.

A *frame* is one rotation about its own z axis: ``R_W,i = R_W,base A_i Rz(s_row)``. Axes are chosen as in a table of
Denavit and Hartenberg, so that the constant rotation of a frame's first child is a turn about x and one about z. An
*origin* is a point ``p = p_parent + R_W,frame (step + s_row slide)``. Bodies that fixed, prismatic and parallelogram
joints hold share a frame; bodies that fixed joints hold share an origin too.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import atan2, cos, hypot, sin

import numpy as np

from ...kinematics.tree import Link, Motion, Tree
from ...model.arrays import Array, frozen
from ...model.masses import lumped_masses
from ...model.rotation import frame_of

SNAP = 1e-15  # entries of rotations closer than this to 0 or +-1 are that


@dataclass(frozen=True)
class Turn:
    """Cosine and sine of a constant angle."""

    c: float = 1.0
    s: float = 0.0


@frozen
class Frame:
    """``R_W,i = R_W,base Rz(alpha) Rx(beta) Rz(gamma) Rz(s_row)``."""

    base: int
    row: int
    A: Array
    alpha: Turn = Turn()
    beta: Turn = Turn()
    gamma: Turn = Turn()


@frozen
class Step:
    """From an origin's parent to it, in `frame`: ``step + s_row slide`` [m]; `slide` is None where nothing slides."""

    parent: int
    frame: int
    step: Array
    row: int = 0
    slide: Array | None = None


@frozen
class Seat:
    """A body: a point p of it is at ``p_origin + R_W,frame (c + E p)``."""

    frame: int
    origin: int
    E: Array
    c: Array

    def point(self, p: Array) -> Array:
        """(3,) in the frame, from the origin."""
        return self.c + self.E @ p


@dataclass(eq=False)
class FlatTree:
    """Frames and origins, number 0 of each the world's; `gravity` (3,) [m/s^2] in frame 0."""

    tree: Tree
    frames: list[Frame] = field(default_factory=lambda: [Frame(0, -1, np.eye(3))])
    origins: list[Step] = field(default_factory=lambda: [Step(0, 0, np.zeros(3))])
    seats: dict[int, Seat] = field(default_factory=lambda: {0: Seat(0, 0, np.eye(3), np.zeros(3))})
    gravity: Array = field(default_factory=lambda: np.zeros(3))

    @staticmethod
    def of(tree: Tree) -> FlatTree:
        """The layout of a tree without loops."""
        layout = FlatTree(tree, gravity=np.array(tree.mechanism.gravity, float))
        for link in tree.links:
            layout._add(link)
        layout._align()
        return layout

    def moments(self) -> tuple[dict[int, Array], Array]:
        """Constant mass moments ``{frame: (3,)}`` [kg m] of all that does not slide, and each origin's load [kg].

        The load is what an origin carries: itself and everything on it.
        """
        load = np.zeros(len(self.origins))
        moment: dict[int, Array] = {}
        for body, mass, p in lumped_masses(self.tree.mechanism):
            if mass:
                seat = self.seats[self.tree.index[body]]
                load[seat.origin] += mass
                moment[seat.frame] = moment.get(seat.frame, np.zeros(3)) + mass * seat.point(p)
        for o in range(len(self.origins) - 1, 0, -1):
            step = self.origins[o]
            load[step.parent] += load[o]
            moment[step.frame] = moment.get(step.frame, np.zeros(3)) + load[o] * step.step
        return moment, load

    def path(self, origin: int) -> list[int]:
        """The origins from this one inwards, the world's left out."""
        found = []
        while origin:
            found.append(origin)
            origin = self.origins[origin].parent
        return found

    def bases(self, frame: int) -> list[int]:
        """The frames from this one inwards, the world's included."""
        found = [frame]
        while found[-1]:
            found.append(self.frames[found[-1]].base)
        return found

    def _add(self, link: Link) -> None:
        parent, base = self.seats[link.parent], self.seats[link.base]
        at, E, frame, origin = parent.point(link.p0), base.E @ link.R0, base.frame, parent.origin
        if link.joint.type == "fixed":
            self.seats[link.body] = Seat(frame, origin, E, at)
            return
        slide = link.slide
        direction = None if slide is None else _snapped(parent.E @ link.R0 @ slide.axis)
        self.origins.append(Step(origin, parent.frame, at, slide.row if slide else 0, direction))
        for motion in link.motions:
            if motion.rotates:
                Q = _onto(motion)
                self.frames.append(Frame(frame, motion.row, _snapped(E @ Q)))
                frame, E = len(self.frames) - 1, _snapped(Q.T)
        self.seats[link.body] = Seat(frame, len(self.origins) - 1, E, np.zeros(3))

    def _align(self) -> None:
        """Turn every frame about its z axis (the world's in any way) so that its first child's `alpha` is nothing."""
        first: dict[int, int] = {}
        for i, frame in enumerate(self.frames[1:], start=1):
            first.setdefault(frame.base, i)
        for i in range(len(self.frames)):
            T = np.eye(3)
            if i in first:
                A = self.frames[first[i]].A
                T = A if i == 0 else _about_z(_euler(A)[0])
            frame = self.frames[i]
            # what is fixed in the frame turns back, the frame itself turns forward
            self.frames[i] = replace(frame, A=_snapped(frame.A @ T)) if i else frame
            for c, child in enumerate(self.frames):
                if c and child.base == i:
                    self.frames[c] = replace(child, A=_snapped(T.T @ child.A))
            for o, step in enumerate(self.origins):
                if step.frame == i:
                    slide = None if step.slide is None else _snapped(T.T @ step.slide)
                    self.origins[o] = replace(step, step=T.T @ step.step, slide=slide)
            for body, seat in self.seats.items():
                if seat.frame == i:
                    self.seats[body] = replace(seat, E=_snapped(T.T @ seat.E), c=T.T @ seat.c)
            if i == 0:
                self.gravity = T.T @ self.gravity
        for i, frame in enumerate(self.frames):
            if i:
                alpha, beta, gamma = _euler(frame.A)
                self.frames[i] = replace(frame, alpha=alpha, beta=beta, gamma=gamma)


def _euler(R: Array) -> tuple[Turn, Turn, Turn]:
    """(alpha, beta, gamma) with ``Rz(alpha) Rx(beta) Rz(gamma) == R``; alpha is nothing where z stays in place."""
    sine = hypot(R[0, 2], R[1, 2])
    if sine <= SNAP:
        # gamma alone turns; a half turn about x, where z is reversed
        return Turn(), Turn(float(np.sign(R[2, 2])), 0.0), _turn(R[0, 0], -R[0, 1])
    # R[:, 2] = (sin a sin b, -cos a sin b, cos b)
    alpha, beta = _turn(-R[1, 2], R[0, 2]), _turn(R[2, 2], sine)
    x = _about_z(alpha).T @ R[:, 0]  # = Rx(beta) (cos c, sin c, 0): well determined however small sin b is
    return alpha, beta, _turn(x[0], beta.c * x[1] + beta.s * x[2])


def _turn(c: float, s: float) -> Turn:
    angle = atan2(s, c)
    c, s = cos(angle), sin(angle)
    return Turn(_snap(c), _snap(s))


def _snap(x: float) -> float:
    near = float(round(x))
    return near if abs(x - near) <= SNAP else float(x)


def _snapped(M: Array) -> Array:
    found: Array = np.array(M, np.float64)
    near = np.rint(M) + 0.0  # no negative zero
    close = np.abs(M - near) <= SNAP
    found[close] = near[close]
    return found


def _about_z(turn: Turn) -> Array:
    return np.array([[turn.c, -turn.s, 0.0], [turn.s, turn.c, 0.0], [0.0, 0.0, 1.0]])


def _onto(motion: Motion) -> Array:
    """A rotation that takes z onto the motion's axis, a permutation where it can be."""
    return frame_of(motion.axis).T

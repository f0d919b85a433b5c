"""An open chain as what gravity sees of it: links between joint centres, each with its first moment of mass.

A joint is one hinge, or several hinges whose axes meet in a point (a universal joint, a wrist, three hinges for a ball
joint), or a ball joint. Everything is measured in the world at q = 0, which no relative rotation changes. Bodies held
together by fixed joints are one link, point masses included.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..energy.potential import lumped_masses
from ..errors import UnsupportedError
from ..kinematics import Tree
from ..kinematics.tree import Link
from ..mechanism import Mechanism
from ..spring import Vec3
from .mounts import Mounts

SAME = 1e-9  # of the mechanism's reach: closer points coincide


@dataclass(frozen=True)
class Pivot:
    """Where a joint turns: about the point `p` (3,) [m], or about the line through it along the unit vector `e`."""

    p: Array
    e: Array | None

    def off(self, x: Array) -> float:
        """Distance of the point x from it [m]."""
        d = x - self.p
        return float(np.linalg.norm(d if self.e is None else d - (d @ self.e) * self.e))

    def common(self, other: Pivot, near: float) -> Pivot | None:
        """What two pivots share: a point, or a line when they are the same one; None when they pass each other."""
        if self.e is None or other.e is None:
            point, line = (self, other) if self.e is None else (other, self)
            return point if line.off(point.p) <= near else None
        across = np.cross(self.e, other.e)
        if np.linalg.norm(across) <= SAME:
            return self if self.off(other.p) <= near else None
        s, t, _ = np.linalg.solve(np.column_stack([self.e, -other.e, across]), other.p - self.p)
        meeting = self.p + s * self.e
        return Pivot(meeting, None) if np.linalg.norm(meeting - other.p - t * other.e) <= near else None


@dataclass(frozen=True)
class Segment:
    """A link of the chain, at q = 0 in world coordinates.

    Attributes:
        body: that carries its springs.
        centre: (3,) of its proximal joint [m].
        length: (3,) from there to the centre of its distal joint [m]; None for the last link.
        mass: its own [kg].
        com: (3,) its mass centre from `centre` [m].
        moment: (3,) first moment about `centre` [kg m], with all that is beyond it hung at its distal joint.
        pivots: of the hinges of its proximal joint; one of them with no axis is a ball joint.
    """

    body: str
    centre: Array
    length: Array | None
    mass: float
    com: Array
    moment: Array
    pivots: tuple[Pivot, ...]

    @property
    def along(self) -> Array:
        """(3,) the part of `moment` on the line to the distal joint."""
        if self.length is None:
            return self.moment
        return (self.moment @ self.length) / (self.length @ self.length) * self.length

    def off_line(self, near: float) -> bool:
        """Whether its mass centre is off that line by more than `near` [m]."""
        return float(np.linalg.norm(self.moment - self.along)) > near * self.mass

    @property
    def free(self) -> bool:
        """Whether its joint gives it every orientation: a ball joint, or three hinges that span space."""
        axes = [pivot.e for pivot in self.pivots if pivot.e is not None]
        return len(axes) < len(self.pivots) or (bool(axes) and np.linalg.matrix_rank(np.array(axes), SAME) == 3)


@dataclass(frozen=True)
class Chain:
    """The links of an open chain, ground first; `near` [m] is what counts as no distance."""

    mechanism: Mechanism
    links: tuple[Segment, ...]
    near: float

    @property
    def weight(self) -> float:
        """|g| [m/s^2]."""
        return float(np.linalg.norm(self.mechanism.gravity))

    @property
    def up(self) -> Array:
        """(3,) the unit vector against gravity."""
        return -np.array(self.mechanism.gravity) / self.weight

    @property
    def loaded(self) -> tuple[Segment, ...]:
        """The links up to the last with a moment: what is beyond is balanced about its own joint."""
        last = max((i for i, x in enumerate(self.links) if np.linalg.norm(x.moment) > self._nothing), default=-1)
        return self.links[: last + 1]

    @property
    def _nothing(self) -> float:
        return self.near * sum(link.mass for link in self.links)

    def on(self, body: str, point: Array) -> Vec3:
        """The place of a point (3,), given in the world at q = 0, in the frame of a body [m]."""
        tree = Tree.of(self.mechanism)
        zero, i = tree.poses(np.zeros((1, tree.n))), tree.index[body]
        x, y, z = (float(v) for v in zero.R[0, i].T @ (point - zero.p[0, i]))
        return x, y, z


def reasons(mechanism: Mechanism) -> list[str]:
    """Why a mechanism is no such chain; empty when it is."""
    found = []
    if mechanism.loops:
        found.append("it has loops")
    if mechanism.couplings:
        found.append("it has coupled joints")
    found += [
        f"joint '{joint.name}' is {joint.type}, and links must be joined by hinges and ball joints"
        for joint in mechanism.joints
        if joint.type not in ("revolute", "spherical", "fixed")
    ]
    if not np.any(mechanism.gravity):
        found.append("there is no gravity")
    if found:
        return found
    tree = Tree.of(mechanism)
    moving, root = _groups(tree)
    if not moving:
        return ["no joint moves"]
    for link in moving:
        rivals = [other.joint.name for other in moving if root[other.parent] == root[link.parent]]
        if len(rivals) > 1:
            return [f"it branches: joints {' and '.join(repr(name) for name in rivals)} start from one link"]
    return [] if chain(mechanism).loaded else ["gravity loads no joint"]


def chain(mechanism: Mechanism) -> Chain:
    """The chain of a mechanism for which `reasons` finds none against it.

    Where a link's mass centre is in the plane of its proximal joint and the hinge at its far end, the far joint's
    centre is the point of that hinge's axis that is in line with both; else it is the joint's origin.
    """
    tree = Tree.of(mechanism)
    zero = tree.poses(np.zeros((1, tree.n)))
    near = SAME * Mounts.of(mechanism).reach
    moving, root = _groups(tree)
    mass, first = np.zeros(len(tree.names)), np.zeros((len(tree.names), 3))
    for body, m, p in lumped_masses(mechanism.with_springs(())):
        i = tree.index[body]
        mass[root[i]] += m
        first[root[i]] += m * zero.point(i, p)[0]

    joints: list[tuple[list[Pivot], Pivot, int]] = []  # hinges, what they share, the body beyond
    for link in moving:
        own = Pivot(zero.p[0, link.body], None)
        if link.joint.type == "revolute":
            own = Pivot(own.p, zero.R[0, link.body] @ link.motions[0].axis)
        if joints:
            hinges, shared, between = joints[-1]
            m, centre = mass[between], first[between] / (mass[between] or 1.0)
            meeting = shared.common(own, near)
            still = m == 0 or (meeting is not None and meeting.e is None and meeting.off(centre) <= near)
            if meeting is not None and (still or own.off(centre) <= near):
                if m and own.off(centre) <= near:  # a mass on the next axis is as good as beyond it
                    mass[link.body] += m
                    first[link.body] += first[between]
                joints[-1] = ([*hinges, own], meeting, link.body)
                continue
        joints.append(([own], own, link.body))
    return Chain(mechanism, tuple(_segments(tree, joints, mass, first, near)), near)


def _segments(
    tree: Tree, joints: list[tuple[list[Pivot], Pivot, int]], mass: Array, first: Array, near: float
) -> list[Segment]:
    beyond = np.cumsum([mass[body] for _, _, body in joints][::-1])[::-1]
    segments, centre = [], joints[0][1].p
    for i, (hinges, _, body) in enumerate(joints):
        m = float(mass[body])
        com = first[body] / m - centre if m else np.zeros(3)
        length = None
        if i + 1 < len(joints):
            length = _in_line(joints[i + 1][1], centre, com, near) - centre
            if np.linalg.norm(length) <= near:
                names = f"'{tree.names[body]}' and '{tree.names[joints[i + 1][2]]}'"
                raise UnsupportedError(f"links {names} turn about one point, but the mass between is off it")
        moment = m * com + (0.0 if length is None else beyond[i + 1] * length)
        segments.append(Segment(tree.names[body], centre, length, m, com, moment, tuple(hinges)))
        centre = centre if length is None else centre + length
    return segments


def _in_line(pivot: Pivot, centre: Array, com: Array, near: float) -> Array:
    """The point of a pivot in line with `centre` and the mass centre, where there is one; else its origin."""
    if pivot.e is None or np.linalg.norm(com) <= near:
        return pivot.p
    plane = np.column_stack([pivot.p - centre, pivot.e])
    (along, aside), *_ = np.linalg.lstsq(plane, com, rcond=None)
    off = np.linalg.norm(plane @ (along, aside) - com)
    return pivot.p + aside / along * pivot.e if off <= near and abs(along) > SAME else pivot.p


def _groups(tree: Tree) -> tuple[list[Link], dict[int, int]]:
    """The links that move, parents first, and the body that each rigid group of bodies is named after."""
    root, moving = {0: 0}, []
    for link in tree.links:
        fixed = link.joint.type == "fixed"
        root[link.body] = root[link.parent] if fixed else link.body
        if not fixed:
            moving.append(link)
    return moving, root

"""An open chain as what gravity sees of it: links between joint centres, each with its first moment of mass.

A joint is one hinge, or several hinges whose axes meet in a point (a universal joint, a wrist, three hinges for a ball
joint), or a ball joint. Everything is measured in the world at q = 0, which no relative rotation changes. Bodies held
together by fixed joints are one link, point masses included.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...kinematics import Tree
from ...model.arrays import Array, frozen, vec3
from ...model.elements import Vec3
from ...model.errors import UnsupportedError
from ...model.mechanism import Mechanism
from ..mounts import Mounts
from .moments import segments

COINCIDE = 1e-9  # of the mechanism's reach: closer points coincide


@frozen
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
        if np.linalg.norm(across) <= COINCIDE:
            return self if self.off(other.p) <= near else None
        s, t, _ = np.linalg.solve(np.column_stack([self.e, -other.e, across]), other.p - self.p)
        meeting = self.p + s * self.e
        return Pivot(meeting, None) if np.linalg.norm(meeting - other.p - t * other.e) <= near else None


@frozen
class ChainLink:
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
    def along(self) -> float:
        """The part of `moment` on the line to the distal joint, as a multiple of `length` [kg]."""
        return 0.0 if self.length is None else float(self.moment @ self.length / (self.length @ self.length))

    @property
    def across(self) -> Array:
        """(3,) the rest of `moment` [kg m]; of the last link, all of it."""
        return self.moment if self.length is None else self.moment - self.along * self.length

    def off_line(self, near: float) -> bool:
        """Whether its mass centre is off that line by more than `near` [m]."""
        return float(np.linalg.norm(self.across)) > near * self.mass

    @property
    def free(self) -> bool:
        """Whether its joint gives it every orientation: a ball joint, or three hinges that span space."""
        axes = [pivot.e for pivot in self.pivots if pivot.e is not None]
        return len(axes) < len(self.pivots) or (bool(axes) and np.linalg.matrix_rank(np.array(axes), COINCIDE) == 3)


@dataclass(frozen=True)
class Chain:
    """The links of an open chain on the upright body `base`; `near` [m] is what counts as no distance."""

    mechanism: Mechanism
    base: str
    links: tuple[ChainLink, ...]
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
    def loaded(self) -> tuple[ChainLink, ...]:
        """The links up to the last with a moment: what is beyond is balanced about its own joint."""
        nothing = self.near * sum(link.mass for link in self.links)
        last = max((i for i, x in enumerate(self.links) if np.linalg.norm(x.moment) > nothing), default=-1)
        return self.links[: last + 1]

    def on(self, body: str, point: Array) -> Vec3:
        """The place of a point (3,), given in the world at q = 0, in the frame of a body [m]."""
        tree = Tree.of(self.mechanism)
        zero, i = tree.poses(np.zeros((1, tree.n))), tree.index[body]
        return vec3(zero.R[0, i].T @ (point - zero.p[0, i]))


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
    moving = segments(mechanism.with_springs(()))[1:]
    if not moving:
        return ["no joint moves"]
    for link in moving:
        rivals = [other.joint.name for other in moving if other.parent == link.parent and other.joint]
        if len(rivals) > 1:
            return [f"it branches: joints {' and '.join(repr(name) for name in rivals)} start from one link"]
    try:
        return [] if chain(mechanism).loaded else ["gravity loads no joint"]
    except UnsupportedError as error:
        return [str(error)]


def chain(mechanism: Mechanism) -> Chain:
    """The chain of a mechanism whose joints `reasons` accepts.

    Where a link's mass centre is in the plane of its proximal joint and the hinge at its far end, the far joint's
    centre is the point of that hinge's axis that is in line with both; else it is the joint's origin.

    Raises:
        UnsupportedError: two joints turn about one point, and the mass between them does not lie there.
    """
    mechanism = mechanism.with_springs(())
    tree = Tree.of(mechanism)
    zero = tree.poses(np.zeros((1, tree.n)))
    near = COINCIDE * Mounts.of(mechanism).reach
    ground, *moving = segments(mechanism)
    stages: list[_Stage] = []
    for link in moving:
        R, p = zero.R[0, tree.index[link.name]], zero.p[0, tree.index[link.name]]
        at = p + R @ link.origin
        hinge = link.joint is not None and link.joint.type == "revolute"
        own = Pivot(at, R @ link.axis / np.linalg.norm(link.axis) if hinge else None)
        lumps = () if link.upright else link.lumps  # an upright link's height is constant
        mass = sum(m for m, _ in lumps)
        first = sum((m * (at + R @ r) for m, r in lumps), np.zeros(3))
        stage = _Stage(link.name, link.upright, (own,), own, mass, first)
        merged = stages[-1].merged(stage, near) if stages else None
        stages[-1:] = [merged] if merged else [*stages[-1:], stage]
    base = ground.name
    while stages and stages[0].upright:
        base = stages.pop(0).body
    return Chain(mechanism, base, tuple(_links(stages, near)), near)


@frozen
class _Stage:
    """A joint and the link it turns: its hinges, what they share, mass [kg] and first moment [kg m] in the world."""

    body: str
    upright: bool
    hinges: tuple[Pivot, ...]
    shared: Pivot
    mass: float
    first: Array

    def merged(self, other: _Stage, near: float) -> _Stage | None:
        """This and the next as one joint, where they turn about one point or line and the mass between allows it."""
        meeting = self.shared.common(other.shared, near)
        if meeting is None:
            return None
        centre = self.first / (self.mass or 1.0)
        on_axis = self.mass > 0 and other.shared.off(centre) <= near  # as good as beyond it
        if not (self.mass == 0 or on_axis or (meeting.e is None and meeting.off(centre) <= near)):
            return None
        mass, first = (self.mass, self.first) if on_axis else (0.0, np.zeros(3))
        hinges = (*self.hinges, *other.hinges)
        return _Stage(other.body, other.upright, hinges, meeting, other.mass + mass, other.first + first)


def _links(stages: list[_Stage], near: float) -> Iterator[ChainLink]:
    beyond = np.cumsum([stage.mass for stage in stages][::-1])[::-1]
    centre = stages[0].shared.p if stages else np.zeros(3)
    for i, stage in enumerate(stages):
        com = stage.first / stage.mass - centre if stage.mass else np.zeros(3)
        length = None
        moment = stage.mass * com
        if i + 1 < len(stages):
            length = _in_line(stages[i + 1].shared, centre, com, near) - centre
            if np.linalg.norm(length) <= near:
                names = f"'{stage.body}' and '{stages[i + 1].body}'"
                raise UnsupportedError(f"links {names} turn about one point, but the mass between is off it")
            moment = moment + beyond[i + 1] * length
        yield ChainLink(stage.body, centre, length, stage.mass, com, moment, stage.hinges)
        centre = centre if length is None else centre + length


def _in_line(pivot: Pivot, centre: Array, com: Array, near: float) -> Array:
    """The point of a pivot in line with `centre` and the mass centre, where there is one; else its origin."""
    if pivot.e is None or np.linalg.norm(com) <= near:
        return pivot.p
    plane = np.column_stack([pivot.p - centre, pivot.e])
    (along, aside), *_ = np.linalg.lstsq(plane, com, rcond=None)
    off = np.linalg.norm(plane @ (along, aside) - com)
    return pivot.p + aside / along * pivot.e if off <= near and abs(along) > COINCIDE else pivot.p

"""A cam to look at and to cut: the closed outline of its profile, and its cable or roller at any angle of the joint."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, vec3
from .element import End
from .laws.law import Terms
from .laws.profile import Profile
from .plane import Plane

if TYPE_CHECKING:
    from ...kinematics import Poses, Tree

AROUND = 64  # points of an outline in a picture
STEPS = 41  # angles of the joint between which a picture goes straight
SHAFT, LARGEST = 0.8, 0.02  # of the room around the axis, at most [m]: what is cut there
INSIDE = 0.9  # of the least distance from the axis: where a roller never is
ROUND = np.linspace(0, 2 * np.pi, 25)


class Track(NamedTuple):
    """A point that moves in a body with the sum of ratio times angle of joints.

    Attributes:
        angles: (m,) of that sum [rad]; places: (m, 3) where it is in the body's frame [m].
    """

    body: str
    joints: Terms
    angles: Array
    places: Array

    def at(self, tree: Tree, poses: Poses) -> Array:
        """(N, 3) where it is in the world."""
        sums = (ratio * poses.s[:, tree.rows[joint]] for joint, ratio in self.joints)
        angle = sum(sums, np.zeros(len(poses.s)))
        own = np.stack([np.interp(angle, self.angles, column) for column in self.places.T], axis=1)
        b = tree.index[self.body]
        return np.einsum("nij,nj->ni", poses.R[:, b], own) + poses.p[:, b]


def closed(made: Profile) -> Array:
    """(n, 2) the outline to cut in the profile's axes [m], the written points first; it closes to its first one.

    What is beside the profile is never in the way: under a cable it is the convex hull with a disk about the axis,
    inside all lines of the cable; under a roller it is nearer to the axis than any of the profile.
    """
    points = np.array(made.profile)
    if made.roller is not None:
        r = INSIDE * float(np.hypot(*points.T).min())
        ends = np.unwrap(np.arctan2(points[[-1, 0], 1], points[[-1, 0], 0]))
        way = float(np.sign(points[0, 0] * points[1, 1] - points[0, 1] * points[1, 0]))
        rest = (way * (ends[1] - ends[0])) % (2 * np.pi)
        turn = ends[0] + way * np.linspace(0, rest, 60)
        return np.vstack([points, r * np.stack([np.cos(turn), np.sin(turn)], axis=1)])
    room = shaft(made)
    disk = room * np.stack([np.cos(ROUND[:-1]), np.sin(ROUND[:-1])], axis=1)
    corners = _hull(np.vstack([points, disk]) if room else points)
    # once around from the first written point on, the way that they go
    area = points[:, 0] * np.roll(points[:, 1], -1) - points[:, 1] * np.roll(points[:, 0], -1)
    corners = corners if area.sum() > 0 else corners[::-1]
    corners = np.roll(corners, -int(np.argmin(np.hypot(*(corners - points[0]).T))), axis=0)
    last = int(np.argmin(np.hypot(*(corners - points[-1]).T)))
    return np.vstack([points, corners[last + 1 :]])


def shaft(made: Profile) -> float:
    """Radius of the disk about the axis that its cable never meets [m]; 0 where the cable's line passes the axis."""
    lever = made.run.lever
    return 0.0 if lever.min() < 0 < lever.max() else min(SHAFT * float(np.abs(lever).min()), LARGEST)


def outline(made: Profile, tree: Tree, joints: Terms) -> tuple[End | Track, ...]:
    """From the spring's fixed end to the profile, and once around the profile from where it is touched."""
    plane, run = Plane.of(tree, joints[0][0]), made.run
    other = "parent" if made.fixed_to == "child" else "child"
    names = {"parent": plane.parent, "child": plane.child}
    angles = np.linspace(run.angle[0], run.angle[-1], STEPS)
    contact = np.stack([np.interp(angles, run.angle, column) for column in run.contact.T], axis=1)
    rim = closed(made)
    rim = np.vstack([rim, rim[:1]])
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(rim, axis=0).T))])
    near = np.array([length[np.argmin(np.hypot(*(rim - p).T))] for p in contact])

    # on a sum of joints nothing of the mechanism turns by it: it is drawn as if on the first joint
    own = joints == ((joints[0][0], 1.0),)

    def track(body: str, flat: Array) -> Track:
        if own or body == "parent":
            return Track(names[body], joints, angles, plane.points(body, flat))
        x, y = np.broadcast_to(flat, (STEPS, 2)).T
        turned = np.stack([np.cos(angles) * x - np.sin(angles) * y, np.sin(angles) * x + np.cos(angles) * y], axis=1)
        return Track(plane.parent, joints, angles, plane.points("parent", turned))

    around = [
        track(made.fixed_to, np.stack([np.interp((near + share * length[-1]) % length[-1], length, column)
                                       for column in rim.T], axis=1))
        for share in np.linspace(0, 1, AROUND)
    ]  # fmt: skip

    def fixed(flat: ArrayLike) -> End | Track:
        if own or other == "parent":
            return names[other], vec3(plane.points(other, flat)[0])
        return track(other, np.asarray(flat, float))

    if made.cable is not None:
        return (fixed(made.cable.point), track(made.fixed_to, contact), *around)
    assert made.roller is not None
    u = np.array([np.cos(made.roller.direction), np.sin(made.roller.direction)])
    left = made.roller.offset * np.array([-u[1], u[0]])
    height = np.interp(angles, run.angle, run.free)
    centre = height[:, None] * u + left
    rolls = [track(other, centre + made.roller.radius * np.array([np.cos(t), np.sin(t)])) for t in ROUND]
    return (fixed(made.roller.seat * u + left), *rolls, track(made.fixed_to, contact), *around)


def _hull(points: Array) -> Array:
    from scipy.spatial import ConvexHull

    return np.asarray(points[ConvexHull(points).vertices])

"""Where to look from, and which two poses to show."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..energy.evaluate import Potential
from ..kinematics import Poses, Tree, sample
from ..kinematics.sampling import bounds, inside
from ..model.arrays import Array
from ..model.masses import lumped_masses
from ..model.mechanism import Mechanism
from .skeleton import Skeleton

CANDIDATES = 600  # random poses to choose from
TURNED = np.deg2rad(28)  # how far a spatial arm is turned out of the picture plane
ELEVATION = np.deg2rad(16)
FEW = 12  # with more coordinates than these, poses half way to the neutral one look less contorted
HALF = 0.5  # of the heaviest pose's load: what the second pose is to have, so that it is not a trivial one
PARALLEL = 1e-6


@dataclass(frozen=True)
class View:
    """A parallel projection: unit vectors (3,) in the world; `normal` points to the viewer, `vertical` against gravity.

    `planar` means that everything moves in the picture plane, which is seen straight on.
    """

    right: Array
    up: Array
    normal: Array
    vertical: Array
    planar: bool

    def flat(self, p: Array) -> Array:
        """World points (..., 3) -> picture (..., 2) [m]."""
        return np.stack([p @ self.right, p @ self.up], axis=-1)

    def depth(self, p: Array) -> Array:
        """(...,) how near to the viewer."""
        return p @ self.normal


def choose(mechanism: Mechanism, skeleton: Skeleton) -> tuple[View, Array]:
    """The view and two configurations (2, n): the arm heavy and stretched out, and bent. Always the same ones."""
    tree = Tree.of(mechanism)
    q = _candidates(tree)
    poses = tree.poses(q)
    points, corners = skeleton.points(poses), skeleton.corners(poses)
    extent = max(float(np.ptp(points[:, :, :], axis=1).max()), 1e-9)
    vertical = _vertical(mechanism)
    base = skeleton.base[0].p if skeleton.base else np.zeros(3)
    below = np.clip((base - points) @ vertical, 0, None).max(axis=1) / extent

    torque = np.abs(Potential(mechanism)(q).gravity_torque)
    heavy = (torque / np.maximum(torque.max(axis=0), 1e-9)).mean(axis=1) if tree.n else np.zeros(len(q))
    heavy /= max(float(heavy.max()), 1e-9)
    ends = skeleton.ends(poses)
    marks = np.concatenate([corners, ends.mean(axis=2), ends[:, :, 0], ends[:, :, 1]], axis=1)  # to be seen apart
    centre = _centre(mechanism, tree, poses) - base
    raised = np.clip(centre @ vertical / extent, None, 0.3)
    normal = _plane(mechanism, tree, poses, vertical)
    view = None if normal is None else _straight_on(normal, vertical)
    side = 0.0 if view is None else 0.3 * np.sign(np.round(centre @ view.right, 9))
    first = int(np.argmax(3 * heavy + side + 2 * _spread(marks) / extent + raised - 2 * below))
    if view is None:
        view = _turned(centre[first], vertical)

    flat = view.flat(points)
    both = np.concatenate([np.broadcast_to(flat[first], flat.shape), flat], axis=1)
    moved = np.linalg.norm(flat - flat[first], axis=2).mean(axis=1) / extent
    springs = _shortest(view.flat(ends)) / extent
    score = 2 * np.clip(moved, 0, 0.3) + 5 * _spread(view.flat(marks)) / extent + 3 * np.clip(springs, 0, 0.2) + raised
    score -= np.ptp(both, axis=1).max(axis=1) / extent + np.abs(heavy - HALF) + 2 * below
    return view, q[[first, int(np.argmax(score))]]


def _candidates(tree: Tree) -> Array:
    q = sample(tree, CANDIDATES)
    neutral = np.clip(0.0, *bounds(tree))
    if tree.n > FEW and not tree.mechanism.loops and inside(tree, neutral[None]).all():
        return neutral + 0.5 * (q - neutral)  # ranges and couplings are linear, so that it stays inside
    return q


def _vertical(mechanism: Mechanism) -> Array:
    g = np.array(mechanism.gravity, float)
    return -g / np.linalg.norm(g) if g.any() else np.array([0.0, 0.0, 1.0])


def _centre(mechanism: Mechanism, tree: Tree, poses: Poses) -> Array:
    """(N, 3) centre of mass; of massless mechanisms the mean of the body origins."""
    masses = [(m, poses.point(tree.index[body], p)) for body, m, p in lumped_masses(mechanism) if m]
    total = sum(m for m, _ in masses)
    return sum((m / total * p for m, p in masses), np.zeros(3)) if masses else poses.p.mean(axis=1)


def _plane(mechanism: Mechanism, tree: Tree, poses: Poses, vertical: Array) -> Array | None:
    """The normal of the plane in which everything moves, None when there is no such vertical plane."""
    turns, slides = [], []
    for link in tree.links:
        if link.joint.type == "spherical":
            return None
        for motion in link.motions:
            (turns if motion.rotates else slides).append((poses.R[:, link.base] @ link.R0) @ motion.axis)
    if not turns:
        return None
    axes = np.concatenate(turns)
    normal = axes[0]
    parallel = np.linalg.norm(np.cross(axes, normal), axis=1).max() < PARALLEL
    across = all(np.abs(slide @ normal).max() < PARALLEL for slide in slides)
    return normal if parallel and across and abs(normal @ vertical) < PARALLEL else None


def _straight_on(normal: Array, vertical: Array) -> View:
    right = np.cross(vertical, normal)
    if right[np.argmax(np.abs(right) > 0.5)] < 0:  # seen from the side that has the world's positive axis to the right
        right, normal = -right, -normal
    return View(right, vertical, normal, vertical, planar=True)


def _turned(reach: Array, vertical: Array) -> View:
    """The arm reaches to the right, a little towards the viewer, and is seen from slightly above."""
    level = reach - (reach @ vertical) * vertical
    if np.linalg.norm(level) < 1e-9:
        level = np.cross(vertical, np.eye(3)[np.argmin(np.abs(vertical))])
    level = level / np.linalg.norm(level)
    side = np.cross(level, vertical)  # to the right of whoever looks along the arm
    right = np.cos(TURNED) * level - np.sin(TURNED) * side
    toward = np.cross(right, vertical)
    normal = np.cos(ELEVATION) * toward + np.sin(ELEVATION) * vertical
    return View(right, np.cross(normal, right), normal, vertical, planar=False)


def _spread(points: Array) -> Array:
    """(N,) mean distance of the K points (N, K, d) to their nearest neighbours [m]."""
    N, K, _ = points.shape
    if K < 2:
        return np.zeros(N)
    distance = np.linalg.norm(points[:, :, None] - points[:, None], axis=3) + np.where(np.eye(K), np.inf, 0.0)
    return distance.min(axis=2).mean(axis=1)


def _shortest(ends: Array) -> Array:
    """(N,) length of the shortest spring [m], with its ends (N, springs, 2, d)."""
    length = np.linalg.norm(ends[:, :, 0] - ends[:, :, 1], axis=2)
    return length.min(axis=1) if length.shape[1] else np.zeros(len(ends))

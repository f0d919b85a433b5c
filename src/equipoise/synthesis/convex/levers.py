"""Attachments keep a least distance from the axis that they turn about: nearer, no hole and no hook has room."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...kinematics import Tree, sample
from ...model.arrays import Array
from ...model.elements import Spring
from ...model.mechanism import Mechanism

LEAST = 0.005  # [m]
MORE = 0.05  # share by which the distance that is aimed at is larger than the one asked for
WEIGHT = 30.0  # of a row: what is missing counts, not the torque that it would save


@dataclass(frozen=True, eq=False)
class Levers:
    """Rows of what is missing of the least distances, zero where nothing is.

    Attributes:
        origin: (springs, 2, 3) a point of the axis next to each end, in the frame of its body [m].
        across: (springs, 2, 3, 3) projector onto what counts as distance; none where nothing turns.
        wanted: (springs, 2) [m] no more than the ends have now.
    """

    origin: Array
    across: Array
    wanted: Array

    @staticmethod
    def of(mechanism: Mechanism, springs: Sequence[Spring], least: float = LEAST) -> Levers:
        """Of springs of a mechanism; what is nearer now may stay as near."""
        axes = [[_axis(mechanism, body, other) for body, other in ((s.body_a, s.body_b), (s.body_b, s.body_a))]
                for s in springs]  # fmt: skip
        origin = np.array([[o for o, _ in pair] for pair in axes]).reshape(-1, 2, 3)
        across = np.array([[P for _, P in pair] for pair in axes]).reshape(-1, 2, 3, 3)
        ends = np.array([(s.p_a, s.p_b) for s in springs]).reshape(-1, 2, 3)
        now = np.linalg.norm(np.einsum("seij,sej->sei", across, ends - origin), axis=2)
        return Levers(origin, across, np.minimum(least * (1 + MORE), now))

    def __call__(self, ends: Array) -> tuple[Array, Array]:
        """Rows, and their derivative (rows, springs, 2, 3) by attachments (springs, 2, 3) [m]."""
        d = np.einsum("seij,sej->sei", self.across, ends - self.origin)
        distance = np.linalg.norm(d, axis=2)
        near = np.argwhere(distance < self.wanted)
        rows, J = np.zeros(len(near)), np.zeros((len(near), *ends.shape))
        for row, (i, e) in enumerate(near):
            unit = WEIGHT / self.wanted[i, e]
            rows[row] = unit * (self.wanted[i, e] - distance[i, e])
            J[row, i, e] = -unit * d[i, e] / max(float(distance[i, e]), 1e-12)
        return rows, J


def _axis(mechanism: Mechanism, body: str, other: str) -> tuple[Array, Array]:
    """A point (3,) of the axis of the moving joint next to `body` on the way to `other`, and the projector (3, 3)
    across it, both in the frame of `body`: a ball joint has no axis, a slide no distance."""
    tree = Tree.of(mechanism)
    above = {link.body: link for link in tree.links}

    def up(i: int) -> list[int]:
        return [i, *up(above[i].parent)] if i in above else [i]

    mine, theirs = up(tree.index[body]), up(tree.index[other])
    common = next(i for i in mine if i in theirs)
    way = mine[: mine.index(common)] + theirs[: theirs.index(common)][::-1]
    joint = next((above[i] for i in way if above[i].motions or above[i].base != above[i].parent), None)
    if joint is None or joint.slide is not None:
        return np.zeros(3), np.zeros((3, 3))
    poses = tree.poses(sample(tree, 1))  # nothing moves between the body and that joint
    R, p = poses.R[0, tree.index[body]], poses.p[0, tree.index[body]]
    origin = R.T @ (poses.p[0, joint.body] - p)
    if len(joint.motions) != 1:
        return origin, np.eye(3)
    z = R.T @ poses.R[0, joint.body] @ joint.motions[0].axis
    return origin, np.eye(3) - np.outer(z, z)

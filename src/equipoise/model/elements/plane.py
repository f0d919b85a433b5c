"""The plane of a hinge: its two axes in either of the joint's bodies, at angle 0."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, frozen
from ..rotation import frame_of

if TYPE_CHECKING:
    from ...kinematics import Tree


@frozen
class Plane:
    """Where the axes x, y of a hinge's plane are: the first two rows of `frame_of(axis)` in the child's frame.

    Attributes:
        parent, child: names of the bodies.
        axes: (3, 3) rows x, y and the joint's axis, in the child's frame.
        R0, p0: the child's frame in the parent's at angle 0.
    """

    parent: str
    child: str
    axes: Array
    R0: Array
    p0: Array

    @staticmethod
    def of(tree: Tree, joint: str) -> Plane:
        """That of a joint by name."""
        link = next(link for link in tree.links if link.joint.name == joint)
        return Plane(tree.names[link.parent], tree.names[link.body], frame_of(link.motions[0].axis), link.R0, link.p0)

    def points(self, body: str, flat: ArrayLike, lift: float = 0.0) -> Array:
        """Points (n, 2) of the plane in the frame of "child" or "parent", (n, 3) [m]; `lift` is along the axis."""
        flat = np.atleast_2d(np.asarray(flat, float))
        found = np.column_stack([flat, np.full(len(flat), lift)]) @ self.axes
        return found if body == "child" else found @ self.R0.T + self.p0

    def direction(self, body: str, vector: ArrayLike) -> Array:
        """(2,) a direction (3,) of the child's or parent's frame, seen in the plane."""
        vector = np.asarray(vector, float)
        return np.asarray((self.axes @ (vector if body == "child" else self.R0.T @ vector))[:2])

"""A parallelogram joint for a simulator that has only joints between parent and child: replica hinges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..model.arrays import frozen
from ..model.elements import Vec3
from ..model.errors import UnsupportedError
from ..model.mechanism import WORLD, Joint, Mechanism
from ..model.names import Names
from ..model.rotation import from_rpy


@dataclass(frozen=True)
class Hinge:
    """A replica on a parallelogram's child: its own name, the joint whose angle it has, its axis in the child frame."""

    name: str
    original: str
    axis: Vec3


@frozen
class Replicas:
    """The child's orientation in the parent frame at zero, (3, 3), then the hinges that turn it, in this order."""

    R_PC: NDArray[np.float64]
    hinges: tuple[Hinge, ...]


def replicas(m: Mechanism) -> dict[str, Replicas]:
    """The replicas of each parallelogram joint.

    Raises:
        UnsupportedError: a spherical joint lies between a parallelogram joint's parent and the body it follows.
    """
    holder = {joint.child: joint for joint in m.joints}
    names = Names(joint.name for joint in m.joints)

    def orienting(body: str) -> list[Joint]:
        """The joints whose rotations make up a body's orientation, from the world outwards."""
        path: list[Joint] = []
        while body != WORLD:
            path.append(holder[body])
            body = path[-1].follows or path[-1].parent
        return path[::-1]

    result = {}
    for joint in m.joints:
        if joint.type != "parallelogram":
            continue
        undo, repeat = orienting(joint.parent), orienting(joint.follows or WORLD)
        while undo and repeat and undo[0] is repeat[0]:
            del undo[0], repeat[0]
        for other in (*undo, *repeat):
            if other.type == "spherical":
                raise UnsupportedError(
                    f"MJCF cannot hold the parallelogram joint '{joint.name}': the spherical joint '{other.name}' lies "
                    f"between '{joint.parent}' and '{joint.follows}'"
                )
        # R_PC = (rotations of undo)^T (rotations of repeat) R(rpy), taken from the right: with the constant rotations
        # gathered on the left in R, each hinge axis is seen from the child frame
        R, hinges = from_rpy(joint.rpy), []
        for other, sign in [*((other, 1) for other in reversed(repeat)), *((other, -1) for other in undo)]:
            R_fixed = from_rpy(other.rpy)
            if sign < 0:
                R = R_fixed.T @ R
            if other.type == "revolute":
                x, y, z = (sign * R.T @ np.asarray(other.axis)).tolist()
                hinges.append(Hinge(names.new(f"{joint.name}.{other.name}"), other.name, (x, y, z)))
            if sign > 0:
                R = R_fixed @ R
        result[joint.name] = Replicas(R, tuple(hinges[::-1]))
    return result

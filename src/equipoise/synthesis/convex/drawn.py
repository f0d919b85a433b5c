"""A spring where one would draw it: changes of one spring that no torque notices.

Between bodies whose axes are all parallel, where along these axes the ends are does not matter: both go into one plane.
A spring about one hinge can be turned about it: its end on the link goes where the link's mass centre is.
"""

from __future__ import annotations

import numpy as np

from ...kinematics import Poses, Tree
from ...model.arrays import Array, frozen
from ...model.rotation import about
from .spring_block import SpringBlock

TURNS = 8  # poses that tell whether axes are parallel
PARALLEL = 1e-9


@frozen
class Plane:
    """The normal of all axes between two bodies, in the frame of each, and how far along it B's origin is [m]."""

    a: Array
    b: Array
    apart: float

    @staticmethod
    def between(poses: Poses, A: int, B: int) -> Plane | None:
        """Of bodies A and B; None where their axes are not parallel, or nothing turns."""
        R = np.swapaxes(poses.R[:TURNS, A], 1, 2) @ poses.R[:TURNS, B]
        p = np.einsum("nji,nj->ni", poses.R[:TURNS, A], poses.p[:TURNS, B] - poses.p[:TURNS, A])
        _, values, rows = np.linalg.svd(np.concatenate(R - R[0]))
        if values[1] < PARALLEL or values[2] > PARALLEL * len(R):
            return None
        b = rows[2]
        a = R[0] @ b
        apart = p @ a
        one = np.ptp(apart) < PARALLEL * (1 + float(np.abs(p).max()))
        return Plane(a, b, float(apart.mean())) if one else None


def towards_mass(tree: Tree, name: str) -> tuple[Array, Array] | None:
    """The axis of the hinge that carries a body, and the direction from it to the mass centre, in the body's frame."""
    link = tree.link_of.get(tree.index[name])
    body = next((body for body in tree.mechanism.bodies if body.name == name), None)
    if link is None or body is None or body.mass <= 0 or link.joint.type != "revolute":
        return None
    axis = np.array(link.joint.axis) / np.linalg.norm(link.joint.axis)
    com = np.array(body.com)
    away = com - (com @ axis) * axis
    size = float(np.linalg.norm(away))
    return (axis, away / size) if size > PARALLEL + 1e-6 * float(np.linalg.norm(com)) else None


def drawn(tree: Tree, block: SpringBlock, plane: Plane | None, u: Array) -> Array:
    """(shape,) of a spring that does what one of shape u (shape,) does: in the plane, and turned towards the mass."""
    z = block.lift @ block.ends(u[None])[0]
    p_a, p_b = z[:3], z[4:]
    if plane is not None:
        for height in (0.0, plane.apart, plane.apart / 2):
            flat = p_a + (height - p_a @ plane.a) * plane.a, p_b + (height - plane.apart - p_b @ plane.b) * plane.b
            if (found := _shape(block, *flat)) is not None:
                u, p_a, p_b = found, *flat
                break
    for turned in _turned(tree, block, p_a, p_b):
        if (found := _shape(block, *turned)) is not None:
            return found
    return u


def _turned(tree: Tree, block: SpringBlock, p_a: Array, p_b: Array) -> list[tuple[Array, Array]]:
    """Both ends turned about the hinge that joins their bodies, where there is one."""
    names, ends = block.place, [p_a, p_b]
    for child in (0, 1):
        link, centre = tree.link_of.get(tree.index[names[child]]), towards_mass(tree, names[child])
        if centre is None or link is None or tree.names[link.parent] != names[1 - child]:
            continue
        axis, towards = centre
        across = np.cross(axis, towards)
        here = ends[child]
        angle = -float(np.arctan2(across @ here, towards @ here))
        moved = list(ends)
        moved[child] = about(axis, np.array(angle)) @ here
        moved[1 - child] = link.p0 + about(link.R0 @ axis, np.array(angle)) @ (ends[1 - child] - link.p0)
        return [(moved[0], moved[1])]
    return []


def _shape(block: SpringBlock, p_a: Array, p_b: Array) -> Array | None:
    """(shape,) of a spring between two points [m]; None where one is outside its region."""
    parts = []
    for region, p in ((block.region_a, p_a), (block.region_b, p_b)):
        half, off = np.array(region.half), p - region.at
        axes = list(region.axes)
        fixed = [i for i in range(3) if i not in axes]
        if np.abs(off[fixed]).max(initial=0.0) > PARALLEL * (1 + np.abs(p).max()):
            return None
        parts.append(off[axes] / half[axes])
    u = np.concatenate(parts)
    nearest = block.project(u[None])[0]
    return nearest if np.abs(nearest - u).max(initial=0.0) < PARALLEL else None

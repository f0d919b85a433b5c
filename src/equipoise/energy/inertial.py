"""What it takes to move: the torques of inertia, damping and dry friction (d'Alembert's principle, body by body)."""

from __future__ import annotations

from collections.abc import Iterator
from warnings import warn

import numpy as np

from ..kinematics.moving import Moving
from ..model.arrays import Array
from ..model.errors import EquipoiseWarning
from ..model.masses import lumped_masses
from ..model.mechanism import Mechanism


def motion_torque(mechanism: Mechanism, moving: Moving) -> Array:
    """(N, n) [N m or N] the torque at the independent coordinates that moves the masses and beats the joints' friction.

    All masses count, payloads and those of springs among them; gravity and what springs pull do not.

    Warns:
        EquipoiseWarning: a body with a mass has no inertia: then it counts as a mass in one point.
    """
    tree = moving.tree
    found = np.zeros(moving.q.shape)
    for body, mass, p in lumped_masses(mechanism):
        if mass:
            found += mass * point_torque(moving, tree.index[body], p)
    for index, inertia in _inertias(mechanism, moving):
        R, turn = moving.poses.R[:, index], moving.turn[:, index]
        world = R @ inertia @ np.swapaxes(R, 1, 2)
        moment = (world @ moving.spin[:, index, :, None])[..., 0]
        moment += np.cross(turn, (world @ turn[..., None])[..., 0])
        found += np.einsum("ni,nij->nj", moment, moving.velocities.w[:, index])
    rates = np.einsum("nmj,nj->nm", moving.velocities.s, moving.rate)
    resisted = np.stack([_resistance(mechanism, name, rates[:, i]) for i, name in enumerate(tree.motions)], axis=1)
    return found + np.einsum("nm,nmj->nj", resisted, moving.velocities.s)


def point_torque(moving: Moving, body: int, p: Array) -> Array:
    """(N, n) [N m or N per kg] the torque that moves a mass of 1 kg at the point `p` (3,) of a body."""
    rate = moving.velocities.point(moving.poses, body, p)
    return np.einsum("ni,nij->nj", moving.point(body, p), rate)


def _inertias(mechanism: Mechanism, moving: Moving) -> Iterator[tuple[int, Array]]:
    """The bodies that turn, and their inertia about the centre of mass (3, 3) in the body's frame."""
    unknown = []
    for body in mechanism.bodies:
        index = moving.tree.index[body.name]
        turns = np.abs(moving.velocities.w[:, index]).max(initial=0.0) > 0
        if body.inertia is not None and turns:
            xx, yy, zz, xy, xz, yz = body.inertia
            yield index, np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        elif body.mass and turns:
            unknown.append(body.name)
    if unknown:
        warn(f"no inertia is known of {', '.join(unknown)}: masses in one point", EquipoiseWarning, stacklevel=2)


def _resistance(mechanism: Mechanism, name: str, rate: Array) -> Array:
    """(N,) damping and dry friction of the joint that a motion belongs to, at its rates (N,)."""
    joint = next(j for j in mechanism.joints if name in j.coordinates)
    return joint.damping * rate + joint.friction * np.sign(rate)

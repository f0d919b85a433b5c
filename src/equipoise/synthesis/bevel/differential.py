"""The bevel differential of a roll-pitch shoulder, in closed form.

C. Cho, W. Lee, J. Lee and S. Kang, "A 2-dof gravity compensator with bevel gears", J. Mechanical Science and Technology
26 (2012), Secs. 2 and 3. Angles theta = (theta_1, theta_2), (..., 2) [rad], are zero where the link hangs: l points
along gravity. m g l is written `weight` [N m]. A positive torque is one that acts on the joint; what an actuator has to
hold against gravity is -tau_m.
"""

from __future__ import annotations

import numpy as np

from ...model.arrays import Array

ARRANGEMENTS = ("near", "far")
"""Where the fixed bevel gear is on the roll axis: on the side that the axis points away from, or opposite."""
SIDES = ("left", "right")
"""Disk 1, where the pitch axis points to, and disk 2, where it points away from."""


def differential(arrangement: str = "near", gear_ratio: float = 1.0) -> Array:
    """2J of theta_b = 2J theta, (11): how the disks (rows) turn against the link as roll and pitch (columns) do.

    Args:
        gear_ratio: teeth of the fixed gear over those of a disk's gear; the paper's is 1.
    """
    roll = gear_ratio if arrangement == "near" else -gear_ratio
    return np.array([[-roll, -1.0], [roll, -1.0]])


def gravity_torque(weight: float, theta: Array) -> Array:
    """tau_m (..., 2) [N m], (2)."""
    s, c = np.sin(theta), np.cos(theta)
    return -weight * np.stack([s[..., 0] * c[..., 1], c[..., 0] * s[..., 1]], axis=-1)


def gravity_energy(weight: float, theta: Array) -> Array:
    """V_m (...) [J], (3)."""
    return -weight * np.cos(theta[..., 0]) * np.cos(theta[..., 1])


def single_stiffness(weight: float, b: float, h: float) -> float:
    """k = m g l / (b h) [N/m] of the one spring of a link on one joint, (7)."""
    return weight / (b * h)


def stiffness(weight: float, b: float, h: float) -> float:
    """k = m g l / (2 b h) [N/m] of each of the two springs, (23)."""
    return single_stiffness(weight / 2, b, h)


def stretch_squared(b: float, h: float, theta_b: Array) -> Array:
    """s_i^2 (..., 2) [m^2], (13); with `theta_b` = 2J theta it is (14).

    A_i is at the angle theta_b,i + pi on its disk, (12), and B_i at angle zero on the link. In (12) the paper writes
    the plane of the disk as the x-y plane of its Fig. 2; in its frame 2 it is x-z.
    """
    return b**2 + h**2 + 2 * b * h * np.cos(theta_b)


def spring_energy(k: float, b: float, h: float, theta: Array, J: Array) -> Array:
    """V_k (...) [J] of both springs, (15)-(16), for any 2J."""
    return k / 2 * stretch_squared(b, h, theta @ J.T).sum(axis=-1)


def balanced_spring_energy(k: float, b: float, h: float, theta: Array) -> Array:
    """V_k (...) [J] for a gear ratio of 1, (17)-(18): the same for both arrangements.

    The constant is C = k (b^2 + h^2), as (13) and (15) give; 2 k (b^2 + h^2) in print.
    """
    return k * (b**2 + h**2) + 2 * b * h * k * np.cos(theta[..., 0]) * np.cos(theta[..., 1])


def disk_torque(k: float, b: float, h: float, theta_b: Array) -> Array:
    """tau_b (..., 2) [N m] of the springs on the disks, (24)."""
    return k * b * h * np.sin(theta_b)


def spring_torque(k: float, b: float, h: float, theta: Array, J: Array) -> Array:
    """tau_s = 2J' tau_b (..., 2) [N m] at the joints, (25)-(26), for any 2J."""
    return disk_torque(k, b, h, theta @ J.T) @ J


def balanced_spring_torque(k: float, b: float, h: float, theta: Array) -> Array:
    """tau_s (..., 2) [N m] for a gear ratio of 1, (27): with k of (23) it is -tau_m, (28)."""
    return -gravity_torque(2 * k * b * h, theta)

"""Rotation matrices, and the quaternions that some file formats want."""

from __future__ import annotations

from math import atan2, cos, hypot, sin

import numpy as np
from numpy.typing import ArrayLike

from .arrays import Array, Complexes


def skew(v: ArrayLike) -> Array:
    """The matrix of the cross product: ``skew(v) @ x == cross(v, x)``. v: (..., 3) -> (..., 3, 3)."""
    v = np.asarray(v, float)
    S = np.zeros((*v.shape[:-1], 3, 3))
    S[..., 0, 1], S[..., 0, 2], S[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    return S - np.swapaxes(S, -1, -2)


def from_rpy(rpy: ArrayLike) -> Array:
    """Roll, pitch, yaw about the fixed x, y, z axes [rad] -> ``Rz(yaw) @ Ry(pitch) @ Rx(roll)``, (3, 3)."""
    roll, pitch, yaw = np.asarray(rpy, float)
    x = np.array([[1, 0, 0], [0, cos(roll), -sin(roll)], [0, sin(roll), cos(roll)]])
    y = np.array([[cos(pitch), 0, sin(pitch)], [0, 1, 0], [-sin(pitch), 0, cos(pitch)]])
    z = np.array([[cos(yaw), -sin(yaw), 0], [sin(yaw), cos(yaw), 0], [0, 0, 1]])
    return z @ y @ x


def to_rpy(R: ArrayLike) -> tuple[float, float, float]:
    """Roll, pitch, yaw [rad] with ``from_rpy(to_rpy(R)) == R``; where pitch is +-90 deg the yaw is taken as 0."""
    R = np.asarray(R, float)
    level = hypot(R[0, 0], R[1, 0])
    pitch = atan2(-R[2, 0], level)
    if level > 1e-12:
        return atan2(R[2, 1], R[2, 2]), pitch, atan2(R[1, 0], R[0, 0])
    return atan2(-R[1, 2], R[1, 1]), pitch, 0.0


def about(axis: ArrayLike, angle: ArrayLike) -> Array:
    """Rotation by `angle` [rad], any shape, about a fixed unit `axis` (3,) -> (..., 3, 3) (Rodrigues' formula)."""
    A0, A1 = harmonics(axis)
    # the phase's real part multiplies 2 Re A1, its imaginary part -2 Im A1
    angle = np.asarray(angle, float)[..., None, None]
    return A0 + 2 * (np.cos(angle) * A1.real - np.sin(angle) * A1.imag)


def frame_of(axis: ArrayLike) -> Array:
    """(3, 3) rows: two unit vectors that make a right-handed frame with the unit vector `axis`, and that one last."""
    z = np.asarray(axis, float)
    x: Array = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = x - (x @ z) * z
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z])


def harmonics(axis: ArrayLike) -> tuple[Array, Complexes]:
    """(A0, A1) with ``R(q) = A0 + A1 exp(iq) + conj(A1) exp(-iq)`` for the rotation about a unit `axis` (3,).

    This is what makes the energy a finite Fourier series (docs/theory.md, section 2).
    """
    a = np.asarray(axis, float)
    A0 = np.outer(a, a)
    return A0, 0.5 * ((np.eye(3) - A0) - 1j * skew(a))


def to_quaternion(R: ArrayLike) -> Array:
    """The unit quaternion (w, x, y, z) of a rotation matrix (3, 3), exact to rounding at any angle."""
    R = np.asarray(R, float)
    # 4 q q^T in terms of R: the column with the largest diagonal entry loses no digits (Shepperd's method)
    K = np.empty((4, 4))
    K[0, 0] = 1 + np.trace(R)
    K[0, 1:] = K[1:, 0] = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    K[1:, 1:] = R + R.T + (1 - np.trace(R)) * np.eye(3)
    column = K[:, np.argmax(np.diag(K))]
    return column / np.linalg.norm(column)


def from_quaternion(quaternion: ArrayLike) -> Array:
    """The rotation matrix (3, 3) of a quaternion (w, x, y, z) of any length but zero."""
    q = np.asarray(quaternion, float)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def ball_angles(R: ArrayLike) -> tuple[float, float, float]:
    """x, y, z [rad] of a spherical joint with the rotation ``Rx(x) Ry(y) Rz(z)``, (3, 3)."""
    R = np.asarray(R, float)
    return (
        atan2(-R[1, 2], R[2, 2]),
        atan2(R[0, 2], hypot(R[0, 0], R[0, 1])),
        atan2(-R[0, 1], R[0, 0]),
    )

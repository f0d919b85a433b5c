"""The two rotations that file formats need: from roll, pitch, yaw, and to a quaternion."""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def from_rpy(rpy: ArrayLike) -> Array:
    """Roll, pitch, yaw about the fixed x, y, z axes [rad] -> ``Rz(yaw) @ Ry(pitch) @ Rx(roll)``, (3, 3)."""
    roll, pitch, yaw = np.asarray(rpy, float)
    x = np.array([[1, 0, 0], [0, cos(roll), -sin(roll)], [0, sin(roll), cos(roll)]])
    y = np.array([[cos(pitch), 0, sin(pitch)], [0, 1, 0], [-sin(pitch), 0, cos(pitch)]])
    z = np.array([[cos(yaw), -sin(yaw), 0], [sin(yaw), cos(yaw), 0], [0, 0, 1]])
    return z @ y @ x


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

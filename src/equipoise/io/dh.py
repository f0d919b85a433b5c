"""The Denavit-Hartenberg table of a mechanism file: a serial chain, one row for each body, the first on the world.

standard: T = Rz(theta) Tz(d) Tx(a) Rx(alpha); modified (Craig): T = Rx(alpha) Tx(a) Rz(theta) Tz(d).
The coordinate of a row's joint is added to theta (revolute) or to d (prismatic).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, cos, hypot, sin

from ..model.elements import Vec3
from ..model.mechanism import WORLD, Body, Joint
from .schema import DhTable

Z = (0.0, 0.0, 1.0)


def expand(table: DhTable, bodies: Sequence[Body]) -> tuple[list[tuple[Body, int]], list[tuple[Joint, int]]]:
    """The bodies and joints of a table, each with the row it comes from; a body's frame is the frame of its row.

    In the standard convention the joint's axis is the z of the frame before, so a joint moves a massless body
    `<body>_axis`, and a fixed joint `<joint>_link` carries the body at (a, alpha) from it, at d along the
    axis too where the joint turns.

    Args:
        bodies: as many as the table has rows.
    """
    all_bodies: list[tuple[Body, int]] = []
    joints: list[tuple[Joint, int]] = []
    parent = WORLD
    for i, (row, body) in enumerate(zip(table.rows, bodies, strict=True)):
        name = row.name if row.name is not None else f"joint_{i + 1}"
        offset = 0.0
        child, xyz, rpy = body.name, (0.0, 0.0, row.d), (0.0, 0.0, row.theta)
        if table.convention == "modified":
            xyz = (row.a, -row.d * sin(row.alpha), row.d * cos(row.alpha))
            rpy = _rx_rz(row.alpha, row.theta)
        else:
            child = f"{body.name}_axis"
            if row.type == "revolute":  # Rz and Tz commute: the link, which has the offset d, starts at the last frame
                xyz, offset = (0.0, 0.0, 0.0), row.d
            all_bodies.append((Body(child), i))
        all_bodies.append((body, i))
        joints.append((Joint(name, row.type, parent, child, xyz, rpy, Z, row.range), i))
        if child != body.name:
            link = Joint(f"{name}_link", "fixed", child, body.name, (row.a, 0.0, offset), (row.alpha, 0.0, 0.0))
            joints.append((link, i))
        parent = body.name
    return all_bodies, joints


def _rx_rz(alpha: float, theta: float) -> Vec3:
    """Roll, pitch, yaw [rad] of Rx(alpha) Rz(theta), also where the pitch is a right angle."""
    if theta == 0:  # the common cases, exactly
        return (alpha, 0.0, 0.0)
    if alpha == 0:
        return (0.0, 0.0, theta)
    ca, sa, ct, st = cos(alpha), sin(alpha), cos(theta), sin(theta)
    yaw = atan2(ca * st, ct)
    pitch = atan2(-sa * st, hypot(ct, ca * st))
    # from Rz(-yaw) R, and not from R itself: whatever the yaw, the product of the three is R
    roll = atan2(sa * cos(yaw), ca * ct * cos(yaw) + st * sin(yaw))
    return (roll, pitch, yaw)

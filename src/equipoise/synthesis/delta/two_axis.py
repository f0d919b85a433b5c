"""A two-axis rocker by itself (Simionescu, Ciupitu and Ionita 2015, section 4), in any mechanism that is one.

Link 3 turns about a horizontal axis B on a body that stays upright, link 4 about C on link 3, which meets B at a right
angle: a roll-pitch shoulder. The guide of `rocker` and springs 10 and 11 balance link 4, a spring of Eq. (3) link 3.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...kinematics import Tree
from ...kinematics.sampling import bounds
from ...model.arrays import Array
from ...model.mechanism import Body, Joint, Mechanism
from ...model.rotation import to_rpy
from ..arms.shoulder import Shoulder
from .rocker import Guide, TwoAxisRocker, snapped


def balanced(mechanism: Mechanism, shoulder: Shoulder, guide: Guide) -> Mechanism:
    """The mechanism with the guide and its springs; its own springs go."""
    bare = mechanism.with_springs(())
    frame, fixed, parts = _rocker(bare, shoulder)
    return replace(
        bare,
        bodies=(*bare.bodies, Body(frame, guide.frame), *parts.bodies(guide, "")),
        joints=(*bare.joints, fixed, *parts.joints(guide, "")),
        couplings=(*bare.couplings, parts.coupling("")),
        springs=tuple(parts.springs(guide, "", shoulder.g)),
    )


def _rocker(m: Mechanism, s: Shoulder) -> tuple[str, Joint, TwoAxisRocker]:
    """The upright frame of B as a body, how it is fixed, and the rocker."""
    B = s.roll.joint
    assert B is not None
    tree = Tree.of(m)
    home = tree.poses(np.zeros((1, tree.n))).R[0]
    base, R_3, R_4 = (home[tree.index[name]] for name in (B.parent, s.roll.name, s.pitch.name))
    y, up = R_3 @ s.roll.axis, base @ s.up
    upright = np.column_stack([np.cross(y, up), y, up])
    across = R_4 @ s.pitch.axis
    lower, upper = bounds(tree)
    middle = float((lower + upper)[tree.coordinates.index(B.name)]) / 2
    psi, z = min(
        ((_tilt(upright, np.cross(sign * across, y)), sign * across) for sign in (1, -1)),
        key=lambda one: abs(_wrapped(one[0] + middle)),
    )
    cross = R_3.T @ np.column_stack([z, y, np.cross(z, y)])
    frame = "frame B"
    fixed = Joint(frame, "fixed", B.parent, frame, B.xyz, to_rpy(base.T @ upright))
    parts = TwoAxisRocker(
        upright=frame,
        at=(0.0, 0.0, 0.0),
        cross=s.roll.name,
        R_3=cross,
        angle=((B.name, 1.0),),
        offset=psi,
        rocker=s.pitch.name,
        C=float(s.pitch.tip @ s.roll.axis),
        moment=s.pitch_moment,
        own=s.roll_moment,
        places=(snapped(s.roll.origin), snapped(s.centre)),
    )
    return frame, fixed, parts


def _tilt(upright: Array, z: Array) -> float:
    """psi [rad] where the bar of link 3 points along `z` (3,) in the world."""
    return float(np.arctan2(z @ upright[:, 0], z @ upright[:, 2]))


def _wrapped(angle: float) -> float:
    return (angle + np.pi) % (2 * np.pi) - np.pi

"""A mechanism that goes no farther than its motions do: where only these are to have room."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..kinematics import Tree
from ..model.mechanism import SINGLE, Mechanism
from ..model.motion import Motion


def within(mechanism: Mechanism, motions: Sequence[Motion]) -> Mechanism:
    """The mechanism with the ranges that the motions use; what does not move in any stays at rest.

    Ball joints and joints that others drive keep their ranges. Without motions it is the mechanism itself.
    """
    if not motions:
        return mechanism
    tree = Tree.of(mechanism)
    low: dict[str, float] = dict(zip(tree.coordinates, tree.rest.tolist(), strict=True))
    high = dict(low)
    moved = {name for motion in motions for name in motion.coordinates}
    for name in moved & low.keys():
        values = [np.array(motion.values)[:, motion.coordinates.index(name)]
                  for motion in motions if name in motion.coordinates]  # fmt: skip
        low[name], high[name] = (float(f([f(v) for v in values])) for f in (min, max))
    joints = (
        replace(joint, range=(low[joint.name], high[joint.name]))
        if joint.type in SINGLE and joint.name in low
        else joint
        for joint in mechanism.joints
    )
    return replace(mechanism, joints=tuple(joints))

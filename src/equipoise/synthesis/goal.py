"""What a goal is to a problem: its options, and what it makes of each joint's torque; and a problem as a goal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..kinematics import Tree
from ..model.arrays import Array, Booleans
from ..model.errors import Fault, InputError
from ..model.goal import BY_DEFAULT, Count, Goal
from ..model.mechanism import Joint
from ..model.motion import Where
from .load import cases

if TYPE_CHECKING:
    from .problem import Problem


def asked(goal: Goal, given: Mapping[str, Any]) -> dict[str, Any]:
    """The options that a goal stands for, where they are not given."""
    count = goal.count
    meant = {
        "objective": count.torque,
        "weights": dict(count.joints),
        "joints": count.only,
        "loads": cases(goal.loads),
        "samples": goal.poses.samples,
        "goal": goal,
    }
    found = {name: value for name, value in meant.items() if given[name] is None}
    whole = given["unlimited"] or goal.poses.whole_turns
    return found | {"unlimited": whole, "seed": given["seed"] or goal.poses.seed}


def stated(goal: Goal, problem: Problem) -> Goal:
    """The goal with what a problem asks for; none where a file cannot say it, for loads were given."""
    if problem.loads != cases(goal.loads):
        return BY_DEFAULT
    found = goal.counting(torque=problem.objective, joints=problem.weights, only=problem.joints)
    poses = replace(found.poses, samples=problem.samples, seed=problem.seed, whole_turns=problem.unlimited)
    # where nothing is asked for but other poses, there is no goal to write down
    return replace(found, poses=poses) if replace(found, poses=Where()) or poses.chosen else BY_DEFAULT


def motor_scale(count: Count, tree: Tree, counted: Booleans) -> Array | None:
    """(n,) what a unit of each coordinate's torque is to its motor; None where motors do not count.

    Raises:
        InputError: of one of those that are `counted` (n,) it is not known.
    """
    if count.share_of is None:
        return None
    joints = {coordinate: joint for joint in tree.mechanism.joints for coordinate in joint.coordinates}
    found, missing = np.zeros(tree.n), []
    for j, name in enumerate(tree.coordinates):
        value = _effort(joints[name])
        if value is not None:
            found[j] = value
        elif counted[j]:
            missing.append(name)
    if missing:
        how = "give it in the file, or name the joints that count"
        raise InputError(Fault(("share_of",), f"needs the effort of {', '.join(missing)}: {how}"))
    return found


def _effort(joint: Joint) -> float | None:
    return None if joint.effort is None else 1 / joint.effort

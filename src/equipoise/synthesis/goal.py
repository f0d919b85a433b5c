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
    if count.share_of is None and not count.heat:
        return None
    of, needs = (_root_heat, "torque_constant and resistance") if count.heat else (_share, "effort")
    joints = {coordinate: joint for joint in tree.mechanism.joints for coordinate in joint.coordinates}
    found, missing = np.zeros(tree.n), []
    for j, name in enumerate(tree.coordinates):
        value = of(joints[name])
        if value is not None:
            found[j] = value
        elif counted[j]:
            missing.append(name)
    if missing:
        how = "give it in the file, or name the joints that count"
        what = "heat" if count.heat else "share_of"
        raise InputError(Fault((what,), f"needs the {needs} of {', '.join(missing)}: {how}"))
    return found


def _share(joint: Joint) -> float | None:
    return None if joint.effort is None else 1 / joint.effort


def _root_heat(joint: Joint) -> float | None:
    """The root of the heat [W^0.5] of 1 N m: its square adds up over joints and poses as torques do."""
    if joint.torque_constant is None or joint.resistance is None:
        return None
    return float(np.sqrt(joint.resistance)) / joint.torque_constant


def held(count: Count, tree: Tree) -> Array:
    """(n,) [N m or N] what dry friction holds at each coordinate at rest, where that counts.

    Raises:
        InputError: a coupled joint has friction: then several coordinates share it.
    """
    found = np.zeros(tree.n)
    if count.friction:
        rows = {tree.motions[row]: j for j, row in enumerate(tree.coordinate_rows.tolist())}
        for joint in tree.mechanism.joints:
            for name in joint.coordinates if joint.friction else ():
                if name not in rows:
                    problem = f"does not go with the friction of '{name}', which follows other joints"
                    raise InputError(Fault(("friction",), problem))
                found[rows[name]] = joint.friction
    return found

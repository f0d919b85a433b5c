"""How springs are used over the poses: lengths and forces, where they are slack or pass a limit, friction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..kinematics import Tree
from ..model.arrays import Array
from ..model.elements import Element
from ..model.elements.laws import State
from ..model.mechanism import Mechanism

Range = tuple[float, float]
MARGINS = 4096  # poses at most over which friction and pulleys are judged


@dataclass(frozen=True)
class Reached:
    """That a spring is slack, over-stretched, solid or past its stroke somewhere.

    Attributes:
        state: which; `state.limit` says that it must not be.
        share: of the random poses.
        path: how far beyond it gets [m or rad].
        configuration: (n,) the pose where it does [rad or m].
    """

    state: State
    share: float
    path: float
    configuration: tuple[float, ...]

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        state = {"state": self.state.name, "beyond": self.state.beyond, "limit": self.state.limit}
        return {**state, "path": self.path, "share": self.share, "configuration": list(self.configuration)}


@dataclass(frozen=True)
class SpringUse:
    """Least and largest path and force of a spring over the poses: lengths [m] and [N], or angles [rad] and [N m].

    Attributes:
        reached: where it is slack, or passes a limit.
        margin: (n,) torque of its friction at most, either way [N m or N].
    """

    path: Range
    force: Range
    reached: tuple[Reached, ...] = ()
    margin: tuple[float, ...] = ()

    @property
    def min_length(self) -> float:
        """The shortest it gets [m]."""
        return self.path[0]

    @property
    def max_length(self) -> float:
        """The longest it gets [m]."""
        return self.path[1]

    @property
    def max_force(self) -> float:
        """The largest force magnitude [N]."""
        return max(map(abs, self.force))

    def to_dict(self, spring: Element) -> dict[str, Any]:
        """The spring's entry in ``check --json``; `states` where it can be in any, `friction` where it has some, and
        `made` where what it is made of is known too."""
        entry = spring.to_dict(self.path, self.force)
        if spring.law.states or spring.wheels:
            entry["states"] = [one.to_dict() for one in self.reached]
        if self.margin:
            entry["friction"] = list(self.margin)
        if (made := spring.law.comparison(*self.path)) is not None:
            entry["made"] = made.to_dict()
        return entry


def uses(mechanism: Mechanism, q: Array, path: Array, most: Array, at: Array) -> tuple[SpringUse, ...]:
    """Of each spring.

    Args:
        q: (N, n) poses; path: (N, springs) of each there [m or rad].
        most: (2 springs,) the largest path of each, then minus the smallest, over all poses; at: (2 springs, n) where.
    """
    count = len(mechanism.springs)
    longest, shortest = most[:count], -most[count:]
    return tuple(
        _use(spring, (float(shortest[i]), float(longest[i])), path[:, i], (at[count + i], at[i]), *judged)
        for i, (spring, judged) in enumerate(zip(mechanism.springs, _judged(mechanism, q), strict=True))
    )


def _use(
    spring: Element, path: Range, paths: Array, at: tuple[Array, Array], margin: Array, routed: list[Reached]
) -> SpringUse:
    """From the range of its path, the paths of the samples, and the poses where it is shortest and longest."""
    reached = []
    for state in spring.law.states:
        most, pose = path[state.above], at[state.above]
        if state.holds(np.array(most)):
            reached.append(Reached(state, float(state.holds(paths).mean()), most, tuple(pose.tolist())))
    return SpringUse(path, spring.law.extremes(*path), (*reached, *routed), tuple(margin.tolist()))


def _judged(mechanism: Mechanism, q: Array) -> list[tuple[Array, list[Reached]]]:
    """For each spring the largest torque of its friction over the poses, (n,) [N m or N], (0,) where it has none; and
    what is to be said of its pulleys."""
    tree, q = Tree.of(mechanism), q[:MARGINS]
    poses = tree.poses(q) if any(spring.law.margin or spring.wheels for spring in mechanism.springs) else None
    found = []
    for spring in mechanism.springs:
        margin, routed = np.zeros(0), list[Reached]()
        if poses is not None and spring.law.margin:
            arms = np.abs(spring.lever_arms(tree, poses, tree.velocities(q, poses)))
            margin = spring.law.margin * arms.max(axis=0)
        for state, values in spring.routing(tree, poses) if poses is not None else ():
            if (holds := state.holds(values)).any():
                i = int(values.argmax() if state.above else values.argmin())
                routed.append(Reached(state, float(holds.mean()), float(values[i]), tuple(q[i].tolist())))
        found.append((margin, routed))
    return found

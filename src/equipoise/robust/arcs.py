"""Adjustment without energy: a pose in which the ends may slide along arcs while no spring changes its length.

With the joints locked, the other end of a spring is a fixed point of the body that the sliding end is on: along a
circle about it the spring keeps its length, and its stored energy. So an end can be brought from one place to another
for nothing in every pose in which the spring is as long with either: for the basic gravity equilibrator, a link with
``m g l = k a b``, at the angle where the sine is (b + b') / 2 a (van Dorsser, Barents, Wisse and Herder 2007, a
gravity-balanced arm support with energy-free adjustment). A straight slider cannot do that: along it the force of a
spring changes by its stiffness for each metre, in every pose.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..kinematics import Tree
from ..kinematics.sampling import bounds
from ..model.arrays import Array, frozen
from ..model.elements import Spring, lines
from ..model.mechanism import Mechanism
from .moves import Move

STARTS = 8
SAME = 1e-9  # of the length squared: as long as before


@frozen
class Arc:
    """Where an end slides: about `centre` (3,) [m], in the frame of `body`, at `radius` [m]."""

    spring: str
    what: str
    body: str
    centre: Array
    radius: float


@frozen
class Locked:
    """A pose (n,) in which the moves take no energy, and the arcs along which they do not."""

    configuration: Array
    arcs: tuple[Arc, ...]

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        arcs = [
            {"spring": a.spring, "what": a.what, "body": a.body, "centre": a.centre.tolist(), "radius": a.radius}
            for a in self.arcs
        ]
        return {"configuration": self.configuration.tolist(), "arcs": arcs}


def locked(mechanism: Mechanism, moves: Sequence[Move], q: Array) -> Locked | None:
    """A pose near the samples q (N, n); None where there is none, where a free length moves, or with loops."""
    tree = Tree.of(mechanism)
    springs = {spring.name: spring for spring in lines(mechanism, "adjust")}
    if mechanism.loops or any(move.what == "free_length" for move in moves):
        return None
    own = [(springs[move.spring], move) for move in moves]
    scale = np.array([float(m.low @ m.low + m.high @ m.high) or 1.0 for _, m in own])

    def change(at: Array) -> Array:
        """(N, moves) of the squared lengths."""
        poses = tree.poses(at)
        each = []
        for spring, move in own:
            here, there, other = _sides(spring, move.what)
            fixed = poses.point(tree.index[there], np.array(other))
            low, high = (poses.point(tree.index[here], p) - fixed for p in (move.low, move.high))
            each.append((high**2).sum(axis=1) - (low**2).sum(axis=1))
        return np.stack(each, axis=1) / scale

    from scipy.optimize import least_squares

    lower, upper = bounds(tree)
    wide = upper > lower
    for start in q[np.argsort(np.abs(change(q)).max(axis=1), kind="stable")[:STARTS]]:

        def off(u: Array, start: Array = start) -> Array:
            at = start.copy()
            at[wide] = u
            return change(at[None])[0]

        found = least_squares(off, np.clip(start[wide], lower[wide], upper[wide]), bounds=(lower[wide], upper[wide]),
                              xtol=1e-15, ftol=1e-15, gtol=1e-15)  # fmt: skip
        if np.abs(found.fun).max(initial=0.0) < SAME:
            pose = start.copy()
            pose[wide] = found.x
            return Locked(pose, tuple(_arc(tree, spring, move, pose) for spring, move in own))
    return None


def _sides(spring: Spring, what: str) -> tuple[str, str, tuple[float, float, float]]:
    """The body that the end slides on, and the body and the place of the other end."""
    return (spring.body_a, spring.body_b, spring.p_b) if what == "p_a" else (spring.body_b, spring.body_a, spring.p_a)


def _arc(tree: Tree, spring: Spring, move: Move, pose: Array) -> Arc:
    here, there, other = _sides(spring, move.what)
    poses, body = tree.poses(pose[None]), tree.index[here]
    centre = poses.R[0, body].T @ (poses.point(tree.index[there], np.array(other))[0] - poses.p[0, body])
    return Arc(spring.name, move.what, here, centre, float(np.linalg.norm(move.low - centre)))

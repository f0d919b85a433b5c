"""The poses that count in a problem, where they are no averages over the joint ranges: with what moves through them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..energy.evaluate import Potential
from ..energy.inertial import motion_torque
from ..kinematics import Tree, sample
from ..kinematics.moving import Moving
from ..kinematics.sampling import inside
from ..kinematics.trajectory import course
from ..model.arrays import Array, frozen
from ..model.errors import Fault, InputError
from ..model.mechanism import Mechanism
from ..model.motion import Box, Listed, Where

ROUNDS = 200  # of random poses, in search of those in a box
EDGE = 1e-6  # [rad or m] by which a motion may pass the end of a range: rounding of tables


@frozen
class States:
    """Configurations `q` (N, n), what each counts `share` (N,), together 1, and how they are passed.

    `rate` and `acceleration` (N, n) are None where it stands still.
    """

    q: Array
    share: Array
    rate: Array | None = None
    acceleration: Array | None = None

    def __len__(self) -> int:
        return len(self.q)

    @staticmethod
    def still(q: Array) -> States:
        """Poses that all count the same."""
        return States(q, np.full(len(q), 1 / max(1, len(q))))

    def chunks(self, size: int) -> Iterator[States]:
        """Parts of at most so many, with their shares of the whole."""
        for start in range(0, len(self.q), size):
            part = slice(start, start + size)
            moves = (None if x is None else x[part] for x in (self.rate, self.acceleration))
            yield States(self.q[part], self.share[part], *moves)

    def moving(self, tree: Tree) -> Moving | None:
        """The bodies' motion there; None where it stands still."""
        if self.rate is None or self.acceleration is None:
            return None
        return Moving.of(tree, self.q, self.rate, self.acceleration)


def load_torque(mechanism: Mechanism, states: States, moving: Moving | None) -> Array:
    """(N, n) [N m or N] what holds gravity and the present springs, and in a motion moves all masses."""
    still = Potential(mechanism)(states.q).torque
    return still if moving is None else still + motion_torque(mechanism, moving)


def chosen(where: Where, tree: Tree, count: int, seed: int) -> States | None:
    """The poses that a goal gives; None where it gives none, and the joint ranges count.

    Raises:
        InputError: a motion or a pose leaves the joint ranges, or (almost) no pose of the ranges is in the box.
    """
    if where.motions:
        return _passed(where, tree)
    if where.listed is not None:
        return _listed(where.listed, tree)
    return None if where.box is None else States.still(_in_box(where.box, tree, count, seed))


def _passed(where: Where, tree: Tree) -> States:
    every = [course(motion, tree) for motion in where.motions]
    total = sum(motion.share for motion in where.motions)
    shares = [motion.share / total * one.share for motion, one in zip(where.motions, every, strict=True)]
    q = np.concatenate([one.q for one in every])
    _within(tree, q, "motion")
    rate, acceleration = (np.concatenate([getattr(one, name) for one in every]) for name in ("rate", "acceleration"))
    return States(q, np.concatenate(shares), rate, acceleration)


def _listed(listed: Listed, tree: Tree) -> States:
    q = np.tile(tree.rest, (len(listed.values), 1))
    q[:, [tree.coordinates.index(name) for name in listed.coordinates]] = listed.values
    _within(tree, q, "list")
    shares = np.array(listed.shares)
    return States(q, shares / shares.sum())


def _within(tree: Tree, q: Array, what: str) -> None:
    out = ~inside(tree, q, EDGE)
    if not out.any():
        return
    s = tree.values(q[out][:1])[0]
    over = np.maximum(tree.lower - s, s - tree.upper)
    name = tree.motions[int(np.argmax(over))]
    raise InputError(Fault(("goal", "poses", what), f"leaves the range of joint '{name}'"))


def _in_box(box: Box, tree: Tree, count: int, seed: int) -> Array:
    body, p = tree.index[box.body], np.array(box.at)
    found: list[Array] = []
    have = 0
    for turn in range(ROUNDS):
        q = sample(tree, count, [seed, turn])
        at = tree.poses(q).point(body, p)
        q = q[((at >= box.low) & (at <= box.high)).all(axis=1)]
        found.append(q)
        have += len(q)
        if have >= count:
            return np.concatenate(found)[:count]
    problem = f"of {ROUNDS * count:,} random poses inside the joint ranges {have:,} have the point in the box"
    raise InputError(
        Fault(("goal", "poses", "box"), f"{problem}, too few to judge by: enlarge it, or ask for fewer samples")
    )

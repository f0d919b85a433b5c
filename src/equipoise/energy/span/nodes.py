"""A tree as nodes: one for each single rotation, with points as sums of vectors fixed in nodes.

A point is ``p = sum_X R_X (v_X0 + sum_j q_j v_Xj)`` with constant vectors; what slides brings the q_j. No series are
multiplied out, so that everything here is as long as the tree.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ...kinematics.linkage import Linkage
from ...kinematics.sampling import bounds
from ...kinematics.tree import Link, Tree
from ...model.arrays import Array, Complexes, Integers, frozen
from ...model.errors import NoFourierForm
from ...model.rotation import about, harmonics
from ..fourier.frames import denominators


@frozen
class Node:
    """A rotation of node `base`: ``R = R_base (A0 + A1 e^is + conj(A1) e^-is)``, s the value of motion `row`.

    `axis` is in the frame of `base`. `frequency` (n,) is that of e^is, in whole multiples of what the coordinates have
    in common, and zero where some coordinate turns this node only: then s itself may be the variable instead of it.
    """

    base: int
    row: int
    axis: Array
    A0: Array
    A1: Complexes
    frequency: Integers


class Nodes:
    """The nodes of a tree, the world first and every one before those that hang on it, branch by branch.

    Attributes:
        nodes: of all but the world: `nodes[X - 1]` is node X.
        slides: the coordinates j that have a power in some point.
        reach: (1 + slides,) the size of 1 and of each of them [m or rad].

    Raises:
        NoFourierForm: loops or ratios exclude it.
    """

    def __init__(self, tree: Tree) -> None:
        if isinstance(tree, Linkage):
            raise NoFourierForm("it has loops: its energy is no finite sum over the independent coordinates")
        self.tree = tree
        turned = np.count_nonzero(tree.C[tree.rotates], axis=0)
        alone = np.count_nonzero(tree.C[:, turned == 1], axis=1) > 0
        keys = np.rint(tree.C * denominators(tree)).astype(int)
        self._frequency = np.where(alone[:, None], 0, keys)
        self._free = np.abs(tree.C).max(axis=1, initial=0.0) == 0
        self.nodes: list[Node] = []
        self._of = {0: (0, np.eye(3))}
        carried: dict[int, list[Link]] = {}
        for link in tree.links:
            carried.setdefault(link.base, []).append(link)
        waiting = [*carried.get(0, ())]
        while waiting:  # depth first: a branch is one stretch of numbers
            link = waiting.pop()
            self._of[link.body] = self._turned(link)
            waiting += carried.get(link.body, ())
        sprung = [tree.rows[joint] for element in tree.mechanism.springs for joint in element.turns]
        self.slides = np.flatnonzero((tree.C[~tree.rotates] != 0).any(axis=0) | (tree.C[sprung] != 0).any(axis=0))
        self.reach = np.append(1.0, reach(tree)[self.slides])

    def __len__(self) -> int:
        return 1 + len(self.nodes)

    def _turned(self, link: Link) -> tuple[int, Array]:
        """The node that carries a body's orientation, and that orientation in it."""
        node, R = self._of[link.base]
        R = R @ link.R0
        for motion in link.motions:
            if motion.rotates:
                s0 = self.tree.s0[motion.row]
                if self._free[motion.row]:
                    R = R @ about(motion.axis, s0)
                    continue
                A0, A1 = harmonics(motion.axis)
                self.nodes.append(
                    Node(
                        node, motion.row, R @ motion.axis, R @ A0, R @ A1 * np.exp(1j * s0), self._frequency[motion.row]
                    )
                )
                node, R = len(self.nodes), np.eye(3)
        return node, R

    def zero(self) -> Array:
        """(nodes, 1 + slides, 3) of the world's origin."""
        return np.zeros((len(self), 1 + len(self.slides), 3))

    def value(self, terms: Iterable[tuple[str, float]]) -> Array:
        """(1 + slides,) ``sum ratio s`` of joints (name, ratio): its constant, and its slope by each of `slides`."""
        rows = [(self.tree.rows[name], ratio) for name, ratio in terms]
        slopes = sum((ratio * self.tree.C[row, self.slides] for row, ratio in rows), np.zeros(len(self.slides)))
        return np.append(sum(ratio * self.tree.s0[row] for row, ratio in rows), slopes)

    def point(self, body: int, p: Array, top: int = 0) -> Array:
        """(nodes, 1 + slides, 3) the point `p` of a body, seen from the origin of a body `top` that carries it."""
        found = self.zero()
        node, R = self._of[body]
        found[node, 0] += R @ p
        while body != top:
            link = self.tree.link_of[body]
            node, R = self._of[link.parent]
            found[node, 0] += R @ link.p0
            if link.slide:
                along = self.value([(self.tree.motions[link.slide.row], 1.0)])
                found[node] += along[:, None] * (R @ link.R0 @ link.slide.axis)
            body = link.parent
        return found

    def between(self, body_a: int, p_a: Array, body_b: int, p_b: Array) -> Array:
        """(nodes, 1 + slides, 3) from a point of one body to one of another; what carries both is not in it."""
        above = [body_a]
        while above[-1]:
            above.append(self.tree.link_of[above[-1]].parent)
        top = body_b
        while top not in above:
            top = self.tree.link_of[top].parent
        return self.point(body_b, p_b, top) - self.point(body_a, p_a, top)


def reach(tree: Tree) -> Array:
    """(n,) the largest size of each coordinate [m or rad] within its range; see `bounds`."""
    largest = np.abs(bounds(tree)).max(axis=0, initial=0.0)
    return np.where(largest > 0, largest, 1.0)  # a slide locked at zero still carries its load

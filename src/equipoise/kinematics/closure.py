"""The loop equations of a mechanism and their analytic Jacobian, at the coordinates of its spanning tree.

A point closure is three equations, the gap between its two points. A hinge adds two: its axes a and b stay parallel,

    2 a . e / (1 + a . b) = 0    for the two unit vectors e of body_b that are normal to b,

which is twice the tangent of half the angle between them: zero for parallel axes only, and infinite for opposite ones,
so that no solver turns a hinge round. Everything is dimensionless: lengths are shares of the mechanism's size.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..model.arrays import Array, Integers
from ..model.mechanism import Loop
from .tree import Tree


class Loops(NamedTuple):
    """A tree and its loops as arrays, for `closing`.

    Attributes:
        link: (links, 5) body, parent, base, its first motion and the one after its last; outwards.
        R0, p0: (links, 3, 3), (links, 3) [m] at zero.
        row, turns: (motions,) of s, in the links' order; and whether it turns.
        axis: (motions, 3); turning: (motions, 3, 3, 3) what is constant, times cos and times sin in its rotation.
        C, s0: s = C q + s0.
        ends, points: (loops, 2) bodies, (loops, 2, 3) [m] in them.
        hinge: (hinges,) loops; along: (hinges, 3) axes in body_a; frame: (hinges, 3, 3) rows e, e, b in body_b.
        scale: (n,) unit of each coordinate; size: [m] unit of lengths.
        independent, dependent: numbers of coordinates.
    """

    link: Integers
    R0: Array
    p0: Array
    row: Integers
    turns: Integers
    axis: Array
    turning: Array
    C: Array
    s0: Array
    ends: Integers
    points: Array
    hinge: Integers
    along: Array
    frame: Array
    scale: Array
    size: float
    independent: Integers
    dependent: Integers


class Closure:
    """The equations that close the loops of `tree.mechanism`: first the gaps of all loops, then the hinges.

    Attributes:
        tree: the spanning tree, whose n coordinates the equations are in.
        size: [m] of the mechanism: what lengths are measured in.
        scale: (n,) unit of each coordinate: 1 rad, or the size for a slide.
        count: the number of equations.
        table: all of it as arrays for `closing`, no coordinate dependent yet.
    """

    def __init__(self, tree: Tree) -> None:
        self.tree = tree
        self.loops = tree.mechanism.loops
        self.size = _size(tree)
        self.scale = np.where(tree.turns, 1.0, self.size)
        self.hinges = np.array([i for i, loop in enumerate(self.loops) if loop.axis_a is not None], int)
        self.count = 3 * len(self.loops) + 2 * len(self.hinges)
        self.table = self._table()

    def at(self, q: Array) -> tuple[Array, Array]:
        """What is left of the equations at coordinates `q` (N, n) of the tree, lengths as shares of the size.

        Returns:
            (N, count) it, and (N, count, n) its derivative by the coordinates in units of `scale`.
        """
        from . import closing

        residual, J = np.empty((len(q), self.count)), np.empty((len(q), self.count, self.tree.n))
        closing.at(self.table, np.ascontiguousarray(q, float), len(self.tree.names), residual, J)
        return residual, J

    def gaps(self, q: Array) -> Array:
        """(N, loops) how far each loop is open [m]; an angle between the axes of a hinge counts at the size."""
        residual, points = self.at(q)[0], 3 * len(self.loops)
        square = (residual[:, :points].reshape(len(q), len(self.loops), 3) ** 2).sum(axis=2)
        square[:, self.hinges] += (residual[:, points:].reshape(len(q), len(self.hinges), 2) ** 2).sum(axis=2)
        return self.size * np.sqrt(square)

    def _table(self) -> Loops:
        tree, index = self.tree, self.tree.index
        motions = [motion for link in tree.links for motion in link.motions]
        last = np.cumsum([len(link.motions) for link in tree.links]).tolist()
        ends = [(index[loop.body_a], index[loop.body_b]) for loop in self.loops]
        hinges = [self.loops[i] for i in self.hinges]
        rows = np.array([motion.row for motion in motions], int)
        return Loops(
            link=np.array([
                (link.body, link.parent, link.base, end - len(link.motions), end)
                for link, end in zip(tree.links, last, strict=True)
            ], int).reshape(-1, 5),
            R0=np.array([link.R0 for link in tree.links]).reshape(-1, 3, 3),
            p0=np.array([link.p0 for link in tree.links]).reshape(-1, 3),
            row=rows,
            turns=np.array([motion.rotates for motion in motions], int),
            axis=np.array([motion.axis for motion in motions]).reshape(-1, 3),
            turning=np.ascontiguousarray(np.stack(tree.turning, axis=1)[rows]),
            C=tree.C,
            s0=tree.s0,
            ends=np.array(ends, int).reshape(-1, 2),
            points=np.array([(loop.p_a, loop.p_b) for loop in self.loops], float).reshape(-1, 2, 3),
            hinge=self.hinges,
            along=np.array([_unit(loop.axis_a) for loop in hinges]).reshape(-1, 3),
            frame=np.array([_frame(loop) for loop in hinges]).reshape(-1, 3, 3),
            scale=self.scale,
            size=self.size,
            independent=np.arange(tree.n),
            dependent=np.arange(0),
        )  # fmt: skip


def _unit(axis: tuple[float, float, float] | None) -> Array:
    v: Array = np.array(axis, float)
    v /= np.abs(v).max()
    return v / float(np.linalg.norm(v))


def _frame(loop: Loop) -> Array:
    """(3, 3) rows: two unit vectors normal to the axis of body_b, and the axis."""
    along = _unit(loop.axis_b)
    first = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))]).astype(float)
    first /= float(np.linalg.norm(first))
    return np.stack([first, np.cross(along, first), along])


def _size(tree: Tree) -> float:
    """[m] the largest distance between joints or loop ends of a body, 1 where all are at its origin."""
    lengths = [float(np.linalg.norm(link.p0)) for link in tree.links]
    for loop in tree.mechanism.loops:
        lengths += [float(np.linalg.norm(p)) for p in (loop.p_a, loop.p_b)]
    return max(lengths, default=0.0) or 1.0

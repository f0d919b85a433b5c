"""How far the energy of a tree is from constant, in polynomial time: no Fourier form is written out.

Gravity is linear in points and a spring of zero free length half the square of a difference of two. With points as sums
over nodes (`nodes`) their energy is ``sum_YX <A_YX, R_Y' R_X>``, times powers of what slides: forms (`forms`).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ...kinematics.tree import Tree
from ...model.arrays import Array, Integers
from ...model.masses import lumped_masses
from ...model.mechanism import Mechanism
from ..exactness import ROUNDING, Distance, size
from .forms import Forms, variation
from .nodes import Nodes


class SpanEnergy:
    """What decides whether the energy of a mechanism is constant.

    Attributes:
        distance: from exact; it asks the springs, and NoFourierForm is raised where one has no such form: one with a
            free length, a cam.

    Raises:
        NoFourierForm: it has loops, a coupling ratio is not a fraction, or couplings join too many joints far from each
            other.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        tree = Tree.of(mechanism)
        self.nodes = Nodes(tree)
        self._g = np.array(mechanism.gravity)
        one = self.nodes.zero()
        points = [m * self.nodes.point(tree.index[body], p) for body, m, p in lumped_masses(mechanism) if m]
        self._moments = np.reshape(points, (-1, *one.shape)) * self.nodes.reach[:, None]

    @cached_property
    def _stretches(self) -> Array:
        """(springs, nodes, 1 + slides, 3); only asked for where springs matter, for not every kind has one."""
        stretches = [element.affine(self.nodes) for element in self.nodes.tree.mechanism.springs]
        return np.reshape(stretches, (-1, *self.nodes.zero().shape)) * self.nodes.reach[:, None]

    @property
    def exact(self) -> bool:
        """Whether the energy is constant, to rounding."""
        return self.distance.exact

    @cached_property
    def distance(self) -> Distance:
        """From exact."""
        every = [_linear(self._g, self._moments.sum(axis=0)[None]), _square(self._stretches[None])]
        return Distance(self._varies(every), self.scale)

    @cached_property
    def scale(self) -> float:
        """[J] how much there is to be balanced, see `exactness`."""
        gravity = self._varies([_linear(self._g, self._moments)])
        levers = np.linalg.norm(self._moments, axis=-1)
        levers[:, 0, 0] = 0.0
        if gravity > ROUNDING * size(levers.sum(axis=(1, 2))) * np.linalg.norm(self._g):
            return gravity
        springs = self._varies([_square(self._stretches[:, None])])
        held = size((self._stretches**2).sum(axis=(1, 2, 3)) / 2)
        return springs if springs > ROUNDING * held else 0.0

    def _varies(self, parts: list[Blocks]) -> float:
        """[J] of energies that are the sums of these parts, all of them together."""
        label, block = (np.concatenate(each) for each in zip(*parts, strict=True))
        same = label[:, 3] == label[:, 4]  # R' R = 1
        block[same, 0, 0] = np.trace(block[same], axis1=1, axis2=2)
        block[same, 0, 1:], block[same, 1:], label[same, 3:] = 0.0, 0.0, 0
        keys, found = np.zeros((1, self.nodes.tree.n), int), []
        for free in (True, False):
            own = label[:, 1:3].any(axis=1) != free
            energies, row = np.unique(label[own, :3], axis=0, return_inverse=True)
            pairs, pair = np.unique(np.vstack([[0, 0], label[own, 3:]]), axis=0, return_inverse=True)
            A = np.zeros((len(energies), len(pairs), 3, 3))
            np.add.at(A, (row.ravel(), pair.ravel()[1:]), block[own])
            found.append(Forms(pairs, keys, A[:, None], free))
        return variation(self.nodes, *found)


Blocks = tuple[Integers, Array]
"""Terms ``q_i q_j <A, R_Y' R_X>``: (energy, i, j, Y, X) of each, where the first of `slides` is 1 and 0 stands for the
constant 1, and A (3, 3)."""


def _linear(g: Array, moments: Array) -> Blocks:
    """Gravity on mass moments (energies, nodes, 1 + slides, 3)."""
    row, X, j = np.nonzero(moments.any(axis=-1))
    zero = np.zeros_like(X)
    return np.stack([row, zero, j, zero, X], axis=1), -g[:, None] * moments[row, X, j][:, None, :]


def _square(stretches: Array) -> Blocks:
    """Half the squares of stretches (energies, springs, nodes, 1 + slides, 3), summed over the springs."""
    X, j = np.nonzero(stretches.any(axis=(0, 1, 4)))
    a, b = np.triu_indices(len(X))
    D = stretches[:, :, X, j].reshape(*stretches.shape[:2], 3 * len(X))
    products = (np.swapaxes(D, 1, 2) @ D).reshape(len(D), len(X), 3, len(X), 3).transpose(0, 1, 3, 2, 4)[:, a, b]
    products *= np.where(a == b, 0.5, 1.0)[:, None, None]
    row = np.repeat(np.arange(len(D)), len(a))
    places = np.stack([np.minimum(j[a], j[b]), np.maximum(j[a], j[b]), X[a], X[b]], axis=1)
    label = np.column_stack([row, np.tile(places, (len(D), 1))])
    block = products.reshape(len(label), 3, 3)
    used = block.any(axis=(1, 2))
    return label[used], block[used]

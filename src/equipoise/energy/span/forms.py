"""Energies as bilinear forms in the nodes' rotations, and the root mean square of what they vary by.

A form is ``sum_YX <A_YX, R_Y' R_X>`` over pairs of nodes, Y before X, where ``<A, R> = sum_ij A_ij R_ij``. Node X, the
last, is ``R_X = R_B (A0 + Ac cos s + As sin s)``: written out, the form is

    F_0 + F_c sqrt(2) cos s + F_s sqrt(2) sin s,

again three forms, in one node less, and since 1, sqrt(2) cos s and sqrt(2) sin s are orthonormal, its mean square over
s is the sum of theirs. Of many forms only the sum of their mean squares counts, which an orthogonal mixture leaves
alone: so the triangular factor of their coefficients stands for all, and there are never more than a form has
coefficients. Nothing is squared before the end, so that what cancels is seen down to rounding.

Where a coordinate turns several nodes, a form has one set of coefficients for each frequency in it so far, and falls
apart into one form for each when no node with the coordinate is left.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...model.arrays import Array, Complexes, Integers, frozen
from ...model.errors import NoFourierForm
from ..exactness import size
from .nodes import Node, Nodes

NEGLIGIBLE = 1e-16  # a form so much smaller than the largest number that all began with is rounding
MAX_ENTRIES = 4_000_000  # numbers of all forms at a time: 32 MB, or 64 with couplings


@frozen
class Forms:
    """Forms that a node is to be taken from, and whether their constants count.

    Attributes:
        pairs: (P, 2) nodes Y < X; the first is (0, 0), and its entry [0, 0] is a constant.
        keys: (L, n) frequencies of coordinates that turn several nodes, zero first.
        A: (forms, L, P, 3, 3) real, or complex with keys.
        free: constants, which are the same at every configuration, are dropped.
    """

    pairs: Integers
    keys: Integers
    A: Array | Complexes
    free: bool

    @staticmethod
    def none(n: int, free: bool = False) -> Forms:
        """No forms in n coordinates."""
        return Forms(np.zeros((1, 2), int), np.zeros((1, n), int), np.zeros((0, 1, 1, 3, 3)), free)

    def joined(self, *others: Forms) -> Forms:
        """All of these forms, in as few as have the same mean square together."""
        every = [form for form in (self, *others) if len(form.A)]
        if not every:
            return self
        pairs, keys = _union([form.pairs for form in every]), _union([form.keys for form in every])
        count = sum(len(form.A) for form in every)
        _afford(count * len(pairs) * len(keys))
        A = np.zeros((count, len(keys), len(pairs), 3, 3), np.result_type(*(form.A for form in every)))
        start = 0
        for form in every:
            stop = start + len(form.A)
            A[start:stop, _places(keys, form.keys)[:, None], _places(pairs, form.pairs)] = form.A
            start = stop
        return replace(self, pairs=pairs, keys=keys, A=A).fewest()

    def fewest(self) -> Forms:
        """The same without what is zero, with no more forms than numbers in one.

        Forms that vanish but for rounding are replaced by a constant that is not less than they can be.
        """
        if not len(self.A):
            return Forms.none(self.keys.shape[1], self.free)
        if self.free:
            self.A[:, 0, 0] = 0
        used = (self.A != 0).any(axis=(0, 1, 3, 4))
        used[0] = True
        A = self.A[:, :, used]
        rows = A.reshape(len(A), -1)
        if len(rows) > 1:
            active = (rows != 0).any(axis=0)
            R: Complexes = np.asarray(np.linalg.qr(rows[:, active], mode="r"))
            sizes = np.linalg.norm(R, axis=1)
            kept = sizes > (0 if self.free else NEGLIGIBLE)
            lost = np.linalg.norm(sizes[~kept])
            rows = np.zeros((np.count_nonzero(kept) + bool(lost), rows.shape[1]), R.dtype)
            rows[: np.count_nonzero(kept), active] = R[kept]
            if lost:  # |R_Y' R_X| = sqrt(3)
                rows[-1, 0] = lost * np.sqrt(3 * A.shape[1] * A.shape[2])
        return replace(self, pairs=self.pairs[used], A=rows.reshape(len(rows), *A.shape[1:]))

    def without(self, X: int, node: Node) -> tuple[Forms, Forms]:
        """What is left of the forms when the last node X is written out, and what must vanish besides."""
        touched = self.pairs[:, 1] == X
        if not touched.any():
            return self, Forms.none(self.keys.shape[1])
        Y, moved, kept = self.pairs[touched, 0], self.A[:, :, touched], self.A[:, :, ~touched]

        ends = np.sort(np.stack([Y, np.full(len(Y), node.base)], axis=1), axis=1)
        near, back = node.base == Y, (node.base < Y)[:, None, None]
        ends[near] = 0  # R_base' R_base = 1
        pairs = _union([self.pairs[~touched], ends])
        at = _places(pairs, ends)

        def turned(T: Any) -> NDArray[Any]:
            """The forms of what R_base T stands for."""
            of_base = moved @ T.T
            A = np.zeros((*self.A.shape[:2], len(pairs), 3, 3), of_base.dtype)
            A[:, :, at] = np.where(back, np.swapaxes(of_base, -1, -2), of_base)
            A[:, :, 0, 0, 0] = np.trace(of_base[:, :, near], axis1=-2, axis2=-1).sum(axis=-1)
            return A

        rest = turned(node.A0)
        rest[:, :, _places(pairs, self.pairs[~touched])] += kept
        left = replace(self, pairs=pairs, A=rest)
        if node.frequency.any():
            ahead = turned(node.A1)
            keys = _union([self.keys, self.keys + node.frequency, self.keys - node.frequency])
            _afford(len(self.A) * len(keys) * len(pairs))
            A = np.zeros((len(self.A), len(keys), len(pairs), 3, 3), complex)
            for change, part in ((0, rest), (1, ahead), (-1, turned(node.A1.conj()))):
                A[:, _places(keys, self.keys + change * node.frequency)] += part
            return replace(left, keys=keys, A=A), Forms.none(self.keys.shape[1])
        root = np.sqrt(2.0)
        harmonics = np.concatenate([turned(root * node.A1.real), turned(-root * node.A1.imag)])
        return left, replace(left, A=harmonics, free=False)

    def parted(self, done: Integers) -> tuple[Forms, Forms]:
        """With no node left that the coordinates `done` turn: what they leave alone, and what must vanish besides."""
        none, own, rest = Forms.none(self.keys.shape[1]), self.keys[:, done], self.keys.copy()
        rest[:, done] = 0
        keys, stay, gone = _union([rest]), none, []
        for frequency in np.unique(own, axis=0):
            chosen = (own == frequency).all(axis=1)
            A = np.zeros((len(self.A), len(keys), *self.A.shape[2:]), self.A.dtype)
            A[:, _places(keys, rest[chosen])] = self.A[:, chosen]
            part = replace(self, keys=keys, A=A, free=self.free and not frequency.any())
            if part.free:
                stay = part
            else:
                gone.append(part)
        return stay, none.joined(*gone)

    @property
    def constants(self) -> Array | Complexes:
        """What counts of their constants, once no node is left."""
        constant = self.A[:, :, 0, 0, 0]
        return constant[:, self.keys.any(axis=1)] if self.free else constant


def variation(nodes: Nodes, free: Forms, zero: Forms) -> float:
    """The root of the summed mean squares: of `free` about their means, and of `zero` about zero.

    Over all angles; the forms' own factors stand for the powers of what slides.

    Raises:
        NoFourierForm: too many coordinates turn several nodes far from each other.
    """
    unit = max((float(np.abs(form.A).max(initial=0)) for form in (free, zero)), default=0.0)
    if not 0 < unit < np.inf:
        return unit
    free, zero = (replace(form, A=form.A / unit).fewest() for form in (free, zero))
    for X in range(len(nodes) - 1, 0, -1):
        node = nodes.nodes[X - 1]
        free, more = free.without(X, node)
        zero, harmonics = zero.without(X, node)
        zero = zero.joined(more, harmonics)
        if node.frequency.any():
            ahead = sum((np.abs(other.frequency) for other in nodes.nodes[: X - 1]), np.zeros_like(node.frequency))
            done = np.flatnonzero((node.frequency != 0) & (ahead == 0))
            free, more = free.parted(done)
            zero = zero.parted(done)[1].joined(more)
    left = np.concatenate([form.constants.ravel() for form in (free, zero)])
    return unit * size(left)


def _union(rows: list[Integers]) -> Integers:
    """Each row once, zero first."""
    every = {tuple(row) for one in rows for row in one.tolist()}
    zero = (0,) * rows[0].shape[1]
    return np.array([zero, *sorted(every - {zero})], int)


def _places(every: Integers, rows: Integers) -> Integers:
    """Where each of `rows` is in `every`."""
    number = {tuple(row): i for i, row in enumerate(every.tolist())}
    return np.array([number[tuple(row)] for row in rows.tolist()], int)


def _afford(entries: int) -> None:
    if 9 * entries > MAX_ENTRIES:
        raise NoFourierForm("its couplings join too many joints far from each other for a proof")

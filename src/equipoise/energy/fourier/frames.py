"""Relative rotations and stretches of a tree as finite Fourier series.

Every rotation is ``A0 + A1 exp(iq) + conj(A1) exp(-iq)``. A stretch is written as a sum over bodies,
``d = sum_X R_WX v_X``, so that ``|d|^2 = sum_XY v_X' R_XY v_Y`` needs only relative rotations R_XY: along a path of m
joints it has 3^m terms, and joints outside the path never appear.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from math import lcm

import numpy as np

from ...kinematics.linkage import Linkage
from ...kinematics.tree import Link, Tree
from ...model.arrays import Array, Integers
from ...model.errors import NoFourierForm
from ...model.rotation import harmonics
from .series import Series

MAX_TERMS = 200_000
MAX_KEYS = 16_000_000  # frequencies and degrees of all terms: 64 MB
MAX_FREQUENCY = 2**31 - 1  # a sum of frequencies has to fit the keys of a `Series`
ALIKE = 1e-12  # how near orientations are that count as one
MAX_DENOMINATOR = 1000  # a coupling ratio is taken as a fraction of at most this denominator


class Frames:
    """Relative rotations and stretches of a tree as series. Integer frequencies: unit 1/`denominators` per radian.

    Raises:
        NoFourierForm: loops, ratios or the number of terms exclude it.
    """

    def __init__(self, tree: Tree, max_terms: int = MAX_TERMS) -> None:
        if isinstance(tree, Linkage):
            raise NoFourierForm("it has loops: its energy is no finite sum over the independent coordinates")
        self.tree = tree
        self.max_terms = min(max_terms, MAX_KEYS // max(1, 2 * tree.n))
        self.denominators = denominators(tree)
        self._chains: dict[tuple[int, int], Series] = {}
        self._paths: dict[int, list[int]] = {}
        self._like = self._orientations()

    def stretch(self, body_a: int, body_b: int) -> dict[int, Series]:
        """Z as ``{X: V_X}``, V_X 3 x 7: the stretch is ``sum_X R_WX V_X z``, z = [p_a; 1; p_b].

        See docs/theory.md, section 1.
        """
        to_a = np.hstack([np.eye(3), np.zeros((3, 4))])
        to_b = np.hstack([np.zeros((3, 4)), np.eye(3)])
        unit = np.eye(7)[None, 3]
        parts: dict[int, list[Series]] = {}
        for sign, body, point in ((-1, body_a, to_a), (1, body_b, to_b)):
            parts.setdefault(self._like[body], []).append(self.constant(sign * point))
            for X, step in self._origin(body):
                parts.setdefault(X, []).append((step @ self.constant(unit)).scaled(sign))
        return _nonzero(parts)

    def moment(self, masses: list[tuple[int, float, Array]]) -> dict[int, Series]:
        """``sum m p`` of the masses (body, m [kg], p [m]) as ``{X: v_X}`` with ``sum_X R_WX v_X``, v 3 x 1 [kg m]."""
        parts: dict[int, list[Series]] = {}
        for body, mass, p in masses:
            parts.setdefault(self._like[body], []).append(self.constant(mass * p[:, None]))
            for X, step in self._origin(body):
                parts.setdefault(X, []).append(step.scaled(mass))
        return _nonzero(parts)

    def linear(self, row: Array, V: dict[int, Series], body: int = 0) -> Series:
        """``row . sum_X R_BX V_X`` with `row` (3,) in the frame of a body, or the world; coefficients (T, 1, m)."""
        left = self.constant(np.asarray(row)[None])
        return self._sum([left @ self.relative(body, X) @ v for X, v in V.items()], V)

    def quadratic(self, V: dict[int, Series]) -> Series:
        """``|sum_X R_WX V_X|^2``: coefficients (T, m, m), symmetric."""
        parts = []
        for X, v in V.items():
            parts.append(v.T @ v)
            for Y, u in V.items():
                if X < Y:
                    cross = v.T @ self.relative(X, Y) @ u
                    parts += [cross, cross.T]
        return self._sum(parts, V)

    def value(self, terms: Iterable[tuple[str, float]]) -> Series:
        """``sum ratio s`` of joints (name, ratio), ``s = C q + s0``: degree one in each coordinate; (T, 1, 1)."""
        n, (rows, ratios) = self.tree.n, zip(*((self.tree.rows[name], ratio) for name, ratio in terms), strict=True)
        slopes = np.array(ratios) @ self.tree.C[list(rows)]
        active = np.flatnonzero(slopes)
        keys = np.zeros((1 + len(active), 2 * n), np.int32)
        keys[np.arange(1, 1 + len(active)), n + active] = 1
        values = np.concatenate([[np.array(ratios) @ self.tree.s0[list(rows)]], slopes[active]])
        return Series(keys, values[:, None, None].astype(complex))

    def harmonics(self, terms: Iterable[tuple[str, float]], amplitudes: Iterable[tuple[int, float, float]]) -> Series:
        """``sum a cos(n s) + b sin(n s)`` over (n, a, b), of ``s = sum ratio value`` of joints; (T, 1, 1).

        Raises:
            NoFourierForm: a frequency is no whole multiple of those of the tree.
        """
        n, (rows, ratios) = self.tree.n, zip(*((self.tree.rows[name], ratio) for name, ratio in terms), strict=True)
        turn = np.array(ratios) @ self.tree.C[list(rows)] * self.denominators
        whole = np.rint(turn)
        if np.abs(turn - whole).max(initial=0) > 1e-12 * (1 + np.abs(turn).max(initial=0)):
            raise NoFourierForm("a cam's joints have ratios that its Fourier form cannot hold")
        phase, parts = float(np.array(ratios) @ self.tree.s0[list(rows)]), []
        for times, a, b in amplitudes:
            keys = np.zeros((2, 2 * n), np.int32)
            keys[0, :n] = times * whole
            keys[1] = -keys[0]
            half = 0.5 * (a - 1j * b) * np.exp(1j * times * phase)
            parts.append(Series(keys, np.array([half, half.conjugate()])[:, None, None]))
        return Series.sum(parts)

    def _sum(self, parts: list[Series], V: dict[int, Series]) -> Series:
        if not parts:
            return self.constant(np.zeros((1, 1)))
        if sum(len(part) for part in parts) > 8 * self.max_terms:
            raise NoFourierForm(f"its Fourier form has more than {self.max_terms:,} terms")
        total = Series.sum(parts)
        self._guard(len(total))
        return total

    def _guard(self, terms: int) -> None:
        if terms > self.max_terms:
            raise NoFourierForm(f"its Fourier form has more than {self.max_terms:,} terms")

    def constant(self, value: Array) -> Series:
        """A series of one constant term."""
        return Series.constant(value, self.tree.n)

    def _origin(self, body: int) -> Iterator[tuple[int, Series]]:
        """The steps (X, step in X's frame, 3 x 1) whose sum over X is the body's origin."""
        while body:
            link = self.tree.link_of[body]
            step = self.constant(link.p0[:, None])
            if link.slide:
                step = Series.sum([step, self._slide(link)])
            yield self._like[link.parent], step
            body = link.parent

    def _slide(self, link: Link) -> Series:
        """``R0 axis s`` with the joint's value s."""
        motion = link.motions[0]
        return self.constant((link.R0 @ motion.axis)[:, None]) @ self.value(((self.tree.motions[motion.row], 1.0),))

    def _turn(self, link: Link) -> Series:
        """The body's orientation in its base: ``R0`` times three terms for each rotation."""
        turn = self.constant(link.R0)
        for motion in link.motions:
            if not motion.rotates:
                continue
            A0, A1 = harmonics(motion.axis)
            phase = np.exp(1j * self.tree.s0[motion.row])
            keys = np.zeros((3, 2 * self.tree.n), np.int32)
            keys[1, : self.tree.n] = np.rint(self.tree.C[motion.row] * self.denominators)
            keys[2] = -keys[1]
            turn = turn @ Series(keys, np.stack([A0.astype(complex), A1 * phase, (A1 * phase).conj()]))
        return turn

    def _chain(self, top: int, body: int) -> Series:
        """R_top,body, with `top` above `body` along the bases."""
        if top == body:
            return self.constant(np.eye(3))
        if (top, body) not in self._chains:
            link = self.tree.link_of[body]
            above, turn = self._chain(top, link.base), self._turn(link)
            self._guard(len(above) * len(turn) // 3)  # equal terms are collected below: allow for some
            product = (above @ turn).collected()
            self._guard(len(product))
            self._chains[top, body] = product
        return self._chains[top, body]

    def relative(self, X: int, Y: int) -> Series:
        """R_XY."""
        X, Y = self._like[X], self._like[Y]
        above_x, above_y = self._bases(X), self._bases(Y)
        top = next(body for body in above_x if body in above_y)
        left, right = self._chain(top, X), self._chain(top, Y)
        if top == X:
            return right
        self._guard(len(left) * len(right) // 3)
        product = (left.T @ right).collected() if len(left) > 1 else left.T @ right
        self._guard(len(product))
        return product

    def _orientations(self) -> list[int]:
        """For each body the first that always has its orientation, as an auxiliary link has its link's.

        An orientation is that at zero, turned about its joints' axes at zero, one after the other.
        """
        tree, count, first = self.tree, len(self.tree.names), [0]
        like, home, turns = list(range(count)), [np.eye(3)] * count, [np.zeros((0, 4 + tree.n))] * count
        for link in tree.links:
            body = link.body
            home[body] = home[link.base] @ link.R0
            own = [
                [*(home[body] @ motion.axis), *tree.C[motion.row], tree.s0[motion.row]]
                for motion in link.motions
                if motion.rotates
            ]
            turns[body] = np.vstack([turns[link.base], np.reshape(own, (-1, 4 + tree.n))])
            for other in first:
                if len(turns[other]) != len(turns[body]):
                    continue
                if (
                    max(np.abs(home[other] - home[body]).max(), np.abs(turns[other] - turns[body]).max(initial=0))
                    < ALIKE
                ):
                    like[body] = other
                    break
            else:
                first.append(body)
        return like

    def _bases(self, body: int) -> list[int]:
        """The body and those that its orientation hangs on, down to the world."""
        if body not in self._paths:
            self._paths[body] = [body, *(self._bases(self.tree.link_of[body].base) if body else ())]
        return self._paths[body]


def _nonzero(parts: dict[int, list[Series]]) -> dict[int, Series]:
    """Collect each body's terms and drop what cancels: the steps that both ends of a spring share."""
    summed = {X: Series.sum(series) for X, series in parts.items()}
    return {X: series for X, series in summed.items() if np.abs(series.coef).max() > 0}


def denominators(tree: Tree) -> Integers:
    """(n,) the least whole numbers that make every rotation's ratio to each coordinate whole.

    Raises:
        NoFourierForm: there are none of a reasonable size.
    """
    return np.array([_denominator(column[column != 0]) for column in tree.C[tree.rotates].T], int)


def _denominator(ratios: Array) -> int:
    """The common denominator of a coordinate's ratios in all rotations."""
    fractions = [_fraction(ratio) for ratio in ratios]
    common = lcm(1, *(fraction.denominator for fraction in fractions))
    if sum(abs(fraction) for fraction in fractions) * common > MAX_FREQUENCY:
        raise NoFourierForm("its coupling ratios have no common denominator of a reasonable size")
    return common


def _fraction(ratio: float) -> Fraction:
    if not np.isfinite(ratio):
        raise NoFourierForm("the product of its coupling ratios overflows")
    fraction = Fraction(float(ratio)).limit_denominator(MAX_DENOMINATOR)
    if abs(float(fraction) - ratio) > 1e-15 * max(1.0, abs(ratio)):
        raise NoFourierForm(f"a coupling ratio ({ratio:g}) is not a fraction with a denominator below 1000")
    return fraction

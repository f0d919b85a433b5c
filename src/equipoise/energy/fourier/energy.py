"""The energy as a finite Fourier series: the balance certificate (THEORY section 2).

Gravity and zero-free-length springs give

    U(q) = sum_k c_k exp(i k.q)        (times powers of q_j where joint j slides)

with finitely many terms. Exponentials and powers are linearly independent on any open set, so U is constant, and the
mechanism balanced at **all** configurations, if and only if every coefficient but the constant one is zero.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from ...kinematics.sampling import bounds
from ...kinematics.tree import Tree
from ...model.arrays import Array, Booleans, Complexes, Integers
from ...model.masses import lumped_masses
from ...model.mechanism import Mechanism
from .frames import MAX_TERMS, Frames
from .series import Series

EXACT = 1e-10  # relative: what counts as zero
ROUNDING = 1e-13  # relative: what may be nothing but rounding


class FourierEnergy:
    """The energy of a mechanism as ``U(q) = Re sum_t c_t q^degree_t exp(i frequency_t . q)``.

    Attributes:
        frequency: (T, n) real; zero in the constant term, and so is
        degree: (T, n) whole numbers, of coordinates that slide or that a spring on a joint acts on.
        c: (T,) complex [J, or J/m^degree].
        scale: [J] the size of what has to be balanced: what each mass alone, or where gravity does no work each spring
            alone, makes the energy vary by, summed before anything cancels; 0 where that is nothing but rounding.

    Raises:
        NoFourierForm: it has loops, a spring has a free length, a coupling ratio is not a fraction, or there are too
            many terms.
    """

    def __init__(self, mechanism: Mechanism, max_terms: int = MAX_TERMS) -> None:
        tree = Tree.of(mechanism)
        frames = Frames(tree, max_terms)
        self.tree = tree
        weights = [frames.linear(-np.array(mechanism.gravity), frames.moment([mass])) for mass in _masses(tree)]
        springs = [spring.series(frames) for spring in mechanism.springs]
        total = Series.sum([Series.constant(np.zeros((1, 1)), tree.n), *weights, *springs])
        n = tree.n
        self.frequency = total.keys[:, :n] / frames.denominators
        self.degree = total.keys[:, n:]
        self.c = total.coef[:, 0, 0]
        self.scale = self._scale(weights, springs, _moving_weight(frames, self.reach))

    @cached_property
    def reach(self) -> Array:
        """(n,) the largest value of each coordinate [m or rad], where it has a degree; see `bounds`."""
        reach = np.abs(bounds(self.tree)).max(axis=0)
        return np.where(reach > 0, reach, 1.0)  # a slide locked at zero still carries its load

    @property
    def varies(self) -> Booleans:
        """(T,) false for the constant term only."""
        return np.asarray(self.frequency.any(axis=1) | self.degree.any(axis=1))

    @cached_property
    def amplitude(self) -> Array:
        """(T,) the largest value of each term over the range [J], 0 for the constant."""
        return np.where(self.varies, np.abs(self.c) * np.prod(self.reach**self.degree, axis=1), 0.0)

    def _scale(self, weights: list[Series], springs: list[Series], moving_weight: float) -> float:
        varying, _ = self._sizes(weights)
        if varying > ROUNDING * moving_weight:
            return varying
        varying, constant = self._sizes(springs)
        return varying if varying > ROUNDING * constant else 0.0

    def _sizes(self, parts: list[Series]) -> tuple[float, float]:
        """What the parts vary by at most and their constants [J], each part on its own, before anything cancels."""
        varying = constant = 0.0
        for part in parts:
            size = np.abs(part.coef[:, 0, 0]) * np.prod(self.reach ** part.keys[:, self.tree.n :], axis=1)
            varies = part.keys.any(axis=1)
            varying += float(size[varies].sum())
            constant += float(size[~varies].sum())
        return varying, constant

    @property
    def constant(self) -> float:
        """The constant term [J]."""
        return float(self.c[~self.varies].real.sum())

    @property
    def exact(self) -> bool:
        """Whether the energy is constant: no term but the constant one above 1e-10 of `scale`, all taken together."""
        left = self.amplitude.sum()
        return bool(np.isfinite(left + self.scale) and (self.scale == 0 or left <= EXACT * self.scale))

    def torque_bound(self) -> Array:
        """(n,) ``|tau_j| <= sum_k |k_j| |c_k|`` over all configurations [N m or N] (degrees within `reach`)."""
        bound = self.amplitude @ np.abs(self.frequency)
        for j, factor, degree in self._slides():
            bound[j] += np.sum(np.abs(self.c) * factor * np.prod(self.reach**degree, axis=1))
        return bound

    def energy(self, q: Array) -> Array:
        """(N,) energy [J] at `q` (N, n)."""
        return self._terms(q, self.degree).sum(axis=1).real

    def torque(self, q: Array) -> Array:
        """(N, n) holding torque dU/dq [N m or N] at `q` (N, n)."""
        torque = (1j * self._terms(q, self.degree) @ self.frequency).real
        for j, factor, degree in self._slides():
            torque[:, j] += (self._terms(q, degree) @ factor).real
        return torque

    def _terms(self, q: Array, degree: Integers) -> Complexes:
        powers = np.prod(q[:, None] ** degree, axis=2)
        return self.c * powers * np.exp(1j * (q @ self.frequency.T))

    def _slides(self) -> Iterator[tuple[int, Integers, Integers]]:
        """For each sliding coordinate j: the factor (T,) and the degrees that d/dq_j leaves of the powers."""
        for j in np.flatnonzero(self.degree.any(axis=0)):
            degree = self.degree.copy()
            degree[:, j] = np.maximum(degree[:, j] - 1, 0)
            yield int(j), self.degree[:, j], degree


def gravity_series(frames: Frames) -> Series:
    """Gravity's energy [J] of all masses, spring masses included; coefficients (T, 1, 1)."""
    g = np.array(frames.tree.mechanism.gravity)
    return frames.linear(g, frames.moment(_masses(frames.tree))).scaled(-1)


def _masses(tree: Tree) -> list[tuple[int, float, Array]]:
    return [(tree.index[body], mass, p) for body, mass, p in lumped_masses(tree.mechanism) if mass]


def _moving_weight(frames: Frames, reach: Array) -> float:
    """[J] sum of m |g| times every lever arm that moves, in any direction: gravity's rounding is a share of it."""
    total = 0.0
    for mass in _masses(frames.tree):
        for X, v in frames.moment([mass]).items():
            size = np.abs(v.coef[:, :, 0]).sum(axis=1) * np.prod(reach ** v.keys[:, frames.tree.n :], axis=1)
            total += float(size.sum() if len(frames.relative(0, X)) > 1 else size[v.keys.any(axis=1)].sum())
    return total * float(np.linalg.norm(frames.tree.mechanism.gravity))

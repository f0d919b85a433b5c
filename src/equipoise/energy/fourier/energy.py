"""The energy as a finite Fourier series: the balance certificate (docs/theory.md, section 2).

Gravity and zero-free-length springs give

    U(q) = sum_k c_k exp(i k.q)        (times powers of q_j where joint j slides)

with finitely many terms. Exponentials and powers are linearly independent on any open set, so U is constant, and the
mechanism balanced at **all** configurations, if and only if every coefficient but the constant one is zero.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from ...kinematics.tree import Tree
from ...model.arrays import Array, Booleans, Complexes, Integers
from ...model.masses import lumped_masses
from ...model.mechanism import Mechanism
from ..exactness import Distance, size
from ..span.energy import SpanEnergy
from ..span.nodes import reach
from .frames import MAX_TERMS, Frames
from .series import Series


class FourierEnergy:
    """The energy of a mechanism as ``U(q) = Re sum_t c_t q^degree_t exp(i frequency_t . q)``.

    Attributes:
        frequency: (T, n) real; zero in the constant term, and so is
        degree: (T, n) whole numbers, of coordinates that slide or that a spring on a joint acts on.
        c: (T,) complex [J, or J/m^degree].

    Raises:
        NoFourierForm: it has loops, a spring has a free length, a coupling ratio is not a fraction, or there are too
            many terms.
    """

    def __init__(self, mechanism: Mechanism, max_terms: int = MAX_TERMS) -> None:
        tree = Tree.of(mechanism)
        frames = Frames(tree, max_terms)
        self.tree = tree
        springs = [spring.series(frames) for spring in mechanism.springs]
        total = Series.sum([Series.constant(np.zeros((1, 1)), tree.n), gravity_series(frames), *springs])
        n = tree.n
        self.frequency = total.keys[:, :n] / frames.denominators
        self.degree = total.keys[:, n:]
        self.c = total.coef[:, 0, 0]

    @cached_property
    def reach(self) -> Array:
        """(n,) the largest size of each coordinate [m or rad] within its range."""
        return reach(self.tree)

    @cached_property
    def scale(self) -> float:
        """[J] how much there is to be balanced, see `exactness`."""
        return SpanEnergy(self.tree.mechanism).scale

    @property
    def varies(self) -> Booleans:
        """(T,) false for the constant term only."""
        return np.asarray(self.frequency.any(axis=1) | self.degree.any(axis=1))

    @cached_property
    def amplitude(self) -> Array:
        """(T,) the largest value of each term over the range [J], 0 for the constant."""
        return np.where(self.varies, np.abs(self.c) * np.prod(self.reach**self.degree, axis=1), 0.0)

    @property
    def constant(self) -> float:
        """The constant term [J]."""
        return float(self.c[~self.varies].real.sum())

    @property
    def distance(self) -> Distance:
        """From exact."""
        return Distance(size(self.amplitude), self.scale)

    @property
    def exact(self) -> bool:
        """Whether the energy is constant, to rounding."""
        return self.distance.exact

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

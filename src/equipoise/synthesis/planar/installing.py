"""Springs of a given layout that balance a planar arm exactly, found by Newton's method from seeded starts.

The equations say that the blocks off the diagonal vanish (Lee and Chen 2014, Eq. (23); `energy.blocks`). Written with
``v = sqrt(k) (.., -a, r_{i+1}, .., r_{k-1}, b, ..)`` for each spring, they are ``sum conj(v_u) v_v = 0`` and, in the
ground's row, ``= g M_v``; and the stored energy is ``1/2 sum |v|^2``, a sum of squares too. So least squares on both,
the energy weighted less and less, leads to solutions that store little, and Newton's steps then make them exact. Where
that finds nothing, least squares on the equations alone does.

Attachments are measured along each link; on the ground along the upward vertical, where Eq. (24) wants them. On a
straight arm they are real: on the link's line.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from functools import cache, lru_cache, partial
from math import inf, log

import numpy as np

from ...model.arrays import Array, Booleans, Complexes, frozen
from .arm import Installation, PlanarArm, upward
from .elongation import ROOM, Elongation
from .exclusion import Layout
from .stiffness_blocks import StiffnessBlocks

STARTS = 40  # tried at most
ENOUGH = 6  # solutions to choose the least energy from
WEIGHTS = (0.3, 0.05, 0.005)  # of the square root of the energy, one fit after the other
SMALL, LARGE = 0.02, 1e3  # attachments of a spring that belongs to its layout, in longest links
SOFT = 1e-4  # of the stiffest spring: softer ones count as absent
EXACT = 1e-13  # of the largest moment
FIT = 30  # evaluations: further ones would only trade the equations for energy
PATIENCE = 8  # starts without a solution, after which the energy does not count
PLAIN = 300  # evaluations without the energy
LIMITS = (1.5, 3.0, 6.0, inf)  # in longest links: tried in turn when no limit is given
STIFFNESS, A, B = range(3)
off_diagonal = cache(partial(np.triu_indices, k=1))  # rows and columns of the blocks above the diagonal, of n x n

Fixed = Mapping[tuple[int, int], float]
"""(number of the spring, STIFFNESS or A or B) -> its value [N/m or m]; a and b along the link, the ground's upwards."""


@frozen
class Equations:
    """The equations of a layout on an arm, in units of its longest link and its largest moment.

    Attributes:
        limit: [m] of |a| and |b|, infinite for none.
        elongation: how long springs may get; None for any length.
    """

    arm: PlanarArm
    layout: Layout
    limit: float = inf
    fixed: Fixed = field(default_factory=dict)
    elongation: Elongation | None = None

    @property
    def size(self) -> float:
        """[m] the unit of length."""
        lengths = self.arm.lengths
        return float(lengths[1:-1].max()) if len(lengths) > 2 else float(lengths[-1])

    @property
    def energy(self) -> float:
        """[J] the unit of energy."""
        return self.arm.gravity * float(abs(self.arm.moments).max())

    @property
    def width(self) -> int:
        """Unknowns of a spring: log stiffness, then a and b along the link, and across it when the arm is crooked."""
        return 3 if self.arm.straight else 5

    def start(self, generator: np.random.Generator) -> Array:
        """(springs, width) random unknowns, the fixed ones in place."""
        x = np.empty((len(self.layout), self.width))
        x[:, 0] = generator.normal(0, 1, len(x))
        x[:, 1:] = generator.normal(0, min(0.7, self.limit / self.size), x[:, 1:].shape)
        return self.held(x)

    def held(self, x: Array) -> Array:
        """The unknowns with the fixed ones in place."""
        x = x.copy()
        for (spring, which), value in self.fixed.items():
            if which == STIFFNESS:
                x[spring, 0] = log(value * self.size**2 / self.energy)
            else:
                columns = self._columns(which)
                x[spring, columns] = 0
                x[spring, columns[0]] = value / self.size
        return x

    def free(self) -> Booleans:
        """(springs * width,) which unknowns are not fixed."""
        free = np.ones((len(self.layout), self.width), bool)
        for spring, which in self.fixed:
            free[spring, self._columns(which)] = False
        return free.ravel()

    def _columns(self, which: int) -> list[int]:
        if which == STIFFNESS:
            return [0]
        first = 1 + (which - 1) * (self.width - 1) // 2
        return list(range(first, first + (self.width - 1) // 2))

    def unpacked(self, x: Array) -> tuple[Array, Complexes, Complexes]:
        """Stiffness, a and b of every spring, in our units."""
        k = np.exp(np.clip(x[:, 0], -30, 30))
        if self.width == 3:
            return k, x[:, 1].astype(complex), x[:, 2].astype(complex)
        return k, x[:, 1] + 1j * x[:, 2], x[:, 3] + 1j * x[:, 4]

    def vectors(self, x: Array) -> tuple[Complexes, Complexes]:
        """v (springs, n) and its derivative (springs, width, n) by the spring's own unknowns."""
        k, a, b = self.unpacked(x)
        n, root = self.arm.n, np.sqrt(k)
        v = np.zeros((len(x), n), complex)
        D = np.zeros((len(x), self.width, n), complex)
        lengths = self.arm.lengths / self.size
        turns = (1.0,) if self.width == 3 else (1.0, 1j)
        for s, (i, j) in enumerate(self.layout):
            sign = 1.0 if i == 1 else -1.0  # the ground's row is divided by I'
            v[s, i : j - 1] = root[s] * lengths[i : j - 1]
            v[s, i - 1], v[s, j - 1] = sign * root[s] * a[s], root[s] * b[s]
            D[s, 0] = v[s] / 2
            for c, turn in enumerate(turns):
                D[s, 1 + c, i - 1] = sign * root[s] * turn
                D[s, 1 + len(turns) + c, j - 1] = root[s] * turn
        return v, D

    def blocks(self, x: Array) -> tuple[Array, Array]:
        """The blocks off the diagonal as real rows, and their derivative (rows, springs * width)."""
        return self._blocks(*self.vectors(x))

    def _blocks(self, v: Complexes, D: Complexes) -> tuple[Array, Array]:
        rows, columns = off_diagonal(self.arm.n)
        e = (v[:, rows].conj() * v[:, columns]).sum(axis=0)
        e[: self.arm.n - 1] -= self.arm.gravity * self.arm.moments[1:] / self.energy
        own = v[:, None]
        J = D[..., rows].conj() * own[..., columns] + own[..., rows].conj() * D[..., columns]
        return self._real(e), self._real(J.reshape(-1, len(rows)).T)

    def _real(self, z: Complexes) -> Array:
        return z.real if self.width == 3 else np.concatenate([z.real, z.imag])

    def fit(self, x: Array, weight: float, evaluations: int = FIT) -> Array:
        """Least squares on the blocks, the weighted root of the energy, and what sticks out of the limits."""
        from scipy.optimize import least_squares

        free, shape = self.free(), x.shape

        def full(y: Array) -> Array:
            z = x.ravel().copy()
            z[free] = y
            return z.reshape(shape)

        @lru_cache(1)  # the solver asks for the rows first, and then for their slopes, at one place
        def both(y: bytes) -> tuple[Array, Array]:
            z = full(np.frombuffer(y))
            v, D = self.vectors(z)
            energy = np.eye(len(z))[:, None, :, None] * D.transpose(0, 2, 1)[:, :, None]
            stored = weight * self._real(v.ravel()), weight * self._real(energy.reshape(v.size, -1))
            parts = self._blocks(v, D), stored, self._out(z), self._stretched(z)
            return np.concatenate([e for e, _ in parts]), np.concatenate([J for _, J in parts])[:, free]

        found = least_squares(
            lambda y: both(y.tobytes())[0],
            x.ravel()[free],
            jac=lambda y: both(y.tobytes())[1],  # pyright: ignore[reportArgumentType]
            max_nfev=evaluations,
        )
        return full(found.x)

    def _out(self, x: Array) -> tuple[Array, Array]:
        """Rows (2 springs,) that are 0 for attachments within the limit, and their derivative."""
        half = (self.width - 1) // 2
        ends = x[:, 1:].reshape(-1, 2, half)
        far = np.linalg.norm(ends, axis=-1)
        over = far - ROOM * self.limit / self.size
        J = np.zeros((len(x), 2, len(x), self.width))
        for s, end in zip(*np.nonzero(over > 0), strict=True):
            J[s, end, s, 1 + end * half : 1 + (end + 1) * half] = 10 * ends[s, end] / far[s, end]
        return 10 * np.maximum(over, 0).ravel(), J.reshape(2 * len(x), -1)

    def _stretched(self, x: Array) -> tuple[Array, Array]:
        """Rows (springs,) that are 0 for springs that are short enough, and their derivative."""
        if self.elongation is None:
            return np.zeros(0), np.zeros((0, x.size))
        _, a, b = self.unpacked(x)
        return self.elongation.rows(self.layout, self.arm.lengths, self.size, a, b, (self.width - 1) // 2)

    def newton(self, x: Array, steps: int = 40) -> Array | None:
        """The nearest exact solution, or None."""
        free = self.free()
        for _ in range(steps):
            e, J = self.blocks(x)
            if not free.any() or not np.isfinite(e).all():
                break
            step = np.zeros(x.size)
            step[free] = -np.linalg.lstsq(J[:, free], e, rcond=1e-9)[0]
            x = x + (step / max(1.0, np.abs(step).max())).reshape(x.shape)
            if np.abs(step).max() < 1e-15 * max(1.0, np.abs(x).max()):
                break
        return x if np.abs(self.blocks(x)[0]).max() < EXACT else None

    def installed(self, x: Array) -> tuple[Installation, ...] | None:
        """The springs; None when one has shrunk into a spring of another layout, or sticks out of the limit."""
        k, a, b = self._settled(*self.unpacked(x))
        ends = np.abs(np.concatenate([a, b]))
        inside = ends.min() >= SMALL and ends.max() <= min(LARGE, self.limit / self.size)
        if not inside or k.min() < SOFT * k.max():
            return None
        if self.elongation is not None and not self.elongation.holds(self.layout, self.arm.lengths, self.size, a, b):
            return None
        stiffness, size = k * self.energy / self.size**2, self.size
        return tuple(
            Installation(i, j, float(stiffness[s]), complex(a[s] * size * upward(i)), complex(b[s] * size))
            for s, (i, j) in enumerate(self.layout)
        )

    def _settled(self, k: Array, a: Complexes, b: Complexes) -> tuple[Array, Complexes, Complexes]:
        """A spring between neighbours acts by k a b alone: its ends are put half a link, or limit, out."""
        longest = inf if self.elongation is None else self.elongation.longest
        half = min(self.size, self.limit, longest) / self.size / 2
        held = {spring for spring, _ in self.fixed}
        for s, (i, j) in enumerate(self.layout):
            if j == i + 1 and s not in held and a[s] and b[s]:
                k[s] *= abs(a[s]) * abs(b[s]) / half**2
                turn = b[s] / abs(b[s])  # equivalent installations: both angles turned alike
                a[s], b[s] = half * a[s] / abs(a[s]) / turn, half
        return k, a, b

    def solve(
        self, seed: int = 0, starts: int = STARTS, near: Array | None = None, enough: int = ENOUGH
    ) -> Installed | None:
        """Of the solutions found the one that stores least, None when none is found.

        Args:
            near: where to start from, before the random starts.
            enough: solutions to choose from.
        """
        generator = np.random.default_rng(seed)
        found: list[Installed] = []
        for number in range(starts):
            x = self.held(near) if number == 0 and near is not None else self.start(generator)
            if number < PATIENCE or found:
                for weight in WEIGHTS:
                    x = self.fit(x, weight)
            else:
                x = self.fit(x, 0.0, PLAIN)
            x = self.newton(x)
            springs = None if x is None else self.installed(x)
            if x is not None and springs is not None:
                found.append(Installed(self, x, springs))
            if len(found) == enough:
                break
        return min(found, key=lambda one: one.energy, default=None)


@frozen
class Installed:
    """Unknowns that satisfy the equations, and the springs that they stand for."""

    equations: Equations
    x: Array
    springs: tuple[Installation, ...]

    @property
    def energy(self) -> float:
        """[J] what the springs store, summed over their parts along each link; gravity takes from it what it gives."""
        arm = self.equations.arm
        blocks = (StiffnessBlocks.spring(arm, one).K.diagonal().real for one in self.springs)
        return float(sum(0.5 * (K * arm.lengths**2).sum() for K in blocks))


def solve(
    arm: PlanarArm,
    layout: Layout,
    limit: float | None = None,
    fixed: Fixed | None = None,
    seed: int = 0,
    enough: int = ENOUGH,
    elongation: Elongation | None = None,
) -> Installed | None:
    """Springs of a layout that balance the arm and store little, None when none were found.

    Args:
        limit: [m] of the attachments; without one they are kept as close as some multiple of the longest link.
        elongation: how long springs may get; None for any length.
        enough: solutions to choose from.
    """
    size = Equations(arm, layout).size
    for most in (limit,) if limit is not None else (share * size for share in LIMITS):
        found = Equations(arm, layout, most, fixed or {}, elongation).solve(seed, enough=enough)
        if found is not None:
            return found
    return None

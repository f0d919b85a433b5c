"""Stiffness block matrices of planar arms: Lee and Chen (2014), Eqs. (5)-(8), (17)-(24), (26)-(27).

With the directions r = (x_1, r_2, .., r_n) as complex numbers the energy is ``1/2 r^H K r``. Each 2 x 2 block of the
paper is a rotation times a factor, so one complex number: 1 stands for I, i for I'. A spring has ``K = k w w^H``
(docs/theory.md, section 5); the arm is balanced when the blocks off the diagonal vanish in the sum with gravity's,
Eq. (23).
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce
from operator import add

import numpy as np

from ...model.arrays import Complexes, frozen
from .arm import Installation, PlanarArm


@frozen
class StiffnessBlocks:
    """Hermitian matrix `K` (n, n) of blocks [N/m]; the ground's row is [N], as x_1 is a bare direction."""

    K: Complexes

    @staticmethod
    def gravity(arm: PlanarArm) -> StiffnessBlocks:
        """Eqs. (18)-(20): K_1j = -g (moment of link j and of all that it carries) / r_j times I'."""
        K = np.zeros((arm.n, arm.n), complex)
        K[0, 1:] = -1j * arm.gravity * arm.moments[1:] / arm.lengths[1:]
        return StiffnessBlocks(K + K.conj().T)

    @staticmethod
    def spring(arm: PlanarArm, one: Installation) -> StiffnessBlocks:
        """Eqs. (7)-(8): K = k w w^H with w = (0, .., -A, 1, .., 1, B, 0, ..)."""
        w = vector(arm, one)
        return StiffnessBlocks(one.stiffness * (w.conj()[:, None] @ w[None]))

    @staticmethod
    def total(arm: PlanarArm, springs: Iterable[Installation]) -> StiffnessBlocks:
        """Eq. (23): gravity and all springs."""
        return reduce(add, (StiffnessBlocks.spring(arm, one) for one in springs), StiffnessBlocks.gravity(arm))

    def __add__(self, other: StiffnessBlocks) -> StiffnessBlocks:
        return StiffnessBlocks(self.K + other.K)

    @property
    def off_diagonal(self) -> Complexes:
        """(n (n-1)/2,) the blocks that must vanish, row by row."""
        return self.K[np.triu_indices(len(self.K), 1)]

    def block(self, u: int, v: int) -> complex:
        """K_uv, links numbered from 1."""
        return complex(self.K[u - 1, v - 1])

    def __str__(self) -> str:
        """The upper triangle as the paper prints it: factors of I and I'."""
        n = len(self.K)
        cells = [[_text(self.K[u, v]) if v >= u else "" for v in range(n)] for u in range(n)]
        width = max(len(cell) for row in cells for cell in row)
        return "\n".join("[ " + "  ".join(cell.rjust(width) for cell in row) + " ]" for row in cells)

    def latex(self) -> str:
        """The upper triangle as a LaTeX matrix."""
        n = len(self.K)
        rows = [" & ".join(_latex(self.K[u, v]) if v >= u else "" for v in range(n)) for u in range(n)]
        return "\\begin{bmatrix} " + " \\\\ ".join(rows) + " \\end{bmatrix}"


def vector(arm: PlanarArm, one: Installation) -> Complexes:
    """(n,) w: what a spring stretches by, as a combination of x_1, r_2, .., r_n."""
    w: Complexes = np.zeros(arm.n, np.complex128)
    w[one.i : one.k - 1] = 1.0
    w[one.i - 1] = -one.a / arm.lengths[one.i - 1]
    w[one.k - 1] = one.b / arm.lengths[one.k - 1]
    return w


def _text(z: complex) -> str:
    parts = [f"{value:.6g} {name}" for value, name in ((z.real, "I"), (z.imag, "I'")) if value]
    return " + ".join(parts).replace("+ -", "- ") or "0"


def _latex(z: complex) -> str:
    parts = [f"{_power(value)}\\,{name}" for value, name in ((z.real, "I"), (z.imag, "I'")) if value]
    return " + ".join(parts).replace("+ -", "- ") or "0"


def _power(value: float) -> str:
    mantissa, _, exponent = f"{value:.6g}".partition("e")
    return f"{mantissa} \\times 10^{{{int(exponent)}}}" if exponent else mantissa

"""Mean square torque of many designs and its gradient, through the Gram form: whatever the number of configurations.

The torque is linear in ``k y y'`` of each spring, so the objective of a whole batch of designs is two products with
one matrix, and its gradient comes with it. For fixed attachments it is a quadratic form in the stiffnesses.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array, frozen
from .gram import TRI_I, TRI_J, TRI_WEIGHT, Gram, svec
from .polish import Springs, unit_torque


@frozen
class Quadratic:
    """``x' H x + 2 b' x + c``: the mean square torque over stiffnesses x [N/m], as a share of the unbalanced one."""

    H: Array
    b: Array
    c: float

    @staticmethod
    def of(gram: Gram, springs: Springs) -> Quadratic:
        """Of one spring set (a batch of one), whose attachments stay."""
        A = unit_torque(gram, springs)[0]
        return Quadratic(A.T @ A, A.T @ gram.d, float(gram.d @ gram.d) + gram.rest**2)

    def __call__(self, x: Array) -> tuple[Array, Array]:
        """Values (N,) and gradients (N, springs) at the stiffnesses x (N, springs) [N/m]."""
        half = x @ self.H + self.b  # half the gradient
        return np.einsum("ns,ns->n", x, half + self.b) + self.c, 2 * half


def mean_square(gram: Gram, springs: Springs) -> tuple[Array, Array, Array]:
    """Mean square torque, as a share of the unbalanced one squared, and its gradient.

    Returns:
        Values (batch,), derivatives by stiffness (batch, springs) [m/N] and by the attachments in their regions' own
        coordinates (batch, springs, 2, 3).
    """
    batch = np.arange(len(springs))[:, None]
    Q = svec(gram.Q).transpose(1, 0, 2).reshape(len(gram.d), -1)  # (rows, 28 pairs)
    y = springs.y
    outer = springs.k[..., None] * y[..., TRI_I] * y[..., TRI_J] * TRI_WEIGHT
    N = np.zeros((len(springs), len(gram.problem.pairs), len(TRI_I)))
    np.add.at(N, (batch, springs.pair), outer)
    r = N.reshape(len(springs), -1) @ Q.T + gram.d
    slope = (2 * r @ Q).reshape(N.shape)[batch, springs.pair]  # by each spring's k y y'
    G = np.zeros((*springs.k.shape, 7, 7))
    G[..., TRI_I, TRI_J] = G[..., TRI_J, TRI_I] = slope / TRI_WEIGHT
    Gy = (G @ y[..., None])[..., 0]
    by_k = np.einsum("bsi,bsi->bs", y, Gy)
    by_u = (2 * springs.k[..., None] * Gy)[..., [0, 1, 2, 4, 5, 6]].reshape(springs.u.shape)
    return np.einsum("br,br->b", r, r) + gram.rest**2, by_k, by_u

"""Mean square torque of many designs and its gradient, through the Gram form: whatever the number of configurations.

The torque is linear in the unknowns that the parts add up to, so the objective of a whole batch of designs is two
products with one matrix, and its gradient comes with it. For fixed shapes it is a quadratic form in the amounts.
"""

from __future__ import annotations

import numpy as np

from ...model.arrays import Array, frozen
from .least_squares_form import LeastSquaresForm
from .polish import Parts, by_block, unit_torque


@frozen
class Quadratic:
    """``x' H x + 2 b' x + c``: the mean square torque over amounts x, as a share of the unbalanced one."""

    H: Array
    b: Array
    c: float

    @staticmethod
    def of(reduced: LeastSquaresForm, parts: Parts) -> Quadratic:
        """Of one set (a batch of one), whose shapes stay."""
        A = unit_torque(reduced, parts)[0]
        return Quadratic(A.T @ A, A.T @ reduced.d, float(reduced.d @ reduced.d) + reduced.rest**2)

    def __call__(self, x: Array) -> tuple[Array, Array]:
        """Values (N,) and gradients (N, parts) at the amounts x (N, parts): of springs the stiffnesses [N/m]."""
        half = x @ self.H + self.b  # half the gradient
        return np.einsum("ns,ns->n", x, half + self.b) + self.c, 2 * half


def mean_square(reduced: LeastSquaresForm, parts: Parts) -> tuple[Array, Array, Array]:
    """Mean square torque, as a share of the unbalanced one squared, and its gradient.

    Returns:
        Values (batch,), derivatives by the amounts (batch, parts), of springs [m/N], and by the shapes
        (batch, parts, shape).
    """
    r = np.tile(reduced.d, (len(parts), 1))
    by_k, by_u = np.empty(parts.k.shape), np.zeros(parts.u.shape)
    rows = np.broadcast_to(np.arange(len(parts))[:, None], parts.k.shape)
    each = [
        (
            at,
            rows[at],
            reduced.columns[number],
            own.part(parts.u[at, : own.shape]),
            own.slopes(parts.u[at, : own.shape]),
        )
        for own, at, number in by_block(reduced, parts.block)
    ]
    for at, row, columns, part, _ in each:
        x = np.zeros((len(parts), part.shape[1]))
        np.add.at(x, row, parts.k[at, None] * part)
        r += x @ columns.T
    for at, row, columns, part, slopes in each:
        slope = (2 * r @ columns)[row]  # by the unknowns of each part
        by_k[at] = np.einsum("nx,nx->n", part, slope)
        by_u[at, : slopes.shape[1]] = parts.k[at, None] * (slopes @ slope[..., None])[..., 0]
    return np.einsum("br,br->b", r, r) + reduced.rest**2, by_k, by_u

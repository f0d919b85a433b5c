"""Blocks whose shapes are in a ball: a step that they allow stays in it to first order, and slopes are derivatives."""

from __future__ import annotations

import numpy as np

from equipoise.synthesis.convex.counterweight_block import CounterweightBlock

BLOCK = CounterweightBlock("arm", 0.3)


def test_a_step_is_within_when_the_ball_allows_it_to_first_order():
    rng = np.random.default_rng(0)
    for u, step in zip(BLOCK.project(rng.normal(size=(50, 3))), rng.normal(size=(50, 3)), strict=True):
        A, b = BLOCK.within(u)
        assert (A @ step <= b).all() == (u @ u + 2 * u @ step <= 1)


def test_slopes_are_the_derivative_of_a_part():
    u, step = np.full((1, 3), 0.2), 1e-6
    for i, slope in enumerate(BLOCK.slopes(u)[0]):
        moved = u + step * np.eye(3)[i]
        np.testing.assert_allclose((BLOCK.part(moved) - BLOCK.part(u))[0] / step, slope, atol=1e-8)

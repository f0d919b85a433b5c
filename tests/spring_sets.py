"""Sets of parts for the convex problem, and the torques of the real elements that they stand for."""

from __future__ import annotations

import numpy as np

import equipoise as eq
from equipoise.energy import Potential
from equipoise.synthesis.convex.polish import Parts
from equipoise.synthesis.problem import Problem


def with_parts(problem: Problem, parts: Parts) -> eq.Mechanism:
    """The mechanism with the real elements of one set of parts."""
    mechanism = problem.kept
    for number, k, u in zip(parts.block[0], parts.k[0], parts.u[0], strict=True):
        block = problem.blocks[number]
        mechanism = block.add(mechanism, float(k), u[: block.shape])
    return mechanism


def torque_of(problem: Problem, parts: Parts, q: np.ndarray) -> np.ndarray:
    """Weighted torques (N, n) of gravity and a set of parts, computed from real elements."""
    return Potential(with_parts(problem, parts))(q).torque * problem.scale


def some_springs(problem: Problem, seed: int = 0) -> Parts:
    rng = np.random.default_rng(seed)
    block = rng.integers(len(problem.blocks), size=(1, 4))
    return Parts(block, rng.uniform(50, 500, (1, 4)), rng.uniform(-0.5, 0.5, (1, 4, 6)))

"""Sets of springs for the convex problem, and the torques of the real springs that they stand for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import equipoise as eq
from equipoise.energy import Potential
from equipoise.synthesis.polish import Springs
from equipoise.synthesis.problem import Problem


def torque_of(problem: Problem, springs: Springs, q: np.ndarray) -> np.ndarray:
    """Weighted torques (N, n) of gravity and a spring set, computed from real springs."""
    real = []
    for i, (pair, k, y) in enumerate(zip(springs.pair[0], springs.k[0], springs.y[0], strict=True)):
        a, b = problem.pairs[pair]
        z = problem.lift((a, b)) @ y
        real.append(eq.Spring(f"{i}", a, tuple(z[:3]), b, tuple(z[4:]), float(k)))
    mechanism = replace(problem.mechanism, springs=(*problem.mechanism.springs, *real))
    return Potential(mechanism)(q).torque * problem.weights


def some_springs(problem: Problem, seed: int = 0) -> Springs:
    rng = np.random.default_rng(seed)
    pair = rng.integers(len(problem.pairs), size=(1, 4))
    return Springs(pair, rng.uniform(50, 500, (1, 4)), rng.uniform(-0.5, 0.5, (1, 4, 2, 3)))

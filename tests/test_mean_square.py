"""The objective against the torques of real springs, and its gradient against finite differences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from robots import robot
from spring_sets import some_springs, torque_of

from equipoise.kinematics import Tree, sample
from equipoise.synthesis.convex import least_squares_form
from equipoise.synthesis.convex.mean_square import Quadratic, mean_square
from equipoise.synthesis.convex.polish import Parts
from equipoise.synthesis.problem import Problem


def batch(problem: Problem, count: int) -> Parts:
    sets = [some_springs(problem, seed) for seed in range(count)]
    return Parts(*(np.concatenate([getattr(one, name) for one in sets]) for name in ("block", "k", "u")))


@pytest.mark.parametrize("name", ["ur5", "panda"])
def test_value_is_the_mean_square_torque_of_real_springs(name: str) -> None:
    problem = Problem.of(robot(name), span=2, radius=0.2, samples=200)
    compressed = least_squares_form.build(problem)
    q = sample(Tree.of(problem.mechanism), 200, 0)
    springs = batch(problem, 3)
    value, _, _ = mean_square(compressed, springs)
    expected = [(torque_of(problem, springs[np.array([i])], q) ** 2).sum(axis=1).mean() for i in range(3)]
    np.testing.assert_allclose(value * compressed.unbalanced**2, expected, rtol=1e-10)
    form = Quadratic.of(compressed, springs[np.array([1])])
    np.testing.assert_allclose(form(springs.k[1:2])[0] * compressed.unbalanced**2, expected[1], rtol=1e-10)


def test_gradients_are_those_of_finite_differences() -> None:
    compressed = least_squares_form.build(Problem.of(robot("ur5"), span=2, radius=0.2))
    springs = batch(compressed.problem, 4)
    _, by_k, by_u = mean_square(compressed, springs)
    for name, gradient, h in (("k", by_k, 1e-2), ("u", by_u, 1e-5)):
        at = getattr(springs, name)
        for place in np.ndindex(at.shape[1:]):
            step = np.zeros(at.shape)
            step[(slice(None), *place)] = h
            up, down = (mean_square(compressed, replace(springs, **{name: at + sign * step}))[0] for sign in (1, -1))
            slope = (up - down) / (2 * h)
            np.testing.assert_allclose(
                gradient[(slice(None), *place)], slope, rtol=1e-5, atol=1e-6 * abs(gradient).max()
            )


def test_quadratic_form_and_its_gradient() -> None:
    compressed = least_squares_form.build(Problem.of(robot("ur5"), span=2, radius=0.2))
    one = some_springs(compressed.problem)
    form = Quadratic.of(compressed, one)
    k = np.random.default_rng(0).uniform(10, 500, (20, one.k.shape[1]))
    many = Parts(np.repeat(one.block, 20, axis=0), k, np.repeat(one.u, 20, axis=0))
    value, by_k, _ = mean_square(compressed, many)
    found, gradient = form(k)
    np.testing.assert_allclose(found, value, rtol=1e-10)
    np.testing.assert_allclose(gradient, by_k, rtol=1e-9, atol=1e-12 * np.abs(by_k).max())

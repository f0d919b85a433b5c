"""The compressed problem against the torques of real springs."""

from dataclasses import replace

import numpy as np
import pytest
from robots import lee_chen, planar_arm, robot
from spring_sets import some_springs, torque_of, with_parts

import equipoise as eq
from equipoise.energy import Potential
from equipoise.kinematics import Tree, sample
from equipoise.synthesis.convex import least_squares_form
from equipoise.synthesis.convex.polish import residual
from equipoise.synthesis.problem import Problem, Region


def slides() -> eq.Mechanism:
    return eq.Mechanism(
        "lift",
        bodies=(eq.Body("carriage", 2.0), eq.Body("arm", 1.0, (0.3, 0, 0.1))),
        joints=(
            eq.Joint("slide", "prismatic", "world", "carriage", axis=(0, 1, 2), range=(0, 0.4)),
            eq.Joint("turn", "revolute", "carriage", "arm", axis=(1, 2, 0), range=(-1, 2)),
        ),
    )


@pytest.mark.parametrize("mechanism", [robot("ur5"), robot("xarm7"), slides(), lee_chen()], ids=lambda m: m.name)
def test_samples_give_the_mean_square_torque_of_real_springs(mechanism):
    problem = Problem.of(mechanism, span=2, radius=0.2, samples=300)
    compressed = least_squares_form.build(problem)
    springs = some_springs(problem)
    q = sample(Tree.of(mechanism), 300, 0)
    expected = np.sqrt((torque_of(problem, springs, q) ** 2).sum(axis=1).mean())
    found = np.hypot(np.linalg.norm(residual(compressed, springs)), compressed.rest) * compressed.unbalanced
    assert found == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("mechanism", [robot("ur5"), lee_chen()], ids=lambda m: m.name)
def test_exact_averages_are_the_limit_of_samples(mechanism):
    problem = Problem.of(mechanism, span=2, radius=0.2)
    exact = least_squares_form.build(problem)
    assert exact.averaged
    springs = some_springs(problem)
    value = np.hypot(np.linalg.norm(residual(exact, springs)), exact.rest) * exact.unbalanced
    errors = []
    for count in (500, 50_000):
        q = np.random.default_rng(1).uniform(-np.pi, np.pi, (count, Tree.of(mechanism).n))
        errors.append(abs(np.sqrt((torque_of(problem, springs, q) ** 2).sum(axis=1).mean()) / value - 1))
    assert errors[1] < 0.01
    assert errors[1] < errors[0]


def test_mean_stored_energy_is_that_of_the_springs():
    problem = Problem.of(lee_chen(), span=3, radius=0.2)
    averaged, sampled = least_squares_form.build(problem), least_squares_form.build(replace(problem, samples=20_000))
    springs = some_springs(problem)
    q = np.random.default_rng(2).uniform(-np.pi, np.pi, (20_000, 3))
    expected = Potential(with_parts(problem, springs))(q).springs.sum(axis=1).mean()
    assert springs.cost(averaged)[0] == pytest.approx(expected, rel=0.02)
    assert springs.cost(sampled)[0] == pytest.approx(expected, rel=0.02)


def test_averages_are_exact_but_where_samples_are_asked_for():
    assert least_squares_form.build(Problem.of(robot("ur5"), span=1)).averaged  # +-360 deg and +-180 deg
    limited = planar_arm([1, 1], [0.3, 0.3], [0.1, 0.1])
    limited = replace(limited, joints=tuple(replace(j, range=(-1.0, 1.0)) for j in limited.joints))
    for mechanism in (slides(), limited):
        assert least_squares_form.build(Problem.of(mechanism, span=1)).averaged
        assert not least_squares_form.build(Problem.of(mechanism, span=1, samples=100)).averaged


def test_a_spring_between_the_ground_and_a_vertical_axis_is_recognised_as_useless():
    spun = eq.Mechanism(
        "turntable",
        bodies=(eq.Body("table", 1.0), eq.Body("arm", 1.0, (0.3, 0, 0))),
        joints=(
            eq.Joint("turn", "revolute", "world", "table", axis=(0, 0, 1)),
            eq.Joint("lift", "revolute", "table", "arm", axis=(0, 1, 0)),
        ),
    )
    problem = Problem(spun, (("table", "arm"),), {"table": Region.ball(0.1), "arm": Region.ball(0.1)})
    assert least_squares_form.build(problem).useful == [0]
    fixed = eq.Mechanism("post", (eq.Body("post", 1.0),), (eq.Joint("weld", "fixed", "world", "post"),))
    problem = Problem(fixed, (("world", "post"),), {"world": Region.ball(0.1), "post": Region.ball(0.1)})
    assert least_squares_form.build(problem).useful == []

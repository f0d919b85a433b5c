"""Exact means over joint ranges, against the torques of real springs: a tensor grid of quadrature, and many samples."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from robots import planar_arm, robot
from spring_sets import some_springs, torque_of, with_parts
from test_least_squares_form import slides

import equipoise as eq
from equipoise.energy import Potential
from equipoise.kinematics import Tree, sample
from equipoise.kinematics.sampling import bounds
from equipoise.model.elements import TorsionSpring
from equipoise.model.mechanism import Coupling, Mechanism
from equipoise.synthesis.convex import least_squares_form
from equipoise.synthesis.convex.box_averages import is_box
from equipoise.synthesis.convex.polish import residual
from equipoise.synthesis.problem import Problem

POINTS = 28  # of Gauss and Legendre in each range


def limited(*ranges: tuple[float, float] | None) -> Mechanism:
    arm = planar_arm([1.0] * len(ranges), [0.3] * len(ranges), [0.1] * len(ranges))
    joints = tuple(replace(joint, range=given) for joint, given in zip(arm.joints, ranges, strict=True))
    return replace(arm, joints=(replace(joints[0], axis=(1.0, 2.0, 0.5)), *joints[1:]))


def turned_by_a_spring() -> Mechanism:
    m = limited((-1.0, 0.5), (0.2, 1.5))
    spring = TorsionSpring("t", ((m.joints[0].name, 1.0), (m.joints[1].name, -0.5)), 3.0, 0.2)
    return m.with_springs((spring,))


def geared() -> Mechanism:
    m = limited((-1.0, 0.5), (0.2, 1.5), None)
    names = [joint.name for joint in m.joints]
    return replace(m, couplings=(Coupling(names[2], ((names[0], 0.5), (names[1], -1.0)), 0.3),))


def by_quadrature(problem: Problem, springs: object) -> tuple[float, float]:
    """[N m] the root mean square torque, and [J] the mean energy of the springs, over the box."""
    lower, upper = bounds(Tree.of(problem.judged))
    points, weights = np.polynomial.legendre.leggauss(POINTS)
    q = np.stack(np.meshgrid(*[(a + b) / 2 + (b - a) / 2 * points for a, b in zip(lower, upper, strict=True)]), axis=-1)
    w = np.prod(np.stack(np.meshgrid(*[weights / 2] * len(lower)), axis=-1), axis=-1).ravel()
    q = q.reshape(-1, len(lower))
    torque = torque_of(problem, springs, q)  # type: ignore[arg-type]
    stored = Potential(with_parts(problem, springs))(q).springs.sum(axis=1)  # type: ignore[arg-type]
    return float(np.sqrt(w @ (torque**2).sum(axis=1))), float(w @ stored)


@pytest.mark.parametrize(
    "m",
    [
        slides(),
        limited((-1.0, 2.0), (0.5, 0.500001), (-2.0, 2.5)),
        limited((0.1, 0.2), (1.0, 1.0001)),
        limited((-0.5, 0.5), None),
        limited((-5.0, 4.0), (-0.3, 0.1)),
        geared(),
        turned_by_a_spring(),
    ],
    ids=["slides", "limited", "narrow", "one limited", "more than a turn", "geared", "torsion spring"],
)
def test_the_mean_over_the_box_is_that_of_quadrature(m: Mechanism) -> None:
    problem = Problem.of(m, span=2, radius=0.2, keep=bool(m.springs))
    form = least_squares_form.build(problem)
    assert form.averaged
    springs = some_springs(problem)
    rms, stored = by_quadrature(problem, springs)
    assert np.hypot(np.linalg.norm(residual(form, springs)), form.rest) * form.unbalanced == pytest.approx(
        rms, rel=1e-9
    )
    if not m.springs:
        assert springs.cost(form)[0] == pytest.approx(stored, rel=1e-9)


@pytest.mark.parametrize("name", ["panda", "xarm7"])
def test_it_is_the_limit_of_samples(name: str) -> None:
    """The measure is that of the samples that were taken before: within four standard errors of 60,000."""
    problem = Problem.of(robot(name), span=2, radius=0.2)
    form = least_squares_form.build(problem)
    springs = some_springs(problem)
    value = np.hypot(np.linalg.norm(residual(form, springs)), form.rest) * form.unbalanced
    squares = (torque_of(problem, springs, sample(Tree.of(problem.judged), 60_000, 5)) ** 2).sum(axis=1)
    assert abs(squares.mean() - value**2) < 4 * squares.std() / np.sqrt(len(squares))


def test_whole_turns_are_the_same_by_either_way() -> None:
    arm = limited(None, None)
    once = replace(arm, joints=tuple(replace(joint, range=(-np.pi, np.pi * (1 - 1e-5))) for joint in arm.joints))
    values = []
    for m in (arm, once):
        problem = Problem.of(m, span=2, radius=0.2)
        form, springs = least_squares_form.build(problem), some_springs(problem)
        values.append(np.hypot(np.linalg.norm(residual(form, springs)), form.rest) * form.unbalanced)
    assert values[0] == pytest.approx(values[1], rel=1e-4)


def test_limits_of_coupled_joints_that_cut_the_box_are_sampled() -> None:
    m = geared()
    cut = replace(m, joints=(*m.joints[:2], replace(m.joints[2], range=(-0.5, 0.5))))
    wide = replace(m, joints=(*m.joints[:2], replace(m.joints[2], range=(-9.0, 9.0))))
    assert is_box(Tree.of(wide))
    assert not is_box(Tree.of(cut))
    assert not least_squares_form.build(Problem.of(cut, span=1, samples=None)).averaged


def test_no_seed_is_in_the_result() -> None:
    problem = Problem.of(limited((-1.0, 2.0), (-2.0, 2.5)), span=2, radius=0.2)
    one, other = (least_squares_form.build(replace(problem, seed=seed)) for seed in (0, 7))
    assert one.unbalanced == other.unbalanced
    assert eq.design(problem.mechanism, span=2, springs=1, radius=0.2).samples is None

"""The convex bound against a second solver and a second formulation, and against random designs."""

import itertools

import cvxpy as cp
import numpy as np
import pytest
from robots import lee_chen, planar_arm, robot

from equipoise.synthesis.convex import least_squares_form
from equipoise.synthesis.convex.peak import Peak
from equipoise.synthesis.convex.polish import Parts, residual
from equipoise.synthesis.convex.semidefinite import least_rms, rms_program
from equipoise.synthesis.convex.spring_block import smat
from equipoise.synthesis.problem import Problem

CASES = [
    (lee_chen(), {"span": 1}),
    (lee_chen(), {"span": 3, "pairs": [("world", "link2"), ("world", "link3"), ("link2", "link3")]}),
    (planar_arm([1, 2], [0.4, 0.3], [0.2, 0.1]), {"span": 1, "shape": "box"}),
    (robot("ur5"), {"span": 1}),
]


def by_cvxpy(compressed: least_squares_form.LeastSquaresForm) -> float:
    """The same program in its textbook form, by another solver."""
    problem = compressed.problem
    N = [cp.Variable((7, 7), PSD=True) for _ in problem.pairs]
    scale = 1 / max(np.abs(columns).max() for columns in compressed.columns)
    every = [smat(columns) for columns in compressed.columns]
    w = sum(cp.hstack([cp.trace(scale * Q @ M) for Q in Qs]) for Qs, M in zip(every, N, strict=True))
    limits = []
    for pair, M in zip(problem.pairs, N, strict=True):
        bounded, balls = [], []
        for name, first in zip(pair, (0, 4), strict=True):
            end = range(first, first + 3)
            if problem.attachments[name][0].shape == "ball":
                balls.append(list(end))
                limits.append(sum(M[i, i] for i in end) <= M[3, 3])
            else:
                bounded += end
                limits += [M[i, i] <= M[3, 3] for i in end]
        for s, t in itertools.product((1, -1), (1, -1)):
            for i, j in itertools.combinations(bounded, 2):
                limits.append(M[3, 3] + s * M[3, i] + t * M[3, j] + s * t * M[i, j] >= 0)
            for i, j, k in itertools.combinations(bounded, 3):
                limits.append(M[3, 3] + s * M[i, j] + t * M[i, k] + s * t * M[j, k] >= 0)
        for s, i, ball in itertools.product((1, -1), bounded, balls):
            limits.append(cp.norm(M[3, ball] + s * M[i, ball]) <= M[3, 3] + s * M[3, i])
    torque = cp.norm(cp.hstack([w + compressed.d, compressed.rest]))
    program = cp.Problem(cp.Minimize(torque), limits)
    program.solve(solver=cp.SCS, eps=1e-7, max_iters=200_000)
    return float(np.asarray(torque.value))


@pytest.mark.parametrize(("mechanism", "options"), CASES)
def test_bound_agrees_with_another_solver(mechanism, options):
    compressed = least_squares_form.build(Problem.of(mechanism, radius=0.15, **options))
    assert least_rms(compressed).value == pytest.approx(by_cvxpy(compressed), rel=1e-4, abs=1e-5)


@pytest.mark.parametrize(("mechanism", "options"), CASES)
def test_no_random_design_undercuts_the_bound(mechanism, options):
    compressed = least_squares_form.build(Problem.of(mechanism, radius=0.15, **options))
    bound = least_rms(compressed).value
    rng = np.random.default_rng(0)
    pair = rng.integers(len(compressed.blocks), size=(2000, 4))
    u = rng.uniform(-1, 1, (2000, 4, 6))
    springs = Parts.at(compressed, pair, np.exp(rng.uniform(-3, 8, (2000, 4))), u)
    value = np.hypot(np.linalg.norm(residual(compressed, springs), axis=1), compressed.rest)
    assert value.min() >= bound - 1e-9


def test_acceptance_ur5_span_2():
    """THEORY's table says 0.58 % by sampling; the exact average is 0.619 %."""
    bound = least_rms(least_squares_form.build(Problem.of(robot("ur5"), span=2, radius=0.15)))
    assert 0.005 < bound.value < 0.007


def test_the_samples_do_not_change_the_size_of_the_solve():
    forms = [
        least_squares_form.build(Problem.of(robot("ur5"), span=2, radius=0.15, samples=count)) for count in (1000, 5000)
    ]
    assert [{columns.shape for columns in found.columns} for found in forms] == [{(28, 28)}] * 2
    assert [len(found.columns) for found in forms] == [11, 11]


def test_more_pairs_or_larger_regions_never_leave_more():
    small = least_squares_form.build(Problem.of(lee_chen(), span=1, radius=0.1))
    assert least_rms(small.enlarged(2.0)).value <= least_rms(small).value + 1e-8
    large = least_squares_form.build(Problem.of(lee_chen(), span=2, radius=0.1))
    assert least_rms(large).value <= least_rms(small).value + 1e-8


def test_enlarged_is_the_problem_with_larger_regions():
    problem = Problem.of(lee_chen(), span=1, radius=0.1)
    direct = least_rms(least_squares_form.build(problem.enlarged(3.0))).value
    assert least_rms(least_squares_form.build(problem).enlarged(3.0)).value == pytest.approx(direct, abs=1e-7)


def test_peak_bound_holds_for_random_designs_and_is_reached():
    compressed = least_squares_form.build(Problem.of(lee_chen(), span=1, radius=0.15, samples=500, objective="peak"))
    peak = Peak.of(compressed)
    bound = peak.bound.value
    rng = np.random.default_rng(0)
    for _ in range(200):
        pair = rng.integers(len(compressed.blocks), size=(1, 3))
        springs = Parts.at(compressed, pair, np.exp(rng.uniform(0, 7, (1, 3))), rng.uniform(-1, 1, (1, 3, 6)))
        assert peak.torques(springs).max() >= bound - 1e-9
    start = Parts(np.array([[0, 1, 2]]), np.full((1, 3), 100.0), np.full((1, 3, 6), 0.2))
    _, value = peak.polish(start)
    assert bound - 1e-9 <= value <= 1.3 * bound


@pytest.mark.parametrize(("mechanism", "options"), CASES)
def test_whether_a_value_is_reached_is_what_the_optimum_says(mechanism, options):
    program = rms_program(least_squares_form.build(Problem.of(mechanism, radius=0.15, **options)))
    least = program.solve().value
    for value in (1e-6, 0.5 * least, 0.999 * least, 1.001 * least + 1e-8, 2.0):
        assert program.reaches(value) is (least < value)


def test_prices_pull_the_optimum_towards_fewer_parts():
    program = rms_program(least_squares_form.build(Problem.of(lee_chen(), span=2, radius=0.15)))
    blocks = program.reduced.blocks
    free = program.priced([np.zeros(block.unknowns) for block in blocks])
    dear = program.priced([0.1 * block.amount for block in blocks])
    amount = [sum(block.amount @ own for block, own in zip(blocks, x, strict=True)) for x in (free, dear)]
    assert amount[1] < 0.5 * amount[0]
    again = program.priced([np.zeros(block.unknowns) for block in blocks])
    assert [own.tolist() for own in again] == [own.tolist() for own in free]

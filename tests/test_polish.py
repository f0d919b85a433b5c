"""Local improvement: derivatives, constraints, and convergence to exact designs."""

import numpy as np
import pytest
from robots import lee_chen, planar_arm

from equipoise.synthesis.convex import least_squares_form
from equipoise.synthesis.convex.polish import Parts, best_amounts, jacobian, polish, residual
from equipoise.synthesis.problem import Problem, Region


def a_batch(compressed: least_squares_form.LeastSquaresForm, batch: int, springs: int, seed: int = 0) -> Parts:
    rng = np.random.default_rng(seed)
    pair = rng.integers(len(compressed.blocks), size=(batch, springs))
    u = rng.uniform(-1, 1, (batch, springs, 6))
    return Parts.at(compressed, pair, rng.uniform(50, 500, (batch, springs)), u)


@pytest.fixture(scope="module")
def compressed() -> least_squares_form.LeastSquaresForm:
    return least_squares_form.build(Problem.of(lee_chen(), span=3, radius=0.15))


def test_jacobian_is_the_central_difference_to_second_order(compressed):
    springs = a_batch(compressed, 3, 2)
    J = jacobian(compressed, springs)

    def error(h: float) -> float:
        worst = 0.0
        for s in range(2):
            for v in range(7):
                step = np.zeros((3, 2, 7))
                step[:, s, v] = h
                inner = Parts(springs.block, springs.k, 0.3 * springs.u)  # the regions leave it alone
                plus, minus = inner.moved(compressed, step), inner.moved(compressed, -step)
                slope = (residual(compressed, plus) - residual(compressed, minus)) / (2 * h)
                worst = max(worst, np.abs(slope - jacobian(compressed, inner)[:, :, 7 * s + v]).max())
        return worst

    assert J.shape == (3, len(compressed.d), 14)
    assert error(1e-3) < 1e-4 * np.abs(J).max()
    assert error(1e-3) < 0.02 * error(1e-2) + 1e-12


@pytest.mark.parametrize("shape", ["ball", "box"])
def test_polish_stays_in_the_regions_and_never_gets_worse(shape):
    compressed = least_squares_form.build(Problem.of(lee_chen(), span=1, radius=0.1, shape=shape))
    start = best_amounts(compressed, a_batch(compressed, 40, 3))
    before = np.hypot(np.linalg.norm(residual(compressed, start), axis=1), compressed.rest)
    after, value = polish(compressed, start)
    ends = after.u.reshape(40, 3, 2, 3)
    size = np.abs(ends).max(axis=-1) if shape == "box" else np.linalg.norm(ends, axis=-1)
    assert size.max() <= 1 + 1e-12
    assert (after.k > 0).all()
    assert (value <= before + 1e-12).all()
    assert value == pytest.approx(np.hypot(np.linalg.norm(residual(compressed, after), axis=1), compressed.rest))


def test_a_pendulum_is_polished_to_rounding():
    pendulum = planar_arm([2.0], [0.5], [0.3])
    regions = {"world": Region.ball(0.2), "link2": Region.box((0.2, 0.01, 0.01), (0.1, 0, 0))}
    compressed = least_squares_form.build(Problem(pendulum, (("world", "link2"),), regions))
    start = best_amounts(compressed, a_batch(compressed, 16, 1))
    springs, value = polish(compressed, start)
    assert value.min() < 1e-12
    best = value.argmin()
    spring = compressed.blocks[0].add(pendulum, springs.k[best, 0], springs.u[best, 0]).springs[0]
    # k a x b = m g l and a . b = 0 in the plane of motion, the ground end a and the link's end b
    (ax, _, az), (bx, _, bz), k = spring.p_a, spring.p_b, spring.stiffness
    assert k * (az * bx - ax * bz) == pytest.approx(2.0 * 9.81 * 0.3, rel=1e-9)
    assert k * (ax * bx + az * bz) == pytest.approx(0.0, abs=1e-9)


def test_polish_does_not_touch_its_start(compressed):
    start = a_batch(compressed, 4, 2)
    k, u = start.k.copy(), start.u.copy()
    polish(compressed, start, iterations=5)
    assert (start.k == k).all()
    assert (start.u == u).all()

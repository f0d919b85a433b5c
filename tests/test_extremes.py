"""The climb: it finds closed-form extremes, never loses the best sample, and stays inside the ranges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from campaign import campaign
from odd_mechanisms import coupled, drum
from random_mechanisms import random_mechanism
from scipy.optimize import minimize
from zoo import ZOO, geared_pair, pendulum, vertical_slide

from equipoise import check
from equipoise.energy import FourierEnergy, Potential
from equipoise.energy.extremes import climb
from equipoise.kinematics import Tree, sample
from equipoise.kinematics.sampling import bounds, inside
from equipoise.model.errors import InputError
from equipoise.model.mechanism import Mechanism


def peaks(m: Mechanism, samples: int = 500, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Of the torques' magnitudes: the peaks and where they are."""
    tree, potential = Tree.of(m), Potential(m)
    return climb(tree, lambda q: np.abs(potential(q).torque), sample(tree, samples, seed), seed)


@pytest.mark.parametrize("name", [name for name, make in ZOO.items() if None not in make().residual])
def test_closed_forms(name: str) -> None:
    known = ZOO[name]()
    for m, expected in ((known.mechanism, known.residual), (known.mechanism.with_springs(()), known.unbalanced)):
        if name == "heavy_spring" and not m.springs:
            continue  # its spring is part of the load
        found, q = peaks(m)
        np.testing.assert_allclose(found, np.array(expected, float), rtol=1e-6, atol=1e-11)
        at_them = np.abs(np.diagonal(Potential(m)(q).torque))
        np.testing.assert_allclose(found, at_them, atol=1e-12)


def test_six_dimensions_from_few_samples() -> None:
    """The best of 50 samples is far from the peak; the climb is not."""
    known = ZOO["lenzo_spherical"]()
    m = known.mechanism.with_springs(())
    tree, potential = Tree.of(m), Potential(m)
    q = sample(tree, 50)
    best = np.abs(potential(q).torque).max(axis=0)
    assert (best < 0.99 * np.array(known.unbalanced)).any()
    np.testing.assert_allclose(peaks(m, 50)[0], known.unbalanced, rtol=1e-6)


@pytest.mark.parametrize("seed", range(60))
def test_never_below_the_samples_nor_beyond_the_bound(seed: int) -> None:
    m = random_mechanism(seed, 4, free_lengths=False)
    tree, potential = Tree.of(m), Potential(m)
    try:
        q = sample(tree, 300, seed)
    except InputError:
        return  # its ranges contradict each other
    found, where = climb(tree, lambda q: np.abs(potential(q).torque), q, seed)
    best = np.abs(potential(q).torque).max(axis=0, initial=0)
    assert (found >= best * (1 - 1e-13) - 1e-13).all()  # poses in other company are rounded differently
    assert (found <= FourierEnergy(m).torque_bound() * (1 + 1e-12) + 1e-11).all()
    assert inside(tree, where).all()
    lower, upper = bounds(tree)
    assert ((where >= lower) & (where <= upper)).all()


def test_the_edge_of_a_range() -> None:
    """sin and cos peak outside: the extreme is where the range ends."""
    m = pendulum().with_springs(())
    m = replace(m, joints=(replace(m.joints[0], range=(0.5, 1.2)),))
    found, where = peaks(m)
    np.testing.assert_allclose(where, [[0.5]])
    np.testing.assert_allclose(found, 5.886 * np.cos(0.5), rtol=1e-14)


def test_the_range_of_a_coupled_joint() -> None:
    """A driver within +-3 rad, but 1 - 2 q within -0.2 to 0.6."""
    found, where = peaks(coupled(-0.2, 0.6).with_springs(()))
    q = np.linspace(0.2, 0.6, 100_001)
    expected = np.abs(9.81 * 0.3 * (np.cos(q) - 2 * np.cos(1 - 2 * q))).max()
    assert found[0] == pytest.approx(expected, rel=1e-9)
    assert 0.2 - 1e-9 <= where[0, 0] <= 0.6 + 1e-9


def test_an_unlimited_slide_is_judged_within_a_metre() -> None:
    m = vertical_slide().mechanism
    m = replace(m, joints=(replace(m.joints[0], range=None),))
    found, where = peaks(m)
    np.testing.assert_allclose([found[0], abs(where[0, 0])], [98.1, 1.0], rtol=1e-12)


def test_an_unlimited_drum_is_judged_within_half_a_turn() -> None:
    found, where = peaks(drum(None))
    np.testing.assert_allclose([found[0], abs(where[0, 0])], [0.981 * np.pi, np.pi], rtol=1e-12)


@pytest.mark.parametrize("ratio", [0.5, 0.1, 0.01])
def test_a_reduction_gear_gets_to_its_peak(ratio: float) -> None:
    """The driven link is horizontal only after many turns of the motor."""
    m = geared_pair(ratio, 1.2).with_springs(())
    motor, link = m.bodies
    m = replace(m, bodies=(replace(motor, mass=0.0), link))
    np.testing.assert_allclose(peaks(m)[0], [ratio * 9.81 * 0.3], rtol=1e-6)


def test_the_same_seed_gives_the_same_peak() -> None:
    m = ZOO["lee_chen_arm"]().mechanism
    for first, second in zip(peaks(m, seed=3), peaks(m, seed=3), strict=True):
        np.testing.assert_array_equal(first, second)


def test_nothing_to_climb() -> None:
    tree = Tree.of(Mechanism("m"))
    best, where = climb(tree, lambda q: np.ones((len(q), 2)), sample(tree, 5))
    assert best.tolist() == [1, 1]
    assert where.shape == (2, 0)
    tree = Tree.of(pendulum())
    best, where = climb(tree, lambda q: np.ones((len(q), 0)), sample(tree, 5))
    assert best.shape == (0,)
    assert where.shape == (0, 1)


def elsewhere(m: Mechanism, part: str, j: int, seed: int) -> float:
    """The largest magnitude of one torque that another search finds."""
    tree, potential = Tree.of(m), Potential(m)
    poses = sample(tree, 5000, seed)

    def lost(q: np.ndarray) -> float:
        return -abs(float(getattr(potential(q[None]), part)[0, j])) if inside(tree, q[None])[0] else 0.0

    found = np.abs(getattr(potential(poses), part)[:, j])
    limits = list(zip(*bounds(tree), strict=True))
    climbed = minimize(lost, poses[found.argmax()], method="L-BFGS-B", bounds=limits)
    return max(float(found.max()), -float(climbed.fun))


@campaign(500)
def test_no_pose_of_another_search_exceeds_the_largest(seeds: range) -> None:
    """By 0.01 %. Where a spring with a free length can shrink to nothing, its force has no direction: left out."""
    done = 0
    for seed in seeds:
        m = random_mechanism(seed, 3)
        try:
            b = check(m)
        except InputError:
            continue  # its ranges contradict each other
        if any(use.min_length < 1e-3 and spring.free for use, spring in zip(b.use, m.springs, strict=True)):
            continue
        done += 1
        for part, printed in (("gravity_torque", b.unbalanced.max), ("torque", b.residual.max)):
            for j, most in enumerate(printed):
                assert elsewhere(m, part, j, seed + 1) <= most * (1 + 1e-4) + 1e-9 * printed.max(), (seed, part, j)
    assert done > 0.6 * len(seeds)

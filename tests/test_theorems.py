"""Attempts to break the theorems of docs/theorems.md; that of the fewest springs has test_fewest.py."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from exact_mechanisms import exact_mechanism, spoiled
from random_mechanisms import random_mechanism
from robots import planar_arm
from scipy.optimize import least_squares

from equipoise.energy import Potential, SpanEnergy
from equipoise.kinematics import Tree
from equipoise.model.elements import Spring
from equipoise.model.mechanism import Mechanism

TURN = np.linspace(-np.pi, np.pi, 41)[:-1]


# Joint limits ---------------------------------------------------------------------------------------------------------


def spread(m: Mechanism, q: np.ndarray) -> float:
    """[J] by which the energy varies over poses."""
    return float(np.ptp(Potential(m)(q).energy))


def test_what_is_constant_on_a_small_box_is_constant_everywhere() -> None:
    """Exact, spoiled and random ones: the verdict over all configurations is that on any box of 0.6 rad or m."""
    verdicts = []
    for seed in range(40):
        exact = exact_mechanism(seed)
        for m in (exact, spoiled(exact, seed, 1e-2), random_mechanism(seed, 3, free_lengths=False)):
            n = len(m.coordinates)
            if n:
                rng = np.random.default_rng(seed)
                q = rng.uniform(-2, 2, n) + rng.uniform(-0.3, 0.3, (300, n))
                distance = SpanEnergy(m).distance
                size = np.abs(Potential(m)(q).springs).sum() / 300 + distance.scale
                assert distance.exact == (spread(m, q) < 1e-9 * size), seed
                verdicts.append(distance.exact)
    assert 30 < sum(verdicts) < len(verdicts) - 30


@pytest.mark.parametrize("width", [1.0, 0.1])
def test_no_spring_balances_a_range_and_not_the_turn(width: float) -> None:
    """The best spring on a range of one joint, from many starts: as good as exact only where it is exact all around."""
    arm = planar_arm([1.0], [0.3], [0.15])
    q = np.linspace(0.3, 0.3 + width, 12)[:, None]

    def with_spring(x: np.ndarray) -> Mechanism:
        a, b = (float(x[0]), 0.0, float(x[1])), (float(x[2]), 0.0, float(x[3]))
        return arm.with_springs((Spring("s", "world", a, arm.bodies[0].name, b, float(np.exp(x[4]))),))

    def left(x: np.ndarray) -> np.ndarray:
        return Potential(with_spring(x))(q).torque[:, 0]

    reached = 0
    for seed in range(8):
        start = np.append(np.random.default_rng(seed).uniform(-0.3, 0.3, 4), 5.0)
        found = least_squares(left, start, xtol=1e-15, ftol=1e-15, gtol=1e-15).x
        if np.abs(left(found)).max() < 1e-11:
            reached += 1
            assert np.abs(Potential(with_spring(found))(TURN[:, None]).torque).max() < 1e-6
    assert reached > 3


# Free length ----------------------------------------------------------------------------------------------------------


def least_torque(free: float, count: int, starts: int) -> float:
    """[N m] the least rms torque found on a link whose weight makes sin q N m, with springs that end within 0.5 m."""
    rng = np.random.default_rng(count)
    c, s = np.cos(TURN)[:, None], np.sin(TURN)[:, None]
    bounds = np.tile([0.5, 0.5, 0.5, 0.5, 7.0], count)

    def left(x: np.ndarray) -> np.ndarray:
        ax, ay, bx, by, k = x.reshape(count, 5).T
        dx, dy = c * bx - s * by - ax, s * bx + c * by - ay
        length = np.sqrt(dx**2 + dy**2 + 1e-24)
        pull = np.exp(k) * (1 - free / length)
        return (pull * (dx * (-s * bx - c * by) + dy * (c * bx - s * by))).sum(axis=1) + np.sin(TURN)

    found = [
        least_squares(left, rng.uniform(-0.5, 0.5, len(bounds)) * bounds, bounds=(-bounds, bounds), max_nfev=200,
                      xtol=1e-15, ftol=1e-15, gtol=1e-15)
        for _ in range(starts)
    ]  # fmt: skip
    return min(float(np.sqrt(np.mean(one.fun**2))) for one in found)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_springs_with_a_free_length_are_never_exact(count: int) -> None:
    """From many starts: with no free length what is left is rounding; with 0.1 m it may be little, but never that."""
    assert least_torque(0.0, count, 4) < 1e-11
    assert least_torque(0.1, count, 4) > 1e-7


def test_halves_of_angles_do_not_cancel() -> None:
    """The second case of the proof: lengths |cos| of half the angle, of any number of springs, are not smooth."""
    arm = planar_arm([1.0], [0.3], [0.15]).with_springs(())
    rng = np.random.default_rng(0)
    for count in (1, 2, 5):
        springs = []
        for i in range(count):
            r, start = float(rng.uniform(0.1, 0.3)), float(rng.uniform(-3, 3))
            a = (r * np.cos(start), 0.0, r * np.sin(start))
            springs.append(Spring(f"s{i}", "world", a, arm.bodies[0].name, (r, 0.0, 0.0), 100.0, 0.1))
        m = arm.with_springs(springs)
        kinks = np.abs(np.diff(Potential(m)(np.linspace(-np.pi, np.pi, 20_001)[:, None]).torque[:, 0]))
        assert (kinks > 0.5).sum() == count  # a jump of k L r each


def test_a_spring_that_keeps_its_length_may_have_a_free_one() -> None:
    """The exception: from the axis."""
    arm = planar_arm([1.0], [0.3], [0.15])
    base = arm.joints[0].xyz
    idle = Spring("idle", "world", base, arm.bodies[0].name, (0.2, 0.0, 0.1), 100.0, 0.05)
    assert np.abs(Potential(arm.with_springs((idle,)))(TURN[:, None]).spring_torque).max() < 1e-12


# Tilt -----------------------------------------------------------------------------------------------------------------


def test_a_tilted_base_asks_for_a_mass_centre_that_stays() -> None:
    """Counterweights hold for every direction; with springs that lift, some of four directions is not held."""
    directions = 9.81 * np.array([[0, 0, -1], [1, 0, 0], [0, 1, 0], [-0.6, 0, 0.8]], float)
    assert np.linalg.matrix_rank(directions[1:] - directions[0]) == 3
    met = {True: 0, False: 0}
    for seed in range(60):
        m = exact_mechanism(seed)
        if any(joint.type == "prismatic" for joint in m.joints) or not m.coordinates:
            continue
        tilted = [replace(m, gravity=(float(x), float(y), float(z))) for x, y, z in directions]
        all_exact = all(SpanEnergy(one).distance.exact for one in tilted)
        tree = Tree.of(m)
        q = np.random.default_rng(seed).uniform(-2, 2, (50, tree.n))
        poses = tree.poses(q)
        lumps = [(body.name, body.mass, body.com) for body in m.bodies]
        lumps += [(mass.body, mass.mass, mass.position) for mass in m.masses]
        centre = sum(w * poses.point(tree.index[b], np.array(p)) for b, w, p in lumps) / sum(w for _, w, _ in lumps)
        stays = bool(np.ptp(np.asarray(centre), axis=0).max() < 1e-9)
        assert all_exact == stays, seed
        met[stays] += 1
    assert min(met.values()) > 5, met

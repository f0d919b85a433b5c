"""Load cases: one residual each, and the best design for all of them against brute force over poses."""

from dataclasses import replace

import numpy as np
import pytest
from robots import planar_arm

import equipoise as eq
from equipoise.energy import Potential
from equipoise.kinematics import Tree, sample
from equipoise.model.errors import InfeasibleError, InputError
from equipoise.synthesis.convex.least_squares_form import build
from equipoise.synthesis.convex.semidefinite import least_rms
from equipoise.synthesis.load import cone

ARM = planar_arm([1, 2], [0.4, 0.3], [0.2, 0.1])
LIMITED = replace(ARM, joints=tuple(replace(j, range=(-0.5, 2.0)) for j in ARM.joints))
CUP = eq.PointMass("cup", "link3", 0.8, (0.3, 0, 0))
PAYLOADS = [eq.Load("empty", 3.0), eq.Load("full", 1.0, (CUP,))]
TILTED = [eq.Load("upright"), eq.Load("tilted", 2.0, gravity=(9.81 * np.sin(0.4), 0.0, -9.81 * np.cos(0.4)))]


def torques(mechanism: eq.Mechanism, loads: list[eq.Load], q: np.ndarray) -> np.ndarray:
    """(loads, N, n) by the energies of the mechanism under each load."""
    return np.array([Potential(load.on(mechanism))(q).torque for load in loads])


@pytest.mark.parametrize("loads", [PAYLOADS, TILTED], ids=["payloads", "gravity"])
@pytest.mark.parametrize("arm", [ARM, LIMITED], ids=["averages", "samples"])
def test_one_residual_each_and_their_weighted_mean(arm, loads):
    problem = eq.Problem.of(arm, span=2, radius=0.2).with_loads(loads)
    if arm is LIMITED:
        problem = problem.with_poses(700, seed=5)
        q = sample(Tree.of(arm), 700, 5)
    else:  # sums of two angles' harmonics up to 2: 8 angles each are exact
        turn = 2 * np.pi * np.arange(8) / 8
        q = np.stack(np.meshgrid(turn, turn), axis=-1).reshape(-1, 2)
    design = eq.solve(problem, springs=2)
    each = [np.sqrt((t**2).sum(axis=1).mean()) for t in torques(design.mechanism, loads, q)]
    bare = [np.sqrt((t**2).sum(axis=1).mean()) for t in torques(arm, loads, q)]
    assert [row.name for row in design.loads] == [load.name for load in loads]
    assert [row.residual for row in design.loads] == pytest.approx(each, rel=1e-9)
    assert [row.unbalanced for row in design.loads] == pytest.approx(bare, rel=1e-9)
    weights = [load.weight for load in loads]
    assert design.residual == pytest.approx(np.sqrt(np.average(np.square(each), weights=weights)), rel=1e-9)
    assert design.unbalanced == pytest.approx(np.sqrt(np.average(np.square(bare), weights=weights)), rel=1e-9)
    assert design.bound is not None
    assert design.bound <= design.residual * (1 + 1e-9)
    # no worse for all together than what is best for one load alone
    for load in loads:
        alone = eq.solve(problem.with_loads([load]), springs=2)
        other = [np.sqrt((t**2).sum(axis=1).mean()) for t in torques(alone.mechanism, loads, q)]
        assert design.residual <= np.sqrt(np.average(np.square(other), weights=weights)) * (1 + 1e-6)


def test_the_best_for_two_payloads_is_the_best_for_their_mean():
    """The mean square is that of the mean payload and a constant (theory: fixed springs)."""
    loads = [eq.Load("empty"), eq.Load("full", 1.0, (CUP,))]
    half = eq.Load("half", 1.0, (replace(CUP, mass=CUP.mass / 2),))
    problem = eq.Problem.of(ARM, span=1, radius=0.2)
    both, mean = (build(problem.with_loads(these)) for these in (loads, [half]))
    torque = torques(ARM, loads, np.random.default_rng(0).uniform(-np.pi, np.pi, (200_000, 2)))
    spread = float(np.mean(((torque[1] - torque[0]) ** 2).sum(axis=1))) / 4
    left = (least_rms(both).value * both.unbalanced) ** 2
    assert left == pytest.approx((least_rms(mean).value * mean.unbalanced) ** 2 + spread, rel=0.01)


def test_the_peak_is_the_largest_of_all_loads():
    problem = eq.Problem.of(LIMITED, span=1, radius=0.2, objective="peak", samples=500, loads=PAYLOADS)
    design = eq.solve(problem, springs=2)
    largest = np.abs(torques(design.mechanism, PAYLOADS, sample(Tree.of(LIMITED), 500, 0))).max(axis=(1, 2))
    assert [row.residual for row in design.loads] == pytest.approx(largest, rel=1e-9)
    assert design.residual == pytest.approx(largest.max(), rel=1e-9)
    assert design.bound is not None
    assert design.bound <= design.residual


def test_exact_is_under_every_load():
    problem = eq.Problem.of(ARM, span=2, radius=0.2)
    assert eq.solve(problem, exact=True).balance.exact
    two = problem.with_loads(PAYLOADS)
    with pytest.raises(InfeasibleError, match="exact balance is infeasible"):
        eq.solve(two, exact=True)
    design = eq.solve(two, springs=2, front=True)
    assert design.exact_feasible is False
    assert not any(row.exact for row in design.front)
    full = eq.solve(problem.with_loads([PAYLOADS[1]]), exact=True)
    assert eq.check(PAYLOADS[1].on(full.mechanism)).exact
    assert not full.balance.exact  # of the mechanism as it is


def test_the_default_is_one_load():
    design = eq.design(ARM, span=1, radius=0.1, springs=1)
    (row,) = design.loads
    assert (row.name, row.weight) == ("own", 1.0)
    assert row.residual == pytest.approx(design.residual, rel=1e-12)
    assert design.to_dict()["loads"][0]["unbalanced"] == pytest.approx(design.unbalanced, rel=1e-12)
    assert "loads" not in design.free_parameters
    given = eq.design(ARM, span=1, radius=0.1, springs=1, loads=PAYLOADS).free_parameters["loads"]
    assert given[1] == {
        "name": "full",
        "weight": 1.0,
        "masses": [{"name": "cup", "body": "link3", "mass": 0.8, "position": [0.3, 0, 0]}],
        "gravity": None,
    }


@pytest.mark.parametrize(
    ("loads", "message"),
    [
        ([], "one or more with different names"),
        ([eq.Load("a"), eq.Load("a")], "one or more with different names"),
        ([eq.Load("a", masses=(eq.PointMass("cup", "hand", 1.0),))], "there is no body 'hand'"),
    ],
)
def test_refusals(loads, message):
    with pytest.raises(InputError, match=message):
        eq.solve(eq.Problem.of(ARM, radius=0.2, loads=loads))


def test_a_weight_is_more_than_nothing():
    with pytest.raises(InputError, match="weight: must be a finite number of more than 0, found 0"):
        eq.Load("a", 0.0)


@pytest.mark.parametrize("tilt", [0.1, 0.5, 1.5])
def test_few_directions_have_the_moments_of_the_cone(tilt):
    """Of a direction evenly spread over a cap its height h is even from cos(tilt) to 1 (Archimedes)."""
    g = np.array([1.0, 2.0, -9.0])
    axis, c = g / np.linalg.norm(g), np.cos(tilt)
    every = np.array(cone(g, tilt)) / np.linalg.norm(g)
    along = (1 + c + c**2) / 3  # mean of h^2
    across = (1 - along) / 2
    assert every.mean(axis=0) == pytest.approx((1 + c) / 2 * axis, abs=1e-12)
    expected = across * np.eye(3) + (along - across) * np.outer(axis, axis)
    assert every.T @ every / len(every) == pytest.approx(expected, abs=1e-12)

"""Few springs out of the program: the bound is reached, on one slide and on hundreds of random mechanisms."""

import os
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from campaign import campaign
from robots import planar_arm, robot

import equipoise as eq
from equipoise.energy import Potential
from equipoise.model.errors import EquipoiseError, EquipoiseWarning
from equipoise.report.text import design_lines
from equipoise.synthesis import Problem
from equipoise.synthesis.convex import few_springs, semidefinite
from equipoise.synthesis.convex.block_sets import FEASIBLE
from equipoise.synthesis.convex.few_springs import SpringSearch
from equipoise.synthesis.convex.goal import Rms
from equipoise.synthesis.convex.least_squares_form import build

WEIGHT = 6 * 9.81
LIFT = eq.Mechanism(
    "lift",
    (eq.Body("carriage", 6.0),),
    (eq.Joint("z", "prismatic", "world", "carriage", axis=(0, 0, 1), range=(0.0, 0.4)),),
)
Vec3 = tuple[float, float, float]


@pytest.mark.parametrize("seed", range(3))
def test_one_spring_is_the_optimum_of_one_slide(seed):
    """The ends as far apart as a ball of 300 mm allows, k = mean(L) W / mean(L^2) with L = 0.6 - z; by hand."""
    design = eq.design(LIFT, radius=0.3, seed=seed, samples=20_000)
    (spring,) = design.mechanism.springs
    np.testing.assert_allclose([spring.p_a, spring.p_b], [(0, 0, 0.3), (0, 0, -0.3)], atol=1e-4)
    assert spring.stiffness == pytest.approx(WEIGHT * 0.4 / np.mean(np.linspace(0.2, 0.6, 10_001) ** 2), rel=3e-3)
    z = np.linspace(0, 0.4, 10_001)[:, None]
    left = np.sqrt(np.mean(Potential(design.mechanism)(z).torque ** 2))
    assert left == pytest.approx(16.325, rel=2e-4)
    assert design.bound == pytest.approx(design.residual, rel=1e-6)
    assert not design.by_chance


@pytest.mark.parametrize("seed", range(3))
def test_the_least_peak_of_one_slide_is_half_the_weight(seed):
    """By hand: k (0.6 - z) - W is as large at both ends of the range where k = 2 W / (0.6 + 0.2)."""
    design = eq.design(LIFT, radius=0.3, seed=seed, objective="peak", samples=200)
    (spring,) = design.mechanism.springs
    assert design.residual == pytest.approx(29.43, rel=1e-4)
    assert design.bound == pytest.approx(29.43, rel=1e-4)
    assert spring.stiffness == pytest.approx(2 * WEIGHT / 0.8, rel=1e-4)


def random_mechanism(seed: int) -> tuple[eq.Mechanism, float]:
    """By turns a slide, a pendulum, a SCARA and a planar arm, with limits or without, and a radius of all balls [m]."""
    rng = np.random.default_rng(seed)
    kind = ("slide", "pendulum", "scara", "planar arm")[seed % 4]
    joints = {"slide": 1, "pendulum": 1, "scara": 3, "planar arm": int(rng.integers(2, 4))}[kind]
    slide = {"slide": 0, "scara": int(rng.integers(3))}.get(kind)
    axis: Vec3 = {"scara": (0.0, 0.0, 1.0), "planar arm": (0.0, 1.0, 0.0)}.get(kind) or vector(rng, 1.0)
    names = ["world", *(f"link{i}" for i in range(joints))]

    def limits(i: int) -> tuple[float, float] | None:
        if i == slide:
            low = float(rng.uniform(-0.3, 0))
            return low, low + float(rng.uniform(0.1, 0.6))
        low = float(rng.uniform(-np.pi, np.pi))
        return (low, low + float(rng.uniform(0.3, 4))) if rng.random() < 0.6 else None

    mechanism = eq.Mechanism(
        kind,
        tuple(eq.Body(name, float(rng.uniform(0.5, 5)), vector(rng, 0.2)) for name in names[1:]),
        tuple(
            eq.Joint(f"joint{i}", "prismatic" if i == slide else "revolute", names[i], names[i + 1],
                     vector(rng, 0.3), axis=axis, range=limits(i))
            for i in range(joints)
        ),
    )  # fmt: skip
    return mechanism, float(rng.uniform(0.05, 0.4))


def vector(rng: np.random.Generator, size: float) -> Vec3:
    x, y, z = rng.uniform(-size, size, 3).tolist()
    return x, y, z


@campaign(300)
def test_with_balls_the_bound_is_reached(seeds):
    """A pair with parallel axes is a Hermitian matrix under three constraints: its extreme points have rank one."""
    for seed in seeds:
        mechanism, radius = random_mechanism(seed)
        limited = any(joint.range for joint in mechanism.joints)
        reduced = build(Problem.of(mechanism, span=3, radius=radius, samples=300 if limited else None))
        if not reduced.useful or reduced.unbalanced < 1e-9:
            continue  # axes along gravity
        search = SpringSearch(Rms(reduced.on(reduced.useful)), most=12)
        if search.floor > 1 - 1e-9:
            continue  # no spring helps
        found = search.best(12)
        assert found is not None
        assert found.value - search.floor <= 1e-3 * search.floor + (FEASIBLE if found.exact else 1e-9), seed
        assert found.exact or search.floor >= FEASIBLE, seed
        assert not found.by_chance, seed


def test_real_arms_reach_their_bounds_with_two_and_three_springs():
    ur5 = eq.design(robot("ur5"), span=2, radius=0.15, springs=8)
    assert ur5.residual / ur5.unbalanced == pytest.approx(0.006190, abs=5e-7)
    assert len(ur5.mechanism.springs) == 2
    xarm7 = eq.design(robot("xarm7"), span=3, radius=0.15, unlimited=True, springs=8)
    assert xarm7.residual / xarm7.unbalanced == pytest.approx(0.070746, abs=5e-7)
    assert len(xarm7.mechanism.springs) == 3
    for design in (ur5, xarm7):
        assert design.bound == pytest.approx(design.residual, rel=1e-6)
        assert not design.by_chance


def test_random_starts_are_named(monkeypatch):
    arm = planar_arm([0.848, 0.848, 1.330], [0.180, 0.180, 0.070], [0.090, 0.090, 0.060])
    by_program = eq.design(arm, span=3, radius=0.2)
    assert by_program.balance.exact
    assert len(by_program.mechanism.springs) == 3
    monkeypatch.setattr(few_springs, "few_parts", lambda *_: None)
    by_chance = eq.design(arm, span=3, radius=0.2, springs=3)
    assert by_chance.balance.exact
    for design, named in ((by_program, False), (by_chance, True)):
        assert design.by_chance is design.to_dict()["by_chance"] is named
        assert any("random starts" in str(line) for line in design_lines(design)) is named


def test_a_solver_that_fails_is_a_warning_and_random_starts(monkeypatch):
    def fails(*_: object) -> None:
        raise EquipoiseError("the convex solver stopped with 'MaxIterations'")

    monkeypatch.setattr(semidefinite.Program, "solve", fails)
    monkeypatch.setattr(semidefinite.Program, "priced", fails)
    with pytest.warns(EquipoiseWarning, match="MaxIterations.*no bound"):
        design = eq.design(planar_arm([2.0], [0.5], [0.3]), radius=0.2)
    assert design.bound is None
    assert design.certified_gap is None
    assert design.exact_feasible is None
    assert design.by_chance
    assert design.balance.exact


def test_the_design_does_not_depend_on_the_number_of_threads():
    code = (
        "import equipoise as eq, sys, warnings; warnings.simplefilter('ignore');"
        "print(eq.design(sys.argv[1], span=3, springs=3).mechanism.springs)"
    )
    path = str(Path(__file__).parents[1] / "examples" / "robots" / "ur5.urdf")
    said = [
        subprocess.run(
            [sys.executable, "-c", code, path],
            env=os.environ | {"OPENBLAS_NUM_THREADS": threads},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for threads in ("1", "2")
    ]
    assert said[0] == said[1]
    assert "stiffness" in said[0]


def test_fewer_springs_leave_more():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        search = SpringSearch(Rms(build(Problem.of(robot("ur5"), span=2, radius=0.15))), most=4)
        values = [found.value for found in search.front()]
    assert values == sorted(values, reverse=True)
    assert values[0] < 0.42

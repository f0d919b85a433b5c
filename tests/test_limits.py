"""Heat, friction and limits: against brute force over poses, and the bounds of THEORY section 9 for limited rates."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from robots import planar_arm, robot
from test_states import cycle

import equipoise as eq
from equipoise.energy import Potential
from equipoise.kinematics import Tree
from equipoise.model.errors import InputError
from equipoise.model.goal import Cost, Count, Goal
from equipoise.model.motion import Motion, Where
from equipoise.synthesis.convex.least_squares_form import build
from equipoise.synthesis.convex.peak import peak_poses
from equipoise.synthesis.convex.semidefinite import least_rms
from equipoise.synthesis.score import score

SAMPLES = 40
ARM = planar_arm([1, 2], [0.4, 0.3], [0.2, 0.1])
JOINTS = zip(ARM.joints, (0.5, 0.2), (2.0, 1.0), strict=True)
ARM = replace(
    ARM,
    bodies=tuple(replace(b, inertia=(0.01, 0.02, 0.02, 0, 0, 0)) for b in ARM.bodies),
    joints=tuple(replace(j, friction=f, torque_constant=c, resistance=0.5) for j, f, c in JOINTS),
    workspace=eq.Workspace(SAMPLES),
)
TURN = 2 * np.pi * np.arange(8) / 8
WHOLE = np.stack(np.meshgrid(TURN, TURN), axis=-1).reshape(-1, 2)


def solved(goal: Goal, **options: Any) -> eq.Design:
    design = eq.solve(eq.Problem.of(ARM, span=1, radius=0.2, goal=goal), springs=2, **options)
    assert design.bound is not None
    assert design.bound <= design.residual * (1 + 1e-9)
    found = score(design.mechanism)
    assert (found is None) == (not goal)
    assert found is None or found.value == pytest.approx(design.residual, rel=1e-9)
    return design


def test_heat_is_that_of_the_currents():
    design = solved(Goal(count=Count(heat=True)))
    current = Potential(design.mechanism)(WHOLE).torque / [2.0, 1.0]
    heat = (0.5 * current**2).sum(axis=1).mean()
    assert design.residual**2 == pytest.approx(heat, rel=1e-9)
    found = score(design.mechanism)
    assert found is not None
    assert found.to_dict()["value"] == pytest.approx(heat, rel=1e-9)
    assert f"heat in all motors together: {heat:.4g} W" in str(found)


def test_what_friction_does_not_hold():
    design = solved(Goal(count=Count("peak", friction=True)))
    torque = np.abs(Potential(design.mechanism)(peak_poses(Tree.of(ARM), SAMPLES, 0)).torque)
    assert design.residual == pytest.approx((torque - [0.5, 0.2]).max(), rel=1e-9)


@pytest.mark.parametrize("torque", ["rms", "peak"])
def test_limits_are_kept(torque):
    free = solved(Goal(count=Count(torque)))
    rates = sum(s.stiffness for s in free.mechanism.springs)
    less = solved(Goal(count=Count(torque), cost=Cost(stiffness=rates / 10)))
    assert sum(s.stiffness for s in less.mechanism.springs) <= rates / 10 * (1 + 1e-9)
    assert less.residual > free.residual
    assert less.bound is not None
    assert free.bound is not None
    assert less.bound > free.bound
    assert less.residual <= less.bound + 0.1 * less.unbalanced
    assert (less.exact_feasible, less.infeasible) == (None, None)


def test_energy_is_the_mean_that_is_stored():
    free = solved(Goal())
    stored = float(Potential(free.mechanism)(WHOLE).springs.sum(axis=1).mean())
    less = solved(Goal(cost=Cost(energy=stored / 2)))
    assert Potential(less.mechanism)(WHOLE).springs.sum(axis=1).mean() <= stored / 2 * (1 + 1e-9)
    assert less.bound is not None
    assert free.bound is not None
    assert less.bound >= free.bound


def test_the_number_is_kept():
    design = eq.design(ARM, span=2, radius=0.2, goal=Goal(cost=Cost(springs=1)))
    assert len(design.mechanism.springs) == 1


@pytest.mark.parametrize(("limit", "bound"), [("20 kN/m", 2.368), ("100 kN/m", 2.289)])
def test_bounds_of_limited_rates(limit, bound):
    goal = Goal(poses=Where((cycle(),)), cost=Cost(stiffness=limit))
    reduced = build(eq.Problem.of(robot("ur5"), span=3, radius=0.15, goal=goal))
    assert least_rms(reduced.on(reduced.useful)).value * reduced.unbalanced == pytest.approx(bound, abs=1e-3)


def test_refusals():
    swing = Where((Motion(("joint2",), (0, 1, 2), ((0,), (1,), (0,))),))
    with pytest.raises(InputError, match="friction: does not go with a motion"):
        eq.design(ARM, goal=Goal(poses=swing, count=Count("peak", friction=True)))
    with pytest.raises(InputError, match="friction: does not go with torque rms"):
        Count(friction=True)
    with pytest.raises(InputError, match="heat: does not go with share_of"):
        Count(share_of="effort", heat=True)
    bare = planar_arm([1.0], [0.3], [0.2])
    with pytest.raises(InputError, match="heat: needs the torque_constant and resistance of joint2"):
        eq.design(bare, goal=Goal(count=Count(heat=True)))
    with pytest.raises(InputError, match=r"stiffness: must be a finite number of more than 0"):
        Cost(stiffness=0)

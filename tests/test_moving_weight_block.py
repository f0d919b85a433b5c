"""Weights that a motion has to move: their inertia against the motion's own torques, and what the least mass leaves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_states import ARM, SWING

import equipoise as eq
from equipoise.energy import Potential
from equipoise.energy.inertial import motion_torque
from equipoise.kinematics import Tree
from equipoise.model.goal import Goal
from equipoise.model.motion import Where
from equipoise.synthesis.convex.least_squares_form import build
from equipoise.synthesis.convex.moving_weight_block import MovingWeightBlock
from equipoise.synthesis.convex.semidefinite import least_rms
from equipoise.synthesis.score import score

GOAL = Goal(poses=Where((SWING,)))


def test_it_moves_as_its_mass_does():
    problem = eq.Problem.of(ARM, pairs=[], counterweights=0.2, goal=GOAL)
    assert all(isinstance(block, MovingWeightBlock) for block in problem.blocks)
    tree, block, rng = Tree.of(ARM), problem.blocks[1], np.random.default_rng(0)
    moving = problem.states.moving(tree)
    assert moving is not None
    before, columns = motion_torque(ARM, moving), block.driven(moving)
    q = problem.states.q
    poses, bare = tree.poses(q), Potential(ARM)(q).torque
    still, _ = block.sampled(tree, q, poses, tree.velocities(q, poses))
    for u in rng.uniform(-0.5, 0.5, (4, 3)):
        x, added = 1.3 * block.part(u[None])[0], block.add(ARM, 1.3, u)
        np.testing.assert_allclose(columns @ x, motion_torque(added, moving) - before, atol=1e-10)
        np.testing.assert_allclose(still @ x, Potential(added)(q).torque - bare, atol=1e-10)
        slope = (block.part(u + 1e-6 * np.eye(3)) - block.part(u - 1e-6 * np.eye(3))) / 2e-6
        np.testing.assert_allclose(block.slopes(u[None])[0], slope, atol=1e-8)
        for cone in block.cones():
            value = cone.F @ x
            assert cone.kind == "semidefinite" or (value >= 0).all()


def test_no_weights_and_springs_leave_less_in_the_motion():
    problem = eq.Problem.of(ARM, pairs=[("world", "link2")], radius=0.1, counterweights=0.2, goal=GOAL)
    bound = least_rms(build(problem))
    design = eq.solve(problem, springs=3)
    assert design.bound is not None
    assert design.residual >= design.bound * (1 - 1e-6)
    assert design.residual <= design.bound + 0.02 * design.unbalanced
    found = score(replace(design.mechanism, goal=GOAL))
    assert found is not None
    assert found.value == pytest.approx(design.residual, rel=1e-6)
    rng = np.random.default_rng(1)
    for _ in range(6):
        masses = [
            eq.PointMass(f"w{i}", f"link{i}", float(rng.uniform(0, 2)), (-float(rng.uniform(0, 0.2)), 0, 0))
            for i in (2, 3)
        ]
        other = score(replace(ARM.with_masses(masses), goal=GOAL))
        assert other is not None
        assert other.value >= bound.value * design.unbalanced * (1 - 1e-9)


def test_the_least_mass_for_a_motion():
    design = eq.design(ARM, pairs=[("world", "link2")], radius=0.1, counterweights=0.2, residual="60%", goal=GOAL)
    assert design.counterweights is not None
    assert design.counterweights.mass == pytest.approx(design.counterweights.bound, rel=0.011)
    found = score(replace(design.mechanism, goal=GOAL))
    assert found is not None
    assert found.value <= 0.6 * design.unbalanced * (1 + 1e-3)

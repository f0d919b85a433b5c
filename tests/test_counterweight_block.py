"""A counterweight's torque is that of the same mass, from its series and from samples, and it stays in its ball."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from robots import planar_arm, robot

import equipoise as eq
from equipoise.energy import Potential
from equipoise.energy.fourier.frames import Frames
from equipoise.kinematics import Tree, sample
from equipoise.model.errors import InputError
from equipoise.synthesis.convex.counterweight_block import CounterweightBlock, moving

ARM = planar_arm([1, 2], [0.4, 0.3], [0.2, 0.1])


def weightless(mechanism: eq.Mechanism) -> eq.Mechanism:
    bodies = tuple(replace(body, mass=0.0) for body in mechanism.bodies)
    return replace(mechanism, bodies=bodies, springs=(), masses=())


@pytest.mark.parametrize("mechanism", [ARM, robot("ur5")], ids=["planar", "ur5"])
def test_it_does_what_its_mass_does(mechanism):
    block, rng = CounterweightBlock(mechanism.bodies[-1].name, 0.25), np.random.default_rng(3)
    tree, q = Tree.of(mechanism), sample(Tree.of(mechanism), 20, 1)
    poses = tree.poses(q)
    torque, energy = block.sampled(tree, q, poses, tree.velocities(q, poses))
    series = block.series(Frames(tree))
    for u in rng.uniform(-0.5, 0.5, (3, 3)):
        added = block.add(weightless(mechanism), 1.7, u)
        assert np.linalg.norm(added.masses[0].position) <= 0.25
        own = Potential(added)(q)
        x = 1.7 * block.part(u[None])[0]
        np.testing.assert_allclose(torque @ x, own.torque, atol=1e-12)
        assert energy @ x == pytest.approx(own.gravity.sum(), rel=1e-9)
        phases = np.exp(1j * q @ series.keys[:, : tree.n].T)
        np.testing.assert_allclose((phases @ (series.coef @ x)).real, own.gravity, atol=1e-9)


def test_its_cone_is_the_ball():
    block, rng = CounterweightBlock("link2", 0.2), np.random.default_rng(0)
    (cone,) = block.cones()
    for u in block.project(rng.normal(0, 2, (20, 3))):
        first, *rest = cone.F @ block.part(u[None])[0]
        assert np.linalg.norm(rest) <= first * (1 + 1e-12)
        first, *rest = cone.F @ block.part(1.01 * u[None] / np.linalg.norm(u))[0]
        assert np.linalg.norm(rest) > first  # and no more than the ball
    larger, scale = block.enlarged(3.0)
    assert larger.radius == pytest.approx(0.6)
    assert scale.tolist() == [1, 3, 3, 3]


def test_which_bodies_move():
    assert moving(robot("ur5"))[0] == "shoulder_link"
    assert "base_link" not in moving(robot("ur5"))
    assert [block.body for block in CounterweightBlock.each(ARM, "200 mm")] == ["link2", "link3"]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"lnk2": 0.1}, "did you mean 'link2'"),
        ({"world": 0.1}, "'world' does not move"),
        ({}, "no body is named"),
        (0.0, "must be between"),
        ("3 kg", "length"),
    ],
)
def test_bad_weights(given, message):
    with pytest.raises(InputError, match=message):
        eq.Problem.of(ARM, counterweights=given)

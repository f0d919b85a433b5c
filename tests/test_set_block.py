"""Elements with fixed ends in the program: their torques and series, and never worse than a brute-force grid."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from robots import planar_arm

import equipoise as eq
from equipoise.energy import Potential
from equipoise.energy.fourier.frames import Frames
from equipoise.kinematics import Tree, sample
from equipoise.model.errors import InputError
from equipoise.synthesis.convex.set_block import SetBlock

LAMP = planar_arm([0.4, 0.3, 0.5], [0.4, 0.4, 0.1], [0.2, 0.2, 0.05])
LAMP = replace(LAMP, joints=tuple(replace(joint, range=(-1.0, 1.2)) for joint in LAMP.joints))
ENDS = ("world", (0.05, 0, 0.3), "link2", (0.15, 0, 0))
KINDS = {
    "linear": eq.Spring("x", *ENDS, 100.0),
    "torsion": eq.TorsionSpring("x", (("joint2", 1.0), ("joint3", 1.0)), 2.0, 0.3),
    "gas": eq.LineElement("x", "world", (0, 0, -0.2), "link2", (0.1, 0, 0), eq.laws.Gas(30.0, 0.4, 0.1, None, 1.3)),
    "constant": eq.LineElement("x", *ENDS, eq.laws.ConstantForce(5.0)),
    "torque": eq.JointElement("x", (("joint2", 1.0),), eq.laws.ConstantTorque(-1.0)),
}


@pytest.mark.parametrize("kind", KINDS)
def test_it_does_what_its_element_does(kind):
    mechanism = LAMP.with_springs([KINDS[kind]])
    (block,) = SetBlock.of_file(mechanism, ["x"])
    tree, q = Tree.of(LAMP), sample(Tree.of(LAMP), 20, 1)
    poses = tree.poses(q)
    torque, _ = block.sampled(tree, q, poses, tree.velocities(q, poses))
    bare, rng = Potential(LAMP)(q).torque, np.random.default_rng(0)
    for _ in range(4):
        u, k = rng.uniform(-1, 1, (1, block.shape)), float(rng.uniform(1, 50))
        added = Potential(block.add(LAMP, k, u[0]))(q).torque - bare
        np.testing.assert_allclose(torque @ (k * block.part(u)[0]), added, atol=1e-9)
        (cone,) = block.cones()
        assert (cone.F @ block.part(u)[0] >= -1e-12).all()
    if kind in ("torsion", "torque"):
        series = block.series(Frames(tree))
        x, n, step = block.part(np.zeros((1, block.shape)))[0], tree.n, 1e-5

        def energy(at):
            powers = np.prod(at[:, None] ** series.keys[None, :, n:], axis=2)
            return ((np.exp(1j * at @ series.keys[:, :n].T) * powers) @ (series.coef @ x)).real

        slopes = [(energy(q + step * e) - energy(q - step * e)) / (2 * step) for e in np.eye(n)]
        np.testing.assert_allclose(np.stack(slopes, axis=1), torque @ x, atol=1e-6)


def test_torsion_springs_and_weights_are_never_worse_than_a_grid():
    """Rates, preloads and weights of a lamp with three parallel joints, on a grid, by the reference energy."""
    design = eq.design(LAMP, pairs=[], torsion=["joint2", "joint3"], counterweights={"link3": 0.2}, residual=0.28)
    assert design.counterweights is not None
    assert design.residual <= 0.28 * design.unbalanced * (1 + 1e-5)
    assert design.counterweights.mass >= design.counterweights.bound > 0
    free = eq.Problem.of(LAMP, pairs=[], torsion=["joint2", "joint3"], counterweights={"link3": 0.2})
    best = eq.solve(free)
    assert best.bound is not None
    assert best.residual >= best.bound * (1 - 1e-6)
    assert best.residual <= best.bound + 0.011 * best.unbalanced
    q = sample(Tree.of(LAMP), 3000, 5)
    load = Potential(LAMP)(q).torque
    springs = (eq.TorsionSpring("t", ((f"joint{j}", 1.0),), 1.0, rest) for j in (2, 3) for rest in (0.0, 1.0))
    unit = [Potential(LAMP.with_springs([spring]))(q).torque - load for spring in springs]
    weight = Potential(LAMP.with_masses([eq.PointMass("w", "link3", 1.0, (-0.2, 0, 0))]))(q).torque - load
    least = np.inf
    for k2, r2, k3, r3, m in product((0, 0.5, 1, 2), (0, 3, 6), (0, 0.25, 0.5, 1), (0, 3, 6), (0, 0.4, 0.8, 1.2)):
        left = load + m * weight
        left = left + k2 * (unit[0] + r2 * (unit[1] - unit[0])) + k3 * (unit[2] + r3 * (unit[3] - unit[2]))
        least = min(least, float(np.sqrt((left**2).sum(axis=1).mean())))
    assert least < best.unbalanced
    assert best.bound <= least * 1.01  # of other random poses


def test_what_each_brought(run, tmp_path):
    file = tmp_path / "lamp.yaml"
    strut = replace(KINDS["gas"], name="strut")
    eq.save(LAMP.with_springs([strut]), file)
    code, text, err = run(
        "design", file, "--pairs", "world:link2", "--radius", "100mm", "--tune", "strut", "--torsion", "joint3"
    )
    assert code == 0, err
    assert "strut: without it at least" in text
    assert "torsion joint3: without it at least" in text
    code, text, _ = run("design", file, "--pairs", "world:link2", "--radius", "0.1", "--torsion", "all", "--json")
    answer = json.loads(text)
    assert set(answer["brought"]) == {"torsion joint2", "torsion joint3", "torsion joint4"}
    assert all(left >= answer["bound"] * (1 - 1e-6) for left in answer["brought"].values())


def test_bad_names():
    with pytest.raises(InputError, match="did you mean 'joint2'"):
        eq.Problem.of(LAMP, torsion=["jont2"])
    with pytest.raises(InputError, match="no spring 'y'"):
        eq.Problem.of(LAMP.with_springs([KINDS["gas"]]), tune=["y"])
    spring = eq.LineElement("x", *ENDS, eq.laws.Extension(100.0, 0.05, 1.0))
    with pytest.raises(InputError, match="cannot be designed"):
        eq.Problem.of(LAMP.with_springs([spring]), tune=["x"])

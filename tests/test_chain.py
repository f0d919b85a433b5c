"""The chain that gravity sees: its moments give the energy of random arms; where joints merge, and what is no chain."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from robots import planar_arm, robot
from zoo import counterweight, gantry, lenzo_revolute, lenzo_spherical, mirrored_pair, parallelogram_lamp

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.synthesis.arms.chain import chain, reasons


def random_chain(seed: int, links: int, kinds: tuple[str, ...], on_line: bool = False) -> eq.Mechanism:
    """Random links, hinges with random axes or ball joints, a payload and a body held by a fixed joint.

    With `on_line` every mass centre is on the line to the next joint, ahead of its own joint or a little behind.
    """
    rng = np.random.default_rng(seed)

    def vector(size: float) -> tuple[float, float, float]:
        x, y, z = rng.uniform(-size, size, 3).tolist()
        return x, y, z

    bodies, joints = [], []
    parent, xyz = "world", vector(0.3)
    for i in range(links):
        end = vector(0.5)
        share = float(rng.uniform(-0.2, 1))
        x, y, z = (share * e for e in end)
        bodies.append(eq.Body(f"b{i}", float(rng.uniform(0.5, 3)), (x, y, z) if on_line else vector(0.3)))
        joints.append(eq.Joint(f"j{i}", str(rng.choice(kinds)), parent, f"b{i}", xyz, vector(pi), vector(1)))  # type: ignore[arg-type]
        parent, xyz = f"b{i}", end
    hand = eq.Joint("wrist", "fixed", parent, "hand", xyz, vector(pi))
    return eq.Mechanism(
        "random chain",
        (*bodies, eq.Body("hand", 0.3, vector(0.1))),
        (*joints, hand),
        masses=(eq.PointMass("load", parent, 0.5, vector(0.3)),),
        gravity=vector(10),
        workspace=eq.Workspace(100),
    )


def moment_energy(m: eq.Mechanism, q: np.ndarray) -> np.ndarray:
    """(N,) energy of gravity as the moments of the chain give it [J], but for a constant."""
    found = chain(m)
    tree = Potential(m.with_springs(())).tree
    R, R0 = tree.poses(q).R, tree.poses(np.zeros((1, tree.n))).R[0]
    moved = sum(R[:, (i := tree.index[link.body])] @ (R0[i].T @ link.moment) for link in found.links)
    return found.weight * moved @ found.up


def spread(m: eq.Mechanism) -> tuple[float, float]:
    """How much the energy by moments less the true one varies over random poses, and the true one [J]."""
    q = np.random.default_rng(0).uniform(-pi, pi, (50, len(m.coordinates)))
    true = Potential(m.with_springs(()))(q).gravity
    return float(np.ptp(moment_energy(m, q) - true)), float(np.ptp(true))


@settings(derandomize=True, deadline=None, max_examples=40)
@given(
    seed=st.integers(0, 10**6),
    links=st.integers(1, 4),
    kinds=st.sampled_from([("revolute",), ("spherical", "revolute")]),
)
def test_the_moments_give_the_energy(seed, links, kinds):
    m = random_chain(seed, links, kinds)
    assert reasons(m) == []
    error, scale = spread(m)
    assert error < 1e-12 * scale


@pytest.mark.parametrize("known", [lenzo_spherical, lenzo_revolute])
def test_the_arm_of_lenzo(known):
    """Three hinges through one point are as good as a ball joint."""
    m = known().mechanism
    found = chain(m)
    assert (found.base, [link.body for link in found.links]) == ("world", ["upper arm", "forearm"])
    upper, fore = found.links
    np.testing.assert_allclose(upper.moment, (2 * 0.15 + 1.2 * 0.3, 0, 0), atol=1e-15)
    np.testing.assert_allclose(fore.moment, (1.2 * 0.12, 0, 0), atol=1e-15)
    assert upper.length == pytest.approx((0.3, 0, 0), abs=1e-15)
    assert (upper.free, fore.free) == (True, False)
    assert not upper.off_line(found.near)
    assert spread(m)[0] < 1e-13


@pytest.mark.parametrize(("offset", "base"), [(0.0, "world"), (0.1, "turret")])
def test_upright_links_are_ground(offset, base):
    """A turret that turns about the vertical needs no spring, heavy or not; the arm beside its axis stands on it."""
    m = lenzo_revolute().mechanism
    turret = replace(m.bodies[0], mass=5.0, com=(0.1, 0.2, 0.3))
    pitch = replace(m.joints[1], xyz=(offset, 0.0, 0.4))
    m = replace(m, bodies=(turret, *m.bodies[1:]), joints=(m.joints[0], pitch, *m.joints[2:]))
    found = chain(m)
    assert found.base == base
    assert [link.body for link in found.links] == ["upper arm", "forearm"]
    np.testing.assert_allclose(found.links[0].centre, (offset, 0, 0.4), atol=1e-15)
    assert found.links[0].free == (offset == 0)
    assert spread(m)[0] < 1e-13


def test_the_far_centre_is_in_line_with_the_mass_where_it_can_be():
    """The elbow's origin is 80 mm along its hinge from the plane of the arm: another point of the axis is as good."""
    m = lenzo_spherical().mechanism
    elbow, fore = replace(m.joints[1], xyz=(0.3, 0.08, 0.0)), replace(m.bodies[1], com=(0.12, -0.08, 0.0))
    m = replace(m, joints=(m.joints[0], elbow), bodies=(m.bodies[0], fore))
    found = chain(m)
    assert found.links[0].length == pytest.approx((0.3, 0, 0), abs=1e-15)
    assert not found.links[0].off_line(found.near)


def test_what_is_beyond_the_last_moment_is_not_loaded():
    m = planar_arm([1.0, 1.0, 1.0], [0.3, 0.3, 0.2], [0.1, 0.1, 0.0])
    found = chain(m)
    assert len(found.links) == 3
    assert [link.body for link in found.loaded] == ["link2", "link3"]


def test_bodies_that_are_fixed_together_are_one_link():
    m = lenzo_spherical().mechanism
    hand = eq.Joint("wrist", "fixed", "forearm", "hand", (0.25, 0, 0))
    m = replace(m, bodies=(*m.bodies, eq.Body("hand", 0.4, (0.05, 0, 0))), joints=(*m.joints, hand))
    found = chain(m)
    assert len(found.links) == 2
    assert found.links[1].moment == pytest.approx((1.2 * 0.12 + 0.4 * 0.3, 0, 0))


@pytest.mark.parametrize(
    ("mechanism", "reason"),
    [
        (mirrored_pair().mechanism, "coupled"),
        (gantry().mechanism, "is prismatic"),
        (parallelogram_lamp().mechanism, "is parallelogram"),
        (counterweight().mechanism, "gravity loads no joint"),
        (replace(lenzo_spherical().mechanism, gravity=(0.0, 0.0, 0.0)), "no gravity"),
        (robot("human"), "it branches"),
        (robot("xarm7"), "links 'link5' and 'link6' turn about one point, but the mass between is off it"),
    ],
)
def test_no_chain(mechanism, reason):
    assert any(reason in text for text in reasons(mechanism))

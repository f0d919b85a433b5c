"""Cams in the convex program: what any could bring, against a projection by hand; and the profile of one on a sum."""

from __future__ import annotations

from dataclasses import replace
from math import radians

import numpy as np
import pytest
from robots import planar_arm
from test_cam import entry, judged

import equipoise as eq
from equipoise.energy import Potential
from equipoise.energy.fourier.frames import Frames
from equipoise.kinematics import Tree, sample
from equipoise.model.errors import InputError
from equipoise.synthesis.convex.cam_block import HARMONICS, CamBlock
from equipoise.synthesis.convex.least_squares_form import build
from equipoise.synthesis.convex.semidefinite import least_rms

ARM = planar_arm([2, 1.5], [0.4, 0.3], [0.2, 0.15])
FIRST, SECOND = (joint.name for joint in ARM.joints)


def within(low: float, high: float) -> eq.Mechanism:
    joints = tuple(replace(joint, range=(radians(low), radians(high))) for joint in ARM.joints)
    return replace(ARM, joints=joints)


def test_its_series_is_what_it_does_at_poses() -> None:
    block, tree = CamBlock(((FIRST, 1.0), (SECOND, -1.0))), Tree.of(ARM)
    q = sample(tree, 40)
    poses = tree.poses(q)
    torque, energy = block.sampled(tree, q, poses, tree.velocities(q, poses))
    form = block.series(Frames(tree))
    turned = np.exp(1j * q @ form.keys[:, : tree.n].T)
    assert energy == pytest.approx((turned @ form.coef).real.sum(axis=0), abs=1e-12)
    slopes = np.einsum("nt,tj,tu->nju", turned, 1j * form.keys[:, : tree.n], form.coef).real
    np.testing.assert_allclose(torque, slopes, atol=1e-12)


@pytest.mark.parametrize("limits", [(-180, 180), (-50, 70)])
def test_the_bound_of_a_cam_is_the_projection_of_the_torque(limits: tuple[float, float]) -> None:
    mechanism = within(*limits)
    value = least_rms(build(eq.Problem(mechanism, (), beside=(CamBlock(((SECOND, 1.0),)),)))).value
    # on a grid of both angles, by ordinary least squares
    low, high = np.radians(limits)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    grid = (low + high) / 2 + (high - low) / 2 * nodes
    q = np.stack(np.meshgrid(grid, grid, indexing="ij"), axis=-1).reshape(-1, 2)
    root = np.sqrt(np.outer(weights, weights).ravel())
    load = Potential(mechanism)(q).torque
    n = np.arange(1, HARMONICS + 1)
    columns = np.hstack([np.sin(q[:, 1:] * n), np.cos(q[:, 1:] * n)]) * root[:, None]
    left = load[:, 1] * root - columns @ np.linalg.lstsq(columns, load[:, 1] * root, rcond=None)[0]
    rest = (left @ left + (load[:, 0] * root) @ (load[:, 0] * root)) / np.square(load * root[:, None]).sum()
    assert value == pytest.approx(np.sqrt(rest), rel=1e-6)


def test_a_spring_and_a_pulley_on_a_sum_of_joints_balance_an_arm_and_the_pulley_gets_its_profile() -> None:
    mechanism = within(-30, 25)
    sum_of = f"{FIRST}+{SECOND}"
    without = eq.design(mechanism, pairs=[("world", "link2")])
    assert without.residual > 0.05 * without.unbalanced
    both = eq.design(mechanism, pairs=[("world", "link2")], cams=[sum_of], exact=True)
    assert both.balance.exact
    assert both.free_parameters["cams"] == [f"cam on {FIRST} + {SECOND}"]
    cam = both.mechanism.springs[-1]
    made = eq.design(both.mechanism, "cam", profile_of=cam.name)
    assert made.balance.exact
    assert made.mechanism.springs[0] == both.mechanism.springs[0]
    angles = np.radians(np.linspace(-60, 50, 31))
    torque = 1.5 * 9.81 * 0.15 * np.cos(angles)  # of the second link, whose direction is the sum
    assert np.abs(judged(entry(made), angles) + torque).max() < 0.005 * torque.max()
    # the same from the load alone, the spring staying
    kept = mechanism.with_springs(both.mechanism.springs[:1])
    again = eq.design(kept, "cam", joint=sum_of, keep=True)
    assert again.residual < 1e-8 * again.unbalanced


def test_the_best_cam_of_a_joint_of_an_arm_is_that_of_the_bound() -> None:
    mechanism = within(-40, 60)
    problem = eq.Problem(mechanism, (), beside=(CamBlock(((SECOND, 1.0),)),))
    bound = least_rms(build(problem)).value
    joint = eq.design(mechanism, "cam", joint=SECOND, follower="roller", size=0.3)
    assert joint.residual / joint.unbalanced == pytest.approx(bound, rel=0.02)  # random poses


def test_a_joint_that_is_not_there_is_named() -> None:
    with pytest.raises(InputError, match=r"cams: no revolute joint 'elbw'"):
        eq.Problem.of(ARM, cams=["elbw"])
    with pytest.raises(InputError, match="is there twice"):
        eq.Problem.of(ARM, cams=[FIRST, FIRST])
    with pytest.raises(InputError, match="there is no cam"):
        eq.design(ARM, "cam", profile_of="elbow")

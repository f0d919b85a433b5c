"""Poses against a slow reference, velocities against differences of poses, random configurations inside the ranges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_mechanisms import random_mechanism, random_poses
from scipy.spatial.transform import Rotation
from zoo import ZOO, geared_pair

from equipoise.kinematics import Tree, sample
from equipoise.kinematics.sampling import bounds, inside
from equipoise.model.errors import InputError
from equipoise.model.mechanism import Body, Coupling, Joint, Mechanism

SlowPoses = dict[str, tuple[np.ndarray, np.ndarray]]


def slow_values(m: Mechanism, q: np.ndarray) -> dict[str, float]:
    """The value of every coordinate and of every coupled joint, by the definition of a coupling."""
    values = dict(zip(m.coordinates, map(float, q), strict=True))
    couplings = {coupling.joint: coupling for coupling in m.couplings}

    def value(name: str) -> float:
        if name not in values:
            values[name] = couplings[name].offset + sum(ratio * value(other) for other, ratio in couplings[name].terms)
        return values[name]

    for name in couplings:
        value(name)
    return values


def slow_poses(m: Mechanism, q: np.ndarray) -> SlowPoses:
    """R_WB and p_WB of every body at one configuration, body by body, by the definition of the joints."""
    values = slow_values(m, q)
    holder = {joint.child: joint for joint in m.joints}
    poses: SlowPoses = {"world": (np.eye(3), np.zeros(3))}

    def pose(body: str) -> tuple[np.ndarray, np.ndarray]:
        if body not in poses:
            j = holder[body]
            R_WP, p_WP = pose(j.parent)
            R_base = pose(j.follows)[0] if j.follows is not None else R_WP
            R, p = Rotation.from_euler("xyz", j.rpy).as_matrix(), np.array(j.xyz)
            axis = np.array(j.axis) / np.linalg.norm(j.axis)
            turn = np.eye(3)
            if j.type == "revolute":
                turn = Rotation.from_rotvec(values[j.name] * axis).as_matrix()
            elif j.type == "spherical":
                turn = Rotation.from_euler("XYZ", [values[f"{j.name}.{letter}"] for letter in "xyz"]).as_matrix()
            elif j.type == "prismatic":
                p = p + values[j.name] * R @ axis
            poses[body] = R_base @ R @ turn, p_WP + R_WP @ p
        return poses[body]

    return {body: pose(body) for body in m.body_names}


@pytest.mark.parametrize("seed", range(100))
def test_poses(seed: int) -> None:
    m = random_mechanism(seed)
    q = random_poses(m, 3, seed)
    poses = Tree.of(m).poses(q)
    for i in range(len(q)):
        expected = slow_poses(m, q[i])
        for body, name in enumerate(m.body_names):
            np.testing.assert_allclose(poses.R[i, body], expected[name][0], atol=1e-13)
            np.testing.assert_allclose(poses.p[i, body], expected[name][1], atol=1e-12)
            point = np.array([0.1, -0.2, 0.3])
            there = expected[name][1] + expected[name][0] @ point
            np.testing.assert_allclose(poses.point(body, point)[i], there, atol=1e-12)


@pytest.mark.parametrize("seed", range(60))
def test_velocities_are_the_derivatives_of_the_poses(seed: int) -> None:
    """Central differences: the error is small, and halving the step quarters it."""
    m = random_mechanism(seed)
    tree = Tree.of(m)
    q = random_poses(m, 2, seed)
    poses = tree.poses(q)
    velocities = tree.velocities(q, poses)
    point = np.array([0.3, 0.1, -0.2])
    for j in range(tree.n):
        errors = []
        for h in (2e-3, 1e-3):
            step = h * np.eye(tree.n)[j]
            up, down = tree.poses(q + step), tree.poses(q - step)
            error = 0.0
            for body in range(len(tree.names)):
                slope = (up.point(body, point) - down.point(body, point)) / (2 * h)
                error = max(error, np.abs(slope - velocities.point(poses, body, point)[:, :, j]).max())
                spin = (up.R[:, body] - down.R[:, body]) / (2 * h) @ np.swapaxes(poses.R[:, body], 1, 2)
                w = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=1)
                error = max(error, np.abs(w - velocities.w[:, body, :, j]).max())
            errors.append(error)
        assert errors[0] < 1e-3
        if errors[1] > 1e-10:  # less is rounding: a slide has no error at all
            assert 1.9 < np.log2(errors[0] / errors[1]) < 2.1


def test_couplings_of_couplings() -> None:
    joints = [Joint(f"j{i}", "revolute" if i else "prismatic", "world", f"b{i}") for i in range(4)]
    couplings = (Coupling("j3", (("j2", 2.0), ("j0", -1.0)), 0.1), Coupling("j2", (("j1", -0.5), ("j0", 3.0)), 0.2))
    tree = Tree.of(Mechanism("m", tuple(Body(f"b{i}") for i in range(4)), tuple(joints), couplings))
    assert tree.coordinates == ("j0", "j1")
    np.testing.assert_allclose(tree.C, [[1, 0], [0, 1], [3, -0.5], [5, -1]])
    np.testing.assert_allclose(tree.s0, [0, 0, 0.2, 0.5])
    assert tree.turns.tolist() == [False, True]


def test_an_axis_of_any_length() -> None:
    m = ZOO["exact_pendulum"]().mechanism
    q = np.array([[0.7]])
    for length in (1e-320, 1e-200, 1.0, 1e200, 1e308):
        joint = replace(m.joints[0], axis=(0.0, -length, 0.0))
        R = Tree.of(replace(m, joints=(joint,))).poses(q).R
        np.testing.assert_allclose(R, Tree.of(m).poses(q).R, atol=1e-15)


def test_samples_are_inside_and_reproducible() -> None:
    tried = 0
    for seed in range(40):
        m = random_mechanism(seed)
        tree = Tree.of(m)
        try:
            q = sample(tree, 200, seed)
        except InputError:
            continue  # contradictory ranges, see below
        tried += 1
        assert q.shape == (200, tree.n)
        assert inside(tree, q).all()
        np.testing.assert_array_equal(q, sample(tree, 200, seed))
        lower, upper = bounds(tree)
        assert ((q >= lower) & (q <= upper)).all()
        for pose in q[:5]:
            values = slow_values(m, pose)
            for joint in m.joints:
                if joint.range is not None:
                    assert joint.range[0] - 1e-9 <= values[joint.name] <= joint.range[1] + 1e-9
    assert tried > 30


def coupled(lower: float, upper: float) -> Mechanism:
    """A driver within +-3 rad and a joint that turns minus twice as far, plus one radian."""
    m = geared_pair(-2.0, 1.0)
    left, right = m.joints
    return replace(m, joints=(replace(left, range=(-3.0, 3.0)), replace(right, range=(lower, upper))))


def test_the_range_of_a_coupled_joint_is_respected() -> None:
    q = sample(Tree.of(coupled(-0.2, 0.6)), 1000)  # 1 - 2 q within -0.2 to 0.6
    assert 0.2 <= q.min() < 0.21
    assert 0.59 < q.max() <= 0.6


@pytest.mark.parametrize("limits", [(7.5, 9.0), (8.0, 8.0), (-6.0, -5.5), (6.9999999, 7.0)])
def test_contradictory_ranges(limits: tuple[float, float]) -> None:
    with pytest.raises(InputError, match=r"right pivot.*exclude nearly every configuration"):
        sample(Tree.of(coupled(*limits)), 1000)


def test_a_joint_locked_outside_its_range() -> None:
    m = replace(geared_pair(), couplings=(Coupling("right pivot", (), 0.7),))
    left, right = m.joints
    assert len(sample(Tree.of(replace(m, joints=(left, replace(right, range=(0.0, 1.0))))), 10)) == 10
    with pytest.raises(InputError, match="right pivot"):
        sample(Tree.of(replace(m, joints=(left, replace(right, range=(0.0, 0.5))))), 10)


def test_an_unlimited_angle_turns_the_slowest_joint_once() -> None:
    """A motor with a 1:100 gear: half a turn either way of the motor would leave the link where it is."""
    lower, upper = bounds(Tree.of(geared_pair(0.01)))
    np.testing.assert_allclose([lower[0], upper[0]], [-100 * np.pi, 100 * np.pi])
    np.testing.assert_allclose(bounds(Tree.of(geared_pair(2.0)))[1], [np.pi])
    np.testing.assert_allclose(bounds(Tree.of(geared_pair(1e-17)))[1], [np.pi])  # that is rounding, not a gear


def test_nothing_to_move() -> None:
    for m in (Mechanism("m"), Mechanism("m", (Body("a"),), (Joint("j", "fixed", "world", "a", (1, 2, 3)),))):
        tree = Tree.of(m)
        q = sample(tree, 5)
        assert q.shape == (5, 0)
        poses = tree.poses(q)
        assert tree.velocities(q, poses).v.shape == (5, len(tree.names), 3, 0)
        np.testing.assert_array_equal(poses.p[:, -1], np.tile([1, 2, 3] if m.bodies else [0, 0, 0], (5, 1)))

"""What it takes to move against MuJoCo's inverse dynamics: trees of hinges and slides, payloads, spring mass."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from random_mechanisms import random_mechanism, random_poses

import equipoise as eq
from equipoise.energy import Potential
from equipoise.energy.inertial import motion_torque
from equipoise.io import mjcf
from equipoise.kinematics import Tree
from equipoise.kinematics.moving import Moving
from equipoise.model.errors import EquipoiseWarning

KINDS = ("revolute", "revolute", "prismatic", "fixed")


@pytest.mark.parametrize("seed", [0, 3, 7, 11])
def test_it_is_mujocos(seed):
    m = random_mechanism(seed, kinds=KINDS)
    bodies = tuple(replace(b, inertia=b.inertia or (0.03, 0.04, 0.05, 0, 0, 0), mass=b.mass or 0.5) for b in m.bodies)
    joints = tuple(replace(j, damping=0.3) if j.type in ("revolute", "prismatic") else j for j in m.joints)
    m = replace(m, bodies=bodies, joints=joints)
    tree, rng = Tree.of(m), np.random.default_rng(seed)
    assert tree.n
    q = random_poses(m, 4, seed)
    rate, acceleration = rng.normal(size=(2, *q.shape))
    found = motion_torque(m, Moving.of(tree, q, rate, acceleration)) + Potential(m)(q).torque
    model = mujoco.MjModel.from_xml_string(mjcf.to_text(m))
    model.dof_armature[:] = 0
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data = mujoco.MjData(model)
    T = np.stack([tree.C[tree.rows[model.joint(i).name]] for i in range(model.njnt)])
    s0 = np.array([tree.s0[tree.rows[model.joint(i).name]] for i in range(model.njnt)])
    for i in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = T @ q[i] + s0, T @ rate[i], T @ acceleration[i]
        mujoco.mj_inverse(model, data)
        expected = T.T @ data.qfrc_inverse
        assert found[i] == pytest.approx(expected, abs=1e-9 * max(1.0, float(np.abs(expected).max())))


@pytest.mark.slow(reason="a loop is compiled")
def test_a_loop_moves_as_energy_says():
    """Power of the torque is the rate of kinetic energy, by differences of it, for a mechanism with a loop."""
    four_bar = eq.load("examples/mechanisms/four_bar.yaml")
    bodies = tuple(replace(b, inertia=(0.01, 0.02, 0.03, 0, 0, 0)) for b in four_bar.bodies)
    m = replace(four_bar, bodies=bodies)
    tree = Tree.of(m)

    def at(t: float) -> tuple[np.ndarray, ...]:
        w = np.arange(1, tree.n + 1)
        return (
            tree.rest + 0.1 * np.sin(w * t)[None],
            (0.1 * w * np.cos(w * t))[None],
            (-0.1 * w**2 * np.sin(w * t))[None],
        )

    def kinetic(t: float) -> float:
        moving = Moving.of(tree, *at(t))
        total = 0.0
        for body in m.bodies:
            i = tree.index[body.name]
            R, turn = moving.poses.R[0, i], moving.turn[0, i]
            v = (moving.velocities.point(moving.poses, i, np.array(body.com)) @ moving.rate[0])[0]
            total += body.mass * v @ v / 2 + turn @ R @ np.diag((body.inertia or (0, 0, 0))[:3]) @ R.T @ turn / 2
        return total

    q, rate, acceleration = at(0.7)
    power = float((motion_torque(m, Moving.of(tree, q, rate, acceleration)) @ rate[0])[0])
    assert power == pytest.approx((kinetic(0.7 + 1e-4) - kinetic(0.7 - 1e-4)) / 2e-4, rel=1e-5)


def test_a_missing_inertia_is_said():
    arm = eq.Mechanism(
        "arm", (eq.Body("arm", 2.0, (0.3, 0, 0)),), (eq.Joint("hinge", "revolute", "world", "arm", axis=(0, 1, 0)),)
    )
    one = np.ones((1, 1))
    with pytest.warns(EquipoiseWarning, match="no inertia is known of arm"):
        torque = motion_torque(arm, Moving.of(Tree.of(arm), one, one, one))
    assert torque == pytest.approx(2.0 * 0.3**2)

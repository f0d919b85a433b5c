"""Energy and torque against a slow reference, MuJoCo and Pinocchio, finite differences, and what must not matter."""

# pyright: reportAttributeAccessIssue=false
# (the names of MuJoCo and Pinocchio come from compiled modules that ship no type stubs)

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from campaign import campaign
from in_mujoco import mujoco_state
from in_pinocchio import pin, pinocchio_model
from random_mechanisms import random_mechanism, random_poses
from rewritten import in_another_world, relabelled, swapped_ends
from scipy.spatial.transform import Rotation
from slow_reference import slow_energy, slow_values
from zoo import EXACT, PENDULUM_K, pendulum

from equipoise.energy import Potential
from equipoise.io import mjcf
from equipoise.kinematics import Tree
from equipoise.model.elements import Spring
from equipoise.model.errors import UnsupportedError
from equipoise.model.mechanism import Body, Joint, Mechanism


@pytest.mark.parametrize("seed", range(100))
def test_energy(seed: int) -> None:
    m = random_mechanism(seed)
    q = random_poses(m, 3, seed)
    state = Potential(m)(q)
    for i in range(len(q)):
        gravity, springs, lengths = slow_energy(m, q[i])
        assert state.gravity[i] == pytest.approx(gravity, rel=1e-12, abs=1e-11)
        np.testing.assert_allclose(state.springs[i], springs, rtol=1e-11, atol=1e-11)
        np.testing.assert_allclose(state.path[i], lengths, rtol=1e-12, atol=1e-13)
        assert state.energy[i] == pytest.approx(gravity + sum(springs), rel=1e-12, abs=1e-10)


@pytest.mark.parametrize("seed", range(80))
def test_torque_is_the_derivative_of_the_energy(seed: int) -> None:
    """The work of moving is the torque times the way: central differences, of second order in the step."""
    m = random_mechanism(seed)
    potential = Potential(m)
    rng = np.random.default_rng(seed)
    for q in random_poses(m, 3, seed):
        v = rng.normal(size=len(q))
        v /= max(1.0, float(np.linalg.norm(v)))
        parts = ("gravity_torque", "spring_torque")
        for energy, part in zip((lambda s: s.gravity[0], lambda s: s.springs[0].sum()), parts, strict=True):
            errors = []
            for h in (2e-3, 1e-3):
                work = energy(potential(q + h * v)) - energy(potential(q - h * v))
                errors.append(abs(work / (2 * h) - float((getattr(potential(q), part) @ v)[0])))
            size = 1 + abs(energy(potential(q)))
            assert errors[0] < 1e-3 * size
            if errors[1] > 1e-9 * size:  # less is rounding, or an accident of the direction
                assert 1.7 < np.log2(errors[0] / errors[1]) < 2.3


# MuJoCo --------------------------------------------------------------------------------------------------------------


@campaign(20_000)
def test_mechanisms_agree_with_mujoco(seeds: range) -> None:
    done, with_parallelogram, with_ball, with_coupling = 0, 0, 0, 0
    for seed in seeds:
        m = random_mechanism(seed)
        try:
            model = mujoco.MjModel.from_xml_string(mjcf.to_text(m))
        except UnsupportedError:
            continue  # a ball between what a parallelogram joins and what it follows
        done += 1
        kinds = {joint.type for joint in m.joints}
        with_parallelogram += "parallelogram" in kinds
        with_ball += "spherical" in kinds
        with_coupling += bool(m.couplings)
        q = random_poses(m, 3, seed)
        state = Potential(m)(q)
        found = [mujoco_state(m, model, pose) for pose in q]
        # MuJoCo's energy leaves out what is fixed to the world, a constant
        energy = state.energy - np.array([energy for energy, _, _ in found])
        size = np.abs(state.gravity).max() + np.abs(state.springs).sum(axis=1).max()
        # a massless body weighs 1e-13 kg there, and 1e-9 of `least` is what that does over the reach
        reach = max(1.0, 2 * np.abs(Tree.of(m).poses(q).p).max())
        massless = sum(body.mass == 0 for body in m.bodies)
        least = max(1e-3, 1e-4 * float(np.linalg.norm(m.gravity)) * reach * massless)
        assert np.ptp(energy) <= 1e-9 * max(size, least), seed
        torque = np.hstack([state.gravity_torque, state.spring_torque])
        expected = np.array([np.hstack(parts) for _, *parts in found]).reshape(torque.shape)
        assert np.abs(torque - expected).max(initial=0) <= 1e-9 * max(np.abs(expected).max(initial=0), least), seed
    assert done > 0.8 * len(seeds)
    assert min(with_parallelogram, with_ball, with_coupling) > 0.16 * len(seeds)


# Pinocchio -----------------------------------------------------------------------------------------------------------


@campaign(20_000)
def test_gravity_agrees_with_pinocchio(seeds: range) -> None:
    for seed in seeds:
        m = random_mechanism(seed, kinds=("fixed", "revolute", "prismatic", "spherical"))
        model, names = pinocchio_model(m)
        data = model.createData()
        q = random_poses(m, 3, seed)
        state = Potential(m)(q)
        energies = []
        for i, pose in enumerate(q):
            start = slow_values(m, np.zeros(len(pose)))
            s = slow_values(m, pose)
            unit = [slow_values(m, row) for row in np.eye(len(pose))]
            T = np.array([[one[name] - start[name] for one in unit] for name in names]).reshape(len(names), len(pose))
            values = np.zeros(model.nq)
            for k, name in enumerate(names):
                values[model.joints[model.getJointId(name)].idx_q] = s[name]
                assert model.joints[model.getJointId(name)].idx_v == k
            torque = T.T @ pin.computeGeneralizedGravity(model, data, values)
            size = max(np.abs(torque).max(initial=0), 1e-2)
            np.testing.assert_allclose(state.gravity_torque[i], torque, atol=1e-10 * size, rtol=0)
            energies.append(pin.computePotentialEnergy(model, data, values))
        # Pinocchio leaves out what is fixed to the world, a constant
        assert np.ptp(state.gravity - np.array(energies)) <= 1e-10 * max(np.abs(state.gravity).max(), 1e-2), seed


# What must not matter ------------------------------------------------------------------------------------------------


def assert_same(m: Mechanism, other: Mechanism, seed: int) -> None:
    """The same torques and lengths at the same configurations, and energies that differ by a constant at most."""
    q = random_poses(m, 4, seed)
    order = [m.coordinates.index(name) for name in other.coordinates]
    a, b = Potential(m)(q), Potential(other)(q[:, order])
    for part in ("gravity_torque", "spring_torque"):
        first, second = getattr(a, part)[:, order], getattr(b, part)
        np.testing.assert_allclose(second, first, rtol=0, atol=1e-12 * (10 + np.abs(first).max(initial=0)))
    np.testing.assert_allclose(b.springs, a.springs, rtol=1e-11, atol=1e-10)
    np.testing.assert_allclose(b.path, a.path, rtol=1e-11, atol=1e-12)
    assert np.ptp(b.gravity - a.gravity) <= 1e-11 * (1 + np.abs(a.gravity).max())


@pytest.mark.parametrize("seed", range(40))
def test_where_the_world_is_does_not_matter(seed: int) -> None:
    rng = np.random.default_rng(seed)
    m = random_mechanism(seed)
    assert_same(m, in_another_world(m, Rotation.random(rng=rng).as_matrix(), rng.uniform(-2, 2, 3)), seed)


@pytest.mark.parametrize("seed", range(60))
def test_where_a_body_frame_is_does_not_matter(seed: int) -> None:
    rng = np.random.default_rng(seed)
    m = random_mechanism(seed)
    assert_same(m, relabelled(m, f"b{rng.integers(len(m.bodies))}", rng), seed)


@pytest.mark.parametrize("seed", range(40))
def test_which_end_comes_first_does_not_matter(seed: int) -> None:
    m = random_mechanism(seed)
    assert_same(m, swapped_ends(m), seed)


@pytest.mark.parametrize("seed", range(40))
def test_the_order_in_the_file_does_not_matter(seed: int) -> None:
    rng = np.random.default_rng(seed)
    m = random_mechanism(seed)
    bodies = tuple(m.bodies[i] for i in rng.permutation(len(m.bodies)))
    joints = tuple(m.joints[i] for i in rng.permutation(len(m.joints)))
    couplings = m.couplings[::-1]
    assert_same(m, replace(m, bodies=bodies, joints=joints, couplings=couplings, masses=m.masses[::-1]), seed)


@pytest.mark.parametrize("seed", range(20))
def test_scaling(seed: int) -> None:
    """Masses and stiffnesses times s: energies and torques times s. Lengths times s: the gravity part times s."""
    m, s = random_mechanism(seed), 3.7
    heavier = replace(
        m,
        bodies=tuple(replace(body, mass=s * body.mass) for body in m.bodies),
        masses=tuple(replace(mass, mass=s * mass.mass) for mass in m.masses),
        springs=tuple(replace(k, mass=s * k.mass, stiffness=s * k.stiffness) for k in m.springs),
    )
    q = random_poses(m, 4, seed)
    a, b = Potential(m)(q), Potential(heavier)(q)
    for part in ("gravity", "springs", "gravity_torque", "spring_torque"):
        size = np.abs(getattr(a, part)).max(initial=0)
        np.testing.assert_allclose(getattr(b, part), s * getattr(a, part), rtol=1e-12, atol=1e-13 * size)
    np.testing.assert_array_equal(a.path, b.path)


# Known answers -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", EXACT)
def test_the_zoo_is_balanced_everywhere(name: str) -> None:
    known = EXACT[name]()
    assert known.energy is not None
    state = Potential(known.mechanism)(random_poses(known.mechanism, 500))
    size = max(np.ptp(state.gravity), 1.0)
    np.testing.assert_allclose(state.energy, known.energy, atol=1e-12 * size, rtol=1e-13)
    assert np.abs(state.torque).max() <= 1e-12 * size


def test_sign_conventions() -> None:
    """At rest the arm points along x: holding 2 kg at 0.3 m takes +5.886 N m about the axis that lifts."""
    state = Potential(pendulum())([0.0])
    assert state.gravity_torque[0, 0] == pytest.approx(5.886, rel=1e-15)
    assert state.spring_torque[0, 0] == pytest.approx(-5.886, rel=1e-15)
    assert state.gravity[0] == pytest.approx(0)
    assert state.springs[0, 0] == pytest.approx(PENDULUM_K / 2 * (0.2**2 + 0.15**2), rel=1e-15)
    assert Potential(pendulum())([np.pi / 2]).gravity[0] == pytest.approx(2 * 9.81 * 0.3, rel=1e-15)


def test_a_spring_shorter_than_its_free_length_pushes() -> None:
    slide = Joint("slide", "prismatic", "world", "block", axis=(1.0, 0.0, 0.0))
    spring = Spring("s", "world", (0, 0, 0), "block", (0, 0, 0), 100.0, 0.5)
    potential = Potential(Mechanism("m", (Body("block"),), (slide,), springs=(spring,)))
    assert potential([0.2]).spring_torque[0, 0] == pytest.approx(-30)  # held back, it would move away
    assert potential([0.7]).spring_torque[0, 0] == pytest.approx(20)
    assert potential([-0.2]).spring_torque[0, 0] == pytest.approx(30)
    assert potential([0.0]).spring_torque[0, 0] == 0  # no direction: none is taken
    assert potential([0.0]).springs[0, 0] == pytest.approx(12.5)


def test_batches_are_the_same_as_poses_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    m = random_mechanism(3)
    q = random_poses(m, 50)
    whole = Potential(m)(q)
    monkeypatch.setattr("equipoise.energy.reference.CHUNK_ENTRIES", 1)
    for part in ("gravity", "springs", "path", "gravity_torque", "spring_torque"):
        np.testing.assert_allclose(getattr(Potential(m)(q), part), getattr(whole, part), rtol=1e-13, atol=1e-13)
    assert Potential(m)(q[:0]).energy.shape == (0,)
    with pytest.raises(ValueError, match="expected"):
        Potential(m)(q[:, :-1])


def test_coordinates_are_in_the_order_of_the_file() -> None:
    for seed in range(20):
        m = random_mechanism(seed)
        assert Tree.of(m).coordinates == m.coordinates
        assert [c.turns for c in m.coordinates] == Tree.of(m).turns.tolist()

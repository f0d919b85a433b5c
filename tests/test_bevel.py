"""The method `bevel`: the paper's equations, exact on random shoulders, payload, friction, gears; what it refuses."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

import warnings
from dataclasses import replace
from math import pi
from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from in_mujoco import set_pose
from robots import lee_chen, robot
from scipy.spatial.transform import Rotation
from zoo import counterweight, exact_pendulum

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.io import mjcf
from equipoise.model.errors import EquipoiseWarning, InfeasibleError, InputError, UnsupportedError
from equipoise.reproduce.cho2012 import arm as shoulder
from equipoise.synthesis import METHODS
from equipoise.synthesis.arms.shoulder import find
from equipoise.synthesis.bevel import differential as d

THETA = np.random.default_rng(0).uniform(-pi, pi, (200, 2))
WEIGHT, B, H, K = 10.0, 0.05, 0.07, 900.0
ATOL = 1e-12


def triple(v: np.ndarray) -> tuple[float, float, float]:
    x, y, z = v.tolist()
    return x, y, z


def random_shoulder(seed: int, yaw: bool = False, simple: bool = False) -> eq.Mechanism:
    """Any frames, phases, masses and directions: an upright base that may yaw, roll, pitch, and a fixed forearm.

    `simple` puts the mass in the plane across the pitch axis and none on the roll link.
    """
    rng = np.random.default_rng(seed)
    up, R = rng.normal(size=3), Rotation.from_rotvec(rng.normal(size=(4, 3)))
    up /= np.linalg.norm(up)
    side = np.cross(up, rng.normal(size=3))  # horizontal
    roll_axis = R[1].inv().apply(R[0].inv().apply(side))  # in the frame of the roll link at zero
    across = np.cross(roll_axis, rng.normal(size=3))
    pitch_axis = R[2].inv().apply(across)
    offset = rng.normal() * roll_axis + rng.normal() * across  # from the roll joint's origin: the axes intersect
    com = rng.normal(size=3)
    if simple:
        com -= pitch_axis * (com @ pitch_axis) / (pitch_axis @ pitch_axis)
        offset = rng.normal() * roll_axis

    def rpy(i: int) -> tuple[float, float, float]:
        return triple(R[i].as_euler("xyz"))

    base = "revolute" if yaw else "fixed"
    return eq.Mechanism(
        "random shoulder",
        (
            eq.Body("base", 1.0, (0.1, 0.2, 0.3)),
            eq.Body("roller", 0.0 if simple else 2.0, triple(rng.normal(size=3))),
            eq.Body("arm", 3.0, triple(com)),
            eq.Body("forearm", 0.0 if simple else 1.0, triple(rng.normal(size=3))),
        ),
        (
            eq.Joint("yaw", base, "world", "base", triple(rng.normal(size=3)), rpy(0), triple(R[0].inv().apply(up))),
            eq.Joint("roll", "revolute", "base", "roller", triple(rng.normal(size=3)), rpy(1), triple(roll_axis)),
            eq.Joint("pitch", "revolute", "roller", "arm", triple(offset), rpy(2), triple(pitch_axis)),
            eq.Joint("elbow", "fixed", "arm", "forearm", triple(rng.normal(size=3)), rpy(3)),
        ),
        gravity=triple(-rng.uniform(1, 20) * up),
        workspace=eq.Workspace(100),
    )


# The equations -------------------------------------------------------------------------------------------------------


def slope(energy, theta: np.ndarray) -> np.ndarray:
    """dV/dtheta by central differences, (N, 2)."""
    steps = 1e-6 * np.eye(2)
    return np.stack([(energy(theta + s) - energy(theta - s)) / 2e-6 for s in steps], axis=-1)


@pytest.mark.parametrize("arrangement", d.ARRANGEMENTS)
def test_energy_and_torque_give_the_same_spring(arrangement):
    """(15)-(16) is (17)-(18), (25)-(26) is (27) and minus the energy's slope; with k of (23) both cancel gravity."""
    J = d.differential(arrangement)
    np.testing.assert_allclose(d.spring_energy(K, B, H, THETA, J), d.balanced_spring_energy(K, B, H, THETA), atol=ATOL)
    torque = d.spring_torque(K, B, H, THETA, J)
    np.testing.assert_allclose(torque, d.balanced_spring_torque(K, B, H, THETA), atol=ATOL)
    np.testing.assert_allclose(torque, -slope(lambda x: d.spring_energy(K, B, H, x, J), THETA), atol=1e-8)
    gravity = d.gravity_torque(WEIGHT, THETA)
    np.testing.assert_allclose(gravity, -slope(lambda x: d.gravity_energy(WEIGHT, x), THETA), atol=1e-8)
    k = d.stiffness(WEIGHT, B, H)
    total = d.gravity_energy(WEIGHT, THETA) + d.spring_energy(k, B, H, THETA, J)
    np.testing.assert_allclose(total, k * (B**2 + H**2), atol=ATOL)  # C, half of what (17) prints
    np.testing.assert_allclose(gravity + d.spring_torque(k, B, H, THETA, J), 0, atol=ATOL)  # (28)


def test_the_disk_torque_is_the_cross_product_of_24():
    angle = THETA[:, 0]
    A = -H * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    force = K * (np.array([B, 0.0]) - A)
    np.testing.assert_allclose(d.disk_torque(K, B, H, angle), A[:, 0] * force[:, 1] - A[:, 1] * force[:, 0], atol=ATOL)
    np.testing.assert_allclose(d.stretch_squared(B, H, angle), np.sum((force / K) ** 2, axis=-1), atol=ATOL)
    assert d.stiffness(WEIGHT, B, H) == d.single_stiffness(WEIGHT, B, H) / 2  # (7)


@pytest.mark.parametrize("ratio", [0.5, 1.0, 3.0])
@pytest.mark.parametrize("arrangement", d.ARRANGEMENTS)
def test_the_mechanism_is_the_equations(arrangement, ratio):
    """Bodies, couplings and springs give (2), (3), (15) and (25), with the paper's angles."""
    m = shoulder()
    springs: dict[str, Any] = {"b": B, "h": H}
    made = eq.design(m, "bevel", arrangement=arrangement, gear_ratio=ratio, **springs) if ratio != 3 else None
    if made is None:  # whole turns of roll: no spring helps, so the ranges are narrowed
        m = replace(m, joints=(replace(m.joints[0], range=(-1.0, 1.0)), m.joints[1]))
        made = eq.design(m, "bevel", arrangement=arrangement, gear_ratio=ratio, **springs)
    k = made.mechanism.springs[0].stiffness
    assert made.mechanism.springs[1].stiffness == pytest.approx(k)
    state = Potential(made.mechanism)(THETA)
    J = d.differential(arrangement, ratio)
    weight = 6.7 * 9.81 * 0.164
    np.testing.assert_allclose(state.gravity, d.gravity_energy(weight, THETA), atol=1e-10)
    np.testing.assert_allclose(state.gravity_torque, -d.gravity_torque(weight, THETA), atol=1e-10)
    np.testing.assert_allclose(state.springs.sum(axis=1), d.spring_energy(k, B, H, THETA, J), rtol=1e-7)
    np.testing.assert_allclose(state.spring_torque, -d.spring_torque(k, B, H, THETA, J), atol=1e-6)


# Exactness -----------------------------------------------------------------------------------------------------------


@settings(derandomize=True, deadline=None, max_examples=25)
@given(
    seed=st.integers(0, 10**6),
    arrangement=st.sampled_from(d.ARRANGEMENTS),
    yaw=st.booleans(),
    simple=st.booleans(),
    disks=st.sampled_from([0.0, {"left": 0.3}, {"left": 0.2, "right": 0.5}]),
)
def test_random_shoulders_are_exact(seed, arrangement, yaw, simple, disks):
    m = random_shoulder(seed, yaw, simple)
    made = eq.design(m, "bevel", arrangement=arrangement, disk_mass=disks, b={"left": 0.1}, stiffness={"right": 500.0})
    certificate = made.balance.certificate
    assert made.balance.exact
    assert certificate.kind == "fourier"
    # the roll link's own spring only where something only rolls
    assert len(made.mechanism.springs) == (2 if simple and disks == 0.0 else 3)
    found, _ = find(m)
    assert found is not None
    energy = Potential(m)(np.random.default_rng(seed).uniform(-pi, pi, (400, len(m.coordinates)))).gravity
    assert np.ptp(energy) <= 2 * (found.weight + found.roll_weight) * (1 + 1e-9)
    for spring in made.mechanism.springs[:2]:
        sides = {name: made.free_parameters[name][spring.name.split()[0]] for name in ("b", "h", "stiffness")}
        assert sides["stiffness"] * sides["b"] * sides["h"] == pytest.approx(weight_of(made) / 2)


def weight_of(made: eq.Design) -> float:
    """m g l from the energies alone: the amplitude over pitch goes with |cos(phi)|, whose mean square is a half."""
    bare = made.mechanism.with_springs(())
    q = np.zeros((1, len(bare.coordinates)))
    n = bare.coordinates.index("pitch")
    grid = np.linspace(-pi, pi, 60, endpoint=False)
    best = 0.0
    for roll in grid[:30]:
        x = np.repeat(q, 60, axis=0)
        x[:, n], x[:, n - 1] = grid, roll
        best += (2 * abs(np.fft.rfft(Potential(bare)(x).gravity)[1]) / 60) ** 2
    return float(np.sqrt(2 * best / 30))


@pytest.mark.parametrize("arrangement", d.ARRANGEMENTS)
def test_two_of_b_h_and_k_give_the_third_on_each_side(arrangement):
    weight = 6.7 * 9.81 * 0.164
    every: list[dict[str, Any]] = [
        {},
        {"b": 0.05},
        {"b": {"left": 0.05, "right": 0.03}, "h": 0.07},
        {"stiffness": {"left": 1000.0}, "h": {"*": 0.05, "right": 0.08}},
        {"stiffness": 1500.0},
        {"stiffness": weight / 2 / 0.05 / 0.07, "b": 0.05, "h": 0.07},  # all three, where they fit
    ]
    for asked in every:
        made = eq.design(shoulder(), "bevel", arrangement=arrangement, **asked)
        assert made.balance.exact
        for spring in made.mechanism.springs:
            side = spring.name.split()[0]
            h = np.linalg.norm(spring.p_a)
            b = np.hypot(spring.p_b[0], spring.p_b[2])
            assert spring.stiffness * b * h == pytest.approx(weight / 2)
            for name, found in (("b", b), ("h", h), ("stiffness", spring.stiffness)):
                assert made.free_parameters[name][side] == pytest.approx(found)
                value = asked.get(name)
                value = value.get(side, value.get("*")) if isinstance(value, dict) else value
                assert value is None or found == pytest.approx(value)
    message = (
        r"stiffness.left: with b and h it is given already: 1539.89 N/m, as the product of the three must be 5.38961"
    )
    with pytest.raises(InputError, match=message):
        eq.design(shoulder(), "bevel", b=0.05, h=0.07, stiffness={"left": 1500.0})


def test_the_arrangement_turns_the_disks_the_other_way():
    for arrangement in d.ARRANGEMENTS:
        m = eq.design(shoulder(), "bevel", arrangement=arrangement).mechanism
        rows = [[dict(c.terms)[name] for name in ("roll", "pitch")] for c in m.couplings]
        np.testing.assert_array_equal(rows, d.differential(arrangement))


@pytest.mark.parametrize("seed", range(3))
def test_mujoco_finds_the_same_constant_energy(seed):
    m = eq.design(random_shoulder(seed, yaw=True), "bevel", disk_mass={"left": 0.3}).mechanism
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EquipoiseWarning)  # no inertias
        model = mujoco.MjModel.from_xml_string(mjcf.to_text(m))
    q = np.random.default_rng(1).uniform(-pi, pi, (10, 3))
    state = Potential(m)(q)
    for values, energy in zip(q, state.energy, strict=True):
        data = set_pose(m, model, dict(zip(m.coordinates, values.tolist(), strict=True)))
        mujoco.mj_energyPos(model, data)
        assert data.energy[0] == pytest.approx(energy, rel=1e-9)
        equality = data.efc_pos[data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY]
        assert len(equality) == 2
        assert np.abs(equality).max() < 1e-12  # the gears mesh
    assert np.ptp(state.energy) < 1e-9 * np.ptp(state.gravity)


def test_survives_a_file(tmp_path):
    m = eq.design(random_shoulder(4), "bevel").mechanism
    eq.save(m, tmp_path / "arm.yaml")
    assert replace(eq.load(tmp_path / "arm.yaml"), provenance={}) == replace(m, provenance={})


# Beyond the paper ----------------------------------------------------------------------------------------------------


def test_the_hemisphere_is_the_side_that_the_roll_axis_points_to():
    free = replace(shoulder(), joints=tuple(replace(joint, range=None) for joint in shoulder().joints))
    made = eq.design(free, "bevel", workspace="hemisphere").mechanism
    for joint, expected in zip(made.joints[:2], ((-pi, pi), (-pi, 0)), strict=True):
        assert joint.range == pytest.approx(expected)
    for seed in range(5):
        made = eq.design(random_shoulder(seed), "bevel", workspace="hemisphere").mechanism
        found, _ = find(made.with_springs(()))
        ranges = {joint.name: joint.range for joint in made.joints}
        low, high = ranges["pitch"] or (0, 0)
        assert high - low == pytest.approx(pi)
        tree = Potential(made).tree
        q = np.random.default_rng(seed).uniform((-pi, low), (pi, high), (50, 2))
        poses = tree.poses(q)
        assert found is not None
        axis = poses.R[:, tree.index["roller"]] @ found.roll.axis
        moment = poses.R[:, tree.index[found.pitch.name]] @ found.pitch_moment
        assert np.einsum("ni,ni->n", axis, moment).min() > 0
        assert -pi < (low + high) / 2 <= pi


def best_by_search(m: eq.Mechanism, design: eq.Design, poses: np.ndarray) -> float:
    """The least rms torque when the two stiffnesses vary, springs where the design has them."""
    gravity = Potential(m)(poses).gravity_torque
    columns = []
    for spring in design.mechanism.springs:
        unit = design.mechanism.with_springs([replace(spring, stiffness=1.0)])
        columns.append(Potential(unit)(poses).spring_torque.reshape(-1))
    A = np.stack(columns, axis=1)
    k = np.linalg.lstsq(A, -gravity.reshape(-1), rcond=None)[0]
    assert k == pytest.approx([spring.stiffness for spring in design.mechanism.springs], rel=0.02)
    return float(np.sqrt(np.mean(np.sum((A @ k + gravity.reshape(-1)).reshape(gravity.shape) ** 2, axis=1))))


@pytest.mark.parametrize(("ratio", "roll"), [(0.5, (-pi, pi)), (2.0, (-1.0, 1.5)), (3.0, (-0.5, 0.5))])
def test_other_gear_ratios_are_the_best_approximation(ratio, roll):
    m = shoulder()
    m = replace(m, joints=(replace(m.joints[0], range=roll), m.joints[1]))
    made = eq.design(m, "bevel", gear_ratio=ratio)
    assert not made.balance.exact
    assert "exact with a gear ratio of 1 only" in made.free_parameters["approximate"]
    assert 0 < made.residual < made.unbalanced
    poses = np.random.default_rng(5).uniform((roll[0], -pi), (roll[1], 0), (20_000, 2))
    assert best_by_search(m, made, poses) == pytest.approx(made.residual, rel=0.02)
    # turning an end about the pitch axis does not help either
    first = made.mechanism.springs[0]
    for angle in (-0.05, 0.05):
        A = Rotation.from_rotvec([0, angle, 0]).apply(first.p_a)
        turned = made.mechanism.with_springs([replace(first, p_a=triple(A)), made.mechanism.springs[1]])
        torque = [Potential(x)(poses).torque for x in (made.mechanism, turned)]
        assert np.mean(torque[1] ** 2) > np.mean(torque[0] ** 2)


def test_a_gear_ratio_of_2_is_useless_over_whole_turns():
    with pytest.raises(InfeasibleError, match="with a gear ratio of 2 no spring helps over these joint ranges"):
        eq.design(shoulder(), "bevel", gear_ratio=2.0)


def test_a_ratio_near_1_tends_to_the_exact_design():
    """The fit and the closed form agree where they meet, and what is left is first order in the ratio's error."""
    m = random_shoulder(7)
    shares = []
    for error in (1e-2, 1e-3):
        made = eq.design(m, "bevel", gear_ratio=1 + error, b=0.1, h=0.1)
        shares.append(made.residual / made.unbalanced / error)
    assert shares[0] == pytest.approx(shares[1], rel=0.05)
    exact = eq.design(m, "bevel", b=0.1, h=0.1).mechanism.springs
    for a, b in zip(exact, eq.design(m, "bevel", gear_ratio=1 + 1e-9, b=0.1, h=0.1).mechanism.springs, strict=True):
        np.testing.assert_allclose([a.stiffness, *a.p_a, *a.p_b], [b.stiffness, *b.p_a, *b.p_b], rtol=1e-6, atol=1e-7)


def test_payload_says_what_to_move():
    """Moving b (or h) as told, and turning B where the moment turns, balances the payload with the same springs."""
    at = (0.3, 0.0, 0.1)
    made = eq.design(shoulder(), "bevel", b=0.05, h=0.07, payload=[1.0], payload_at=at)
    assert made.balance.exact
    assert made.mechanism.masses[0].mass == 1.0
    rule = made.free_parameters["payload_rule"]
    assert rule["1 kg"]["b.left [m]"] == pytest.approx(0.05)
    bare = eq.design(shoulder(), "bevel", b=0.05, h=0.07)
    k = {side: bare.free_parameters["stiffness"][side] for side in d.SIDES}
    ratio = 6.7 * 0.164 / np.hypot(6.7 * 0.164 + 0.3, 0.1)
    assert rule["0 kg"]["b.left [m]"] == pytest.approx(0.05 * ratio)
    assert rule["0 kg"]["or h.right [m]"] == pytest.approx(0.07 * ratio)
    # the same springs at the told b balance the shoulder without its payload
    K_loaded = made.free_parameters["stiffness"]["left"]
    assert K_loaded * rule["0 kg"]["b.left [m]"] * 0.07 == pytest.approx(k["left"] * 0.05 * 0.07)
    turn, b = rule["0 kg"]["turn [rad]"], rule["0 kg"]["b.left [m]"]
    moved = []
    for spring in made.mechanism.springs:  # B alone moves
        on_axis = np.array([0.0, spring.p_b[1], 0.0])
        u = (np.array(spring.p_b) - on_axis) / 0.05
        moved.append(replace(spring, p_b=triple(on_axis + b * Rotation.from_rotvec([0, turn, 0]).apply(u))))
    assert abs(turn) > 0.01
    assert eq.check(made.mechanism.with_masses(()).with_springs(moved)).exact
    assert not eq.check(made.mechanism.with_masses(())).exact


@pytest.mark.parametrize("at", [None, (0.2, 0.03, -0.05)])
def test_one_fixed_design_is_best_in_the_middle_of_a_payload_range(at):
    low, high = 0.5, 2.0
    made = eq.design(shoulder(), "bevel", payload=[low, high], payload_at=at)
    assert made.mechanism.masses[0].mass == pytest.approx(1.25)
    residual = max(made.free_parameters["payload_residual"].values())
    place = np.array(at or (0.164, 0, 0))

    def worst(mass: float) -> float:
        springs = eq.design(shoulder(), "bevel", payload=[mass], payload_at=at).mechanism.springs
        ends = []
        for end in (low, high):
            m = eq.design(shoulder(), "bevel", payload=[end], payload_at=at).mechanism.with_springs(springs)
            ends.append(eq.check(m).residual.max.max())
        return max(ends)

    assert residual == pytest.approx(worst(1.25), rel=1e-6)
    assert residual <= 9.81 * np.linalg.norm(place) * 0.75 * (1 + 1e-9)
    for other in (1.0, 1.5):
        assert worst(other) > 1.2 * residual


def test_friction_margin():
    """One spring's share of the torque is half of m g l, so that one alone may be wrong by twice as much."""
    weight = 6.7 * 9.81 * 0.164
    made = eq.design(shoulder(), "bevel", friction={"roll": 0.5, "pitch": 0.2})
    found = made.free_parameters
    assert found["margin"] == pytest.approx({"roll": 0.5, "pitch": 0.2})
    errors = {"left spring": 0.4 / weight, "right spring": 0.4 / weight, "all springs": 0.2 / weight}
    assert found["spring_error"] == pytest.approx(errors, rel=1e-6)
    share = found["spring_error"]["all springs"]
    for factor, held in ((0.999, True), (1.001, False)):
        springs = [replace(s, stiffness=s.stiffness * (1 + factor * share)) for s in made.mechanism.springs]
        residual = eq.check(made.mechanism.with_springs(springs)).residual.max
        assert bool((residual <= [0.5, 0.2]).all()) is held
    rough = eq.design(shoulder(), "bevel", gear_ratio=0.5, friction=1.0).free_parameters
    assert rough["margin"]["roll"] < 0
    assert rough["spring_error"]["all springs"] == 0
    rolls = replace(shoulder(), masses=(eq.PointMass("motor", "link 1", 1.0, (0.1, 0, 0)),))
    errors = eq.design(rolls, "bevel", friction={"pitch": 0.2}).free_parameters["spring_error"]
    assert errors["roll spring"] is None  # it never loads the pitch joint
    assert errors["left spring"] == pytest.approx(0.4 / weight, rel=1e-6)


def test_what_was_chosen_makes_the_same_design_again():
    first = eq.design(random_shoulder(5), "bevel", disk_mass=0.2, gear_ratio=1.0)
    options = {name: value for name, value in first.free_parameters.items() if name in METHODS["bevel"].parameters}
    again = eq.design(random_shoulder(5), "bevel", **options)
    for a, b in zip(first.mechanism.springs, again.mechanism.springs, strict=True):
        np.testing.assert_allclose([a.stiffness, *a.p_a, *a.p_b], [b.stiffness, *b.p_a, *b.p_b], atol=1e-12)


# What it refuses -----------------------------------------------------------------------------------------------------


def changed(joint: int, **values: object) -> eq.Mechanism:
    joints = list(shoulder().joints)
    joints[joint] = replace(joints[joint], **values)  # type: ignore[arg-type]
    return replace(shoulder(), joints=tuple(joints))


def distal() -> eq.Mechanism:
    m = shoulder()
    elbow = eq.Joint("elbow", "revolute", "link 2", "forearm", (0.3, 0, 0), axis=(0, 1, 0))
    return replace(m, bodies=(*m.bodies, eq.Body("forearm", 1.0, (0.1, 0, 0))), joints=(*m.joints, elbow))


@pytest.mark.parametrize(
    ("m", "reason"),
    [
        (replace(shoulder(), gravity=(9.0, 0, 1.0)), "the axis of 'roll' is 6.34 deg off the horizontal"),
        (changed(1, axis=(0.1, 1, 0)), "no reason: still perpendicular"),
        (changed(1, axis=(0, 1, 0.1)), "the axes of 'roll' and 'pitch' are 5.711 deg off a right angle"),
        (changed(1, xyz=(0.02, 0, 0.1)), "the axes of 'roll' and 'pitch' pass each other at 20 mm"),
        (
            changed(1, type="spherical", range=None),
            "joint 'pitch' is spherical: a roll-pitch shoulder has two",
        ),
        (changed(1, type="fixed", range=None), "'link 2': turned by one joint only"),
        (distal(), "gravity also does work on 'forearm': the mass centre of what turns with 'link 2' must be fixed"),
        (eq.design(shoulder(), "bevel").mechanism, "joint 'left disk' is geared to the shoulder already"),
        (exact_pendulum().mechanism, "'arm': turned by one joint only"),
        (counterweight().mechanism, "gravity does no work on any link: nothing to balance"),
        (lee_chen(), "the axes of 'joint2' and 'joint3' are 90 deg off a right angle"),
        (replace(shoulder(), gravity=(0, 0, 0)), "there is no gravity"),
        (replace(shoulder(), loops=(eq.Loop("link 1", (0, 0, 0), "link 2", (0, 0, 0)),)), "it has loops"),
        (robot("panda"), "gravity also does work on"),
    ],
)
def test_where_it_does_not_apply(m, reason):
    if reason.startswith("no reason"):
        assert METHODS["bevel"].applies(m) == []
        assert eq.design(m, "bevel").balance.exact
        return
    assert any(reason in text for text in METHODS["bevel"].applies(m)), METHODS["bevel"].applies(m)
    with pytest.raises(UnsupportedError, match="method 'bevel' does not apply to"):
        eq.design(m, "bevel")


def test_a_counterweighted_forearm_is_balanced_with_the_rest():
    """The paper's way with a second link [13]: a counter mass keeps the mass centre fixed."""
    m = distal().with_masses((eq.PointMass("counterweight", "forearm", 2.0, (-0.05, 0, 0)),))
    made = eq.design(m, "bevel")
    assert made.balance.exact
    assert "elbow" in made.mechanism.coordinates


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"b": 0.0}, "b: must be a finite number of more than 0, found 0.0"),
        ({"b": {"middle": 0.1}}, r"b: no link that takes it 'middle' \(valid: left, right\)"),
        ({"gear_ratio": -1.0}, "gear_ratio: must be a finite number of more than 0, found -1.0"),
        ({"arrangement": "top"}, r"arrangement: unknown value 'top' \(valid: near, far\)"),
        ({"workspace": "sphere"}, r"workspace: unknown value 'sphere' \(valid: file, hemisphere\)"),
        ({"disk_mass": -1.0}, "disk_mass: must be a finite number of at least 0, found -1.0"),
        ({"payload": [1, 2, 3]}, "payload: must be one mass, or the smallest and largest"),
        ({"payload": [2, 1]}, "payload: the smallest comes first, found 2 kg, 1 kg"),
        ({"payload": [6.7], "payload_at": (-0.164, 0, 0)}, "payload: leaves no shoulder to balance: gravity does no"),
        ({"payload_at": (1, 2)}, "payload_at.link 2: must be three lengths x,y,z"),
        ({"friction": {"elbow": 1.0}}, r"friction: no link that takes it 'elbow'.*\(valid: roll, pitch\)"),
        ({"span": 2}, "method 'bevel' has no such option"),
    ],
)
def test_bad_options(options, message):
    with pytest.raises(InputError, match=message):
        eq.design(shoulder(), "bevel", **options)


def test_command_line(run, tmp_path):
    source, out = tmp_path / "shoulder.yaml", tmp_path / "out.yaml"
    eq.save(shoulder(), source)
    sets = ("b=49 mm", "b.left=60 mm", "h=0.0685", "arrangement=far", "payload=0,500 g", "friction.roll=200 N mm")
    code, _, err = run("design", source, "--method", "bevel", *(x for text in sets for x in ("--set", text)), "-o", out)
    assert (code, err) == (0, f"wrote {out}\n")
    made = eq.load(out)
    assert np.hypot(made.springs[0].p_b[0], made.springs[0].p_b[2]) == pytest.approx(0.06)
    assert made.masses[0].mass == 0.25
    assert made.provenance["options"]["margin"]["roll"] == pytest.approx(0.2)
    code, output, _ = run("check", out)
    assert code == 0
    assert "EXACT" in output
    assert run("design", source, "--method", "bevel", "--set", "gear_ratio=2")[0] == 1
    code, _, err = run("design", source, "--method", "bevel", "--set", "friction=1 kg")
    assert code == 2
    assert "--set friction" in err

"""Scatter: the fast map against rebuilt mechanisms, closed forms, first-order propagation, Sobol indices."""

import json
from dataclasses import replace
from math import erf, pi, sqrt

import numpy as np
import pytest
import zoo
from hypothesis import given, settings
from hypothesis import strategies as st
from robots import balanced, robot

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.kinematics import Tree, sample
from equipoise.model.errors import InputError, UnsupportedError
from equipoise.robust import Scatter, tolerance
from equipoise.robust.torque_map import TorqueMap

MGL = 2 * zoo.G * 0.3
ONLY_STIFFNESS = Scatter(stiffness=0.05, attachment=0, mass=0, length=0)


def built(m: eq.Mechanism, torque_map: TorqueMap, x: np.ndarray) -> eq.Mechanism:
    """The mechanism of one build, its values changed one by one."""
    off = {(p.kind, p.item, p.value): float(v) for p, v in zip(torque_map.parameters, x, strict=True)}

    def place(kind, item, label, p):
        return tuple(value + off.get((kind, item, f"{label}.{c}"), 0.0) for c, value in zip("xyz", p, strict=True))

    def mass(item):
        return item.mass * (1 + off.get(("mass", item.name, "mass"), 0.0))

    springs = tuple(
        replace(
            s,
            stiffness=s.stiffness * (1 + off.get(("stiffness", s.name, "stiffness"), 0.0)),
            p_a=place("attachment", s.name, "p_a", s.p_a),
            p_b=place("attachment", s.name, "p_b", s.p_b),
        )
        for s in m.springs
    )
    return replace(
        m,
        bodies=tuple(replace(b, mass=mass(b), com=place("length", b.name, "com", b.com)) for b in m.bodies),
        masses=tuple(
            replace(p, mass=mass(p), position=place("length", p.name, "position", p.position)) for p in m.masses
        ),
        joints=tuple(replace(j, xyz=place("length", j.name, "xyz", j.xyz)) for j in m.joints),
        springs=springs,
    )


def spatial_arm(free_length: float = 0.0) -> eq.Mechanism:
    """A slide, a ball joint and a hinge; springs over one and over all; a payload; a heavy spring."""
    return eq.Mechanism(
        "spatial arm",
        (
            eq.Body("cart", 1.0, (0.1, 0.0, 0.05)),
            eq.Body("ball", 2.0, (0.2, 0.1, 0.0)),
            eq.Body("tip", 0.5, (0.1, 0, 0)),
        ),
        (
            eq.Joint("slide", "prismatic", "world", "cart", (0.1, 0.2, 0.3), axis=(0, 0.6, 0.8), range=(-0.3, 0.3)),
            eq.Joint("socket", "spherical", "cart", "ball", (0.2, 0, 0)),
            eq.Joint("hinge", "revolute", "ball", "tip", (0.4, 0, 0.1), axis=(0, 1, 0)),
        ),
        springs=(
            eq.Spring("long", "world", (0, 0, 0.5), "tip", (0.1, 0.02, 0), 120.0, free_length, 0.3, 0.25),
            eq.Spring("short", "ball", (0.1, 0, 0.1), "tip", (0.15, 0, 0), 300.0),
        ),
        masses=(eq.PointMass("payload", "tip", 0.7, (0.2, 0.0, 0.0)),),
    )


@settings(deadline=None, max_examples=15)
@given(seed=st.integers(0, 10_000), free=st.sampled_from([0.0, 0.1]))
def test_the_map_is_the_torque_of_the_rebuilt_mechanism(seed, free):
    m = spatial_arm(free)
    q = sample(Tree.of(m), 20, seed)
    found = TorqueMap(m, q, Scatter(0.1, 5e-3, 0.1, 5e-3))
    x = np.random.default_rng(seed).normal(size=(3, len(found.parameters))) * found.deviation
    tau = found(x)
    for one, own in zip(x, tau.T, strict=True):
        true = Potential(built(m, found, one))(q).torque.T.ravel()
        assert own == pytest.approx(true, abs=2e-6 * np.abs(true).max())


def test_the_map_of_a_robot():
    m = robot("ur5")
    ends = (("shoulder_link", "forearm_link"), ("shoulder_link", "wrist_1_link"), ("upper_arm_link", "wrist_3_link"))
    m = m.with_springs(
        eq.Spring(f"spring {i}", a, (0.05, -0.02, 0.1), b, (0.02, 0.1, 0.03), 300.0 + i)
        for i, (a, b) in enumerate(ends)
    )
    q = sample(Tree.of(m), 50)
    found = TorqueMap(m, q, Scatter())
    x = np.random.default_rng(3).normal(size=(2, len(found.parameters))) * found.deviation
    for one, own in zip(x, found(x).T, strict=True):
        true = Potential(built(m, found, one))(q).torque.T.ravel()
        assert own == pytest.approx(true, abs=1e-6 * np.abs(true).max())


@pytest.mark.parametrize("free", [0.0, 0.1])
def test_the_jacobian_by_differences(free):
    m = spatial_arm(free)
    q = sample(Tree.of(m), 10)
    found = TorqueMap(m, q, Scatter())
    step, J = 1e-5, found.jacobian()
    for i in range(len(found.parameters)):
        x = np.eye(len(found.parameters))[i] * found.deviation * step
        up, down = (Potential(built(m, found, sign * x))(q).torque.T.ravel() for sign in (1, -1))
        assert J[:, i] == pytest.approx((up - down) / (2 * step), abs=1e-6 * max(1.0, np.abs(J[:, i]).max()))


def test_one_link_in_closed_form():
    """Stiffness off by e leaves e m g l sin: peaks are half normal, and friction F holds erf(F / (s m g l sqrt 2))."""
    friction = 0.05 * MGL
    found = tolerance(zoo.pendulum(), ONLY_STIFFNESS, builds=40_000, friction=friction)
    assert found.peak.mean() == pytest.approx(0.05 * MGL * sqrt(2 / pi), rel=0.01)
    assert found.peak.std() == pytest.approx(0.05 * MGL * sqrt(1 - 2 / pi), rel=0.01)
    assert found.yield_ == pytest.approx(erf(1 / sqrt(2)), abs=0.01)
    assert found.by_kind == {"stiffness": 1.0}
    assert found.nominal == pytest.approx([0.0], abs=1e-12)


def test_uniform_scatter_is_between_its_limits():
    found = tolerance(zoo.pendulum(), replace(ONLY_STIFFNESS, shape="uniform"), builds=20_000)
    assert 0.0495 * MGL < found.peak.max() <= 0.05 * MGL * (1 + 1e-6)
    assert found.peak.mean() == pytest.approx(0.025 * MGL, rel=0.02)


def test_first_order_propagation_for_small_scatter():
    """Mean and spread at every pose, and of the peak where one pose decides it, within 3 %."""
    m = spatial_arm(0.1)
    found = tolerance(m, Scatter().times(0.02), builds=20_000, poses=200)
    live = found.first_order > 1e-3 * found.first_order.max()
    assert found.spread[live] == pytest.approx(found.first_order[live], rel=0.03)
    nominal = Potential(m)(sample(Tree.of(m), 200)).torque.T.ravel()
    assert np.abs(found.mean - nominal)[live] == pytest.approx(0, abs=0.03 * found.first_order.max())
    for j, rows in enumerate(np.arange(len(nominal)).reshape(-1, 200)):
        worst = rows[np.abs(nominal[rows]).argmax()]
        assert found.peak[:, j].mean() == pytest.approx(abs(nominal[worst]), rel=0.03)
        assert found.peak[:, j].std() == pytest.approx(found.first_order[worst], rel=0.03)


def test_sobol_indices_against_pick_and_freeze():
    m, scatter = spatial_arm(), Scatter(0.05, 2e-3, 0.05, 2e-3)
    found = tolerance(m, scatter, builds=10, poses=100)
    torque_map = TorqueMap(m, sample(Tree.of(m), 100), scatter)
    rng, P = np.random.default_rng(1), len(torque_map.parameters)
    A, B = (rng.normal(size=(4000, P)) * torque_map.deviation for _ in range(2))
    reach = [1.0 if turns else found_reach(m) for turns in Tree.of(m).turns]
    weight = np.repeat(reach, 100)[:, None]
    nominal = torque_map.nominal[:, None]
    tau_a, tau_b = weight * (torque_map(A) - nominal), weight * (torque_map(B) - nominal)
    variance = (tau_a**2).sum() / len(A)
    for i in np.argsort(-found.share)[:4]:
        mixed = A.copy()
        mixed[:, i] = B[:, i]
        index = (tau_b * (weight * (torque_map(mixed) - nominal) - tau_a)).sum() / len(A) / variance  # Saltelli 2010
        assert index == pytest.approx(found.share[i], abs=0.03)
    assert found.share.sum() == pytest.approx(1.0)


def found_reach(m: eq.Mechanism) -> float:
    from equipoise.synthesis.mounts import Mounts

    return Mounts.of(m).reach


def test_the_same_seed_gives_the_same_builds():
    first, again = (tolerance(spatial_arm(), builds=50, poses=20, seed=4).peak for _ in range(2))
    assert (first == again).all()
    assert not (first == tolerance(spatial_arm(), builds=50, poses=20, seed=5).peak).any()


@pytest.mark.parametrize(
    ("kind", "value"), [("stiffness", 0.3), ("stiffness", -0.1), ("attachment", float("nan")), ("length", float("inf"))]
)
def test_bad_scatter(kind, value):
    with pytest.raises(InputError, match=kind):
        Scatter(**{kind: value})


def test_what_is_not_covered_says_so():
    loop = eq.load("examples/mechanisms/parallelogram_lamp.yaml")
    if loop.loops:
        with pytest.raises(UnsupportedError, match="loops"):
            tolerance(loop, builds=5, poses=5)
    with pytest.raises(InputError, match="nothing scatters"):
        tolerance(zoo.pendulum(), Scatter(0, 0, 0, 0))
    with pytest.raises(InputError, match="shoulder"):
        tolerance(zoo.pendulum(), friction={"sholder": 1.0})


def test_command_line(run, tmp_path):
    file, picture = tmp_path / "arm.yaml", tmp_path / "builds.svg"
    eq.save(zoo.pendulum(), file)
    small = ("--builds", 2000, "--poses", 50, "--friction", "0.6 N m")
    code, out, err = run("tolerance", file, *small, "--plot", picture, "--json")
    answer = json.loads(out)
    assert code == 0
    assert f"wrote {picture}" in err
    assert "<svg" in picture.read_text()
    assert answer["builds"] == 2000
    assert 0.9 < answer["yield"] < 1
    assert sum(answer["share"]["kinds"].values()) == pytest.approx(1)
    assert run("tolerance", file, *small, "--yield", "99.9%")[0] == 1
    code, out, _ = run("tolerance", file, *small, "--yield", "50%")
    assert code == 0
    for text in ("YIELD", "builds hold every pose", "N m", "stiffness", "Sobol"):
        assert text in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--stiffness", "much"), "--stiffness"),
        (("--attachment", "3 kg"), "--attachment"),
        (("--friction", "elbow=1 N m"), "elbow"),
        (("--friction", "1 m"), "--friction"),
        (("--yield", "97%"), "--yield"),
    ],
)
def test_bad_options(run, tmp_path, arguments, message):
    file = tmp_path / "arm.yaml"
    eq.save(zoo.pendulum(), file)
    code, out, err = run("tolerance", file, *arguments)
    assert (code, out) == (2, "")
    assert message in err


@pytest.mark.slow(reason="a hundred thousand builds")
def test_a_hundred_thousand_builds_of_a_robot():
    ur5 = balanced().mechanism
    found = tolerance(ur5, friction=5.0)
    assert found.peak.shape == (100_000, 6)
    small = tolerance(ur5, Scatter().times(0.02), builds=20_000)
    live = small.first_order > 1e-3 * small.first_order.max()
    assert small.spread[live] == pytest.approx(small.first_order[live], rel=0.03)
    assert np.abs(small.mean[live]) == pytest.approx(0, abs=0.03 * small.first_order.max())


def test_payload_sweep_is_symmetric_about_the_payload_that_is_balanced(run, tmp_path):
    m = zoo.pendulum()
    m = replace(m, springs=(replace(m.springs[0], stiffness=zoo.PENDULUM_K * (2 * 0.3 + 0.4) / 0.6),))  # 1 kg at 0.4 m
    file = tmp_path / "arm.yaml"
    eq.save(m, file)
    options = ("--payload", "0.5,1.5kg", "--payload-on", "arm", "--payload-at", "0.4,0,0")
    code, out, _ = run("check", file, *options, "--json")
    answer = json.loads(out)
    assert code == 1
    assert answer["payload"]["payloads"] == pytest.approx([0.5, 0.75, 1.0, 1.25, 1.5])
    assert answer["payload"]["exact"] == [False, False, True, False, False]
    slope = zoo.G * 0.4
    peaks = [row[0] for row in answer["payload"]["residual"]]
    assert peaks == pytest.approx([0.5 * slope, 0.25 * slope, 0, 0.25 * slope, 0.5 * slope], abs=1e-9)
    assert "0.75 kg" in run("check", file, *options)[1]
    assert run("check", file, "--payload", "1,2")[0] == 2
    assert run("check", file, "--payload", "2,1", "--payload-on", "arm")[0] == 2

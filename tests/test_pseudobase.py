"""The method `pseudobase`: exact on random arms and on robots, with the springs it promises; what it refuses."""

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
from zoo import counterweight, gantry, lenzo_spherical, mirrored_pair, parallelogram_lamp, vertical_slide

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.io import mjcf
from equipoise.model.errors import EquipoiseWarning, InputError, UnsupportedError
from equipoise.synthesis import METHODS
from equipoise.synthesis.arms.moments import moments, segments
from equipoise.synthesis.pseudobase.parallelograms import mobility


def random_arm(seed: int, joints: int, branches: bool = False) -> eq.Mechanism:
    """Random axes, offsets, masses and gravity; now and then a massless link, or one held by a fixed joint."""
    rng = np.random.default_rng(seed)
    placed, bodies, hinges = ["world"], [], []

    def vector(size: float) -> tuple[float, float, float]:
        x, y, z = rng.uniform(-size, size, 3).tolist()
        return x, y, z

    for i in range(joints):
        parent = str(rng.choice(placed)) if branches else placed[-1]
        bodies.append(eq.Body(f"b{i}", float(rng.uniform(0.1, 5)) * (rng.random() < 0.8), vector(0.3)))
        kind = "fixed" if rng.random() < 0.15 else "revolute"
        hinges.append(eq.Joint(f"j{i}", kind, parent, f"b{i}", vector(0.5), vector(pi), vector(1)))
        placed.append(f"b{i}")
    tip = eq.PointMass("payload", placed[-1], 1.0, (0.1, 0.2, 0.3))
    return eq.Mechanism(
        "random arm", tuple(bodies), tuple(hinges), masses=(tip,), gravity=vector(10), workspace=eq.Workspace(100)
    )


def quick(name: str) -> eq.Mechanism:
    """An example robot with fewer samples: these tests look at the proof."""
    return replace(robot(name), workspace=eq.Workspace(100))


def poses(m: eq.Mechanism, count: int = 30) -> np.ndarray:
    return np.random.default_rng(1).uniform(-pi, pi, (count, len(m.coordinates)))


def working_links(m: eq.Mechanism) -> list[str]:
    """Links with a moment that gravity does work on, by brute force: their own energy over random poses varies."""
    tree_poses = Potential(m).tree.poses(poses(m, 200))
    found = []
    for link, moment in zip(segments(m), moments(segments(m)), strict=True):
        energy = -tree_poses.R[:, m.body_names.index(link.name)] @ moment.vector @ np.array(m.gravity)
        if np.ptp(energy) > 1e-9:
            found.append(link.name)
    return found


@settings(derandomize=True, deadline=None, max_examples=15)
@given(
    seed=st.integers(0, 10**6),
    joints=st.integers(1, 5),
    branches=st.booleans(),
    share=st.sampled_from([0.0, 0.05, 0.5]),
    weight=st.sampled_from([0.0, 0.3]),
)
def test_random_arms_are_exact(seed, joints, branches, share, weight):
    m = random_arm(seed, joints, branches)
    if METHODS["pseudobase"].applies(m):  # every joint may be fixed
        assert not working_links(m)
        return
    design = eq.design(m, "pseudobase", auxiliary=share, pseudobase=weight)
    assert design.balance.exact
    assert design.balance.certificate.kind == "fourier"
    assert design.certified_gap is not None
    assert design.certified_gap < 1e-10
    if not share and not weight:
        assert [spring.body_b for spring in design.mechanism.springs] == working_links(m)


@pytest.mark.parametrize(("name", "count"), [("ur10", 3), ("panda", 6), ("xarm7", 6)])
def test_robots_with_auxiliary_links_of_5_percent(name, count):
    m = quick(name)
    design = eq.design(m, "pseudobase", auxiliary=0.05)
    assert design.balance.exact
    assert [spring.body_b for spring in design.mechanism.springs] == working_links(m)
    assert len(design.mechanism.springs) == count
    own = {body.name: body.mass for body in m.bodies}
    for body in design.mechanism.bodies:
        if body.name.endswith(" auxiliary") and name != "panda":  # the Panda's last link is several bodies
            assert body.mass == pytest.approx(0.05 * own[body.name.removesuffix(" auxiliary")])
    assert sum(design.free_parameters["auxiliary_mass"].values()) > 0.1


def test_the_fingers_of_the_panda_may_move():
    """They balance each other, so that the proof covers them: nothing has to be locked."""
    design = eq.design(quick("panda"), "pseudobase")
    assert "panda_finger_joint1" in design.mechanism.coordinates
    assert design.balance.exact
    heavy = replace(quick("panda"), masses=(eq.PointMass("pad", "panda_leftfinger", 0.01),))
    with pytest.raises(UnsupportedError, match="sliding 'panda_finger_joint1', 'panda_finger_joint2' changes"):
        eq.design(heavy, "pseudobase")


def test_springs_hang_on_bodies_that_stay_upright():
    """The spring's end on the pseudobase is l_CA above C_i, and D_i on the auxiliary link is `height` above it."""
    m = random_arm(3, 5)
    design = eq.design(m, "pseudobase", height=0.25, l_CA=0.1)
    tree = Potential(design.mechanism).tree
    p = tree.poses(poses(design.mechanism))
    up = -np.array(m.gravity) / np.linalg.norm(m.gravity)
    frames = tree.index
    for spring in design.mechanism.springs:
        link = spring.body_b
        C = np.array(design.free_parameters["centre"][link])
        foot = p.point(frames[link], C)
        np.testing.assert_allclose(
            p.point(frames[spring.body_a], np.array(spring.p_a)) - foot, [0.1 * up] * 30, atol=1e-14
        )
        segment = next(s for s in segments(m) if s.name == link)
        D = p.point(frames[f"{link} auxiliary"], C - segment.origin)
        np.testing.assert_allclose(D - foot, [0.25 * up] * 30, atol=1e-14)


def test_the_height_of_the_auxiliary_chain_only_shifts_the_energy():
    m = random_arm(5, 4)
    low, high = (eq.design(m, "pseudobase", auxiliary=0.1, pseudobase=0.2, height=h).mechanism for h in (0.1, 0.3))
    a, b = (Potential(x)(poses(x)) for x in (low, high))
    np.testing.assert_allclose(a.springs, b.springs, rtol=1e-12)
    np.testing.assert_allclose(a.torque, b.torque, atol=1e-10)
    lifted = sum(x.mass * (1.0 if x.name.endswith("auxiliary") else 0.5) for x in low.bodies[len(m.bodies) :])
    np.testing.assert_allclose(b.gravity - a.gravity, 0.2 * np.linalg.norm(m.gravity) * lifted, rtol=1e-10)


@pytest.mark.parametrize("link", range(3))
def test_a_spring_1_percent_stiff_leaves_1_percent_of_its_links_torque(link):
    m = eq.design(lee_chen(), "pseudobase").mechanism
    springs = list(m.springs)
    springs[link] = replace(springs[link], stiffness=1.01 * springs[link].stiffness)
    balance = eq.check(m.with_springs(springs))
    moment = moments(segments(lee_chen()))[link + 1]
    assert not balance.exact
    assert balance.residual.max == pytest.approx([0.01 * 9.81 * moment.vector[0]] * (link + 1) + [0] * (2 - link))


def test_two_of_stiffness_l_CA_and_l_CB_give_the_third():
    """K l_CA l_CB = mu g |sigma|, Eq. (16)."""
    weight = 2 * 9.81 * 0.3
    m = eq.Mechanism(
        "pendulum",
        (eq.Body("arm", 2.0, (0.3, 0, 0)),),
        (eq.Joint("shoulder", "revolute", "world", "arm", axis=(0, -1, 0)),),
    )
    every: list[tuple[dict[str, Any], float]] = [
        ({}, weight / 0.15**2),  # half the link's size
        ({"l_CA": 0.2}, weight / (0.2 * 0.15)),
        ({"l_CB": 0.2}, weight / (0.2 * 0.15)),
        ({"l_CA": 0.2, "l_CB": 0.1}, weight / 0.02),
        ({"stiffness": 300.0}, 300.0),
        ({"stiffness": 300.0, "l_CA": 0.2}, 300.0),
        ({"stiffness": {"arm": 300.0}, "l_CB": {"*": 0.2}}, 300.0),
    ]
    for asked, K in every:
        design = eq.design(m, "pseudobase", **asked)
        (spring,) = design.mechanism.springs
        lengths = (
            np.linalg.norm(spring.p_a),
            np.linalg.norm(np.array(spring.p_b) - design.free_parameters["centre"]["arm"]),
        )
        assert spring.stiffness == pytest.approx(K)
        assert spring.stiffness * lengths[0] * lengths[1] == pytest.approx(weight)
        for i, name in enumerate(("l_CA", "l_CB")):
            if name in asked:
                value = asked[name]
                assert lengths[i] == pytest.approx(value["*"] if isinstance(value, dict) else value)
        assert design.balance.exact
    with pytest.raises(InputError, match=r"stiffness.arm: with l_CA and l_CB it is given already: 294.3 N/m"):
        eq.design(m, "pseudobase", stiffness=1.0, l_CA=0.1, l_CB=0.2)


def test_what_was_chosen_makes_the_same_design_again():
    first = eq.design(quick("ur10"), "pseudobase", auxiliary=0.05, pseudobase=0.1)
    options = {name: value for name, value in first.free_parameters.items() if name != "mobility"}
    again = eq.design(quick("ur10"), "pseudobase", **options)
    for a, b in zip(first.mechanism.springs, again.mechanism.springs, strict=True):
        np.testing.assert_allclose([a.stiffness, *a.p_a, *a.p_b], [b.stiffness, *b.p_a, *b.p_b], atol=1e-12)


def test_links_that_gravity_does_no_work_on():
    """The UR10: wrist 1's moment is along its level axis, wrist 3 has none. A heavy coupler undoes that."""
    light = eq.design(quick("ur10"), "pseudobase", auxiliary=0.05)
    assert [s.body_b for s in light.mechanism.springs] == ["upper_arm_link", "forearm_link", "wrist_2_link"]
    made = [body.name for body in light.mechanism.bodies if body.name.endswith("auxiliary")]
    assert made == [f"{x}_link auxiliary" for x in ("upper_arm", "forearm", "wrist_1", "wrist_2")]
    heavy = eq.design(quick("ur10"), "pseudobase", pseudobase={"wrist_1_link": 0.2})
    assert "wrist_1_link" in [s.body_b for s in heavy.mechanism.springs]
    assert heavy.balance.exact


def test_the_foot_of_the_chain_is_on_the_last_upright_link():
    m = eq.design(quick("ur10"), "pseudobase", height=0.2).mechanism
    joints = {joint.child: joint for joint in m.joints}
    assert joints["upper_arm_link auxiliary"].parent == "shoulder_link"
    np.testing.assert_allclose(joints["upper_arm_link auxiliary"].xyz, (0, 0.220941, 0.2), atol=1e-15)
    assert joints["forearm_link auxiliary"].parent == "upper_arm_link auxiliary"
    assert joints["forearm_link auxiliary"].follows == "forearm_link"


def test_parallel_axes_get_planar_four_bars():
    design = eq.design(quick("ur10"), "pseudobase")
    flat = ["upper_arm_link", "forearm_link", "wrist_1_link"]
    assert design.free_parameters["planar"] == flat
    assert design.free_parameters["mobility"] == {"active": 6, "idle": 1}
    follows = {joint.child: joint.follows for joint in design.mechanism.joints}
    assert {follows[f"{name} pseudobase"] for name in flat} == {"shoulder_link"}  # their plane turns with the pan joint
    spatial = eq.design(quick("ur10"), "pseudobase", planar=())
    assert spatial.free_parameters["mobility"] == {"active": 6, "idle": 4}
    assert spatial.balance.exact
    with pytest.raises(InputError, match=r"planar: no link with a joint that stays horizontal 'wrist_2_link'"):
        eq.design(quick("ur10"), "pseudobase", planar=("wrist_2_link",))


@pytest.mark.parametrize("n", range(1, 9))
def test_mobility(n):
    """Eq. (20): 2n freedoms, n of them idle; Eq. (19) is n = 1."""
    assert mobility(n, n) == (n, n)
    assert mobility(n, 0) == (n, 0)


def test_gears_and_rails():
    for known in (mirrored_pair(), gantry()):
        assert eq.design(known.mechanism, "pseudobase", auxiliary=0.1).balance.exact


def test_survives_a_file(tmp_path):
    m = eq.design(lee_chen(), "pseudobase", auxiliary=0.05).mechanism
    eq.save(m, tmp_path / "arm.yaml")
    assert replace(eq.load(tmp_path / "arm.yaml"), provenance={}) == replace(m, provenance={})


@pytest.mark.parametrize("name", ["ur10", "xarm7"])
def test_mujoco_finds_the_same_constant_energy(name):
    m = eq.design(quick(name), "pseudobase", auxiliary=0.05, pseudobase=0.1).mechanism
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EquipoiseWarning)  # auxiliary links have no inertia
        model = mujoco.MjModel.from_xml_string(mjcf.to_text(m))
    q = poses(m, 10)
    state = Potential(m)(q)
    for values, energy in zip(q, state.energy, strict=True):
        data = set_pose(m, model, dict(zip(m.coordinates, values.tolist(), strict=True)))
        mujoco.mj_energyPos(model, data)
        assert data.energy[0] == pytest.approx(energy, abs=1e-9)
    assert np.ptp(state.energy) < 1e-10 * np.ptp(state.gravity)


@pytest.mark.parametrize(
    ("m", "reason"),
    [
        (lenzo_spherical().mechanism, "joint 'shoulder' is spherical: a module has one revolute joint"),
        (parallelogram_lamp().mechanism, "joint 'lower bars' is parallelogram"),
        (vertical_slide().mechanism, "sliding 'lift' changes the moment of link 'carriage' by 2 kg m per m"),
        (counterweight().mechanism, "gravity does no work on any link: nothing to balance"),
        (replace(lee_chen(), gravity=(0, 0, 0)), "there is no gravity"),
        (replace(lee_chen(), loops=(eq.Loop("link2", (0, 0, 0), "link4", (0, 0, 0)),)), "it has loops"),
    ],
    ids=["spherical", "parallelogram", "slide", "counterweight", "weightless", "loop"],
)
def test_where_it_does_not_apply(m, reason):
    with pytest.raises(UnsupportedError, match=r"method 'pseudobase' does not apply to .*" + reason):
        eq.design(m, "pseudobase")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"stiffness": -1.0}, "stiffness: must be a finite number of more than 0, found -1.0"),
        ({"stiffness": float("inf")}, "stiffness: must be a finite number of more than 0, found inf"),
        ({"l_CA": {"link2": 0.0}}, "l_CA: must be a finite number of more than 0, found 0.0"),
        ({"l_CA": {"link9": 0.1}}, r"l_CA: no link that takes it 'link9'; did you mean 'link4'\?"),
        ({"height": 0.0}, "height: must be a finite number of more than 0, found 0.0"),
        ({"auxiliary": -0.1}, "auxiliary: must be a finite number of at least 0, found -0.1"),
        ({"centre": 0.1}, "centre.link2: must be three lengths x,y,z"),
        ({"centre": {"link2": [0.1, 0.2]}}, "centre.link2: must be three lengths x,y,z"),
        ({"centre": {"link2": [0.0, 0.2, 0.0]}}, "centre.link2: is on the joint's axis"),
        ({"span": 2}, "method 'pseudobase' has no such option"),
    ],
)
def test_bad_options(options, message):
    with pytest.raises(InputError, match=message):
        eq.design(lee_chen(), "pseudobase", **options)


def test_command_line(run, tmp_path):
    source, out = tmp_path / "arm.yaml", tmp_path / "out.yaml"
    eq.save(lee_chen(), source)
    sets = ("auxiliary=5%", "auxiliary.link4=0.1", "l_CA=80 mm", "centre.link2=0.1,0,20 mm", "stiffness.link2=2 kN/m")
    code, _, err = run(
        "design", source, "--method", "pseudobase", *(x for text in sets for x in ("--set", text)), "-o", out
    )
    assert (code, err) == (0, f"wrote {out}\n")
    made = eq.load(out)
    assert made.springs[0].stiffness == 2000
    assert made.springs[0].p_a == (0, 0, 0.08)
    bodies = {body.name: body for body in made.bodies}
    assert bodies["link3 auxiliary"].mass == pytest.approx(0.05 * 0.848)
    assert bodies["link4 auxiliary"].mass == pytest.approx(0.1 * 1.33)
    assert run("check", out)[0] == 0
    code, _, err = run("design", source, "--method", "pseudobase", "--set", "auxiliary=x")
    assert code == 2
    assert "--set.auxiliary: expected a share such as 0.05 or 5%, found 'x'" in err


def any_arm(n: int) -> eq.Mechanism:
    """`n` links of which nothing is special, on unlimited joints."""
    rng = np.random.default_rng(n)
    bodies = tuple(eq.Body(f"link {i}", float(rng.uniform(0.5, 4)), tuple(rng.uniform(-0.2, 0.2, 3))) for i in range(n))
    joints = tuple(
        eq.Joint(f"joint {i}", "revolute", f"link {i - 1}" if i else "world", f"link {i}",
                 tuple(rng.uniform(-0.3, 0.3, 3)), tuple(rng.uniform(-1.5, 1.5, 3)), axis=(0, 0, 1))
        for i in range(n)
    )  # fmt: skip
    return eq.Mechanism("any arm", bodies, joints)


@pytest.mark.parametrize("n", [2, *(pytest.param(n, marks=pytest.mark.deep) for n in range(3, 8))])
def test_real_joints_are_proved_on_the_branch_of_the_assembly_pose(n):
    """Its modules fold within the ranges, where another branch begins that does not balance: it is never met."""
    found = eq.design(any_arm(n), "pseudobase", real=True)
    assert found.free_parameters["folds"]
    assert found.balance.exact
    assert found.balance.relative < 1e-9

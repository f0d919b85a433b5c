"""Calibration against an independent linear program, brute force and the reference energy; exact where it can be."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from robots import planar_arm
from scipy.optimize import linprog

import equipoise as eq
from equipoise.energy import Potential
from equipoise.kinematics import Tree
from equipoise.model.errors import InputError
from equipoise.synthesis.calibrate.minimax import proved
from equipoise.synthesis.dials import columns, dials

ENDS = (
    ("world", (-0.03, 0, 0.2), "link2", (0.12, 0, 0.01)),
    ("link2", (0.1, 0, 0.12), "link3", (0.08, 0, 0.03)),
    ("link3", (0.25, 0, 0.1), "link4", (0.05, 0, 0.03)),
)
LAMP = planar_arm([0.4, 0.3, 0.5], [0.4, 0.4, 0.1], [0.2, 0.2, 0.05]).with_springs(
    eq.Spring(f"spring {i}", a, p, b, r, 100.0 + i, free_length=0.02) for i, (a, p, b, r) in enumerate(ENDS, 1)
)
NAMES = tuple(LAMP.coordinates)
REACHED: dict[str, float] = {NAMES[0]: 0.4, NAMES[1]: -0.3, NAMES[2]: 0.3}


def by_energy(mechanism: eq.Mechanism, q: np.ndarray) -> np.ndarray:
    """Torques by central differences of the energy."""
    n, step = q.shape[1], 1e-5
    states = [Potential(mechanism)(q + sign * step * np.eye(n)[j]) for j in range(n) for sign in (1, -1)]
    at = [state.gravity + state.springs.sum(axis=1) for state in states]
    return np.stack([(at[2 * j] - at[2 * j + 1]) / (2 * step) for j in range(n)], axis=1)


def independent(mechanism: eq.Mechanism, q: np.ndarray, shortest: np.ndarray) -> float:
    """The least largest torque by another program: nonnegative combinations of springs with extreme free lengths."""
    bare = mechanism.with_springs(())
    load = Potential(bare)(q).torque.ravel()
    extremes = [
        Potential(bare.with_springs([replace(s, stiffness=1.0, free_length=free)]))(q).torque.ravel() - load
        for s, most in zip(mechanism.springs, shortest, strict=True)
        for free in (0.0, most)
    ]
    T, one = np.stack(extremes, axis=1), np.ones((len(load), 1))
    A = np.vstack([np.hstack([T, -one]), np.hstack([-T, -one])])
    cost = np.append(np.zeros(T.shape[1]), 1.0)
    return linprog(cost, A, np.concatenate([-load, load]), method="highs-ipm").fun


def test_one_pose_is_balanced_to_rounding():
    found = eq.calibrate(LAMP, [REACHED])
    assert found.exact
    assert np.abs(found.after).max() < 1e-9
    assert np.abs(by_energy(found.mechanism, found.poses)).max() < 1e-6
    assert np.abs(Potential(found.mechanism)(found.poses).torque).max() < 1e-9
    assert found.proofs == ()


def test_what_cannot_be_is_proved_and_equals_another_program():
    poses: list[dict[str, float]] = [
        {NAMES[0]: a, NAMES[1]: b, NAMES[2]: c} for a, b, c in ((0.4, -1, 0.3), (1.0, -0.2, 0), (-0.3, 0.5, 0.4))
    ]
    found = eq.calibrate(LAMP, poses)
    shortest = Potential(LAMP)(found.poses).path.min(axis=0)
    least = independent(LAMP, found.poses, shortest)
    (proof,) = found.proofs
    assert least > 0.01
    assert proof.least == pytest.approx(least, rel=1e-6)
    assert found.largest("N m") == pytest.approx(least, rel=1e-6)
    assert np.abs(Potential(found.mechanism)(found.poses).torque).max() == pytest.approx(least, rel=1e-6)
    assert sum(abs(w) for _, _, w in proof.terms) == pytest.approx(1)
    rng, rows = np.random.default_rng(0), {(str(c), i): w for c, i, w in proof.terms}
    for _ in range(30):  # the proof holds for settings at random
        springs = [
            replace(s, stiffness=float(np.exp(rng.uniform(1, 8))), free_length=float(rng.uniform(0, most)))
            for s, most in zip(LAMP.springs, shortest, strict=True)
        ]
        torque = Potential(LAMP.with_springs(springs))(found.poses).torque
        mean = sum(w * torque[i, NAMES.index(name)] for (name, i), w in rows.items())
        assert mean >= proof.least * (1 - 1e-9)


def test_a_proof_needs_no_solver():
    q = np.array([[0.4, -1.0, 0.3], [1.0, -0.2, 0.0]])
    found = dials(LAMP, q, {})
    torque, load = columns(LAMP, found, q)
    A, b, rng = torque.reshape(6, -1), load.ravel(), np.random.default_rng(0)
    for _ in range(20):
        y = rng.normal(size=6)
        y /= np.abs(y).sum()
        bound = proved(A, b, y, found)
        for _ in range(20):
            x = np.concatenate([
                dial.unknowns(*(rng.uniform(*own.limits) for own in dial.settings)) for dial in found
            ])  # fmt: skip
            assert np.abs(A @ x + b).max() >= bound - 1e-9


def test_of_equals_the_nearest_to_the_file():
    """What balances already stays; with two springs on one joint the change is shared in proportion."""
    hinge = planar_arm([2.0], [0.5], [0.3])
    spring = eq.Spring("one", "world", (0, 0, 0.2), "link2", (0.15, 0, 0), 2.0 * 0.3 * 9.81 / (0.2 * 0.15))
    same = eq.calibrate(hinge.with_springs([spring]), [{"joint2": 0.3}])
    assert same.mechanism.springs[0].stiffness == pytest.approx(spring.stiffness, rel=1e-9)
    assert same.mechanism.springs[0].free_length == pytest.approx(0, abs=1e-9)
    moved = eq.calibrate(
        hinge.with_springs([spring]), [{"joint2": 0.3}, {"joint2": -0.3}], bounds={"one": {"stiffness": (300.0, 400.0)}}
    )  # what balances is not within the limits
    assert moved.largest("N m") == pytest.approx(moved.proofs[0].least, rel=1e-6)
    half = replace(spring, stiffness=spring.stiffness / 4)
    fixed = {name: {"free_length": (0.0, 0.0)} for name in ("one", "two")}
    found = eq.calibrate(hinge.with_springs([half, replace(half, name="two")]), [{"joint2": 0.3}], bounds=fixed)
    assert [s.stiffness for s in found.mechanism.springs] == pytest.approx([spring.stiffness / 2] * 2, rel=1e-9)


def test_every_kind_that_can_be_set_over_the_whole_workspace():
    hinge = planar_arm([2.0], [0.5], [0.3])
    hinge = replace(hinge, joints=(replace(hinge.joints[0], range=(-0.5, 1.0)),))
    ends = ("world", (0.05, 0, 0.2), "link2", (0.15, 0, 0))
    each = {
        "torsion": eq.TorsionSpring("x", (("joint2", 1.0),), 3.0, 0.2),
        "gas": eq.LineElement("x", "world", (0, 0, -0.2), "link2", (0.1, 0, 0), eq.laws.Gas(30.0, 0.4, 0.1, None, 1.3)),
        "constant": eq.LineElement("x", *ends, eq.laws.ConstantForce(5.0)),
        "torque": eq.JointElement("x", (("joint2", 1.0),), eq.laws.ConstantTorque(-1.0)),
        "extension": eq.LineElement("x", *ends, eq.laws.Extension(100.0, 0.05, 1.0)),
        "compression": eq.LineElement("x", *ends, eq.laws.Compression(100.0, 0.4)),
    }
    for name, element in each.items():
        found = eq.calibrate(replace(hinge.with_springs([element]), workspace=eq.Workspace(200)))
        torque = Potential(found.mechanism)(found.poses).torque
        np.testing.assert_allclose(torque, found.after, atol=1e-9, err_msg=name)
        before = np.abs(found.before).max()
        assert np.abs(torque).max() <= before * (1 + 1e-9), name
        rng = np.random.default_rng(1)
        for _ in range(20):  # nothing near it is better
            values = {own.field: own.after * (1 + rng.normal(0, 0.05)) for own in found.changes}
            if name == "gas":
                values["progression"] = 1.3
            other = found.mechanism.with_springs([e.changed(**values) for e in found.mechanism.springs])
            assert np.abs(Potential(other)(found.poses).torque).max() >= np.abs(torque).max() * (1 - 1e-6), name


def test_slides_apart():
    lift = eq.Mechanism(
        "lift",
        bodies=(eq.Body("car", 3.0), eq.Body("flap", 1.0, (0.2, 0, 0))),
        joints=(
            eq.Joint("slide", "prismatic", "world", "car", axis=(0, 0, 1), range=(0, 0.5)),
            eq.Joint("hinge", "revolute", "car", "flap", axis=(0, -1, 0), range=(-1, 1)),
        ),
        springs=(eq.TorsionSpring("flap spring", (("hinge", 1.0),), 2.0),),
    )
    found = eq.calibrate(lift, [{"slide": "100 mm", "hinge": 0.0}])
    (proof,) = found.proofs
    assert (proof.unit, proof.least) == ("N", pytest.approx(4 * 9.81))
    assert found.largest("N m") < 1e-9 * 4 * 9.81


def test_masses_change_where_a_bound_names_them():
    weight = eq.PointMass("weight", "link2", 0.1, (-0.2, 0, 0))
    hinge = planar_arm([2.0], [0.5], [0.3]).with_masses([weight])
    with pytest.raises(InputError, match="nothing to set"):
        eq.calibrate(hinge, [{"joint2": 0.0}])
    found = eq.calibrate(hinge, [{"joint2": 0.0}], bounds={"weight": {"mass": (0.0, 5.0)}})
    assert found.mechanism.masses[0].mass == pytest.approx(3.0, rel=1e-9)
    assert eq.check(found.mechanism).exact


MJCF = """<mujoco model="lamp"><compiler angle="radian"/><worldbody>
<site name="post" pos="-.03 0 .2"/>
<body name="lower"><joint name="shoulder" axis="0 -1 0"/><geom type="box" size=".2 .01 .01" pos=".2 0 0" mass=".4"/>
<site name="l1" pos=".12 0 .01"/><site name="l2" pos=".1 0 .12"/>
<body name="upper" pos=".4 0 0"><joint name="elbow" axis="0 -1 0"/>
<geom type="box" size=".2 .01 .01" pos=".2 0 0" mass=".3"/>
<site name="u" pos=".08 0 .03"/></body></body></worldbody>
<tendon><spatial name="s1" stiffness="150" springlength="0"><site site="post"/><site site="l1"/></spatial>
<spatial name="s2" stiffness="90" springlength="0"><site site="l2"/><site site="u"/></spatial></tendon></mujoco>"""


def test_command_line_and_mjcf(run, tmp_path):
    pytest.importorskip("mujoco")
    file, out = tmp_path / "lamp.xml", tmp_path / "set.yaml"
    file.write_text(MJCF)
    code, text, err = run("calibrate", file, "--pose", "shoulder=0.4,elbow=-20 deg", "-o", out)
    assert code == 0, err
    assert "BALANCED" in text
    q = np.array([[0.4, -np.radians(20)]])
    assert np.abs(Potential(eq.load(out))(q).torque).max() < 1e-9
    bound = ("--bound", "s1.stiffness=5:10 N/m", "--bound", "s1.free_length=0")
    code, text, _ = run("calibrate", file, "--pose", "shoulder=0.4,elbow=-20 deg", *bound)
    assert code == 1
    assert "Impossible: at least" in text
    assert "proof: whatever is set" in text
    code, text, _ = run("calibrate", file, "--all", *bound, "--json")
    answer = json.loads(text)
    assert code == 1
    assert answer["residual"]["N m"] == pytest.approx(answer["bound"]["N m"], rel=1e-6)
    change = next(c for c in answer["changes"] if (c["item"], c["field"]) == ("s1", "stiffness"))
    assert 5 <= change["after"] <= 10


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "--pose JOINT=VALUE,... once or more, or --all"),
        (("--pose", f"{NAMES[0]}=1", "--all"), "or --all"),
        (("--pose", f"{NAMES[0]}=1"), f"has no value for {NAMES[1]}, {NAMES[2]}"),
        (("--pose", "jont2=1"), "did you mean 'joint2'"),
        (("--pose", "joint2=1 kg,joint3=0,joint4=0"), "angle"),
        (("--pose", "joint2=1,joint2=2"), "given twice"),
        (("--pose", "joint2"), "JOINT=VALUE"),
        (("--all", "--bound", "sprng 1.stiffness=1:2"), "did you mean 'spring 1'"),
        (("--all", "--bound", "spring 1.stifness=1:2"), "did you mean 'stiffness'"),
        (("--all", "--bound", "spring 1.stiffness=3:2"), "lesser to a greater"),
        (("--all", "--bound", "spring 1.stiffness=1:2 kg"), "stiffness"),
        (("--all", "--bound", "spring 1.rest=0:1"), "has no number"),
        (("--all", "--bound", "spring 1"), "ITEM.FIELD=LOW:HIGH"),
        (("--all", "--hold", "spring 1,spring 2,spring 3"), "nothing to set"),
    ],
)
def test_bad_input(run, tmp_path, options, message):
    file = tmp_path / "lamp.yaml"
    eq.save(LAMP, file)
    code, out, err = run("calibrate", file, *options)
    assert (code, out) == (2, "")
    assert message in err


def test_outside_a_joint():
    held = replace(LAMP, joints=(replace(LAMP.joints[0], range=(-0.1, 0.1)), *LAMP.joints[1:]))
    with pytest.raises(InputError, match="outside its range"):
        eq.calibrate(held, [REACHED])
    assert Tree.of(held).n == 3

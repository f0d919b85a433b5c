"""Torsion springs: against MuJoCo, closed forms, differences and series; in files, verdicts, pictures and refusals."""

from __future__ import annotations

import json
from math import pi
from pathlib import Path

import numpy as np
import pytest
from in_mujoco import mujoco_state
from peers import peer
from random_mechanisms import random_mechanism, random_poses, with_torsion

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.energy.fourier.energy import FourierEnergy
from equipoise.energy.kernel import Kernel
from equipoise.io import mjcf
from equipoise.io.yaml import to_text
from equipoise.kinematics import Tree
from equipoise.model.errors import EquipoiseWarning, InputError, NoFourierForm, UnsupportedError
from equipoise.model.mechanism import JOINT_TYPES

HINGE = """\
schema: 1
name: hinge
bodies: [{name: arm, mass: 1, com: [50.96839959225280 mm, 0, 0]}]
joints: [{name: shoulder, type: revolute, parent: world, child: arm, axis: [0, -1, 0], range: [0, 90 deg]}]
springs: [{name: coil, kind: torsion, joint: shoulder, stiffness: 0.3183 N m/rad, rest: 90 deg}]
"""


@pytest.fixture
def hinge(tmp_path: Path) -> Path:
    """A joint that holds 0.5 cos(angle) N m by itself."""
    path = tmp_path / "hinge.yaml"
    path.write_text(HINGE)
    return path


def test_200_mechanisms_agree_with_mujoco() -> None:
    mujoco = peer("mujoco")
    done, on_sums, seed = 0, 0, 70_000
    while done < 200:
        seed += 1
        m = with_torsion(random_mechanism(seed, most_joints=5, kinds=(*JOINT_TYPES, "revolute", "revolute")), seed)
        torsion = [spring for spring in m.springs if isinstance(spring, eq.TorsionSpring)]
        try:
            model = mujoco.MjModel.from_xml_string(mjcf.to_text(m))
        except UnsupportedError:
            continue  # a ball between what a parallelogram joins and what it follows
        if not torsion:
            continue
        done += 1
        on_sums += any(len(spring.joints) > 1 for spring in torsion)
        q = random_poses(m, 2, seed)
        state, found = Potential(m)(q), [mujoco_state(m, model, pose) for pose in q]
        size = 1 + np.abs(state.gravity).max() + np.abs(state.springs).sum(axis=1).max()
        assert np.ptp(state.energy - [energy for energy, _, _ in found]) <= 1e-10 * size, seed
        expected = np.array([gravity + springs for _, gravity, springs in found])
        assert np.abs(state.torque - expected).max(initial=0) <= 1e-10 * (1 + np.abs(expected).max(initial=0)), seed
    assert on_sums > 60


@pytest.mark.parametrize("seed", range(20))
def test_kernel_series_and_differences_agree_with_the_sum(seed: int) -> None:
    m = with_torsion(random_mechanism(seed, most_joints=4, free_lengths=False), seed)
    q = random_poses(m, 40, seed)
    state, n = Potential(m).reference(q), len(m.coordinates)
    size = 1 + np.abs(state.energy).max()
    for recursion in ("numpy", "generic"):
        parts = Kernel(m).parts(q, tier=recursion)
        np.testing.assert_allclose(parts.path, state.path, atol=1e-12 * size)
        np.testing.assert_allclose(parts.spring_torque, state.spring_torque, atol=1e-12 * size)
    np.testing.assert_allclose(Kernel(m)(q).energy, state.energy, atol=1e-12 * size)
    try:
        series = FourierEnergy(m)
    except NoFourierForm:
        series = None  # too many terms
    if series is not None:
        np.testing.assert_allclose(series.energy(q), state.energy, atol=1e-10 * size)
        np.testing.assert_allclose(series.torque(q), state.torque, atol=1e-10 * size)
    h = 1e-5
    for j in range(n):
        step = h * np.eye(n)[j]
        slope = (Potential(m).reference(q[:3] + step).energy - Potential(m).reference(q[:3] - step).energy) / (2 * h)
        np.testing.assert_allclose(slope, state.torque[:3, j], atol=1e-5 * size)


def test_a_loop_turns_a_spring_on_a_dependent_joint() -> None:
    """The rocker of a parallelogram turns as its crank does: a spring on either is the same."""
    bodies = (eq.Body("crank", 1.0, (0.1, 0, 0)), eq.Body("coupler", 1.0, (0.2, 0, 0)), eq.Body("rocker"))
    joints = (
        eq.Joint("a", "revolute", "world", "crank", axis=(0, -1, 0), range=(-1.2, 1.2)),
        eq.Joint("b", "revolute", "crank", "coupler", xyz=(0.2, 0, 0), axis=(0, -1, 0)),
        eq.Joint("c", "revolute", "world", "rocker", xyz=(0, 0, -0.4), axis=(0, -1, 0)),
    )
    loop = eq.Loop("coupler", (0.0, 0, -0.4), "rocker", (0.2, 0, 0))
    m = eq.Mechanism("parallelogram", bodies, joints, loops=(loop,), independent=("a",))
    assert Tree.of(m).coordinates == ("a",)
    q = np.linspace(-1, 1, 9)[:, None]
    found = [
        Potential(m.with_springs([eq.TorsionSpring("s", terms, 3.0, 0.4)]))(q)
        for terms in ((("a", 1.0),), (("c", 1.0),), (("b", -1.0),))
    ]
    np.testing.assert_allclose(found[0].spring_torque, 3.0 * (q - 0.4), atol=1e-9)
    np.testing.assert_allclose(found[1].spring_torque, found[0].spring_torque, atol=1e-7)
    np.testing.assert_allclose(found[2].spring_torque, found[0].spring_torque, atol=1e-7)


def test_the_best_spring_of_a_hinge_leaves_a_fifth_inside_the_range(hinge: Path, run) -> None:
    """0.5 cos(x) + 0.3183 (x - pi/2): nothing at the ends, and at sin(x) = 0.6366 as much as is left anywhere."""
    code, out, _ = run("check", hinge, "--json")
    assert code == 1
    found = json.loads(out)
    x = np.arcsin(0.3183 / 0.5)
    worst = 0.5 * np.cos(x) + 0.3183 * (x - pi / 2)
    assert worst == pytest.approx(0.1053, abs=5e-5)
    assert found["torque"]["residual"]["max"] == pytest.approx([worst], rel=1e-6)
    assert found["worst"]["configuration"] == pytest.approx([x], abs=1e-3)
    assert found["certificate"]["kind"] == "fourier"  # its polynomial form counts, as a slide's does
    assert found["torque"]["bound"][0] >= worst
    (spring,) = found["springs"]
    assert spring == {
        "name": "coil", "kind": "torsion", "joints": {"shoulder": 1.0}, "stiffness": 0.3183,
        "rest": pytest.approx(pi / 2), "path": pytest.approx([0, pi / 2], abs=1e-6),
        "force": pytest.approx([-0.3183 * pi / 2, 0], abs=1e-6), "unit": "N m",
    }  # fmt: skip
    code, out, _ = run("check", hinge)
    assert "coil: 0.3183 N m/rad on shoulder, relaxed at 90 deg, 0.0 to 90.0 deg, up to 0.5 N m" in out


def test_two_springs_on_a_sum_that_never_turns_leave_the_balance_exact() -> None:
    """A coupling keeps the sum of two angles: a spring on it is a constant."""
    bodies = (eq.Body("one"), eq.Body("two"))
    joints = tuple(
        eq.Joint(f"j{i}", "revolute", "world", name, axis=(0, 0, 1)) for i, name in enumerate(("one", "two"))
    )
    coupling = (eq.Coupling("j1", (("j0", -1.0),), 0.3),)
    spring = eq.TorsionSpring("s", (("j0", 1.0), ("j1", 1.0)), 5.0, 1.0)
    assert eq.check(eq.Mechanism("gears", bodies, joints, coupling, springs=(spring,))).exact
    alone = eq.TorsionSpring("s", (("j0", 1.0),), 5.0, 1.0)
    assert not eq.check(eq.Mechanism("gears", bodies, joints, coupling, springs=(alone,))).exact


def test_files_keep_it(tmp_path: Path, hinge: Path) -> None:
    m = eq.load(hinge)
    terms = (("shoulder", 2.0),)
    m = m.with_springs([*m.springs, eq.TorsionSpring("geared", terms, 1.25, -1.0), eq.TorsionSpring("o", terms, 2.0)])
    path = tmp_path / "again.yaml"
    path.write_text(to_text(m))
    assert eq.load(path) == m
    assert "joint: shoulder" in to_text(m)
    assert "joints: {shoulder: 2.0}" in to_text(m)
    peer("mujoco")
    model = tmp_path / "again.xml"
    with pytest.warns(EquipoiseWarning, match="inertia"):
        model.write_text(mjcf.to_text(m))
    read, q = eq.load(model), np.linspace(-1, 1, 5)[:, None]
    assert [spring.name for spring in read.springs] == ["coil", "geared", "o"]
    np.testing.assert_allclose(Potential(read)(q).spring_torque, Potential(m)(q).spring_torque, atol=1e-12)


def test_the_stiffness_of_a_hinge_is_read(tmp_path: Path) -> None:
    """Of a joint that is drawn at 0.2 rad, too."""
    mujoco = peer("mujoco")
    path = tmp_path / "arm.xml"
    path.write_text(
        '<mujoco><compiler angle="radian"/><worldbody><body name="arm" pos="0 0 0.3"><joint name="shoulder" '
        'type="hinge" axis="0 -1 0" range="-1 1" ref="0.2" stiffness="5" springref="1.2"/>'
        '<geom type="sphere" size="0.02" pos="0.2 0 0" mass="3"/></body></worldbody></mujoco>'
    )
    m, model = eq.load(path), mujoco.MjModel.from_xml_path(str(path))
    assert m.springs == (eq.TorsionSpring("shoulder spring", (("shoulder", 1.0),), 5.0, 1.2),)
    data = mujoco.MjData(model)
    for q in (-1.0, 0.0, 0.7):
        data.qpos[:] = q
        mujoco.mj_forward(model, data)
        np.testing.assert_allclose(Potential(m)(q).torque[0], data.qfrc_bias - data.qfrc_passive, atol=1e-12)


@pytest.mark.parametrize(
    ("found", "message"),
    [
        ("joint: elbow", "there is no revolute joint 'elbow' (valid: shoulder)"),
        ("joints: {shoulder: 0}", "its ratio must be finite and not 0, found 0"),
        ("joint: shoulder, joints: {shoulder: 1}", "give 'joint', or 'joints' with a ratio each, and not both"),
        ("rest: 0", "give 'joint', or 'joints' with a ratio each, and not both"),
        ("joint: shoulder, rest: 3 mm", "expected a number [rad] or text with a unit of angle (rad), found '3 mm'"),
        ("joint: shoulder, free_length: 0", "unknown key 'free_length' (valid: name, kind, joint, joints, "),
    ],
)  # fmt: skip
def test_a_wrong_key_is_said_with_its_line(tmp_path: Path, run, found: str, message: str) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(HINGE.replace("joint: shoulder, stiffness: 0.3183 N m/rad, rest: 90 deg", f"stiffness: 2, {found}"))
    code, _, err = run("check", path)
    assert code == 2
    assert message in " ".join(err.split())
    assert "bad.yaml:5:" in err


def test_a_kind_that_does_not_exist_is_named(tmp_path: Path, run) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(HINGE.replace("kind: torsion", "kind: torsoin"))
    code, _, err = run("check", path)
    assert code == 2
    assert "no kind of spring 'torsoin'; did you mean 'torsion'? (valid: linear, extension, " in " ".join(err.split())


def test_what_cannot_serve_it_says_so_by_name(hinge: Path, tmp_path: Path, run) -> None:
    stock = tmp_path / "stock.csv"
    assert run("made-up", "--count", "5", "-o", stock)[0] == 0
    commands = (
        ("stock", hinge, stock),
        ("tolerance", hinge),
        ("adjust", hinge, "--payload", "0,1", "--payload-on", "arm", "--payload-at", "0.1,0,0"),
    )
    for command in commands:
        code, _, err = run(*command)
        assert code == 2, command
        assert "'coil' is a torsion spring" in " ".join(err.split()), command
        assert command[0] in err


def test_where_every_spring_is_on_a_joint_there_is_no_room_to_judge(hinge: Path, run) -> None:
    code, out, _ = run("clearance", hinge, "--samples", 50)
    assert code == 1  # nothing says how large the links are
    text = " ".join(out.split())
    assert "NOTHING TO JUDGE: no spring or weight has anything to come close to" in text
    assert "not judged: coil (a torsion spring: no size is known)" in text
    code, out, _ = run("clearance", hinge, "--samples", 50, "--json")
    found = json.loads(out)
    assert (found["least"], found["gaps"], found["springs"]) == (None, [], [])
    assert eq.clearance(hinge, samples=50).nearest == (np.inf,) * 50


def test_it_is_drawn_and_designed_around(hinge: Path, tmp_path: Path, run) -> None:
    """Kept as a load, with a spring between points beside it; drawn in figure, schematic, report and page."""
    out = tmp_path / "both.yaml"
    figure, page = tmp_path / "both.png", tmp_path / "both.html"
    code, _, err = run("design", hinge, "--keep", "--radius", "100mm", "-o", out, "--plot", figure)
    assert code == 0, err
    code, _, err = run("report", out, "-o", page)
    assert code == 0, err
    m = eq.load(out)
    assert [spring.kind for spring in m.springs][:1] == ["torsion"]
    assert eq.check(m).residual.max[0] < 0.7 * eq.check(eq.load(hinge)).residual.max[0]
    assert figure.stat().st_size > 1000
    text = page.read_text()
    assert "k [N m/rad]" in text
    assert "relaxed at [deg]" in text
    for target in ("svg", "dxf"):
        code, _, err = run("export", out, "--to", target, "-o", tmp_path / f"both.{target}")
        assert code == 0, err


def test_a_faulty_value_is_an_error() -> None:
    m = random_mechanism(1, kinds=("revolute",))
    for spring in (
        eq.TorsionSpring("s", (), 1.0),
        eq.TorsionSpring("s", (("j0", 1.0), ("j0", 2.0)), 1.0),
        eq.TorsionSpring("s", (("j0", 1.0),), -1.0),
        eq.TorsionSpring("s", (("j0", 1.0),), 1.0, float("nan")),
        eq.TorsionSpring("s", (("j0", float("inf")),), 1.0),
    ):
        with pytest.raises(InputError):
            m.with_springs([spring])

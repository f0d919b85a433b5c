"""Cables over pulleys: closed forms, MuJoCo, differences; in files, verdicts and MJCF."""

from __future__ import annotations

import json
from math import acos, atan2, cos, hypot, pi, sin
from pathlib import Path

import numpy as np
import pytest
from in_mujoco import set_pose
from peers import peer

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.energy.kernel import Kernel
from equipoise.io import mjcf
from equipoise.io.yaml import to_text
from equipoise.kinematics import Tree
from equipoise.model.errors import UnsupportedError

R, A, C, K = 0.05, 0.3, 0.2, 150.0
FILE = """\
schema: 1
name: over a pulley
bodies: [{name: arm, mass: 1, com: [0.2, 0, 0], inertia: [0.01, 0.01, 0.01, 0, 0, 0]}]
joints: [{name: hinge, type: revolute, parent: world, child: arm, axis: [0, -1, 0], range: [-80 deg, 60 deg]}]
springs:
  - {name: cabled, body_a: world, p_a: [-0.3, 0, 0], body_b: arm, p_b: [0.2, 0, 0], stiffness: 150, free_length: 0.1,
     via: [{body: world, point: [0, 0, 0], radius: 50 mm, axis: [0, 2, 0], side: [0, 0, 100 mm]}]}
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "pulley.yaml"
    path.write_text(FILE)
    return path


def length(q: float) -> tuple[float, float]:
    """The cable from (-A, 0) over the top of a pulley of radius R about the joint to C (cos q, sin q), and dL/dq: two
    tangents and an arc while it lies on the pulley, then straight."""
    arc = pi - q - acos(R / A) - acos(R / C)
    if arc > 0:
        return hypot(A, 0) * sin(acos(R / A)) + C * sin(acos(R / C)) + R * arc, -R
    L = hypot(C * cos(q) + A, C * sin(q))
    return L, -A * C * sin(q) / L


def test_a_pulley_about_a_joint_against_its_formula(file: Path) -> None:
    m, q = eq.load(file), np.linspace(-1.3, 1.0, 47)
    both = [length(x) for x in q]
    assert 10 < sum(slope == -R for _, slope in both) < 40
    state = Potential(m)(q[:, None])
    np.testing.assert_allclose(state.path[:, 0], [L for L, _ in both], atol=1e-14)
    expected = [9.81 * 0.2 * cos(x) + K * (L - 0.1) * slope for x, (L, slope) in zip(q, both, strict=True)]
    np.testing.assert_allclose(state.torque[:, 0], expected, atol=1e-12)
    with pytest.raises(UnsupportedError, match="'cabled' lies on a pulley"):
        Kernel(m)


def test_a_cable_askew_is_straight_when_rolled_out() -> None:
    """On a pulley of the world, its ends 0.2 m apart along the axis: the hypotenuse of that and the flat length."""
    pulley = eq.Pulley("world", (0.0, 0.0, 0.1), R, (0.0, 3.0, 0.0), (0.0, 0.5, 0.3))
    cable = eq.LineElement("s", "world", (-A, 0.1, 0.0), "arm", (C, -0.1, 0.0), eq.laws.Linear(K), (pulley,))
    joint = eq.Joint("hinge", "revolute", "world", "arm", axis=(0, -1, 0))
    m = eq.Mechanism("askew", (eq.Body("arm", 1.0),), (joint,), springs=(cable,))
    (x_a, z_a), (x_b, z_b) = (-A, -0.1), (C, -0.1)
    arc = pi + atan2(-z_a, -x_a) + atan2(-z_b, x_b) - acos(R / hypot(x_a, z_a)) - acos(R / hypot(x_b, z_b))
    flat = sum((hypot(x, z) ** 2 - R**2) ** 0.5 for x, z in ((x_a, z_a), (x_b, z_b))) + R * arc
    state = Potential(m)(np.zeros((1, 1)))
    assert state.path[0, 0] == pytest.approx(hypot(flat, 0.2), rel=1e-12)
    tree = Tree.of(m)
    _, (askew, fleet) = cable.routing(tree, tree.poses(np.zeros((1, 1))))
    assert fleet == pytest.approx([atan2(0.2, flat)], rel=1e-12)
    assert askew.holds(fleet).all()
    assert any(one.state == askew and one.share > 0.3 for one in eq.check(m).use[0].reached)


@pytest.mark.parametrize("seed", range(6))
def test_differences_and_mujoco_agree_on_moving_pulleys(seed: int) -> None:
    """A pulley on a link that moves, between two others that do."""
    mujoco = peer("mujoco")
    rng = np.random.default_rng(seed)
    names = ("one", "two", "three")
    joints = tuple(
        eq.Joint(f"j{i}", "revolute", parent, name, (0.2, 0, 0), axis=tuple(rng.normal(size=3)))
        for i, (parent, name) in enumerate(zip(("world", *names), names, strict=False))
    )
    x, y, z = (float(v) for v in rng.uniform(-0.05, 0.05, 3))
    pulley = eq.Pulley("two", (x, y, z), 0.06, (0.1, 1.0, 0.2), (x, y, z + 0.2))
    cable = eq.LineElement("s", "world", (0.0, 0.1, 0.0), "three", (0.2, 0.0, 0.1), eq.laws.Linear(K), (pulley,))
    inertia = (0.01, 0.01, 0.01, 0.0, 0.0, 0.0)
    m = eq.Mechanism("three", tuple(eq.Body(n, 1.0, inertia=inertia) for n in names), joints, springs=(cable,))
    q = rng.uniform(-0.8, 0.8, (8, 3))
    state, h = Potential(m)(q), 1e-6
    for j in range(3):
        step = h * np.eye(3)[j]
        slope = (Potential(m)(q + step).energy - Potential(m)(q - step).energy) / (2 * h)
        np.testing.assert_allclose(slope, state.torque[:, j], atol=1e-5)
    model = mujoco.MjModel.from_xml_string(mjcf.to_text(m))
    for pose, path in zip(q, state.path[:, 0], strict=True):
        data = set_pose(m, model, dict(zip(m.coordinates, pose.tolist(), strict=True)))
        assert data.tendon("s").length[0] == pytest.approx(path, rel=1e-12)


def test_files_keep_it(file: Path, tmp_path: Path) -> None:
    peer("mujoco")
    m = eq.load(file)
    (pulley,) = m.springs[0].via
    assert pulley == eq.Pulley("world", (0.0, 0.0, 0.0), 0.05, (0.0, 2.0, 0.0), (0.0, 0.0, 0.1))
    again, model = tmp_path / "again.yaml", tmp_path / "again.xml"
    again.write_text(to_text(m))
    assert eq.load(again) == m
    model.write_text(mjcf.to_text(m))
    back, q = eq.load(model), np.linspace(-1.3, 1, 9)[:, None]
    np.testing.assert_allclose(Potential(back)(q).torque, Potential(m)(q).torque, atol=1e-12)
    assert back.springs[0].via[0].side == pulley.side


def test_check_says_where_a_cable_leaves_its_pulley(file: Path, run) -> None:
    """At angles above pi - acos(R/A) - acos(R/C) = 24.1 deg it is straight: 36 of 140 deg."""
    _, out, _ = run("check", file, "--json")
    (spring,) = json.loads(out)["springs"]
    (off,) = spring["states"]
    assert (off["state"], off["limit"]) == ("off its pulley 1", False)
    most = pi - acos(R / A) - acos(R / C)
    assert off["share"] == pytest.approx((pi / 3 - most) / (7 * pi / 9), abs=0.02)
    assert spring["via"][0]["radius"] == 0.05
    _, out, _ = run("check", file)
    assert "off its pulley 1" in out


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("radius: 50 mm, ", "", "a pulley has 'radius', 'axis' and 'side'"),
        ("side: [0, 0, 100 mm]", "side: [0, 0, 40 mm]", "must be outside the pulley, farther than its radius"),
        ("axis: [0, 2, 0]", "axis: [0, 0, 0]", "axis: must not be zero"),
        ("radius: 50 mm", "radius: 0", "radius: must be more than 0 m, found 0"),
        ("100 mm]}]", "100 mm]}, {body: arm, point: [0, 0, 0], radius: 9 mm, axis: [0, 1, 0], side: [1, 0, 0]}]",
         "follows another pulley: give a guide point between them"),
    ],
)  # fmt: skip
def test_a_wrong_pulley_is_said_with_its_line(file: Path, run, old: str, new: str, message: str) -> None:
    file.write_text(FILE.replace(old, new))
    code, _, err = run("check", file)
    assert code == 2
    assert message in " ".join(err.split())
    assert "pulley.yaml:7:" in err


def test_it_is_let_go_and_drawn(file: Path, tmp_path: Path, run) -> None:
    peer("mujoco")
    from equipoise.simulate.engine import Engine

    m = eq.load(file)
    engine, q = Engine(m), np.array([0.2])
    engine.place(q)
    np.testing.assert_allclose(engine.holding(), Potential(m)(q).torque[0], atol=1e-12)
    for target in ("svg", "dxf"):
        assert run("export", file, "--to", target, "-o", tmp_path / f"drawn.{target}")[0] == 0
    code, _, err = run("report", file, "-o", tmp_path / "drawn.html")
    assert code == 0, err
    assert "off its pulley 1" in (tmp_path / "drawn.html").read_text()

"""Elements of every law on every path against MuJoCo, the kernel and differences; in simulations and in designs."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from campaign import campaign
from in_mujoco import mujoco_state
from peers import peer
from random_mechanisms import random_mechanism, random_poses, with_elements

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.energy.kernel import Kernel
from equipoise.io import mjcf
from equipoise.model.elements import Element
from equipoise.model.errors import EquipoiseWarning, UnsupportedError
from equipoise.model.mechanism import JOINT_TYPES, Mechanism

JOINTS = (*JOINT_TYPES, "revolute", "revolute")


def smooth(m: Mechanism, path: np.ndarray) -> bool:
    """Whether no element is within a nanometre of a kink of its law, or of a length of 0."""

    def kinks(spring: Element) -> list[float]:
        return [0.0] * (spring.path_unit == "m") + [state.beyond for state in spring.law.states]

    return all(abs(s - kink) > 1e-9 for spring, s in zip(m.springs, path, strict=True) for kink in kinks(spring))


@campaign(500)
def test_random_mechanisms_with_mixed_elements_agree_with_mujoco(seeds: range) -> None:
    mujoco = peer("mujoco")
    for seed in seeds:
        m = with_elements(random_mechanism(80_000 + seed, most_joints=5, kinds=JOINTS), seed)
        try:
            model = mujoco.MjModel.from_xml_string(mjcf.to_text(m, warn=False))
        except UnsupportedError:
            continue  # a ball between what a parallelogram joins and what it follows
        q = random_poses(m, 3, seed)
        state, found = Potential(m)(q), [mujoco_state(m, model, pose) for pose in q]
        keep = [smooth(m, path) for path in state.path]
        assert any(keep), seed
        size = 1 + np.abs(state.gravity).max() + np.abs(state.springs).sum(axis=1).max()
        assert np.ptp((state.energy - [energy for energy, _, _ in found])[keep]) <= 1e-9 * size, seed
        expected = np.array([gravity + springs for _, gravity, springs in found])
        off = np.abs(state.torque - expected)[keep].max(initial=0)
        assert off <= 1e-9 * (1 + np.abs(expected).max(initial=0)), seed


@pytest.mark.parametrize("seed", range(12))
def test_kernel_and_differences_agree_with_the_sum(seed: int) -> None:
    m = with_elements(random_mechanism(seed, most_joints=4, kinds=JOINTS), seed, pulleys=False)
    q = random_poses(m, 40, seed)
    state, n = Potential(m).reference(q), len(m.coordinates)
    size = 1 + np.abs(state.energy).max() + np.abs(state.torque).max(initial=0)
    for tier in ("numpy", "generic", "generated") if seed < 4 else ("numpy",):
        parts = Kernel(m).parts(q, tier=tier)  # type: ignore[arg-type]
        np.testing.assert_allclose(parts.path, state.path, atol=1e-12 * size)
        np.testing.assert_allclose(parts.spring_torque, state.spring_torque, atol=1e-11 * size)
        np.testing.assert_allclose(Kernel(m)(q, tier=tier).energy, state.energy, atol=1e-11 * size)  # type: ignore[arg-type]
    h = 1e-6
    for j in range(n):
        step = h * np.eye(n)[j]
        slope = (Potential(m).reference(q[:3] + step).energy - Potential(m).reference(q[:3] - step).energy) / (2 * h)
        np.testing.assert_allclose(slope, state.torque[:3, j], atol=1e-4 * size)


def test_a_cable_through_a_point_against_its_formula() -> None:
    """A cable over (0, h) to c (cos q, sin q): what is behind the point is constant, dL/dq = -h c cos q / L."""
    h, c, k, q = 0.12, 0.1, 300.0, np.linspace(-1.3, 1.3, 27)
    joint = eq.Joint("hinge", "revolute", "world", "arm", axis=(0, -1, 0))
    cable = eq.LineElement(
        "s", "world", (-0.3, 0, -0.1), "arm", (c, 0, 0), eq.laws.Linear(k, 0.3), (eq.Guide("world", (0, 0, h)),)
    )
    m = eq.Mechanism("arm", (eq.Body("arm", 1.0, (0.2, 0, 0)),), (joint,), springs=(cable,))
    L = np.sqrt(h**2 + c**2 - 2 * h * c * np.sin(q))
    expected = 9.81 * 0.2 * np.cos(q) + k * (np.hypot(0.3, 0.22) + L - 0.3) * (-h * c * np.cos(q) / L)
    for found in (Potential(m).reference(q[:, None]), Kernel(m)(q[:, None], tier="numpy")):
        np.testing.assert_allclose(found.torque[:, 0], expected, atol=1e-12)


FIELD = """<mujoco model="arm"><compiler angle="degree"/><worldbody><site name="post" pos="{post}"/>
<site name="mid" pos="0 0 0.12"/><body name="arm"><joint name="shoulder" type="hinge" axis="0 -1 0" range="-80 80"/>
<geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.02" mass="1"/><site name="hook" pos="0.1 0 0"/></body></worldbody>
<tendon><spatial name="spring" stiffness="300" springlength="{rest}">
<site site="post"/>{mid}<site site="hook"/></spatial></tendon></mujoco>"""


@pytest.mark.parametrize(
    ("post", "rest", "mid", "behind", "body"),
    [("0 0 0.12", "0 0.08", "", 0.0, 0.08), ("-0.3 0 -0.1", "0.3", '<site site="mid"/>', np.hypot(0.3, 0.22), None)],
    ids=["slack", "routed"],
)  # fmt: skip
def test_slack_and_routed_tendons_are_read(
    tmp_path: Path, post: str, rest: str, mid: str, behind: float, body: float | None
) -> None:
    """m g l cos q + k max(0, L - 0.08)/L d.dd/dq, and the same behind an eyelet (`cases/field/10`)."""
    peer("mujoco")
    path = tmp_path / "arm.xml"
    path.write_text(FIELD.format(post=post, rest=rest, mid=mid))
    m, q = eq.load(path), np.linspace(-1.3, 1.3, 40)
    L = np.sqrt(0.12**2 + 0.1**2 - 2 * 0.12 * 0.1 * np.sin(q))
    force = 300 * (np.maximum(L - body, 0) if body else L + behind - 0.3)
    expected = 9.81 * 0.2 * np.cos(q) - force * 0.12 * 0.1 * np.cos(q) / L
    np.testing.assert_allclose(Potential(m)(q[:, None]).torque[:, 0], expected, atol=1e-9)
    (spring,) = m.springs
    assert spring.kind == ("extension" if body else "linear")


def test_mjcf_holds_what_it_can_and_names_the_rest(tmp_path: Path) -> None:
    peer("mujoco")
    joint = eq.Joint("hinge", "revolute", "world", "arm", axis=(0, -1, 0))
    ends = ("world", (0.0, 0.0, 0.3), "arm", (0.1, 0.0, 0.0))
    via = (eq.Guide("world", (0.0, 0.0, 0.12)),)
    held = (
        eq.LineElement("hooked", *ends, eq.laws.Extension(900.0, 0.25)),
        eq.LineElement("pressed", *ends, eq.laws.Compression(900.0, 0.25)),
        eq.LineElement("drum", *ends, eq.laws.ConstantForce(4.0), via),
        eq.LineElement("routed", *ends, eq.laws.Linear(300.0, 0.1), via),
        eq.Spring("tight", *ends, 20.0, -0.05),
        eq.JointElement("motor", (("hinge", 2.0),), eq.laws.ConstantTorque(0.2)),
    )
    inertia = (0.01, 0.01, 0.01, 0.0, 0.0, 0.0)
    m = eq.Mechanism("arm", (eq.Body("arm", 1.0, (0.2, 0, 0), inertia),), (joint,), springs=held)
    path = tmp_path / "arm.xml"
    path.write_text(mjcf.to_text(m))
    assert {s.name: s for s in eq.load(path).springs} == {s.name: s for s in held}
    gas = eq.LineElement("strut", *ends, eq.laws.Gas(200.0, 0.4, 0.2, progression=1.3))
    path.write_text(mjcf.to_text(m.with_springs([gas])))
    q = np.linspace(-1, 1, 9)[:, None]
    back = eq.load(path)
    assert back.springs[0].kind == "linear"  # its stroke is not held, its force is
    np.testing.assert_allclose(Potential(back)(q).torque, Potential(m.with_springs([gas]))(q).torque, atol=1e-9)
    table = eq.LineElement("measured", *ends, eq.laws.Table(((0.2, 1.0), (0.4, 3.0))))
    with pytest.warns(EquipoiseWarning, match="cannot hold the force of 'measured' \\(a measured spring\\)"):
        path.write_text(mjcf.to_text(m.with_springs([table])))
    with pytest.warns(EquipoiseWarning, match="what it pulls without being told to is left out"):
        assert eq.load(path).springs == ()


def test_simulate_lets_go_with_laws_that_the_engine_lacks(tmp_path: Path, run) -> None:
    """A cam that undoes gravity stays; with one per cent less it does not. A table of the same torque falls back."""
    peer("mujoco")
    text = """\
schema: 1
name: cam
bodies: [{name: arm, mass: 1, com: [0.2, 0, 0], inertia: [0.01, 0.01, 0.01, 0, 0, 0]}]
joints: [{name: hinge, type: revolute, parent: world, child: arm, axis: [0, -1, 0], range: [-70 deg, 70 deg]}]
springs: [{name: snail, kind: cam, joint: hinge, sine: [-1.962]}]
"""
    path = tmp_path / "cam.yaml"
    path.write_text(text)
    code, out, err = run("simulate", path, "--poses", "2", "--seconds", "1", "--json")
    assert code == 0, err
    found = json.loads(out)
    assert found["stays"]
    assert found["max_drift"] < 1e-6
    path.write_text(text.replace("-1.962", "-1.9"))
    code, out, err = run("simulate", path, "--poses", "2", "--seconds", "1", "--json")
    assert (code, json.loads(out)["stays"]) == (1, False)


def test_an_element_that_is_let_go_keeps_its_energy() -> None:
    """Of an arm on a gas spring, a hooked spring and a table: what is lost is the integrator's error."""
    peer("mujoco")
    from equipoise.simulate.engine import Engine

    joint = eq.Joint("hinge", "revolute", "world", "arm", axis=(0, -1, 0))
    ends = ("world", (0.0, 0.0, 0.3), "arm", (0.1, 0.0, 0.0))
    springs = (
        eq.LineElement("strut", *ends, eq.laws.Gas(20.0, 0.4, 0.2, progression=1.3)),
        eq.LineElement("hooked", *ends, eq.laws.Extension(90.0, 0.15, 3.0)),
        eq.LineElement("measured", *ends, eq.laws.Table(((0.1, 1.0), (0.3, 3.0), (0.5, 1.0)))),
    )
    inertia = (0.01, 0.01, 0.01, 0.0, 0.0, 0.0)
    m = eq.Mechanism("arm", (eq.Body("arm", 1.0, (0.2, 0, 0), inertia),), (joint,), springs=springs)
    engine, q = Engine(m), np.array([0.4])
    engine.place(q)
    np.testing.assert_allclose(engine.holding(), Potential(m)(q).torque[0], atol=1e-12)
    before, start = engine.energy, engine.data.qpos.copy()
    engine.run(0.5)
    assert engine.moved(start)[0] > 0.1
    assert engine.energy == pytest.approx(before, abs=1e-8)


KEPT = """\
schema: 1
name: kept
bodies: [{name: arm, mass: 1, com: [0.2, 0, 0]}]
joints: [{name: hinge, type: revolute, parent: world, child: arm, axis: [0, -1, 0], range: [-70 deg, 70 deg]}]
springs:
  - {name: strut, kind: gas, body_a: world, p_a: [0, 0, -0.3], body_b: arm, p_b: [0.1, 0, 0], force: 6 N,
     progression: 1.3, longest: 400 mm, shortest: 200 mm, friction: 1 N}
  - {name: hooked, kind: extension, body_a: world, p_a: [0, 0, 0.3], body_b: arm, p_b: [0.1, 0, 0], stiffness: 5 N/m,
     body_length: 300 mm, longest: 390 mm}
  - {name: routed, body_a: world, p_a: [-0.3, 0, -0.1], body_b: arm, p_b: [0.1, 0, 0], stiffness: 2,
     via: [{body: world, point: [0, 0, 120 mm]}]}
  - {name: snail, kind: cam, joint: hinge, sine: [-0.2]}
"""


def test_a_design_takes_them_as_a_given_load_and_shows_them(tmp_path: Path, run) -> None:
    """What stays when a spring is added beside them; in figure, page and drawings, which say what is past a limit."""
    path, out = tmp_path / "kept.yaml", tmp_path / "out.yaml"
    path.write_text(KEPT)
    code, _, err = run(
        "design", path, "--keep", "--radius", "100mm", "-o", out, "--plot", tmp_path / "kept.png", "--json"
    )
    assert code == 0, err
    before, after = eq.check(path), eq.check(out)
    assert after.mechanism.springs[:4] == before.mechanism.springs
    assert after.residual.rms[0] < 0.1 * before.residual.rms[0]
    for target in ("svg", "dxf"):
        assert run("export", out, "--to", target, "-o", tmp_path / f"kept.{target}")[0] == 0
    code, _, err = run("report", out, "-o", tmp_path / "kept.html")
    assert code == 0, err
    page = (tmp_path / "kept.html").read_text()
    assert "OVER-STRETCHED above 390 mm" in page
    assert "slack below 300 mm" in page


@pytest.mark.parametrize(
    "command",
    [("tolerance",), ("adjust", "--payload", "0,1", "--payload-on", "arm")],
    ids=lambda command: command[0],
)
def test_what_cannot_serve_one_says_so_by_name(tmp_path: Path, run, command: tuple[str, ...]) -> None:
    path = tmp_path / "kept.yaml"
    path.write_text(KEPT)
    name, *options = command
    code, _, err = run(name, path, *options)
    assert code == 2
    assert f"'strut' is a gas spring: {name} covers linear springs between two points only" in " ".join(err.split())

"""Laws on lines and joints against formulas written by hand, and the golden values of real springs."""

from __future__ import annotations

import json
from math import cos, degrees, pi, radians, sin
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicSpline, PchipInterpolator

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.energy.fourier.energy import FourierEnergy
from equipoise.energy.kernel import Kernel, by_numpy
from equipoise.energy.kernel.trace import Trace
from equipoise.io.yaml import to_text
from equipoise.model.elements.laws import Law
from equipoise.model.errors import InputError, NoFourierForm

G = 9.81
SOME = (
    eq.laws.Linear(300.0, 0.1),
    eq.laws.Linear(300.0, -0.1),
    eq.laws.Extension(900.0, 0.12, 3.0, 0.3),
    eq.laws.Compression(700.0, 0.25, 0.05),
    eq.laws.Gas(200.0, 0.4, 0.25, progression=1.3, temperature=310.0),
    eq.laws.Gas(200.0, 0.4, 0.25, force_shortest=150.0),
    eq.laws.ConstantForce(20.0),
    eq.laws.ConstantTorque(-2.0),
    eq.laws.Table(((0.05, -4.0), (0.1, 2.0), (0.2, 3.0), (0.22, 3.0), (0.4, 9.0))),
    eq.laws.Cam(points=((-0.5, 2.0), (0.1, 1.0), (0.2, 1.5), (0.45, 1.0))),
    eq.laws.Cam(cosine=(1.0, 0.0, -0.3), sine=(0.5,)),
)


@pytest.mark.parametrize("law", SOME, ids=lambda law: type(law).__name__)
def test_a_law_is_the_slope_of_its_energy_and_its_symbols_are_the_same(law: Law) -> None:
    s = np.linspace(-0.6, 0.6, 400) + 1e-4  # between knots and kinks
    h = 1e-6
    slope = (law.energy(s + h) - law.energy(s - h)) / (2 * h)
    size = 1 + np.abs(law.pull(s)).max()
    np.testing.assert_allclose(law.pull(s), slope, atol=1e-6 * size)
    assert not list(law.faults())
    low, high = law.extremes(-0.5, 0.5)
    inside = law.pull(np.linspace(-0.5, 0.5, 20_001))
    assert low == pytest.approx(inside.min(), abs=1e-5 * size)
    assert high == pytest.approx(inside.max(), abs=1e-5 * size)
    np.testing.assert_allclose(law.scaled(1.5).pull(s), 1.5 * law.pull(s), atol=1e-12 * size)
    for sign in (1.0, -1.0):  # a sum of joints may turn the other way
        t = Trace()
        program = t.program(law.of_path(t, t.mul(sign, t.input(0))))
        out = np.empty((2, len(s)))
        by_numpy.run(program, s[None], out)
        np.testing.assert_allclose(out[0], law.energy(sign * s), atol=1e-12 * size)
        np.testing.assert_allclose(out[1], law.pull(sign * s), atol=1e-12 * size)


def test_tables_are_scipys_curves() -> None:
    points = ((0.1, 2.0), (0.2, 3.0), (0.22, 3.0), (0.4, 9.0))
    s = np.linspace(0.1, 0.4, 50)
    table, curve = eq.laws.Table(points), PchipInterpolator(*np.array(points).T)
    np.testing.assert_allclose(table.pull(s), curve(s), atol=1e-12)
    np.testing.assert_allclose(table.energy(s), [quad(curve, 0.1, x)[0] for x in s], atol=1e-9)
    cam, spline = eq.laws.Cam(points), CubicSpline(*np.array(points).T)
    np.testing.assert_allclose(cam.energy(s), spline(s), atol=1e-12)
    np.testing.assert_allclose(cam.pull(s), spline.derivative()(s), atol=1e-10)
    assert table.pull(np.array([0.0, 0.9])).tolist() == [2.0, 9.0]  # beyond its ends: as there


def hinge(*springs: eq.Spring | eq.LineElement | eq.JointElement, reach: tuple[float, float] | None = (-1.2, 1.2),
          mass: float = 1.0, com: float = 0.2) -> eq.Mechanism:  # fmt: skip
    """A horizontal arm at angle 0, which turns upwards."""
    joint = eq.Joint("hinge", "revolute", "world", "arm", axis=(0, -1, 0), range=reach)
    return eq.Mechanism("hinge", (eq.Body("arm", mass, (com, 0, 0)),), (joint,), springs=springs)


def on_line(law: Law, **more: object) -> eq.LineElement:
    return eq.LineElement("s", "world", (0, 0, 0.3), "arm", (0.1, 0, 0), law, **more)  # type: ignore[arg-type]


def by_hand(name: str, q: float) -> float:
    """The holding torque of the arm of `hinge`: m g l cos q, and the force at distance L of (0, 0.3) and 0.1 (cos q,
    sin q), L^2 = 0.1 - 0.06 sin q, times dL/dq = -0.03 cos q / L."""
    L = (0.1 - 0.06 * sin(q)) ** 0.5
    force = {
        "linear": 300 * (L + 0.1),
        "extension": 0.0 if L < 0.25 else 3 + 900 * (L - 0.25),
        "compression": min(700 * (L - 0.35), 0.0),
        "gas": -(200 + 200 * 0.3 * (0.4 - L) / 0.15),
        "constant": 20.0,
        "table": 10 + 90 * (L - 0.2),  # all points on one line
    }[name]
    return 1.0 * G * 0.2 * cos(q) + force * (-0.03 * cos(q) / L)


@pytest.mark.parametrize(
    ("name", "law"),
    [
        ("linear", eq.laws.Linear(300.0, -0.1)),
        ("extension", eq.laws.Extension(900.0, 0.25, 3.0)),
        ("compression", eq.laws.Compression(700.0, 0.35)),
        ("gas", eq.laws.Gas(200.0, 0.4, 0.25, progression=1.3)),
        ("constant", eq.laws.ConstantForce(20.0)),
        ("table", eq.laws.Table(((0.2, 10.0), (0.3, 19.0), (0.4, 28.0)))),
    ],
)
def test_one_joint_and_each_law_on_a_line(name: str, law: Law) -> None:
    m, q = hinge(on_line(law)), np.linspace(-1.2, 1.2, 60)
    expected = [by_hand(name, x) for x in q]
    np.testing.assert_allclose(Potential(m).reference(q[:, None]).torque[:, 0], expected, atol=1e-12)
    np.testing.assert_allclose(Kernel(m)(q[:, None]).torque[:, 0], expected, atol=1e-12)
    with pytest.raises(NoFourierForm, match=f"'s' is {law.noun}"):
        FourierEnergy(m)


def test_one_joint_and_each_law_on_an_angle() -> None:
    """A constant torque is in the holding torque as it is; a cam of energy a cos(2 x) + b sin x gives its slope."""
    q = np.linspace(-1.2, 1.2, 40)[:, None]
    weight = G * 0.2 * np.cos(q)
    laws = {
        eq.laws.ConstantTorque(-1.5): weight - 1.5,
        eq.laws.Cam(cosine=(0.0, 0.7), sine=(-0.4,)): weight - 1.4 * np.sin(2 * q) - 0.4 * np.cos(q),
        eq.laws.Table(((-2.0, -4.0), (0.0, 0.0), (2.0, 4.0))): weight + 2 * q,
    }
    for law, expected in laws.items():
        m = hinge(eq.JointElement("s", (("hinge", 1.0),), law))
        for found in (Potential(m).reference(q).torque, Kernel(m)(q).torque):
            np.testing.assert_allclose(found, expected, atol=1e-12)
        if not isinstance(law, eq.laws.Table):
            np.testing.assert_allclose(FourierEnergy(m).torque(q), expected, atol=1e-12)


def test_a_cam_that_undoes_gravity_is_proved() -> None:
    """Gravity of the arm is m g l sin q: the cam's -m g l sin q makes it nothing, at every angle."""
    cam = eq.JointElement("cam", (("hinge", 1.0),), eq.laws.Cam(sine=(-G * 0.2,)))
    assert eq.check(hinge(cam, reach=None)).exact
    wrong = eq.JointElement("cam", (("hinge", 1.0),), eq.laws.Cam(sine=(-G * 0.2, 1e-6)))
    assert not eq.check(hinge(wrong, reach=None)).exact
    twice = eq.JointElement("cam", (("hinge", 0.5),), eq.laws.Cam(sine=(0.0, -G * 0.2)))
    with pytest.raises(NoFourierForm, match="ratios"):
        FourierEnergy(hinge(eq.JointElement("c", (("hinge", 0.5),), eq.laws.Cam(sine=(1.0,))), reach=None))
    assert np.abs(Potential(hinge(twice, reach=None))(np.linspace(-3, 3, 9)[:, None]).torque).max() < 1e-12


def test_a_lever_and_what_a_free_length_leaves() -> None:
    """k = m g r / (a c) = 367.9 N/m, 29.43 N at 80 mm; a free length leaves k L0 a c sin(theta) / length."""
    joint = eq.Joint("hinge", "revolute", "world", "arm", axis=(0, -1, 0))
    k = 0.2 * G * 0.3 / (0.04 * 0.04)
    assert k == pytest.approx(367.9, abs=0.05)
    spring = eq.Spring("s", "world", (0, 0, 0.04), "arm", (0.04, 0, 0), k)
    m = eq.Mechanism("lever", (eq.Body("arm", 0.2, (0.3, 0, 0)),), (joint,), springs=(spring,))
    balance = eq.check(m)
    assert balance.exact
    assert balance.use[0].path == pytest.approx((0, 0.08), abs=1e-5)
    assert balance.use[0].force[1] == pytest.approx(29.43, abs=5e-3)
    free = 0.025
    q = np.linspace(-1.4, 1.4, 29)
    theta = pi / 2 - q  # between the arm and the upward arm at the pivot
    length = np.sqrt(2 * 0.04**2 * (1 - np.cos(theta)))
    found = Potential(m.with_springs([eq.Spring("s", *spring.ends[0], *spring.ends[1], k, free)]))(q[:, None])
    np.testing.assert_allclose(found.torque[:, 0], k * free * 0.04 * 0.04 * np.sin(theta) / length, atol=1e-12)


def test_a_gas_spring_goes_with_the_absolute_temperature(tmp_path: Path) -> None:
    """F(T) = F(20 C) (273.15 + T) / 293.15, at both ends of the stroke."""
    for text, T in (("0 degC", 0.0), ("20 C", 20.0), ("45 degC", 45.0)):
        path = tmp_path / "gas.yaml"
        path.write_text(
            "schema: 1\nname: hatch\nbodies: [{name: arm, mass: 1}]\n"
            "joints: [{name: hinge, type: revolute, parent: world, child: arm, axis: [0, 1, 0]}]\n"
            "springs: [{name: strut, kind: gas, body_a: world, p_a: [0, 0, 0], body_b: arm, p_b: [0.3, 0, 0], "
            f"force: 200 N, progression: 1.3, longest: 400 mm, shortest: 250 mm, temperature: {text}}}]\n"
        )
        law = eq.load(path).springs[0].law
        share = (273.15 + T) / 293.15
        assert law.pull(np.array([0.4, 0.25])) == pytest.approx([-200 * share, -260 * share], rel=1e-12)


def test_a_catalogue_spring_leaves_a_fifth(tmp_path: Path, run) -> None:
    """2.2497 cos t + rx Fy - ry Fx, y down: 0.4369 N m at -53.6 deg (19.42 %); not the 3.29 % of a printed tool."""
    t = np.radians(np.linspace(-53.6, 43.4, 971))
    end = 0.0176 * np.stack([np.cos(t), np.sin(t)])
    far = np.array([0.0427, -0.2117])[:, None]
    length = np.linalg.norm(far - end, axis=0)
    force = (26.867 + 1273.17 * (length - 0.13335)) * (far - end) / length
    by_formula = 2.2497 * np.cos(t) + end[0] * force[1] - end[1] * force[0]
    assert np.abs(by_formula).max() == pytest.approx(0.4369, abs=5e-5)
    assert degrees(t[np.abs(by_formula).argmax()]) == pytest.approx(-53.6)
    path = tmp_path / "catalogue.yaml"
    path.write_text(  # y down, so that gravity is along y
        "schema: 1\nname: catalogue\ngravity: [0, 9.81, 0]\n"
        f"bodies: [{{name: arm, mass: 1, com: [{2.2497 / 9.81}, 0, 0]}}]\n"
        "joints: [{name: t, type: revolute, parent: world, child: arm, axis: [0, 0, 1], "
        "range: [-53.6 deg, 43.4 deg]}]\n"
        "springs: [{name: s, kind: extension, body_a: world, p_a: [42.7 mm, -211.7 mm, 0], body_b: arm, "
        "p_b: [17.6 mm, 0, 0], stiffness: 1273.17 N/m, body_length: 133.35 mm, initial_tension: 26.867 N}]\n"
    )
    code, out, _ = run("check", path, "--json")
    assert code == 1
    found = json.loads(out)
    assert found["torque"]["residual"]["max"][0] == pytest.approx(0.4369, abs=5e-5)
    assert found["torque"]["residual"]["max"][0] / found["torque"]["unbalanced"]["max"][0] == pytest.approx(
        0.1942, abs=5e-5
    )
    assert found["worst"]["configuration"] == pytest.approx([radians(-53.6)], abs=1e-6)
    assert found["springs"][0]["kind"] == "extension"
    tension = 26.867 + 1273.17 * (length - 0.13335)
    assert found["springs"][0]["force"] == pytest.approx([tension.min(), tension.max()], abs=1e-3)


SPRINGS = """\
schema: 1
name: all kinds
bodies: [{name: arm, mass: 1, com: [0.2, 0, 0]}]
joints: [{name: hinge, type: revolute, parent: world, child: arm, axis: [0, -1, 0], range: [-70 deg, 70 deg]}]
springs:
  - {name: tight, body_a: world, p_a: [0, 0, 0.3], body_b: arm, p_b: [0.1, 0, 0], stiffness: 10, free_length: -50 mm}
  - {name: hooked, kind: extension, body_a: world, p_a: [0, 0, 0.3], body_b: arm, p_b: [0.1, 0, 0], stiffness: 900 N/m,
     body_length: 250 mm, initial_tension: 3 N, longest: 390 mm}
  - {name: pressed, kind: compression, body_a: world, p_a: [0, 0, 0.3], body_b: arm, p_b: [0.1, 0, 0], stiffness: 70,
     free_length: 350 mm, solid_length: 220 mm}
  - {name: strut, kind: gas, body_a: world, p_a: [0, 0, 0.3], body_b: arm, p_b: [0.1, 0, 0], force: 20 N,
     progression: 1.3, longest: 400 mm, shortest: 200 mm, friction: 2 N}
  - {name: drum, kind: constant, body_a: world, p_a: [0, 0, 0.3], body_b: arm, p_b: [0.1, 0, 0], force: 4 N}
  - {name: motor, kind: constant, joint: hinge, torque: 0.1 N m}
  - {name: measured, kind: table, body_a: world, p_a: [0, 0, 0.3], body_b: arm, p_b: [0.1, 0, 0],
     points: [[200 mm, 1 N], [300 mm, 2 N], [400 mm, 4 N]]}
  - {name: twisted, kind: table, joints: {hinge: 2}, file: twist.csv}
  - {name: snail, kind: cam, joint: hinge, cosine: [0.2 J], sine: [0, 0.1]}
  - {name: curve, kind: cam, joint: hinge, points: [[-90 deg, 0.1], [0, 0.3], [90 deg, 0]]}
  - {name: routed, body_a: world, p_a: [-0.3, 0, -0.1], body_b: arm, p_b: [0.1, 0, 0], stiffness: 30,
     via: [{body: world, point: [0, 0, 120 mm]}]}
"""


@pytest.fixture
def all_kinds(tmp_path: Path) -> Path:
    path = tmp_path / "all.yaml"
    path.write_text(SPRINGS)
    (tmp_path / "twist.csv").write_text("angle [deg],torque [N m]\n-180,-1\n0,0\n180,2\n")
    return path


def test_files_keep_every_kind(all_kinds: Path, tmp_path: Path) -> None:
    m = eq.load(all_kinds)
    assert [s.kind for s in m.springs] == [
        "linear", "extension", "compression", "gas", "constant", "constant", "table", "table", "cam", "cam", "linear",
    ]  # fmt: skip
    table = m.springs[7].law
    np.testing.assert_allclose(table.points, [(-pi, -1), (0, 0), (pi, 2)])
    again = tmp_path / "again.yaml"
    again.write_text(to_text(m))
    assert eq.load(again) == m


def test_check_says_what_each_kind_does(all_kinds: Path, run) -> None:
    """Lengths go from (0.1 - 0.06 sin 70 deg)^1/2 = 208.9 to 395.4 mm: over-stretched, solid, within a stroke."""
    code, out, _ = run("check", all_kinds, "--json")
    assert code == 1
    found = {spring["name"]: spring for spring in json.loads(out)["springs"]}
    shortest, longest = (0.1 - 0.06 * sin(radians(70))) ** 0.5, (0.1 + 0.06 * sin(radians(70))) ** 0.5
    hooked = found["hooked"]
    assert hooked["path"] == pytest.approx([shortest, longest], abs=1e-5)
    assert hooked["force"] == pytest.approx([0, 3 + 900 * (longest - 0.25)], abs=0.02)
    assert hooked["unit"] == "N"
    assert hooked["longest"] == 0.39
    slack, over = hooked["states"]
    assert (slack["state"], slack["limit"]) == ("slack", False)
    assert 0.2 < slack["share"] < 0.4
    assert (over["state"], over["limit"]) == ("over-stretched", True)
    assert over["configuration"] == pytest.approx([radians(-70)], abs=1e-3)
    assert [state["state"] for state in found["pressed"]["states"]] == ["loose", "solid"]
    assert found["strut"]["states"] == []
    # 2 N times the largest lever arm, which is that of the pivot to the line: 0.1 m where it is square to the arm
    assert found["strut"]["friction"] == pytest.approx([0.2], rel=1e-3)
    assert found["twisted"]["unit"] == "N m"
    code, out, _ = run("check", all_kinds)
    assert "OVER-STRETCHED above 390 mm" in out
    assert "slack below 250 mm" in out
    assert "friction of ±2 N adds up to hinge ±0.2 N m to the residual" in out


def test_a_passed_limit_is_no_whatever_the_tolerance(all_kinds: Path, tmp_path: Path, run) -> None:
    assert run("check", all_kinds, "--tolerance", "100000%")[0] == 1
    within = tmp_path / "within.yaml"
    within.write_text(
        SPRINGS.replace("longest: 390 mm", "longest: 396 mm").replace("solid_length: 220", "solid_length: 200")
    )
    assert run("check", within, "--tolerance", "100000%")[0] == 0


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("longest: 390 mm", "longest: 20 mm", 8, "springs[1].longest: must be more than 'body_length', 0.25 m"),
        ("initial_tension: 3 N", "initial_tension: 3 mm", 8, "expected a number [N] or text with a unit of force"),
        ("solid_length: 220 mm", "solid_length: 400 mm", 10, "must be more than 'solid_length', 0.4 m, found 0.35"),
        ("progression: 1.3", "progression: 1.3, force_shortest: 3", 12, "give 'progression' or 'force_shortest', and"),
        ("friction: 2 N", "temperature: 45", 12, "from 200 to 400 K, found 45; a number without a unit is in kelvin"),
        ("[300 mm, 2 N]", "[300 mm]", 16, "expected a list of length and force, found ['300 mm']"),
        ("[300 mm, 2 N]", "[100 mm, 2 N]", 16, "must go up: 0.1 follows 0.2"),
        ("file: twist.csv", "file: none.csv", 17, "'none.csv' cannot be used as a table"),
        ("cosine: [0.2 J]", "cosine: [0.2 N]", 18, "expected a number [J] or text with a unit of energy"),
        ("sine: [0, 0.1]", "points: [[0, 1], [1, 2]]", 18, "give 'points', or 'cosine' and 'sine', and not both"),
        ("force: 4 N", "force: 0", 13, "must be finite and not 0, found 0"),
        ("force: 4 N", "torque: 4", 13, "unknown key 'torque'"),
        ("via: [{body: world,", "via: [{body: wrold,", 21, "no body 'wrold'; did you mean 'world'?"),
        ("via: [{body: world, point", "via: [{body: world, pont", 21, "unknown key 'pont'; did you mean 'point'?"),
    ],
)  # fmt: skip
def test_a_wrong_key_is_said_with_its_line(all_kinds: Path, run, old: str, new: str, line: int, message: str) -> None:
    all_kinds.write_text(SPRINGS.replace(old, new))
    code, _, err = run("check", all_kinds)
    assert code == 2
    assert message in " ".join(err.split())
    assert f"all.yaml:{line}:" in err


def test_a_wrong_cell_of_a_table_is_said_with_its_line(all_kinds: Path, run) -> None:
    (all_kinds.parent / "twist.csv").write_text("angle [deg],torque [N m]\n-180,-1\n0,none\n")
    code, _, err = run("check", all_kinds)
    assert code == 2
    assert "twist.csv:3: torque: expected a number [N m]" in " ".join(err.split())
    assert "'twist.csv' cannot be used as a table" in err


def test_a_table_of_one_point_is_no_table() -> None:
    with pytest.raises(InputError, match="2 to 200 points"):
        hinge(on_line(eq.laws.Table(((0.1, 1.0),))))

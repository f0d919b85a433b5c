"""The method `cam` against closed forms, and against a polygon that a cable is laid around."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from math import pi, radians
from pathlib import Path
from typing import Any

import cam_wrapping
import numpy as np
import pytest
from campaign import campaign
from mpmath import acos, diff, mp, mpf, sqrt

import equipoise as eq
from equipoise.hardware.stock.made_up import made_up_catalogue
from equipoise.io.mjcf import to_text
from equipoise.kinematics import Tree
from equipoise.model.errors import InfeasibleError, InputError
from equipoise.model.rotation import about
from equipoise.report.skeleton import Skeleton
from equipoise.simulate.release import release
from equipoise.synthesis import by_name

G = 9.81
SLOW = pytest.mark.slow(reason="searches a list, or one that finds nothing")
EXAMPLES = Path(__file__).parents[1] / "examples" / "mechanisms"


def arm(low: float, high: float, *springs: Any, mass: float = 2.0, com: tuple[float, float, float] = (0.3, 0, 0),
        axis: tuple[float, float, float] = (0, -1, 0), masses: Any = ()) -> eq.Mechanism:  # fmt: skip
    joint = eq.Joint("elbow", "revolute", "world", "arm", axis=axis, range=(low, high))
    return eq.Mechanism("arm", (eq.Body("arm", mass, com),), (joint,), springs=springs, masses=masses)


def entry(design: Any, number: int = -1) -> dict[str, Any]:
    """The cam as ``check --json`` and the file have it."""
    return design.balance.to_dict()["springs"][number]


def points(cam: dict[str, Any]) -> list[tuple[float, float]]:
    return [tuple(point) for point in cam["profile"]]


# closed forms


def envelope(lever: Any, far: float, bearing: float, psi: float) -> tuple[float, float]:
    """Where two neighbouring lines of a cable meet in the axes of the profile, by 40 digits."""
    mp.dps = 40
    bearing, far = mpf(bearing), mpf(far)

    def theta(q: Any) -> Any:
        return bearing - acos(lever(q) / far) - q

    q = mpf(psi)
    h, dh, angle, turn = lever(q), diff(lever, q), theta(q), diff(theta, q)
    # x cos + y sin = h, and its slope (-x sin + y cos) turn = dh
    along = dh / turn
    return float(h * mp.cos(angle) - along * mp.sin(angle)), float(h * mp.sin(angle) + along * mp.cos(angle))


@pytest.mark.parametrize("case", ["constant torque", "gravity"])
def test_profiles_are_the_closed_forms(case: str) -> None:
    k, F0, low, high = 900.0, 40.0, radians(-55), radians(50)
    if case == "constant torque":  # a linear spring against a constant torque
        still = eq.JointElement("drum", (("elbow", 1.0),), eq.laws.ConstantTorque(3.0))
        mechanism = arm(low, high, still, mass=0.0)
        options: dict[str, Any] = {"keep": True, "spring": "linear"}

        def work(q: Any) -> Any:
            return 3 * (mpf(high) - q)

        def torque(q: Any) -> Any:
            return mpf(-3)
    else:  # m g l cos q, and an extension spring
        mechanism, options = arm(low, high), {"spring": "extension"}
        size = mpf(2.0) * mpf(G) * mpf("0.3")

        def work(q: Any) -> Any:
            return size * (mp.sin(mpf(high)) - mp.sin(q))

        def torque(q: Any) -> Any:
            return -size * mp.cos(q)

    design = eq.design(
        mechanism, "cam", stiffness=k, force=F0, fixed=(0.02, -0.3), size=0.3, least_radius=1e-4, guide=True, **options
    )
    found = entry(design)
    far, bearing = float(np.hypot(0.02, 0.3)), float(np.arctan2(-0.3, 0.02))
    written = np.array(points(found))[24:-4]

    def lever(q: Any) -> Any:
        return -torque(q) / sqrt(F0**2 + 2 * k * work(q))

    angles = np.linspace(low, high, 181)[::20]
    exact = np.array([envelope(lever, far, bearing, q) for q in angles])
    written = written[::20] if np.hypot(*(written[0] - exact[0])) < 1e-4 else written[::-1][::20]
    np.testing.assert_allclose(written, exact, atol=1e-8)
    # the torque that a taut cable has on these points, and the spring's lengths
    for q in np.linspace(low, high, 23):
        own = cam_wrapping.cable(points(found), tuple(found["cable"]["point"]), q)
        drawn = own.length - found["cable"]["length"] + found["cable"]["behind"]
        _, force, _ = cam_wrapping.spring(found["spring"], drawn)
        assert force == pytest.approx(float(sqrt(F0**2 + 2 * k * work(q))), rel=1e-4)
        assert -force * own.lever == pytest.approx(float(torque(q)), rel=1e-3)
    law = design.mechanism.springs[-1].law
    assert law.made is not None
    run = law.made.run
    inside = (run.angle > low) & (run.angle < high)
    exact_torque = np.array([float(torque(q)) for q in run.angle[inside][::40]])
    np.testing.assert_allclose(run.torque[inside][::40], exact_torque, rtol=1e-6)


def test_a_series_where_gravity_alone_is_there_and_the_balance_is_proved() -> None:
    design = eq.design(arm(-0.9, 0.9, com=(0.3, 0, 0.05)), "cam")
    assert design.balance.exact
    assert "cosine" in entry(design)
    assert entry(design)["made"]["share"] < 1e-4
    assert entry(design)["made"]["faults"] == []


# in an engine, in a file, on a sheet


def test_mujoco_keeps_the_energy_with_the_taut_cable_on_the_written_points() -> None:
    mujoco = pytest.importorskip("mujoco")
    mechanism = arm(radians(-50), radians(60), mass=1.2, com=(0.4, 0, 0.02))
    cam = entry(eq.design(mechanism, "cam"))
    body = replace(mechanism.bodies[0], inertia=(1e-3, 0.07, 0.07, 0, 0, 0))
    model = mujoco.MjModel.from_xml_string(to_text(replace(mechanism, bodies=(body,))))
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    model.opt.timestep = 2e-3
    data = mujoco.MjData(model)

    def pulled(q: float) -> tuple[float, float]:
        own = cam_wrapping.cable(points(cam), tuple(cam["cable"]["point"]), q)
        drawn = own.length - cam["cable"]["length"] + cam["cable"]["behind"]
        _, force, energy = cam_wrapping.spring(cam["spring"], drawn)
        return force * own.lever, energy

    # at rest all over the range, the sum does not change
    sums, weight = [], []
    for q in np.radians(np.linspace(-50, 60, 45)):
        data.qpos[0] = q
        mujoco.mj_forward(model, data)
        sums.append(data.energy[0] + pulled(q)[1])
        weight.append(data.energy[0])
    assert np.ptp(sums) < 0.005 * np.ptp(weight)
    # pushed, it goes on through the range as on a table
    data.qpos[0], data.qvel[0] = radians(-45), 1.0
    mujoco.mj_forward(model, data)
    speeds = []
    while data.qpos[0] < radians(55) and data.time < 5:
        data.qfrc_applied[0] = pulled(float(data.qpos[0]))[0]
        mujoco.mj_step(model, data)
        speeds.append(float(data.qvel[0]))
    assert data.qpos[0] >= radians(55)
    kinetic = data.energy[1]
    assert abs(np.square(speeds[-1]) - 1) * kinetic < 0.005 * np.ptp(weight)
    # the program's own way: the element's law in the engine, let go at rest
    held = replace(eq.design(mechanism, "cam").mechanism, bodies=(body,))
    assert release(held, poses=3, seconds=1.0, control=False).design.largest < 1e-4


@SLOW
def test_a_monitor_arm_gets_a_spring_of_a_list() -> None:
    mechanism = eq.load(EXAMPLES / "monitor_arm.yaml")
    design = eq.design(mechanism, "cam", joint="lift", stock=made_up_catalogue(600))
    cam = entry(design)
    assert cam["spring"]["part"].startswith("MADE-UP")
    assert cam["made"]["faults"] == []
    low, high = mechanism.joints[1].range or (0.0, 0.0)
    angles = np.linspace(low, high, 41)
    weight = 9.81 * (1.1 * 0.15 + 5 * 0.3) * np.cos(angles)  # as the file's first lines have it
    assert np.abs(judged(cam, angles) + weight).max() < 0.01 * weight.max()


def test_a_cam_is_written_read_and_drawn(tmp_path: Path, run: Any) -> None:
    file, out, sheet = tmp_path / "arm.yaml", tmp_path / "cam.yaml", tmp_path / "cam.svg"
    eq.save(arm(-0.9, 0.9), file)
    more = ["--set", "cable=1mm", "--set", "friction=3%", "-o", out]
    code, text, _ = run("design", file, "--method", "cam", "--joint", "elbow", *more)
    assert code == 0
    assert "is that of the energy within" in " ".join(text.split())
    assert "friction of ±" in text
    mechanism = eq.load(out)
    made = mechanism.springs[0].law.made
    assert made is not None
    assert eq.check(mechanism).exact
    assert run("export", out, "--to", "svg", "--cam", "elbow cam", "-o", sheet)[0] == 0
    drawing = sheet.read_text(encoding="utf-8")
    for words in (
        "fixed point (",
        "bottom of its groove",
        "x, 0 deg",
        "axis",
        f"cable {1e3 * made.cable.length:.5g} from",
    ):
        assert words in drawing
    dxf = pytest.importorskip("ezdxf")
    assert run("export", out, "--to", "dxf", "--cam", "elbow cam", "-o", tmp_path / "cam.dxf")[0] == 0
    lines = dxf.readfile(tmp_path / "cam.dxf").modelspace().query("LWPOLYLINE[layer=='thick']")
    rim = np.array([(x, y) for x, y, *_ in max(lines, key=len)])
    np.testing.assert_allclose(rim[0], rim[-1])
    profile = 1e3 * np.array(made.profile)
    np.testing.assert_allclose(np.diff(rim[: len(profile)], axis=0), np.diff(profile, axis=0), atol=1e-6)
    code, _, err = run("export", out, "--to", "svg", "--cam", "elbw cam")
    assert code == 2
    assert "did you mean 'elbow cam'" in err
    code, _, err = run("design", file, "--joint", "elbow")
    assert code == 2
    assert "is for --method cam" in err


def test_a_profile_that_does_not_give_its_energy_is_no_balance(tmp_path: Path, run: Any) -> None:
    file, bad = tmp_path / "cam.yaml", tmp_path / "bad.yaml"
    design = _designed().mechanism
    eq.save(design, file)
    assert run("check", file)[0] == 0
    cam = design.springs[0]
    thick = replace(cam.law.made, profile=tuple((1.03 * x, 1.03 * y) for x, y in cam.law.made.profile))
    eq.save(design.with_springs([cam.changed(made=thick)]), bad)
    code, text, _ = run("check", bad)
    assert code == 1
    assert "its torque differs by up to" in text
    assert run("report", bad, "-o", tmp_path / "bad.html")[0] in (0, 1)
    page = (tmp_path / "bad.html").read_text(encoding="utf-8")
    assert "its torque differs by up to" in page
    assert "Profile of elbow cam" in page


def test_the_angles_that_are_given_become_the_range_of_the_joint() -> None:
    free = replace(arm(-0.9, 0.9), joints=(replace(arm(-0.9, 0.9).joints[0], range=None),))
    design = eq.design(free, "cam", range=(-0.5, 0.7))
    assert design.mechanism.joints[0].range == (-0.5, 0.7)
    assert entry(design)["made"]["faults"] == []


def test_pictures_have_the_cable_where_it_leaves_the_profile() -> None:
    ways: tuple[dict[str, Any], ...] = ({}, {"fixed_to": "parent"}, {"follower": "roller"})
    for options in ways:
        mechanism = eq.design(arm(-0.9, 0.9), "cam", **options).mechanism
        cam = mechanism.springs[0].law.made
        tree = Tree.of(mechanism)
        q = np.linspace(-0.85, 0.85, 7)[:, None]
        poses = tree.poses(q)
        line = np.stack([point.at(poses) for point in Skeleton.of(mechanism).springs[0]], axis=1)[:, :, [0, 2]]
        if cam.roller is not None:
            centre, rim = line[:, 1:25].mean(axis=1), line[:, 27:]
            gap = np.linalg.norm(rim - centre[:, None], axis=2).min(axis=1)
            np.testing.assert_allclose(gap, cam.roller.radius, atol=2e-4)  # it touches, and nothing is inside
            continue
        fixed, contact, rim = line[:, 0], line[:, 1], line[:, 2:]
        along = (fixed - contact) / np.linalg.norm(fixed - contact, axis=1)[:, None]
        across = np.stack([-along[:, 1], along[:, 0]], axis=1)
        height = np.einsum("nij,nj->ni", rim - contact[:, None], across)  # all of the rim is on one side of the cable
        assert np.minimum(np.abs(height.min(axis=1)), np.abs(height.max(axis=1))).max() < 2e-4
        lever = np.abs(np.einsum("ni,ni->n", contact, across))
        np.testing.assert_allclose(lever, np.interp(q[:, 0], cam.run.angle, np.abs(cam.run.lever)), rtol=1e-3)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("spring: {kind: extension", "spring: {kind: extention"),
        ("cable: {point: ", "cable: {pont: "),
        ("profile:", "profil:"),
        ("fixed_to: parent", "fixed_to: uncle"),
    ],
)
def test_what_is_wrong_with_a_cam_is_said_at_its_place(tmp_path: Path, change: str, said: str) -> None:
    file = tmp_path / "arm.yaml"
    eq.save(_designed().mechanism, file)
    text = file.read_text(encoding="utf-8")
    assert change in text
    file.write_text(text.replace(change, said, 1), encoding="utf-8")
    with pytest.raises(InputError, match=r"did you mean|unknown|no body"):
        eq.load(file)


@cache
def _designed() -> Any:
    return eq.design(arm(-0.9, 0.9), "cam", fixed_to="parent")


def test_a_profile_that_is_not_its_energy_is_told() -> None:
    cam = _designed().mechanism.springs[0]
    made = cam.law.made
    bent = replace(made, profile=tuple((1.02 * x, 1.02 * y) for x, y in made.profile))
    short = replace(made, cable=replace(made.cable, length=made.cable.length + 0.2))
    for other, words in ((bent, "its torque differs by up to"), (short, "its spring goes slack")):
        mechanism = _designed().mechanism.with_springs([cam.changed(made=other)])
        found = eq.check(mechanism, samples=50).to_dict()["springs"][0]["made"]
        assert any(words in fault for fault in found["faults"])


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"size": 0.012}, "least_radius"),
        pytest.param({"preload": 0.7}, "least force, of the largest", marks=SLOW),
        pytest.param({"hub": 0.12}, "the axis inside the profile by", marks=SLOW),
    ],
)
def test_no_says_which_demand_fails_and_what_would_help(options: dict[str, Any], said: str) -> None:
    with pytest.raises(InfeasibleError, match=said) as caught:
        eq.design(arm(-0.9, 0.9), "cam", **options)
    assert "any one of these would help" in str(caught.value)
    helps = str(caught.value).split("would help: ")[1]
    (name,) = options
    value = re.search(rf"a {name} of ([\d.]+) (mm|%)", helps)
    assert value is not None
    better = float(value[1]) / (1e3 if value[2] == "mm" else 100) * (1.02 if name == "size" else 0.98)
    assert by_name(arm(-0.9, 0.9), "cam", **{name: better}).residual < 1e-9


@SLOW
def test_two_sides_where_the_torque_changes_its_sign() -> None:
    mechanism = arm(0.3, 2.6)
    design = eq.design(mechanism, "cam", sides="two")
    angles = np.linspace(0.3, 2.6, 31)
    both = sum(judged(entry(design, i), angles) for i in (0, 1))
    weight = 9.81 * 2.0 * 0.3 * np.cos(angles)
    assert np.abs(both + weight).max() < 0.005 * np.abs(weight).max()


def test_what_cannot_be() -> None:
    cases: tuple[tuple[dict[str, Any], str], ...] = (
        ({"joint": "elbw"}, "did you mean 'elbow'"),
        ({"range": (0.5, 0.2)}, "the lower one first"),
        ({"fixed": (0.0, 0.0)}, "not its axis"),
        ({"spring": "rubber"}, "rubber"),
    )
    for options, said in cases:
        with pytest.raises(InputError, match=said):
            eq.design(arm(-0.9, 0.9), "cam", **options)
    free = replace(arm(-0.9, 0.9), joints=(replace(arm(-0.9, 0.9).joints[0], range=None),))
    with pytest.raises(InputError, match="a range of a turn or more"):
        eq.design(free, "cam")


# 200 random joints


def joint(seed: int) -> tuple[eq.Mechanism, dict[str, Any], Any]:
    """A hinge with gravity, a payload and sometimes a torsion spring; options; and its holding torque as a formula."""
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    mass, load = rng.uniform(0.5, 5), rng.uniform(0, 1)
    com, at = rng.uniform(-0.3, 0.3, 3), rng.uniform(-0.4, 0.4, 3)
    width, middle = np.radians(rng.uniform(30, 120)), rng.uniform(-pi, pi)
    low, high = middle - width / 2, middle + width / 2
    rate, rest = (rng.uniform(0.1, 1.0), rng.uniform(-1, 1)) if seed % 4 == 0 else (0.0, 0.0)
    springs = (eq.TorsionSpring("coil", (("elbow", 1.0),), rate, rest),) if rate else ()
    payload = eq.PointMass("payload", "arm", load, tuple(at))
    mechanism = arm(low, high, *springs, mass=mass, com=tuple(com), axis=tuple(axis), masses=(payload,))
    options = {
        "keep": True,
        "fixed_to": str(rng.choice(["child", "parent"])),
        "guide": bool(rng.integers(2)),
        "follower": "roller" if seed % 5 == 1 else "cable",
        "size": 0.2,
        "least_radius": 0.003,
    }

    def holding(q: float) -> float:
        def energy(angle: float) -> float:
            R = about(axis, angle)
            return G * float((R @ (mass * com + load * at))[2]) + 0.5 * rate * (angle - rest) ** 2

        return (energy(q + 1e-5) - energy(q - 1e-5)) / 2e-5

    return mechanism, options, holding


@campaign(200, block=25)
def test_the_written_points_give_the_torque_by_an_independent_way(seeds: range) -> None:
    feasible = 0
    for seed in seeds:
        mechanism, options, holding = joint(seed)
        try:
            design = eq.design(mechanism, "cam", **options)
        except InfeasibleError:
            continue
        feasible += 1
        low, high = mechanism.joints[0].range or (0.0, 0.0)
        angles = np.linspace(low, high, 61)
        wanted = -np.array([holding(q) for q in angles])
        got = judged(entry(design), angles)
        assert np.abs(got - wanted).max() < 0.005 * np.abs(wanted).max(), seed
    assert feasible >= len(seeds) // 3


def judged(cam: dict[str, Any], angles: Any) -> Any:
    """The torque of a cam on its joint by polygons; its cable must not leave it, its spring not be slack."""
    turn = 1.0 if cam["fixed_to"] == "child" else -1.0
    pushes = cam["spring"]["kind"] in ("compression", "gas")
    if "cable" in cam:
        own = [cam_wrapping.cable(points(cam), tuple(cam["cable"]["point"]), turn * q) for q in angles]
        corners = [one.corner for one in own]
        assert min(corners) > 2, "the cable comes off where it is fixed"
        assert max(corners) < len(cam["profile"]) - 1, "the cable leaves the profile"
        steps = np.diff(corners)
        assert (steps >= 0).all() or (steps <= 0).all()
        drawn = np.array([one.length for one in own]) - cam["cable"]["length"] + cam["cable"]["behind"]
        lever = -turn * np.array([one.lever for one in own])
        found = [cam_wrapping.spring(cam["spring"], x) for x in drawn]
    else:
        line = (cam["roller"]["radius"], cam["roller"]["direction"], cam["roller"]["offset"])
        h = 1e-2  # the sides of the polygon are about so long
        places = [[cam_wrapping.roller(points(cam), *line, turn * (q + d)) for d in (-h, 0, h)] for q in angles]
        places = np.array(places)
        lever = (places[:, 2] - places[:, 0]) / (2 * h)
        found = [cam_wrapping.spring(cam["spring"], x - cam["roller"]["seat"]) for x in places[:, 1]]
    length, force, _ = np.array(found).T
    assert (force > 0).all(), "the spring is slack"
    law = cam["spring"]
    if pushes:
        assert (length >= law.get("shortest", law.get("solid_length", 0.0)) - 1e-9).all()
    elif law["kind"] == "extension":
        assert (length > law["body_length"]).all()
        assert (length <= law["longest"] + 1e-9).all()
    return force * lever

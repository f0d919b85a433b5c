"""The method `cam` against closed forms, and against a polygon that a cable is laid around."""

from __future__ import annotations

from math import pi, radians
from typing import Any

import cam_wrapping
import numpy as np
import pytest
from campaign import campaign
from mpmath import acos, diff, mp, mpf, sqrt

import equipoise as eq
from equipoise.model.errors import InfeasibleError
from equipoise.model.rotation import about

G = 9.81


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

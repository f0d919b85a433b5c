"""The verdict: known answers, what proves it, what it reports, and that it is what the command line promises."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from odd_mechanisms import coupled, turret
from random_mechanisms import random_mechanism
from zoo import PENDULUM_K, ZOO, hinge, irrational_pair, pendulum, to_ground, vertical_slide

from equipoise import Balance, check
from equipoise.model.elements import Spring
from equipoise.model.errors import InputError
from equipoise.model.mechanism import Body, Joint, Mechanism, Workspace


@pytest.mark.parametrize("name", ZOO)
def test_the_zoo(name: str) -> None:
    known = ZOO[name]()
    b = check(known.mechanism)
    assert b.exact == known.exact
    assert b.certificate.kind == ("fourier" if known.proved else "sampled")
    size = max(1.0, *known.unbalanced)
    np.testing.assert_allclose(b.unbalanced.max, known.unbalanced, rtol=1e-9, atol=1e-12 * size)
    for found, expected in zip(b.residual.max, known.residual, strict=True):
        if expected is not None:
            assert found == pytest.approx(expected, rel=1e-9, abs=1e-12 * size)
    if known.energy is not None:
        np.testing.assert_allclose([b.constant, *b.total], known.energy, rtol=1e-12, atol=1e-12 * size)
    if b.bound is not None:
        assert (b.residual.max <= b.bound * (1 + 1e-12) + 1e-12 * size).all()
    assert (b.residual.rms <= b.residual.max + 1e-15).all()
    worst = b.residual.max.argmax()
    assert abs(b.worst_torque[worst]) == pytest.approx(b.residual.max[worst], rel=1e-12, abs=1e-15)


def test_one_per_cent_soft() -> None:
    b = check(pendulum(0.99 * PENDULUM_K))
    assert b.residual.max[0] == pytest.approx(0.05886, rel=1e-12)
    assert b.relative == pytest.approx(0.01, rel=1e-12)
    assert b.residual.rms[0] == pytest.approx(0.05886 / np.sqrt(2), rel=0.02)  # of a sine, sampled
    assert b.bound is not None
    assert b.bound[0] == pytest.approx(0.05886, rel=1e-12)
    assert b.certificate.max_coefficient == pytest.approx(0.05886 / 2, rel=1e-12)
    assert b.certificate.terms == 3
    assert np.cos(b.worst_configuration[0]) == pytest.approx(-1) or np.cos(b.worst_configuration[0]) == pytest.approx(1)
    assert not b.balanced()
    assert b.balanced(0.0101)
    assert not b.balanced(0.0099)
    assert b.balanced(torque=0.0589)
    assert not b.balanced(torque=0.0588)


def test_a_free_length_of_an_eighth() -> None:
    """Its peak is where k L0 a b cos q / |d| is greatest: L0 / a of m g l, 12.5 %."""
    b = check(pendulum(free_length=0.025))
    assert not b.exact
    assert b.relative == pytest.approx(0.125, rel=1e-9)
    assert b.certificate.reason == "spring 'shoulder spring' has a free length"
    assert b.bound is None


def test_energies_and_springs() -> None:
    """Of the exact pendulum: gravity between -m g l and m g l, the spring between 0.05 and 0.35 m."""
    b = check(pendulum())
    np.testing.assert_allclose(b.gravity, [-5.886, 5.886], rtol=1e-9)
    np.testing.assert_allclose(b.springs, [PENDULUM_K / 2 * 0.05**2, PENDULUM_K / 2 * 0.35**2], rtol=1e-9)
    assert b.use[0].max_length == pytest.approx(0.35, rel=1e-9)
    assert b.use[0].max_force == pytest.approx(PENDULUM_K * 0.35, rel=1e-9)
    pushed = check(pendulum(free_length=0.3))  # presses with 0.25 m, pulls with 0.05 m
    assert pushed.use[0].max_force == pytest.approx(PENDULUM_K * 0.25, rel=1e-9)
    short = check(pendulum(free_length=0.15))  # presses with 0.1 m, pulls with 0.2 m
    assert short.use[0].max_force == pytest.approx(PENDULUM_K * 0.2, rel=1e-9)


def test_balanced_but_without_proof() -> None:
    b = check(irrational_pair().mechanism)
    assert not b.exact
    assert b.certificate.kind == "sampled"
    assert "1.41421) is not a fraction" in (b.certificate.reason or "")
    assert b.relative < 1e-13
    assert b.balanced()  # within the tolerance, on samples


def test_too_long_a_form_is_proved_without_and_has_no_bound() -> None:
    m = ZOO["lenzo_spherical"]().mechanism
    b = check(m, max_terms=20, samples=100)
    assert (b.exact, b.certificate.kind, b.certificate.terms, b.bound) == (True, "span", None, None)
    assert (b.certificate.reason, b.certificate.max_coefficient) == (None, None)
    assert b.certificate.distance is not None
    assert b.certificate.distance.relative < 1e-13
    assert b.to_dict()["certificate"]["varies"] == b.certificate.distance.varies
    assert b.certificate.samples == 100
    assert b.balanced()


def test_the_reported_peak_is_within_the_bound() -> None:
    for seed in range(12):
        try:
            b = check(random_mechanism(seed, 3, free_lengths=False), samples=200)
        except InputError:
            continue  # contradictory ranges of coupled joints
        assert b.bound is not None
        assert (b.residual.max <= b.bound * (1 + 1e-12) + 1e-11).all()


def test_a_hundred_millionth_is_not_exact() -> None:
    assert check(pendulum(PENDULUM_K * (1 + 1e-12)), samples=50).exact
    assert not check(pendulum(PENDULUM_K * (1 + 1e-8)), samples=50).exact


def test_what_does_not_have_to_be_balanced_lends_nothing() -> None:
    b = check(turret(arm=1e-6), samples=50)
    assert not b.exact
    assert b.relative == pytest.approx(1)


def test_angles_and_slides_are_not_compared_with_each_other() -> None:
    """A huge torque of one joint must not make the force of another look small."""
    slide = vertical_slide().mechanism
    m = replace(
        slide,
        bodies=(*slide.bodies, Body("arm", 1e6, (1.0, 0.0, 0.0))),
        joints=(*slide.joints, hinge("pivot", "world", "arm")),
        springs=(*slide.springs, to_ground("big", "arm", 1.0, 1.0, 9.81e6)),
    )
    assert check(m).relative == pytest.approx(0.5)


# The JSON contract of docs and command line --------------------------------------------------------------------------

KEYS = {
    "mechanism": None,
    "coordinates": None,
    "exact": None,
    "certificate": {"kind", "terms", "max_coefficient", "samples"},
    "energy": {"constant", "gravity", "springs", "total"},
    "torque": {"unbalanced", "residual", "bound"},
    "worst": {"configuration", "torque"},
    "springs": None,
}
SPRING_KEYS = {
    "name", "body_a", "p_a", "body_b", "p_b", "stiffness", "free_length", "max_length", "min_length", "max_force",
}  # fmt: skip


@pytest.mark.parametrize("name", ZOO)
def test_to_dict(name: str) -> None:
    m = ZOO[name]().mechanism
    b = check(m, samples=100)
    found = json.loads(json.dumps(b.to_dict(), allow_nan=False))
    assert found.keys() >= KEYS.keys()
    for key, inner in KEYS.items():
        assert inner is None or found[key].keys() >= inner
    n = len(m.coordinates)
    assert found["mechanism"] == m.name
    assert found["coordinates"] == list(m.coordinates)
    assert found["exact"] is b.exact
    assert found["certificate"]["kind"] in ("fourier", "sampled")
    assert found["certificate"]["samples"] == 100
    for part in ("unbalanced", "residual"):
        assert found["torque"][part] == {"max": getattr(b, part).max.tolist(), "rms": getattr(b, part).rms.tolist()}
    for vector in (found["torque"]["bound"], found["worst"]["configuration"], found["worst"]["torque"]):
        assert len(vector) == n
    for part in ("gravity", "springs", "total"):
        low, high = found["energy"][part]
        assert low <= high
    assert len(found["springs"]) == len(m.springs)
    for spring, original in zip(found["springs"], m.springs, strict=True):
        assert spring.keys() >= SPRING_KEYS
        assert (spring["name"], tuple(spring["p_a"])) == (original.name, original.p_a)
        assert spring["max_force"] >= original.stiffness * (spring["max_length"] - original.free_length)


# Degenerate ----------------------------------------------------------------------------------------------------------


def still() -> list[Mechanism]:
    fixed = (Joint("bolt", "fixed", "world", "a"), Joint("weld", "fixed", "a", "b", (1.0, 0.0, 0.0)))
    spring = Spring("s", "world", (0.0, 0.0, 0.0), "b", (0.0, 0.0, 0.0), 2.0)
    return [
        Mechanism("nothing"),
        Mechanism("fixed", (Body("a", 1.0), Body("b", 2.0)), fixed),
        Mechanism("fixed with a spring", (Body("a", 1.0), Body("b", 2.0)), fixed, springs=(spring,)),
    ]


@pytest.mark.parametrize("m", still(), ids=lambda m: m.name)
def test_nothing_moves(m: Mechanism) -> None:
    b = check(m)
    assert b.exact
    assert b.balanced()
    assert b.relative == 0
    assert b.residual.max.shape == b.worst_configuration.shape == (0,)
    assert b.constant == pytest.approx(len(m.springs))
    json.dumps(b.to_dict(), allow_nan=False)


def test_springs_without_gravity_and_springs_on_a_massless_arm() -> None:
    for m in (replace(pendulum(), gravity=(0.0, 0.0, 0.0)), replace(pendulum(), bodies=(Body("arm"),))):
        b = check(m)
        assert not b.exact
        assert b.relative == np.inf  # something is left over of nothing
        assert not b.balanced()
        assert b.residual.max[0] == pytest.approx(5.886)
        opposite = replace(m.springs[0], name="opposite", p_b=(-0.15, 0.0, 0.0))
        assert check(m.with_springs((*m.springs, opposite))).exact
        json.dumps(b.to_dict(), allow_nan=False)


def test_contradictory_ranges_are_refused() -> None:
    with pytest.raises(InputError, match="right pivot"):
        check(coupled(7.5, 9.0))


def test_numbers_that_overflow_are_refused() -> None:
    m = pendulum()
    with pytest.raises(InputError, match="'one-link arm' has numbers so large"):
        check(replace(m, bodies=(Body("arm", 1e308, (1e5, 0.0, 0.0)),)))
    with pytest.raises(InputError, match="so large"):
        check(pendulum(1e308, free_length=1e10))
    with pytest.raises(InputError, match="so large"):
        check(replace(m, bodies=(Body("arm", 1e200, (1.0, 0.0, 0.0)),)))  # its square does


def test_the_number_of_samples() -> None:
    m = replace(pendulum(), workspace=Workspace(17))
    assert check(m).certificate.samples == 17
    assert check(m, samples=5).certificate.samples == 5


def test_the_same_seed_gives_the_same_verdict() -> None:
    m = ZOO["lee_chen_arm"]().mechanism
    first, second = (json.dumps(check(m, samples=50, seed=4).to_dict()) for _ in range(2))
    assert first == second
    assert isinstance(check(m, samples=50), Balance)


def test_without_springs_residual_and_unbalanced_are_the_same():
    balance = check(random_mechanism(3).with_springs(()), samples=200)
    assert (balance.residual.max == balance.unbalanced.max).all()

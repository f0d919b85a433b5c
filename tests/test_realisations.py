"""Realisations of zero-free-length springs: what each leaves, by the mechanism's own torque, and when each works."""

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from robots import TABLE_5A, TABLE_5B, lee_chen, lee_chen_springs

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.hardware import Envelope, ExtensionSpring, Limits, Options, realisations
from equipoise.hardware.realise.bill import bill
from equipoise.hardware.realise.installed import Torques, installed_torque
from equipoise.hardware.realise.realisations import KINDS
from equipoise.hardware.realise.stretch import Pulley, Straight, beyond
from equipoise.kinematics import Tree, sample
from equipoise.model.errors import InputError
from equipoise.synthesis.planar.arm import PlanarArm

ROOM = Envelope(0.04, 1.2)


def pendulum(low: float = -180, high: float = 180, free: float = 0.0, b: float = 0.15) -> eq.Mechanism:
    """One link, balanced by one spring attached 0.2 m above the joint and `b` along the link."""
    limits = (np.radians(low), np.radians(high))
    return eq.Mechanism(
        "pendulum",
        bodies=(eq.Body("arm", 2.0, (0.3, 0, 0)),),
        joints=(eq.Joint("shoulder", "revolute", "world", "arm", axis=(0, -1, 0), range=limits),),
        springs=(eq.Spring("s", "world", (0, 0, 0.2), "arm", (b, 0, 0), 5.886 / 0.2 / b, free),),
    )


vectors = st.tuples(*[st.floats(-1, 1)] * 3)


@given(vectors, vectors, st.floats(0.001, 0.3))
def test_gradient_of_the_cable_is_that_of_its_length(p, c, radius) -> None:
    d, along = np.array([p]), np.array(c)
    if np.linalg.norm(along) < 1e-2 or np.linalg.norm(np.cross(along, p)) < 1e-2:
        return
    law = Pulley(radius, tuple(along / np.linalg.norm(along)))
    if beyond(law, d)[0] < 1e-2:
        return
    h = 1e-6
    steps = [(law(d + h * e)[0] - law(d - h * e)[0])[0] / (2 * h) for e in np.eye(3)]
    assert law(d)[1][0] == pytest.approx(np.array(steps), abs=1e-5)
    assert np.linalg.norm(law(d)[1][0]) == pytest.approx(1)  # it pulls with the cable's own force


def test_cable_straight_on_touches_without_wrapping_and_a_quarter_turn_adds_an_arc() -> None:
    law = Pulley(0.1, (1.0, 0.0, 0.0))
    assert law(np.array([[0.5, 0.0, 0.0]]))[0][0] == pytest.approx(0.5)
    # leaving at right angles: a quarter of the pulley and the rest, 0.1 m further along
    assert law(np.array([[0.1, 0.6, 0.0]]))[0][0] == pytest.approx(0.1 * np.pi / 2 + 0.5)


def test_ideal_laws_give_the_reference_torque() -> None:
    for m in (lee_chen_springs(), pendulum(free=0.03)):
        q = sample(Tree.of(m), 50, 3)
        state = Potential(m)(q)
        gravity, springs = Torques(m, [Straight(s.free_length) for s in m.springs])(q)
        assert gravity == pytest.approx(state.gravity_torque, abs=1e-12)
        assert springs.sum(axis=1) == pytest.approx(state.spring_torque, abs=1e-12)
        # an eyelet is a spring in line
        _, eyelets = Torques(m, [Pulley(0.0, (0.0, 0.6, 0.8), -s.free_length) for s in m.springs])(q)
        assert eyelets == pytest.approx(springs, abs=1e-12)


def test_torque_over_a_pulley_is_the_derivative_of_its_energy() -> None:
    m, law = pendulum(), Pulley(0.02, (0.0, 0.0, -1.0), 0.01)
    q, h = sample(Tree.of(m), 200, 1), 1e-6

    def energy(x):
        d = Tree.of(m).poses(x).point(1, np.array(m.springs[0].p_b)) - np.array(m.springs[0].p_a)
        return m.springs[0].stiffness / 2 * law(d)[0] ** 2

    found = Torques(m, [law])(q)[1][:, 0, 0]
    assert found == pytest.approx((energy(q + h) - energy(q - h)) / (2 * h), abs=1e-6)


@pytest.mark.parametrize("share", [1 / 8, 1 / 4])
def test_free_length_that_is_left_is_its_share_of_the_longer_distance(share: float) -> None:
    left = installed_torque(pendulum(), [Straight(share * 0.2)])
    assert left.share == pytest.approx(share, rel=1e-4)
    assert left.share == pytest.approx(eq.check(pendulum(free=share * 0.2)).relative, rel=1e-4)


def test_pulley_error_is_of_first_order_in_the_radius() -> None:
    m, radii = pendulum(), (4e-3, 2e-3, 1e-3, 5e-4)
    shares = [installed_torque(m, [Pulley(r, (0.0, 0.0, -1.0))]).share for r in radii]
    for coarse, fine in pairwise(shares):
        assert coarse / fine == pytest.approx(2, rel=0.1)


def test_friction_is_a_share_of_the_springs_torque() -> None:
    m = pendulum()
    left = installed_torque(m, [Straight()], [0.05])
    assert left.residual[0] < 1e-12
    assert left.friction[0] == pytest.approx(0.05 * 5.886, rel=1e-6)


def test_which_realisations_work() -> None:
    balance = eq.check(pendulum())
    ways = {way.kind: way for way in realisations(balance, 0, Options(envelope=ROOM))}
    assert tuple(ways) == KINDS
    for kind in ("case", "telescope", "eyelet"):
        assert ways[kind].works
        assert ways[kind].share == balance.relative
    assert balance.relative < 1e-12
    # the best preload is found: another leaves no less in the mean
    pulley = ways["pulley"]
    law = pulley.stretch
    assert isinstance(law, Pulley)
    assert pulley.share is not None
    assert 0 < pulley.share < 0.2
    rms = [installed_torque(pendulum(), [replace(law, preload=law.preload + x)]).rms[0] for x in (-1e-3, 0, 1e-3)]
    assert rms[1] == min(rms)
    assert "closed length" in ways["direct"].reason


def test_direct_leaves_the_free_length_that_initial_tension_does_not_make_up_for() -> None:
    balance = eq.check(pendulum(-90, 45))
    direct = realisations(balance, 0, Options(envelope=ROOM))[0]
    spring = direct.winding.spring
    assert direct.works
    assert isinstance(spring, ExtensionSpring)
    assert spring.free_length <= balance.use[0].min_length * (1 + 1e-9)
    assert 0 < spring.left_over < spring.free_length
    assert direct.share == pytest.approx(eq.check(pendulum(-90, 45, free=spring.left_over)).relative, rel=1e-3)
    # in use it is as long as its attachments are apart
    made = bill(balance, Options(envelope=ROOM), "direct").to_dict()["springs"][0]
    use = balance.use[0]
    assert made["realisations"][0]["length_in_use"] == pytest.approx([use.min_length, use.max_length], rel=1e-6)


def test_attachments_that_meet_leave_only_a_cable() -> None:
    balance = eq.check(pendulum(b=0.2))
    ways = {way.kind: way for way in realisations(balance, 0, Options(envelope=ROOM))}
    assert [kind for kind in KINDS if ways[kind].works] == ["eyelet"]
    assert "10 mm" in ways["telescope"].reason
    assert "inside the pulley" in ways["pulley"].reason
    assert "as near as 0.0 mm" in ways["direct"].reason


def test_a_case_needs_room_behind_for_what_is_longer_than_the_spring_can_be() -> None:
    near, far = (
        {way.kind: way for way in realisations(eq.check(pendulum(*limits)), 0, Options(envelope=ROOM))}
        for limits in ((-180, 180), (-90, -60))
    )
    # the spring's length is that from B to the case's end
    spring = near["case"].winding.spring
    assert isinstance(spring, ExtensionSpring)
    assert near["case"].behind == pytest.approx(spring.left_over)
    assert spring.length(39.24) - near["case"].behind == pytest.approx(0.2, abs=1e-9)
    behind = [ways["telescope"].behind or 0.0 for ways in (far, near)]
    assert 0 <= behind[0] < behind[1]


def test_bill_judges_what_is_built_with_its_masses() -> None:
    balance = eq.check(lee_chen_springs())
    made = bill(balance, Options(envelope=ROOM))
    assert made.complete
    assert made.built is not None
    assert made.left is not None
    assert [item.chosen.kind for item in made.items if item.chosen] == ["telescope", "eyelet", "eyelet"]
    assert made.mass == pytest.approx(sum(s.mass for s in made.built.springs))
    # of this design all realisations are ideal, so what is left is the weight of the springs
    assert made.left.share == pytest.approx(eq.check(made.built).relative, rel=1e-3)
    assert 1e-3 < made.left.share < 0.05
    json.dumps(made.to_dict(), allow_nan=False)


def test_bill_with_a_realisation_that_cannot_be() -> None:
    made = bill(eq.check(lee_chen_springs()), Options(envelope=ROOM), "direct")
    assert not made.complete
    assert made.left is None
    kinds = [item.chosen.kind if item.chosen else None for item in made.items]
    assert kinds == ["direct", None, None]
    with pytest.raises(InputError, match="did you mean 'direct'"):
        bill(eq.check(pendulum()), Options(), "dirct")
    with pytest.raises(InputError, match="has none"):
        bill(eq.check(lee_chen()), Options())


@pytest.mark.parametrize("table", [TABLE_5A, TABLE_5B])
def test_springs_of_lee2014_table_5_can_be_made(table) -> None:
    arm = lee_chen()
    balance = eq.check(arm.with_springs(PlanarArm.of(arm).springs(table)))
    bare = Options(envelope=ROOM, limits=Limits(safety=1.0, fatigue=0.0), pulley=0.005)
    made = bill(balance, bare)
    assert made.complete
    for item, row in zip(made.to_dict()["springs"], table, strict=True):
        way = item["realisations"][0]
        assert way["count"] == 1
        assert way["rate"] == pytest.approx(row.stiffness)
        assert way["static_margin"] >= 1 - 1e-9
        assert way["hook_margin"] is None or way["hook_margin"] >= 1 - 1e-9
        assert way["fatigue_margin"] > 0.4  # several would break in the end; the bill says so
    assert "fatigue margin under 1" in made.warnings[0]
    enduring = bill(balance, Options(envelope=ROOM, pulley=0.005))
    assert not enduring.warnings
    assert enduring.complete
    assert all(s["realisations"][0]["fatigue_margin"] >= 1 - 1e-9 for s in enduring.to_dict()["springs"])


@pytest.mark.slow(reason="winds springs of every wire")
def test_springs_of_lin2010_table_3() -> None:
    from equipoise.reproduce import lin2010

    design = lin2010.balanced().mechanism
    balance = eq.check(design, samples=1000)
    made = bill(
        replace(balance, mechanism=replace(design, workspace=eq.Workspace(1000))),
        Options(limits=Limits(safety=1.0, fatigue=0.0), envelope=Envelope(0.04, 0.6)),
    )
    assert made.complete
    found = made.to_dict()["springs"]
    # 20 kN/m at 0.1 m: no single spring of this size, but three side by side
    assert (found[0]["rate"], found[0]["realisations"][0]["count"]) == (20e3, 3)
    assert all(way["count"] > 1 for way in found[0]["realisations"])
    direct = next(way for way in found[0]["realisations"] if way["kind"] == "direct")
    assert not direct["works"]
    assert "as near as 33." in direct["reason"]
    assert "closed length" in direct["reason"]
    for item in found:
        assert item["realisations"][0]["static_margin"] >= 1 - 1e-9

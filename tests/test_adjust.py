"""Following a payload: closed forms of one link, exact balance of an arm at both ends, and the best fixed springs."""

import json
from dataclasses import replace

import numpy as np
import pytest
import zoo
from hypothesis import given, settings
from hypothesis import strategies as st
from robots import lee_chen, lee_chen_springs

import equipoise as eq
from equipoise.balance import payload_residual
from equipoise.energy import Potential
from equipoise.model.errors import InputError
from equipoise.model.payload import Payload
from equipoise.robust import adjust


def pendulum(low=0.0, high=2.0):
    m = zoo.pendulum()
    return m, Payload.at(m, (low, high), "arm", (0.4, 0.0, 0.0))


@settings(deadline=None, max_examples=15)
@given(low=st.floats(0, 1), more=st.floats(0.1, 3))
def test_one_link_in_closed_form(low, more):
    """k a b = m g l + p g r: either distance grows in proportion, and the work is k/2 (c'^2 - c^2) + (g p r) sin."""
    m, payload = pendulum(low, low + more)
    found = adjust(m, payload)
    assert found.exact
    ways = {way.moves[0].what: way for way in found.ways}
    spring = m.springs[0]
    for what, size in (("p_a", 0.2), ("p_b", 0.15)):
        move = ways[what].moves[0]
        wanted = [size * (1 + mass * 0.4 / (2 * 0.3)) for mass in (low, low + more)]
        assert [np.linalg.norm(move.low), np.linalg.norm(move.high)] == pytest.approx(wanted, rel=1e-9)
        assert move.travel == pytest.approx(wanted[1] - wanted[0], rel=1e-9)
        middle = spring.stiffness / 2 * (wanted[1] ** 2 - wanted[0] ** 2)
        swing = zoo.G * more * 0.4
        assert ways[what].work == pytest.approx((middle - swing, middle + swing), rel=1e-6, abs=1e-6)
    assert found.best.moves[0].what == "p_b"  # the shorter one moves less
    assert ways["free_length"].share > 0.9  # it only turns the spring's force down


def test_every_way_leaves_what_it_says_by_the_reference():
    m = lee_chen_springs()
    payload = Payload.at(m, (0.0, 2.0), m.body_names[-1], (0.2, 0.0, 0.0))
    found = adjust(m, payload, tolerance=1e-4)
    assert found.keeps
    assert found.best.share <= 1e-4
    assert len(found.best.moves) == 2  # two links carry the payload
    for balance in found.ends:
        assert balance.relative < 1e-3
    for way in found.ways:
        assert way.share > 0.1  # and no spring can do it alone


def test_no_more_springs_move_than_need_to():
    """Moving link 4's two springs alone is exact: a third that would move by nothing is not named."""
    m = eq.load("examples/mechanisms/lee2014_table5a.yaml")
    found = adjust(m, Payload.at(m, (0.0, 2.0), "link 4"))
    assert found.exact
    assert [move.spring for move in found.best.moves] == ["spring 2 (1-4)", "spring 3 (1-4)"]
    assert all(move.travel > 0.01 for move in found.best.moves)


def test_where_loops_close():
    m = eq.load("examples/mechanisms/desk_lamp.yaml")
    found = adjust(m, Payload.at(m, (0.0, 0.5), "head"))
    assert found.exact
    assert found.left == pytest.approx(found.bound, rel=1e-6)
    assert len(found.best.moves) == 2


def test_no_fixed_springs_leave_less_than_the_bound():
    m, payload = pendulum()
    found = adjust(m, payload)
    assert found.left == pytest.approx(found.bound, rel=1e-9)
    assert found.bound == pytest.approx([zoo.G * 0.4])
    for factor in np.linspace(0.3, 4.0, 30):
        springs = (replace(m.springs[0], stiffness=factor * m.springs[0].stiffness),)
        assert payload_residual(payload, m, springs)["shoulder"] >= found.bound[0] * (1 - 1e-9)


def test_a_spring_with_free_length_is_adjusted_as_well_as_it_can_be():
    """Not exact, but no nearby attachment leaves less."""
    m = zoo.pendulum(free_length=0.02)
    found = adjust(m, Payload.at(m, (0.0, 1.0), "arm", (0.3, 0.0, 0.0)))
    assert not found.keeps
    way = next(way for way in found.ways if way.moves[0].what == "p_b")
    payload = Payload.at(m, (1.0,), "arm", (0.3, 0.0, 0.0))
    rms = eq.check(payload.on(way.high, 1.0), samples=2000).residual.rms[0]
    for factor in (0.97, 1.03):
        spring = way.high.springs[0]
        x, y, z = (factor * value for value in spring.p_b)
        other = way.high.with_springs([replace(spring, p_b=(x, y, z))])
        assert eq.check(payload.on(other, 1.0), samples=2000).residual.rms[0] > rms


def test_the_basic_gravity_equilibrator_is_adjusted_without_energy():
    """The golden case: k a b = m g l, a above the joint; b slides to b' where the link's sine is (b + b') / 2 a."""
    m = zoo.pendulum()  # a = 0.2 m, b = 0.15 m
    found = adjust(m, Payload.at(m, (0.0, 0.5), "arm", (0.4, 0.0, 0.0)))
    locked = found.locked
    assert locked is not None
    assert np.sin(locked.configuration[0]) == pytest.approx((0.15 + 0.2) / (2 * 0.2), rel=1e-9)
    (arc,) = locked.arcs
    assert arc.body == "arm"
    q, spring = locked.configuration[None], m.springs[0]
    move = found.best.moves[0]
    start, end = (np.arctan2(p[2] - arc.centre[2], p[0] - arc.centre[0]) for p in (move.low, move.high))
    turn = start + np.linspace(0, 1, 7) * ((end - start + np.pi) % (2 * np.pi) - np.pi)
    for angle in turn:  # all along the arc the spring stores what it stores at its ends
        p = (arc.centre[0] + arc.radius * np.cos(angle), 0.0, arc.centre[2] + arc.radius * np.sin(angle))
        stored = Potential(m.with_springs([replace(spring, p_b=p)]))(q).springs.sum()
        assert stored == pytest.approx(Potential(m)(q).springs.sum(), rel=1e-9)
    assert [step.exact for step in found.steps] == [True] * 5
    far = adjust(m, Payload.at(m, (0.0, 2.0), "arm", (0.4, 0.0, 0.0)))
    assert far.locked is None  # b would have to be 0.35 m: beyond what the link reaches at any angle


def test_a_slide_to_the_payload_s_point_is_exact_at_every_payload():
    """A vertical slide by m g / k of a spring to the payload's point, beside springs that balance the arm."""
    k, arm = 2.0 * zoo.G / 0.2, zoo.pendulum()
    spring = eq.Spring("payload spring", "world", (0, 0, 0), "arm", (0.4, 0, 0), k)
    m = arm.with_springs([*arm.springs, spring])
    found = adjust(m, Payload.at(m, (0.0, 2.0), "arm", (0.4, 0.0, 0.0)), payloads=20)
    assert len(found.steps) == 20
    assert all(step.exact for step in found.steps)
    way = next(way for way in found.ways if (way.moves[0].spring, way.moves[0].what) == ("payload spring", "p_a"))
    assert way.moves[0].high == pytest.approx((0, 0, 0.2), abs=1e-9)


def test_a_partial_adjustment_within_its_travel():
    m, payload = pendulum(0.0, 0.5)
    found = adjust(m, payload, travel="10 mm")
    assert not found.keeps
    assert found.best.moves[0].travel == pytest.approx(0.01, rel=1e-4)
    assert found.best.moves[0].high == pytest.approx((0.16, 0, 0), abs=1e-3)  # over random poses
    last = found.steps[-1]
    spring = m.springs[0]
    assert last.unmoved[0] == pytest.approx(0.5 * 0.4 * zoo.G, rel=1e-3)
    assert last.moved[0] == pytest.approx(0.5 * 0.4 * zoo.G - spring.stiffness * 0.2 * 0.01, rel=1e-3)
    assert found.unmoved == pytest.approx(1.0)
    assert found.reach is not None
    assert found.reach < np.sqrt(0.5) * last.moved[0]  # a stiffer spring would do it


def test_an_approximate_design_gets_a_table_with_a_gain():
    design = eq.design(lee_chen(), pairs=[("world", "link2"), ("link2", "link3")], radius=0.1, keep=False)
    assert not design.balance.exact
    m = design.mechanism
    found = adjust(m, Payload.at(m, (0.0, 0.5), "link4", (0.05, 0, 0)))
    assert not found.keeps
    assert found.best.share < found.unmoved
    assert found.steps[-1].moved.max() < 0.95 * found.steps[-1].unmoved.max()
    assert found.reach is not None
    rms = eq.check(Payload.at(m, (0.5,), "link4", (0.05, 0, 0)).on(found.best.high, 0.5)).residual.rms
    assert np.linalg.norm(rms) >= found.reach * 0.97  # over other random poses


def test_command_line(run, tmp_path):
    file, fixed = tmp_path / "arm.yaml", tmp_path / "fixed.yaml"
    eq.save(zoo.pendulum(), file)
    options = ("--payload", "0,2kg", "--payload-on", "arm", "--payload-at", "0.4,0,0")
    code, out, _ = run("adjust", file, *options, "-o", fixed, "--json")
    answer = json.loads(out)
    assert code == 0
    assert answer["exact"]
    assert answer["fixed"]["residual"] == pytest.approx(answer["fixed"]["bound"])
    sweep = json.loads(run("check", fixed, *options, "--json")[1])["payload"]
    assert sweep["exact"] == [False, False, True, False, False]
    assert max(row[0] for row in sweep["residual"]) == pytest.approx(zoo.G * 0.4)
    out = run("adjust", file, *options)[1]
    for text in ("EXACT at both ends", "p_b", "200.0", "energy [J]", "least"):
        assert text in out


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"--payload": "2,1"}, "smallest comes first"),
        ({"--payload": "1,1"}, "must have a range"),
        ({"--payload": "1"}, "expected LOW,HIGH"),
        ({"--payload": "1,2 m"}, "--payload"),
        ({"--payload": "0,nan"}, "found 'nan'"),
        ({"--payload": "-1,2"}, "at least 0"),
        ({"--payload-on": "amr"}, "did you mean 'arm'"),
        ({"--payload-on": "world"}, "loads no joint"),
        ({"--payload-at": "0,0"}, "X,Y,Z"),
        ({"--tolerance": "2"}, "--tolerance"),
        ({"--tolerance": "0"}, "tolerance"),
        ({"-o": "missing/fixed.yaml"}, "missing"),
    ],
)
def test_bad_options(run, tmp_path, changed, message):
    file = tmp_path / "arm.yaml"
    eq.save(zoo.pendulum(), file)
    options = {"--payload": "0,2kg", "--payload-on": "arm"} | changed
    code, out, err = run("adjust", file, *(text for pair in options.items() for text in pair))
    assert (code, out) == (2, "")
    assert message in err


def test_without_springs():
    m = zoo.pendulum().with_springs(())
    with pytest.raises(InputError, match="no springs to adjust"):
        adjust(m, Payload.at(m, (0.0, 1.0), "arm"))

"""Clearance as a constraint: the rows by differences, closed forms, and designs that stay balanced when they move."""

import json
from dataclasses import replace

import numpy as np
import pytest
import zoo
from peers import peer
from robots import lee_chen_springs, robot

import equipoise as eq
from equipoise.clearance import ClearanceConstraint, clearance
from equipoise.kinematics import Tree, sample
from equipoise.model.errors import InfeasibleError, InputError
from equipoise.model.mechanism import Capsule, Shape
from equipoise.synthesis.convex.ordinary import ordinary


def near_post(distance: float = 0.01) -> eq.Mechanism:
    """A 20 mm spring in the plane of the pendulum; a 20 mm post at `distance` from that plane is in its way."""
    m = zoo.with_post()
    return replace(m, capsules=(Capsule("post", "stand", (0.05, distance, -1.0), (0.05, distance, 1.0), 0.01),))


def ends(m: eq.Mechanism) -> np.ndarray:
    return np.array([(s.p_a, s.p_b) for s in m.springs])


def test_derivative_by_differences():
    m = robot("ur5").with_springs(
        (
            eq.Spring("one", "shoulder_link", (0.05, 0.1, 0), "forearm_link", (0, 0.1, 0.05), 500.0, diameter=0.02),
            eq.Spring("two", "base_link", (0, 0, 0.1), "wrist_1_link", (0.1, 0, 0.02), 300.0, diameter=0.03),
        )
    )
    m = replace(m, capsules=(Capsule("upper arm", "upper_arm_link", (0, 0, 0), (0, 0, 0.4), 0.06),))
    room, p, h = ClearanceConstraint(m, sample(Tree.of(m), 200), 0.05), ends(m), 1e-6
    rows, J = room(p)
    assert len(rows) > 20
    for i in np.ndindex(p.shape):
        step = np.zeros(p.shape)
        step[i] = h
        more, less = room(p + step)[0], room(p - step)[0]
        assert len(more) == len(less) == len(rows)
        assert J[(slice(None), *i)] == pytest.approx((more - less) / (2 * h), abs=1e-5 * np.abs(J).max())


def test_no_rows_where_there_is_room():
    m = near_post(0.1)
    q = sample(Tree.of(m), 50)
    assert len(ClearanceConstraint(m, q, 0.05)(ends(m))[0]) == 0
    assert len(ClearanceConstraint(m, q, 0.09)(ends(m))[0]) > 0


def test_a_spring_steps_aside_and_balances_as_before():
    found = ordinary(near_post(), clearance=0.005)
    assert found.room is not None
    before, after = found.room
    assert before.least == pytest.approx(-0.01, abs=1e-6)
    assert 0.005 <= after.least < 0.01
    assert found.balance.exact
    assert clearance(found.mechanism, seed=7).least >= 0.005 - 1e-6


@pytest.mark.slow(reason="a fit with clearance")
def test_three_springs_of_an_arm_get_out_of_each_others_way():
    m = lee_chen_springs()
    found = ordinary(m.with_springs(replace(s, diameter=0.02) for s in m.springs), clearance=0.005)
    assert found.room is not None
    assert found.room[0].least < 0
    assert found.room[1].least >= 0.005
    assert found.balance.exact


def test_what_has_room_enough_stays_as_it_is_to_the_last_digit(run, tmp_path):
    m = near_post(0.1)
    found = ordinary(m, clearance=0.05)
    assert found.mechanism is m
    eq.save(m.with_springs(()), tmp_path / "arm.yaml")
    without, with_room = tmp_path / "without.yaml", tmp_path / "with.yaml"
    base = ("design", tmp_path / "arm.yaml", "--span", 1, "--radius", "200mm")
    plain = json.loads(run(*base, "-o", without, "--json")[1])
    answer = json.loads(run(*base, "--clearance", "5mm", "-o", with_room, "--json")[1])
    assert eq.load(with_room).springs == eq.load(without).springs
    for key in ("residual", "unbalanced", "bound", "certified_gap", "averaged", "balance"):
        assert answer[key] == plain[key]
    assert "nothing was moved" in run(*base, "--clearance", "5mm")[1]


def test_springs_keep_away_from_solids_too():
    """The post as a cylinder, which the collision library measures, in place of a capsule."""
    peer("coal")
    m = near_post()
    shape = Shape("post", "stand", "cylinder", (0.02, 0.02, 2.0), (0.05, 0.01, 0.0))
    found = ordinary(replace(m, capsules=(), shapes=(shape,)), clearance=0.005)
    assert found.room is not None
    assert found.room[0].least < 0
    assert found.room[1].least >= 0.005
    assert found.balance.exact


def test_free_length_and_room_together():
    found = ordinary(near_post(), 0.025, clearance=0.005)
    assert found.room is not None
    assert found.room[1].least >= 0.005
    assert found.gain > 5


def test_where_there_is_no_room_it_says_so():
    m = near_post()
    with pytest.raises(InfeasibleError, match="keep 500 mm"):
        ordinary(m, clearance=0.5)
    with pytest.raises(InputError, match="at least 0 m"):
        ordinary(m, clearance=-1.0)


def test_command_line(run, tmp_path):
    file, made = tmp_path / "arm.yaml", tmp_path / "made.yaml"
    eq.save(near_post().with_springs(()), file)
    options = ("--span", 1, "--radius", "200mm", "--clearance", "5mm", "--diameter", "20mm")
    code, out, _ = run("design", file, *options, "-o", made, "--json")
    answer = json.loads(out)
    assert code == 0
    assert answer["balance"]["exact"]
    assert answer["free_length"]["clearance"][1] >= 0.005
    assert run("clearance", made, "--least", "5mm")[0] == 0
    assert "clearance: least distance" in run("design", file, *options)[1]
    code, _, err = run("design", file, *options[:4], "--clearance", "1m")
    assert code == 1
    assert "no attachments were found that keep 1000 mm" in err
    for bad in (("--clearance", "3 kg"), ("--diameter", "2cm"), ("--clearance", "-1mm"), ("--clearance", "nan")):
        code, out, err = run("design", file, "-o", tmp_path / "bad.yaml", *bad)
        assert (code, out) == (2, "")
        assert bad[0] in err or "clearance" in err
        assert not (tmp_path / "bad.yaml").exists()

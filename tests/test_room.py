"""What takes room: cables over pulleys as MuJoCo lays them, weights, auxiliary links; what is and is not judged."""

import json
from dataclasses import replace

import numpy as np
import pytest
import zoo
from in_mujoco import set_pose
from peers import peer

import equipoise as eq
from equipoise.clearance import clearance
from equipoise.clearance.pairs import Pairs
from equipoise.io import mjcf
from equipoise.kinematics import Tree, sample
from equipoise.model.elements import Guide, LineElement, Pulley, TorsionSpring
from equipoise.model.elements.laws import Linear
from equipoise.model.mechanism import Body, Capsule, Joint, PointMass, Shape


def cable(diameter: float = 0.0) -> LineElement:
    via = (Pulley("world", (0.0, 0.0, 0.0), 0.05, (0.0, 2.0, 0.0), (0.0, 0.0, 0.1)), Guide("arm", (0.12, 0.0, 0.03)))
    return LineElement(
        "cabled", "world", (-0.3, 0.0, 0.0), "arm", (0.2, 0.0, 0.0), Linear(150.0, 0.1), via, diameter=diameter
    )


def with_cable() -> eq.Mechanism:
    m = zoo.pendulum().with_springs((cable(),))
    return replace(m, joints=(replace(m.joints[0], range=(-1.2, 1.0)),))


def test_a_cable_lies_where_mujoco_lays_it():
    mujoco = peer("mujoco")
    m = with_cable()
    m = replace(m, bodies=(replace(m.bodies[0], inertia=(0.01, 0.01, 0.01, 0.0, 0.0, 0.0)),))
    tree = Tree.of(m)
    q = sample(tree, 40)
    model = mujoco.MjModel.from_xml_string(mjcf.to_text(m))
    ends = Pairs(m).points(tree.poses(q), Pairs(m).ends)  # world to pulley, pulley to guide, guide to arm
    lies = []
    for at, own in zip(q, ends, strict=True):
        data = set_pose(m, model, {"shoulder": float(at[0])})
        count = int(data.ten_wrapnum[0])
        points = data.wrap_xpos.reshape(-1, 3)[:count]
        mine = [own[0, 0], own[0, 1], own[1, 0], own[1, 1], own[2, 1]]
        if count == 5:  # it lies on the pulley: in this order along it
            assert points == pytest.approx(np.array(mine), abs=1e-9)
        else:
            assert points == pytest.approx(np.array([own[0, 0], own[0, 1], own[2, 1]]), abs=1e-9)
        lies.append(count == 5)
    assert 0 < sum(lies) < len(lies)


def test_elements_of_every_kind_are_served():
    post = Capsule("post", "stand", (0.0, 0.06, -1.0), (0.0, 0.06, 1.0), 0.01)
    m = with_cable()
    stand = (*m.joints, Joint("bolts", "fixed", "world", "stand"))
    m = replace(m, bodies=(*m.bodies, Body("stand")), joints=stand)
    m = replace(m, capsules=(post, Capsule("tube", "arm", (0.1, 0.0, 0.0), (0.3, 0.0, 0.0), 0.015)))
    m = m.with_springs((*m.springs, TorsionSpring("wound", (("shoulder", 1.0),), 2.0)))
    found = clearance(m, samples=200)
    assert found.least == pytest.approx(0.05, abs=1e-9)  # of the cable's plane to the post
    assert {gap.other for gap in found.gaps} == {"post"}  # its parts end on the world and on the arm
    assert found.left_out == ("wound (a torsion spring: no size is known)",)
    assert [line.spring for line in found.lines] == ["cabled"]


def test_weights_and_springs_against_each_other():
    """A steel ball of 2 kg, 39.3 mm, swings past a post; a spring fixed inside it is mounted on it."""
    m = zoo.with_post()
    ball = np.cbrt(3 * 2.0 / (4 * np.pi * 7850))
    m = replace(m, masses=(PointMass("weight", "arm", 2.0, (-0.2, 0.0, 0.0)),))
    gaps = {(gap.spring, gap.other): gap.distance for gap in clearance(m, samples=500).gaps}
    assert gaps["weight", "post"] == pytest.approx(0.1 - 0.01 - ball, abs=1e-6)
    assert gaps["shoulder spring", "weight"] == pytest.approx(0.0 - 0.01 - ball, abs=1e-5)  # it swings through it
    held = replace(m, masses=(PointMass("weight", "arm", 2.0, (0.15, 0.0, 0.0)),))
    assert ("shoulder spring", "weight") not in {(g.spring, g.other) for g in clearance(held, samples=50).gaps}


def test_auxiliary_links_count_as_lines():
    m = zoo.with_post()
    bodies = (*m.bodies, Body("rod", 0.1, (0.25, 0.0, 0.0)))
    side = Joint("side", "parallelogram", "world", "rod", (0.0, 0.05, 0.0), follows="arm")
    m = replace(m, bodies=bodies, joints=(*m.joints, side))
    gaps = {(gap.spring, gap.other): gap.distance for gap in clearance(m, samples=500).gaps}
    assert gaps["rod", "post"] == pytest.approx(0.05 - 0.01, abs=1e-9)
    assert gaps["shoulder spring", "rod"] == pytest.approx(0.05 - 0.01, abs=1e-9)


def test_without_geometry_nothing_is_called_clear(run, tmp_path):
    bare = tmp_path / "bare.yaml"
    eq.save(zoo.pendulum(), bare)
    code, out, _ = run("clearance", bare, "--samples", 50)
    assert code == 1
    assert "NOT JUDGED against the links" in out
    assert "CLEAR" not in out
    code, out, _ = run("clearance", bare, "--samples", 50, "--json")
    assert (code, json.loads(out)["judged"]["links"]) == (1, False)
    code, out, _ = run("design", bare, "--radius", "200mm", "--span", 1, "--clearance", "5mm")
    assert code == 0
    assert "NOT JUDGED against the links" in out


@pytest.mark.parametrize("suffix", [".svg"])
def test_the_closest_pose_is_drawn(run, tmp_path, suffix):
    shape = Shape("box", "stand", "box", (0.1, 0.1, 0.1), (0.1, 0.1, 0.1), (0.1, 0.2, 0.3))
    eq.save(replace(zoo.with_post(), shapes=(shape,)), tmp_path / "m.yaml")
    code, _, err = run("clearance", tmp_path / "m.yaml", "--samples", 50, "--plot", tmp_path / f"worst{suffix}")
    assert code == 0
    assert "wrote" in err
    assert (tmp_path / f"worst{suffix}").stat().st_size > 5000
    m = eq.load(tmp_path / "m.yaml")
    gap, pairs = clearance(m, samples=50).gaps[0], Pairs(m)
    here, there = pairs.between(Tree.of(m).poses(gap.configuration[None]), pairs.names.index((gap.spring, gap.other)))
    assert np.linalg.norm(here - there) == pytest.approx(gap.distance, abs=1e-9)


def test_the_share_of_the_workspace_that_is_free():
    """The spring's closest approach to a ball beside the way of its end: free where the arm is far enough from it."""
    m = zoo.with_post()
    m = replace(m, capsules=(Capsule("ball", "stand", (0.0, 0.0, -0.15), (0.0, 0.0, -0.15), 0.02),))
    found = clearance(m, samples=4000)
    tree, pairs = Tree.of(m), Pairs(m)
    q = np.linspace(-np.pi, np.pi, 20_001)[:, None]
    share = float((pairs.distances(tree.poses(q)).min(axis=1) >= 0.05).mean())
    assert 0.3 < share < 0.9
    assert found.free(0.05) == pytest.approx(share, abs=0.03)
    assert found.to_dict(0.05)["free"] == {"share": found.free(0.05), "limit": 0.05, "samples": 4000}

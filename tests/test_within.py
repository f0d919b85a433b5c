"""Room where a motion goes: the ranges that it uses, and springs that need room only there."""

from dataclasses import replace

import numpy as np
import zoo

from equipoise.clearance import clearance, within
from equipoise.kinematics import Tree
from equipoise.kinematics.sampling import bounds
from equipoise.model.mechanism import Capsule, PointMass
from equipoise.model.motion import Motion, Where
from equipoise.synthesis.convex.ordinary import ordinary

UP = Motion(("shoulder",), (0.0, 1.0, 2.0), ((0.6,), (0.2,), (1.1,)))


def test_the_ranges_are_those_of_the_motion():
    m = zoo.with_post()
    assert within(m, []) is m
    low, high = bounds(Tree.of(within(m, [UP])))
    assert (low, high) == (0.2, 1.1)
    arm = zoo.lee_chen_arm().mechanism
    first = Tree.of(arm).coordinates[0]
    one = within(arm, [Motion((first,), (0.0, 1.0, 2.0), ((0.0,), (0.3,), (0.1,)))])
    low, high = bounds(Tree.of(one))
    assert np.ptp(np.stack([low, high]), axis=0)[1:].max(initial=0.0) == 0  # what does not move rests


def test_room_is_needed_only_where_it_goes(run, tmp_path):
    """A ball where the spring comes by with the arm hanging down is in nobody's way with the arm up."""
    m = zoo.with_post()
    m = replace(m, capsules=(Capsule("ball", "stand", (0.0, 0.0, -0.15), (0.0, 0.0, -0.15), 0.02),))
    assert clearance(m, samples=300).least < 0.0
    assert clearance(within(m, [UP]), samples=300).least > 0.1
    goal = replace(m.goal, poses=Where(motions=(UP,)))
    assert ordinary(replace(m, goal=goal), clearance=0.02).moved is False


def test_what_springs_cannot_change_does_not_hold_them_up():
    """A weight that swings through a post is named by `clearance`; springs are moved out of the way all the same."""
    m = zoo.with_post()
    post = Capsule("post", "stand", (0.05, 0.01, -1.0), (0.05, 0.01, 1.0), 0.01)
    m = replace(m, capsules=(post,), masses=(PointMass("weight", "arm", 1.0, (-0.2, 0.0, 0.0)),))
    found = ordinary(m, clearance=0.005)
    assert found.room is not None
    assert found.room[1].least < 0
    assert found.room[1].least_of_springs >= 0.005

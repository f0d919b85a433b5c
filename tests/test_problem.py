"""A problem is a value: made, looked at, altered, solved; and it is checked whichever way it is made."""

from dataclasses import replace

import numpy as np
import pytest
from robots import lee_chen, planar_arm

import equipoise as eq
from equipoise.energy import Potential
from equipoise.kinematics import Tree, sample
from equipoise.model.errors import InputError

ARM = planar_arm([1, 2], [0.4, 0.3], [0.2, 0.1])
LIMITED = replace(ARM, joints=tuple(replace(j, range=(-0.5, 2.0)) for j in ARM.joints))
HELPER = eq.Spring("helper", "world", (0, 0, 0.1), "link2", (0.1, 0, 0), 30.0)


def test_design_is_solve_of_the_problem():
    problem = eq.Problem.of(ARM, span=1, radius=0.1, seed=3)
    solved, designed = eq.solve(problem, springs=2, seed=3), eq.design(ARM, span=1, radius=0.1, seed=3, springs=2)
    assert solved.mechanism == designed.mechanism
    assert solved.to_dict() == designed.to_dict()


def test_a_problem_with_other_pairs_regions_weights_and_poses():
    first = eq.Problem.of(LIMITED, span=1, radius=0.1)
    other = first.with_pairs([("world", "link3"), ("link3", "world")])
    assert (first.span, other.span, other.pairs) == (1, None, (("world", "link3"),))
    assert other.attachments["link3"] == (eq.Region.ball(0.1),)
    far = eq.Region.box(0.02, (0.2, 0, 0))
    other = other.with_regions({"link3": far}).with_poses(500, seed=2)
    assert other.attachments == {"link3": (far,), "world": (eq.Region.ball(0.1),)}
    assert (first.samples, other.samples, other.seed) == (None, 500, 2)
    design = eq.solve(other, springs=2)
    assert {(s.body_a, s.body_b) for s in design.mechanism.springs} == {("world", "link3")}
    assert all(np.abs(np.array(s.p_b) - (0.2, 0, 0)).max() <= 0.02 + 1e-12 for s in design.mechanism.springs)
    assert first == eq.Problem.of(LIMITED, span=1, radius=0.1)


def test_weights_are_factors_of_the_torques_that_count():
    problem = eq.Problem.of(LIMITED, pairs=[("world", "link2")], radius=0.1, samples=400)
    q = sample(Tree.of(LIMITED), 400, 0)
    left = {}
    for weight in (1.0, 10.0):
        weighted = problem.with_weights({"joint3": weight})
        design = eq.solve(weighted, springs=2)
        torque = Potential(design.mechanism)(q).torque * (1.0, weight)
        assert design.residual == pytest.approx(np.sqrt((torque**2).sum(axis=1).mean()), rel=1e-9)
        assert design.unbalanced > design.residual
        left[weight] = design
    assert left[10.0].free_parameters["weights"] == {"joint3": 10.0}
    assert left[10.0].unbalanced > left[1.0].unbalanced
    # no weight is the joint that does not count
    without = eq.solve(problem.with_weights({"joint3": 0.0}), springs=2)
    assert without.residual == pytest.approx(eq.solve(replace(problem, joints=("joint2",)), springs=2).residual)


def test_what_stays_is_part_of_the_problem():
    sprung = ARM.with_springs([HELPER])
    gone, kept = (eq.Problem.of(sprung, radius=0.1, keep=keep) for keep in (False, True))
    assert (gone.kept.springs, kept.kept.springs) == ((), (HELPER,))
    assert eq.solve(kept, springs=1).mechanism.springs[0] == HELPER
    assert HELPER not in eq.solve(gone, springs=1).mechanism.springs


def test_unlimited_poses_leave_the_robot_its_ranges():
    problem = eq.Problem.of(LIMITED, radius=0.1).with_poses(unlimited=True)
    assert [joint.range for joint in problem.judged.joints] == [None, None]
    assert eq.solve(problem, springs=1).mechanism.joints == LIMITED.joints


def test_enlarged_regions_keep_their_centres():
    problem = eq.Problem.of(ARM, radius=0.1, regions={"link2": eq.Region.ball(0.2, (0, 0, 0.1))}).enlarged(3)
    assert problem.attachments["link2"] == (eq.Region.ball(3 * 0.2, (0, 0, 0.1)),)
    assert problem.attachments["world"][0].half[0] == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"pairs": (("world", "lnk2"),)}, "did you mean 'link2'"),
        ({"pairs": ()}, "name at least one pair"),
        ({"regions": {"wrist": eq.Region.ball(1.0)}}, "there is no body 'wrist'"),
        ({"regions": {"link2": eq.Region.ball(0.0)}}, "more than 0 m"),
        ({"radius": 1e9}, "must be between"),
        ({"objective": "mean"}, "unknown objective"),
        ({"shape": "cube"}, "unknown shape"),
        ({"joints": ("joint9",)}, "no independent joint 'joint9'"),
        ({"weights": {"joint9": 1.0}}, "no independent joint 'joint9'"),
        ({"weights": {"joint2": -1.0}}, "at least 0, found -1"),
        ({"samples": 0}, "whole number from 1"),
        ({"seed": 0.5}, "whole number of at least 0"),
    ],
)
def test_replace_checks(change, message):
    with pytest.raises(InputError, match=message):
        replace(eq.Problem.of(lee_chen(), radius=0.1), **change)

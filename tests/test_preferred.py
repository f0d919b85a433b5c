"""Of equivalent designs the one that a person would draw: no torque changes, and the springs do."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from robots import planar_arm

import equipoise as eq
from equipoise.model.errors import InputError
from equipoise.synthesis.convex.few_springs import ROUNDING_SHARE, SpringSearch, SpringSet
from equipoise.synthesis.convex.goal import Rms, rms
from equipoise.synthesis.convex.least_squares_form import build
from equipoise.synthesis.convex.polish import Parts
from equipoise.synthesis.convex.preferred import preferred
from equipoise.synthesis.problem import Problem

ONE = planar_arm([0.3], [0.6], [0.3])
FOUR_BAR = Path(__file__).parents[1] / "examples" / "mechanisms" / "four_bar.yaml"


def spring_set(problem: Problem, k: float, p_a: tuple[float, ...], p_b: tuple[float, ...]) -> tuple[Rms, SpringSet]:
    """One spring on the only pair, in the regions' own coordinates."""
    goal = Rms(build(problem))
    parts = Parts(np.zeros((1, 1), int), np.array([[k]]), np.array([[[*p_a, *p_b]]]))
    value = float(rms(goal.reduced, parts)[0])
    return goal, SpringSet(parts, value, value < ROUNDING_SHARE, 0.0)


def test_a_spring_on_one_hinge_goes_where_one_would_draw_it():
    """Field case: turned about the hinge, out of its plane and stiff; equivalent is (0, 0, a) to (b, 0, 0)."""
    problem = Problem.of(ONE, pairs=[("world", "link2")], radius=0.1)
    turn = 2.5  # of the whole spring about the hinge, which changes nothing
    a, b = 0.04, 0.05
    k = 0.3 * 9.81 * 0.3 / (a * b)
    p_a = (-a * np.sin(turn) / 0.1, -0.8, a * np.cos(turn) / 0.1)
    p_b = (b * np.cos(turn) / 0.1, -0.77, b * np.sin(turn) / 0.1)
    goal, start = spring_set(problem, k, p_a, p_b)
    assert start.exact
    found = preferred(goal, start, {}, 1)
    assert found.exact
    assert rms(goal.reduced, found.parts)[0] < ROUNDING_SHARE
    np.testing.assert_allclose(found.parts.u[0, 0], [0, 0, 1, 1, 0, 0], atol=2e-3)  # least force: as far out as may be
    assert found.parts.k[0, 0] == pytest.approx(0.3 * 9.81 * 0.3 / 0.1**2, rel=2e-3)


def test_a_design_has_its_springs_in_the_plane_of_the_motion():
    for mechanism in (planar_arm([1, 2], [0.4, 0.3], [0.2, 0.1]), eq.load(FOUR_BAR)):
        design = eq.design(mechanism)
        assert design.balance.exact or design.certified_gap is not None
        assert max(abs(p[1]) for s in design.mechanism.springs for p in (s.p_a, s.p_b)) < 1e-4


def test_both_ends_are_in_one_plane_where_links_lie_side_by_side():
    arm = planar_arm([1, 2], [0.4, 0.3], [0.2, 0.1])
    aside = {"world": 0.0, "link2": 0.0, "link3": 0.03}  # [m] of each body's origin along the axes
    joints = tuple(replace(j, xyz=(j.xyz[0], aside[j.child], 0.0)) for j in arm.joints)
    for spring in eq.design(replace(arm, joints=joints), radius=0.1, shape="box").mechanism.springs:
        heights = [p[1] + aside[body] for body, p in spring.ends]
        assert heights[0] == pytest.approx(heights[1], abs=1e-9)


@pytest.mark.parametrize("prefer", ["force", "energy"])
def test_what_is_preferred_gets_less_and_the_balance_stays(prefer):
    arm = planar_arm([1.0, 0.8], [0.3, 0.25], [0.15, 0.1])
    designs = {name: eq.design(arm, radius=0.1, prefer=name) for name in (None, prefer)}
    assert all(one.balance.exact for one in designs.values())
    assert len({len(one.mechanism.springs) for one in designs.values()}) == 1

    def measure(design: eq.Design) -> float:
        springs = design.to_dict()["balance"]["springs"]
        if prefer == "energy":
            return design.balance.springs[1]
        return max(s[{"force": "max_force", "length": "max_length", "rate": "stiffness"}[prefer]] for s in springs)

    assert measure(designs[prefer]) <= measure(designs[None]) * 1.02
    assert designs[prefer].free_parameters["prefer"] == prefer


def test_wishes_have_the_slopes_of_central_differences():
    from equipoise.synthesis.convex.wishes import Wishes

    reduced = build(Problem.of(planar_arm([1, 2], [0.4, 0.3], [0.2, 0.1]), radius=0.1))
    rng = np.random.default_rng(0)
    parts = Parts(np.array([[0, 1, 2]]), rng.uniform(50, 200, (1, 3)), rng.uniform(-0.5, 0.5, (1, 3, 6)))
    wishes = Wishes(reduced, parts, "energy")
    slopes = wishes.slopes(parts)
    for i in range(3):
        for j in range(7):
            step = np.zeros((1, 3, 7))
            step[0, i, j] = 1e-6
            more, less = (Parts(parts.block, parts.k * np.exp(s[..., 0]), parts.u + s[..., 1:]) for s in (step, -step))
            difference = (wishes.rows(more) - wishes.rows(less)) / 2e-6
            np.testing.assert_allclose(slopes[0, :, 7 * i + j], difference[0], atol=1e-6)


def test_one_spring_more_where_all_are_far_lighter():
    """A heavy set and a light one of one spring more, both exact: two in parallel are no lighter than one."""
    problem = Problem.of(ONE, pairs=[("world", "link2")], radius=0.1)
    search = SpringSearch(Rms(build(problem)), most=8)
    found = search.few()
    assert found is not None
    twice = Parts(np.zeros((1, 2), int), np.tile(found.parts.k / 2, 2), np.tile(found.parts.u, (1, 2, 1)))
    kept = preferred(search.goal, found, {2: [SpringSet(twice, found.value, True, 0.0)]}, 2)
    assert kept.count == 1
    stiff = replace(found, parts=Parts(found.parts.block, found.parts.k * 100, found.parts.u * 0.1))
    goal = Rms(build(replace(problem, regions={"world": 0.01, "link2": 0.01})))  # no room to be soft
    assert preferred(goal, stiff, {}, 1).parts.k[0, 0] > 50 * found.parts.k[0, 0]


def test_the_peak_stays_what_it_was():
    lift = eq.Mechanism(
        "lift",
        (eq.Body("carriage", 6.0),),
        (eq.Joint("z", "prismatic", "world", "carriage", axis=(0, 0, 1), range=(0.0, 0.4)),),
    )
    design = eq.design(lift, radius=0.3, objective="peak")
    assert design.residual == pytest.approx(29.43, rel=1e-4)
    assert len(design.mechanism.springs) == 1


def test_an_unknown_preference():
    with pytest.raises(InputError, match=r"prefer: unknown value 'forces'; did you mean 'force'\? \(valid: force"):
        eq.design(ONE, prefer="forces")  # type: ignore[arg-type]

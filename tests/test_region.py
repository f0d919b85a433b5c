"""Regions: balls, boxes that may be flat, points, unions, joints as centres; and no end outside of them, ever."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from robots import planar_arm

import equipoise as eq
from equipoise.model.errors import InputError
from equipoise.model.region import Attachment
from equipoise.synthesis.convex.polish import Parts
from equipoise.synthesis.convex.spring_block import SpringBlock
from equipoise.synthesis.region import given_regions, nearest_region, project

ARM = planar_arm([1, 2], [0.4, 0.3], [0.2, 0.1])
length = st.floats(1e-6, 10)
place = st.tuples(*[st.floats(-10, 10)] * 3)
balls = st.builds(eq.Region.ball, length, place)
boxes = st.builds(eq.Region.box, st.tuples(*[st.one_of(st.just(0.0), length)] * 3), place)


def outside(region: eq.Region, p: tuple[float, ...]) -> bool:
    """In exact arithmetic."""
    off = [Fraction(x) - Fraction(c) for x, c in zip(p, region.at, strict=True)]
    if region.shape == "ball":
        return sum(d * d for d in off) > Fraction(region.half[0]) ** 2
    return any(abs(d) > Fraction(h) for d, h in zip(off, region.half, strict=True))


@settings(max_examples=200)
@given(st.one_of(balls, boxes), st.one_of(balls, boxes), st.integers(0, 2**32 - 1))
def test_no_end_lies_outside_its_region(region_a, region_b, seed):
    rng = np.random.default_rng(seed)
    block = SpringBlock("world", "link2", region_a, region_b)
    assert block.shape == len(region_a.axes) + len(region_b.axes)  # what a region fixes is no unknown
    ends = block.attachments(block.project(3 * rng.normal(size=(1, block.shape)))[0])
    for region, p in zip((region_a, region_b), ends, strict=True):
        assert not outside(region, p)
        fixed = [i for i in range(3) if i not in region.axes]
        assert [p[i] for i in fixed] == [region.at[i] for i in fixed]


def test_the_nearest_point_of_a_region():
    u = np.array([[3.0, 0.0, -4.0]])
    np.testing.assert_allclose(project(u, np.array(False)), [[0.6, 0.0, -0.8]])
    np.testing.assert_allclose(project(u, np.array(True)), [[1.0, 0.0, -1.0]])


def test_a_joint_is_a_centre():
    region = eq.Region.box((0.05, 0, 0.02), "joint3")
    assert region.on("link2", ARM.joints) == replace(region, centre=(0.4, 0, 0))  # where it hangs on its parent
    assert region.on("link3", ARM.joints) == replace(region, centre=(0, 0, 0))
    with pytest.raises(InputError, match=r"'world' has no joint 'joint3'; did you mean .* \(valid: joint2\)"):
        region.on("world", ARM.joints)
    with pytest.raises(InputError, match="known with a mechanism"):
        _ = region.lift


def test_what_is_given_counts_before_the_file():
    file = replace(
        ARM,
        attachments=(
            Attachment("world", eq.Region.point((0, 0, 0.1))),
            Attachment("world", eq.Region.ball(0.05)),
            Attachment("link2", eq.Region.ball(0.1, "joint3")),
        ),
    )
    own = given_regions(file, {"link2": "50 mm", "link3": [eq.Region.point(), eq.Region.point()]})
    assert own == {
        "world": (eq.Region.point((0, 0, 0.1)), eq.Region.ball(0.05)),
        "link2": (eq.Region.ball(0.05),),
        "link3": (eq.Region.point(),),
    }
    problem = eq.Problem.of(file, pairs=[("world", "link2")], radius=1.0)
    assert problem.attachments["link2"] == (eq.Region.ball(0.1, (0.4, 0, 0)),)
    assert len(problem.blocks) == 2  # one for each region of the world
    with pytest.raises(InputError, match="there is none"):
        given_regions(ARM, {"link2": []})


def test_a_design_uses_both_parts_of_a_union_and_nothing_between():
    """Two points on the ground that only together balance: their springs' moments are not parallel to gravity's."""
    one = replace(ARM, bodies=(replace(ARM.bodies[0], com=(0.2, 0, 0.05)), replace(ARM.bodies[1], mass=0.0)))
    points = [eq.Region.point((0.1, 0, 0.1)), eq.Region.point((-0.1, 0, 0.1))]
    asked = {"pairs": [("world", "link2")], "joints": ["joint2"]}
    regions = {"world": points, "link2": [eq.Region.point((0.2, 0, 0)), eq.Region.point((0.1, 0, 0.1))]}
    design = eq.design(one, regions=regions, **asked)
    assert {s.p_a for s in design.mechanism.springs} <= {p.centre for p in points}
    alone = eq.design(one, regions=regions | {"world": points[0]}, **asked)
    assert design.residual < 0.9 * alone.residual
    assert design.bound is not None
    assert design.residual <= design.bound + 1e-6 * design.unbalanced  # amounts alone: the program is exact
    assert isinstance(design.free_parameters["regions"]["world"], list)


def test_the_nearest_of_several_regions():
    regions = [eq.Region.ball(0.1), eq.Region.box((0.5, 0, 0), (1, 0, 0))]
    assert nearest_region(regions, (0.05, 0, 0)) is regions[0]
    assert nearest_region(regions, (0.6, 0, 0)) is regions[1]


def test_sets_on_blocks_of_different_shapes_are_one_batch():
    """A set on some of the blocks has fewer coordinates than one on others."""
    flat, whole = (Parts(np.zeros((1, 2), int), np.ones((1, 2)), np.full((1, 2, n), 0.5)) for n in (5, 6))
    both = Parts.joined([flat, whole])
    assert both.u.shape == (2, 2, 6)
    assert both.u[0].tolist() == [[0.5] * 5 + [0.0]] * 2
    assert both.u[1].tolist() == [[0.5] * 6] * 2


def test_the_viewer_designs_again_within_the_regions_of_the_file():
    from equipoise.viewer.model import Model

    line = eq.Region.box((0.02, 0, 0), (0, 0, 0.15))
    springs = [eq.Spring(body, "world", (0, 0, 0.3), body, (0.05, 0, 0), 100.0) for body in ("link2", "link3")]
    model = Model(replace(ARM, attachments=(Attachment("world", line),), springs=tuple(springs)))
    assert model.redesign()
    assert not any(outside(line, p) for s in model.springs for body, p in s.ends if body == "world")
    assert model.saved().attachments == model.file.attachments

"""``--region`` as it is typed."""

import pytest

import equipoise as eq
from equipoise.cli.regions import regions
from equipoise.model.errors import InputError


@pytest.mark.parametrize(
    ("text", "region"),
    [
        ("80mm", eq.Region.ball(0.08)),
        ("ball 80 mm at 0, 0, 5 cm", eq.Region.ball(0.08, (0, 0, 0.05))),
        ("box 100,0,20 mm at 50,0,0 mm", eq.Region.box((0.1, 0, 0.02), (0.05, 0, 0))),
        ("box 100 mm,0,2 cm at 50 mm,0,0", eq.Region.box((0.1, 0, 0.02), (0.05, 0, 0))),
        ("box 0.1", eq.Region.box(0.1)),
        ("point at -1e-2,0,.1", eq.Region.point((-0.01, 0, 0.1))),
        ("point at wrist 1", eq.Region.point("wrist 1")),
    ],
)
def test_each_shape(text, region):
    assert regions([f"forearm={text}"], box=False) == {"forearm": [region]}


def test_a_radius_may_be_half_a_box_and_several_are_a_union():
    assert regions(["a=0.1", "b=0.2", "a=point at 0,0,0"], box=True) == {
        "a": [eq.Region.box(0.1), eq.Region.point()],
        "b": [eq.Region.box(0.2)],
    }


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("forearm", "expected BODY=RADIUS"),
        ("a=cube 3", "found 'cube 3', in 'a=cube 3' .*BODY=box X,Y,Z at X,Y,Z"),
        ("a=box 1,2", "one half side, or three"),
        ("a=ball 1,2,3", "one radius"),
        ("a=ball 0 at 0,0,0", "more than 0 m"),
        ("a=box 1,-1,0", "more than 0 m"),
        ("a=point 3 at 0,0,0", "a point has no size"),
        ("a=point at 0,0", "expected 'at X,Y,Z' or 'at JOINT'"),
        ("a=ball 3 kg", "length"),
    ],
)
def test_what_is_no_region(text, message):
    with pytest.raises(InputError, match=message):
        regions([text], box=False)

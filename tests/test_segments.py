"""Distances of segments against a collision library, closed forms, and what must not change them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from peers import peer

from equipoise.clearance import closest

points = arrays(float, (4, 3), elements=st.floats(-2, 2, allow_subnormal=False))


def test_a_thousand_random_capsules_as_a_collision_library_has_them():
    coal = peer("coal")
    rng = np.random.default_rng(0)
    ends, radius = rng.uniform(-1, 1, (1500, 4, 3)), rng.uniform(0.01, 0.1, (1500, 2))
    own = closest(*ends.transpose(1, 0, 2))[0] - radius.sum(axis=1)
    apart = np.flatnonzero(own >= 1e-3)[:1000]  # touching: a penetration depth is another question
    assert len(apart) == 1000
    request, far = coal.DistanceRequest(), []
    request.gjk_tolerance = 1e-12
    for (a, b, c, d), (r, s), distance in zip(ends[apart], radius[apart], own[apart], strict=True):
        shapes = [_capsule(coal, a, b, r), _capsule(coal, c, d, s)]
        far.append(distance - coal.distance(*shapes[0], *shapes[1], request, coal.DistanceResult()))
    assert np.abs(far).max() < 1e-9


def _capsule(coal, a, b, radius):
    z = (b - a) / np.linalg.norm(b - a)
    x = np.linalg.svd(z[None])[2][1]
    R = np.stack([x, np.cross(z, x), z], axis=1)
    return coal.Capsule(float(radius), float(np.linalg.norm(b - a))), coal.Transform3s(R, (a + b) / 2)


@settings(deadline=None)
@given(points)
def test_it_is_the_least_of_all_distances_between_their_points(p):
    a, b, c, d = p
    distance, s, t = closest(a, b, c, d)
    grid = np.linspace(0, 1, 21)
    first, second = a + grid[:, None] * (b - a), c + grid[:, None] * (d - c)
    assert distance <= np.linalg.norm(first[:, None] - second, axis=2).min() + 1e-12
    assert distance == pytest.approx(np.linalg.norm(a + s * (b - a) - c - t * (d - c)), abs=1e-12)
    assert 0 <= s <= 1
    assert 0 <= t <= 1


@settings(deadline=None)
@given(points)
def test_neither_order_nor_direction_matters(p):
    a, b, c, d = p
    distance = closest(a, b, c, d)[0]
    for other in ((c, d, a, b), (b, a, c, d), (a, b, d, c)):
        assert closest(*other)[0] == pytest.approx(distance, abs=1e-9)


@pytest.mark.parametrize(
    ("ends", "distance"),
    [
        (((0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)), 1.0),  # parallel
        (((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)), 1.0),  # in line
        (((0, 0, 0), (2, 0, 0), (1, 0, 0), (3, 0, 0)), 0.0),  # overlapping
        (((0, 0, 0), (1, 0, 0), (0.5, -1, 1), (0.5, 1, 1)), 1.0),  # crossing
        (((0, 0, 0), (0, 0, 0), (0, 3, 4), (0, 3, 4)), 5.0),  # two points
        (((0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1 + 1e-9, 0)), 1.0),  # nearly parallel
    ],
)
def test_closed_forms(ends, distance):
    assert closest(*np.array(ends, float))[0] == pytest.approx(distance, abs=1e-12)

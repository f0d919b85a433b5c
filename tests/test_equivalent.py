"""Equivalent installations, Eqs. (28a, b): the same blocks off the diagonal, and designs stay exact."""

from cmath import phase
from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from robots import lee_chen

import equipoise as eq
from equipoise.model.errors import InfeasibleError, UnsupportedError
from equipoise.synthesis.planar.arm import Installation, PlanarArm
from equipoise.synthesis.planar.equivalent import exchanged, resized, rotated, turned
from equipoise.synthesis.planar.installing import Installed, solve
from equipoise.synthesis.planar.stiffness_blocks import StiffnessBlocks

ARM = PlanarArm.of(lee_chen())
lengths = st.floats(0.02, 0.5)
angles = st.floats(-pi, pi)
ends = st.builds(lambda length, angle: complex(length * np.exp(1j * angle)), lengths, angles)
stiffnesses = st.floats(10, 1000)


def blocks(*springs: Installation) -> np.ndarray:
    return np.sum([StiffnessBlocks.spring(ARM, one).off_diagonal for one in springs], axis=0)


def same(one: tuple[Installation, ...], two: tuple[Installation, ...]) -> bool:
    a, b = blocks(*one), blocks(*two)
    return bool(abs(a - b).max() <= 1e-9 * abs(a).max())


def solution(*layout: tuple[int, int]) -> Installed:
    found = solve(ARM, layout)
    assert found is not None
    return found


def exact(*springs: Installation) -> bool:
    return eq.check(lee_chen().with_springs(ARM.springs(springs))).exact


@given(st.integers(1, 3), stiffnesses, ends, ends, angles, lengths, lengths)
def test_between_neighbours(i, k, a, b, angle, c, d):
    one = Installation(i, i + 1, k, a, b)
    assert same((one,), (turned(one, angle),))
    new = resized(one, c, d)
    assert (abs(new.a), abs(new.b)) == pytest.approx((c, d))
    assert same((one,), (new,))


@given(stiffnesses, stiffnesses, ends, ends, ends, ends, st.sampled_from([(1, 3), (1, 4), (2, 4)]))
def test_two_between_the_same_links(k, m, a, b, c, d, pair):
    i, j = pair
    one, two = Installation(i, j, k, a, b), Installation(i, j, m, c, d)
    try:
        lower, upper = exchanged(ARM, one, two, "lower"), exchanged(ARM, one, two, "upper")
    except InfeasibleError:  # alike, or nothing would be left between the ends
        return
    assert (lower[0].i, lower[0].k, lower[1].i) == (i, j, i + 1)
    assert (upper[0].i, upper[0].k, upper[1].k) == (i, j, j - 1)
    assert lower[1].k in (j, j - 1)  # j - 1 where both springs have the same ratio of a to b
    assert upper[1].i in (i, i + 1)
    assert lower[1].a == pytest.approx(-ARM.lengths[i])  # 28a: on the joint
    if upper[1].span > 1:  # else only k a b counts
        assert upper[1].b == pytest.approx(ARM.lengths[j - 2])  # 28b
    assert same((one, two), lower)
    assert same((one, two), upper)


def test_28a_leads_from_one_minimum_to_the_other():
    """Tables 2 and 3: {13,14,14} and {13,14,24}, each exact."""
    first, one, two = solution((1, 3), (1, 4), (1, 4)).springs
    pair = exchanged(ARM, one, two, "lower")
    assert [(s.i, s.k) for s in (first, *pair)] == [(1, 3), (1, 4), (2, 4)]
    assert exact(first, one, two)
    assert exact(first, *pair)
    back = rotated(ARM, pair[0], pair[1], 0.4)
    assert [(s.i, s.k) for s in back] == [(1, 4), (1, 4)]
    assert exact(first, *back)


def test_figure_8():
    """Springs 23 and 24 on link 2 become 24 and 34 on link 4: Table 3's last matrix for n = 4."""
    s12, s14, s23, s24 = solution((1, 2), (1, 4), (2, 3), (2, 4)).springs
    on_joint = resized(turned(s23, -phase(s23.b)), 0.05, float(ARM.lengths[2]))
    two = rotated(ARM, s24, on_joint, 0.7)
    assert [(s.i, s.k) for s in two] == [(2, 4), (2, 4)]
    pair = exchanged(ARM, two[0], two[1], "lower")
    assert [(s.i, s.k) for s in pair] == [(2, 4), (3, 4)]
    assert exact(s12, s14, *pair)


def test_what_cannot_be_exchanged():
    far, near = Installation(1, 3, 100, 0.1j, 0.1), Installation(1, 2, 100, 0.1j, 0.1)
    with pytest.raises(UnsupportedError, match="same two links"):
        exchanged(ARM, far, near, "lower")
    with pytest.raises(UnsupportedError, match="same two links"):
        exchanged(ARM, near, near, "lower")
    with pytest.raises(UnsupportedError, match="spans 2 joints"):
        turned(far, 1.0)
    with pytest.raises(UnsupportedError, match="spans 2 joints"):
        resized(far, 0.1, 0.1)
    with pytest.raises(InfeasibleError, match="act as one"):
        exchanged(ARM, far, far, "lower")
    with pytest.raises(InfeasibleError, match="what lies between"):
        exchanged(ARM, far, Installation(1, 3, 100, -0.1j, -0.1), "lower")

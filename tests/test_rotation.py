"""Rotation matrices to roll, pitch and yaw, and back."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from equipoise.model.rotation import from_rpy, to_rpy

angles = st.floats(-pi, pi) | st.sampled_from([0.0, pi / 2, -pi / 2, pi, -pi])


@given(angles, angles, angles)
def test_there_and_back(roll, pitch, yaw):
    R = from_rpy((roll, pitch, yaw))
    np.testing.assert_allclose(from_rpy(to_rpy(R)), R, atol=1e-11)


@given(st.integers(0, 2**32 - 1))
def test_any_rotation_as_another_library_has_it(seed):
    x, y, z, w = np.random.default_rng(seed).normal(size=4)
    R = Rotation.from_quat([x, y, z, w])
    np.testing.assert_allclose(to_rpy(R.as_matrix()), R.as_euler("xyz"), atol=1e-9)


@given(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))
def test_angles_are_found_again(roll, pitch, yaw):
    assert to_rpy(from_rpy((roll, pitch, yaw))) == pytest.approx((roll, pitch, yaw), abs=1e-9)


@pytest.mark.parametrize("pitch", [pi / 2, -pi / 2])
def test_straight_up_the_yaw_is_zero(pitch):
    roll, found, yaw = to_rpy(from_rpy((0.3, pitch, 0.8)))
    assert found == pytest.approx(pitch)
    assert yaw == 0.0
    np.testing.assert_allclose(from_rpy((roll, found, yaw)), from_rpy((0.3, pitch, 0.8)), atol=1e-12)

"""Attachments keep off the axis that they turn about: distances by hand, the derivative, a design that would not."""

from dataclasses import replace

import numpy as np
import pytest
import zoo
from robots import robot

import equipoise as eq
from equipoise.synthesis.convex import levers
from equipoise.synthesis.convex.levers import Levers
from equipoise.synthesis.convex.ordinary import ordinary


def test_the_distance_is_that_from_the_axis_of_the_joint_between():
    """On a UR5 the shoulder lifts about y of the upper arm, whose origin the axis goes through."""
    m = robot("ur5").with_springs(
        [eq.Spring("s", "shoulder_link", (0.3, 0.4, 0.0), "upper_arm_link", (0.0, 0.9, 0.004), 1.0)]
    )
    found = Levers.of(m, m.springs, 1.0)  # type: ignore[arg-type]
    assert found.wanted[0, 1] == pytest.approx(0.004, abs=1e-9)
    axis = np.eye(3) - found.across[0, 0]
    assert abs(axis[1, 1]) == pytest.approx(1, abs=1e-9)
    assert found.wanted[0, 0] == pytest.approx(0.3, abs=1e-9)
    rows, _ = found(np.array([[(0.3, 0.4, 0.0), (0.0, 0.0, 0.004)]]))
    assert len(rows) <= 2
    rows, _ = found(np.array([[(0.3, -7.0, 0.0), (0.0, 0.0, 0.002)]]))
    assert rows.max() == pytest.approx(levers.WEIGHT / 2, rel=1e-6)


def test_derivative_by_differences():
    m = zoo.pendulum()
    found = Levers.of(m, m.springs)  # type: ignore[arg-type]
    p, h = np.array([[(0.001, 0.0, 0.002), (0.001, 0.3, -0.003)]]), 1e-7
    rows, J = found(p)
    assert len(rows) == 2
    for i in np.ndindex(p.shape):
        step = np.zeros(p.shape)
        step[i] = h
        assert J[(slice(None), *i)] == pytest.approx((found(p + step)[0] - found(p - step)[0]) / (2 * h), abs=1e-3)


def test_a_stiff_spring_does_not_end_on_its_pivot(monkeypatch):
    """A long free length asks for a short lever: without these rows the end comes within a millimetre of the axis."""
    m = zoo.pendulum()
    near = replace(m.springs[0], p_b=(0.006, 0.0, 0.0), stiffness=zoo.PENDULUM_K * 0.15 / 0.006)
    m = replace(m, joints=(replace(m.joints[0], range=(-1.2, 1.2)),)).with_springs([near])

    def lever() -> float:
        (spring,) = ordinary(m, 0.15, stiffness_factor=40.0).mechanism.springs
        return min(float(np.hypot(p[0], p[2])) for p in (spring.p_a, spring.p_b))

    assert lever() >= 0.005
    monkeypatch.setattr(levers, "WEIGHT", 0.0)
    assert lever() < 0.001

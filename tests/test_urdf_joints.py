"""Joints of a URDF together: limits that nobody set, followers, and joints with several coordinates."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from test_urdf import TWO, joint, read

from equipoise.io import urdf
from equipoise.model.errors import EquipoiseWarning


def test_limits_that_are_not_there_are_none() -> None:
    with pytest.warns(EquipoiseWarning, match="as type='continuous' says"), pytest.warns(match="judged over"):
        m = read(
            TWO
            + "<link name='c'/>"
            + joint("prismatic")
            + joint("revolute", "<limit lower='0' upper='0'/>", "k", "b", "c")
        )
    assert [j.range for j in m.joints[1:]] == [None, None]
    m = read(TWO + joint("revolute", "<limit lower='.3' upper='.3'/>"))
    assert m.joints[1].range == (0.3, 0.3)


@pytest.mark.parametrize(
    ("ratio", "leads", "own", "left"),
    [(-1, "-1 1", "0 .5", None), (1, "0 .5", "0 .5", (0, 0.5)), (-2, "-1 1", "-2 2", (-2, 2)), (2, None, "-1 1", None)],
)
def test_a_followers_limits_do_not_restrict_its_leader(ratio, leads, own, left) -> None:
    def limit(ends: str | None) -> str:
        return "" if ends is None else "<limit lower='{}' upper='{}'/>".format(*ends.split())

    body = TWO + "<link name='c'/>" + joint("revolute" if leads else "continuous", limit(leads))
    body += "\n" + joint("revolute", limit(own) + f"<mimic joint='j' multiplier='{ratio}'/>", "k", "a", "c")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        m = read(body)
    assert m.joints[-1].range == left
    said = [str(one.message) for one in caught]
    assert said == [] if left else "joint 'k' (line 4): a follower's own limits" in said[0]


def test_floating_and_planar_joints() -> None:
    base = TWO + "<link name='c'/>" + joint("continuous", "<axis xyz='0 1 0'/>", "k", "b", "c")
    text = "<robot name='r'>" + base + joint("floating", "<origin xyz='1 2 3'/>") + "</robot>"
    assert urdf.read_text(text, "r.urdf", "fixed").coordinates == ("k",)
    loose = urdf.read_text(text, "r.urdf", "free")
    assert loose.coordinates == ("k", "j x", "j y", "j z", "j.x", "j.y", "j.z")
    m = read(TWO + joint("planar", "<axis xyz='0 0 1'/>"))
    assert [(j.name, j.type) for j in m.joints[1:]] == [("j x", "prismatic"), ("j y", "prismatic"), ("j", "revolute")]
    axes = np.array([j.axis for j in m.joints[1:]])
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-15)
    assert tuple(axes[2]) == (0, 0, 1)

"""The DH table: its frames against the matrix products that define the two conventions."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import dh_rows

from equipoise import io
from equipoise.io import yaml
from equipoise.model.errors import InputError
from equipoise.model.mechanism import Joint, Mechanism


def read(tmp_path: Path, text: str) -> Mechanism:
    path = tmp_path / "dh.yaml"
    path.write_text(text, encoding="utf-8")
    return io.load(path)


def rotation(axis: str, angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    T = np.eye(4)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    T[i, i] = T[j, j] = c
    T[i, j], T[j, i] = -s, s
    return T


def translation(x: float, z: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = x, 0, z
    return T


def pose(joint: Joint, q: float) -> np.ndarray:
    """X_PC (4, 4) of a fixed joint, or of a revolute or prismatic one about z at q [rad or m]."""
    T = rotation("z", joint.rpy[2]) @ rotation("y", joint.rpy[1]) @ rotation("x", joint.rpy[0])
    T[:3, 3] = joint.xyz
    if joint.type == "fixed":
        return T
    assert joint.axis == (0.0, 0.0, 1.0)
    return T @ (rotation("z", q) if joint.type == "revolute" else translation(0, q))


@pytest.mark.parametrize("convention", ["standard", "modified"])
@settings(derandomize=True, deadline=None, max_examples=40)
@given(rows=dh_rows(), q=st.floats(-3, 3))
def test_dh_frames_are_the_products_of_the_convention(tmp_path_factory, convention, rows, q):
    lines = [f"schema: 1\nname: dh\nbodies: {[{'name': f'b{i}'} for i in range(len(rows))]}", "dh:"]
    lines += [f"  convention: {convention}", "  rows:", *(f"    - {row}" for row in rows)]
    mechanism = read(tmp_path_factory.getbasetemp(), "\n".join(lines))
    frames = {"world": np.eye(4)}
    for joint in mechanism.joints:
        frames[joint.child] = frames[joint.parent] @ pose(joint, q)
    expected = np.eye(4)
    for i, row in enumerate(rows):
        theta, d = (row["theta"] + q, row["d"]) if row["type"] == "revolute" else (row["theta"], row["d"] + q)
        turn = rotation("z", theta) @ translation(0, d)
        side = translation(row["a"], 0) @ rotation("x", row["alpha"])
        expected = expected @ (turn @ side if convention == "standard" else side @ turn)
        np.testing.assert_allclose(frames[f"b{i}"], expected, atol=1e-13)


def test_dh_names_ranges_and_couplings(tmp_path):
    text = """\
schema: 1
name: dh
bodies: [{name: one, mass: 1}, {name: two}]
dh:
  convention: standard
  rows:
    - {a: 0, alpha: 90 deg, d: 30 cm, theta: 0, range: [-90 deg, 90 deg]}
    - {name: slide, type: prismatic, a: 0, alpha: 0, d: 0, theta: 0, range: [0, 20 cm]}
couplings: [{joint: slide, terms: {joint_1: 0.1}, offset: 5 cm}]
"""
    found = read(tmp_path, text)
    assert [body.name for body in found.bodies] == ["one_axis", "one", "two_axis", "two"]
    assert [joint.name for joint in found.joints] == ["joint_1", "joint_1_link", "slide", "slide_link"]
    assert found.bodies[0].mass == 0
    assert found.joints[0].range == pytest.approx((-math.pi / 2, math.pi / 2))
    assert found.joints[2].range == pytest.approx((0, 0.2))
    assert found.coordinates == ("joint_1",)
    assert read(tmp_path, yaml.to_text(found)) == found
    with pytest.raises(InputError, match=r"bodies\[1\]: body 'two_axis' of the dh table: duplicate name 'two_axis'"):
        read(tmp_path, text.replace("one", "two_axis"))

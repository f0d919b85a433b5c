"""The picture of a design: well-formed, the same every time, readable for any mechanism, nothing half-written."""

import struct
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest
from robots import lee_chen, planar_arm, robot

import equipoise as eq
from equipoise.errors import InputError
from equipoise.io import files
from equipoise.kinematics import Tree
from equipoise.report.arm import zigzag
from equipoise.report.figure import save_figure
from equipoise.report.poses import choose
from equipoise.report.skeleton import Skeleton

SPRINGS = (
    eq.Spring("shoulder spring", "world", (0, 0, 0.2), "link2", (0.1, 0, 0), 123.4),
    eq.Spring("elbow & wrist <1>", "link2", (0, 0, 0.1), "link3", (0.1, 0, 0), 5678.0),
)


def arm() -> eq.Mechanism:
    return planar_arm([1.0, 0.5], [0.4, 0.3], [0.2, 0.15]).with_springs(SPRINGS)


def texts(path) -> str:
    root = ElementTree.fromstring(path.read_text())
    return "\n".join("".join(node.itertext()) for node in root.iter() if node.tag.endswith("text"))


def test_svg_is_well_formed_and_names_springs_bodies_and_units(tmp_path):
    path = tmp_path / "arm.svg"
    save_figure(arm(), path)
    shown = texts(path)
    for text in ("planar arm", "2 springs", "shoulder spring", "elbow & wrist <1>", "123.4 N/m", "5678 N/m", "N m"):
        assert text in shown
    assert "joint2" in shown
    assert "joint3" in shown


def test_the_verdict_is_in_the_picture(tmp_path):
    exact = eq.design(lee_chen(), span=3, radius=0.2)
    save_figure(exact.mechanism, tmp_path / "exact.svg", balance=exact.balance)
    assert "EXACT" in texts(tmp_path / "exact.svg")
    soft = [replace(s, stiffness=0.99 * s.stiffness) for s in exact.mechanism.springs]
    save_figure(exact.mechanism.with_springs(soft), tmp_path / "soft.svg")
    assert "% of unbalanced" in texts(tmp_path / "soft.svg")
    save_figure(lee_chen(), tmp_path / "bare.svg")
    assert "gravity alone" in texts(tmp_path / "bare.svg")


def test_png_has_its_size(tmp_path):
    path = tmp_path / "arm.png"
    save_figure(arm(), path)
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    assert struct.unpack(">II", data[16:24]) == (2100, 1050)


@pytest.mark.parametrize("suffix", [".svg", ".png", ".pdf"])
def test_the_same_bytes_twice(tmp_path, suffix):
    for name in ("one", "two"):
        save_figure(arm(), tmp_path / f"{name}{suffix}")
    assert (tmp_path / f"one{suffix}").read_bytes() == (tmp_path / f"two{suffix}").read_bytes()


@pytest.mark.parametrize("name", ["ur5", "panda", "human"])
def test_real_robots(tmp_path, name):
    mechanism = replace(robot(name), workspace=eq.Workspace(200))
    save_figure(mechanism, tmp_path / "robot.svg")
    shown = texts(tmp_path / "robot.svg")
    if name == "human":
        assert "the 12 of 36 coordinates with the largest unbalanced torque" in shown


def test_all_kinds_of_joints_payloads_and_nothing_at_all(tmp_path):
    every = eq.Mechanism(
        "every kind",
        bodies=(eq.Body("a", 1.0, (0.1, 0, 0)), eq.Body("b"), eq.Body("c", 1.0, (0, 0.1, 0)), eq.Body("d", 0.5)),
        joints=(
            eq.Joint("ball", "spherical", "world", "a"),
            eq.Joint("slide", "prismatic", "a", "b", xyz=(0.2, 0, 0), axis=(1, 0, 0), range=(0, 0.1)),
            eq.Joint("follow", "parallelogram", "b", "c", xyz=(0.1, 0, 0), follows="world"),
            eq.Joint("weld", "fixed", "c", "d", xyz=(0, 0, 0.1)),
        ),
        masses=(eq.PointMass("payload", "d", 1.0, (0, 0.1, 0)),),
    )
    save_figure(every, tmp_path / "every.svg")
    shown = texts(tmp_path / "every.svg")
    assert "ball.x" in shown
    assert "force [N]" in shown
    save_figure(eq.Mechanism("empty"), tmp_path / "empty.svg")
    assert "empty" in texts(tmp_path / "empty.svg")


def test_planar_arms_are_seen_straight_on_and_poses_keep_their_ranges():
    limited = planar_arm([1, 1], [0.4, 0.3], [0.2, 0.1])
    limited = replace(limited, joints=tuple(replace(j, range=(0.2, 0.9)) for j in limited.joints))
    view, q = choose(limited, Skeleton.of(limited))
    assert view.planar
    assert np.abs(view.normal @ (0, 1, 0)) == pytest.approx(1)
    assert ((q >= 0.2) & (q <= 0.9)).all()
    assert not choose(robot("ur5"), Skeleton.of(robot("ur5")))[0].planar
    assert np.linalg.norm(q[0] - q[1]) > 0.1
    assert Tree.of(limited).n == 2


def test_a_zigzag_joins_its_ends():
    path = zigzag(np.array([0.0, 1.0]), np.array([3.0, 5.0]), 0.2)
    assert path[0] == pytest.approx((0, 1))
    assert path[-1] == pytest.approx((3, 5))
    across = (path - path[0]) @ np.array([-0.8, 0.6])
    assert np.abs(across).max() == pytest.approx(0.2)
    assert len(zigzag(np.zeros(2), np.zeros(2), 0.1)) == 2


@pytest.mark.parametrize(
    ("target", "message"),
    [
        ("arm.gif", ".svg, .png, .pdf"),
        ("arm", ".svg"),
        ("missing/arm.svg", "no such file or folder"),
        ("folder.svg", "folder"),
    ],
)
def test_bad_targets(tmp_path, target, message):
    (tmp_path / "folder.svg").mkdir()
    with pytest.raises(InputError, match=message):
        save_figure(arm(), tmp_path / target)
    assert [path.name for path in tmp_path.iterdir()] == ["folder.svg"]


def test_nothing_is_left_behind_when_writing_fails(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files.os, "replace", full)
    with pytest.raises(InputError, match="no space left"):
        save_figure(arm(), tmp_path / "arm.svg")
    assert not list(tmp_path.iterdir())

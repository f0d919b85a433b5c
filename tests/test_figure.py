"""The picture of a design: well-formed, the same every time, readable for any mechanism, nothing half-written."""

import struct
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest
from loop_zoo import four_bar
from robots import lee_chen, planar_arm, robot

import equipoise as eq
from equipoise.balance import check
from equipoise.io import files
from equipoise.kinematics import Tree, sample
from equipoise.model.coordinate import Coordinate
from equipoise.model.errors import InputError
from equipoise.report import figure, loads, style
from equipoise.report.arm import window, zigzag
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
    balance = eq.check(mechanism, max_terms=10_000)  # the human's Fourier form is long, and not what is tested here
    save_figure(mechanism, tmp_path / "robot.svg", balance=balance)
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


# The details ----------------------------------------------------------------------------------------------------------

PENDULUM = eq.Mechanism(
    "one-link arm",
    bodies=(eq.Body("arm", 2.0, (0.3, 0, 0)),),
    joints=(eq.Joint("shoulder", "revolute", "world", "arm", axis=(0, -1, 0)),),
    springs=(eq.Spring("spring", "world", (0, 0, 0.2), "arm", (0.15, 0, 0), 196.2),),
)


def pendulum(share: float) -> eq.Mechanism:
    """The pendulum with this share of the stiffness that balances it."""
    return PENDULUM.with_springs([replace(PENDULUM.springs[0], stiffness=share * 196.2)])


def chain(axes) -> eq.Mechanism:
    """Links of 0.3 m that turn about these axes."""
    names = ["world", *(f"link {i}" for i in range(len(axes)))]
    return eq.Mechanism(
        "chain",
        bodies=tuple(eq.Body(name, 1.0, (0.15, 0, 0)) for name in names[1:]),
        joints=tuple(
            eq.Joint(f"joint {i}", "revolute", names[i], names[i + 1], ((0.3 if i else 0.0), 0, 0), axis=axis)
            for i, axis in enumerate(axes)
        ),
    )


@pytest.mark.parametrize(
    ("share", "verdict", "logarithmic"),
    [(1, "EXACT", False), (0.9, "residual 10.0 % of", False), (1.001, "residual 0.100 % of", True)],
)
def test_a_small_residual_gets_a_logarithmic_axis_and_none_a_word(tmp_path, share, verdict, logarithmic):
    save_figure(pendulum(share), tmp_path / "arm.svg")
    shown = texts(tmp_path / "arm.svg")
    assert verdict in shown
    assert ("logarithmic" in shown) == logarithmic
    assert ("below 1e-9 N m" in shown) == (share == 1)


def test_the_given_balance_and_title_are_used(tmp_path, monkeypatch):
    balance = eq.check(PENDULUM)
    monkeypatch.setattr(figure, "check", None)
    save_figure(PENDULUM, tmp_path / "arm.svg", balance=balance, title="Figure 1 <&> $x$")
    assert "Figure 1 <&> $x$" in texts(tmp_path / "arm.svg")
    assert "one-link arm" not in texts(tmp_path / "arm.svg")


def test_of_many_coordinates_and_springs_the_first_are_shown(tmp_path):
    springs = [replace(SPRINGS[0], name=f"s{i}", body_b="link 3") for i in range(11)]
    many = chain([(0, 1, 0), (0, 0, 1)] * 7).with_springs(springs)
    balance = check(many, samples=50, max_terms=1)
    save_figure(many, tmp_path / "many.svg", balance=balance)
    shown = texts(tmp_path / "many.svg").splitlines()
    assert "and 4 more springs" in shown
    rows = loads.shown(balance)[Coordinate]
    assert len(rows) == loads.BARS_SHOWN
    assert [i for i in range(14) if f"joint {i}" in shown] == rows.tolist()
    hidden = np.setdiff1d(np.arange(14), rows)
    assert balance.unbalanced.max[hidden].max() <= balance.unbalanced.max[rows].min()


@pytest.mark.parametrize(
    "mechanism",
    [
        eq.Mechanism("welded", bodies=(eq.Body("a", 1.0),), joints=(eq.Joint("j", "fixed", "world", "a"),)),
        replace(PENDULUM, gravity=(0.0, 0.0, 0.0)),
        replace(PENDULUM, name="机器人 $\\frac{$"),
        PENDULUM.with_springs([replace(PENDULUM.springs[0], p_a=(0, 0, 0), p_b=(0, 0, 0))]),  # of no length
    ],
    ids=["nothing moves", "no gravity", "a name that no font has", "a spring of no length"],
)
def test_odd_mechanisms_are_drawn(tmp_path, mechanism):
    save_figure(mechanism, tmp_path / "odd.svg")
    assert texts(tmp_path / "odd.svg")


@pytest.mark.parametrize(
    ("mechanism", "planar"),
    [
        (PENDULUM, True),
        (chain([(0, 1, 0), (0, -2, 0)]), True),
        (chain([(0, 0, 1), (0, 1, 0)]), False),
        (chain([(0, 0, 1), (0, 0, 1)]), False),  # gravity is normal to the plane of motion
    ],
)
def test_the_view_shows_everything_and_is_a_rotation(mechanism, planar):
    skeleton = Skeleton.of(mechanism)
    view, q = choose(mechanism, skeleton)
    assert view.planar is planar
    axes = np.array([view.right, view.up, view.normal])
    assert axes @ axes.T == pytest.approx(np.eye(3))
    assert np.linalg.det(axes) == pytest.approx(1)
    placed = Tree.of(mechanism).poses(q)
    (left, right), (bottom, top) = window(skeleton, placed, view, aspect=1.5)
    assert (right - left) / (top - bottom) == pytest.approx(1.5)
    x, y = view.flat(skeleton.points(placed)).reshape(-1, 2).T
    assert left < x.min() < x.max() < right
    assert bottom < y.min() < y.max() < top


def test_bars_lead_from_joint_to_joint_to_the_payload():
    mechanism = chain([(0, 1, 0)] * 2).with_masses([eq.PointMass("p", "link 1", 1.0, (0.5, 0, 0))])
    placed = Tree.of(mechanism).poses(np.zeros((1, 2)))
    ends = [[end.at(placed)[0, 0] for end in (bar.a, bar.b)] for bar in Skeleton.of(mechanism).bars]
    assert np.array(ends) == pytest.approx(np.array([[0, 0.3], [0.3, 0.8]]))


def test_numbers_are_short():
    shown = [style.number(value) for value in (0.0, 59.34, 0.1738, 1401.4, 2e-5, 3e6)]
    assert shown == ["0", "59.3", "0.174", "1401", "2.0e-05", "3.0e+06"]


def test_bars_lead_to_the_ends_of_loops_and_meet_there():
    tree = Tree.of(four_bar())
    skeleton = Skeleton.of(four_bar())
    poses = tree.poses(sample(tree, 5))
    coupler, rocker = (bar for name in ("coupler", "rocker") for bar in skeleton.bars if bar.body == tree.index[name])
    assert np.abs(coupler.b.at(poses) - rocker.b.at(poses)).max() < 1e-12
    assert len(skeleton.joints) == 5  # the loop's two ends are one on the other
    assert np.isfinite(skeleton.points(poses)).all()


def test_a_bracket_starts_at_the_nearest_foot_even_where_zero_does_not_close():
    spring = eq.Spring("s", "world", (0.45, 0.0, 0.2), "rocker", (0.1, 0.0, 0.05), 100.0)
    skeleton = Skeleton.of(four_bar().with_springs((spring,)))
    ground, rocker = skeleton.brackets
    np.testing.assert_allclose(ground.a.p, (0.45, 0.0, 0.0))
    np.testing.assert_allclose(rocker.a.p, (0.1, 0.0, 0.0), atol=1e-12)

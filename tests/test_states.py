"""Motions, boxes and lists: the numbers of THEORY section 9, and the goal's number against MuJoCo along a motion."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from robots import planar_arm, robot

import equipoise as eq
from equipoise.energy import Potential
from equipoise.kinematics import Tree
from equipoise.kinematics.trajectory import course
from equipoise.model.errors import InputError
from equipoise.model.goal import Count, Goal, Loads, Tool
from equipoise.model.motion import Box, Listed, Motion, Where
from equipoise.simulate import play
from equipoise.synthesis.convex.least_squares_form import build
from equipoise.synthesis.convex.semidefinite import least_rms
from equipoise.synthesis.score import score

ARM = planar_arm([1, 2], [0.4, 0.3], [0.2, 0.1])
ARM = replace(ARM, bodies=tuple(replace(b, inertia=(0.01, 0.02, 0.02, 0, 0, 0)) for b in ARM.bodies))
SWING = Motion(("joint2", "joint3"), (0, 0.5, 1, 2), ((0, 0.3), (1, -0.4), (0.5, 1), (0, 0.3)))
PICK = np.array([0, -50, 80, -120, -90, 0.0])
UP, TURNED = np.array([0, -70, 75, -95, -90, 0.0]), np.array([90, 0, 0, 0, 0, 0.0])


def cycle() -> Motion:
    """The UR5's of THEORY section 9: minimum jerk from stop to stop, in eight seconds."""
    rows = np.radians([PICK, UP, UP + TURNED, PICK + TURNED, UP + TURNED, UP, PICK])
    time = 2 * np.cumsum([0, 0.5, 1, 0.5, 0.5, 1, 0.5])
    return Motion(robot("ur5").coordinates, tuple(time.tolist()), tuple(map(tuple, rows.tolist())), stops=True)


@pytest.mark.parametrize(("span", "workspace", "task"), [(1, 22.282, 3.1505), (3, 3.8073, 2.1235)])
def test_the_ur5_cycle(span, workspace, task):
    """The bound of the task, and what the best design for the workspace leaves there."""
    ur5, goal = robot("ur5"), Goal(poses=Where((cycle(),)))
    whole = eq.design(ur5, span=span, radius=0.15, springs=4)
    found = score(replace(whole.mechanism, goal=goal))
    assert found is not None
    assert found.value == pytest.approx(workspace, abs=1e-3)
    assert found.before == pytest.approx(37.923, abs=1e-3)
    reduced = build(eq.Problem.of(ur5, span=span, radius=0.15, goal=goal))
    assert least_rms(reduced.on(reduced.useful)).value * reduced.unbalanced == pytest.approx(task, abs=1e-3)


@pytest.mark.slow(reason="springs for a motion of a UR5")
def test_three_springs_for_the_ur5_cycle():
    ur5, goal = robot("ur5"), Goal(poses=Where((cycle(),)))
    near = eq.design(ur5, span=1, radius=0.15, springs=3, goal=goal)
    assert near.bound == pytest.approx(3.1505, abs=1e-3)
    assert near.residual <= 3.16
    apart = play(near.mechanism, *table(cycle(), ur5, 200)).apart
    assert apart is not None
    assert apart < 1e-6


def table(motion: Motion, mechanism: eq.Mechanism, count: int) -> tuple[np.ndarray, np.ndarray]:
    time = np.linspace(motion.time[0], motion.time[-1], count)
    return time, course(motion, Tree.of(mechanism), time).q


def test_over_a_motion_it_is_the_mean_of_mujocos_torques():
    goal = Goal(Loads((Tool("cup", "link3", (0, 1), (0.3, 0, 0)),)), Where((SWING,)))
    design = eq.solve(eq.Problem.of(ARM, span=1, radius=0.2, goal=goal), springs=2)
    assert design.bound is not None
    assert design.bound <= design.residual * (1 + 1e-9)
    squares = []
    for mass in (0.0, 1.0):
        cup = (eq.PointMass("cup", "link3", mass, (0.3, 0, 0)),) if mass else ()
        time, q = table(SWING, ARM, 4001)
        torque = play(design.mechanism.with_masses(cup), time, q).torque
        squares.append(np.trapezoid((torque**2).sum(axis=1), time) / 2.0)
    assert design.residual == pytest.approx(np.sqrt(np.mean(squares)), rel=1e-4)
    found = score(design.mechanism)
    assert found is not None
    assert (found.value, found.bound) == (pytest.approx(design.residual, rel=1e-9), design.bound)


def test_the_peak_of_two_motions_is_the_worst():
    slow = replace(SWING, time=tuple(3 * t for t in SWING.time), share=5.0)
    goal = Goal(poses=Where((SWING, slow)), count=Count("peak"))
    design = eq.solve(eq.Problem.of(ARM, span=1, radius=0.2, goal=goal), springs=2)
    most = [np.abs(play(design.mechanism, *table(motion, ARM, 2001)).torque).max() for motion in (SWING, slow)]
    assert design.residual == pytest.approx(max(most), rel=0.02)
    assert design.bound is not None
    assert design.bound <= design.residual


def test_a_list_of_poses_with_shares():
    goal = Goal(poses=Where(listed=Listed(("joint2",), ((0.5,), (1.0,)), (1.0, 3.0))))
    design = eq.solve(eq.Problem.of(ARM, span=1, radius=0.2, goal=goal), springs=1)
    squares = (Potential(design.mechanism)(np.array([[0.5, 0], [1.0, 0]])).torque ** 2).sum(axis=1)
    assert design.residual == pytest.approx(np.sqrt(np.average(squares, weights=[1, 3])), rel=1e-6, abs=1e-9)
    assert design.unbalanced == pytest.approx(
        np.sqrt(np.average((Potential(ARM)(np.array([[0.5, 0], [1.0, 0]])).torque ** 2).sum(axis=1), weights=[1, 3]))
    )


def test_a_box_of_a_point():
    box = Box("link3", (0.3, -0.1, -0.1), (0.6, 0.1, 0.4), (0.3, 0, 0))
    problem = eq.Problem.of(ARM, span=1, radius=0.2, goal=Goal(poses=Where(box=box, samples=150)))
    tree = Tree.of(ARM)
    at = tree.poses(problem.states.q).point(tree.index["link3"], np.array([0.3, 0, 0]))
    assert len(at) == 150
    assert ((at >= box.low) & (at <= box.high)).all()
    assert np.ptp(at[:, 0]) > 0.25
    far = Goal(poses=Where(box=replace(box, low=(2, 0, 0), high=(3, 1, 1)), samples=5))
    with pytest.raises(InputError, match=r"goal.poses.box: of 1,000 random poses inside the joint ranges 0 have"):
        eq.design(ARM, span=1, goal=far)


def test_refusals():
    limited = replace(ARM, joints=tuple(replace(j, range=(-0.5, 0.6)) for j in ARM.joints))
    with pytest.raises(InputError, match=r"goal\.poses\.motion: leaves the range of joint 'joint3'"):
        eq.design(limited, goal=Goal(poses=Where((replace(SWING, values=((0, 0), (0.1, 0.7), (0, 0), (0, 0))),))))
    with pytest.raises(InputError, match="exact: is about all poses, and the goal gives some"):
        eq.design(ARM, goal=Goal(poses=Where((SWING,))), exact=True)


def test_a_motion_on_the_command_line(run, tmp_path):
    arm, out, csv = tmp_path / "arm.yaml", tmp_path / "out.yaml", tmp_path / "swing.csv"
    eq.save(ARM, arm)
    time, q = table(SWING, ARM, 41)
    csv.write_text(
        "time,joint2 [rad],joint3\n"
        + "".join(f"{t:.17g},{a:.17g},{b:.17g}\n" for t, (a, b) in zip(time, q, strict=True))
    )
    code, text, _ = run("design", arm, "--span", 1, "--radius", "200mm", "--springs", 2, "--motion", csv, "-o", out)
    assert code == 0
    assert "over the motion, at 281 times" in text
    assert "no springs on these pairs and regions do better than" in run("check", out)[1]
    text = run("simulate", out, "--motion", csv, "--plot", tmp_path / "motion.svg")[1]
    assert "MuJoCo's inverse dynamics and the torques predicted here differ by at most" in text
    svg = (tmp_path / "motion.svg").read_text()
    assert all(word in svg for word in ("torque", "power", "energy"))
    assert json.loads(run("simulate", out, "--motion", csv, "--json")[1])["prediction_apart"] < 1e-6

"""The DELTA robot: its parts, the recognition of its legs, and its springs (Simionescu, Ciupitu and Ionita 2015)."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from equipoise.energy.certificate import fourier_form
from equipoise.energy.evaluate import Potential
from equipoise.kinematics import Tree, sample
from equipoise.model.errors import InputError, UnsupportedError
from equipoise.model.mechanism import Body, Joint, Mechanism
from equipoise.synthesis import design
from equipoise.synthesis.delta.legs import NotDelta, delta_legs
from equipoise.synthesis.delta.method import full, one_per_leg
from equipoise.synthesis.delta.robot import DeltaRobot
from equipoise.synthesis.delta.rocker import Guide

ODD = DeltaRobot(base=0.25, platform=0.1, upper=0.4, lower=0.7, rods=0.12, com_2=0.15, com_4=0.3)
"""Nothing is special: AB is not CD, the radii differ, mass centres are off the middle."""
WEIGHTS: dict[str, Any] = {"link_8": 0.3, "link_9": 0.2, "frame": 0.4, "link_2p": 0.35}
WEIGHTS |= {"spring_7": 1.8, "spring_10": 0.5, "spring_11": 0.6}


def unjudged(robot: Mechanism, **guide: Any) -> Mechanism:
    """The full balance with `WEIGHTS`, without the verdict, which takes most of the time."""
    own = {name: value for name, value in WEIGHTS.items() if name not in ("link_2p", "spring_7")}
    return full(robot, Guide(**own, **guide), 0.25, 0.3, WEIGHTS["spring_7"], 0.5, WEIGHTS["link_2p"])


def energies(mechanism: Mechanism, count: int = 1000) -> tuple[float, float]:
    """Variation of the total and of gravity's energy [J] over random reachable poses."""
    state = Potential(mechanism)(sample(Tree.of(mechanism), count))
    assert np.isfinite(state.energy).all()
    return float(np.ptp(state.energy)), float(np.ptp(state.gravity))


@pytest.mark.parametrize("robot", [DeltaRobot(), ODD], ids=["example", "odd"])
def test_the_closed_form_of_the_inverse_kinematics_agrees_with_the_loops(robot):
    mechanism = robot.mechanism()
    legs, platform = delta_legs(mechanism)
    tree = Tree.of(mechanism)
    assert tree.coordinates == ("A 1", "A 2", "A 3")
    P = np.random.default_rng(0).uniform([-0.1, -0.1, -0.75], [0.1, 0.1, -0.5], (300, 3))
    poses = tree.poses(np.column_stack([leg.actuator(P) for leg in legs]))
    body = tree.index[platform]
    assert np.abs(poses.p[:, body] - P).max() < 1e-12
    assert np.abs(poses.R[:, body] - np.eye(3)).max() < 1e-12  # it does not turn


def test_full_balance_is_proved_with_arbitrary_data():
    found = design(ODD.mechanism(), "delta", BF=0.12, CS=0.1, **WEIGHTS)
    assert len(found.mechanism.springs) == 9
    total, gravity = energies(found.mechanism)
    assert total < 1e-9 * gravity
    assert found.balance.exact
    assert found.balance.certificate.kind == "fourier"
    assert found.balance.residual.max.max() < 1e-10 * found.balance.unbalanced.max.max()


def test_the_printed_stiffness_is_exact_only_if_BF_is_2_CS():
    robot = ODD.mechanism()
    total, gravity = energies(unjudged(robot, BF=0.12, CS=0.1, equation_10="mended"))
    assert total > 0.05 * gravity
    total, gravity = energies(unjudged(robot, BF=0.2, CS=0.1, equation_10="mended"))
    assert total < 1e-9 * gravity


def test_a_soft_spring_is_seen():
    found = unjudged(ODD.mechanism())
    soft = [replace(s, stiffness=0.99 * s.stiffness) if s.name == "spring 7 2" else s for s in found.springs]
    total, gravity = energies(found.with_springs(soft))
    assert total > 1e-4 * gravity


def test_legs_are_found_whatever_the_names_the_frames_and_the_order():
    robot = ODD.mechanism()
    new = {body.name: f"part {i}" for i, body in enumerate(robot.bodies)} | {"world": "world"}
    turned = {joint.name: f"j{i}" for i, joint in enumerate(robot.joints)}
    flipped = [
        replace(j, name=turned[j.name], parent=new[j.parent], child=new[j.child],
                axis=tuple(-a for a in j.axis), range=None if j.range is None else (-j.range[1], -j.range[0]))
        for j in robot.joints
    ]  # fmt: skip
    other = replace(
        robot,
        bodies=tuple(replace(body, name=new[body.name]) for body in robot.bodies),
        joints=tuple(flipped),
        loops=tuple(replace(loop, body_a=new[loop.body_a], body_b=new[loop.body_b]) for loop in robot.loops),
        assembly=tuple((turned[name], -value) for name, value in robot.assembly),
    )
    found = design(other, "delta", **WEIGHTS)
    assert found.balance.exact
    one, two = ([s.stiffness for s in m.springs] for m in (found.mechanism, unjudged(robot)))
    assert one == pytest.approx(two)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda m: replace(m, loops=(), assembly=()), "no loops"),
        (lambda m: replace(m, gravity=(0.0, 0.0, 0.0)), "no gravity"),
        (lambda m: replace(m, gravity=(0.0, -4.0, -9.0)), "not horizontal"),
        (lambda m: heavy(m, "link 5.1", (0.02, 0.0, 0.0)), "link 5 'link 5.1' is not in line"),
        (lambda m: heavy(m, "rod 4.3", (0.05, 0.0, -0.3)), "a rod of 'link 2.3' is not in the plane"),
    ],
)
def test_what_it_does_not_cover_is_refused_with_the_reason(change, reason):
    changed = change(ODD.mechanism())
    with pytest.raises(NotDelta, match=reason):
        delta_legs(changed)
    with pytest.raises(UnsupportedError, match=reason):
        design(changed, "delta")


def heavy(mechanism: Mechanism, name: str, com: tuple[float, float, float]) -> Mechanism:
    """The mass centre of one body moved."""
    bodies = tuple(replace(body, com=com) if body.name == name else body for body in mechanism.bodies)
    return replace(mechanism, bodies=bodies)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"BF": 0.0}, "BF: must be more than 0 m"),
        ({"AV": -0.1}, "AV: must be more than 0 m"),
        ({"share_10": 1.5}, "share_10: must be between 0 and 1"),
        ({"frame": -1.0}, "frame: must be at least 0 kg"),
        ({"m3Q": -1.0}, "m3Q: must be at least 0 kg"),
        ({"equation_10": "printed"}, "equation_10: there is no 'printed'"),
        ({"variant": "rocker"}, "is no two-axis rocker"),
        ({"variant": "half"}, "there is no 'half'"),
        ({"variant": "axis", "BF": 0.1}, "variant 'axis' has no such option"),
        ({"variant": "axis", "heights": [0.8, 0.5]}, "the smaller first"),
        ({"variant": "axis", "heights": [0.5, 0.8], "reach": 2.0}, "does not reach all of the workspace"),
        ({"span": 2}, "method 'delta' has no such option"),
    ],
)
def test_bad_options(options, message):
    with pytest.raises(InputError, match=message):
        design(ODD.mechanism(), "delta", **options)


def test_a_bar_that_hangs_on_link_3_or_is_fixed_to_it_is_balanced():
    """m3Q of the paper at Q; and a mass centre of link 3 off its axis, with a spring of Eq. (3) for each leg."""
    hanging = unjudged(ODD.mechanism(), m3Q=0.15)
    fixed = unjudged(heavy(ODD.mechanism(), "link 3.2", (0.01, 0.0, 0.05)), m3Q=0.15)
    assert len(hanging.springs) == 9
    assert [s.name for s in fixed.springs if s.name.startswith("spring 3")] == ["spring 3 2"]
    for m in (hanging, fixed):
        series, _ = fourier_form(m)
        assert series is not None
        assert series.exact


def two_axes(**change: Any) -> Mechanism:
    """A rocker about two axes of which nothing is special."""
    joints = (
        Joint(
            "B", "revolute", "world", "link 3", (0.1, 0.2, 0.3), (0, 0, 0.7), axis=(0, 1, 0), range=change.get("range")
        ),
        Joint("C", "revolute", "link 3", "link 4", (0.04, 0.1, 0.0), axis=(1, 0, 0)),
    )
    return Mechanism(
        "two axes", (Body("link 3", 0.4, (0.02, 0.01, 0.05)), Body("link 4", 1.2, (0.03, -0.1, -0.2))), joints
    )


@pytest.mark.parametrize("limits", [None, (2.5, 3.5)])
def test_a_two_axis_rocker_by_itself(limits):
    found = design(two_axes(range=limits), "delta", BF=0.12, CS=0.07, m3Q=0.1, spring_10=0.5, spring_11=0.4, link_8=0.3)
    assert found.free_parameters["variant"] == "rocker"
    assert [s.name for s in found.mechanism.springs] == ["spring 10", "spring 11", "spring 3"]
    assert found.balance.exact
    mended = design(two_axes(), "delta", equation_10="mended", BF=0.12, CS=0.07)
    assert not mended.balance.exact
    assert design(two_axes(), "delta", equation_10="mended", BF=0.14, CS=0.07).balance.exact


def test_one_spring_per_leg_is_exact_on_the_axis_of_the_example():
    found = design(DeltaRobot().mechanism(), "delta", variant="axis", spring_7=1.8, heights=[0.4, 0.9], reach=0.0)
    assert found.free_parameters["stiffness"] == pytest.approx(566.7, abs=0.05)
    assert found.free_parameters["residual_peak"] < 1e-9


def test_the_optimum_over_a_workspace_beats_the_formula():
    options = {"spring_7": 1.8, "heights": [0.5, 0.8], "reach": 0.1, "samples": 500}
    found = one_per_leg(DeltaRobot().mechanism(), "peak", **options)[1].numbers
    assert found["residual_peak"] < 0.85 * found["axis_formula_peak"]
    assert found["times_better"] == pytest.approx(found["axis_formula_peak"] / found["residual_peak"])
    rms = one_per_leg(DeltaRobot().mechanism(), "rms", **options)[1].numbers
    assert found["residual_peak"] < rms["residual_peak"]


@pytest.mark.parametrize("objective", ["rms", "peak"])
def test_convex_is_at_least_as_good_as_the_papers_springs(objective):
    """Over the joint ranges, with the pairs of the paper's three springs, and never below its bound."""
    robot = DeltaRobot(range=(-0.3, 1.2)).mechanism()
    pairs = [("world", f"link 2.{i}") for i in (1, 2, 3)]
    found = design(robot, "convex", pairs=pairs, radius=0.45, springs=3, samples=200, objective=objective)
    u = sample(Tree.of(robot), 200)
    paper, own, bare = (Potential(m)(u).torque for m in (paper_springs(robot), found.mechanism, robot))
    measure = {"rms": lambda t: np.sqrt((t**2).sum(axis=1).mean()), "peak": lambda t: np.abs(t).max()}[objective]
    assert measure(own) == pytest.approx(found.residual, rel=1e-6)
    assert measure(bare) == pytest.approx(found.unbalanced, rel=1e-6)
    assert found.bound is not None
    assert 0 < found.bound <= found.residual < 0.8 * measure(paper)
    assert found.residual < 1.01 * found.bound


def paper_springs(robot: Mechanism) -> Mechanism:
    """The robot with the paper's one spring per leg (Eqs. 14-15), not judged."""
    return one_per_leg(robot, "axis", heights=[0.5, 0.8], samples=10)[1].mechanism

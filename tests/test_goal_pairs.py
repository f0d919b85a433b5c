"""Every goal alone and every two together on three arms: the bound is below the design, whose number is MuJoCo's."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
import pytest
from campaign import campaign
from robots import planar_arm
from test_score import WALL, alternatives, leaning, torques

import equipoise as eq
from equipoise.model.errors import InputError
from equipoise.model.goal import Cost, Count, Goal, Gravity, Loads, Tool
from equipoise.model.motion import Box, Listed, Motion, Where
from equipoise.synthesis.convex.peak import peak_states
from equipoise.synthesis.problem import Problem
from equipoise.synthesis.score import score

SAMPLES = 20
EFFORTS, FRICTION = np.array([20.0, 4.0]), np.array([0.5, 0.2])


def arm(*sizes: Any) -> eq.Mechanism:
    made = planar_arm(*sizes)
    joints = tuple(
        replace(j, effort=e, friction=f, torque_constant=2.0, resistance=0.5)
        for j, e, f in zip(made.joints, EFFORTS.tolist(), FRICTION.tolist(), strict=True)
    )
    bodies = tuple(replace(b, inertia=(0.01, 0.02, 0.02, 0, 0, 0)) for b in made.bodies)
    return replace(made, joints=joints, bodies=bodies, workspace=eq.Workspace(SAMPLES))


ARMS = (
    arm([1, 2], [0.4, 0.3], [0.2, 0.1]),
    arm([2, 1], [0.3, 0.5], [0.1, 0.3]),
    arm([1.5, 1], [0.2, 0.2], [0.15, 0.05]),
)
CUP, PLATE = Tool("cup", "link3", (0.8, 0.8)), Tool("plate", "link3", (0.3, 0.3), (0.2, 0, 0.1), 3.0)
GOALS: dict[str, dict[str, dict[str, Any]]] = {
    "payload": {"loads": {"tools": (Tool("cup", "link3", (0, 0.8), (0.3, 0, 0)),)}},
    "tools": {"loads": {"tools": (CUP, PLATE)}},
    "gravity": {"loads": {"gravity": (Gravity((0, 0, -9.81)), WALL)}},
    "tilt": {"loads": {"tilt": 0.2}},
    "list": {"poses": {"listed": Listed(("joint2", "joint3"), ((0.5, 0), (1.0, 1.0), (2.0, -1)), (1, 3, 2))}},
    "box": {"poses": {"box": Box("link3", (-0.5, -1, 0), (0.5, 1, 0.6), (0.1, 0, 0)), "samples": SAMPLES}},
    "motion": {"poses": {"motions": (Motion(("joint2", "joint3"), (0, 1, 2), ((0, 0.5), (1, 0), (0, 0.5))),)}},
    "peak": {"count": {"torque": "peak"}},
    "weights": {"count": {"joints": {"joint3": 2.0}}},
    "effort": {"count": {"share_of": "effort"}},
    "heat": {"count": {"heat": True}},
    "friction": {"count": {"torque": "peak", "friction": True}},
    "stiffness": {"cost": {"stiffness": 300.0}},
    "energy": {"cost": {"energy": 8.0}},
}
PAIRS = list(combinations_with_replacement(GOALS, 2))
AGAINST = [{"effort", "heat"}, {"friction", "motion"}, {"list", "box"}, {"list", "motion"}, {"box", "motion"}]


def together(one: str, other: str) -> Goal:
    parts: dict[str, dict[str, Any]] = {"loads": {}, "poses": {}, "count": {}, "cost": {}}
    for name in (one, other):
        for part, values in GOALS[name].items():
            parts[part] |= values
    return Goal(Loads(**parts["loads"]), Where(**parts["poses"]), Count(**parts["count"]), Cost(**parts["cost"]))


STRIDE = 41  # with nothing in common with their number: a few cases in a row are of all kinds


@pytest.mark.slow(reason="designs for goals of all kinds")
@campaign(3 * len(PAIRS))
def test_two_goals_together(seeds):
    for number in seeds:
        seed = STRIDE * number % (3 * len(PAIRS))
        pair = PAIRS[seed % len(PAIRS)]
        if set(pair) in AGAINST:
            with pytest.raises(InputError):
                eq.design(ARMS[0], radius=0.2, goal=together(*pair))
            continue
        judge(ARMS[seed // len(PAIRS)], together(*pair))


def judge(mechanism: eq.Mechanism, goal: Goal) -> None:
    problem = Problem.of(mechanism, span=1, radius=0.2, goal=goal)
    design = eq.solve(problem, springs=1)
    assert design.bound is not None
    assert design.bound <= design.residual * (1 + 1e-9)
    found = score(design.mechanism)
    assert (found is None) == (not goal)
    if found is None or goal.poses.motions:  # motions meet MuJoCo in test_states
        return
    assert found.value == pytest.approx(design.residual, rel=1e-9)
    scale = np.array([1.0, goal.count.joints.get("joint3", 1.0)])
    scale = scale / EFFORTS if goal.count.share_of else scale * np.sqrt(0.5) / 2.0 if goal.count.heat else scale
    peak = goal.count.torque == "peak"
    turn = 2 * np.pi * np.arange(8) / 8
    q, weight = np.stack(np.meshgrid(turn, turn), axis=-1).reshape(-1, 2), np.full(64, 1 / 64)
    if peak or goal.poses.chosen:
        states = peak_states(problem) if peak else problem.states
        q, weight = states.q, states.share
    spared = FRICTION if goal.count.friction else 0.0
    shares, most, squares = [], [], []
    for share, hung, gravity in alternatives(goal):
        tilt = goal.loads.tilt
        gravities = leaning(gravity, tilt) if tilt else np.array([gravity.vector])
        size = torques(design.mechanism, hung, gravities, q)
        shares.append(share)
        most.append(((np.abs(size) - spared) * scale).max())
        squares.append(weight @ ((size * scale) ** 2).sum(axis=-1).mean(axis=0))
    if not peak:
        assert found.value == pytest.approx(np.sqrt(np.average(squares, weights=shares)), rel=2e-3, abs=1e-6)
    elif goal.loads.tilt:
        assert 0.95 * found.value <= max(0.0, *most) <= found.value * (1 + 1e-6)
    else:
        assert found.value == pytest.approx(max(0.0, *most), rel=1e-6)

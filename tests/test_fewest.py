"""The fewest springs: sections against gravity itself, and against every design that is known to be exact."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from exact_mechanisms import exact_mechanism
from random_mechanisms import random_chain
from robots import planar_arm, robot
from scipy.optimize import least_squares
from zoo import EXACT, counterweight, geared_pair, hinge, pendulum

import equipoise as eq
from equipoise.energy import FourierEnergy, Potential, SpanEnergy
from equipoise.kinematics import Tree
from equipoise.model.elements import Spring
from equipoise.model.mechanism import Body, Mechanism
from equipoise.synthesis.design import FrontRow
from equipoise.synthesis.fewest import Fewest, fewest


def springs(m: Mechanism) -> int:
    found = fewest(m)
    return 0 if found is None else found.springs


@pytest.mark.parametrize(("name", "least"), [("ur5", 3), ("ur10", 3), ("panda", 3), ("xarm7", 3)])
def test_real_arms(name: str, least: int) -> None:
    assert springs(robot(name)) == least


def test_known_arms() -> None:
    for n in range(1, 6):
        arm = planar_arm([1.0] * n, [0.3] * n, [0.1] * n)
        assert springs(arm) == n
        assert springs(random_chain(n, n, ("spherical",))) == n
    assert springs(counterweight().mechanism.with_springs(())) == 0
    assert fewest(geared_pair(2.0)) is None
    assert fewest(replace(pendulum(), gravity=(0.0, 9.81, 0.0))) is None  # along the axis


@pytest.mark.parametrize("name", EXACT)
def test_no_exact_mechanism_has_fewer(name: str) -> None:
    m = EXACT[name]().mechanism
    assert springs(m) <= len(m.springs)


def test_no_random_exact_mechanism_has_fewer() -> None:
    """With counterweights nothing is left to a spring; those that lift are needed."""
    for seed in range(80):
        m = exact_mechanism(seed)
        assert springs(m) <= sum(spring.name.startswith("lift") for spring in m.springs)


@pytest.mark.parametrize("seed", range(12))
def test_a_section_is_a_planar_arm_and_gravity_loads_each_link(seed: int) -> None:
    """Held as it says, the energy of gravity is a constant and one sine of each link's absolute angle, none zero."""
    m = random_chain(seed, 3, ("revolute",)) if seed % 2 else replace(robot("ur5" if seed % 4 else "panda"))
    found = fewest(m)
    assert found is not None
    tree, q = Tree.of(m), np.zeros((200, len(m.coordinates)))
    for name, value in found.held:
        q[:, tree.coordinates.index(name)] = value
    columns = [tree.coordinates.index(name) for name in found.joints]
    q[:, columns] = np.random.default_rng(seed).uniform(-np.pi, np.pi, (200, len(columns)))
    poses = tree.poses(q)
    axes = tree.axes(q, poses)[:, [tree.rows[name] for name in found.joints]]
    assert np.abs(np.cross(axes, axes[:1, :1])).max() < 1e-9
    signs = np.sign(np.einsum("nji,i->nj", axes, axes[0, 0]))
    angle = np.cumsum(q[:, columns] * signs, axis=1)
    A = np.hstack([np.ones((200, 1)), np.cos(angle), np.sin(angle)])
    energy = Potential(m.with_springs(()))(q).gravity
    x = np.linalg.lstsq(A, energy, rcond=None)[0]
    assert np.abs(A @ x - energy).max() < 1e-10 * np.ptp(energy)
    assert (np.hypot(*x[1:].reshape(2, -1)) > 1e-6 * np.ptp(energy)).all()


def test_trying_to_beat_it() -> None:
    """One spring on a two-link arm, anywhere within 5 m, of any stiffness, from many starts: never exact. Two are."""
    arm = planar_arm([1.0, 1.0], [0.3, 0.3], [0.15, 0.15])
    names = arm.body_names

    def spread(x: np.ndarray, pairs: tuple[tuple[str, str], ...]) -> np.ndarray:
        each = x.reshape(len(pairs), 5)
        found = [
            Spring(f"s{i}", a, (u[0], 0.0, u[1]), b, (u[2], 0.0, u[3]), float(np.exp(u[4])))
            for i, ((a, b), u) in enumerate(zip(pairs, each, strict=True))
        ]
        series = FourierEnergy(arm.with_springs(found))
        return np.concatenate([series.c[series.varies].real, series.c[series.varies].imag])

    rng = np.random.default_rng(0)
    pairs = tuple(pairwise(names)), ((names[0], names[2]),)

    def best(chosen: tuple[tuple[str, str], ...], starts: int) -> float:
        bounds = np.tile([5.0, 5.0, 5.0, 5.0, 12.0], len(chosen))
        return min(
            np.abs(least_squares(spread, rng.uniform(-1, 1, len(bounds)) * bounds / 5, args=(chosen,),
                                 bounds=(-bounds, bounds)).fun).max()
            for _ in range(starts)
        )  # fmt: skip

    size = SpanEnergy(arm).scale
    assert springs(arm) == 2
    for pair in (*pairs[0], *pairs[1]):
        assert best((pair,), 2) > 1e-4 * size
    assert best(((names[0], names[2]), (names[1], names[2])), 6) < 1e-9 * size


def test_what_a_design_says() -> None:
    arm = planar_arm([1.0, 1.0], [0.3, 0.3], [0.15, 0.15])
    design = eq.design(arm, span=2, springs=1, radius=0.15, front=True)
    assert design.fewest is not None
    assert design.fewest.springs == 2
    told = design.to_dict()
    assert told["fewest"]["joints"] == list(arm.coordinates)
    assert [row["status"] for row in told["front"]] in (["optimal"], ["cannot be exact"])
    row = FrontRow(1, 1.0, 0.5, (), False)
    assert design.status(row) == "cannot be exact"
    assert design.status(replace(row, springs=2)) == "open"
    assert design.status(replace(row, springs=3, bound=1.0)) == "optimal"
    assert design.status(replace(row, springs=3, exact=True)) == "optimal"


def test_words() -> None:
    joints = "shoulder_lift_joint, elbow_joint and wrist_1_joint"
    assert str(fewest(robot("ur5"))) == (
        f"fewer cannot be exact: {joints} are a planar arm of three links that gravity loads"
    )
    skew = planar_arm([1.0] * 3, [0.3] * 3, [0.1] * 3)
    twisted = replace(skew.joints[1], axis=(1.0, 0.0, 0.0))
    held = fewest(replace(skew, joints=(skew.joints[0], twisted, skew.joints[2])))
    assert isinstance(held, Fewest)
    assert f"with {twisted.name} at" in str(held)
    tree = Mechanism(
        "tree",
        tuple(Body(name, 1.0, (0.2, 0.0, 0.0)) for name in "abc"),
        (hinge("a", "world", "a"), hinge("b", "a", "b", 0.3), hinge("c", "a", "c", 0.2)),
    )
    assert "a planar tree of three links" in str(fewest(tree))

"""Closed loops: poses that close, derivatives against differences, mobility, branches, and what cannot be reached."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from loop_zoo import (
    BASE,
    LOOPED,
    LOWER,
    PLATFORM,
    STEWART_FEET,
    STEWART_HEADS,
    UPPER,
    delta_inverse,
    four_bar,
    gough_stewart,
    spatial_parallelogram,
)  # fmt: skip
from scipy.spatial.transform import Rotation

from equipoise.balance import check
from equipoise.energy.evaluate import Potential
from equipoise.kinematics import Tree, sample
from equipoise.kinematics.branch import Branch, Status
from equipoise.kinematics.linkage import Linkage
from equipoise.model.errors import InputError
from equipoise.model.mechanism import Loop, Mechanism

STEP = 1e-6  # [rad or m] of central differences


@cache
def linkage(name: str) -> Linkage:
    """A mechanism of the zoo, compiled once."""
    found = Tree.of(LOOPED[name]())
    assert isinstance(found, Linkage)
    return found


def gaps(tree: Linkage, q: np.ndarray) -> np.ndarray:
    """(N, loops) distance of the two points and of the two axes, from the poses and the definition of a loop."""
    poses, found = tree.open.poses(q), []
    for loop in tree.mechanism.loops:
        a, b = tree.index[loop.body_a], tree.index[loop.body_b]
        gap = np.linalg.norm(poses.point(a, np.array(loop.p_a)) - poses.point(b, np.array(loop.p_b)), axis=1)
        if loop.axis_a is not None and loop.axis_b is not None:
            u, v = (np.array(axis) / np.linalg.norm(axis) for axis in (loop.axis_a, loop.axis_b))
            gap = np.hypot(gap, np.linalg.norm(poses.R[:, a] @ u - poses.R[:, b] @ v, axis=1))
        found.append(gap)
    return np.stack(found, axis=1)


@pytest.mark.parametrize("name", LOOPED)
def test_sampled_poses_close_inside_the_ranges(name):
    tree = linkage(name)
    u = sample(tree, 50)
    q, status = tree.branch.solve(u)
    assert (status == Status.CLOSED).all()
    assert gaps(tree, q).max() < 1e-12
    assert np.array_equal(q[:, tree.branch.split.independent], u)
    s = tree.values(u)
    assert ((s >= tree.lower - 1e-9) & (s <= tree.upper + 1e-9)).all()


@pytest.mark.parametrize("name", LOOPED)
def test_jacobian_of_the_loops(name):
    """At poses that do not close, so that nothing cancels."""
    tree = linkage(name)
    closure, rng = tree.branch.closure, np.random.default_rng(0)
    q = sample(tree, 8)
    full = tree.branch.solve(q)[0]
    full = full + rng.uniform(-0.2, 0.2, full.shape)
    J = closure.at(full)[1]
    for j in range(tree.open.n):
        step = STEP * np.eye(tree.open.n)[j] * closure.scale
        difference = (closure.at(full + step)[0] - closure.at(full - step)[0]) / (2 * STEP)
        np.testing.assert_allclose(J[:, :, j], difference, atol=2e-8)


@pytest.mark.parametrize("name", LOOPED)
def test_velocities_along_closed_motions(name):
    """Body velocities, which rest on dq/du, against differences of closed poses."""
    tree = linkage(name)
    u = sample(tree, 8)
    poses = tree.poses(u)
    velocities = tree.velocities(u, poses)
    for j in range(tree.n):
        ahead, behind = (tree.poses(u + sign * STEP * np.eye(tree.n)[j]) for sign in (1, -1))
        v = (ahead.p - behind.p) / (2 * STEP)
        turning = (ahead.R - behind.R) @ np.swapaxes(poses.R, 2, 3) / (2 * STEP)
        w = np.stack([turning[..., 2, 1], turning[..., 0, 2], turning[..., 1, 0]], axis=-1)
        size = max(1.0, float(np.abs(velocities.v).max()), float(np.abs(velocities.w).max()))
        np.testing.assert_allclose(velocities.v[..., j], v, atol=1e-7 * size)
        np.testing.assert_allclose(velocities.w[..., j], w, atol=1e-7 * size)


@pytest.mark.parametrize("name", LOOPED)
def test_torque_is_the_derivative_of_the_energy_along_closed_motions(name):
    tree = linkage(name)
    mechanism = tree.mechanism
    potential = Potential(mechanism.with_springs(mechanism.springs[:1]))  # not balanced
    u = sample(tree, 8)
    state = potential(u)
    largest = float(np.abs(state.gravity_torque).max()) + float(np.abs(state.spring_torque).max())
    for j in range(tree.n):
        step = STEP * np.eye(tree.n)[j]
        difference = (potential(u + step).energy - potential(u - step).energy) / (2 * STEP)
        np.testing.assert_allclose(state.torque[:, j], difference, atol=1e-6 * max(largest, 1.0))


@pytest.mark.parametrize(
    ("name", "gruebler", "numerical"),
    [
        ("four-bar", -2, 1),  # 3 - 5
        ("slider-crank", 0, 1),  # 3 - 3
        ("parallelogram", -2, 1),
        ("rod leg", 0, 3),  # 9 - 9: hip, crank and the spin of the rod
        ("RSSR", 4, 4),  # 10 - 6: two active, two idle
        ("DELTA", -9, 3),  # 16 - 25
        ("Gough-Stewart", 6, 6),  # 21 - 15
        ("hexapod", 6, 6),
    ],
)
def test_mobility(name, gruebler, numerical):
    found = linkage(name).mobility
    assert (found.gruebler, found.numerical, found.redundant) == (gruebler, numerical, numerical - gruebler)
    assert len(linkage(name).coordinates) == numerical


def test_idle_freedoms_turn_nothing_but_the_couplers():
    """lin2010, Eqs. (19)-(20): as many idle freedoms as modules, each the spin of a pseudobase about CD."""
    tree = linkage("RSSR")
    idle = [j for j, name in enumerate(tree.coordinates) if name.startswith("link")]
    assert [tree.coordinates[j] for j in idle] == ["link 1 pseudobase.z", "link 2 pseudobase.z"]
    u = sample(tree, 30)
    v = tree.velocities(u, tree.poses(u))
    moved = {tree.names[b] for j in idle for b in np.flatnonzero(np.abs(v.w[..., j]).max(axis=(0, 2)) > 1e-9)}
    assert moved == {"link 1 pseudobase", "link 2 pseudobase"}
    assert np.abs(v.v[..., idle]).max() < 1e-9
    assert np.abs(Potential(tree.mechanism)(u).torque[:, idle]).max() < 1e-10


def test_branch_is_kept_along_a_closed_path():
    """Once round with the crank, in small steps and in one: the same poses, and none jumps."""
    tree = Tree.of(four_bar())
    assert isinstance(tree, Linkage)
    u = np.linspace(-pi, pi, 721)[:, None]
    q, status = tree.branch.solve(u)
    assert (status == Status.CLOSED).all()
    rocker = q[:, tree.open.coordinates.index("rocker")]
    assert np.abs(np.diff(rocker)).max() < 0.05
    assert abs(rocker[0] - rocker[-1]) < 1e-9
    other = replace(four_bar(), assembly=(("coupler", -0.5), ("rocker", -1.8)))
    mirrored = Tree.of(other)
    assert isinstance(mirrored, Linkage)
    apart = mirrored.branch.solve(u)[0][:, tree.open.coordinates.index("rocker")] - rocker
    assert np.abs((apart + pi) % (2 * pi) - pi).min() > 0.1  # the other branch is never met


def four_bar_angles(a: float, b: float, c: float, d: float, theta: np.ndarray, side: float) -> np.ndarray:
    """Rocker angle of a four-bar in closed form, NaN where it does not close; `side` is that of the line to A."""
    A = a * np.exp(1j * theta)
    reach = A - d
    r = np.abs(reach)
    with np.errstate(invalid="ignore"):
        inside = np.arccos((c**2 + r**2 - b**2) / (2 * c * r))
    return np.angle(reach) + side * inside


lengths = st.floats(0.15, 1.0)


@settings(max_examples=20, deadline=None, derandomize=True)
@given(lengths, lengths, lengths, lengths, st.integers(0, 2**31))
def test_random_four_bars(a, b, c, d, seed):
    """Every pose that closes agrees with the closed form of its branch; where the crank turns round, all close."""
    # at a change point all bars fall into one line, where its two ways of assembly meet
    assume(min(abs(a + b - c - d), abs(a + c - b - d), abs(a + d - b - c)) > 0.02)
    side = -1.0
    start = np.random.default_rng(seed).uniform(-pi, pi, 100)
    rocker = four_bar_angles(a, b, c, d, start, side)
    r = np.abs(a * np.exp(1j * start) - d)
    transmission = np.abs((b**2 + c**2 - r**2) / (2 * b * c))  # 1 where the linkage is singular
    good = np.flatnonzero(transmission < 0.9)
    if not len(good):
        return
    first = good[0]
    pin = a * np.exp(1j * start[first])
    end = d + c * np.exp(1j * rocker[first])
    coupler = float(np.angle(end - pin) - start[first])
    assembly = (("crank", float(start[first])), ("coupler", coupler), ("rocker", float(rocker[first])))
    tree = Tree.of(replace(four_bar(a, b, c, d), assembly=assembly, independent=("crank",)))
    assert isinstance(tree, Linkage)
    q, status = tree.branch.solve(start[:, None])
    found = q[:, tree.open.coordinates.index("rocker")]
    closed = status == Status.CLOSED
    assert closed[first]
    wrong = found[closed] - rocker[closed]
    assert np.abs((wrong + pi) % (2 * pi) - pi).max() < 1e-7
    assert np.isnan(q[~closed]).all()
    assert not closed[np.isnan(rocker)].any()
    least = min(abs(abs(a - d) - abs(b - c)), abs((b + c) - (a + d)))
    if abs(b - c) < abs(a - d) and a + d < b + c and least > 0.02:  # it closes at every angle of the crank
        assert closed.all()


def test_delta_against_the_analytic_inverse_kinematics():
    tree = linkage("DELTA")
    places, angles = reachable(500)
    poses = tree.poses(angles)
    body = tree.index["platform"]
    assert np.abs(poses.p[:, body] - places).max() < 1e-12
    assert np.abs(poses.R[:, body] - np.eye(3)).max() < 1e-12
    assert gaps(tree, poses.q).max() < 1e-12


def reachable(count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Random places of the DELTA's platform and the angles of A there: inside the ranges, and on the assembled side of
    the singular poses, where the three pairs of rods are in one plane (1 % of their largest volume off)."""
    rng = np.random.default_rng(seed)
    tree = linkage("DELTA")
    low, high = tree.lower[tree.coordinate_rows], tree.upper[tree.coordinate_rows]
    found: list[tuple[np.ndarray, np.ndarray]] = []
    while sum(len(p) for p, _ in found) < count:
        p = rng.uniform([-0.5, -0.5, -0.95], [0.5, 0.5, -0.2], (2 * count, 3))
        t = delta_inverse(p)
        real = np.isfinite(t).all(axis=1)
        p, t = p[real], t[real]
        ok = ((t >= low) & (t <= high)).all(axis=1) & (volume(p, t) > 0.01)
        found.append((p[ok], t[ok]))
    places, angles = (np.concatenate(x)[:count] for x in zip(*found, strict=True))
    return places, angles


def volume(p: np.ndarray, t: np.ndarray) -> np.ndarray:
    """(N,) of the unit vectors along the three legs' rods, positive where the platform hangs."""
    rods = []
    for i in range(3):
        out = np.array([np.cos(2 * pi * i / 3), np.sin(2 * pi * i / 3), 0.0])
        knee = (BASE - PLATFORM + UPPER * np.cos(t[:, i, None])) * out + UPPER * np.sin(t[:, i, None]) * [0, 0, 1]
        rods.append((p - knee) / LOWER)
    return -np.linalg.det(np.stack(rods, axis=1))


@pytest.mark.parametrize(
    "count", [2000, pytest.param(100_000, marks=pytest.mark.slow(reason="100,000 poses with loops"))]
)
def test_every_reachable_delta_pose_closes(count):
    tree = linkage("DELTA")
    places, angles = reachable(count, seed=1)
    q, status = tree.branch.solve(angles)
    assert (status == Status.CLOSED).all()
    worst = misplaced = 0.0
    for i in range(0, count, 5000):
        part = q[i : i + 5000]
        worst = max(worst, float(gaps(tree, part).max()))
        at = tree.open.poses(part).p[:, tree.index["platform"]]
        misplaced = max(misplaced, float(np.abs(at - places[i : i + 5000]).max()))
    assert worst < 1e-12
    assert misplaced < 1e-10
    outside = angles[np.random.default_rng(2).permutation(count)[:200]].copy()
    outside[:, 0], outside[:, 1:] = -1.2, 1.4  # the rods would have to be longer
    assert (tree.branch.solve(outside)[1] == Status.UNREACHABLE).all()


def test_delta_poses_outside_are_reported():
    """Angles for which the three spheres about the knees do not meet: none closes, and none has a torque."""
    tree = linkage("DELTA")
    rng = np.random.default_rng(3)
    t = rng.uniform(-1.2, 1.4, (3000, 3))
    knees = []
    for i in range(3):
        out = np.array([np.cos(2 * pi * i / 3), np.sin(2 * pi * i / 3), 0.0])
        knees.append(
            (BASE - PLATFORM + UPPER * np.cos(t[:, i, None])) * out + UPPER * np.sin(t[:, i, None]) * [0, 0, 1]
        )
    sides = [np.linalg.norm(knees[i] - knees[i - 1], axis=1) for i in range(3)]
    half = sum(sides) / 2
    area = np.sqrt(half * np.prod([half - side for side in sides], axis=0))
    outside = np.prod(sides, axis=0) / (4 * area) > LOWER  # the circle through the knees is too large
    assert outside.sum() > 300
    status = tree.status(t)
    assert (status[outside] == Status.UNREACHABLE).all()
    state = Potential(tree.mechanism)(t[outside])
    for values in (state.energy, state.torque, state.gravity, state.gravity_torque):
        assert np.isnan(values).all()


def test_gough_stewart_against_its_inverse_kinematics():
    tree = Tree.of(gough_stewart())
    assert isinstance(tree, Linkage)
    rng = np.random.default_rng(0)
    p = np.array([0.0, 0.0, 0.5]) + rng.uniform(-0.04, 0.04, (200, 3))
    R = Rotation.from_rotvec(rng.uniform(-0.1, 0.1, (200, 3))).as_matrix()
    u = np.linalg.norm(p[:, None] + STEWART_HEADS @ np.swapaxes(R, 1, 2) - STEWART_FEET, axis=2)
    poses = tree.poses(u)
    body = tree.index["platform"]
    assert np.abs(poses.p[:, body] - p).max() < 1e-11
    assert np.abs(poses.R[:, body] - R).max() < 1e-11


# What does not close -------------------------------------------------------------------------------------------------


def test_an_unreachable_pose_has_no_torque_and_no_place_in_a_verdict():
    tree = Tree.of(replace(four_bar(0.5, 0.3, 0.4, 0.45), assembly=(("coupler", 1.0), ("rocker", 1.8))))
    assert isinstance(tree, Linkage)
    status = tree.status(np.linspace(-pi, pi, 100)[:, None])
    assert set(status) == {Status.CLOSED, Status.UNREACHABLE}
    state = Potential(tree.mechanism)(np.linspace(-pi, pi, 100)[:, None])
    assert np.array_equal(np.isnan(state.torque[:, 0]), status != Status.CLOSED)
    assert np.array_equal(np.isnan(state.energy), status != Status.CLOSED)
    balance = check(tree.mechanism, samples=200)
    assert np.isfinite([*balance.total, *balance.residual.max]).all()
    assert np.isnan(Potential(tree.mechanism)(np.full((1, 1), np.nan)).energy).all()


def test_a_singular_pose_is_reported():
    """A parallelogram's dead centre: the bars in line with the ground, where it may fold either way."""
    tree = Tree.of(replace(spatial_parallelogram(), joints=unlimited(spatial_parallelogram())))
    assert isinstance(tree, Linkage)
    axis = np.array([0.3, -1.0, 0.2]) / np.linalg.norm([0.3, -1.0, 0.2])
    ground, bar = (v - axis * (axis @ v) for v in (np.array([0.0, 0.0, 0.15]), np.array([0.4, 0.2, 0.1])))
    dead = float(np.arctan2(axis @ np.cross(bar, ground), bar @ ground))
    status = tree.status(np.array([[dead], [dead + 0.01], [dead - 0.01], [0.0]]))
    assert status[0] != Status.CLOSED
    assert np.isnan(Potential(tree.mechanism)(np.array([[dead]])).torque).all()
    assert status[3] == Status.CLOSED
    assert Status.CLOSED in status[1:3]


def test_a_rod_leg_reaches_what_its_geometry_allows():
    """The two ends of the rod on their circles about -y: the crank's pin is reached by a rod of 0.25 m, or is not."""
    tree = linkage("rod leg")
    assert tree.coordinates == ("hip", "crank", "upper z")
    u = np.column_stack([np.zeros(400), np.linspace(-2.8, 2.8, 400), np.zeros(400)])  # beyond is a part of its own
    crank = u[:, 1]
    pin = np.column_stack([0.06 * np.cos(crank), np.full(400, 0.02), 0.06 * np.sin(crank) - 0.1])
    shin = np.linspace(-pi, pi, 4001)
    end = np.column_stack([0.06 * np.cos(shin), np.full(4001, 0.02), 0.06 * np.sin(shin) - 0.4])
    apart = np.linalg.norm(pin[:, None] - end, axis=2)
    reached = (apart.min(axis=1) < 0.25 - 1e-4) & (apart.max(axis=1) > 0.25 + 1e-4)
    never = (apart.min(axis=1) > 0.25 + 1e-4) | (apart.max(axis=1) < 0.25 - 1e-4)
    status = tree.status(u)
    assert 50 < reached.sum() < 350
    assert (status[reached] == Status.CLOSED).all()
    assert (status[never] != Status.CLOSED).all()


def test_what_is_beside_singular_poses_is_left_out_of_a_verdict():
    """Where the rod's ends are as far apart as they can be, the crank's torque grows without a bound."""
    first, second = (check(LOOPED["rod leg"](), samples=500, seed=seed) for seed in (0, 1))
    for balance in (first, second):
        assert balance.singular is not None
        assert balance.certificate.samples == 500 - balance.singular.left_out
        assert balance.to_dict()["singular"]["nearer"] == balance.singular.nearer
        tree = linkage("rod leg")
        assert isinstance(tree, Linkage)
        assert tree.close(balance.singular.configuration[None])[0][0] > balance.singular.nearer
        assert tree.close(balance.worst_configuration[None])[0][0] <= balance.singular.nearer
        assert not balance.singular.passed
    np.testing.assert_allclose(first.residual.max, second.residual.max, rtol=0.2, atol=1e-6)
    assert check(four_bar(), samples=100).singular is None


def test_a_change_point_that_relations_lead_through_is_named_and_nothing_left_out():
    balance = check(replace(spatial_parallelogram(), joints=unlimited(spatial_parallelogram())), samples=500)
    assert balance.singular is not None
    assert balance.singular.passed
    assert balance.singular.left_out == 0
    assert balance.certificate.samples == 500


def unlimited(mechanism: Mechanism) -> tuple:
    return tuple(replace(joint, range=None) for joint in mechanism.joints)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda m: replace(m, loops=(replace(m.loops[0], p_a=(2.0, 0, 0)),)), "cannot be assembled: .* stays open by"),
        (lambda m: replace(m, independent=("crank", "rocker")), "1 coordinate is independent, found 2"),
        (
            lambda m: replace(m, joints=tuple(replace(j, range=(-0.1, 0.1)) for j in m.joints)),
            "cannot be assembled|outside its range of -5.73 to 5.73 deg",
        ),
    ],
)
def test_non_assembling_mechanisms_are_reported(change, message):
    with pytest.raises(InputError, match=message):
        Tree.of(change(four_bar()))


def test_no_verdict_on_what_cannot_be_assembled():
    with pytest.raises(InputError, match="1 coordinate is independent"):
        check(replace(four_bar(), independent=("crank", "rocker")))


def test_a_singular_assembly_is_reported():
    """Assembled flat, a parallelogram can also fold: two ways to move there, one beside it."""
    flat = four_bar(0.2, 0.45, 0.2, 0.45)
    with pytest.raises(InputError, match="singular pose"):
        Tree.of(replace(flat, assembly=(("crank", 0.0), ("coupler", 0.0), ("rocker", 0.0))))


def test_independent_coordinates_that_do_not_determine_the_others():
    two = LOOPED["RSSR"]()
    names = ("joint 1", "link 1 auxiliary", "link 1 pseudobase.z", "link 2 pseudobase.z")
    with pytest.raises(InputError, match="do not determine the others"):
        Tree.of(replace(two, independent=names))


def test_too_few_independent_coordinates_name_what_stays_free():
    leg = LOOPED["rod leg"]()
    with pytest.raises(InputError, match="3 coordinates are independent, found 2: hip, shin; upper z would stay free"):
        Tree.of(replace(leg, independent=("hip", "shin")))


def test_any_coordinate_that_can_may_be_independent():
    by_crank = Tree.of(four_bar())
    assert isinstance(by_crank, Linkage)
    q = by_crank.branch.solve(np.array([[1.0], [1.0001]]))[0]
    here = tuple(zip(by_crank.open.coordinates, q[0].tolist(), strict=True))
    by_rocker = Tree.of(replace(four_bar(), independent=("rocker",), assembly=here))
    assert isinstance(by_rocker, Linkage)
    rocker = q[:, [by_crank.open.coordinates.index("rocker")]]
    np.testing.assert_allclose(by_rocker.branch.solve(rocker)[0], q, atol=1e-9)
    speed = (rocker[1] - rocker[0])[0] / (q[1] - q[0])[0]
    torques = [Potential(t.mechanism)(u).torque[0, 0] for t, u in ((by_crank, q[:1, :1]), (by_rocker, rocker[:1]))]
    assert torques[0] == pytest.approx(torques[1] * speed, rel=1e-3)  # the same work


def test_a_loop_that_is_closed_already_changes_nothing():
    """A hinge on top of a joint: five redundant equations."""
    m = replace(four_bar(), loops=(), assembly=())
    doubled = replace(m, loops=(Loop("crank", (0.2, 0.0, 0.0), "coupler", (0.0, 0.0, 0.0), (0, -1, 0), (0, -1, 0)),))
    tree = Tree.of(doubled)
    assert isinstance(tree, Linkage)
    assert tree.mobility.redundant == 5
    assert tree.coordinates == m.coordinates
    q = sample(Tree.of(m), 20)
    np.testing.assert_allclose(Potential(doubled)(q).torque, Potential(m)(q).torque, atol=1e-12)


def test_closed_poses_do_not_depend_on_what_was_asked_before():
    tree = linkage("RSSR")
    u = sample(tree, 40, seed=5)
    fresh = Branch(tree.mechanism)
    one_by_one = np.concatenate([fresh.solve(row[None])[0] for row in u])
    np.testing.assert_allclose(one_by_one, tree.branch.solve(u)[0], atol=1e-12)

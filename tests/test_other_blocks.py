"""The protocol of blocks is open: counterweights, and a spring between fixed points defined here, go all the way."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from robots import planar_arm
from scipy.optimize import linprog, nnls
from test_load import TILTED, torques

import equipoise as eq
from equipoise.energy import Potential
from equipoise.energy.fourier.frames import Frames
from equipoise.energy.fourier.series import Series
from equipoise.kinematics import Poses, Tree, Velocities, sample
from equipoise.model.arrays import Array
from equipoise.model.errors import NoFourierForm
from equipoise.synthesis.convex.blocks import Block, Cone
from equipoise.synthesis.convex.counterweight_block import CounterweightBlock
from equipoise.synthesis.convex.least_squares_form import build
from equipoise.synthesis.convex.peak import peak_poses
from equipoise.synthesis.convex.semidefinite import least_rms

ARM = planar_arm([1, 2], [0.4, 0.3], [0.2, 0.1])
HINGE = planar_arm([2.0], [0.5], [0.3])


@dataclass(frozen=True)
class FixedSpring(Block):
    """An ordinary spring between the world and a body: the unknowns are k and k L0 / shortest [N/m]."""

    p_a: tuple[float, float, float]
    body: str
    p_b: tuple[float, float, float]
    shortest: float
    unknowns: ClassVar[int] = 2  # type: ignore[assignment]
    shape: ClassVar[int] = 1  # type: ignore[assignment]

    @property
    def place(self) -> tuple[str, ...]:
        return ("world", self.body)

    def series(self, frames: Frames) -> Series:
        raise NoFourierForm("a length is a square root")

    def sampled(self, tree: Tree, q: Array, poses: Poses, velocities: Velocities) -> tuple[Array, Array]:
        body, p_b = tree.index[self.body], np.array(self.p_b)
        d = poses.point(body, p_b) - np.array(self.p_a)
        length = np.linalg.norm(d, axis=1)
        rate = np.einsum("ni,nij->nj", d, velocities.point(poses, body, p_b)) / length[:, None]
        torque = rate[..., None] * np.stack([length, np.full(len(q), -self.shortest)], axis=-1)[:, None]
        return torque, np.array([(length**2).sum() / 2, -self.shortest * length.sum()])

    def cones(self) -> Iterable[Cone]:
        yield Cone("nonnegative", np.array([[0.0, 1.0], [1.0, -1.0]]))

    def part(self, u: Array) -> Array:
        return np.hstack([np.ones((len(u), 1)), (1 + u) / 2])

    def slopes(self, u: Array) -> Array:
        return np.tile([[[0.0, 0.5]]], (len(u), 1, 1))

    def add(self, mechanism: eq.Mechanism, k: float, u: Array) -> eq.Mechanism:
        free = self.shortest * (1 + float(u[0])) / 2
        spring = eq.Spring("fixed", "world", self.p_a, self.body, self.p_b, k, free_length=free)
        return mechanism.with_springs((*mechanism.springs, spring))


def test_a_counterweight_balances_a_hinge_exactly():
    problem = eq.Problem(HINGE, (), beside=(CounterweightBlock("link2", 0.2),))
    design = eq.solve(problem, springs=1)
    (weight,) = design.mechanism.masses
    assert design.balance.exact
    assert design.infeasible is None
    np.testing.assert_allclose(weight.mass * np.array(weight.position)[[0, 2]], [-2.0 * 0.3, 0], atol=1e-9)
    assert np.linalg.norm(weight.position) <= 0.2 * (1 + 1e-12)


def test_a_spring_and_a_counterweight_do_what_neither_does_alone():
    springs = eq.Problem.of(ARM, pairs=[("world", "link2")], radius=0.1)
    weight = CounterweightBlock("link3", 0.2)
    both = replace(springs, beside=(weight,))
    for alone in (springs, replace(both, pairs=())):
        assert least_rms(build(alone)).value > 0.1
    design = eq.solve(both, springs=2, exact=True, front=True)
    assert (len(design.mechanism.springs), len(design.mechanism.masses)) == (1, 1)
    assert {*design.front[-1].pairs} == {("world", "link2"), ("link3",)}
    assert design.mechanism.masses[0].mass * design.mechanism.masses[0].position[0] == pytest.approx(-2 * 0.1)


def test_weights_hold_in_every_direction_of_gravity_and_springs_do_not():
    weights = (CounterweightBlock("link2", 0.3), CounterweightBlock("link3", 0.3))
    problem = eq.Problem(ARM, (), beside=weights, loads=tuple(TILTED))
    design = eq.solve(problem, springs=2, exact=True)
    assert max(row.residual for row in design.loads) < 1e-10 * design.unbalanced
    springs = eq.solve(eq.Problem.of(ARM, radius=0.3, loads=TILTED), springs=2)
    assert springs.bound is not None
    assert springs.bound > 0.05 * springs.unbalanced


@pytest.mark.parametrize("samples", [None, 400])
def test_what_a_block_with_weight_leaves_under_each_load(samples):
    problem = eq.Problem(ARM, (), beside=(CounterweightBlock("link2", 0.3),), loads=tuple(TILTED), samples=samples)
    design = eq.solve(problem, springs=1)
    turn = 2 * np.pi * np.arange(8) / 8
    whole = np.stack(np.meshgrid(turn, turn), axis=-1).reshape(-1, 2)
    q = whole if samples is None else sample(Tree.of(ARM), samples)
    each = [np.sqrt((t**2).sum(axis=1).mean()) for t in torques(design.mechanism, TILTED, q)]
    assert [row.residual for row in design.loads] == pytest.approx(each, rel=1e-9)
    assert design.bound == pytest.approx(design.residual, rel=1e-5)  # one body's weights are one weight


def fixed(peak: bool = False) -> tuple[eq.Problem, Array, Array, float]:
    """A hinge within its range, its torque columns for the two extreme springs (poses, 2), its load and its unit."""
    hinge = replace(HINGE, joints=(replace(HINGE.joints[0], range=(-0.5, 1.0)),))
    q = peak_poses(Tree.of(hinge), 300, 0) if peak else sample(Tree.of(hinge), 300)
    spring = eq.Spring("one", "world", (0.1, 0, 0.4), "link2", (0.15, 0, 0), 1.0)
    shortest = float(Potential(hinge.with_springs([spring]))(q).path.min())
    block = FixedSpring(spring.p_a, "link2", spring.p_b, shortest)
    bare = Potential(hinge)(q).torque[:, 0]
    ends = [replace(spring, free_length=free) for free in (0.0, shortest)]
    columns = np.stack([Potential(hinge.with_springs([s]))(q).torque[:, 0] - bare for s in ends], axis=1)
    return eq.Problem(hinge, (), beside=(block,), samples=300), columns, bare, shortest


def test_the_best_spring_between_fixed_points_is_that_of_nonnegative_least_squares():
    problem, columns, bare, shortest = fixed()
    x, least = nnls(columns, -bare)
    design = eq.solve(problem, springs=1)
    assert design.bound == pytest.approx(least / np.sqrt(300), rel=1e-6)
    assert design.residual == pytest.approx(least / np.sqrt(300), rel=1e-6)
    (spring,) = design.mechanism.springs
    assert spring.stiffness == pytest.approx(x.sum(), rel=1e-4)
    assert spring.free_length == pytest.approx(shortest * x[1] / x.sum(), abs=1e-4)
    assert not design.averaged


def test_the_peak_too():
    """The worst pose is sought at the ends of the range too."""
    problem, columns, bare, _ = fixed(peak=True)
    one = np.ones((len(bare), 1))
    rows, sides = np.vstack([np.hstack([columns, -one]), np.hstack([-columns, -one])]), np.concatenate([-bare, bare])
    least = linprog([0, 0, 1], rows, sides).fun
    design = eq.solve(replace(problem, objective="peak"), springs=1)
    assert design.bound == pytest.approx(least, rel=2e-3)  # from the poses that matter
    assert design.residual == pytest.approx(least, rel=2e-3)


def test_bounds_with_mixed_blocks_hold_for_random_designs():
    problem = eq.Problem.of(ARM, span=1, radius=0.1, samples=200)
    problem = replace(
        problem, beside=(CounterweightBlock("link3", 0.2), FixedSpring((0, 0, 0.5), "link2", (0.1, 0, 0), 0.3))
    )
    reduced, rng = build(problem), np.random.default_rng(0)
    bound, q = least_rms(reduced).value * reduced.unbalanced, sample(Tree.of(ARM), 200)
    for _ in range(50):
        mechanism = ARM
        for block in rng.permutation(np.array(problem.blocks, object)):
            u = block.project(rng.uniform(-1, 1, (1, block.shape)))[0]
            mechanism = block.add(mechanism, float(np.exp(rng.uniform(-3, 6))), u)
        assert np.sqrt((Potential(mechanism)(q).torque ** 2).sum(axis=1).mean()) >= bound * (1 - 1e-9)

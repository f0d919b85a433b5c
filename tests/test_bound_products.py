"""Products of the bounds of attachments: true for every spring in its box, and what makes the bound tight."""

from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
import pytest
from campaign import campaign
from robots import planar_arm

import equipoise as eq
from equipoise.model.arrays import Array
from equipoise.synthesis.convex.blocks import Block
from equipoise.synthesis.convex.bound_products import of_three, of_two, with_balls
from equipoise.synthesis.convex.few_springs import SpringSearch
from equipoise.synthesis.convex.goal import Rms
from equipoise.synthesis.convex.least_squares_form import build
from equipoise.synthesis.convex.semidefinite import least_rms
from equipoise.synthesis.convex.spring_block import SpringBlock
from equipoise.synthesis.problem import Problem


class WithoutProducts(SpringBlock):
    """As before: the second moments of each end alone."""

    def cones(self):
        return islice(super().cones(), 2)


def on_lines() -> Problem:
    """The arm of docs/theory.md with one pair, each end on a line: energy 2.7472 sin q1 + 2.7249 sin(q1 + q2) J."""
    first = 0.3735
    weights = 2.7472 / 9.81 - 2.7249 / 9.81, 2.7249 / 9.81  # m1 s1 + m2 l1 = 2.7472 / g with the second link as a point
    arm = planar_arm([1.0, 1.0], [first, 0.3], [2.7472 / 9.81 - first, weights[1]])
    regions = {
        "world": eq.Region.box((0, 0, 0.2), (0.0094, 0, -0.1644)),
        "link3": eq.Region.box((0.2, 0, 0)),
    }
    return Problem.of(arm, pairs=[("world", "link3")], regions=regions)


def test_on_two_lines_the_bound_rises_to_what_is_reached():
    reduced = build(on_lines())
    loose = replace(reduced, blocks=tuple(WithoutProducts(**vars_of(block)) for block in reduced.blocks))
    assert least_rms(loose).value == pytest.approx(0.186, abs=5e-4)
    assert least_rms(reduced).value == pytest.approx(0.400, abs=5e-4)
    design = eq.solve(on_lines())
    assert design.residual / design.unbalanced == pytest.approx(0.400, abs=5e-4)
    assert design.certified_gap is not None
    assert design.certified_gap < 1e-4
    for spring in design.mechanism.springs:
        assert (*spring.p_a[:2], *spring.p_b[1:]) == (0.0094, 0.0, 0.0, 0.0)  # exactly on its lines
        assert max(abs(spring.p_a[2] + 0.1644), abs(spring.p_b[0])) <= 0.2


def vars_of(block: Block) -> dict[str, Any]:
    return {name: getattr(block, name) for name in ("body_a", "body_b", "region_a", "region_b")}


def in_boxes(rng: np.random.Generator, count: int) -> Array:
    """(count, 6) y = [u_a; 1; u_b] with u_a (2,) in a box, u_b (3,) in a ball; at corners as often as inside."""
    u = rng.uniform(-1, 1, (count, 2))
    u = np.where(rng.random((count, 1)) < 0.5, np.sign(u), u)
    ball = rng.normal(size=(count, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True) * rng.uniform(1, 2, (count, 1))
    return np.concatenate([u, np.ones((count, 1)), ball], axis=1)


def test_every_product_holds_for_every_spring():
    y = in_boxes(np.random.default_rng(0), 500)
    two, three = (np.stack(list(rows)) for rows in (of_two([0, 1], 2, 6), of_three([0, 1, 3], 2, 6)))
    assert np.einsum("ni,mij,nj->nm", y, two, y).min() == pytest.approx(0, abs=1e-12)  # tight at corners
    assert np.einsum("ni,mij,nj->nm", y, three, y).min() >= -1e-12
    for rows in with_balls([0, 1], [3, 4, 5], 2, 6):
        first, *others = np.einsum("ni,mij,nj->mn", y, rows, y)
        assert (first - np.linalg.norm(others, axis=0)).min() >= -1e-12


def test_products_are_violated_by_what_no_springs_are():
    """A moment matrix within every square, but whose products are no products: u_a and u_b of no sign at all."""
    N = np.eye(3)
    N[0, 2] = N[2, 0] = 1.0  # u_a u_b = 1 on average while both are zero on average: springs at two corners
    assert all(np.sum(A * N) >= 0 for A in of_two([0, 2], 1, 3))
    N[0, 1] = N[1, 0] = 0.5  # u_a leans to one side, and u_b does not follow
    assert min(np.sum(A * N) for A in of_two([0, 2], 1, 3)) < -0.4


def two_links(seed: int) -> Problem:
    """A planar arm of two links whose pair has an end on a line each, the lines along an axis of the body."""
    rng = np.random.default_rng(seed)
    lengths, masses = rng.uniform(0.2, 0.6, 2).tolist(), rng.uniform(0.5, 4, 2).tolist()
    arm = planar_arm(masses, lengths, [0.5 * lengths[0], float(rng.uniform(0.2, 0.9)) * lengths[1]])
    regions = {}
    for body in ("world", "link3"):
        half, place = np.zeros(3), rng.uniform(-0.2, 0.2, 3)
        half[2 * rng.integers(2)], place[1] = rng.uniform(0.05, 0.3), 0.0
        regions[body] = eq.Region.box(half.tolist(), place.tolist())
    return Problem.of(arm, pairs=[("world", "link3")], regions=regions)


@campaign(100)
def test_on_lines_bound_and_design_agree(seeds):
    """Two coordinates: the products give the exact hull (Anstreicher and Burer 2010)."""
    for seed in seeds:
        reduced = build(two_links(seed))
        search = SpringSearch(Rms(reduced), most=8)
        found = search.best(8)
        if found is None or search.floor > 1 - 1e-9:
            continue  # no spring helps
        assert search.floor - 1e-8 <= found.value <= search.floor * 1.001 + 1e-9, seed

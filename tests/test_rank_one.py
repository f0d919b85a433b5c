"""Splitting a moment matrix: the terms add up to it, and keep the constraints that it keeps."""

from collections.abc import Sequence

import numpy as np
import pytest

from equipoise.synthesis.convex.rank_one import factor
from equipoise.synthesis.convex.spring_block import SpringBlock, svec
from equipoise.synthesis.region import Region

SIDE, ONE = 7, 3  # of the moment matrix of two whole ends, and the entry between them
ENDS = [0, 1, 2], [4, 5, 6]


def limit(end: list[int]) -> np.ndarray:
    diagonal = np.zeros(SIDE)
    diagonal[ONE], diagonal[end] = 1.0, -1.0
    return np.diag(diagonal)


def within(rng: np.random.Generator, rank: int, ends: Sequence[list[int]]) -> np.ndarray:
    """A matrix of this rank whose mean squares are just within the unit ball at some ends."""
    F = rng.normal(size=(SIDE, rank))
    for end in ends:
        F[end] *= np.sqrt((F[ONE] ** 2).sum() / (F[end] ** 2).sum())
    return F @ F.T


@pytest.mark.parametrize("rank", [1, 2, 3, 5])
def test_terms_add_up_and_keep_one_constraint(rank):
    """Sturm and Zhang 2003: that can always be done."""
    rng = np.random.default_rng(rank)
    for _ in range(20):
        N = within(rng, rank, [ENDS[0]])
        F = factor(N, limit(ENDS[0])[None], 1e-9)
        assert F.shape == (SIDE, rank)
        np.testing.assert_allclose(F @ F.T, N, atol=1e-12 * np.trace(N))
        kept = np.einsum("si,st,ti->i", F, limit(ENDS[0]), F)
        assert kept.min() > -0.02 * np.trace(N)  # the angles are on a grid; the polish does the rest


def test_two_constraints_are_kept_from_rank_three_on_as_a_rule():
    """Ai and Zhang 2009, with exceptions."""
    rng = np.random.default_rng(0)
    limits = np.stack([limit(end) for end in ENDS])
    worst = []
    for _ in range(40):
        N = within(rng, 3, ENDS)
        before = np.linalg.eigh(N)
        start = before.eigenvectors[:, -3:] * np.sqrt(before.eigenvalues[-3:])
        violated = [
            -np.einsum("si,mst,ti->im", F, limits, F).min() / np.trace(N) for F in (start, factor(N, limits, 1e-9))
        ]
        worst.append(violated)
    assert np.median(worst, axis=0)[1] < 0.25 * np.median(worst, axis=0)[0]


def test_a_spring_is_split_into_itself():
    block = SpringBlock("world", "link", Region.ball(0.2), Region.box(0.1))
    u = np.array([[0.3, -0.4, 0.5, 0.9, -0.2, 1.0]])
    k, found = block.split(40.0 * block.part(u)[0], 1e-6)
    assert k == pytest.approx([40.0])
    np.testing.assert_allclose(found, u, atol=1e-12)


def test_what_has_no_amount_is_no_spring():
    block = SpringBlock("world", "link", Region.ball(0.2), Region.ball(0.1))
    only_end = np.zeros(SIDE)
    only_end[0] = 1.0
    k, found = block.split(svec(np.outer(only_end, only_end)), 1e-6)
    assert len(k) == len(found) == 0
    assert block.amount @ block.part(np.full((1, 6), 0.3))[0] == pytest.approx(1.0)

"""Proofs that a layout balances nothing: what they leave open, and that the check does not accept just anything."""

from dataclasses import replace
from itertools import combinations, combinations_with_replacement

import pytest
from planar_arms import pairs

from equipoise.synthesis.planar.exclusion import CaseSplit, Leaf, Proof, prove, verify


def within(n: int, span: int):
    """Layouts of at most one spring per pair, no wider than `span` altogether."""
    every = (c for size in range(1, len(pairs(n)) + 1) for c in combinations(pairs(n), size))
    return [c for c in every if sum(k - i for i, k in c) <= span]


def leaves(proof: Proof) -> list[Leaf]:
    return [proof] if isinstance(proof, Leaf) else leaves(proof.below) + leaves(proof.above)


@pytest.mark.parametrize(
    ("n", "left"),  # THEORY section 5, table; n = 5 as in the paper's Table 2
    [
        (3, {((1, 3), (1, 3)), ((1, 3), (2, 3))}),
        (4, {((1, 3), (1, 4), (1, 4)), ((1, 3), (1, 4), (2, 4))}),
        (5, {((1, 3), (1, 4), (1, 5), (1, 5)), ((1, 3), (1, 4), (1, 5), (2, 5))}),
    ],
)
def test_fewest_springs(n, left):
    layouts = list(combinations_with_replacement(pairs(n), n - 1))
    proofs = {layout: prove(layout, n) for layout in layouts}
    assert {layout for layout, proof in proofs.items() if proof is None} == left
    assert all(verify(layout, n, proof) for layout, proof in proofs.items() if proof is not None)


@pytest.mark.parametrize("n", [3, 4])
def test_no_fewer_springs_than_joints(n):
    """The minimum semidefinite rank of a star on n vertices, found again by cases."""
    for size in range(1, n - 1):
        assert all(prove(layout, n) for layout in combinations_with_replacement(pairs(n), size))


def test_smallest_span():
    proofs = {layout: prove(layout, 4) for layout in within(4, 7)}
    assert {layout for layout, proof in proofs.items() if proof is None} == {
        ((1, 3), (1, 4), (2, 4)),
        ((1, 2), (1, 4), (2, 4), (3, 4)),
        ((1, 2), (1, 4), (2, 3), (2, 4)),
    }


def test_what_is_feasible_is_left_open():
    """Table 5 of the paper balances its arm, to rounding: no proof may say otherwise."""
    for layout in (((1, 3), (1, 4), (1, 4)), ((1, 2), (1, 4), (2, 4), (3, 4))):
        assert prove(layout, 4, cases=5000) is None


def test_a_proof_of_one_layout_is_none_of_another():
    feasible = ((1, 3), (1, 4), (1, 4))
    excluded = prove(((1, 2), (1, 4), (2, 4)), 4)
    assert excluded is not None
    assert not verify(feasible, 4, excluded)


def test_altered_proofs_are_refused():
    layout = ((1, 2), (1, 4), (2, 4))
    proof = prove(layout, 4)
    assert isinstance(proof, (Leaf, CaseSplit))
    for leaf in leaves(proof)[:1]:
        number, weight = leaf.inequalities[0]
        for changed in (-weight, weight + 1):
            wrong = replace(leaf, inequalities=((number, changed), *leaf.inequalities[1:]))
            assert not verify(layout, 4, _with_first(proof, wrong))
    assert not verify(layout, 4, Leaf((), ()))
    outside = CaseSplit(0, 1, float("inf"), proof, proof)  # no cut: both halves must lie inside
    assert not verify(layout, 4, outside)


def _with_first(proof: Proof, leaf: Leaf) -> Proof:
    return leaf if isinstance(proof, Leaf) else replace(proof, below=_with_first(proof.below, leaf))

"""The criteria that exclude layouts: each agrees with the proofs, with angles too, and with every exact design."""

from itertools import combinations_with_replacement

import numpy as np
import pytest
from planar_arms import crooked, pairs
from robots import lee_chen

from equipoise.synthesis.planar.arm import Installation, PlanarArm
from equipoise.synthesis.planar.criteria import failures, objections, sign_failures
from equipoise.synthesis.planar.exclusion import prove
from equipoise.synthesis.planar.installing import Equations, solve
from equipoise.synthesis.planar.layouts import default_layout


def failing(n: int, most: int):
    layouts = (c for size in range(1, most + 1) for c in combinations_with_replacement(pairs(n), size))
    return [(c, {one.criterion for one in failures(c, n)}) for c in layouts if any(failures(c, n))]


@pytest.mark.parametrize(("n", "most"), [(3, 4), (4, 3)])
def test_what_a_criterion_excludes_has_a_proof_too(n, most):
    """Straight arms: the proofs know nothing of the criteria."""
    layouts = failing(n, most)
    assert {name for _, names in layouts for name in names} == {"rank", "G1", "G2", "G3", "G5"}
    assert all(prove(layout, n) is not None for layout, _ in layouts)


@pytest.mark.slow(reason="150 proofs for five links")
def test_what_a_criterion_excludes_has_a_proof_too_for_five_links():
    layouts = failing(5, 4)
    chosen = np.random.default_rng(0).choice(len(layouts), 150, replace=False)
    assert all(prove(layouts[number][0], 5) is not None for number in chosen)


def test_they_hold_for_any_angles():
    """On a crooked arm, ends anywhere: with two springs on three links only what passes is solved."""
    arm = PlanarArm.of(crooked(3))
    for layout in combinations_with_replacement(pairs(3), 2):
        found = Equations(arm, layout).solve(starts=6, enough=1)
        assert (found is not None) == (not any(failures(layout, 3))), layout


@pytest.mark.parametrize("n", [2, 3, 4, 5, 9])
def test_the_default_layout_fails_nothing(n):
    layout = default_layout(n)
    assert len(layout) == n - 1
    assert not any(failures(layout, n))
    assert not any(objections(layout, n, "springs"))
    assert not any(objections(layout, n, "span"))


def test_messages_say_where():
    texts = [str(failure) for failure in failures(((1, 2), (1, 5), (2, 5), (2, 3)), 5)]
    assert texts[0] == "fails G3 at links 3-4: no spring from the ground to either"
    assert "fails G5 at links 2-4: one spring alone acts there" not in texts
    assert "fails G5 at links 3-4: nothing cancels the springs that reach beyond both" in texts
    assert str(next(failures(((1, 3),), 3))).startswith("fails rank bound: 3 links need 2 springs, it has 1")


def test_the_papers_objections():
    found = {f.criterion for f in objections(((1, 2), (1, 4), (2, 4), (3, 4)), 4, "span")}
    assert found == {"J4"}  # its own exception
    assert [f.criterion for f in objections(((1, 2), (1, 3), (1, 4), (1, 4)), 4, "span")] == ["J1", "J3"]
    assert [f.criterion for f in objections(((1, 2), (1, 4), (2, 4), (3, 4)), 4, "springs")] == ["S3"]
    assert [f.criterion for f in objections(((1, 3), (2, 4)), 4, "springs")] == ["S1", "S2"]


def test_signs():
    """G1 and G4: what balances passes; a spring turned over does not."""
    arm = PlanarArm.of(lee_chen())
    for layout in (((1, 3), (1, 4), (1, 4)), ((1, 2), (1, 4), (2, 3), (2, 4)), ((1, 3), (1, 4), (2, 4))):
        found = solve(arm, layout, enough=1)
        assert found is not None
        assert not list(sign_failures(arm, found.springs))
    one = Installation(1, 4, 100, -0.1j, 0.02)
    assert [f.criterion for f in sign_failures(arm, [one])] == ["G4", "G4", "G1"]
    assert [f.criterion for f in sign_failures(arm, [Installation(1, 4, 100, -0.1j, -0.02)])] == ["G4", "G4"]

"""The search for layouts: the known minima, every candidate accounted for, and every example exact."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import combinations, combinations_with_replacement

import pytest
from planar_arms import pairs

import equipoise as eq
from equipoise.model.errors import InputError
from equipoise.synthesis.planar.criteria import failures, sign_failures
from equipoise.synthesis.planar.exclusion import prove, verify
from equipoise.synthesis.planar.layouts import LayoutSearch, _layouts, example_arm, name, search, span

FEWEST = {  # THEORY section 5; n = 5 as in the paper's Table 2
    2: {"12"},
    3: {"13,13", "13,23"},
    4: {"13,14,14", "13,14,24"},
    5: {"13,14,15,15", "13,14,15,25"},
    6: {"13,14,15,16,16", "13,14,15,16,26"},
}
SMALLEST = {  # THEORY section 5, and one more for n = 5
    2: {"12"},
    3: {"13,23"},
    4: {"13,14,24", "12,14,23,24", "12,14,24,34"},
    5: {"13,14,15,25", "12,14,15,23,25", "13,15,23,24,25", "13,15,24,25,34", "12,13,15,24,25"},
    6: {
        "13,14,15,16,26",
        "12,13,14,16,25,26",
        "12,13,15,16,24,26",
        "12,14,15,16,23,26",
        "13,14,16,23,25,26",
        "13,15,16,23,24,26",
        "13,15,16,24,26,34",
    },
}
LARGE = [
    2,
    3,
    4,
    pytest.param(5, marks=pytest.mark.slow(reason="all layouts of five links")),
    pytest.param(6, marks=pytest.mark.slow(reason="all layouts of six links")),
]


def names(found: LayoutSearch) -> set[str]:
    return {name(one.layout) for one in found.feasible}


def judged(found: LayoutSearch) -> None:
    """Nothing open, every proof good, every example exact with the springs of its layout."""
    assert not found.open
    assert all(verify(one.layout, found.n, one.proof) for one in found.proved if one.proof is not None)
    assert all(one.proof is not None for one in found.proved)
    assert all(any(one.failures) or one.proof for one in found.excluded)
    for one in found.feasible:
        assert one.balance.certificate.kind == "fourier"
        assert eq.check(one.balance.mechanism).exact
        assert tuple((spring.i, spring.k) for spring in one.found.springs) == one.layout
        assert not list(sign_failures(one.found.equations.arm, one.found.springs))


@pytest.mark.parametrize("n", LARGE)
def test_fewest_springs(n):
    """n - 1, Eq. (29): all multisets of fewer are excluded."""
    found = search(n, "springs")
    assert names(found) == FEWEST[n]
    assert {one.cost for one in found.feasible} == {n - 1}
    assert found.candidates == sum(
        len(list(combinations_with_replacement(pairs(n), size))) for size in range(1, n)
    )  # fmt: skip
    judged(found)


@pytest.mark.parametrize("n", LARGE)
def test_smallest_span(n):
    """(n^2 + n - 6) / 2, Eq. (33): all layouts of one spring per pair that span less are excluded."""
    found = search(n, "span")
    assert names(found) == SMALLEST[n]
    least = (n * n + n - 6) // 2 if n > 2 else 1
    assert {one.cost for one in found.feasible} == {least}
    subsets = (c for size in range(1, len(pairs(n)) + 1) for c in combinations(pairs(n), size))
    assert found.candidates == sum(span(c) <= least for c in subsets)
    judged(found)


@pytest.mark.parametrize("n", [3, 4, 5, pytest.param(6, marks=pytest.mark.slow(reason="all layouts of six links"))])
def test_several_springs_per_pair_span_more(n):
    """J1: what `search` leaves out for the span. Two between neighbours act as one, so they are never the fewest."""
    least = (n * n + n - 6) // 2
    left = 0
    for size in range(1, least + 1):
        for joints in range(size, least + 1):
            for layout in _layouts(n, size, joints, repeated=True):
                if (1, n) not in layout:  # G1, quickly
                    continue
                again = {pair for pair in layout if layout.count(pair) > 1}
                if again and all(k > i + 1 for i, k in again) and not any(failures(layout, n)):
                    left += 1
                    assert prove(layout, n) is not None, name(layout)
    assert left == {3: 0, 4: 0, 5: 2, 6: 16}[n]


@pytest.mark.parametrize("weight", [0.01, 1.0, 30.0])
def test_weighted(weight):
    """One layout has both minima, so it has the least of any weighted sum: the paper's last remark in section 7.2."""
    found = search(4, "weighted", weight=weight)
    assert names(found) == FEWEST[4] & SMALLEST[4] == {"13,14,24"}
    assert found.feasible[0].cost == pytest.approx(3 + 7 * weight)


def test_given_number_of_springs():
    found = search(4, "span", springs=4)
    assert names(found) == {"12,14,23,24", "12,14,24,34"}
    assert {len(one.layout) for one in found.excluded} == {4}
    found = search(3, "springs", springs=3)
    assert "13,13,13" in names(found)
    judged(found)
    none = search(4, springs=2)
    assert none.feasible == none.open == ()
    assert none.candidates == 21


def test_equations_have_the_signs_of_the_springs():
    (one,) = search(2).feasible
    assert str(one.equations) == "K_12 = [-s2 m2 g/r2 + k12 a12 b12/r2] I' = 0"


def test_the_example_arm_hangs_on_springs_alone():
    arm = example_arm(3)
    assert not eq.check(arm).exact
    assert [joint.parent for joint in arm.joints] == ["world", "link 2"]
    (first, *_) = search(3).feasible
    assert replace(first.balance.mechanism, springs=()) == arm


@pytest.mark.parametrize(
    "options", [{"n": 1}, {"n": 3, "objective": "cost"}, {"n": 3, "springs": 0}, {"n": 3, "weight": float("nan")}]
)
def test_bad_options(options):
    with pytest.raises(InputError):
        search(**options)


def test_command(run, tmp_path):
    code, out, err = run("layouts", 3, "--excluded", "--equations", "text", "-o", tmp_path / "made")
    assert code == 0
    assert "13,23: 2 springs that span 3 joints; exact on arm of 3 links" in out
    assert (
        "searched 9 layouts: 7 pruned by criteria (rank 3, G1 3, G2 1), 0 proved infeasible, 2 feasible, 0 open" in out
    )
    assert "12,13: fails G2 at link 3" in out
    assert "K_23 = " in out
    assert "wrote" in err
    assert {path.name for path in (tmp_path / "made").iterdir()} == {"13_13.yaml", "13_23.yaml"}
    assert run("check", tmp_path / "made" / "13_23.yaml")[0] == 0


def test_command_as_json(run):
    code, out, err = run("layouts", 4, "--objective", "span", "--excluded", "--json")
    rows = json.loads(out)
    assert code == 0
    assert "searched 54 layouts" in err
    feasible = [row for row in rows if row["example"] is not None]
    assert {tuple(map(tuple, row["pairs"])) for row in feasible} == {one.layout for one in search(4, "span").feasible}
    for row in feasible:
        assert (row["span"], row["cost"], row["excluded"]) == (7, 7, None)
        assert row["springs"] == len(row["pairs"])
        assert row["example"]["balance"]["exact"]
        assert row["example"]["equations"][0].startswith("K_12 = [-s2 m2 g/r2")
    excluded = [row for row in rows if row["example"] is None]
    assert len(excluded) == 51
    assert any("proved by the signs" in row["excluded"] for row in excluded)


def test_command_that_finds_none_or_is_wrong(run):
    code, out, _ = run("layouts", 4, "--springs", 2)
    assert code == 1
    assert "no layout is feasible" in out
    for wrong in (["1"], ["3", "--objective", "cost"], ["3", "--equations", "pdf"], ["3", "--weight", "0"]):
        code, _, err = run("layouts", *wrong)
        assert code == 2
        assert err.startswith("error: ")

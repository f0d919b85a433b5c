"""lenzo2017: the golden case, the residuals of the four layouts, the refusals, the energies over a motion."""

from __future__ import annotations

import json

import numpy as np
import pytest

from equipoise.reproduce import Plot, reproduce
from equipoise.reproduce.lenzo2017 import CHOSEN, balanced


@pytest.fixture(scope="module")
def paper():
    return reproduce("lenzo2017")


@pytest.fixture(scope="module")
def rows(paper):
    return {row.item: row for row in paper.rows}


def test_nothing_differs(rows):
    assert {row.verdict for row in rows.values()} == {"agrees", "golden"}


@pytest.mark.parametrize(("name", "value"), [("a2", 0.053955), ("b2", 0.0654545), ("k12", 2618.18)])
def test_golden_numbers_are_labelled(rows, name, value):
    row = rows[f"{name} (15), layout b"]
    assert row.value is None
    assert row.own.value == value
    assert row.verdict == "golden"
    assert "the paper prints no numbers" in row.note


def test_residuals(rows):
    residuals = {item: row for item, row in rows.items() if "residual torque over 2000" in item}
    assert len(residuals) == 4 * 2 + 2
    for item, row in residuals.items():
        if item.endswith("values rounded"):
            assert 1e-8 < row.computed < 1e-4  # rounding shows
        else:
            assert row.computed < 1e-13, item
            assert row.published == "0"


def test_golden_layout_b_is_exact():
    design = balanced(layout="b", **CHOSEN)
    assert design.balance.exact
    assert design.balance.certificate.samples is None or design.balance.certificate.samples == 2000
    assert design.balance.residual.max.max() < 1e-13


def test_refusals_give_the_reason(rows):
    above = rows["layouts that exist with h2 > 0, Sec. 3.2"]
    below = rows["layouts that exist with h2 < 0, Sec. 3.2"]
    assert (above.computed, below.computed) == (2, 2)
    assert "layout c needs h2 < 0" in above.note
    assert "layout d needs h2 < 0" in above.note
    assert "layout a needs h2 > 0" in below.note
    row = rows["designs with a2 < 0, five heights from -10 mm to -1 m, Sec. 3.2"]
    assert row.computed == 0
    assert "a2 > 0 is needed" in row.note


def test_without_spring_k12_the_term_of_12_is_left(rows):
    found = balanced(layout="b", springs=3).free_parameters
    left = rows["variation of the energy without spring k12, Fig. 4a (12)"].computed
    assert left == pytest.approx(2 * found["k2"] * found["b2"] * 0.3, rel=1e-3)  # over random poses


def test_the_energy_is_constant_over_the_motion(paper):
    figure, *pictures = paper.figures
    assert [picture.name for picture in pictures] == [
        "fig1",
        "fig2",
        "fig3",
        "fig4a",
        "fig4b",
        *(f"fig5{x}" for x in "abcd"),
    ]
    assert isinstance(figure, Plot)
    assert set(figure.series) == {"gravity", "spring k2", "spring k12", "total"}
    parts = sum(figure.series[name] for name in ("gravity", "spring k2", "spring k12"))
    np.testing.assert_allclose(parts, figure.series["total"], rtol=1e-13)
    for name in ("gravity", "spring k2", "spring k12"):
        assert np.ptp(figure.series[name]) > 1  # [J]
    assert np.ptp(figure.series["total"]) < 1e-12


def test_command_line(run):
    code, out, _ = run("reproduce", "lenzo2017", "--json")
    assert code == 0
    assert {row["paper"] for row in json.loads(out)} == {"lenzo2017"}

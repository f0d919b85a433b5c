"""lee2014: Table 5's energies and residuals, the layouts of Tables 2 and 3, Fig. 10, and the errata."""

from __future__ import annotations

import numpy as np
import pytest
from example_files import FOLDER, same

import equipoise as eq
from equipoise.reproduce import Plot, reproduce
from equipoise.reproduce.lee2014 import CASES, arm, balanced, completed, motion, printed


@pytest.fixture(scope="module")
def paper():
    return reproduce("lee2014")


@pytest.fixture(scope="module")
def rows(paper):
    return {row.item: row for row in paper.rows}


@pytest.mark.slow(reason="computes the whole paper")
def test_every_number_is_compared_and_none_differs(paper, rows):
    assert len(rows) == len(paper.rows)
    for case in CASES:
        assert sum(f"^{row.i}{row.k}" in item for row in case.rows for item in rows if f"({case.letter})" in item) >= 6
    assert {row.verdict for row in rows.values()} == {"agrees", "erratum", "differs", "golden"}
    assert {item for item, row in rows.items() if row.verdict == "erratum"} == {
        "ground springs of 13,23, Table 2; G3: greater than ceil((n-1)/2) = 1",
        "variation of the total energy, Table 5(b) with a from the joint of link i",
    }


@pytest.mark.slow(reason="computes the whole paper")
def test_numbers_of_the_paper(rows):
    """PAPERS.md: 20.52 to 20.63 J, mean 20.58, 0.055 N m; 27.17 to 27.29 J, 0.050 N m; 26 J from the wrong joint."""
    expected = {
        "lowest total energy over all poses, Table 5(a) as printed": (20.52, 0.005),
        "highest total energy over all poses, Table 5(a) as printed": (20.63, 0.005),
        "mean total energy, Table 5(a) as printed": (20.58, 0.005),
        "total energy, Table 5(a) completed": (20.56, 0.005),
        "largest residual torque, Table 5(a) as printed": (0.055, 0.0006),
        "lowest total energy over all poses, Table 5(b) as printed": (27.17, 0.005),
        "highest total energy over all poses, Table 5(b) as printed": (27.29, 0.005),
        "largest residual torque, Table 5(b) as printed": (0.050, 0.0006),
        "largest unbalanced torque, Table 4": (8.47, 0.005),
        "variation of the total energy, Table 5(b) with a from the joint of link i": (26.2, 0.05),
    }
    for item, (value, digits) in expected.items():
        assert rows[item].computed == pytest.approx(value, abs=digits), item


@pytest.mark.slow(reason="computes the whole paper")
def test_layouts(rows):
    for n, count in ((3, 1), (4, 3), (5, 4)):
        row = rows[f"layouts for n = {n}, Table 3 and Fig. 8"]
        assert row.computed == count == float(row.published)
    assert "12,13,15,24,25" in rows["layouts for n = 5, Table 3 and Fig. 8: further ones"].note


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.letter)
def test_completed_springs_are_exact_and_round_to_the_table(case):
    assert eq.check(balanced(case)).exact
    assert not eq.check(printed(case)).exact
    for one, row in zip(completed(case), case.rows, strict=True):
        assert abs(one.a) == pytest.approx(float(row.a), abs=0.00061)
        assert abs(one.b) == pytest.approx(float(row.b), abs=0.00061)
        np.testing.assert_allclose([one.a / abs(one.a), one.b / abs(one.b)], [1j**row.alpha, 1j**row.beta], atol=1e-12)


def test_the_motion_is_that_of_section_8():
    """Link 3 starts and stays horizontal, link 4 hangs, until both are raised."""
    q = np.degrees(motion())
    np.testing.assert_allclose(q[[0, 200, 400]], [[135, 225, 270], [90, 270, 270], [90, 315, 45]])
    absolute = np.cumsum(q[:201], axis=1)
    np.testing.assert_allclose(absolute[:, 1], 360, atol=1e-9)
    np.testing.assert_allclose(absolute[:, 2], 360 + 270, atol=1e-9)


@pytest.mark.slow(reason="computes the whole paper")
def test_figure_10(paper):
    assert [figure.name for figure in paper.figures] == ["fig10a", "fig10b"]
    for figure, least in zip(paper.figures, (20.5, 27.2), strict=True):
        assert isinstance(figure, Plot)
        gravity, springs, total = (figure.series[name] for name in ("gravity", "springs", "total"))
        np.testing.assert_allclose(gravity + springs, total, rtol=1e-13)
        assert np.ptp(total) < 1e-12 * np.ptp(gravity)
        assert total.mean() == pytest.approx(least, abs=0.1)
        assert np.ptp(gravity) > 5


@pytest.mark.parametrize(
    ("file", "mechanism"),
    [("lee_chen_arm", arm()), *((f"lee2014_table5{case.letter}", balanced(case)) for case in CASES)],
)
def test_examples(file, mechanism):
    same(eq.load(FOLDER / f"{file}.yaml"), mechanism, 1e-12, 1e-15)

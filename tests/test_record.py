"""Published beside computed: what a printed number's digits say, and the verdict on it."""

import numpy as np
import pytest

from equipoise.model.errors import InputError
from equipoise.reproduce import Map, Plot, Row, reproduce
from equipoise.reproduce.record import half_unit, spread, vector


@pytest.mark.parametrize(("printed", "half"), [("0.13", 0.005), ("105.92", 0.005), ("20", 0.5), ("1.590e3", 0.5)])
def test_the_last_printed_digit_is_the_rounding(printed, half):
    assert half_unit(printed) == pytest.approx(half)


def test_spread_of_a_product_is_first_order():
    # (2.0 +- 0.05) * (3.00 +- 0.005) = 6 +- (0.05 * 3 + 2 * 0.005)
    assert spread(lambda x, y: x * y, ["2.0", "3.00"]) == pytest.approx(0.16)


@pytest.mark.parametrize(
    ("published", "computed", "more", "verdict"),
    [
        ("0.13", 0.1349, {}, "agrees"),
        ("0.13", 0.1351, {}, "differs"),
        ("0.13", 0.1351, {"spread": 0.001}, "agrees"),
        ("0.13", 0.2, {"erratum": "a digit is missing"}, "erratum"),
        (None, 0.2, {}, "computed"),
    ],
)
def test_verdict(published, computed, more, verdict):
    row = Row("paper", "item", published, computed, **more)
    assert row.verdict == verdict
    keys = {"paper", "item", "published", "computed", "relative_difference", "note"}  # the contract of DESIGN.md
    assert set(row.to_dict()) >= keys


def test_vectors_give_a_row_for_each_component():
    rows = vector("paper", "sigma", ["0.1", "0.2", "0.30"], np.array([0.1, 0.2, 0.3]), unit="m")
    assert [row.item for row in rows] == ["sigma.x", "sigma.y", "sigma.z"]
    assert rows[2].rounding == pytest.approx(0.005)
    assert rows[1].relative_difference == pytest.approx(0)


def test_an_unknown_paper_is_refused():
    with pytest.raises(InputError, match="no paper"):
        reproduce("lin2011")


@pytest.mark.parametrize("suffix", [".svg", ".png"])
def test_figures_are_the_same_bytes_each_time(tmp_path, suffix):
    from equipoise.report.plots import save_plot

    x = np.linspace(0, 1, 20)
    plot = Plot("energy", "Energy", "time [s]", "energy [J]", x, {"gravity": x**2, "springs": -(x**2)})
    panel = np.outer(x, x)
    chart = Map("map", "Residual", "x [m]", "y [m]", "torque [N m]", x, x, {"before": panel, "after": -panel})
    for one in (plot, chart):
        paths = [tmp_path / f"{i}{suffix}" for i in range(2)]
        for path in paths:
            save_plot(one, path)
        assert paths[0].read_bytes() == paths[1].read_bytes()
        assert paths[0].stat().st_size > 2000

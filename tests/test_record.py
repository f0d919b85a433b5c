"""Published beside computed: what a printed number's digits say, and the verdict on it."""

import numpy as np
import pytest

from equipoise.model.errors import InfeasibleError, InputError
from equipoise.reproduce import Map, Plot, Reproduction, Row, reproduce
from equipoise.reproduce.record import half_unit, spread, vector


@pytest.mark.parametrize(("printed", "half"), [("0.13", 0.005), ("105.92", 0.005), ("20", 0.5), ("1.590e3", 0.5)])
def test_the_last_printed_digit_is_the_rounding(printed, half):
    assert half_unit(printed) == pytest.approx(half)


def test_spread_of_a_product_is_first_order():
    # (2.0 +- 0.05) * (3.00 +- 0.005) = 6 +- (0.05 * 3 + 2 * 0.005)
    assert spread(lambda x, y: x * y, ["2.0", "3.00"]) == pytest.approx(0.16)


WRONG = {"golden": "0.20", "why": "a digit is missing"}


@pytest.mark.parametrize(
    ("published", "computed", "more", "verdict"),
    [
        ("0.13", 0.1349, {}, "agrees"),
        ("0.13", 0.1351, {}, "FAILS"),
        ("0.13", 0.1351, {"spread": 0.001}, "agrees"),
        ("0.13", 0.1301, {"exact": True}, "FAILS"),
        ("1", 1.4, {"exact": True}, "FAILS"),
        ("<= 2", 1.9, {}, "agrees"),
        ("<= 2", 2.1, {}, "FAILS"),
        (">= 20", 4.8, {}, "FAILS"),
        (None, 0.2, {"golden": "0.20"}, "golden"),
        (None, 0.21, {"golden": "0.20"}, "FAILS"),
        (None, 1 / 3, {"golden": 1 / 3}, "golden"),
        (None, 0.3333, {"golden": 1 / 3}, "FAILS"),
        (None, float("nan"), {"golden": "<= 1e-12"}, "FAILS"),
        ("0.13", 0.1349, {"golden": "0.1349"}, "agrees"),
        ("0.13", 0.1349, {"golden": "0.1340"}, "FAILS"),
        ("0.13", 0.2, {"against": "erratum", **WRONG}, "erratum"),
        ("0.13", 0.2, {"against": "unprinted", **WRONG}, "unprinted"),
        (">= 20", 0.2, {"against": "refuted", **WRONG}, "refuted"),
        ("0.13", 0.2, {"against": "erratum", "proof": False, **WRONG}, "FAILS"),  # nothing proves the print wrong
        ("0.20", 0.2, {"against": "erratum", **WRONG}, "FAILS"),  # the print is right
        ("0.13", 0.3, {"against": "erratum", **WRONG}, "FAILS"),  # neither is right
    ],
)
def test_verdict(published, computed, more, verdict):
    row = Row("paper", "item", published, computed, **more)
    assert row.verdict == verdict
    keys = {"paper", "item", "published", "computed", "relative_difference", "note"}  # the contract of DESIGN.md
    assert set(row.to_dict()) >= keys


def test_a_golden_value_is_never_shown_as_published():
    found = Row("paper", "item", None, 0.2, golden="0.20").to_dict()
    assert (found["published"], found["golden"], found["tolerance"]) == (None, 0.2, pytest.approx(0.005))


@pytest.mark.parametrize(
    "more",
    [
        {},
        {"published": "1", "against": "erratum", "why": "so"},
        {"published": "1", "against": "refuted", "golden": 2.0},
    ],
)
def test_a_row_that_is_held_to_nothing_cannot_be_made(more):
    with pytest.raises(ValueError, match="item"):
        Row("paper", "item", more.pop("published", None), 1.0, **more)


def test_a_section_that_cannot_be_computed_fails_by_its_name():
    def springs():
        """The springs of Table 1."""
        raise InfeasibleError("none were found")
        yield

    (row,) = Reproduction.of("paper", "citation", [springs], []).rows
    assert row.verdict == "FAILS"
    assert "The springs of Table 1." in row.failure
    assert "none were found" in row.failure
    assert row.to_dict()["computed"] is None  # JSON has no NaN


def test_a_row_that_fails_makes_the_command_fail_and_is_named_last(run, monkeypatch):
    from equipoise.synthesis.bevel import method

    make = method._disk_spring
    monkeypatch.setattr(method, "_disk_spring", lambda s, disk, side, phase, width, size: make(
        s, disk, side, phase, width, (1.3 * size[0], *size[1:])
    ))  # fmt: skip
    from equipoise.reproduce.cho2012 import balanced

    balanced.cache_clear()
    code, out, _ = run("reproduce", "cho2012")
    balanced.cache_clear()
    assert code == 1
    assert (
        "FAILS: cho2012, k of the left spring, fixed gear near (23): computed 2.08744 kN/m, golden 1.60572"
        in " ".join(out.split())
    )
    assert "gear ratio 0.5: computed 0.858915, golden 0.84368" in " ".join(out.rsplit("FAILS:", 1)[1].split())


def test_vectors_give_a_row_for_each_component():
    rows = vector("paper", "sigma", ["0.1", "0.2", "0.30"], np.array([0.1, 0.2, 0.3]), unit="m")
    assert [row.item for row in rows] == ["sigma.x", "sigma.y", "sigma.z"]
    assert rows[2].printed is not None
    assert rows[2].printed.tolerance == pytest.approx(0.005)
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

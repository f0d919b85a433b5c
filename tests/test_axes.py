"""What varies in a study: values, products of them, and draws."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from scipy.stats import kstest, qmc

from equipoise.model.errors import InputError
from equipoise.study.axes import axes, plain


def values(given: object) -> list[object]:
    (axis,) = axes({"x": given})
    return list(axis.values["x"])


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ([1, "50 mm", "30 deg", "2%", "ball", True], [1, 0.05, np.pi / 6, 0.02, "ball", True]),
        ({"from": "50 mm", "to": 0.2, "count": 4}, [0.05, 0.1, 0.15, 0.2]),
        ({"from": 1, "to": 7, "count": 3}, [1, 4, 7]),
        ({"from": 1, "to": 2, "count": 3}, [1.0, 1.5, 2.0]),
        ({"from": "1 kg", "to": "100 kg", "count": 3, "scale": "log"}, [1.0, 10.0, 100.0]),
    ],
)
def test_lists_and_ranges(given, expected):
    found = values(given)
    assert [type(value) for value in found] == [type(value) for value in expected]
    assert found == pytest.approx(expected) if "ball" not in expected else found[2:] != [] and found[4:] == expected[4:]


def test_quantities_become_numbers_in_si_and_names_stay():
    assert [plain(text) for text in ("2 kN/m", "850 g", "-20 N mm", "1e-3 m")] == pytest.approx(
        [2000, 0.85, -0.02, 1e-3]
    )
    assert [plain(text) for text in ("a", "12a", "m", "A:B", "mm", "%")] == ["a", "12a", "m", "A:B", "mm", "%"]


def test_draws_of_one_count_and_seed_go_together_and_others_multiply():
    together = {"uniform": [0, 1], "count": 5, "seed": 1}
    found = axes({"a": together, "n": [1, 2], "b": together, "c": {**together, "seed": 2}})
    assert [(list(axis.values), len(axis)) for axis in found] == [(["a", "b"], 5), (["n"], 2), (["c"], 5)]
    assert found[0].values["a"] != found[0].values["b"] != found[2].values["c"]


def test_a_draw_is_its_own_whatever_else_is_drawn():
    law = {"normal": [2, 0.5], "count": 9, "seed": 3}
    assert axes({"a": law})[0].values["a"] == axes({"b": law, "a": law})[0].values["a"]


@pytest.mark.parametrize("points", ["random", "low-discrepancy"])
def test_draws_follow_their_distribution(points):
    more = {"count": 2000, "seed": 4, "points": points}
    found = axes(
        {
            "u": {"uniform": ["1 kg", 3], **more},
            "l": {"log-uniform": [1, 1000], **more},
            "n": {"normal": [5, 2], **more},
        }
    )[0].values
    assert kstest(found["u"], "uniform", (1, 2)).pvalue > 0.01
    assert kstest(np.log10(found["l"]), "uniform", (0, 3)).pvalue > 0.01
    assert kstest(found["n"], "norm", (5, 2)).pvalue > 0.01
    assert np.abs(np.corrcoef(found["u"], found["n"])[0, 1]) < 0.07


def test_low_discrepancy_fills_the_square_more_evenly():
    def discrepancy(points: str) -> float:
        law = {"uniform": [0, 1], "count": 256, "seed": 0, "points": points}
        found = axes({"a": law, "b": law})[0].values
        return float(qmc.discrepancy(np.column_stack([found["a"], found["b"]])))

    assert discrepancy("low-discrepancy") < 0.2 * discrepancy("random")


@pytest.mark.parametrize(
    ("given", "path", "message"),
    [
        ([], ("x",), "has no values"),
        (3, ("x",), "expected a list, a range or a distribution"),
        ({"from": 1, "to": 2}, ("x",), "'count' is missing"),
        ({"from": 1, "to": 2, "cuont": 3}, ("x", "cuont"), "did you mean 'count'?"),
        ({"from": 1, "to": "b", "count": 3}, ("x", "to"), "expected a number"),
        ({"from": 0, "to": 2, "count": 3, "scale": "log"}, ("x", "from"), "a log scale needs"),
        ({"from": 1, "to": 2, "count": 3, "scale": "logg"}, ("x", "scale"), "did you mean 'log'?"),
        ({"from": 1, "to": 2, "count": 2.5}, ("x", "count"), "whole number"),
        ({"uniform": [2, 1], "count": 3}, ("x", "uniform"), "low <= high"),
        ({"uniform": [2, 1, 3], "count": 3}, ("x", "uniform"), "expected [low, high]"),
        ({"log-uniform": [0, 1], "count": 3}, ("x", "log-uniform"), "0 < low <= high"),
        ({"normal": [0, -1], "count": 3}, ("x", "normal"), "at least 0"),
        ({"uniform": [0, 1], "normal": [0, 1], "count": 3}, ("x", "normal"), "unknown key"),
        ({"uniform": [0, 1], "count": 3, "seed": -1}, ("x", "seed"), "at least 0"),
        ({"uniform": [0, 1], "count": 3, "points": "sobol"}, ("x", "points"), "no points 'sobol'"),
    ],
)
def test_mistakes(given, path, message):
    with pytest.raises(InputError) as error:
        axes({"good": [1], "x": given})
    (fault,) = error.value.faults
    assert fault.path == path
    assert message in fault.message


def test_all_mistakes_at_once():
    with pytest.raises(InputError) as error:
        axes({"a": [], "b": {"from": 1}, "c": [1]})
    assert {fault.path[0] for fault in error.value.faults} == {"a", "b"}


def test_the_product_is_that_of_loops():
    found = axes({"a": [1, 2], "b": ["x", "y", "z"]})
    loops = list(product(*(axis.values[name] for axis, name in zip(found, "ab", strict=True))))
    assert loops == [(a, b) for a in (1, 2) for b in "xyz"]

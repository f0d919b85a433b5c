"""The example mechanism files: each loads, equals the zoo's mechanism, and has its known verdict."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from example_files import FOLDER, same
from loop_zoo import EXAMPLES
from zoo import ZOO

from equipoise import Balance, Spring, check, load
from equipoise.energy.evaluate import Potential
from equipoise.kinematics import Tree, sample
from equipoise.report.figure import save_figure
from equipoise.synthesis import design

OF_THE_ZOO = {
    "pendulum": "exact_pendulum",
    "lenzo_layout_b": "lenzo_spherical",
    "lee_chen_arm": "lee_chen_arm",
    "parallelogram_lamp": "parallelogram_lamp",
    "geared_pair": "mirrored_pair",
}
OF_PAPERS = {
    "lin2010_arm",
    "lin2010_balanced",
    "lin2010_rssr",
    "bevel_shoulder",
    "bevel_balanced",
    "lee2014_table5a",
    "lee2014_table5b",
}
"""Their answers are known to test_lin2010, test_cho2012 and test_lee2014."""
MADE = EXAMPLES.FILES.keys() - OF_PAPERS  # by make.py; the bare DELTA apart, all are balanced
PROVED = {"four_bar": 1, "desk_lamp": 2, "pantograph": 2, "rssr": 4, "hexapod": 6, "delta_balanced": 3}
"""Mobilities."""
# pairs between which `convex` may put springs, and how far out
CONVEX = {
    "four_bar": ("world:crank,world:rocker", 0.3),
    "desk_lamp": ("world:lower arm,knee:upper arm", 0.2),
    "pantograph": ("world:lower bar,upper bar:inner bar", 0.5),
    "rssr": ("link 1 pseudobase:link 1,link 2 pseudobase:link 2", 0.4),
    "hexapod": ("world:platform,world:shin 1", 0.4),
    "delta": ("world:link 2.1,world:link 2.2,world:link 2.3", 0.45),
}


def test_every_file_has_a_known_answer() -> None:
    assert {path.stem for path in FOLDER.glob("*.yaml")} == OF_THE_ZOO.keys() | OF_PAPERS | MADE | {
        "telescope",
        "monitor_arm",
    }
    assert PROVED.keys() | {"delta"} == MADE


def test_a_compression_spring_in_a_telescopic_case_is_a_zero_free_length_spring() -> None:
    """Its length is 450 mm less the distance of pivot and arm, its free length 450 mm: the energy is k/2 distance^2."""
    telescope = load(FOLDER / "telescope.yaml")
    arm = replace(telescope, bodies=telescope.bodies[:1], joints=telescope.joints[:1], loops=(), independent=(),
                  assembly=(), springs=(Spring("s", "world", (0, 0, 0.2), "arm", (0.15, 0, 0), 196.2),))  # fmt: skip
    q = np.linspace(-1.3, 1.2, 9)[:, None]
    both = [Potential(m)(q) for m in (telescope, arm)]
    np.testing.assert_allclose(both[0].springs, both[1].springs, atol=1e-9)
    np.testing.assert_allclose(both[0].path[:, 0], 0.45 - both[1].path[:, 0], atol=1e-10)
    assert check(arm).exact
    balance = check(telescope, samples=200)
    assert balance.relative < 1e-8
    assert balance.passed == []
    low, _ = balance.use[0].path
    assert low > 0.095
    tight = telescope.with_springs([telescope.springs[0].changed(solid_length=low + 0.01)])
    assert [one.state.name for _, one in check(tight, samples=200).passed] == ["solid"]


@pytest.mark.parametrize("file", OF_THE_ZOO)
def test_is_the_mechanism_of_the_zoo(file: str) -> None:
    """Equal but for the last digit, which a conversion of units may change."""
    same(load(FOLDER / f"{file}.yaml"), ZOO[OF_THE_ZOO[file]]().mechanism, 1e-15, 0.0)


@pytest.mark.parametrize("file", OF_THE_ZOO)
def test_verdict(file: str) -> None:
    known = ZOO[OF_THE_ZOO[file]]()
    b = check(load(FOLDER / f"{file}.yaml"))
    assert b.exact == known.exact
    assert b.certificate.kind == "fourier"
    np.testing.assert_allclose(b.unbalanced.max, known.unbalanced, rtol=1e-9)
    np.testing.assert_allclose(b.residual.max, np.array(known.residual, float), rtol=1e-9, atol=1e-12)
    if known.energy is not None:
        assert b.constant == pytest.approx(known.energy, rel=1e-13)


@pytest.mark.parametrize("file", sorted(MADE))
def test_is_what_make_writes(file: str) -> None:
    same(load(FOLDER / f"{file}.yaml"), EXAMPLES.FILES[file](), 1e-9, 1e-9, provenance=False)


@cache
def judged(file: str) -> Balance:
    return check(load(FOLDER / f"{file}.yaml"), samples=256)


@pytest.mark.parametrize("file", PROVED)
def test_verdict_with_loops(file: str) -> None:
    b = judged(file)
    assert b.certificate.kind == "fourier"
    assert b.exact
    assert b.relative < 1e-10
    assert b.mobility is not None
    assert b.mobility.numerical == PROVED[file]
    assert b.unbalanced.max.max() > 1.0


@pytest.mark.parametrize("file", CONVEX)
def test_convex_works_with_loops(file: str) -> None:
    """Never worse than what the file has on these pairs, and the bound is below it."""
    mechanism = load(FOLDER / f"{file}.yaml")
    pairs, radius = CONVEX[file]
    chosen = [(a, b) for a, b in (pair.split(":") for pair in pairs.split(","))]
    found = design(mechanism, "convex", pairs=chosen, radius=radius, springs=3, samples=60)
    assert found.bound is not None
    assert found.bound <= found.residual < found.unbalanced
    q = sample(Tree.of(mechanism), 60)
    left, before = (
        float(np.sqrt((Potential(m)(q).torque ** 2).sum(axis=1).mean()))
        for m in (found.mechanism, mechanism.with_springs(()))
    )
    assert left == pytest.approx(found.residual, abs=1e-9 * before)
    if file in ("four_bar", "desk_lamp", "pantograph"):  # the file's own springs are on these pairs
        assert found.residual < 1e-9 * before


@pytest.mark.parametrize("file", ["four_bar", "rssr", "delta_balanced"])
def test_pictures_show_the_loops_closed(file: str, tmp_path: Path) -> None:
    b = judged(file)
    save_figure(b.mechanism, tmp_path / "picture.svg", balance=b)
    assert "nan" not in (tmp_path / "picture.svg").read_text().lower()

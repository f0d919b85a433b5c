"""The example mechanism files: each loads, equals the zoo's mechanism, and has its known verdict."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from zoo import ZOO

from equipoise import check, load

FOLDER = Path(__file__).parents[1] / "examples" / "mechanisms"
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
    "bevel_shoulder",
    "bevel_balanced",
    "lee2014_table5a",
    "lee2014_table5b",
}
"""Their answers are known to test_lin2010, test_cho2012 and test_lee2014."""


def flat(value: Any, path: str = "") -> dict[str, Any]:
    """Nested values as one dictionary."""
    if isinstance(value, dict):
        return {k: v for key, inner in value.items() for k, v in flat(inner, f"{path}.{key}").items()}
    if isinstance(value, (tuple, list)):
        return {k: v for i, inner in enumerate(value) for k, v in flat(inner, f"{path}[{i}]").items()}
    return {path: value}


def test_every_file_has_a_known_answer() -> None:
    assert {path.stem for path in FOLDER.glob("*.yaml")} == OF_THE_ZOO.keys() | OF_PAPERS


@pytest.mark.parametrize("file", OF_THE_ZOO)
def test_is_the_mechanism_of_the_zoo(file: str) -> None:
    """Equal but for the last digit, which a conversion of units may change."""
    found, expected = (flat(asdict(m)) for m in (load(FOLDER / f"{file}.yaml"), ZOO[OF_THE_ZOO[file]]().mechanism))
    assert found.keys() == expected.keys()
    for path, value in expected.items():
        assert found[path] == (pytest.approx(value, rel=1e-15, abs=0) if isinstance(value, float) else value), path


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

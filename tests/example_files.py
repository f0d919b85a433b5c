"""The example files, and whether a mechanism is what a file says."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pytest

from equipoise.model.mechanism import Mechanism

FOLDER = Path(__file__).parents[1] / "examples" / "mechanisms"


def flat(value: Any, path: str = "") -> dict[str, Any]:
    """Nested values as one dictionary."""
    if isinstance(value, dict):
        return {k: v for key, inner in value.items() for k, v in flat(inner, f"{path}.{key}").items()}
    if isinstance(value, (tuple, list)):
        return {k: v for i, inner in enumerate(value) for k, v in flat(inner, f"{path}[{i}]").items()}
    return {path: value}


def same(one: Mechanism, other: Mechanism, rel: float, absolute: float, provenance: bool = True) -> None:
    """Every field of both, their provenance too unless told otherwise; numbers to `rel` or `absolute`."""
    if not provenance:
        one, other = replace(one, provenance={}), replace(other, provenance={})
    found, expected = flat(asdict(one)), flat(asdict(other))
    assert found.keys() == expected.keys()
    for path, value in expected.items():
        close = pytest.approx(value, rel=rel, abs=absolute) if isinstance(value, float) else value
        assert found[path] == close, path

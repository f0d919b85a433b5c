"""Whatever a model holds: it is refused, something is said, or its torques are the engine's."""

from __future__ import annotations

import warnings
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from campaign import campaign
from engine import Engine
from random_models import RandomModel

import equipoise as eq
from equipoise.energy import Potential
from equipoise.kinematics import Tree
from equipoise.kinematics.sampling import sample
from equipoise.model.errors import EquipoiseWarning, InputError, SlipWarning

LOOPS = (6, 19, 74, 102, 106)
"""Seeds of models whose loops close."""


def outcome(path: Path) -> str:
    """What became of the model in a file; an error when torques differ though nothing was said."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            m = eq.load(path)
            tree = Tree.of(m)
            q = sample(tree, 2, 1)
        except InputError:
            return "refused"
    if any(issubclass(one.category, EquipoiseWarning) and one.category is not SlipWarning for one in caught):
        return "said"
    ours, theirs = Potential(m)(q).torque, Engine(path, m).torque(q)
    good = np.isfinite(ours).all(axis=1) & np.isfinite(theirs).all(axis=1)
    np.testing.assert_allclose(ours[good], theirs[good], atol=1e-9 * max(1, np.abs(theirs[good]).max(initial=0)))
    return "still" if not tree.n else "loops" if m.loops and good.any() else "tree" if good.any() else "open"


@campaign(600, block=60)
def test_torques_of_random_models_are_the_engines_or_something_is_said(seeds, tmp_path):
    found = Counter[str]()
    for seed in seeds:
        (tmp_path / "model.xml").write_text(RandomModel(seed).text)
        found[outcome(tmp_path / "model.xml")] += 1
    assert found["tree"] >= len(seeds) / 3  # enough is compared
    assert found["open"] <= len(seeds) / 10
    assert min(found["refused"], found["said"]) > 0


@pytest.mark.parametrize("seed", LOOPS)
def test_torques_with_loops_are_the_engines(seed, tmp_path):
    (tmp_path / "model.xml").write_text(RandomModel(seed).text)
    assert outcome(tmp_path / "model.xml") == "loops"

"""Robot files as they are found in packages: read or refused for a reason, with the torques of an independent code."""

from __future__ import annotations

import warnings
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from engine import Engine
from peers import peer, robot_files

import equipoise as eq
from equipoise.energy import Potential
from equipoise.kinematics import Tree
from equipoise.kinematics.sampling import sample
from equipoise.model.errors import EquipoiseWarning, InputError, SlipWarning

URDF = robot_files("example-robot-data", ".urdf")
MJCF = [path for name in ("gymnasium", "gymnasium-robotics") for path in robot_files(name, ".xml")]
installed = pytest.mark.skipif(not (URDF and MJCF), reason="the packages with robots are not installed")

REASONS = (
    "has no link",  # what is left of a file of macros
    "MuJoCo does not compile it",  # a part of a model, for others to include
    "is free, and nothing holds what it carries",  # a thing to be grasped, or a walking robot: --base fixed holds it
    "expected a URDF file, whose root element is <robot>, found <config>",
)
"""Why a file may be refused: each is a reason that a roboticist would agree with."""


@cache  # each MJCF file is compiled in a process of its own
def load(path: Path, base: str | None = None) -> tuple[eq.Mechanism | None, list[str]]:
    """The mechanism, and what was said while it was read; None and why where the file is refused."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            m = eq.load(path, base=base)
        except InputError as error:
            return None, [fault.message for fault in error.faults]
    said = [one for one in caught if issubclass(one.category, EquipoiseWarning)]
    return m, [str(one.message) for one in said if not issubclass(one.category, SlipWarning)]


@installed
@pytest.mark.parametrize("path", URDF, ids=lambda path: path.stem)
def test_urdf_agrees_with_pinocchio(path: Path) -> None:
    m, said = load(path)
    if m is None:
        assert path.name == "ur3.urdf", said  # all else is read
        assert any(reason in line for reason in REASONS for line in said)
        return
    q = np.random.default_rng(0).uniform(-1, 1, (5, Tree.of(m).n))
    ours, theirs = Potential(m)(q).torque, gravity_by_pinocchio(path, m, q)
    np.testing.assert_allclose(ours, theirs, atol=1e-9 * max(1, np.abs(ours).max(initial=0)))


def gravity_by_pinocchio(path: Path, m: eq.Mechanism, q: np.ndarray) -> np.ndarray:
    """(N, n) what holds it at `q` (N, n), followers projected on their leaders [N m or N]."""
    pin: Any = peer("pinocchio")
    model, tree = pin.buildModelFromUrdf(str(path)), Tree.of(m)
    data, row, found = model.createData(), {name: i for i, name in enumerate(tree.motions)}, np.zeros_like(q)
    for k, values in enumerate(tree.values(q)):
        x, rates = pin.neutral(model), np.zeros((model.nv, tree.n))
        for i in range(1, model.njoints):
            joint, value = model.joints[i], values[row[model.names[i]]]
            x[joint.idx_q : joint.idx_q + joint.nq] = value if joint.nq == 1 else (np.cos(value), np.sin(value))
            rates[joint.idx_v] = tree.C[row[model.names[i]]]
        found[k] = rates.T @ pin.computeGeneralizedGravity(model, data, x)
    return found


@installed
@pytest.mark.parametrize("path", MJCF, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_mjcf_agrees_with_the_engine_or_says_why_not(path: Path) -> None:
    m, said = load(path)
    if m is None and any("free" in line for line in said):
        m, said = load(path, base="fixed")
    if m is None:
        assert all(any(reason in line for reason in REASONS) for line in said), said
        return
    tree = Tree.of(m)
    if said or not tree.n:
        return
    q = sample(tree, 3, 1)
    ours, theirs = Potential(m)(q).torque, Engine(path, m).torque(q)
    np.testing.assert_allclose(ours, theirs, atol=1e-9 * max(1, np.abs(theirs).max(initial=0)))


@installed
def test_most_files_are_compared() -> None:
    """The tests above would also pass if everything were refused, or warned of."""
    assert sum(load(path)[0] is not None for path in URDF) >= 68
    read = [load(path) for path in MJCF]
    assert sum(m is not None and bool(m.coordinates) and not said for m, said in read) >= 20

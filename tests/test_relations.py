"""Linear relations between joint angles: they carry a branch through the poses where a parallelogram folds."""

from __future__ import annotations

import numpy as np
import pytest

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.kinematics import Linkage, Tree
from equipoise.kinematics.branch import Status
from equipoise.kinematics.relations import relations

CRANK, COUPLER = 0.2, 0.5  # [m]


def parallelogram() -> eq.Mechanism:
    """Two equal cranks about y and a coupler of a mass that stays level: it folds where the cranks are level."""
    Y = (0.0, 1.0, 0.0)
    return eq.Mechanism(
        "parallelogram",
        (eq.Body("crank", 1.0, (CRANK / 2, 0, 0)), eq.Body("coupler", 2.0, (0.1, 0, 0.2)), eq.Body("rocker")),
        (
            eq.Joint("crank", "revolute", "world", "crank", axis=Y),
            eq.Joint("coupler", "revolute", "crank", "coupler", (CRANK, 0, 0), axis=Y),
            eq.Joint("rocker", "revolute", "world", "rocker", (COUPLER, 0, 0), axis=Y),
        ),
        loops=(eq.Loop("coupler", (COUPLER, 0, 0), "rocker", (CRANK, 0, 0), Y, Y),),
        assembly=(("crank", 1.0), ("coupler", -1.0), ("rocker", 1.0)),
    )


def test_a_rational_relation_is_found_and_a_bent_one_is_not():
    u = np.random.default_rng(0).uniform(-0.05, 0.05, (40, 2))
    q = np.column_stack([u, 0.3 + 2 / 3 * u[:, 0] - u[:, 1], np.sin(u[:, 0]), u[:, 1] - 1e-3 * u[:, 0] ** 2])
    (found,) = relations(q, [True] * 5, "abcde", (0, 1))
    assert (found.joint, [name for name, _ in found.terms]) == ("c", ["a", "b"])
    np.testing.assert_allclose([ratio for _, ratio in found.terms], [2 / 3, -1])
    assert found.offset == pytest.approx(0.3)


def test_a_parallelogram_stays_one_beyond_where_it_folds():
    tree = Tree.of(parallelogram())
    assert isinstance(tree, Linkage)
    angles = np.linspace(-3.1, 3.1, 64)
    full, status = tree.branch.solve(angles[:, None])
    assert (status == Status.CLOSED).all()
    at = [tree.open.coordinates.index(name) for name in ("crank", "coupler", "rocker")]
    np.testing.assert_allclose(full[:, at], np.column_stack([angles, -angles, angles]), atol=1e-12)
    np.testing.assert_allclose(tree.branch.rates(full)[:, at, 0], np.tile([1, -1, 1], (64, 1)))
    assert tree.branch.solve(np.array([[0.0], [np.pi]]))[1].tolist() == [Status.SINGULAR, Status.SINGULAR]


def test_nothing_is_divided_by_nothing_near_a_fold():
    """The torque is that of the coupler's weight at the crank's end, however near to the fold."""
    m = parallelogram()
    angles = np.array([-1.0, -1e-3, -1e-5, 1e-5, 1e-3, 1.0])
    torque = Potential(m)(angles[:, None]).gravity_torque[:, 0]
    np.testing.assert_allclose(torque, -9.81 * (1.0 * CRANK / 2 + 2.0 * CRANK) * np.cos(angles), rtol=1e-9)
    assert eq.check(m).unbalanced.max[0] == pytest.approx(9.81 * 2.5 * CRANK, rel=1e-6)

"""Statistics in one pass against those of all poses at once."""

from __future__ import annotations

import numpy as np
import pytest
from loop_zoo import four_bar
from odd_mechanisms import coupled
from random_mechanisms import random_mechanism
from robots import robot

from equipoise.energy import Potential
from equipoise.energy.stream import CHUNK, Statistics, statistics
from equipoise.energy.tally import draw
from equipoise.kinematics import Tree, sample
from equipoise.kinematics.sampling import bounds, inside
from equipoise.model.errors import InputError, UnsupportedError
from equipoise.model.mechanism import Mechanism

MECHANISM = random_mechanism(8)


def poses(count: int, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-2, 2, (count, len(MECHANISM.coordinates)))


def matches(found: Statistics, q: np.ndarray, mechanism: Mechanism = MECHANISM) -> None:
    state = Potential(mechanism).reference(q)
    size = np.abs(state.torque)
    assert found.poses == len(q)
    np.testing.assert_allclose(found.max, size.max(axis=0), rtol=1e-12)
    np.testing.assert_allclose(found.rms, np.sqrt((size**2).mean(axis=0)), rtol=1e-12)
    np.testing.assert_allclose(found.energy, [state.energy.min(), state.energy.mean(), state.energy.max()], rtol=1e-12)
    np.testing.assert_array_equal(found.worst, q[size.argmax(axis=0)])
    for share, value in found.quantiles.items():
        exact = np.quantile(size, share, axis=0, method="inverted_cdf")
        np.testing.assert_allclose(value, exact, rtol=2e-3)


def test_from_an_iterator_of_arrays_of_any_size() -> None:
    q = poses(20_000)
    assert q.shape[1] > 1
    matches(statistics(MECHANISM, iter([q[:1], q[1:1], q[1:15_000], q[15_000:]])), q)


def test_arrays_longer_than_a_chunk_and_threads() -> None:
    q = poses(2 * CHUNK + 5)
    one, two = statistics(MECHANISM, [q]), statistics(MECHANISM, [q], threads=2)
    matches(one, q)
    np.testing.assert_array_equal(one.rms, two.rms)
    np.testing.assert_array_equal(one.worst, two.worst)


def test_from_a_parquet_file(tmp_path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    q = poses(5_000)
    columns = dict(zip(MECHANISM.coordinates, q.T, strict=True))
    table = pyarrow.table({"time": np.arange(len(q)), **dict(reversed(columns.items()))})
    parquet.write_table(table, tmp_path / "q.parquet", row_group_size=700)
    matches(statistics(MECHANISM, tmp_path / "q.parquet"), q)
    parquet.write_table(table.drop_columns([MECHANISM.coordinates[0]]), tmp_path / "less.parquet")
    with pytest.raises(InputError, match=MECHANISM.coordinates[0]):
        statistics(MECHANISM, str(tmp_path / "less.parquet"))


def test_random_poses_are_those_of_the_seed() -> None:
    ur5 = robot("ur5")
    count = CHUNK + 1000
    one, two = statistics(ur5, count, seed=3), statistics(ur5, count, seed=3, threads=2)
    np.testing.assert_array_equal(one.rms, two.rms)
    assert one.poses == count
    other = statistics(ur5, count, seed=4)
    assert (one.rms[1:3] != other.rms[1:3]).all()
    np.testing.assert_allclose(one.rms, other.rms, rtol=0.02, atol=1e-9)


def test_random_numbers_are_splitmix64s() -> None:
    """Against the published recurrence on Python's whole numbers, however the poses are cut into blocks."""
    seed, n, count, mask = 0x123456789ABCDEF0, 3, 50, 2**64 - 1
    expected, state = [], seed
    for _ in range(n * count):
        state = (state + 0x9E3779B97F4A7C15) & mask
        z = ((state ^ (state >> 30)) * 0xBF58476D1CE4E5B9) & mask
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
        expected.append(((z ^ (z >> 31)) >> 11) / 2**53)
    lower, width = np.array([0.0, -1.0, 2.0]), np.array([1.0, 2.0, 0.5])
    q = np.empty((n, count))
    for first, last in ((0, 20), (20, count)):
        part = np.empty((n, last - first))
        draw(np.uint64(seed), first, lower, width, part)
        q[:, first:last] = part
    np.testing.assert_array_equal(q.T, lower + width * np.array(expected).reshape(count, n))


def test_statistics_do_not_depend_on_the_number_of_threads() -> None:
    count = 3 * CHUNK + 77
    one, *others = (statistics(MECHANISM, count, seed=5, threads=threads) for threads in (1, 2, 3))
    assert one.poses == count
    assert all(other == one for other in others)


def test_random_poses_keep_the_ranges_of_dependent_joints() -> None:
    arm = coupled(-2.0, 3.0)
    tree = Tree.of(arm)
    assert not inside(tree, np.random.default_rng(0).uniform(*bounds(tree), (1000, tree.n))).all()
    found = statistics(arm, 2000)
    assert inside(tree, found.worst).all()
    matches(found, sample(tree, 2000, (0, 0)), arm)


def test_poses_that_are_no_numbers_are_left_out() -> None:
    q = poses(1000)
    spoiled = q.copy()
    spoiled[3, 0], spoiled[999, 1] = np.nan, np.inf
    found = statistics(MECHANISM, [spoiled])
    assert found.skipped == 2
    matches(found, np.delete(q, [3, 999], axis=0))


def test_errors() -> None:
    with pytest.raises(InputError, match="no pose"):
        statistics(MECHANISM, [])
    with pytest.raises(InputError, match="between 0 and 1"):
        statistics(MECHANISM, 10, quantiles=[1.0])
    with pytest.raises(InputError, match="at least 1"):
        statistics(MECHANISM, 0)
    with pytest.raises(UnsupportedError, match="loops"):
        statistics(four_bar(), 10)

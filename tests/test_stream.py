"""Statistics in one pass against those of all poses at once."""

from __future__ import annotations

import numpy as np
import pytest
from loop_zoo import four_bar
from random_mechanisms import random_mechanism
from robots import robot

from equipoise.energy import Potential
from equipoise.energy.stream import CHUNK, Statistics, statistics
from equipoise.model.errors import InputError, UnsupportedError

MECHANISM = random_mechanism(8)


def poses(count: int, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-2, 2, (count, len(MECHANISM.coordinates)))


def matches(found: Statistics, q: np.ndarray) -> None:
    state = Potential(MECHANISM).reference(q)
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

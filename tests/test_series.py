"""Arithmetic of series: whatever is done to them, their values at a configuration follow."""

from __future__ import annotations

import numpy as np
import pytest

from equipoise.energy.fourier.series import Series

N = 3  # coordinates


def random_series(rng: np.random.Generator, shape: tuple[int, ...], terms: int = 6) -> Series:
    frequencies, degrees = rng.integers(-1, 2, (terms, N)), rng.integers(0, 2, (terms, N))
    coef = rng.normal(size=(terms, *shape)) + 1j * rng.normal(size=(terms, *shape))
    return Series(np.hstack([frequencies, degrees]).astype(np.int32), coef)


def value(series: Series, q: np.ndarray) -> np.ndarray:
    """The sum, term by term, by its definition."""
    total = np.zeros(series.coef.shape[1:], complex)
    for key, coef in zip(series.keys, series.coef, strict=True):
        factor = 1.0 + 0j
        for j in range(N):
            factor *= q[j] ** int(key[N + j]) * np.exp(1j * key[j] * q[j])
        total += coef * factor
    return total


@pytest.mark.parametrize("seed", range(20))
def test_arithmetic(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b, c = random_series(rng, (2, 3)), random_series(rng, (2, 3)), random_series(rng, (3, 4))
    for q in rng.uniform(-2, 2, (3, N)):
        np.testing.assert_allclose(value(Series.sum([a, b]), q), value(a, q) + value(b, q), atol=1e-12)
        np.testing.assert_allclose(value(a @ c, q), value(a, q) @ value(c, q), atol=1e-11)
        np.testing.assert_allclose(value((a @ c).collected(), q), value(a, q) @ value(c, q), atol=1e-11)
        np.testing.assert_allclose(value(a.scaled(2 - 1j), q), (2 - 1j) * value(a, q), atol=1e-12)
        np.testing.assert_array_equal(value(a.T, q), value(a, q).T)
        np.testing.assert_array_equal(value(Series.constant(np.eye(2), N), q), np.eye(2))


def test_collected_has_each_term_once_in_order() -> None:
    keys = np.array([[1, 0, 0, 0, 0, 2], [-1, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0, 2], [0, 0, 0, 0, 0, 0]], np.int32)
    found = Series(keys, np.array([1, 2, 4, 8], complex)).collected()
    assert found.keys.tolist() == [[-1, 0, 0, 0, 0, 0], [0] * 6, [1, 0, 0, 0, 0, 2]]
    assert found.coef.tolist() == [2, 8, 5]
    np.testing.assert_array_equal(found.collected().coef, found.coef)


def test_constants_collect_to_one_term() -> None:
    total = Series.sum([Series.constant(np.eye(2), N)] * 3)
    assert len(total) == 1
    np.testing.assert_array_equal(total.coef[0], 3 * np.eye(2))
    assert len(Series.sum([Series.constant(1.0, 0)] * 2)) == 1  # over no coordinates at all

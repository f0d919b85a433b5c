"""The distance between segments, vectorised; with radii, between capsules.

The squared distance is a convex quadratic of the two positions along the segments, over a square. So its least value is
at the critical point when that lies inside, else on an edge: one of four distances of an end point. All five are
evaluated and the smallest taken, which needs no tolerance for parallel segments: a badly conditioned critical point is
only one candidate more, and every candidate is a true distance.
"""

from __future__ import annotations

import numpy as np

from ..model.arrays import Array


def closest(a: Array, b: Array, c: Array, d: Array) -> tuple[Array, Array, Array]:
    """Segments a-b and c-d, (..., 3) each [m], shapes that broadcast; a segment may be a point.

    Returns:
        Distance (...) [m], and where it is: ``a + s (b - a)`` and ``c + t (d - c)``, s and t (...) from 0 to 1.
    """
    a, b, c, d = np.broadcast_arrays(a, b, c, d)
    u, v, w = b - a, d - c, a - c
    uu, uv, vv = _dot(u, u), _dot(u, v), _dot(v, v)
    uw, vw = _dot(u, w), _dot(v, w)
    zero, one = np.zeros_like(uu), np.ones_like(uu)
    inside = _unit((uv * vw - vv * uw), uu * vv - uv**2)
    s = np.stack([inside, zero, one, _unit(-uw, uu), _unit(uv - uw, uu)])
    t = np.stack([_unit(vw + inside * uv, vv), _unit(vw, vv), _unit(vw + uv, vv), zero, one])
    squared = _dot(*[w + s[..., None] * u - t[..., None] * v] * 2)
    best = squared.argmin(axis=0)[None]
    distance, s, t = (np.take_along_axis(x, best, axis=0)[0] for x in (np.sqrt(squared), s, t))
    return distance, s, t


def _dot(x: Array, y: Array) -> Array:
    return np.einsum("...i,...i", x, y)


def _unit(numerator: Array, denominator: Array) -> Array:
    """The quotient, at most 1 and at least 0; 0 where it is undefined."""
    safe = np.where(denominator > 0, denominator, 1.0)
    return np.where(denominator > 0, np.clip(numerator / safe, 0.0, 1.0), 0.0)

"""The coordinates of its own that a search moves in within a region, and the regions of a problem's bodies."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..model.arrays import Array, Booleans
from ..model.errors import Fault, InputError
from ..model.mechanism import Mechanism
from ..model.region import Region, Shape
from ..model.units import Amount

__all__ = ["Given", "Region", "free_directions", "given_regions", "nearest_region", "plain_regions", "project"]

RIM = 1 - 1e-12  # in a region's own coordinates: on its boundary
Given = Region | Amount | Iterable[Region]
"""A region, a radius [m], or regions that are a union."""


def given_regions(
    mechanism: Mechanism, given: Mapping[str, Given], shape: Shape = "ball"
) -> dict[str, tuple[Region, ...]]:
    """The regions of each body: those given, else those that the mechanism's file names; joints as centres found.

    Raises:
        InputError: a joint that is not on the body, or a body without any region.
    """
    every: dict[str, tuple[Region, ...]] = {}
    for one in mechanism.attachments:
        every[one.body] = (*every.get(one.body, ()), one.region)
    for body, own in given.items():
        several = (Region.of(own, body, shape),) if isinstance(own, (Region, str, float, int)) else tuple(own)
        if not several:
            raise InputError(Fault(("regions", body), "there is none; leave the body out for the default"))
        every[body] = several
    try:
        return {
            body: tuple(dict.fromkeys(one.on(body, mechanism.joints) for one in own)) for body, own in every.items()
        }
    except InputError as error:
        raise InputError(replace(fault, path=("regions",)) for fault in error.faults) from None


def plain_regions(regions: Sequence[Region]) -> object:
    """As plain data: one region by itself, several as a list."""
    return regions[0].to_dict() if len(regions) == 1 else [region.to_dict() for region in regions]


def nearest_region(regions: Iterable[Region], p: Iterable[float]) -> Region:
    """The region that a point [m] is in, or is least outside of, as a share of the regions' sizes."""
    point = np.array(tuple(p))

    def outside(region: Region) -> float:
        half = np.array(region.half)
        off = np.abs(point - region.at)
        return float(np.linalg.norm(off) - half[0] if region.shape == "ball" else np.maximum(off - half, 0.0).max())

    return min(regions, key=lambda region: max(outside(region), 0.0))


def project(u: Array, is_box: Booleans) -> Array:
    """The nearest point of each region: the unit box or the unit ball. u: (..., d), is_box: (...)."""
    if is_box.all():
        return np.clip(u, -1, 1)
    norm = np.linalg.norm(u, axis=-1, keepdims=True)
    return np.where(is_box[..., None], np.clip(u, -1, 1), u / np.maximum(norm, 1.0))


def free_directions(u: Array, gradient: Array, is_box: Booleans) -> Array:
    """(..., d, d) projectors onto the steps that do not leave a region through its boundary, downhill of `gradient`."""
    side, outward = np.eye(u.shape[-1]), gradient * u
    keep_box = np.where((np.abs(u) >= RIM) & (outward < 0), 0.0, 1.0)[..., None] * side
    if is_box.all():
        return keep_box
    at_rim = ((u * u).sum(axis=-1) >= RIM**2) & (outward.sum(axis=-1) < 0)
    keep_ball = side - np.where(at_rim[..., None, None], u[..., :, None] * u[..., None, :], 0.0)
    return np.where(is_box[..., None, None], keep_box, keep_ball)

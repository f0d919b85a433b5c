"""Monte Carlo over builds: how large the residual torque gets, whether friction holds it, and what matters most."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np

from ..io import Source, loaded
from ..kinematics import Tree, sample
from ..model.arrays import Array, frozen
from ..model.coordinate import Coordinate
from ..model.errors import Fault, InputError, nearest
from ..model.mechanism import Mechanism
from ..model.notebook import Shown
from ..model.progress import Progress, silent
from ..model.units import Amount, quantity
from ..model.validate import MAX_NUMBERS, MAX_SAMPLES, whole_number
from ..synthesis.mounts import Mounts
from .scatter import Scatter, ScatteredValue
from .torque_map import TorqueMap

MOST_WORK = 1_000_000_000  # builds times poses: some minutes
CHUNK_ENTRIES = 1_500_000  # torques held at a time: they stay in the cache
PERCENTILES = (5, 50, 95, 99)


@frozen
class Tolerance(Shown):
    """What scatter does to a design.

    Attributes:
        peak: (builds, n) the largest residual torque of each build over the poses [N m or N].
        friction: coordinate -> what its joint holds [N m or N].
        nominal: (n,) peak of the drawing itself.
        mean, spread: (n N,) of the torque at every pose over the builds, coordinate by coordinate.
        first_order: (n N,) the spread by first-order propagation.
        share: (parameters,) of the mean square torque that scatter causes: the first-order Sobol index of the torque
            over the poses, from derivatives; they sum to 1.
    """

    mechanism: Mechanism
    scatter: Scatter
    poses: int
    seed: int
    parameters: tuple[ScatteredValue, ...]
    peak: Array
    friction: Mapping[str, float]
    nominal: Array
    mean: Array
    spread: Array
    first_order: Array
    share: Array

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        return Tree.of(self.mechanism).coordinates

    @cached_property
    def margin(self) -> Array:
        """(builds, coordinates with friction) friction less peak; negative where a pose is not held."""
        index = [self.coordinates.index(name) for name in self.friction]
        return np.array(list(self.friction.values())) - self.peak[:, index]

    @property
    def yield_(self) -> float | None:
        """The share of builds that friction holds at every pose; None without friction."""
        return float((self.margin >= 0).all(axis=1).mean()) if self.friction else None

    @property
    def agreement(self) -> float:
        """Root mean square spread over the poses, Monte Carlo over first order."""
        first = float(np.sqrt(np.mean(self.first_order**2)))
        return float(np.sqrt(np.mean(self.spread**2))) / first if first else 1.0

    @cached_property
    def by_kind(self) -> dict[str, float]:
        """The shares of all stiffnesses, attachments, masses and lengths together, largest first."""
        total: dict[str, float] = {}
        for parameter, share in zip(self.parameters, self.share, strict=True):
            total[parameter.kind] = total.get(parameter.kind, 0.0) + float(share)
        return dict(sorted(total.items(), key=lambda item: -item[1]))

    @cached_property
    def ranked(self) -> list[tuple[ScatteredValue, float]]:
        """Every parameter with its share, largest first."""
        return [(self.parameters[i], float(self.share[i])) for i in np.argsort(-self.share, kind="stable")]

    def to_dict(self) -> dict[str, Any]:
        """The JSON object of ``equipoise tolerance --json``."""
        return {
            "mechanism": self.mechanism.name,
            "builds": len(self.peak),
            "poses": self.poses,
            "seed": self.seed,
            "scatter": self.scatter.to_dict(),
            "coordinates": list(self.coordinates),
            "peak": {"nominal": self.nominal.tolist(), **_statistics(self.peak)},
            "friction": dict(self.friction),
            "margin": dict(zip(self.friction, _columns(self.margin), strict=True)),
            "yield": self.yield_,
            "first_order": {
                "largest_spread": float(self.first_order.max(initial=0)),
                "spread_ratio": self.agreement,
            },
            "share": {
                "kinds": self.by_kind,
                "parameters": [{"name": p.name, "kind": p.kind, "share": share} for p, share in self.ranked],
            },
        }


def tolerance(
    mechanism: Source,
    scatter: Scatter | None = None,
    *,
    builds: int = 100_000,
    poses: int = 1000,
    friction: Mapping[str, Amount] | Amount | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> Tolerance:
    """Build a design many times over.

    Args:
        mechanism: or the path of its file.
        scatter: what is off by how much; the usual by default.
        poses: random ones, the same for all builds; a peak is the largest over them.
        friction: what every turning joint holds [N m], or coordinate -> torque [N m] or force [N].

    Raises:
        InputError: a bad option, nothing moves, or nothing scatters.
        UnsupportedError: lengths scatter and the mechanism has loops.
    """
    mechanism = loaded(mechanism)
    whole_number("builds", builds, 2, MAX_SAMPLES)
    whole_number("poses", poses, 1, min(MAX_SAMPLES, MOST_WORK // builds, MAX_NUMBERS // _numbers(mechanism)))
    whole_number("seed", seed, 0)
    tree = Tree.of(mechanism)
    if not tree.n:
        raise InputError(f"mechanism '{mechanism.name}': nothing moves, so nothing has to be held")
    held = _friction(friction, tree)
    scatter = scatter or Scatter()
    torque = TorqueMap(mechanism, sample(tree, poses, seed), scatter)
    if not torque.parameters:
        raise InputError("nothing scatters: give at least one scatter of more than 0")
    rows = tree.n * poses
    peak, mean, square = np.empty((builds, tree.n)), np.zeros(rows), np.zeros(rows)
    rng, size = np.random.default_rng(seed), max(16, CHUNK_ENTRIES // rows)
    nominal, report = torque.nominal.astype(np.float32)[:, None], progress or silent
    for start in range(0, builds, size):
        count = min(size, builds - start)
        tau = torque(scatter.draw(rng, count, len(torque.parameters)) * torque.deviation)
        peak[start : start + count] = np.maximum(*(f(tau.reshape(tree.n, poses, count)) for f in (_top, _low))).T
        tau -= nominal  # a variance about the drawing loses nothing to rounding
        mean += tau.sum(axis=1)
        square += np.einsum("rb,rb->r", tau, tau)
        report("building", (start + count) / builds)
    mean /= builds
    J = torque.jacobian()
    weight = np.where(tree.turns, 1.0, Mounts.of(mechanism).reach).repeat(poses)[:, None]
    cause = np.sum((weight * J) ** 2, axis=0)
    return Tolerance(
        mechanism=mechanism,
        scatter=scatter,
        poses=poses,
        seed=seed,
        parameters=torque.parameters,
        peak=peak,
        friction=held,
        nominal=np.abs(torque.nominal.reshape(tree.n, poses)).max(axis=1),
        mean=torque.nominal + mean,
        spread=np.sqrt(np.maximum(square / builds - mean**2, 0.0)),
        first_order=np.sqrt(np.sum(J**2, axis=1)),
        share=cause / (cause.sum() or 1.0),
    )


def _top(tau: Array) -> Array:
    return tau.max(axis=1)


def _low(tau: Array) -> Array:
    return -tau.min(axis=1)


def _friction(given: Mapping[str, Amount] | Amount | None, tree: Tree) -> dict[str, float]:
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        given = {coordinate: given for coordinate in tree.coordinates if coordinate.turns}
    held = {}
    for name, value in given.items():
        if name not in tree.coordinates:
            problem = f"there is no coordinate {nearest(name, tree.coordinates)}"
            raise InputError(Fault(("friction",), problem, tree.coordinates))
        load = tree.coordinates[tree.coordinates.index(name)].load
        held[name] = quantity(value, load, "friction", name)
        if held[name] < 0:
            raise InputError(Fault(("friction", name), f"must be finite and at least 0, found {held[name]:g}"))
    return held


def _statistics(values: Array) -> dict[str, Any]:
    """Of (builds, n): what JSON says, a list over the coordinates each."""
    found = {"mean": values.mean(axis=0), "spread": values.std(axis=0), "max": values.max(axis=0)}
    found |= {f"p{p}": row for p, row in zip(PERCENTILES, np.percentile(values, PERCENTILES, axis=0), strict=True)}
    return {name: row.tolist() for name, row in found.items()}


def _columns(values: Array) -> list[dict[str, float]]:
    statistics = _statistics(values)
    statistics.pop("max", None)
    statistics["min"] = values.min(axis=0).tolist()
    return [{name: row[i] for name, row in statistics.items()} for i in range(values.shape[1])]


def _numbers(mechanism: Mechanism) -> int:
    """Derivatives that are held for each pose, about: every coordinate's torque by everything that may be off."""
    off = 7 * len(mechanism.springs) + 4 * (len(mechanism.bodies) + len(mechanism.masses)) + 3 * len(mechanism.joints)
    return max(1, len(mechanism.coordinates) * off)

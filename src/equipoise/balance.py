"""The verdict: is a mechanism with its springs balanced, exactly or how nearly, and where is it worst?

Everything is computed from the mechanism alone, so that no design method has to be trusted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from functools import cached_property
from math import inf
from typing import Any

import numpy as np

from .energy.certificate import AFFORDABLE, Certificate, proof_of
from .energy.evaluate import Potential
from .energy.exactness import EXACT
from .energy.extremes import climb
from .energy.fourier.energy import FourierEnergy
from .energy.reference import State
from .energy.spring_use import Reached, SpringUse, uses
from .io import Source, loaded
from .kinematics import Linkage, Mobility, Tree, sample
from .kinematics.singular import Avoided, Singular
from .model.arrays import Array, frozen
from .model.coordinate import Coordinate
from .model.elements import Element
from .model.errors import InputError
from .model.mechanism import Mechanism
from .model.notebook import Shown
from .model.payload import Payload
from .model.units import Amount, quantity, share
from .model.validate import MAX_NUMBERS, MAX_SAMPLES, whole_number

Range = tuple[float, float]


@frozen
class Loads:
    """Of each coordinate's holding torque [N m or N]: the largest magnitude and the root mean square, (n,) each."""

    max: Array
    rms: Array


@frozen
class Balance(Shown):
    """What is true of a mechanism with its springs.

    Attributes:
        exact: the certificate proves that the energy is constant, to 1e-10 of what is to be balanced (`exactness`).
        unbalanced: torque of gravity alone.
        residual: torque of gravity and springs.
        bound: (n,) proved bound of the residual torque [N m or N], None without a Fourier form of affordable length.
        constant: mean of the total energy over the poses [J].
        gravity: smallest and largest gravity energy [J].
        springs: the same of all springs together.
        total: the same of both together.
        worst_configuration: (n,) the pose of the largest residual torque [rad or m].
        worst_torque: (n,) the torque there [N m or N].
        use: of each spring, how long it gets and how hard it pulls.
        singular: a singular pose of its loops inside the ranges, if one was met.
    """

    mechanism: Mechanism
    exact: bool
    certificate: Certificate
    unbalanced: Loads
    residual: Loads
    bound: Array | None
    constant: float
    gravity: Range
    springs: Range
    total: Range
    worst_configuration: Array
    worst_torque: Array
    use: tuple[SpringUse, ...]
    singular: Singular | None = None

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """The independent coordinates, in the file's order: names that know their units."""
        return Tree.of(self.mechanism).coordinates

    @property
    def units(self) -> tuple[str, ...]:
        """ "rad" or "m" for each coordinate; its torque is in N m or N."""
        return tuple(coordinate.unit for coordinate in self.coordinates)

    @property
    def mobility(self) -> Mobility | None:
        """How many ways a mechanism with loops can move; None without loops."""
        tree = Tree.of(self.mechanism)
        return tree.mobility if isinstance(tree, Linkage) else None

    @property
    def passed(self) -> list[tuple[str, Reached]]:
        """The names of springs that pass a limit inside the workspace, and which."""
        used = zip(self.mechanism.springs, self.use, strict=True)
        return [(spring.name, one) for spring, use in used for one in use.reached if one.state.limit]

    @property
    def unmade(self) -> list[tuple[str, str]]:
        """The names of springs that what they are made of does not give, each with what is wrong there."""
        made = (
            (one.name, one.law.comparison(*use.path)) for one, use in zip(self.mechanism.springs, self.use, strict=True)
        )
        return [(name, fault) for name, found in made if found is not None for fault in found.faults]

    @cached_property
    def relative(self) -> float:
        """Largest residual torque of any coordinate over the largest unbalanced one of the same unit (inf over 0)."""
        return largest_share(self.residual.max, self.unbalanced.max, self.coordinates)

    def balanced(self, tolerance: Amount = EXACT, torque: Amount | None = None) -> bool:
        """Whether it is exact, or the residual stays within a share of the unbalanced torque, or within `torque`."""
        if torque is not None:
            left, most = float(self.residual.max.max(initial=0)), quantity(torque, "torque", "torque")
        else:
            left, most = self.relative, share(tolerance, "tolerance", most=inf)
        return self.exact or left <= most

    def to_dict(self) -> dict[str, Any]:
        """The JSON object of ``equipoise check --json`` (plain numbers, lists and text)."""
        coordinates = self.coordinates
        return {
            "mechanism": self.mechanism.name,
            "coordinates": list(coordinates),
            "mobility": None if self.mobility is None else asdict(self.mobility),
            "singular": None if self.singular is None else self.singular.to_dict(),
            "exact": self.exact,
            "certificate": {
                "kind": self.certificate.kind,
                "terms": self.certificate.terms,
                "max_coefficient": self.certificate.max_coefficient,
                "distance": None if self.certificate.distance is None else self.certificate.distance.relative,
                "varies": None if self.certificate.distance is None else self.certificate.distance.varies,
                "samples": self.certificate.samples,
                "reason": self.certificate.reason,
            },
            "energy": {
                "constant": self.constant,
                "gravity": list(self.gravity),
                "springs": list(self.springs),
                "total": list(self.total),
            },
            "torque": {
                "unbalanced": {"max": self.unbalanced.max.tolist(), "rms": self.unbalanced.rms.tolist()},
                "residual": {"max": self.residual.max.tolist(), "rms": self.residual.rms.tolist()},
                "bound": [None] * len(coordinates) if self.bound is None else self.bound.tolist(),
            },
            "worst": {"configuration": self.worst_configuration.tolist(), "torque": self.worst_torque.tolist()},
            "springs": [use.to_dict(spring) for spring, use in zip(self.mechanism.springs, self.use, strict=True)],
        }


@np.errstate(over="ignore", invalid="ignore")  # what overflows is an error at the end
def check(mechanism: Source, *, samples: int | None = None, seed: int = 0, max_terms: int = AFFORDABLE) -> Balance:
    """Judge a mechanism with its springs.

    Args:
        mechanism: or the path of its file.
        samples: random poses; the mechanism's workspace says how many by default.
        max_terms: a longer Fourier form is not written out. Exactness is decided all the same, but `bound` is None.

    Raises:
        InputError: its loops cannot be closed, the ranges of its joints contradict each other, or its numbers are so
            large that they overflow; or as `load`.
    """
    mechanism = loaded(mechanism)
    tree = Tree.of(mechanism)
    samples = mechanism.workspace.samples if samples is None else samples
    held = 2 * (3 * tree.n + 2 * len(mechanism.springs) + 6)  # numbers for each sample
    whole_number("samples", samples, 1, min(MAX_SAMPLES, MAX_NUMBERS // held))
    whole_number("seed", seed, 0)
    singular = Avoided(tree)
    q = singular.without(sample(tree, samples, seed))
    potential = Potential(mechanism)
    state = potential(q)
    proof, reason = proof_of(mechanism, max_terms)
    series = proof if isinstance(proof, FourierEnergy) else None

    # every reported extreme climbs on its own: torques, energies both ways, lengths both ways
    def quantities(s: State) -> Array:
        sums = np.stack([s.gravity, s.springs.sum(axis=1), s.energy], axis=1)
        return np.hstack([np.abs(s.gravity_torque), np.abs(s.torque), sums, -sums, s.path, -s.path])

    best, best_q = climb(tree, lambda x: singular.nowhere(x, quantities(potential(x))), q, seed)
    n = tree.n
    unbalanced, residual, top, low, _ = np.split(best, np.cumsum([n, n, 3, 3]))
    worst = best_q[n + int(residual.argmax())] if n else q[0]
    unbalanced_rms, residual_rms = _rms(state.gravity_torque), _rms(state.torque)
    # with loops the bound is one of the open tree's coordinates, not of the actuators
    bound = None if series is None or mechanism.loops else series.torque_bound()
    proved = [] if proof is None else [proof.distance.varies, proof.distance.scale]
    bounds = [] if bound is None else [bound]
    if not all(np.isfinite(found).all() for found in (best, unbalanced_rms, residual_rms, *proved, *bounds)):
        raise InputError(f"mechanism '{mechanism.name}' has numbers so large that its energies overflow")
    ranges = [(-float(minus), float(plus)) for minus, plus in zip(low, top, strict=True)]
    return Balance(
        mechanism=mechanism,
        exact=proof is not None and proof.exact,
        certificate=Certificate.of(proof, reason, len(q)),
        unbalanced=Loads(unbalanced, unbalanced_rms),
        residual=Loads(residual, residual_rms),
        bound=bound,
        constant=float(state.energy.mean()),
        gravity=ranges[0],
        springs=ranges[1],
        total=ranges[2],
        worst_configuration=worst,
        worst_torque=potential(worst).torque[0],
        use=uses(mechanism, q, state.path, best[2 * n + 6 :], best_q[2 * n + 6 :]),
        singular=singular.found(samples - len(q)),
    )


def judged(given: Balance | Source) -> Balance:
    """The verdict itself, or the one on a mechanism or on the file of one."""
    return given if isinstance(given, Balance) else check(given)


def payload_residual(payload: Payload, mechanism: Mechanism, springs: Sequence[Element]) -> dict[str, float]:
    """Peak residual torque of each coordinate [N m or N] that springs leave at either end of a range of payload."""
    low, high = (check(payload.on(mechanism, mass).with_springs(springs)) for mass in (payload.low, payload.high))
    return dict(zip(low.coordinates, np.maximum(low.residual.max, high.residual.max).tolist(), strict=True))


def largest_share(residual: Array, unbalanced: Array, coordinates: Sequence[Coordinate]) -> float:
    """The largest of (n,) residual torques over the largest unbalanced one of the same unit (inf over 0)."""
    shares, turns = [0.0], np.array([coordinate.turns for coordinate in coordinates], bool)
    for kind in (turns, ~turns):
        left, whole = (float(x[kind].max(initial=0)) for x in (residual, unbalanced))
        if left > 0:
            shares.append(left / whole if whole > 0 else np.inf)
    return max(shares)


def _rms(torque: Array) -> Array:
    return np.sqrt(np.mean(torque**2, axis=0))

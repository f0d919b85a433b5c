"""An adjustment at payloads of its range: where the ends are, and what is left at each joint, moved and unmoved."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..energy.certificate import proof_of
from ..energy.evaluate import Potential
from ..model.arrays import Array, frozen
from ..model.mechanism import Mechanism
from ..model.payload import Payload
from .moves import Handle, value


@frozen
class Step:
    """One payload.

    Attributes:
        payload: [kg].
        places: of each move the attachment (3,) or free length (1,) [m].
        exact: balance is proved for this payload.
        unmoved, moved: (n,) largest torque at the poses [N m or N], as the design is and adjusted.
    """

    payload: float
    places: tuple[Array, ...]
    exact: bool
    unmoved: Array
    moved: Array

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "payload": self.payload,
            "places": [place.tolist() for place in self.places],
            "exact": self.exact,
            "unmoved": self.unmoved.tolist(),
            "moved": self.moved.tolist(),
        }


def step(
    design: Mechanism, adjusted: Mechanism, handles: Sequence[Handle], payload: Payload, mass: float, q: Array
) -> Step:
    """Of the design as it is, and adjusted for a payload of `mass` [kg], at poses q (N, n)."""
    unmoved, moved = (np.abs(Potential(payload.on(one, mass))(q).torque).max(axis=0) for one in (design, adjusted))
    proof = proof_of(payload.on(adjusted, mass))[0]
    places = tuple(value(adjusted, handle) for handle in handles)
    return Step(mass, places, proof is not None and proof.exact, unmoved, moved)

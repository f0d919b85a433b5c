"""A design under a range of payloads: what fixed springs leave at each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..balance import Balance, check
from ..io import Source, loaded
from ..model.notebook import Shown
from ..model.payload import Payload
from ..model.validate import whole_number


@dataclass(frozen=True)
class Sweep(Shown):
    """The verdict at each payload [kg]."""

    payloads: tuple[float, ...]
    balances: tuple[Balance, ...]

    @property
    def worst(self) -> Balance:
        """The verdict at the payload with the largest residual torque."""
        return max(self.balances, key=lambda balance: float(balance.residual.max.max(initial=0)))

    def to_dict(self) -> dict[str, Any]:
        return {
            "payloads": list(self.payloads),
            "residual": [balance.residual.max.tolist() for balance in self.balances],
            "exact": [balance.exact for balance in self.balances],
        }


def sweep(mechanism: Source, payload: Payload, *, steps: int = 5) -> Sweep:
    """Judge fixed springs of a mechanism or a file at `steps` payloads of the range, its ends among them.

    Raises:
        InputError: not a number of steps.
    """
    mechanism = loaded(mechanism)
    whole_number("steps", steps, 2, 1000)
    payloads = np.linspace(payload.low, payload.high, steps if payload.high > payload.low else 1).tolist()
    return Sweep(tuple(payloads), tuple(check(payload.on(mechanism, mass)) for mass in payloads))

"""What joint friction forgives: it holds a pose while the residual torque stays below it (the torque margin)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..balance import Balance, check


def torque_margin(balance: Balance, friction: Mapping[str, float]) -> dict[str, Any]:
    """How much friction is left over at the worst pose of the workspace, and how wrong the springs may be.

    Args:
        friction: coordinate -> friction torque [N m] or force [N].

    Returns:
        ``margin``: coordinate -> friction less the largest residual; negative where friction does not hold it.
        ``spring_error``: spring -> by which share its stiffness alone may be wrong with every pose still held, and
        under "all springs" by which they may all be, in the same direction; 0 where the margin is negative, None for
        a spring that does not load these coordinates. Where there is a residual the shares are on the safe side: the
        worst poses are taken as the same.
    """
    m = balance.mechanism
    index = [m.coordinates.index(name) for name in friction]
    margin = np.array(list(friction.values())) - balance.residual.max[index]
    weightless = replace(m, gravity=(0.0, 0.0, 0.0), provenance={})
    groups = {spring.name: (spring,) for spring in m.springs} | {"all springs": m.springs}
    errors = {}
    for name, springs in groups.items():
        load = check(weightless.with_springs(springs)).residual.max[index]
        shares = np.divide(margin, load, out=np.full(len(load), np.inf), where=load > 0)
        least = float(shares.min(initial=np.inf))
        errors[name] = max(0.0, least) if least < np.inf else None
    return {"margin": dict(zip(friction, margin.tolist(), strict=True)), "spring_error": errors}

"""What no sliding end can take away: the bound of all springs on the same pairs of bodies, at the largest payload."""

from __future__ import annotations

import numpy as np

from ..model.elements import lines
from ..model.errors import EquipoiseError
from ..model.mechanism import Mechanism
from ..model.payload import Payload
from ..model.region import Region
from ..synthesis.convex.least_squares_form import build
from ..synthesis.convex.semidefinite import least_rms
from ..synthesis.problem import Problem


def least_left(mechanism: Mechanism, payload: Payload, mass: float, travel: float) -> float | None:
    """[N m] rms that springs of zero free length on the pairs of the mechanism's springs leave at least.

    Their ends are anywhere within balls about the bodies' origins that reach as far as the ends do now, and `travel`
    [m] further where that is finite, with any stiffnesses. None where that says nothing: other springs, or no bound.

    Args:
        mass: [kg] of the payload.
    """
    springs = lines(mechanism, "adjust")
    if any(spring.free_length for spring in springs):
        return None
    far: dict[str, float] = {}
    for body, p in (end for spring in springs for end in spring.ends):
        far[body] = max(far.get(body, 0.0), float(np.linalg.norm(p)))
    more = travel if np.isfinite(travel) else 0.0
    reach = max(far.values()) or 1.0
    regions = {body: Region.ball(max(size + more, 1e-3 * reach)) for body, size in far.items()}
    pairs = dict.fromkeys((spring.body_a, spring.body_b) for spring in springs)
    loaded = payload.on(mechanism, mass).with_springs(())
    try:
        reduced = build(Problem.of(loaded, pairs=pairs, regions=regions))
        return least_rms(reduced.on(reduced.useful)).value * reduced.unbalanced
    except EquipoiseError:
        return None

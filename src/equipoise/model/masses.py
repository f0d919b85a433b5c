"""All that has weight in a mechanism, as masses at points."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .arrays import Array
from .mechanism import Mechanism


def lumped_masses(mechanism: Mechanism) -> Iterator[tuple[str, float, Array]]:
    """Every mass as (body, mass [kg], point in the body's frame (3,) [m]): bodies, point masses, springs."""
    for body in mechanism.bodies:
        yield body.name, body.mass, np.array(body.com)
    for mass in mechanism.masses:
        yield mass.body, mass.mass, np.array(mass.position)
    for spring in mechanism.springs:
        for name, mass, p in spring.lumps():
            yield name, mass, np.array(p)

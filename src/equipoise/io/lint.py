"""Inertias that look wrong: robot files are full of placeholders."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
from numpy.typing import NDArray

from ..model.mechanism import Body, Mechanism

ROUNDING = 1e-6
"""Relative excess of a principal moment that is put down to the rounded numbers of a file, not to an error."""


def principal(body: Body) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Principal moments [kg m^2], ascending, (3,), and axes, the columns of a right-handed (3, 3), of a body's inertia.

    A body without inertia has zero moments.
    """
    ixx, iyy, izz, ixy, ixz, iyz = body.inertia or (0.0,) * 6
    moments, axes = np.linalg.eigh([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
    if np.linalg.det(axes) < 0:
        axes[:, 0] = -axes[:, 0]
    return moments, axes


def impossible(body: Body) -> str | None:
    """Why no distribution of mass has this body's inertia, with its numbers [kg m^2]; None when one does."""
    low, middle, high = principal(body)[0]
    slack = ROUNDING * max(abs(low), abs(high))
    moments = f"principal moments {low:.6g}, {middle:.6g}, {high:.6g} kg m^2"
    if low < -slack:
        return f"{moments}: none can be negative"
    if high - (low + middle) > slack:
        return f"{moments}: none can exceed the sum of the other two, {low + middle:.6g} kg m^2"
    return None


def inertia_lint(mechanism: Mechanism) -> list[str]:
    """Say which inertias look like placeholders or mistakes.

    A body with neither mass nor inertia is a frame, and one without an inertia has none to check: both are fine.

    Returns:
        One message per link: mass with zero inertia, inertia without mass, an inertia that no distribution of mass has;
        and one for all links that share mass, com and inertia with another.
    """
    messages: list[str] = []
    same: dict[tuple[float, object, object], list[str]] = defaultdict(list)
    for body in mechanism.bodies:
        if body.inertia is None:
            continue
        if not any(body.inertia):
            if body.mass:
                messages.append(f"link '{body.name}': zero inertia with a mass of {body.mass:.6g} kg")
            continue
        if body.mass:
            same[body.mass, body.com, body.inertia].append(body.name)
        else:
            messages.append(f"link '{body.name}': inertia without mass")
        reason = impossible(body)
        if reason:
            messages.append(f"link '{body.name}': impossible inertia, {reason}")
    groups = [f"{', '.join(map(repr, names))} ({mass:.6g} kg)" for (mass, *_), names in same.items() if len(names) > 1]
    if groups:
        messages.append(f"links with identical inertials, copied placeholders? {'; '.join(groups)}")
    return messages

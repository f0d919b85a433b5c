"""Figs. 5 and 6 of cho2012 in theory, and maps over the hemisphere."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...energy.evaluate import Potential
from ...model.arrays import Array
from ...model.mechanism import Mechanism
from ..record import Map, Plot
from .shoulder import GRID, MOVE, SOFT, TIMES, arm, balanced, motion, scaled


def figures() -> Iterator[Plot]:
    """Figs. 5 and 6 in theory: the reference angle, the static torque and what is left with springs."""
    q = motion()
    bare, sprung = Potential(arm())(q).torque, Potential(balanced().mechanism)(q).torque
    for j in range(2):
        series = {
            f"reference theta_{j + 1} [rad]": q[:, j],
            "static torque without springs [N m]": bare[:, j],
            "torque with springs [N m]": sprung[:, j],
        }
        yield Plot(
            f"fig{5 + j}",
            f"Cho et al. (2012), Fig. {5 + j} in theory: theta_{j + 1} through the poses of Table 1",
            "time [s]",
            "angle [rad], torque [N m]",
            TIMES,
            series,
            note=f"a move takes {MOVE:g} s here; the paper shows measured torques, which friction moves off zero",
        )


def maps() -> tuple[Map, ...]:
    """The holding torques over the hemisphere."""
    before, after, soft = map(_over_hemisphere, (arm(), balanced().mechanism, scaled(1 - SOFT)))
    pictures = {
        "torque": ("without springs and balanced", {"no springs": before, "balanced": after}),
        "soft": ("with both springs 1 % soft", {"1 % soft": soft}),
    }
    return tuple(
        Map(
            name,
            f"Cho et al. (2012): holding torque over the hemisphere, {title}",
            "theta_1 [rad]",
            "theta_2 [rad]",
            "torque [N m]",
            *GRID,
            {f"of theta_{j + 1}, {label}": torque[..., j] for label, torque in torques.items() for j in range(2)},
            note=f"largest: {', '.join(f'{label} {_largest(torque)}' for label, torque in torques.items())}",
        )
        for name, (title, torques) in pictures.items()
    )


def _over_hemisphere(m: Mechanism) -> Array:
    """(theta_2, theta_1, 2) holding torque [N m]."""
    theta = np.stack(np.meshgrid(*GRID), axis=-1)
    return Potential(m)(theta.reshape(-1, 2)).torque.reshape(theta.shape)


def _largest(torque: Array) -> str:
    peak = float(np.abs(torque).max())
    return f"{peak:.3g} N m" if peak > 1e-9 else "below 1e-9 N m"

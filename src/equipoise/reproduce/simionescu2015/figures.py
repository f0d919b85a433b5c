"""Figs. 10 to 12 of simionescu2015, with the stiffness in print and with the right one; and what is left elsewhere."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...energy.evaluate import Potential
from ..record import Map, Plot
from .example import PRINTED_K, SWING, actuators, mechanism, path, printed, sprung


def diagrams() -> Iterator[Plot]:
    """Figs. 10-12: moment at A of leg 1 against theta_11 with theta_13 fixed."""
    robots = {
        "with spring 7": sprung().mechanism,
        f"with k7 = {PRINTED_K} N/m as printed": printed(),
    }
    for name, theta_13 in SWING.items():
        theta, u = path(theta_13, 121)
        series = {"without springs": Potential(mechanism())(u).gravity_torque[:, 0]}
        series |= {label: Potential(robot)(u).torque[:, 0] for label, robot in robots.items()}
        series["the paper's 2 N m"] = np.full_like(theta, 2.0)
        title = f"Fig. {name.removeprefix('fig')}: moment at joint A, theta_13 = {theta_13:.4g} rad"
        note = "Platform moved along the axis of A only, E below A: the paper does not say where else it is."
        yield Plot(name, title, "theta_11 [rad]", "moment [N m]", theta, series, note)


def residual_map() -> Iterator[Map]:
    """The largest residual of the three actuators over a plane."""
    side = np.linspace(-0.25, 0.25, 41)
    x, y = np.meshgrid(side, side)
    u = actuators(np.column_stack([x.ravel(), y.ravel(), np.full(x.size, -0.65)]))
    found = {"spring by (15)": sprung("axis", 0.1), "optimised over ±0.1 m": sprung("peak", 0.1)}
    panels = {
        label: np.abs(Potential(one.mechanism)(u).torque).max(axis=1).reshape(x.shape) for label, one in found.items()
    }
    title = "Largest residual moment of the three actuators, platform 0.65 m below the base"
    yield Map("residual", title, "x [m]", "y [m]", "moment [N m]", side, side, panels)

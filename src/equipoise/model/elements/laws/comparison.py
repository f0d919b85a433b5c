"""How well the profile of a cam gives the energy that stands beside it."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite
from typing import Any

import numpy as np

from ...arrays import Array
from .law import Law
from .profile import Profile, Run

COMPARED = 721  # angles
CLOSE = 0.005
"""Share of the largest torque that a profile may differ by from the energy that it stands for."""


@dataclass(frozen=True)
class Comparison:
    """How well a profile gives the energy that stands beside it, over the angles that are used.

    Attributes:
        low, high: these angles [rad].
        peak: the largest torque of the energy [N m]; off: by how much the profile's differs at the most.
        energy: by how much the difference of the energies varies [J].
    """

    made: Profile
    low: float
    high: float
    peak: float
    off: float
    energy: float

    @staticmethod
    def of(made: Profile, law: Law, low: float, high: float) -> Comparison:
        """That with the energy of a law between two angles [rad]."""
        run = made.run
        angle = np.linspace(low, high, COMPARED)
        torque = law.pull(angle)
        if run.folds:
            return Comparison(made, low, high, float(np.abs(torque).max()), inf, inf)
        off = np.interp(angle, run.angle, run.torque) - torque
        energy = np.interp(angle, run.angle, run.energy) - law.energy(angle)
        return Comparison(made, low, high, float(np.abs(torque).max()), float(np.abs(off).max()), float(np.ptp(energy)))

    @property
    def share(self) -> float:
        """What the torque differs by, as a share of its peak."""
        return self.off / self.peak if self.peak else inf

    @property
    def used(self) -> Run:
        """What the profile gives between the angles."""
        run, margin = self.made.run, 1e-9
        own = (run.angle >= self.low - margin) & (run.angle <= self.high + margin)
        own = own if own.any() else np.ones(len(own), bool)
        rows = {name: getattr(run, name)[own] for name in run.__dataclass_fields__ if name != "folds"}
        return Run(**rows, folds=run.folds)

    @property
    def faults(self) -> tuple[str, ...]:
        """What is wrong with the profile, its cable or roller and its spring, in words."""
        run, law = self.used, self.made.spring.law
        if run.folds:
            return ("what runs on the profile leaves it: along its points the joint's angle goes back",)
        found = []
        if self.share > CLOSE:
            found.append(f"its torque differs by up to {self.off:.3g} N m, {100 * self.share:.3g} % of its peak")
        if not (run.force > 0).all():
            found.append("its spring goes slack")
        for state in law.states:
            past = float(run.length.max() if state.above else run.length.min())
            if state.limit and state.holds(np.array(past)):
                found.append(f"its spring is {state.name}, at {1e3 * past:.4g} mm")
        if self.made.cable and not (run.radius > 0).all():
            found.append("the profile is not convex: its cable bridges what is hollow")
        if not (run.free > 0).all():
            found.append("its cable ends before its fixed point" if self.made.cable else "its roller passes the axis")
        return tuple(found)

    def to_dict(self) -> dict[str, Any]:
        """For ``check --json``."""
        run = self.used
        return {
            "torque_difference": self.off if isfinite(self.off) else None,
            "share": self.share if isfinite(self.share) else None,
            "energy_difference": self.energy if isfinite(self.energy) else None,
            "spring_length": [float(run.length.min()), float(run.length.max())],
            "spring_force": [float(run.force.min()), float(run.force.max())],
            "least_radius": float(np.abs(run.radius).min()),
            "reach": [float(run.reach.min()), float(run.reach.max())],
            "faults": list(self.faults),
        }

    def __str__(self) -> str:
        run, spring = self.used, self.made.spring
        part = f" '{spring.part}'" if spring.part else ""
        spring = f"{spring.law.noun}{part} {_to(1e3 * run.length)} mm, {_to(run.force)} N"
        how = "a cable to" if self.made.cable else "a roller under"
        size = f"{_to(1e3 * run.reach)} mm from the axis"
        return f"profile: {size}, {how} {spring}; its torque is that of the energy within " + (
            f"{100 * self.share:.3g} % of the peak" if isfinite(self.share) else "no bound"
        )


def _to(values: Array) -> str:
    return f"{values.min():.4g} to {values.max():.4g}"

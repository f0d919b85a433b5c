"""The law of a cam or a non-circular pulley: its energy on an angle, as a table or as a Fourier series.

Its profile may be there too, with what runs on it; then it is told how well the profile gives that energy.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ...arrays import Array
from ...errors import Fault, finite
from .comparison import Comparison
from .law import Law, State, Terms, listed, plain
from .pieces import Pieces
from .profile import Profile
from .table import Points, of_points, outside

if TYPE_CHECKING:
    from ....energy.fourier.frames import Frames
    from ....energy.fourier.series import Series
    from ....energy.kernel.trace import Trace, Value

HARMONICS = 50
"""At most, of a series."""
GRID = 2000  # angles of a turn at which the extremes of a series are looked for


@dataclass(frozen=True)
class Cam(Law):
    """The energy at each angle, either by points or as ``sum_n cosine[n-1] cos(n angle) + sine[n-1] sin(n angle)``.

    Between points it is the cubic spline, so that its torque is smooth; beyond the ends the torque stays, which
    `states` reports.

    Attributes:
        points: of angle [rad] and energy [J].
        cosine, sine: [J], of one, two, three .. times the angle.
        made: the profile that gives it, and what runs on it; the energy stands beside it.
    """

    kind: ClassVar[str] = "cam"
    noun: ClassVar[str] = "a cam"

    points: Points = listed("path", "energy", default=())
    cosine: tuple[float, ...] = listed("energy", default=())
    sine: tuple[float, ...] = listed("energy", default=())
    made: Profile | None = None

    @property
    def harmonics(self) -> list[tuple[int, float, float]]:
        """(times, cosine, sine) of those that are not 0."""
        count = max(len(self.cosine), len(self.sine))
        both = np.zeros((2, count))
        both[0, : len(self.cosine)], both[1, : len(self.sine)] = self.cosine, self.sine
        return [(n + 1, float(a), float(b)) for n, (a, b) in enumerate(both.T) if a or b]

    @cached_property
    def pieces(self) -> Pieces:
        """The torque of the spline through the points."""
        from scipy.interpolate import CubicSpline

        angle, energy = np.array(self.points, float).T
        found = CubicSpline(angle, energy)
        return Pieces(found.x, found.derivative().c, float(energy[0]))

    def energy(self, s: Array) -> Array:
        if self.points:
            return self.pieces.energy(s)
        return sum((a * np.cos(n * s) + b * np.sin(n * s) for n, a, b in self.harmonics), np.zeros_like(s, float))

    def pull(self, s: Array) -> Array:
        if self.points:
            return self.pieces.pull(s)
        slopes = (n * (b * np.cos(n * s) - a * np.sin(n * s)) for n, a, b in self.harmonics)
        return sum(slopes, np.zeros_like(s, float))

    def extremes(self, low: float, high: float) -> tuple[float, float]:
        if self.points:
            return self.pieces.extremes(low, high)
        turns = max(1.0, (high - low) / (2 * np.pi))
        found = self.pull(np.linspace(low, high, int(GRID * turns) + 1))
        return float(found.min()), float(found.max())

    def series(self, frames: Frames, terms: Terms) -> Series | None:
        if self.points:
            return None
        return frames.harmonics(terms, self.harmonics)

    def of_path(self, t: Trace, s: Value) -> tuple[Value, Value]:
        if self.points:
            return self.pieces.of_path(t, s)
        energies: list[Value] = []
        torques: list[Value] = []
        for n, a, b in self.harmonics:
            sine, cosine = t.sincos(t.mul(float(n), s))
            energies += [t.mul(a, cosine), t.mul(b, sine)]
            torques += [t.mul(n * b, cosine), t.mul(-n * a, sine)]
        return t.total(energies), t.total(torques)

    def faults(self) -> Iterator[Fault]:
        series = bool(self.cosine or self.sine)
        if bool(self.points) == series:
            yield Fault(("points",), "give 'points', or 'cosine' and 'sine', and not both")
        if self.points:
            yield from of_points(self.points, "table")
        for name in ("cosine", "sine"):
            yield from finite((name,), getattr(self, name))
            if len(getattr(self, name)) > HARMONICS:
                yield Fault((name,), f"at most {HARMONICS} are worked with, found {len(getattr(self, name))}")
        if series and not self.harmonics:
            yield Fault(("cosine",), "is 0 all through: such a cam does nothing")
        if self.made is not None:
            yield from self.made.faults()

    def values(self) -> dict[str, Any]:
        own = {name: plain(getattr(self, name)) for name in ("points", "cosine", "sine")}
        return {name: value for name, value in own.items() if value} | (self.made.values() if self.made else {})

    @property
    def states(self) -> tuple[State, ...]:
        if self.points or self.made is None:
            return outside(self.points) if self.points else ()
        angle = self.made.run.angle
        return (
            State("below its profile", float(angle.min()), above=False, limit=True),
            State("beyond its profile", float(angle.max()), above=True, limit=True),
        )

    @property
    def margin(self) -> float:
        if self.made is None or not self.made.friction:
            return 0.0
        angle = self.made.run.angle
        return self.made.friction * max(map(abs, self.extremes(float(angle.min()), float(angle.max()))))

    def comparison(self, low: float, high: float) -> Comparison | None:
        return None if self.made is None else Comparison.of(self.made, self, low, high)

    @property
    def strength(self) -> tuple[float, str]:
        if self.points:
            energy = [energy for _, energy in self.points]
            return max(energy) - min(energy), "J"
        return max((abs(x) for x in (*self.cosine, *self.sine)), default=0.0), "J"

    def words(self) -> str:
        return f"{len(self.points)} points of energy" if self.points else f"{len(self.harmonics)} harmonics"

    def scaled(self, factor: float) -> Cam:
        return replace(
            self, points=tuple((s, factor * energy) for s, energy in self.points),
            cosine=tuple(factor * x for x in self.cosine), sine=tuple(factor * x for x in self.sine),
            made=self.made and self.made.scaled(factor),
        )  # fmt: skip

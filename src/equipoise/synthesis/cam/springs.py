"""Springs for a cam: what a list offers, or any; and each as the law of a file, at the length where it works."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, nan
from typing import Protocol

from ...model.elements.laws import Compression, Extension, Gas, Law, Linear

KINDS = ("extension", "linear", "gas", "compression")
PUSHING = ("gas", "compression")
SPARE = 0.05  # of the travel that is left at either end of what is made to measure
EVEN = 1e-4  # share by which a force rises at least over a stroke: one that is the same all over has no rate
MOUNT = 0.06  # [m] of a gas spring's ends


class Part(Protocol):
    """What a list says of a spring, in SI units; `hardware.stock.parts.Stock` has it."""

    @property
    def part(self) -> str: ...
    @property
    def kind(self) -> str: ...
    @property
    def rate(self) -> float: ...
    @property
    def max_force(self) -> float: ...
    @property
    def initial_tension(self) -> float: ...
    @property
    def free_length(self) -> float: ...
    @property
    def max_length(self) -> float: ...
    @property
    def min_length(self) -> float: ...
    @property
    def force(self) -> float: ...
    @property
    def progression(self) -> float: ...
    @property
    def mass(self) -> float: ...
    @property
    def price(self) -> float: ...


@dataclass(frozen=True)
class Offer:
    """A spring that may be taken.

    Attributes:
        kind: of `KINDS`; rate: [N/m], not a number where it may be any.
        most: the largest force that it bears [N]; least: below which it is slack or closed [N].
        length: with nothing on it [m]; not a number where it may be any.
        part: what it is ordered by, where it is from a list.
    """

    kind: str
    rate: float = nan
    most: float = inf
    least: float = 0.0
    length: float = nan
    part: str = ""

    @staticmethod
    def of(part: Part) -> Offer:
        """A row of a list."""
        free, most = part.free_length, part.max_force
        if part.kind == "gas":
            most, stroke = most or part.progression * part.force, free - part.min_length
            rate = max(most - part.force, EVEN * part.force) / stroke
            return Offer(part.kind, rate, part.force + rate * stroke, part.force, free, part.part)
        ends = (part.max_length - free, free - part.min_length)  # [m] that it may be drawn, and pushed in
        most = min(most, part.initial_tension + part.rate * ends[part.kind == "compression"])
        return Offer(part.kind, part.rate, most, part.initial_tension, free, part.part)

    def unloaded(self, k: float, F1: float) -> float:
        """Its length with nothing on it [m]; where that may be any, one that the spring's travel usually needs."""
        if self.length == self.length:
            return self.length
        travel = F1 / k
        return travel if self.kind not in PUSHING else 1.6 * travel

    def law(self, k: float, F0: float, F1: float) -> tuple[Law, float]:
        """It as a law on its length, and its length at the force F0 [m], for forces between F0 and F1."""
        free = self.unloaded(k, F1)
        if self.kind == "linear":
            return Linear(k, free), free + F0 / k
        if self.kind == "extension":
            limit = free + (min(self.most, F1 + SPARE * (F1 - F0)) - self.least) / k
            return Extension(k, free, self.least, limit), free + (F0 - self.least) / k
        if self.kind == "compression":
            solid = free - min(self.most, F1 + SPARE * (F1 - F0)) / k
            return Compression(k, free, solid), free - F0 / k
        if self.length == self.length:
            return Gas(self.least, free, free - (self.most - self.least) / k, self.most), free - (F0 - self.least) / k
        spare = SPARE * (F1 - F0) / k
        stroke = (F1 - F0) / k + 2 * spare
        force, longest = F0 - k * spare, 2 * stroke + MOUNT
        return Gas(force, longest, longest - stroke, force + k * stroke), longest - spare

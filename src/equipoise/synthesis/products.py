"""Unknowns tied by products, such as k a b = m g h: filled in from the values given, and from defaults for the rest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod

from ..model.errors import InfeasibleError

AGREE = 1e-9  # relative: values that agree


@dataclass(frozen=True)
class Product:
    """``over[0] * over[1] .. / under[0] ..`` is `value`; `text` is how a reader knows it, `unit` that of the value."""

    text: str
    value: float
    unit: str
    over: tuple[str, ...]
    under: tuple[str, ...] = ()

    def missing(self, known: Mapping[str, float]) -> list[str]:
        """The unknowns without a value."""
        return [name for name in (*self.over, *self.under) if name not in known]

    def solve(self, name: str, known: Mapping[str, float]) -> float:
        """The one unknown that has no value yet."""
        rest = _ratio(self, {**known, name: 1.0})
        return self.value / rest if name in self.over else rest / self.value

    def agrees(self, known: Mapping[str, float]) -> bool:
        """Whether the values of all its unknowns satisfy it."""
        return abs(_ratio(self, known) - self.value) <= AGREE * abs(self.value)


def fill(products: Sequence[Product], given: Mapping[str, float], defaults: Mapping[str, float]) -> dict[str, float]:
    """A value, not zero, for every unknown: as given, else as the products make it, else its default.

    Products come first that, together with a default, must not be spoiled by it: defaults are used in their order,
    one at a time, and only when no product determines another unknown.

    Raises:
        InfeasibleError: the values given contradict a product.
    """
    known, left = dict(given), list(defaults)
    while True:
        for product in products:
            unknown = product.missing(known)
            if not unknown and not product.agrees(known):
                values = ", ".join(show(name, known[name]) for name in (*product.over, *product.under))
                found = f"{_ratio(product, known):.6g} {product.unit}".rstrip()
                chosen = ", ".join(given)
                raise InfeasibleError(
                    f"{product.text} must be {product.value:.6g} {product.unit}".rstrip()
                    + f", but it is {found} with {values}: leave out one of the values given ({chosen})"
                )
            if len(unknown) == 1:
                known[unknown[0]] = product.solve(unknown[0], known)
                break
        else:
            name = next((name for name in left if name not in known), None)
            if name is None:
                return known
            known[name] = defaults[name]


def show(name: str, value: float) -> str:
    """A stiffness or a length with its unit."""
    return f"{name} = {value:.6g} N/m" if name.startswith("k") else f"{name} = {1e3 * value:.6g} mm"


def _ratio(product: Product, known: Mapping[str, float]) -> float:
    return prod(known[name] for name in product.over) / prod(known[name] for name in product.under)

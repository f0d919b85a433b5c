"""Loops in a certificate: constant forces across them with which the energy hardly varies (docs/theory.md).

On closed poses the two points of a loop coincide, so that a force between them adds nothing to the energy. A hinge is
two pairs of points. The forces are found in double precision; what they leave is enclosed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from ..energy.certificate import fourier_form
from ..energy.fourier.closed import CLOSURE_ROUNDING, opened
from ..model.arrays import Array
from ..model.errors import NoFourierForm
from ..model.mechanism import Mechanism
from .enclosure import Enclosure, Key
from .statement import text

SMALL = 1e-12  # of the largest coefficient: what is left is rounding
Ends = dict[str, Any]


def pairs_of_points(mechanism: Mechanism) -> list[Ends]:
    """What coincides where the loops close.

    Raises:
        NoFourierForm: the two axes of a hinge have different lengths, so that no two points on them coincide.
    """
    return [*_points(mechanism)]


def tree_of(mechanism: Mechanism) -> Mechanism:
    """With its loops open, and the relations that its joints have on closed poses as couplings.

    Raises:
        NoFourierForm: that does not tell whether it is balanced.
    """
    proof, reason = fourier_form(mechanism)
    if proof is None:
        raise NoFourierForm(reason or "with its loops the energy has no finite Fourier form")
    return opened(mechanism)


def _points(mechanism: Mechanism) -> Iterator[Ends]:
    for loop in mechanism.loops:
        ends = [loop.p_a, loop.p_b]
        yield _ends(loop.body_a, ends[0], loop.body_b, ends[1])
        if loop.axis_a is not None and loop.axis_b is not None:
            axes = [[Fraction(x) for x in axis] for axis in (loop.axis_a, loop.axis_b)]
            if sum(x * x for x in axes[0]) != sum(x * x for x in axes[1]):
                raise NoFourierForm("the axes of a loop's hinge have different lengths")
            a, b = ([Fraction(x) + y for x, y in zip(p, axis, strict=True)] for p, axis in zip(ends, axes, strict=True))
            yield _ends(loop.body_a, a, loop.body_b, b)


def _ends(body_a: str, p_a: Sequence[Any], body_b: str, p_b: Sequence[Any]) -> Ends:
    return {"body_a": body_a, "p_a": [*map(text, p_a)], "body_b": body_b, "p_b": [*map(text, p_b)]}


def forces(
    enclosure: Enclosure, loops: Sequence[Ends], within: Mapping[str, Fraction]
) -> tuple[Fraction, list[list[Any]]]:
    """How much the energy varies at most on closed poses [J], and the forces that prove it.

    Returns:
        The bound, and (loop, body in whose frame, the force's three components) of each force.
    """
    energy = enclosure.energy()
    largest = max((abs(complex(c)) for key, c in energy.items() if any(key)), default=0.0)
    columns: list[dict[Key, Any]] = []
    places: list[tuple[int, str, int]] = []
    found = np.zeros(0)
    for bound in (False, True):  # forces that turn with a body take longer, and few mechanisms need them
        for i, ends in enumerate(loops):
            for body in (ends["body_a"], ends["body_b"]) if bound else ("world",):
                for axis, terms in enumerate(enclosure.gap(ends, body)):
                    if any(abs(complex(c)) > CLOSURE_ROUNDING for key, c in terms.items() if any(key)):
                        columns.append(terms)
                        places.append((i, body, axis))
        found, left = _least(enclosure, energy, columns, within)
        if left <= SMALL * largest:
            break
    total = dict(energy)
    for force, terms in zip(found.tolist(), columns, strict=True):
        for key, c in terms.items():
            total[key] = total.get(key, 0) + c * enclosure.number(force)
    proof = []
    for (i, body, axis), force in zip(places, found.tolist(), strict=True):
        if force:
            proof.append([i, body, *(text(force if j == axis else 0) for j in range(3))])
    return enclosure.varies(total, within), proof


def _least(
    enclosure: Enclosure, energy: dict[Key, Any], columns: Sequence[dict[Key, Any]], within: Mapping[str, Fraction]
) -> tuple[Array, float]:
    """The forces (columns,) that leave least of the energy, in double precision, and that [J]."""
    keys = sorted({key for terms in (energy, *columns) for key in terms if any(key)})
    reach = [float(within.get(name, 1)) for name in enclosure.names]
    sizes = np.array([np.prod(np.power(reach, key[len(reach) :])) for key in keys])

    def double(terms: dict[Key, Any]) -> Array:
        values = np.array([complex(terms.get(key, 0)) for key in keys]) * sizes
        return np.concatenate([values.real, values.imag]).astype(float)

    rest = double(energy)
    if not columns:
        return np.zeros(0), float(np.abs(rest).max(initial=0.0))
    A, found = np.stack([double(terms) for terms in columns], axis=1), np.zeros(len(columns))
    for _ in range(2):  # the second time what rounding has left
        found = found - np.linalg.lstsq(A, rest + A @ found, rcond=1e-12)[0]
    return found, float(np.abs(rest + A @ found).max(initial=0.0))

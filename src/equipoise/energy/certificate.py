"""What proves balance, or the lack of it: the Fourier form, or the energy's distance from constant without one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeVar

from ..model.errors import NoFourierForm
from ..model.mechanism import Mechanism
from .exactness import Distance
from .fourier.closed import ClosedEnergy
from .fourier.energy import FourierEnergy
from .fourier.frames import MAX_TERMS
from .span.energy import SpanEnergy

Proof = FourierEnergy | SpanEnergy

AFFORDABLE = 15_000  # terms of a Fourier form that a check writes out: up to about 0.3 s


@dataclass(frozen=True)
class Certificate:
    """How the verdict was reached.

    Attributes:
        kind: "fourier" or "span", proofs over all configurations: by the coefficients of the Fourier form, or without
            writing it out, where it is long; or "sampled", with `reason` why there is no proof.
        samples: random poses used for everything that is not the proof.
        terms: how many the Fourier form has.
        max_coefficient: its largest that varies [J].
        distance: from exact, with a proof.
        reason: why there is no proof.
    """

    kind: Literal["fourier", "span", "sampled"]
    samples: int
    terms: int | None = None
    max_coefficient: float | None = None
    reason: str | None = None
    distance: Distance | None = None

    @staticmethod
    def of(proof: Proof | None, reason: str | None, samples: int) -> Certificate:
        """What `proof_of` found, with the number of poses for the rest."""
        match proof:
            case None:
                return Certificate("sampled", samples, reason=reason)
            case SpanEnergy():
                return Certificate("span", samples, distance=proof.distance)
            case _:
                largest = float(proof.amplitude.max(initial=0))
                return Certificate("fourier", samples, len(proof.c), largest, distance=proof.distance)


P = TypeVar("P", FourierEnergy, ClosedEnergy, SpanEnergy)


def _decided(proof: P) -> P:
    """The same, when its distance from exact can be had."""
    _ = proof.distance
    return proof


def proof_of(mechanism: Mechanism, max_terms: int = AFFORDABLE) -> tuple[Proof | None, str | None]:
    """What decides whether a mechanism is balanced, or None and the reason why nothing does.

    The Fourier form where it has at most so many terms. With loops there is no other.
    """
    if mechanism.loops:
        return fourier_form(mechanism, max(max_terms, MAX_TERMS))
    series, _ = fourier_form(mechanism, max_terms)
    if series is not None:
        return series, None
    try:
        return _decided(SpanEnergy(mechanism)), None
    except NoFourierForm as why:
        return None, str(why)


def fourier_form(mechanism: Mechanism, max_terms: int = MAX_TERMS) -> tuple[FourierEnergy | None, str | None]:
    """The Fourier form of a mechanism's energy, or None and the reason why there is none.

    With loops it is the form up to what the loops make zero, and only one that proves balance says anything.
    """
    try:
        if not mechanism.loops:
            return _decided(FourierEnergy(mechanism, max_terms)), None
        closed = _decided(ClosedEnergy(mechanism, max_terms))
        return (closed, None) if closed.exact else (None, "with its loops the energy has no finite Fourier form")
    except NoFourierForm as why:
        return None, str(why)

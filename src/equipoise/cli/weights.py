"""Options of `equipoise design` for what is designed beside the springs."""

from __future__ import annotations

from ..model.errors import Fault, InputError
from .options import positive_length


def counterweights(text: str) -> float | dict[str, float]:
    """``250mm`` for every link that moves, ``BODY=300 mm, BODY=100 mm`` for some [m].

    Raises:
        InputError: not a length of more than 0, or a body that is named twice.
    """
    if "=" not in text:
        return positive_length(text, "--counterweights")
    found: dict[str, float] = {}
    for part in text.split(","):
        body, equals, radius = (piece.strip() for piece in part.rpartition("="))
        if not equals or not body or body in found:
            expected = "expected one length, or BODY=LENGTH, BODY=LENGTH, each body once"
            raise InputError(Fault(("--counterweights",), f"{expected}; found '{part.strip()}'"))
        found[body] = positive_length(radius, "--counterweights")
    return found

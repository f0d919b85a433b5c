"""A certificate's claims for the terminal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..proof.certificate import Certified


def certificate_lines(found: Certified) -> Iterator[str]:
    """What is claimed, and what is not and why."""
    claims, name = found.claims, found.document["of"]
    if torque := claims.get("torque"):
        least = ", ".join(f"{float(x):.3g} at {joint}" for joint, x in torque["at_most"].items())
        where = " within the ranges of what slides" if torque["within"] else ""
        yield f"{name}: proved at every configuration{where}: the torque is at most [N m or N] {least}"
    if closed := claims.get("closed"):
        yield f"{name}: proved wherever its loops close: the energy varies by at most {float(closed['energy']):.3g} J"
    if bound := claims.get("bound"):
        pairs = ", ".join(dict.fromkeys(f"{pair['body_a']}:{pair['body_b']}" for pair in bound["pairs"]))
        yield (
            f"proved: springs on {pairs} in these regions, of at most {_ratio(bound['stiffness']):.4g} N/m together, "
            f"leave at least {float(bound['at_least']):.6g} N m rms"
        )
    if fewest := claims.get("fewest"):
        links = ", ".join(fewest["links"])
        yield f"proved: fewer than {fewest['springs']} springs cannot be exact, because gravity loads {links}"
    for claim, why in found.left_out.items():
        yield f"not proved: {claim}: {why}"


def _ratio(text: str) -> float:
    over, _, under = text.partition("/")
    return int(over) / int(under or 1)

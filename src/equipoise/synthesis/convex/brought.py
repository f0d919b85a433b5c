"""What each element with fixed ends brought: how much would be left at least without it."""

from __future__ import annotations

from .least_squares_form import LeastSquaresForm
from .semidefinite import least_rms
from .set_block import SetBlock


def brought(reduced: LeastSquaresForm) -> dict[str, float]:
    """For each element with fixed ends, [N m] rms that is left at least without it."""
    found = {}
    for i, block in enumerate(reduced.blocks):
        if isinstance(block, SetBlock):
            rest = [j for j in range(len(reduced.blocks)) if j != i]
            left = least_rms(reduced.on(rest)).value if rest else 1.0
            found[block.element.name] = left * reduced.unbalanced
    return found

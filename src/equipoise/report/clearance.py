"""The room around springs, as text for a terminal."""

from __future__ import annotations

from collections.abc import Iterator

from rich.text import Text

from ..clearance import Clearance
from ..kinematics import Tree
from ..model.mechanism import Mechanism
from .numbers import pose

LISTED = 8  # distances


def clearance_lines(mechanism: Mechanism, found: Clearance, limit: float) -> Iterator[Text]:
    """The verdict, the smallest distances, the worst pose, and the springs that do not always pull one way."""
    if not found.gaps:
        yield Text("nothing to come close to: one spring, and no capsules in the file", style="yellow")
    else:
        good, first = found.least >= limit, found.gaps[0]
        yield Text(
            f"{'CLEAR' if good else 'NOT CLEAR'}: least distance {1e3 * found.least:.4g} mm, "
            f"{first.spring} to {first.other}",
            style="bold green" if good else "bold yellow",
        )
        yield Text(f"worst pose: {pose(Tree.of(mechanism).coordinates, first.configuration)}")
    for gap in found.gaps[:LISTED]:
        yield Text(f"  {1e3 * gap.distance:9.3f} mm  {gap.spring} to {gap.other}")
    for line in found.lines:
        if line.slack:
            yield Text(f"{line.spring}: SLACK, shorter than its free length, in {100 * line.slack:.3g} % of poses")
        if line.over_centre:
            shares = ", ".join(f"{name} ({100 * share:.3g} %)" for name, share in line.over_centre.items())
            yield Text(f"{line.spring}: goes over centre about {shares} of poses")

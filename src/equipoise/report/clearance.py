"""The room around springs, as text for a terminal."""

from __future__ import annotations

from collections.abc import Iterator

from rich.text import Text

from ..clearance import Clearance
from ..kinematics import Tree
from ..model.mechanism import Mechanism
from .numbers import pose

LISTED = 8  # distances
NOT_JUDGED = (
    "NOT JUDGED against the links: the file says nothing of their size; give it 'capsules:' or 'shapes:', or start "
    "from a URDF or MJCF file with collision geometry"
)
"""What is said of room where no link has any."""


def clearance_lines(mechanism: Mechanism, found: Clearance, limit: float) -> Iterator[Text]:
    """The verdict, the smallest distances, the worst pose, and the springs that do not always pull one way."""
    if found.gaps:
        good, first = found.least >= limit, found.gaps[0]
        verdict = "CLEAR" if found.clear(limit) else "room enough among themselves" if good else "NOT CLEAR"
        yield Text(
            f"{verdict}: least distance {1e3 * found.least:.4g} mm, {first.spring} to {first.other}",
            style="bold green" if found.clear(limit) else "bold yellow",
        )
    else:
        yield Text("NOTHING TO JUDGE: no spring or weight has anything to come close to", style="bold yellow")
    if not found.links:
        yield Text(NOT_JUDGED, style="bold yellow")
    for name in found.left_out:
        yield Text(f"not judged: {name}", style="yellow")
    if found.gaps:
        yield Text(f"worst pose: {pose(Tree.of(mechanism).coordinates, found.gaps[0].configuration)}")
        share = f"{100 * found.free(limit):.4g} % of {len(found.nearest):,} random poses"
        yield Text(f"free share: at least {1e3 * limit:.4g} mm everywhere in {share}")
    for gap in found.gaps[:LISTED]:
        yield Text(f"  {1e3 * gap.distance:9.3f} mm  {gap.spring} to {gap.other}")
    for line in found.lines:
        if line.slack:
            yield Text(f"{line.spring}: SLACK, shorter than its free length, in {100 * line.slack:.3g} % of poses")
        if line.over_centre:
            shares = ", ".join(f"{name} ({100 * share:.3g} %)" for name, share in line.over_centre.items())
            yield Text(f"{line.spring}: goes over centre about {shares} of poses")

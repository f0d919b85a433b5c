"""Attachment regions typed on the command line: ``--region "forearm=box 100,0,20 mm at 50,0,0 mm"``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from ..model import slips
from ..model.errors import Fault, InputError
from ..model.units import to_si
from . import terminal

if TYPE_CHECKING:
    from ..model.mechanism import Mechanism
    from ..model.region import Region

OPTION = ("--region",)
SHAPE = re.compile(r"(box|ball|point)\b(.*?)(?:\bat\b(.*))?", re.DOTALL)
UNIT = re.compile(r"[A-Za-zµ]+\Z")
EXPECTED = (
    "BODY=RADIUS",
    "BODY=ball RADIUS at X,Y,Z",
    "BODY=box X,Y,Z at X,Y,Z (half sides, 0 keeps it flat)",
    "BODY=point at X,Y,Z",
    "a joint's name instead of X,Y,Z",
)


def regions(texts: list[str], box: bool) -> dict[str, list[Region]]:
    """The regions of each body, several of one body being a union.

    Args:
        box: a radius alone is half the side of a box.

    Raises:
        InputError: a text is no region; the message says what one looks like.
    """
    found: dict[str, list[Region]] = {}
    for text in texts:
        body, equals, shape = text.rpartition("=")
        if not equals:
            raise InputError(Fault(OPTION, f"expected BODY=RADIUS or another region, found '{text}'", EXPECTED))
        found.setdefault(body.strip(), []).append(_region(shape.strip(), text, box))
    return found


def sizes(mechanism: Mechanism, radius: float | None, regions: dict[str, list[Region]]) -> None:
    """Say which radius is far beyond the mechanism's reach."""
    given = {"--radius": radius or 0.0}
    given |= {f"--region {body}": max(max(region.half) for region in own) for body, own in regions.items()}
    terminal.slip([message for name, value in given.items() for message in slips.far(mechanism, value, name)])


def _region(text: str, whole: str, box: bool) -> Region:
    from ..model.region import ORIGIN, Region

    match = SHAPE.fullmatch(text)
    kind, size, place = match.groups() if match else ("box" if box else "ball", text, None)
    if kind == "point" and size.strip():
        raise InputError(Fault(OPTION, f"a point has no size: expected 'point at X,Y,Z', found '{whole}'"))
    centre = ORIGIN if place is None else _centre(place, whole)
    if kind == "point":
        return Region.point(centre)
    sides = _lengths(size, whole)
    if len(sides) not in ((1, 3) if kind == "box" else (1,)):
        what = "one half side, or three" if kind == "box" else "one radius"
        raise InputError(Fault(OPTION, f"a {kind} has {what}, found '{whole}'", EXPECTED))
    if min(sides) < 0 or max(sides) == 0:
        raise InputError(Fault(OPTION, f"must be more than 0 m, found {whole}"))
    return (
        Region.ball(sides[0], centre) if kind == "ball" else Region.box(sides * 3 if len(sides) == 1 else sides, centre)
    )


def _centre(text: str, whole: str) -> list[float] | str:
    if "," not in text:
        return text.strip()
    point = _lengths(text, whole)
    if len(point) != 3:
        raise InputError(Fault(OPTION, f"expected 'at X,Y,Z' or 'at JOINT', found '{whole}'"))
    return point


def _lengths(text: str, whole: str) -> list[float]:
    """[m] ``100,0,20 mm``: the last unit is that of those without one."""
    parts = [part.strip() for part in text.split(",")]
    unit = UNIT.search(parts[-1])
    try:
        return [to_si(part if UNIT.search(part) or unit is None else f"{part} {unit[0]}", "length") for part in parts]
    except InputError as error:
        raise InputError(Fault(OPTION, f"{error}, in '{whole}'", EXPECTED)) from None

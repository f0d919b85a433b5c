"""Cams in a report: the sheet of each, and how well its profile gives its energy."""

from __future__ import annotations

from collections.abc import Iterator

from ...balance import Balance
from .. import style
from ..cam import cam_drawing
from .content import Block, Items, Paragraph, Picture
from .pictures import inline


def cams(balance: Balance) -> Iterator[Block]:
    """Of every cam whose profile is known."""
    mechanism = balance.mechanism
    for i, (spring, use) in enumerate(zip(mechanism.springs, balance.use, strict=True)):
        made = spring.law.comparison(*use.path)
        if made is None:
            continue
        name = style.clean(spring.name, 60)
        yield Paragraph(f"{name}: {made}.")
        if made.faults:
            yield Items(made.faults)
        if not made.made.run.folds:
            runs = "a cable" if made.made.cable else "a roller"
            title = f"Profile of {name}"
            said = (
                f"The outline of the profile around its axis, with {runs}, at angle 0; below it what to order and cut."
            )
            svg = cam_drawing(mechanism, spring.name).svg()
            how = "equipoise export writes it at full size"
            yield Picture(inline(svg, f"cam{i}", title, said), f"{title}, with {runs}; {how}.", said, narrow=True)

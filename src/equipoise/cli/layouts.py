"""`equipoise layouts`: which links of a planar arm springs have to join."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..model.errors import Fault, InputError, nearest
from . import terminal
from .app import Json, app

if TYPE_CHECKING:
    from ..synthesis.planar.layouts import LayoutSearch

FORMS = ("text", "latex")
MANY = 5_000  # layouts: beyond it, the user is told beforehand


@app.command()
def layouts(
    n: Annotated[int, typer.Argument(metavar="N", help="links, the ground included", show_default=False)],
    objective: Annotated[
        str, typer.Option(help="springs (fewest), span (fewest joints spanned) or weighted")
    ] = "springs",
    weight: Annotated[float, typer.Option(help="of a joint that a spring spans, for weighted")] = 1.0,
    springs: Annotated[int | None, typer.Option(metavar="K", help="exactly so many springs")] = None,
    excluded: Annotated[bool, typer.Option("--excluded", help="also list what is excluded, and why")] = False,
    equations: Annotated[
        str, typer.Option(help="also print the design equations: text or latex", show_default=False)
    ] = "",
    output: Annotated[Path | None, typer.Option("-o", "--output", help="folder for the examples as mechanisms")] = None,
    seed: Annotated[int, typer.Option(min=0, help="of the random starts for springs")] = 0,
    json: Json = False,
) -> None:
    """Which links springs have to join to balance a planar arm of N links: every best layout, each with springs.

    13,14,24 are springs between the ground, 1, and link 3, and so on. Exit code 1 when no layout is feasible.

    Example: [bold]equipoise layouts 4 --objective span[/bold]
    """
    from ..report.layouts import count_lines, layout_lines
    from ..synthesis.planar.layouts import candidates, search

    if equations not in ("", *FORMS):
        raise InputError(Fault(("--equations",), f"unknown form {nearest(equations, FORMS)}", FORMS))
    count = candidates(n, objective, springs, weight)  # pyright: ignore[reportArgumentType]
    if count > MANY:
        terminal.say(f"note: up to {count:,} layouts are looked at, which may take minutes")
    with terminal.progress_bar("searching") as report:
        found = search(n, objective, springs, weight, seed, report)  # pyright: ignore[reportArgumentType]
    written = [] if output is None else _write(found, output)
    if json:
        rows = [one.to_dict() for one in found.feasible]
        terminal.print_json(rows + [one.to_dict() for one in found.excluded] if excluded else rows)
        for line in count_lines(found):
            terminal.say(line)
    else:
        from rich.text import Text

        from ..synthesis.planar.layouts import name

        if excluded:
            terminal.show(Text(f"{name(one.layout)}: {one}", style="dim") for one in found.excluded)
        terminal.show(layout_lines(found, equations))
    for path in written:
        terminal.say(f"wrote {path}")
    raise typer.Exit(0 if found.feasible else 1)


def _write(found: LayoutSearch, folder: Path) -> list[Path]:
    """The example arm with each layout's springs."""
    from ..io import save
    from ..io.files import make_folder
    from ..synthesis.planar.layouts import name

    make_folder(folder)
    written = []
    for one in found.feasible:
        written.append(folder / f"{name(one.layout).replace(',', '_')}.yaml")
        save(one.balance.mechanism, written[-1])
    return written

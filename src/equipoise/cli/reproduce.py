"""`equipoise reproduce`: the papers' tables and figures, published beside computed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from . import terminal
from .app import Json, app

if TYPE_CHECKING:
    from ..reproduce import Reproduction


@app.command()
def reproduce(
    paper: Annotated[str | None, typer.Argument(help="which one (default: all)", show_default=False)] = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="folder for tables and figures")] = None,
    json: Json = False,
) -> None:
    """The papers' tables and figures, published beside computed. Exit code 1 when a row fails; it is named last.

    Example: [bold]equipoise reproduce lin2010 -o lin2010[/bold]
    """
    from ..report.published import failure_lines, reproduction_lines
    from ..reproduce import PAPERS
    from ..reproduce import reproduce as reproduced

    found = []
    with terminal.progress_bar("reproducing") as report:
        for key in PAPERS if paper is None else (paper,):
            report(f"reproducing {key}", 0.0)
            found.append(reproduced(key))
        written = [] if output is None else _write(found, output)
    rows = [row for one in found for row in one.rows]
    if json:
        terminal.print_json([row.to_dict() for row in rows])
    else:
        for one in found:
            terminal.show(reproduction_lines(one))
    for path in written:
        terminal.say(f"wrote {path}")
    failed = list(failure_lines(found))
    for line in failed:
        terminal.say(str(line)) if json else terminal.show(iter([line]))
    raise typer.Exit(1 if failed else 0)


def _write(found: list[Reproduction], folder: Path) -> list[Path]:
    """For each paper its table as Markdown, and its figures."""
    from ..io.files import make_folder, write_text
    from ..report.published import file_name, reproduction_markdown, save_figure

    make_folder(folder)
    written = []
    for one in found:
        written.append(folder / f"{one.paper}.md")
        write_text(written[-1], reproduction_markdown(one))
        for figure in one.figures:
            written.append(folder / file_name(one, figure))
            save_figure(figure, written[-1])
    return written

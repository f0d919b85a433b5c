"""`equipoise identify`: what a build's springs and masses really are."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..model.errors import Fault, InputError, nearest
from . import terminal
from .app import File, Json, app

if TYPE_CHECKING:
    from ..model.mechanism import Mechanism


@app.command()
def identify(
    file: File,
    measured: Annotated[Path, typer.Argument(help="CSV: a column per joint, and torque:JOINT or current:JOINT")],
    constant: Annotated[
        list[str] | None,
        typer.Option(metavar="JOINT=CONSTANT", help="torque constant, such as '0.05 N m/A'; may be repeated"),
    ] = None,
    known: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="as the file has it: rates, preloads, masses, or 'mass of arm'; repeatable"),
    ] = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="write the build as it is found")] = None,
    turned: Annotated[Path | None, typer.Option(help="write the build as it is after the turns")] = None,
    table: Annotated[
        Path | None, typer.Option(help="write the torque that is left over the joint ranges, as CSV")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="of the poses on which turns are chosen")] = 0,
    json: Json = False,
) -> None:
    """What a build's springs and masses really are, from measured holding torques, and what to turn.

    Rates, preloads and masses with 95 % intervals; what cannot be told apart by name; which screw to turn and by how
    much; the torque that is left, as a table for the controller. A column's head may have its unit in brackets.

    Example: [bold]equipoise identify arm.yaml measured.csv --known masses --table left.csv -o real.yaml[/bold]
    """
    from ..io import check_savable, save
    from ..io.files import check_writable, write_text
    from ..report.identify import identify_lines, remaining_table
    from ..robust.identify import identify as run

    mechanism = terminal.load(file)
    constants = _constants(constant or [], mechanism)
    for path in filter(None, (output, turned)):
        check_savable(path)
    if table:
        check_writable(table)
    with terminal.progress_bar("identifying") as report:
        report("identifying", 0.0)
        found = run(mechanism, str(measured), constants=constants, known=known or [], seed=seed)
    if output:
        save(found.mechanism, output)
    if turned:
        save(found.turned, turned)
    if table:
        write_text(table, remaining_table(found.turned if turned else found.mechanism))
    if json:
        terminal.print_json(found.to_dict())
    else:
        terminal.show(identify_lines(found))
    for path in filter(None, (output, turned, table)):
        terminal.say(f"wrote {path}")


def _constants(texts: list[str], mechanism: Mechanism) -> dict[str, float]:
    """``JOINT=CONSTANT`` [N m/A or N/A]."""
    from ..kinematics import Tree

    coordinates, found = Tree.of(mechanism).coordinates, dict[str, float]()
    for text in texts:
        name, equals, value = text.rpartition("=")
        if not equals or name not in coordinates:
            raise InputError(Fault(("--constant",), f"no joint {nearest(name or text, coordinates)}", coordinates))
        number, _, unit = value.strip().partition(" ")
        scale = {"": 1.0, "N m/A": 1.0, "N*m/A": 1.0, "Nm/A": 1.0, "mN m/A": 1e-3, "mNm/A": 1e-3, "N/A": 1.0}.get(
            unit.strip()
        )
        try:
            size = float(number)
        except ValueError:
            size = 0.0
        if scale is None or not 0 < abs(size) < 1e9:
            raise InputError(Fault(("--constant",), f"expected JOINT=0.05 N m/A, found '{text}'"))
        found[name] = scale * size
    return found

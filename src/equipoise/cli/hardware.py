"""`equipoise hardware`: springs to wind and parts as bought, how they are built in, and what that leaves."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from ..model.errors import Fault, InputError
from ..model.units import quantity, share
from . import terminal
from .app import File, Json, app
from .buildable import Cycles, Fatigue, Safety, named

if TYPE_CHECKING:
    from ..hardware import Options
    from ..model.mechanism import Mechanism


@app.command()
def hardware(
    file: File,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="write the bill as a table: .csv")] = None,
    sheet: Annotated[Path | None, typer.Option(help="write a dimensioned drawing: .svg or .dxf")] = None,
    realise: Annotated[
        str | None, typer.Option(help="direct, case, telescope, pulley or eyelet (default: what leaves least)")
    ] = None,
    wire: Annotated[str, typer.Option(metavar="GRADE,...", help="grades of wire to choose from")] = "DH",
    strength: Annotated[str | None, typer.Option(help="tensile strength of the wire instead of the standard's")] = None,
    outer: Annotated[str | None, typer.Option(help="largest outer diameter of a spring")] = None,
    length: Annotated[str | None, typer.Option(help="largest length of a spring in use")] = None,
    pulley: Annotated[str, typer.Option(help="radius of the pulleys")] = "10mm",
    most: Annotated[int, typer.Option(min=1, help="at most this many springs side by side")] = 8,
    fatigue: Fatigue = 1.0,
    safety: Safety = 1.2,
    cycles: Cycles = 1e5,
    limit: Annotated[
        list[str] | None, typer.Option(metavar="NAME=VALUE", help="another permissible stress; --json lists them")
    ] = None,
    friction: Annotated[
        list[str] | None, typer.Option(metavar="KIND=SHARE", help="of a realisation, such as pulley=1%")
    ] = None,
    json: Json = False,
) -> None:
    """Springs to wind for a design, how to realise zero free length, and what that leaves. Exit code 1 if it cannot.

    Example: [bold]equipoise hardware balanced.yaml --outer 40mm --length 600mm -o bill.csv --sheet springs.svg[/bold]
    """
    from ..balance import check
    from ..hardware.realise.bill import bill as make
    from ..hardware.realise.held import real
    from ..io.files import check_writable, write_text
    from ..report.drawing import check_sheet, save_drawing

    options = _options(wire, strength, outer, length, pulley, most, limit or [], friction or [])
    options = replace(options, limits=replace(options.limits, fatigue=fatigue, safety=safety, cycles=cycles))
    mechanism = terminal.load(file)
    if output:
        if output.suffix.lower() != ".csv":
            raise InputError(Fault(("--output",), f"a bill is written as .csv, found '{output.suffix}'"))
        check_writable(output)
    if sheet:
        check_sheet(sheet)
    if real(mechanism):
        _kit(mechanism, options, realise, output, sheet, json)
    with terminal.progress_bar("judging the design") as report:
        bill = make(check(mechanism), options, realise, report)
    if output:
        from ..report.bill import bill_csv

        write_text(output, bill_csv(bill))
    if sheet:
        from ..report.sheet import sheet as draw

        save_drawing(draw(bill), sheet)
    if json:
        terminal.print_json(bill.to_dict())
    else:
        from ..report.bill import bill_lines

        terminal.show(bill_lines(bill))
    for path in filter(None, (output, sheet)):
        terminal.say(f"wrote {path}")
    raise typer.Exit(0 if bill.complete else 1)


def _kit(
    mechanism: Mechanism, options: Options, realise: str | None, output: Path | None, sheet: Path | None, json: bool
) -> NoReturn:
    """The springs of a file that are real already."""
    from ..balance import check
    from ..hardware.realise.held import kit
    from ..io.files import write_text
    from ..report.held import kit_csv, kit_lines

    for name, value in (("--realise", realise), ("--sheet", sheet)):
        if value is not None:
            raise InputError(Fault((name,), "the file's springs are real already; this is for those on paper"))
    with terminal.progress_bar("judging the design"):
        found = kit(check(mechanism), options)
    if output:
        write_text(output, kit_csv(found))
    if json:
        terminal.print_json(found.to_dict())
    else:
        terminal.show(kit_lines(found))
    if output:
        terminal.say(f"wrote {output}")
    raise typer.Exit(0 if found.complete else 1)


def _options(
    wires: str,
    strength: str | None,
    outer: str | None,
    length: str | None,
    pulley: str,
    most: int,
    limits: list[str],
    friction: list[str],
) -> Options:
    from ..hardware import Envelope, Limits, Options
    from ..hardware.realise.realisations import FRICTION
    from ..hardware.sizing.wire import wire
    from . import options

    rm = None if strength is None else quantity(strength, "stress", "--strength")
    room = {
        name: options.positive_length(text, f"--{name}")
        for name, text in (("outer", outer), ("length", length))
        if text is not None
    }
    held = dict(FRICTION)
    for text in friction:
        kind, value = named(text, "--friction")
        if kind not in held:
            raise InputError(Fault(("--friction",), f"unknown realisation '{kind}'", tuple(held)))
        held[kind] = share(value, "--friction")
    radius = options.length(pulley, "--pulley")
    if not 0 <= radius < 10:
        raise InputError(Fault(("--pulley",), f"must be from 0 to 10 m, found {pulley}"))
    return Options(
        wires=tuple(wire(name, rm) for name in options.names(wires)),
        limits=Limits.changed(dict(named(text, "--limit") for text in limits)),
        envelope=Envelope(**room),
        pulley=radius,
        most=most,
        friction=held,
    )

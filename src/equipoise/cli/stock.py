"""`equipoise stock` and `equipoise made-up`: parts of a list for a design, and a list to practise with."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..model.errors import Fault, InputError
from . import buildable, options, terminal
from .app import File, Json, app
from .regions import regions

if TYPE_CHECKING:
    from ..hardware import Limits, Stock
    from ..hardware.choose.chosen import Chosen
    from ..model.mechanism import Mechanism

TRAVEL = "0.25:4"


@app.command()
def stock(
    context: typer.Context,
    file: File,
    catalogue: Annotated[Path, typer.Argument(help="springs in stock: .csv or .parquet", show_default=False)],
    output: Annotated[Path | None, typer.Option("-o", "--output", help="write the design: .yaml")] = None,
    goal: Annotated[
        str, typer.Option(help="torque; or mass or price of parts behind eyelets that do exactly what the file's do")
    ] = "torque",
    column: buildable.Columns = None,
    realise: buildable.Realise = None,
    pairs: Annotated[
        str | None, typer.Option(metavar="A:B,...", help="bodies that springs join (default: those of the file's)")
    ] = None,
    radius: Annotated[str | None, typer.Option(help="attachments within this of each body's origin")] = None,
    region: buildable.Region = None,
    springs: Annotated[int | None, typer.Option(min=1, help="of a file without springs: at most this many")] = None,
    parallel: buildable.Parallel = 1,
    max_length: buildable.MaxLength = None,
    max_force: buildable.MaxForce = None,
    pulley: Annotated[str, typer.Option(help="radius of the pulleys")] = "10mm",
    without: buildable.Without = None,
    objective: Annotated[str, typer.Option(help="peak or rms torque")] = "peak",
    safety: buildable.Safety = 1.2,
    fatigue: buildable.Fatigue = 1.0,
    cycles: buildable.Cycles = 1e5,
    travel: Annotated[
        str, typer.Option(metavar="LOW:HIGH", help="with mass or price: how far attachments move on their rays")
    ] = TRAVEL,
    reach: Annotated[str | None, typer.Option(help="and at most this far from the joint")] = None,
    seconds: buildable.Seconds = 60.0,
    seed: Annotated[int, typer.Option(min=0, help="of random places and poses")] = 0,
    json: Json = False,
) -> None:
    """The best parts of a list and where to attach them: a usable answer in seconds, then better ones.

    Example: [bold]equipoise stock arm.yaml list.csv --realise direct --region arm=20mm --region world=250mm[/bold]
    Example: [bold]equipoise stock balanced.yaml vendor.csv --column "rate=R \\[N/mm]" --column kind=extension[/bold]
    """
    from ..hardware import Limits
    from ..io import check_savable

    limits = Limits(safety=safety, fatigue=fatigue, cycles=cycles)
    goals = ("torque", "mass", "price")
    if goal not in goals:
        raise InputError(Fault(("--goal",), f"unknown goal '{goal}'", goals))
    exact = goal != "torque"
    if not exact and (terminal.typed(context, "travel") or reach is not None):
        exact, goal = True, "mass"  # rays are of exact designs only
    moved = _travel(travel, reach)
    asked = buildable.choice(
        limits, realise=realise, parallel=parallel, max_length=max_length, max_force=max_force, pulley=pulley,
        without=without, seconds=seconds, seed=seed, springs=springs, objective=objective,
    )  # fmt: skip
    where = _where(pairs, radius, region)
    mechanism = terminal.load(file)
    parts = buildable.parts(catalogue, column)
    if output:
        check_savable(output)
    if exact:
        parts = tuple(part for part in parts if part.part not in asked.without)
        _exact(mechanism, parts, goal, moved, limits, seconds, output, json)
    else:
        with terminal.progress_bar("looking at the list") as report, terminal.solver_aside():
            from ..hardware import choose_parts

            found = choose_parts(mechanism, parts, asked, progress=report, **where)
        show(found, output, json)
    if output:
        terminal.say(f"wrote {output}")


def show(found: Chosen, output: Path | None, json: bool) -> None:
    """Save a choice, and print it or its JSON object."""
    from ..io import save

    if output:
        save(found.mechanism, output)
    if json:
        terminal.print_json(found.to_dict() | {"balance": found.balance.to_dict()})
        return
    from ..report.parts import chosen_lines

    terminal.show(chosen_lines(found))


def _exact(
    mechanism: Mechanism,
    parts: tuple[Stock, ...],
    goal: str,
    travel: Any,
    limits: Limits,
    seconds: float,
    output: Path | None,
    json: bool,
) -> None:
    from ..balance import check
    from ..hardware.stock.selection import choose
    from ..io import save

    with terminal.progress_bar("judging the design") as report, terminal.solver_aside():
        before = check(mechanism)
        found = choose(
            before, parts, goal=goal, travel=travel, limits=limits, seconds=seconds, progress=report  # type: ignore[arg-type]
        )  # fmt: skip
        after = check(found.mechanism)
    if output:
        save(found.mechanism, output)
    if json:
        terminal.print_json(found.to_dict() | {"balance": after.to_dict()})
        return
    from ..report.bill import choice_lines
    from ..report.verdict import verdict

    terminal.show(choice_lines(found, before, after))
    terminal.show(iter([verdict(after)]))


@app.command(name="made-up")
def made_up(
    output: Annotated[Path, typer.Option("-o", "--output", help=".csv or .parquet", show_default=False)],
    count: Annotated[int, typer.Option(min=1, help="springs")] = 2000,
    kind: Annotated[str | None, typer.Option(help="extension or compression (default: both)")] = None,
    form: Annotated[
        str,
        typer.Option(help="plain, or inch or metric: as vendors write lists, with heads of their own, no kind"),
    ] = "plain",
    seed: Annotated[int, typer.Option(min=0, help="another list")] = 0,
) -> None:
    """A list of springs that no vendor sells, to practise `equipoise stock` with.

    Example: [bold]equipoise made-up -o list.csv --count 500 --kind extension --form inch[/bold]
    """
    from ..hardware.stock.made_up import made_up_catalogue
    from ..hardware.stock.parts import write_catalogue
    from ..hardware.stock.vendors import FORMS, read_with, write_as

    if form not in (*FORMS, "plain"):
        raise InputError(Fault(("--form",), f"unknown form '{form}'", (*FORMS, "plain")))
    springs = made_up_catalogue(count, seed, kind)
    if form == "plain":
        write_catalogue(springs, output)
    else:
        write_as(springs, output, form)
        terminal.say(f"read it with: {read_with(form)}")
    terminal.say(f"wrote {output}: {count} springs, all made up")


def _travel(text: str, reach: str | None) -> Any:
    from ..hardware.stock.movable import Travel

    low, _, high = text.partition(":")
    try:
        ends = float(low), float(high)
    except ValueError:
        raise InputError(Fault(("--travel",), f"expected LOW:HIGH such as 0.25:4, found '{text}'")) from None
    return Travel(*ends) if reach is None else Travel(*ends, options.length(reach, "--reach"))


def _where(pairs: str | None, radius: str | None, region: list[str] | None) -> dict[str, Any]:
    where: dict[str, Any] = {"regions": regions(region or [], box=False)}
    if pairs is not None:
        where["pairs"] = options.pairs(pairs)
    if radius is not None:
        where["radius"] = options.positive_length(radius, "--radius")
    return where

"""`equipoise study`: many designs, and what came out of them."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..model.errors import Fault, InputError
from . import terminal
from .app import Json, app

if TYPE_CHECKING:
    from ..study.dataset import Dataset

TRIED, SECONDS = 8, 10.0  # designs of a dry run, and the time [s] after which no other is tried
REPORTS = 30.0  # [s] between lines about how far it is, where standard error is no terminal


@app.command()
def study(
    path: Annotated[Path, typer.Argument(metavar="STUDY", help="study file, or its folder", show_default=False)],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="folder for the rows; file for --plot and --export")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="go on with the study in the folder")] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="how many designs, and how long they take")] = False,
    workers: Annotated[int | None, typer.Option(min=1, help="processes (default: one for each core)")] = None,
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS", help="a Dask cluster: tcp://HOST:8786")] = None,
    batch: Annotated[int | None, typer.Option(min=1, help="designs at a time (default: five seconds of them)")] = None,
    show: Annotated[str | None, typer.Option(metavar="SQL", help="a query of the table 'rows'")] = None,
    plot: Annotated[
        tuple[str, str] | None, typer.Option(metavar="X Y", help="plot a column against another, to -o FILE")
    ] = None,
    by: Annotated[
        str | None, typer.Option(metavar="Z", help="with --plot: a line for each value of this column")
    ] = None,
    export: Annotated[
        int | None, typer.Option(metavar="ROW", min=0, help="the mechanism of a design, to -o FILE.yaml")
    ] = None,
    json: Json = False,
) -> None:
    """Many designs: vary a mechanism or the options of a command, and get a table of what comes out.

    The rows are Parquet files in the folder. Exit code 1 when no design succeeds.

    Example: [bold]equipoise study arms.yaml -o arms; equipoise study arms --show "SELECT * FROM rows LIMIT 5"[/bold]
    """
    from ..study.dataset import Dataset, needed

    needed()
    looks = [name for name, value in (("--show", show), ("--plot", plot), ("--export", export)) if value is not None]
    if not path.is_dir():
        if looks:
            raise InputError(Fault((looks[0],), f"looks at a study that was run: give its folder, not '{path}'"))
        _run(path, output, resume, dry_run, workers, scheduler, batch, json)
    elif not looks:
        if not resume:
            raise InputError(Fault((), "say what to do: --show, --plot, --export or --resume", file=str(path)))
        _run(path, path, True, dry_run, workers, scheduler, batch, json)
    else:
        _look(Dataset.open(path), output, show, plot, by, export, json)


def _run(
    path: Path,
    output: Path | None,
    resume: bool,
    dry_run: bool,
    workers: int | None,
    scheduler: str | None,
    batch: int | None,
    json: bool,
) -> None:
    from ..report.study import plan_lines, summary_lines
    from ..study.dataset import Dataset
    from ..study.make import cores, run, trial
    from ..study.plan import OK, Plan
    from ..study.read import read

    with terminal.shown_warnings():
        plan = Plan.of(Dataset.open(path).document) if path.is_dir() else read(path)
    if dry_run:
        tried = trial(plan, TRIED, SECONDS)
        count = workers or cores()
        if json:
            facts = {"designs": len(plan), "seconds": tried.seconds, "workers": count, "columns": dict(tried.columns)}
            terminal.print_json(facts)
        else:
            terminal.show(plan_lines(plan, tried, count))
        return
    if output is None:
        raise InputError(Fault(("--output",), "missing: the folder for the rows, or --dry-run"))
    before = _rows(Dataset.open(output)) if resume else 0
    start = time.monotonic()
    try:
        with terminal.progress_bar("starting") as report, terminal.reports(report, REPORTS) as told:
            run(plan, output, workers, scheduler, resume, batch, told)
    except BaseException as error:
        rows = _rows(Dataset.open(output)) if (output / "manifest.json").is_file() else 0
        if rows and not (isinstance(error, InputError) and rows == before):
            terminal.say(f"{rows:,} of {len(plan):,} rows are in {output}: --resume goes on with the others")
        raise
    dataset, seconds = Dataset.open(output), time.monotonic() - start
    table = dataset.query(
        "SELECT status, count(*) AS n, sum(seconds) AS busy FROM rows GROUP BY status ORDER BY n DESC"
    )
    counts = {row["status"]: row["n"] for row in table.to_pylist()}
    busy = sum(row["busy"] for row in table.to_pylist())
    done = sum(counts.values()) - before
    if json:
        facts: dict[str, Any] = {"study": plan.document["name"], "folder": str(output), "designs": len(plan)}
        facts |= {"rows": sum(counts.values()), "status": counts, "new": done}
        terminal.print_json(facts | {"seconds": seconds, "processor_seconds": busy})
    else:
        terminal.show(summary_lines(plan.document["name"], counts, done, seconds, busy))
    terminal.say(f"wrote {output}")
    raise typer.Exit(0 if counts.get(OK) else 1)


def _rows(dataset: Dataset) -> int:
    return sum(stop - start for start, stop in dataset.files())


def _look(
    dataset: Dataset,
    output: Path | None,
    show: str | None,
    plot: tuple[str, str] | None,
    by: str | None,
    export: int | None,
    json: bool,
) -> None:
    from ..report.study import row_lines, save_rows

    if (plot or export is not None) and output is None:
        raise InputError(Fault(("--output",), "missing: the file to write"))
    if plot and export is not None:
        raise InputError("--plot and --export write a file each: give one of them")
    if export is not None and output is not None:
        _export(dataset, export, output)
        return
    rows = dataset.query(show or "SELECT * FROM rows ORDER BY design").to_pylist()
    if plot and output is not None:
        from ..report.figure import check_drawable

        check_drawable(output)
        save_rows(rows, *plot, by, output, dataset.document["name"])
        terminal.say(f"wrote {output}")
    elif json:
        terminal.print_json(rows)
    else:
        terminal.show(row_lines(rows))


def _export(dataset: Dataset, number: int, output: Path) -> None:
    """Make a design again, and say when it is not what its row says."""
    from ..io import check_savable, save
    from ..study.plan import Plan

    check_savable(output)
    plan = Plan.of(dataset.document)
    with terminal.progress_bar("designing again"):
        mechanism = plan.design(number)
        save(mechanism, output)
    terminal.say(f"wrote {output}")

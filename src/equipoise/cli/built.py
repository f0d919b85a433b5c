"""`equipoise design --realise`, `--stock`: springs that can be built, chosen during the search."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..model.errors import InputError
from . import buildable, terminal
from .stock import show

if TYPE_CHECKING:
    from ..balance import Balance
    from ..hardware import Choice
    from ..model.mechanism import Mechanism

ASKED = ("span", "pairs", "radius", "shape", "regions", "joints", "unlimited", "keep", "goal", "weights")
"""Of a design's options, those that say what may be chosen and what for."""


def built(
    mechanism: Mechanism,
    given: dict[str, Any],
    asked: Choice,
    stock: Path | None,
    columns: list[str] | None,
    output: Path | None,
    report: Path | None,
    json: bool,
) -> None:
    """Choose parts of a list, or springs to wind where there is none, for a mechanism, and say what they leave.

    Raises:
        InputError: an option that says nothing about springs that can be built.
    """
    from ..hardware import choose_parts
    from ..hardware.choose.wound import wound
    from ..io import save

    more = given.keys() - {*ASKED, "springs", "objective", "seed", "samples"}
    if more:
        raise InputError(f"--{sorted(more)[0].replace('_', '-')}: does not go with --realise or --stock")
    where = {name: given[name] for name in ASKED if name in given}
    parts = wound(asked.limits, asked.max_length) if stock is None else buildable.parts(stock, columns)
    bare = mechanism if where.get("keep") else mechanism.with_springs(())
    with terminal.progress_bar("looking at the springs") as progress, terminal.solver_aside():
        found = choose_parts(bare, parts, asked, progress=progress, **where)
        if output:
            save(found.mechanism, output)
        if report:
            write(report, found.balance, output)
    show(found, None, json)


def write(path: Path, balance: Balance, file: Path | None) -> None:
    """The report of a design, with what there is to say about its springs."""
    from ..report.page.make import make, save_report

    save_report(make(balance, extras=("hardware",), file=file, command=""), path)

"""`equipoise check`: the verdict."""

from __future__ import annotations

from typing import Annotated

import typer

from ..errors import InputError
from . import terminal
from .app import File, Json, app


@app.command()
def check(
    file: File,
    tolerance: Annotated[
        str, typer.Option(help="good when the peak residual is below this share of the unbalanced peak, or 'X N m'")
    ] = "1e-10",
    samples: Annotated[int | None, typer.Option(min=1, help="random poses (default: the file's workspace)")] = None,
    seed: Annotated[int, typer.Option(min=0, help="of the random poses")] = 0,
    json: Json = False,
) -> None:
    """Is it balanced? Energies, residual torque, certificate, worst pose. Exit code 1 when it is not.

    Example: [bold]equipoise check arm.yaml --tolerance 1%[/bold]
    """
    from ..balance import check as judge
    from ..kinematics import Tree
    from . import options

    share, torque = options.tolerance(tolerance)
    mechanism = terminal.load(file)
    if torque is not None and "m" in Tree.of(mechanism).units:
        raise InputError("--tolerance: a torque says nothing about the sliding joints here; give a share such as 1%")
    with terminal.progress_bar("judging") as report:
        report("judging the balance", 0.0)
        balance = judge(mechanism, samples=samples, seed=seed)
    good = balance.balanced(share or 0.0, torque)
    if json:
        terminal.print_json(balance.to_dict())
    else:
        from ..report.text import balance_lines

        answer = "" if balance.exact else f"{'within' if good else 'not within'} the tolerance of {tolerance}"
        terminal.show(balance_lines(balance, answer))
    raise typer.Exit(0 if good else 1)

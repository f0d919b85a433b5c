"""`equipoise check`: the verdict."""

from __future__ import annotations

from typing import Annotated

import typer

from ..model.errors import InputError
from . import terminal
from .app import File, Json, app


@app.command()
def check(
    context: typer.Context,
    file: File,
    tolerance: Annotated[
        str, typer.Option(help="good when the peak residual is below this share of the unbalanced peak, or 'X N m'")
    ] = "1e-10",
    payload: Annotated[str | None, typer.Option(metavar="LOW,HIGH", help="also sweep a range of payloads")] = None,
    payload_on: Annotated[str | None, typer.Option(metavar="BODY", help="the body that carries it")] = None,
    payload_at: Annotated[str, typer.Option(metavar="X,Y,Z", help="where, in that body's frame")] = "0,0,0",
    steps: Annotated[int, typer.Option(min=2, help="payloads in the sweep")] = 5,
    samples: Annotated[int | None, typer.Option(min=1, help="random poses (default: the file's workspace)")] = None,
    seed: Annotated[int, typer.Option(min=0, help="of the random poses")] = 0,
    json: Json = False,
) -> None:
    """Is it balanced? Energies, residual torque, certificate, worst pose.

    Exit code 1 when it is not, or when a spring is over-stretched, solid or past its stroke in the workspace,
    or when the profile of a cam does not give its energy.

    Example: [bold]equipoise check arm.yaml --tolerance 1%[/bold]
    """
    from ..balance import check as judge
    from ..kinematics import Tree
    from . import options

    share, torque = options.tolerance(tolerance)
    mechanism = terminal.load(file, weightless=payload is not None)
    if torque is not None and not Tree.of(mechanism).turns.all():
        raise InputError("--tolerance: a torque says nothing about the sliding joints here; give a share such as 1%")
    if payload is not None and payload_on is None:
        raise InputError("--payload: needs --payload-on, the body that carries it")
    swept = goal = None
    with terminal.progress_bar("judging") as report:
        report("judging the balance", 0.0)
        balance = judge(mechanism, samples=samples, seed=seed)
        if payload is not None and payload_on is not None:
            from ..robust import sweep

            report("sweeping payloads", 0.0)
            swept = sweep(mechanism, options.payload(mechanism, payload, payload_on, payload_at), steps=steps)
            balance = swept.worst
        if mechanism.goal:
            from ..synthesis.score import score

            report("judging by the goal", 0.0)
            goal = score(mechanism)
    good = balance.balanced(share or 0.0, torque)
    if json:
        terminal.print_json(
            balance.to_dict()
            | ({} if swept is None else {"payload": swept.to_dict()})
            | ({} if goal is None else {"goal": goal.to_dict()})
        )
    else:
        from ..report.text import balance_lines
        from ..report.verdict import next_step

        answer = (
            ""
            if balance.exact or not (mechanism.springs or terminal.typed(context, "tolerance"))
            else f"{'within' if good else 'not within'} the tolerance of {tolerance}"
        )
        terminal.show(balance_lines(balance, answer))
        if goal is not None:
            terminal.show(iter([f"goal: {goal}"]))
        if swept is not None:
            from ..report.robust import sweep_table

            terminal.show(iter(["at the payload with the largest residual; the whole range:", sweep_table(swept)]))
        if follows := next_step(balance, file):
            terminal.show(iter([follows]))
    raise typer.Exit(0 if good and not balance.passed and not balance.unmade else 1)

"""`equipoise certify` and `equipoise verify`: proofs for another program, and that program."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from . import terminal
from .app import File, Json, app


@app.command()
def certify(
    file: File,
    output: Annotated[Path, typer.Option("-o", "--output", help="write the certificate (JSON)")],
    stiffness: Annotated[
        str, typer.Option(help="the bound holds for springs whose stiffnesses add up to at most this")
    ] = "1 MN/m",
    json: Json = False,
) -> None:
    """Write a proof that another program can check: how large the torque is at most, and what no springs can undercut.

    Exit code 1 when the mechanism has no finite form that could be proved.

    Example: [bold]equipoise certify balanced.yaml -o balanced.json[/bold]
    """
    from ..io.files import check_writable
    from ..model.errors import NoFourierForm
    from ..model.units import quantity
    from ..proof.certificate import certify as prove

    limit = quantity(stiffness, "stiffness", "--stiffness")
    mechanism = terminal.load(file)
    check_writable(output)
    with terminal.progress_bar("proving") as report:
        report("proving", 0.0)
        try:
            found = prove(mechanism, stiffness=limit)
        except NoFourierForm as why:
            terminal.say(f"no certificate: {why}")
            raise typer.Exit(1) from None
        found.save(output)
    if json:
        terminal.print_json(found.to_dict())
    else:
        from ..report.certificate import certificate_lines

        terminal.show(certificate_lines(found))
    terminal.say(f"wrote {output}")


@app.command()
def verify(
    certificate: Annotated[Path, typer.Argument(metavar="CERT", help="a certificate that `certify` wrote")],
    json: Json = False,
) -> None:
    """Check a certificate by a program that shares nothing with the one that wrote it.

    Exit code 1 when it does not prove what it claims. The same program as a file by itself: proof/verify.py.

    Example: [bold]equipoise verify balanced.json[/bold]
    """
    from ..proof.certificate import Refused
    from ..proof.certificate import verify as judge

    claims, reason = (), None
    with terminal.progress_bar("verifying") as report:
        report("verifying", 0.0)
        try:
            claims = judge(certificate)
        except Refused as why:
            reason = str(why)
    if json:
        terminal.print_json({"accepted": reason is None, "claims": list(claims), "reason": reason})
    else:
        terminal.show(iter([f"accepted: {', '.join(claims)}" if reason is None else f"refused: {reason}"]))
    raise typer.Exit(0 if reason is None else 1)

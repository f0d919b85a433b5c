"""`equipoise calibrate`: the best rates, preloads and weights for springs whose ends are fixed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..model.errors import Fault, InputError, nearest
from ..model.mechanism import Mechanism
from ..model.units import to_si
from . import terminal
from .app import File, Json, app

DIMENSIONS = {
    "stiffness": "stiffness",
    "free_length": "length",
    "rest": "angle",
    "initial_tension": "force",
    "force": "force",
    "torque": "torque",
    "progression": "number",
    "mass": "mass",
}


@app.command()
def calibrate(
    file: File,
    pose: Annotated[
        list[str] | None,
        typer.Option(metavar="JOINT=VALUE,...", help="where: every joint, in rad or with a unit; may be repeated"),
    ] = None,
    all_: Annotated[bool, typer.Option("--all", help="the whole workspace instead of poses")] = False,
    bound: Annotated[
        list[str] | None,
        typer.Option(metavar="ITEM.FIELD=LOW:HIGH", help="limits, or one value; names a mass that may change"),
    ] = None,
    hold: Annotated[str | None, typer.Option(metavar="A,B,...", help="springs that stay as they are")] = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="write the mechanism with them: .yaml")] = None,
    seed: Annotated[int, typer.Option(min=0, help="with --all: of the random poses")] = 0,
    json: Json = False,
) -> None:
    """The best rates, free lengths or preloads, and masses, where the ends are fixed by the hardware.

    Globally: the largest joint torque at the poses is the least that any settings leave. Of those that leave as little
    the nearest to the file. Masses change where --bound names them.

    Exit code 1 when something must be left; the message has the least, and the proof.

    Example: [bold]equipoise calibrate lamp.xml --pose shoulder=0.4,elbow=-1 --bound "spring 1.stiffness=50:400 N/m"
    -o set.yaml[/bold]
    """
    from ..io import check_savable, save
    from ..synthesis.calibrate import calibrate as run
    from .options import names

    if bool(pose) == all_:
        raise InputError("give --pose JOINT=VALUE,... once or more, or --all for the whole workspace")
    poses = None if all_ else [_pose(text) for text in pose or []]
    mechanism = terminal.load(file)
    if output:
        check_savable(output)
    limits = _bounds(mechanism, bound or [])
    with terminal.progress_bar("calibrating") as report:
        found = run(mechanism, poses, bounds=limits, hold=names(hold or ""), seed=seed, progress=report)
        if output:
            save(found.mechanism, output)
    if json:
        terminal.print_json(found.to_dict())
    else:
        from ..report.calibration import calibration_lines

        terminal.show(calibration_lines(found))
    if output:
        terminal.say(f"wrote {output}")
    raise typer.Exit(0 if found.exact else 1)


def _pose(text: str) -> dict[str, str]:
    """``shoulder=0.4,elbow=-1``."""
    found: dict[str, str] = {}
    for part in text.split(","):
        name, equals, value = (piece.strip() for piece in part.rpartition("="))
        if not equals or not name:
            raise InputError(Fault(("--pose",), f"expected JOINT=VALUE,JOINT=VALUE, found '{part.strip()}'"))
        if name in found:
            raise InputError(Fault(("--pose",), f"'{name}' is given twice"))
        found[name] = value
    return found


def _bounds(mechanism: Mechanism, texts: list[str]) -> dict[str, dict[str, tuple[float, float]]]:
    """``spring 1.stiffness=50:400 N/m``; one value holds a number there."""
    found: dict[str, dict[str, tuple[float, float]]] = {}
    turning = {element.name for element in mechanism.springs if element.path_unit == "rad"}
    for text in texts:
        place, equals, values = text.partition("=")
        item, dot, field = place.strip().rpartition(".")
        if not equals or not dot:
            raise InputError(Fault(("--bound",), f"expected ITEM.FIELD=LOW:HIGH, found '{text}'"))
        if field not in DIMENSIONS:
            raise InputError(Fault(("--bound", item), f"no number {nearest(field, DIMENSIONS)}", tuple(DIMENSIONS)))
        dimension = "torsional stiffness" if field == "stiffness" and item in turning else DIMENSIONS[field]
        low, colon, high = (part.strip() for part in values.partition(":"))
        high = high if colon else low
        unit = high.lstrip("+-.0123456789eE").strip()
        if unit and low.strip("+-.0123456789eE") == "":
            low = f"{low} {unit}"
        try:
            limits = to_si(low, dimension), to_si(high, dimension)
        except InputError as error:
            raise InputError(Fault(("--bound", item, field), str(error))) from None
        found.setdefault(item, {})[field] = limits
    return found

"""`equipoise methods` and `equipoise design`: which methods apply, and what they give."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ..model.errors import InputError, nearest
from ..model.units import share
from . import buildable, goals, terminal
from .app import File, Json, app


@app.command()
def methods(
    file: File,
    method: Annotated[str | None, typer.Option(help="only this one, with its parameters")] = None,
    json: Json = False,
) -> None:
    """Which methods apply, and why the others do not.

    Example: [bold]equipoise methods ur5.urdf --method planar[/bold]
    """
    from ..synthesis import METHODS

    if method is not None and method not in METHODS:
        raise InputError(f"--method: there is no {nearest(method, METHODS)}")
    mechanism = terminal.load(file)
    if json:
        rows = [
            {
                "method": m.name,
                "applies": not m.applies(mechanism),
                "reasons": m.applies(mechanism),
                "summary": m.summary,
                "source": m.source,
                "parameters": {name: parameter.help for name, parameter in m.parameters.items()},
            }
            for m in METHODS.values()
            if method in (None, m.name)
        ]
        terminal.print_json(rows)
    else:
        from ..report.text import method_lines, methods_table

        terminal.show(method_lines(mechanism, METHODS[method]) if method else iter([methods_table(mechanism)]))
        if method is None:
            terminal.say("the parameters of one: equipoise methods FILE --method NAME")


@app.command()
def design(
    context: typer.Context,
    file: File,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="write the design as a mechanism file")] = None,
    plot: Annotated[Path | None, typer.Option(help="write a figure: .svg, .png or .pdf")] = None,
    method: Annotated[str, typer.Option(help="see `equipoise methods`")] = "convex",
    set_: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="a method's parameter")] = None,
    joint: Annotated[
        str | None, typer.Option(help="cam: the joint it is on, or a sum such as shoulder+elbow (see docs/cams.md)")
    ] = None,
    stock: Annotated[Path | None, typer.Option(metavar="LIST", help="take the springs from this list")] = None,
    column: buildable.Columns = None,
    realise: buildable.Realise = None,
    safety: buildable.Safety = 1.2,
    fatigue: buildable.Fatigue = 1.0,
    cycles: buildable.Cycles = 1e5,
    max_length: buildable.MaxLength = None,
    max_force: buildable.MaxForce = None,
    parallel: buildable.Parallel = 1,
    without: buildable.Without = None,
    pulley: Annotated[str, typer.Option(help="with --realise pulley: its radius")] = "10mm",
    seconds: buildable.Seconds = 40.0,
    report: Annotated[Path | None, typer.Option(help="write a report: .html or .pdf")] = None,
    span: Annotated[int, typer.Option(min=1, help="springs join bodies at most this many moving joints apart")] = 2,
    pairs: Annotated[str | None, typer.Option(metavar="A:B,...", help="the pairs of bodies instead of a span")] = None,
    radius: Annotated[
        str | None, typer.Option(help="attachments within this of each body's origin (default: from each link's size)")
    ] = None,
    region: Annotated[
        list[str] | None,
        typer.Option(
            metavar="BODY=REGION",
            help="for one body: 80mm, 'ball 80 mm at X,Y,Z', 'box 100,0,20 mm at JOINT' (half sides, 0 keeps it flat), "
            "'point at X,Y,Z'; may be repeated, several of one body are a union",
        ),
    ] = None,
    box: Annotated[bool, typer.Option("--box", help="regions are boxes of +-radius, not balls")] = False,
    springs: Annotated[int | None, typer.Option(min=0, help="at most this many (default: as few as do)")] = None,
    objective: Annotated[str, typer.Option(help="rms or peak torque")] = "rms",
    joints: Annotated[str | None, typer.Option(metavar="A,B,...", help="the joints that count (default: all)")] = None,
    payload: goals.Payload = None,
    payload_on: goals.On = None,
    payload_at: goals.At = "0,0,0",
    tilt: goals.Tilt = None,
    share_of: goals.ShareOf = None,
    joint_weight: goals.Weights = None,
    motion: goals.Motion = None,
    heat: goals.Heat = False,
    prefer: Annotated[
        str | None, typer.Option(help="force, energy, length or rate: least among equally good designs")
    ] = None,
    front: Annotated[bool, typer.Option("--front", help="also the residual against the number of springs")] = False,
    exact: Annotated[bool, typer.Option("--exact", help="insist on exact balance; exit code 1 if infeasible")] = False,
    unlimited: Annotated[
        bool, typer.Option("--unlimited", help="all turning joints over +-180 deg, whatever their range")
    ] = False,
    keep: Annotated[
        bool, typer.Option("--keep", help="the file's own springs stay (default: they are replaced)")
    ] = False,
    torsion: Annotated[
        str | None, typer.Option(metavar="A,B,...|all", help="joints that may have a torsion spring too")
    ] = None,
    tune: Annotated[
        str | None,
        typer.Option(metavar="A,B,...", help="springs of the file whose numbers are chosen too, with their ends kept"),
    ] = None,
    counterweights: Annotated[
        str | None,
        typer.Option(metavar="LENGTH|BODY=LENGTH,...", help="weights too, within this of the links' origins"),
    ] = None,
    residual: Annotated[
        str | None,
        typer.Option(help="with --counterweights: what may be left of the unbalanced rms torque (default 0%)"),
    ] = None,
    free_length: Annotated[
        list[str] | None,
        typer.Option(metavar="[SPRING=]LENGTH", help="make the best of springs with a free length; may be repeated"),
    ] = None,
    clearance: Annotated[
        str | None, typer.Option(help="move springs until they keep this from each other and from the file's capsules")
    ] = None,
    diameter: Annotated[str | None, typer.Option(help="with --clearance: outer diameter of the springs")] = None,
    stiffness_factor: Annotated[
        float, typer.Option(min=1, help="with --free-length or --clearance: stiffness may change by this factor")
    ] = 5.0,
    preload: Annotated[
        str, typer.Option(help="with --free-length: the share of it that initial tension may take away")
    ] = "0%",
    samples: Annotated[
        int | None, typer.Option(min=1, help="random poses to judge on (default: exact averages where possible)")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="of random starts and poses")] = 0,
    json: Json = False,
) -> None:
    """Choose springs, and say how far from the best possible they are.

    Example: [bold]equipoise design ur5.urdf --span 3 --radius 150mm --springs 3 -o balanced.yaml --plot ur5.svg[/bold]
    """
    from ..hardware import Limits
    from ..io import check_savable, save
    from ..report.figure import check_drawable, save_figure
    from ..report.page.make import check_report
    from ..synthesis import METHODS, by_name
    from . import options, weights
    from .built import built, write
    from .cam_options import for_cam
    from .regions import regions, sizes

    given: dict[str, Any] = {
        "span": span,
        "pairs": None if pairs is None else options.pairs(pairs),
        "radius": None if radius is None else options.length(radius, "--radius"),
        "shape": "box" if box else "ball",
        "regions": regions(region or [], box),
        "springs": springs,
        "objective": objective,
        "joints": None if joints is None else options.names(joints),
        "samples": samples,
        "unlimited": unlimited,
        "exact": exact,
        "front": front,
        "prefer": prefer,
        "keep": keep,
        "seed": seed,
        "torsion": None if torsion is None else options.names(torsion),
        "tune": None if tune is None else options.names(tune),
        "counterweights": None if counterweights is None else weights.counterweights(counterweights),
        "residual": None if residual is None else share(residual, "--residual"),
    }
    # a method knows its own defaults, and is told only what was asked for
    asked = {"regions": "region", "shape": "box"}
    given = {name: value for name, value in given.items() if terminal.typed(context, asked.get(name, name))}
    if method in METHODS:
        more = options.settings(set_ or [], METHODS[method].parameters)
        for name in given.keys() & more.keys():
            raise InputError(f"--{name} and --set {name} both give '{name}': leave out one of them")
        given |= more
    real = realise is not None or (stock is not None and method != "cam")
    given |= for_cam(method, joint, None if real else stock, column)
    alone = () if real else tuple(name for name in buildable.ONLY if name != "column" or stock is None)
    goes_with = [f"--{name.replace('_', '-')}" for name in alone if terminal.typed(context, name)]
    if goes_with:
        raise InputError(f"{goes_with[0]}: needs --realise, or --stock with a list")
    wound = {"stiffness_factor": stiffness_factor, "preload": share(preload, "--preload")}
    lengths = options.free_lengths(free_length or [])
    room = None if clearance is None else options.length(clearance, "--clearance")
    thick = None if diameter is None else options.positive_length(diameter, "--diameter")
    if room is None and thick is not None:
        raise InputError("--diameter: needs --clearance, the distance that is kept")
    mechanism = terminal.load(file)
    goal = goals.asked(mechanism, payload, payload_on, payload_at, tilt, share_of, joint_weight or [], motion, heat)
    if goal is not None:
        given["goal"] = goal
    sizes(mechanism, given.get("radius"), given.get("regions", {}))
    if output:
        check_savable(output)  # before the work, not after it
    if plot:
        check_drawable(plot)
    if report:
        check_report(report)
    if mechanism.springs and not keep and "profile_of" not in given:
        terminal.say(f"note: springs that the file has are replaced ({len(mechanism.springs)}); --keep keeps them")
    if real:
        asked_of = buildable.choice(
            Limits(safety=safety, fatigue=fatigue, cycles=cycles), realise=realise, parallel=parallel,
            max_length=max_length, max_force=max_force, pulley=pulley, without=without, seconds=seconds, seed=seed,
            springs=springs, objective=given.get("objective", "peak"),
        )  # fmt: skip
        built(mechanism, given, asked_of, stock, column, output, report, json)
        for path in filter(None, (output, report)):
            terminal.say(f"wrote {path}")
        return
    with terminal.progress_bar("designing") as progress:
        found = by_name(mechanism, method, progress=progress, **given)
        if thick is not None:
            found = found.with_diameter(thick)
        if lengths is not None or room is not None:
            progress("moving the springs", 0.0)
            found = found.with_ordinary_springs(lengths, clearance=room, regions=given.get("regions"), **wound)
        progress("judging the design", 0.0)
        balance = found.balance
        if output:
            save(found.mechanism, output)
        if plot:
            progress("drawing", 0.0)
            save_figure(found.mechanism, plot, balance=balance)
        if report:
            write(report, balance, output)
    if json:
        terminal.print_json(found.to_dict())
    else:
        from ..report.text import design_lines

        terminal.show(design_lines(found))
    for path in filter(None, (output, plot, report)):
        terminal.say(f"wrote {path}")

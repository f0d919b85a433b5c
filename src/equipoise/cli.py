"""The command line. Results go to standard output, messages to standard error.

Exit codes: 0 good, 1 the answer is "no" (not balanced, infeasible), 2 bad input.
"""

from __future__ import annotations

import os
import sys
from io import TextIOWrapper
from pathlib import Path
from typing import Annotated, Any

import typer

from . import terminal
from ._version import __version__
from .errors import EquipoiseError, InputError

app = typer.Typer(
    name="equipoise",
    help="Design the springs that make a robot weightless, and prove it.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

File = Annotated[Path, typer.Argument(help="mechanism file: .yaml or .urdf", show_default=False)]
Json = Annotated[bool, typer.Option("--json", help="print one JSON object on standard output")]


def main() -> None:
    """The entry point: errors become one message and an exit code, never a traceback."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal that lacks a letter is no reason to fail
    try:
        app()
    except KeyboardInterrupt:
        typer.echo("interrupted", err=True)
        sys.exit(130)
    except EquipoiseError as error:
        typer.echo(f"error: {error}", err=True)
        sys.exit(error.exit_code)
    except BrokenPipeError:  # the reader of our output has closed it, `| head` for example
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
    except OSError as error:
        typer.echo(f"error: {(error.strerror or str(error)).lower()}", err=True)
        sys.exit(2)
    except Exception as error:
        if os.environ.get("EQUIPOISE_DEBUG"):
            raise
        text = f"internal error: {type(error).__name__}: {error}\nPlease report it; EQUIPOISE_DEBUG=1 shows where."
        typer.echo(text, err=True)
        sys.exit(2)


def _version(value: bool) -> None:
    if value:
        typer.echo(f"equipoise {__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="print the version")
    ] = False,
) -> None: ...


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
    from . import options
    from .balance import check as judge

    share, torque = options.tolerance(tolerance)
    mechanism = terminal.load(file)
    if torque is not None and "m" in mechanism.coordinate_units:
        raise InputError("--tolerance: a torque says nothing about the sliding joints here; give a share such as 1%")
    with terminal.progress_bar("judging") as report:
        report("judging the balance", 0.0)
        balance = judge(mechanism, samples=samples, seed=seed)
    good = balance.balanced(share or 0.0, torque)
    if json:
        terminal.print_json(balance.to_dict())
    else:
        from .report.text import balance_lines

        answer = "" if balance.exact else f"{'within' if good else 'not within'} the tolerance of {tolerance}"
        terminal.show(balance_lines(balance, answer))
    raise typer.Exit(0 if good else 1)


@app.command()
def methods(file: File, json: Json = False) -> None:
    """Which methods apply, and why the others do not.

    Example: [bold]equipoise methods ur5.urdf[/bold]
    """
    from .synthesis import METHODS

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
        ]
        terminal.print_json(rows)
    else:
        from .report.text import methods_table

        terminal.show(iter([methods_table(mechanism)]))


@app.command()
def design(
    context: typer.Context,
    file: File,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="write the design as a mechanism file")] = None,
    plot: Annotated[Path | None, typer.Option(help="write a figure: .svg, .png or .pdf")] = None,
    method: Annotated[str, typer.Option(help="see `equipoise methods`")] = "convex",
    set_: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="a method's parameter")] = None,
    span: Annotated[int, typer.Option(min=1, help="springs join bodies at most this many moving joints apart")] = 2,
    pairs: Annotated[str | None, typer.Option(metavar="A:B,...", help="the pairs of bodies instead of a span")] = None,
    radius: Annotated[
        str | None, typer.Option(help="attachments within this of each body's origin (default: from each link's size)")
    ] = None,
    region: Annotated[
        list[str] | None, typer.Option(metavar="BODY=RADIUS", help="another radius for one body; may be repeated")
    ] = None,
    box: Annotated[bool, typer.Option("--box", help="regions are boxes of +-radius, not balls")] = False,
    springs: Annotated[int | None, typer.Option(min=1, help="at most this many (default: as few as do)")] = None,
    objective: Annotated[str, typer.Option(help="rms or peak torque")] = "rms",
    joints: Annotated[str | None, typer.Option(metavar="A,B,...", help="the joints that count (default: all)")] = None,
    front: Annotated[bool, typer.Option("--front", help="also the residual against the number of springs")] = False,
    exact: Annotated[bool, typer.Option("--exact", help="insist on exact balance; exit code 1 if infeasible")] = False,
    unlimited: Annotated[
        bool, typer.Option("--unlimited", help="all turning joints over +-180 deg, whatever their range")
    ] = False,
    keep: Annotated[
        bool, typer.Option("--keep", help="the file's own springs stay (default: they are replaced)")
    ] = False,
    samples: Annotated[
        int | None, typer.Option(min=1, help="random poses to judge on (default: exact averages where possible)")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="of random starts and poses")] = 0,
    json: Json = False,
) -> None:
    """Choose springs, and say how far from the best possible they are.

    Example: [bold]equipoise design ur5.urdf --span 3 --radius 150mm --springs 3 -o balanced.yaml --plot ur5.svg[/bold]
    """
    from . import options
    from .io import check_savable, save
    from .report.figure import check_drawable, save_figure
    from .synthesis import METHODS
    from .synthesis import design as run

    given: dict[str, Any] = {
        "span": span,
        "pairs": None if pairs is None else options.pairs(pairs),
        "radius": None if radius is None else options.length(radius, "--radius"),
        "shape": "box" if box else "ball",
        "regions": options.regions(region or [], box),
        "springs": springs,
        "objective": objective,
        "joints": None if joints is None else options.names(joints),
        "samples": samples,
        "unlimited": unlimited,
        "exact": exact,
        "front": front,
        "keep": keep,
        "seed": seed,
    }
    # a method knows its own defaults, and is told only what was asked for
    asked = {"regions": "region", "shape": "box"}
    given = {name: value for name, value in given.items() if terminal.typed(context, asked.get(name, name))}
    if method in METHODS:
        given |= options.settings(set_ or [], METHODS[method].parameters)
    mechanism = terminal.load(file)
    if output:
        check_savable(output)  # before the work, not after it
    if plot:
        check_drawable(plot)
    if mechanism.springs and not keep:
        terminal.say(f"note: springs that the file has are replaced ({len(mechanism.springs)}); --keep keeps them")
    with terminal.progress_bar("designing") as report:
        found = run(mechanism, method, progress=report, **given)
        report("judging the design", 0.0)
        balance = found.balance
        if output:
            save(found.mechanism, output)
        if plot:
            report("drawing", 0.0)
            save_figure(found.mechanism, plot, balance=balance)
    if json:
        terminal.print_json(found.to_dict())
    else:
        from .report.text import design_lines

        terminal.show(design_lines(found))
    for path in filter(None, (output, plot)):
        terminal.say(f"wrote {path}")


@app.command()
def export(
    file: File,
    to: Annotated[str, typer.Option("--to", help="yaml, urdf or mjcf", show_default=False)],
    output: Annotated[Path | None, typer.Option("-o", "--output", help="default: standard output")] = None,
) -> None:
    """Write a mechanism in another format; springs become spatial tendons in MJCF and are left out of URDF.

    Example: [bold]equipoise export ur5-balanced.yaml --to mjcf -o ur5.xml[/bold]
    """
    from importlib import import_module

    from .errors import Fault, nearest
    from .io import WRITERS
    from .io.files import write_text

    if to not in WRITERS:
        raise InputError(Fault(("--to",), f"unknown format {nearest(to, WRITERS)}", tuple(WRITERS)))
    with terminal.shown_warnings():
        text = import_module(f".io.{to}", __package__).to_text(terminal.load(file))
    if output is None:
        typer.echo(text, nl=False)
    else:
        write_text(output, text)
        terminal.say(f"wrote {output}")


@app.command()
def demo(
    folder: Annotated[Path, typer.Option("-o", "--output", help="folder for the design and its figure")] = Path(
        "equipoise-demo"
    ),
) -> None:
    """The main job on a real robot, start to finish: a UR5 made weightless by three springs.

    Example: [bold]equipoise demo -o my-demo[/bold]
    """
    from .demo import run

    with terminal.shown_warnings(), terminal.progress_bar("demo") as report:
        lines = run(folder, report)
    terminal.show(iter(lines))

"""Options about springs that exist: what `hardware`, `stock`, `design` and `report` share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from ..model.errors import Fault, InputError
from ..model.units import quantity
from . import options

if TYPE_CHECKING:
    from pathlib import Path

    from ..hardware import Choice, Limits, Stock

Safety = Annotated[float, typer.Option(min=0.01, help="static margin asked for: permissible over largest stress")]
Fatigue = Annotated[float, typer.Option(min=0, help="Goodman margin asked for at --cycles; 0: none")]
Cycles = Annotated[float, typer.Option(min=1, help="from the least to the largest force and back, to live through")]
Realise = Annotated[
    str | None, typer.Option(metavar="A,B,...", help="direct, eyelet, pulley: how springs may be built in")
]
Parallel = Annotated[int, typer.Option(min=1, max=8, help="at most this many equal parts side by side as one spring")]
MaxLength = Annotated[str | None, typer.Option(help="largest length of a spring in use, such as 300mm")]
MaxForce = Annotated[str | None, typer.Option(help="largest force of a spring in use, such as 200N")]
Without = Annotated[list[str] | None, typer.Option(metavar="PART", help="a part that is sold out; may be repeated")]
Columns = Annotated[
    list[str] | None,
    typer.Option(
        "--column",
        metavar="NAME=HEADER",
        help="which column is which, with its unit in brackets, or what holds for all parts: kind=extension",
    ),
]
Seconds = Annotated[float, typer.Option(min=0.1, help="stop with the best so far and its gap")]
Region = Annotated[
    list[str] | None, typer.Option(metavar="BODY=REGION", help="where ends on a body may be; may be repeated")
]

ONLY = ("safety", "fatigue", "cycles", "max_length", "max_force", "parallel", "without", "pulley", "seconds", "column")
"""Options of `design` that speak of springs that can be built."""


def named(text: str, option: str) -> tuple[str, str]:
    """``NAME=VALUE``.

    Raises:
        InputError: it is not.
    """
    name, equals, value = text.partition("=")
    if not equals or not name.strip() or not value.strip():
        raise InputError(Fault((option,), f"expected NAME=VALUE, found '{text}'"))
    return name.strip(), value.strip()


def parts(file: Path, columns: list[str] | None) -> tuple[Stock, ...]:
    """A list of parts, by `--column`."""
    from ..hardware import read_catalogue

    return read_catalogue(file, dict(named(text, "--column") for text in columns or []))


def choice(
    limits: Limits,
    *,
    realise: str | None,
    parallel: int,
    max_length: str | None,
    max_force: str | None,
    pulley: str,
    without: list[str] | None,
    seconds: float,
    seed: int = 0,
    springs: int | None = None,
    objective: str = "peak",
) -> Choice:
    """What is asked of parts.

    Raises:
        InputError: an unknown realisation, or not a length or force.
    """
    from ..hardware import Choice

    room: dict[str, float] = {}
    if max_length:
        room["max_length"] = options.positive_length(max_length, "--max-length")
    if max_force is not None:
        room["max_force"] = quantity(max_force, "force", "--max-force")
        if not room["max_force"] > 0:
            raise InputError(Fault(("--max-force",), f"must be more than 0 N, found {max_force}"))
    ways: tuple[str, ...] = tuple(options.names(realise)) if realise else ("direct", "eyelet")
    return Choice(
        realise=ways,  # type: ignore[arg-type]  # checked there
        springs=springs,
        parallel=parallel,
        limits=limits,
        pulley=options.length(pulley, "--pulley"),
        without=tuple(without or ()),
        objective=objective,
        seconds=seconds,
        seed=seed,
        **room,
    )

"""Make a report and write it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from importlib.util import find_spec
from pathlib import Path

from ...balance import Balance, judged
from ...hardware import Limits
from ...io import Source
from ...io.files import check_writable, write_bytes
from ...model.errors import Fault, InputError, nearest
from ...model.progress import Progress, silent
from ...model.units import Amount
from .. import style
from ..verdict import verdict
from . import design
from . import hardware as built
from .content import Report
from .hardware import EXTRAS
from .html import page
from .pdf import pdf
from .workshop import workshop_section

NEEDS = ("jinja2", "matplotlib", "typst")
WRITERS: dict[str, Callable[[Report], bytes]] = {".html": lambda report: page(report).encode(), ".pdf": pdf}


def make(
    balance: Balance | Source,
    *,
    extras: Iterable[str] = EXTRAS,
    seed: int = 0,
    radius: Amount | None = None,
    limits: Limits | None = None,
    date: str = "",
    file: Path | None = None,
    command: str = "",
    progress: Progress | None = None,
) -> Report:
    """The report of a judged mechanism.

    Args:
        extras: of `EXTRAS`, what else to look into; where a mechanism does not allow one, its section says why.
        seed: of the random poses and builds of the extras.
        radius: [m] of the uniform spheres that stand for bodies without an inertia in the simulation.
        limits: the margins that springs to wind must have.
        date: of the report, as it is to stand there.
        file: where the mechanism is from; command: what gives this report again.

    Raises:
        InputError: an unknown extra.
    """
    wanted, balance = tuple(extras), judged(balance)
    for name in wanted:
        if name not in EXTRAS:
            raise InputError(Fault(("with",), f"no section {nearest(name, EXTRAS)}", EXTRAS))
    report = progress or silent
    found = built.run(balance, wanted, seed, radius, limits or Limits(), report)
    report("drawing", 0.0)
    results = {name: getattr(found, name) for name in EXTRAS}
    return Report(
        title=style.clean(balance.mechanism.name, 200),
        verdict=verdict(balance).plain,
        good=balance.exact,
        sections=(
            workshop_section(balance, found.hardware, date),
            design.mechanism_section(balance),
            design.torque_section(balance),
            design.certificate_section(balance),
            *built.sections(found),
            design.conventions_section(balance),
            design.origin_section(balance, file, command),
        ),
        data={"balance": balance.to_dict()}
        | {
            name: {"not_run": result} if isinstance(result, str) else result.to_dict()
            for name, result in results.items()
            if result is not None
        },
    )


def write(
    balance: Balance | Source,
    path: str | os.PathLike[str],
    *,
    extras: Iterable[str] = EXTRAS,
    seed: int = 0,
    radius: Amount | None = None,
    limits: Limits | None = None,
) -> Report:
    """Write the report of a mechanism, its file or its verdict, as .html or .pdf; see `make`.

    Raises:
        InputError: as `check_report` and `make`.
    """
    check_report(path)
    made = make(balance, extras=extras, seed=seed, radius=radius, limits=limits)
    save_report(made, path)
    return made


def check_report(path: str | os.PathLike[str]) -> None:
    """Whether a report could be written there, asked before long work.

    Raises:
        InputError: another suffix than .html or .pdf, something is not installed, or the folder cannot be written to.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in WRITERS:
        found = f"a report cannot be written as '{suffix}'"
        raise InputError(Fault((), found, tuple(WRITERS), file=os.fspath(path)))
    missing = [name for name in NEEDS if find_spec(name) is None]
    if missing:
        raise InputError(f"reports need {', '.join(missing)}: pip install 'equipoise[report]'")
    check_writable(path)


def save_report(report: Report, path: str | os.PathLike[str]) -> None:
    """Write it, whole or not at all.

    Raises:
        InputError: as `check_report`.
    """
    check_report(path)
    write_bytes(path, WRITERS[Path(path).suffix.lower()](report))

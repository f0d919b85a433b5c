"""`study`: the whole of it, from the file to the rows."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..model.errors import Fault, InputError
from ..model.progress import Progress, silent
from ..model.validate import whole_number
from .batch import packed
from .dataset import Dataset, check_free, needed
from .drive import drive
from .plan import AFTER, FAILED, FIXED, OK, Plan
from .read import read
from .workers import Processes, Workers

if TYPE_CHECKING:
    import pyarrow as pa

TRIED = 3  # designs before a study begins: they tell mistakes, the kinds of columns, and how long one takes
SECONDS = 5.0  # of a batch
SHORT, LEAST, MOST = 0.05, 100, 10_000  # [s] of a short design; designs in a batch of such, and in any
SHARE = 4  # batches for each worker at least, where that leaves LEAST in each


@dataclass(frozen=True)
class Trial:
    """What a few designs of a study tell.

    Attributes:
        rows: theirs.
        seconds: of processor time that a design takes, the first one apart, which compiles.
        columns: name -> type, of the whole study.
    """

    rows: tuple[dict[str, Any], ...]
    seconds: float
    columns: Mapping[str, str]


def study(
    study: str | os.PathLike[str] | Mapping[str, Any],
    folder: str | os.PathLike[str] | None = None,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    resume: bool = False,
    batch: int | None = None,
    progress: Progress | None = None,
) -> pa.Table:
    """Run a study, and return its rows in the order of the designs.

    Args:
        study: its file, or a mapping as the file has it.
        folder: where the rows are kept, written while they are made; else they are only returned.
        workers: processes of this machine, all its cores by default.
        scheduler: the address of a Dask cluster that works instead, such as ``tcp://10.0.0.1:8786``.
        resume: go on with the study in the folder.
        batch: designs that a worker is given at a time; by default as many as take five seconds.

    Raises:
        InputError: the study is wrong, the folder cannot be used, or no scheduler answers.
        EquipoiseError: there are no workers any more.
    """
    needed()
    plan = read(study)
    if folder is not None:
        run(plan, Path(folder), workers, scheduler, resume, batch, progress or silent)
        return Dataset.open(Path(folder)).table()
    if resume:
        raise InputError(Fault(("resume",), "needs the folder of the study"))
    with tempfile.TemporaryDirectory() as temporary:
        run(plan, Path(temporary), workers, scheduler, False, batch, progress or silent)
        return Dataset.open(Path(temporary)).table()


def run(
    plan: Plan,
    folder: Path,
    workers: int | None = None,
    scheduler: str | None = None,
    resume: bool = False,
    batch: int | None = None,
    progress: Progress = silent,
) -> None:
    """Write what is missing of a study into its folder; see `study`."""
    needed()
    for name, value in (("workers", workers), ("batch", batch)):
        if value is not None:
            whole_number(name, value, 1)
    count = workers or cores()
    there = Dataset.open(folder) if resume else None
    if there is None:
        check_free(folder)
    elif there.hash != plan.hash:
        raise InputError(Fault((), "holds another study: its file or its mechanisms have changed", file=str(folder)))
    else:
        there.verify()
        if not there.missing():
            return
    make = _workers(plan, count, scheduler)  # a scheduler that is not there is told before any work
    try:
        progress("trying a few designs", 0.0)
        tried = trial(plan)
        there = there or Dataset.begin(folder, plan, tried.columns)
    except BaseException:
        make.close()
        raise
    size = batch or batch_size(tried.seconds, len(plan), count)
    with there.held():
        drive(plan, there, make, size, progress)


def cores() -> int:
    """How many this program may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def batch_size(seconds: float, designs: int, workers: int) -> int:
    """How many designs a worker is given at a time, from the processor time of one."""
    size = int(min(MOST, max(1.0, SECONDS / max(seconds, 1e-9))))
    shared = -(-designs // (SHARE * workers))
    return max(1, min(size, max(shared, LEAST if seconds <= SHORT else 1)))


def trial(plan: Plan, designs: int = TRIED, most: float = float("inf")) -> Trial:
    """Make a few designs, spread over the study, here.

    Args:
        most: [s] after which no other is begun.

    Raises:
        InputError: an option or a recorded path is wrong; the message gives the parameter.
    """
    numbers = sorted({i * (len(plan) - 1) // max(1, designs - 1) for i in range(designs)})
    rows, start = list[dict[str, Any]](), time.monotonic()
    for number in numbers:
        if rows and time.monotonic() - start > most:
            break
        rows.append(plan.row(number))
        if rows[-1]["status"] == FAILED:
            _mistake(plan, number)
    seconds = [row["seconds"] for row in rows[1:] or rows]
    return Trial(tuple(rows), sum(seconds) / len(seconds), _columns(plan, rows))


def _mistake(plan: Plan, number: int) -> None:
    """Whether a design failed for what stands in the study, and not for what it is.

    Raises:
        InputError: so it did.
    """
    try:
        results = plan.results(plan.values(number))
        for one in plan.record:
            one.of(results)
    except InputError as error:
        places = _places(plan)
        named = [(places.get(str(fault.path[0]).lstrip("-")), fault) for fault in error.faults if fault.path]
        faults = [Fault(place, fault.message, fault.choices) for place, fault in named if place is not None]
        if faults and plan.located is not None:
            raise plan.located.error(plan.located.locate(fault, on_key=True) for fault in faults) from None
        if faults:
            raise InputError(faults) from None
    except Exception:  # a row says it
        return


def _places(plan: Plan) -> dict[str, tuple[str | int, ...]]:
    """Where in the study the options stand, by the names that faults have."""
    found: dict[str, tuple[str | int, ...]] = {"record": ("record",)}
    for command, options in plan.document["run"].items():
        found |= {name: ("run", command, name) for name in options or {}}
    return found | {target.option: ("vary", name) for name, target in plan.targets.items() if target.option}


def _columns(plan: Plan, rows: list[dict[str, Any]]) -> dict[str, str]:
    results = {}
    for one in plan.record:
        kinds = {_kind(row[one.name]) for row in rows if row["status"] == OK and row[one.name] is not None}
        results[one.name] = one.type or (kinds.pop() if len(kinds) == 1 else "double" if not kinds else "string")
    return {**FIXED, **plan.parameters, **results, **AFTER}


def _kind(value: Any) -> str:
    return "bool" if isinstance(value, bool) else "double" if isinstance(value, (int, float)) else "string"


def _workers(plan: Plan, count: int, scheduler: str | None) -> Workers:
    if scheduler is None:
        return Processes(packed(plan), count)
    from .cluster import Cluster

    return Cluster(packed(plan), scheduler)

"""Every method and span on one mechanism, side by side: what each leaves, needs and weighs, and can it be built?

Each row is worked out in a process of its own, which is ended when its time is over: what it has by then counts.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from typing import Any

from ..io import Source, loaded
from ..kinematics import Tree
from ..model.errors import EquipoiseError, InputError, shortened
from ..model.mechanism import Mechanism
from ..model.notebook import Shown
from ..model.progress import Progress, silent
from ..synthesis import METHODS, by_name, reasons

SECONDS = 30.0  # [s] that a row may take
SPANS = (1, 2, 3)
UNKNOWN = "its time was over"


@dataclass(frozen=True)
class Compared:
    """One way to balance the mechanism; None is what is not known.

    Attributes:
        left: largest torque with springs, of the largest without; bound: what no such springs undercut, root mean
            square, and `rms` what these leave of the same, both as shares.
        springs: how many; force: the largest of any [N]; energy: the most that all of them store [J].
        mass: [kg] of the springs that hardware would choose; buildable: whether each can be made.
        note: why there is no design, or why it cannot be built.
        seconds: what it took [s].
    """

    name: str
    method: str
    options: dict[str, Any] = field(default_factory=dict)
    exact: bool | None = None
    left: float | None = None
    rms: float | None = None
    bound: float | None = None
    springs: int | None = None
    force: float | None = None
    energy: float | None = None
    mass: float | None = None
    buildable: bool | None = None
    note: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Comparison(Shown):
    """All rows, in the order of `plan`."""

    mechanism: Mechanism
    rows: tuple[Compared, ...]

    def to_dict(self) -> dict[str, Any]:
        """The JSON object of ``equipoise compare --json``."""
        return {"mechanism": self.mechanism.name, "rows": [asdict(row) for row in self.rows]}


def plan(mechanism: Mechanism, spans: Sequence[int] = SPANS) -> list[Compared]:
    """The rows to work out: the convex program for each span, then the published methods; and why not."""
    most = max(1, Tree.of(mechanism).n)
    rows = [
        Compared(f"convex, span {span}", "convex", {"span": span})
        for span in sorted({min(span, most) for span in spans})
    ]
    why = reasons(mechanism)
    others = [Compared(name, name, note=next(iter(why[name]), "")) for name in METHODS if name != "convex"]
    return rows + sorted(others, key=lambda row: row.note != "")


def compare(
    mechanism: Source,
    *,
    spans: Sequence[int] = SPANS,
    seconds: float = SECONDS,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Comparison:
    """Work out every row.

    Args:
        mechanism: or the path of its file.
        spans: of the convex program.
        seconds: [s] that each row may take.
        workers: rows at the same time, by default one for each core.

    Raises:
        InputError: a bad option, or as `load`.
    """
    mechanism = loaded(mechanism)
    report, rows = progress or silent, plan(mechanism, spans)
    done: dict[str, Compared] = {}
    for row in worked_out(mechanism, rows, seconds, workers):
        done[row.name] = row
        report(row.name, len(done) / len(rows))
    return Comparison(mechanism, tuple(done[row.name] for row in rows))


def worked_out(
    mechanism: Mechanism, rows: Sequence[Compared], seconds: float = SECONDS, workers: int | None = None
) -> Iterator[Compared]:
    """The rows as they get ready, those of methods that do not apply last."""
    if not seconds > 0:
        raise InputError(f"--seconds: must be more than 0 s, found {seconds:g}")
    waiting = [row for row in rows if not row.note]
    running: dict[Connection, tuple[Any, Compared, float]] = {}
    context, count = get_context("spawn"), workers or os.cpu_count() or 1
    try:
        while waiting or running:
            while waiting and len(running) < count:
                row, (ours, theirs) = waiting.pop(0), context.Pipe(duplex=False)
                process = context.Process(target=_work, args=(theirs, mechanism, row), daemon=True)
                process.start()
                theirs.close()
                running[ours] = (process, row, time.monotonic() + seconds)
            next_end = min(end for _, _, end in running.values())
            wait(list(running), max(0.0, next_end - time.monotonic()))
            for ours, (process, row, end) in list(running.items()):
                over = time.monotonic() >= end
                latest, last = _received(ours, row)
                if last or over:
                    yield replace(latest, note=latest.note or ("" if last else UNKNOWN))
                    del running[ours]
                    process.kill()
                    process.join()
                else:
                    running[ours] = (process, latest, end)
    finally:
        for process, _, _ in running.values():
            process.kill()
    yield from (row for row in rows if row.note)


def _received(ours: Connection, row: Compared) -> tuple[Compared, bool]:
    """The newest that a process has said, and whether it was the last."""
    try:
        while ours.poll():
            row, last = ours.recv()
            if last:
                return row, True
    except (EOFError, OSError):
        return replace(row, note=row.note or "its process died: is there enough memory?"), True
    return row, False


def _work(theirs: Connection, mechanism: Mechanism, row: Compared) -> None:
    """One row: the design is sent as soon as it is known, and again with what hardware says."""
    from ..hardware import bill

    began = time.monotonic()
    try:
        design = by_name(mechanism, row.method, **row.options)
        balance, unit = design.balance, design.unbalanced
        row = replace(
            row,
            exact=balance.exact,
            left=balance.relative,
            rms=design.residual / unit if unit else None,
            bound=None if design.bound is None or not unit else design.bound / unit,
            springs=len(design.mechanism.springs),
            force=max((use.max_force for use in balance.use), default=0.0),
            energy=balance.springs[1],
            seconds=time.monotonic() - began,
        )
        theirs.send((row, False))
        made = bill(balance)
        hopeless = "; ".join(item.hopeless for item in made.items if not item.chosen)
        row = replace(row, buildable=made.complete, mass=made.mass if made.complete else None, note=hopeless)
    except EquipoiseError as error:
        row = replace(row, note=shortened(str(error), 400))
    theirs.send((replace(row, seconds=time.monotonic() - began), True))

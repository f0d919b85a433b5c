"""Chooses springs that exist for a mechanism: which parts, where, and how far the answer can be from the best."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..._version import __version__
from ...balance import Balance, check
from ...io import Source, loaded
from ...model.arrays import Array
from ...model.elements import Element, Spring, lines
from ...model.errors import Fault, InfeasibleError, InputError, nearest
from ...model.mechanism import Mechanism
from ...model.progress import Progress, silent
from ...model.region import Region
from ...synthesis import Problem
from ...synthesis.region import nearest_region
from ..stock.part import Stock, said
from .chosen import Choice, Chosen
from .coils import Coil, coils
from .field import Field
from .mount import Mount
from .polish import torque_size
from .search import Search
from .slots import MARGIN, Judge
from .table import LINES, Table

POSES = 96  # random ones that a choice is judged on, of a mechanism with several coordinates
JUDGINGS = 5  # of the finished mechanism, with more and more distance from the limits
ANSWERS = 3  # the best ones, that are judged until one keeps its limits
KEPT = 1e-9  # of a limit: rounding
MORE, AIM = 1.5, 0.2  # times what a limit was passed by, to keep from it; of that, to aim for besides
SHORT = 0.15  # of the time, for what follows the search


def choose_parts(
    mechanism: Source,
    catalogue: Iterable[Stock],
    choice: Choice | None = None,
    *,
    progress: Progress | None = None,
    keep: bool = False,
    **where: Any,
) -> Chosen:
    """Choose parts of a list for a mechanism, with their attachments.

    Args:
        where: `pairs`, `span`, `radius`, `shape`, `regions`, as `Problem.of` takes them. Springs that the mechanism
            has say which pairs they join and where the search begins, unless `keep`: then they stay as they are.

    Raises:
        InputError: a part of `without` that is not in the list, or as `Problem.of`.
        InfeasibleError: no part fits anywhere; the message says what each demand leaves over.
    """
    mechanism, catalogue, choice = loaded(mechanism), tuple(catalogue), choice or Choice()
    say = progress or silent
    names = {part.part for part in catalogue}
    for name in choice.without:
        if name not in names:
            raise InputError(Fault(("without",), f"the list has no part {nearest(name, names)}"))
    table = Table.of(catalogue, choice.limits, choice.parallel, choice.max_length, choice.max_force, choice.without)
    given = () if keep else lines(mechanism, "stock")
    problem, start = _problem(mechanism, given, keep, where)
    if not given:
        start = _ideal(problem, choice.springs)
    field_ = Field(problem.judged, problem.scale, POSES, choice.seed)
    peak = choice.objective == "peak"
    sites, own, ideal = _sites(problem, start, choice, field_)
    judge = Judge(field_, table, catalogue, _size(problem), MARGIN)
    search = Search(judge, sites, own, peak=peak, seed=choice.seed)
    to_be_had = [part for part in catalogue if part.part not in choice.without]
    turned = coils(field_, to_be_had, choice.limits, choice.parallel, choice.springs, peak)
    rest = field_.load + sum((coil.torque for coil in turned), np.zeros_like(field_.load))
    if len(table) or not turned:
        search.run(choice.seconds * (1 - SHORT), ideal, say)
    if not search.best and not turned:
        raise InfeasibleError(_why(catalogue, choice, table, sites))
    say("judging the design", 1.0)
    if turned and (size := torque_size(rest, len(field_.q), peak)) < search.left:
        made, parts = _wound(turned, problem, choice)
        balance, residual = check(made), size
    else:
        made, balance, parts = _finished(search, problem, choice)
        residual = search.left
    whole = np.abs(field_.load).max() if peak else np.sqrt(np.sum(field_.load**2) / len(field_.q))
    free = field_.load + sum(ideal, np.zeros_like(field_.load))
    return Chosen(
        mechanism=made,
        balance=balance,
        objective=choice.objective,
        residual=residual,
        unbalanced=float(whole),
        ideal=None if not given and not start else float(np.abs(free).max() / np.abs(field_.load).max()),
        parts=parts,
        offered=len({int(p) for p in table.part}) + sum(part.kind == "torsion" for part in to_be_had),
        complete=search.complete or not len(table),
        polished=search.polished,
        history=tuple(search.history),
        limits=choice.limits,
    )


def _problem(
    mechanism: Mechanism, given: Sequence[Spring], keep: bool, where: dict[str, Any]
) -> tuple[Problem, tuple[Spring, ...]]:
    """On the pairs of the springs that are there, with regions as large as these are away from the bodies' origins."""
    if given and "pairs" not in where and "span" not in where:
        where = {**where, "pairs": list(dict.fromkeys((s.body_a, s.body_b) for s in given))}
        if "radius" not in where:
            far: dict[str, float] = {}
            for spring in given:
                for body, p in spring.ends:
                    far[body] = max(far.get(body, 0.0), float(np.linalg.norm(p)))
            sizes = {body: Region.ball(size) for body, size in far.items() if size > 0}
            where["regions"] = {**sizes, **dict(where.get("regions") or {})}
    return Problem.of(mechanism, keep=keep, **where), tuple(given)


def _ideal(problem: Problem, count: int | None) -> tuple[Spring, ...]:
    """Springs of zero free length for the same problem: where to begin, and how many of what there could be at best."""
    from ...synthesis import solve

    found = solve(problem, springs=count).mechanism.springs
    return tuple(s for s in found if isinstance(s, Spring) and s not in problem.kept.springs)


def _sites(
    problem: Problem, start: Sequence[Spring], choice: Choice, field_: Field
) -> tuple[list[list[Mount]], list[Array | None], list[Array]]:
    """For each spring its mounts, where the search begins, and the torque of the ideal spring."""
    sites: list[list[Mount]] = []
    own: list[Array | None] = []
    ideal: list[Array] = []
    for spring in start:
        ends = [(spring.body_a, np.array(spring.p_a)), (spring.body_b, np.array(spring.p_b))]
        mounts = []
        for realise in choice.realise:
            for (a, _), (b, _) in (ends, ends[::-1])[: 1 if realise == "direct" else 2]:
                radius = choice.pulley if realise == "pulley" else 0.0
                here, there = problem.attachments[a], problem.attachments[b]
                mounts += [Mount(a, b, r_a, r_b, realise, radius) for r_a in here for r_b in there]
        (_, p_a), (_, p_b) = ends
        sites.append(mounts)
        first = mounts[0]
        nearest_one = [nearest_region(problem.attachments[body], p) for body, p in ends]
        begun = replace(first, region_a=nearest_one[0], region_b=nearest_one[1])
        own.append(begun.own(p_a, p_b) if begun in mounts else None)
        K, _, _ = field_.lines(spring.body_a, p_a[None], spring.body_b, p_b[None])
        ideal.append(spring.stiffness * K[0])
    return sites, own, ideal


def _finished(search: Search, problem: Problem, choice: Choice) -> tuple[Mechanism, Balance, tuple[Stock, ...]]:
    """The mechanism with the springs, judged at the extremes of all poses.

    Where one passes a limit there, it keeps farther from it; an answer that cannot gives way to the one before it.

    Raises:
        InfeasibleError: none keeps what was asked.
    """
    from .polish import left, polish

    judge, worst = search.judge, np.inf
    for answer in search.answers[: -1 - ANSWERS : -1]:
        search.best, judge.margin = answer, MARGIN
        for _ in range(JUDGINGS):
            made, parts = _built(search, problem, choice)
            balance = check(made)
            over = _over(search, balance, choice)
            if over <= KEPT:
                search.left = left(judge, search.best, search.load, search.peak)
                return made, balance, parts
            worst = min(worst, over)
            judge.margin += max(MORE * over, judge.margin)
            aim = AIM * judge.margin
            search.best = polish(judge, search.best, search.load, peak=search.peak, aim=aim)
    raise InfeasibleError(
        f"of the parts that fit at the poses looked at, none keeps a static margin of {choice.limits.safety:g} and a "
        f"fatigue margin of {choice.limits.fatigue:g} between them: the best passes a limit by {100 * worst:.2g} % of "
        "its range. What would help: larger regions (--radius, --region), or more time (--seconds)"
    )


def _over(search: Search, balance: Balance, choice: Choice) -> float:
    """The largest share by which a limit of the best springs is passed at the extremes; to be slack is none."""
    judge, over, i = search.judge, 0.0, len(balance.mechanism.springs)
    i -= int(sum(judge.table.count[slot.row] for slot in search.best))
    for slot in search.best:
        law, path = balance.mechanism.springs[i].law, np.array(balance.use[i].path)
        part = judge.catalogue[int(judge.table.part[slot.row])]
        short, long, worn = judge.limits(slot.row, path[None] - getattr(law, "cable", 0.0), 0.0)[0].tolist()
        slack = part.kind == "extension", part.kind == "compression" and part.free_length <= choice.max_length
        over = max(over, worn, *(passed for passed, loose in zip((short, long), slack, strict=True) if not loose))
        i += int(judge.table.count[slot.row])
    return over


def _built(search: Search, problem: Problem, choice: Choice) -> tuple[Mechanism, tuple[Stock, ...]]:
    springs: list[Element] = []
    parts: list[Stock] = []
    table, catalogue, field_ = search.judge.table, search.judge.catalogue, search.judge.field
    for i, slot in enumerate(search.best, start=1):
        part, count = catalogue[int(table.part[slot.row])], int(table.count[slot.row])
        for j in range(count):
            name = f"spring {i}" + (f"{'abcdefgh'[j]}" if count > 1 else "")
            springs.append(slot.mount.element(field_, slot.x[:6], float(slot.x[6]), part, name))
            parts.append(part)
    return _with(springs, parts, problem, choice), tuple(parts)


def _wound(turned: Sequence[Coil], problem: Problem, choice: Choice) -> tuple[Mechanism, tuple[Stock, ...]]:
    """With torsion springs on joints."""
    elements = [(e, coil.part) for i, coil in enumerate(turned, start=1) for e in coil.elements(f"spring {i}")]
    springs, parts = zip(*elements, strict=True)
    return _with(springs, parts, problem, choice), parts


def _with(springs: Sequence[Element], parts: Sequence[Stock], problem: Problem, choice: Choice) -> Mechanism:
    """The mechanism with what was chosen, and all about the parts in its provenance."""
    kept = problem.mechanism.springs if problem.keep else ()
    provenance = {
        "program": f"equipoise {__version__}",
        "method": "stock",
        "options": {
            "realise": list(choice.realise),
            "objective": choice.objective,
            "safety": choice.limits.safety,
            "fatigue": choice.limits.fatigue,
            "cycles": choice.limits.cycles,
            "regions": {body: [region.to_dict() for region in own] for body, own in problem.attachments.items()},
        },
        "parts": [said(part) for part in dict.fromkeys(parts)],
    }
    made = problem.mechanism.with_springs((*kept, *springs))
    return replace(made, provenance=provenance)


def _size(problem: Problem) -> float:
    return max(max(region.half) for own in problem.attachments.values() for region in own)


def _why(catalogue: Sequence[Stock], choice: Choice, table: Table, sites: Sequence[Sequence[Mount]]) -> str:
    """That nothing fits, and what the nearest thing is."""
    lines = sum(part.kind in LINES for part in catalogue)
    text = f"none of {len(catalogue):,} parts fits"
    if not lines:
        return f"{text}: none is of a kind that joins two points ({', '.join(LINES)})"
    if not len(table):
        shortest = min(part.free_length for part in catalogue if part.kind in LINES)
        return (
            f"{text}: with a static margin of {choice.limits.safety:g} none has a stroke within the largest length and "
            f"force that are allowed; the shortest part is {1e3 * shortest:.4g} mm long"
        )
    limits, pairs = choice.limits, ", ".join(f"{mounts[0].a}:{mounts[0].b}" for mounts in sites)
    return (
        f"{text} on {pairs} {' or '.join(choice.realise)} within the regions, with a static margin of "
        f"{limits.safety:g} and a fatigue margin of {limits.fatigue:g} at {limits.cycles:g} cycles: the shortest part "
        f"that could be used is {1e3 * float(table.low.min()):.4g} mm long. What would help: larger regions (--radius, "
        "--region), another realisation (--realise eyelet), more springs side by side (--parallel), or fewer --cycles"
    )

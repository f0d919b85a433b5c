"""Verdicts and designs as text for a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console, RenderableType
from rich.table import Table
from rich.text import Text

from ..balance import Balance
from ..energy.exactness import EXACT
from ..energy.spring_use import Reached
from ..model.mechanism import Mechanism
from ..model.units import SI_UNITS
from .clearance import NOT_JUDGED
from .numbers import energies, percent, pose, torque
from .verdict import basis, verdict

if TYPE_CHECKING:  # a verdict waits for no method
    from ..synthesis import Design, Parameter
    from ..synthesis.convex.ordinary import Ordinary
    from ..synthesis.method import Method


BEST = 1e-3  # of the unbalanced torque: a design that is so near its bound is as good as any


def console(stderr: bool = False) -> Console:
    """A console that never cuts a table: at least 120 columns when the output is not a terminal."""
    plain = Console(stderr=stderr, highlight=False)
    return plain if plain.is_terminal else Console(stderr=stderr, highlight=False, width=max(plain.width, 120))


def balance_lines(balance: Balance, tolerance: str = "") -> Iterator[RenderableType]:
    """The verdict, the torques per coordinate, the energies, the worst pose and the springs."""
    m = balance.mechanism
    free = len(balance.coordinates)
    freedom = f"{free} degree{'' if free == 1 else 's'} of freedom"
    yield Text(f"{m.name}: {freedom}, {_count(m.springs, 'spring') if m.springs else 'no springs'}", style="bold")
    if (mobility := balance.mobility) is not None:
        ways = f"its loops leave {_count(range(mobility.numerical), 'way')} to move"
        if mobility.redundant:
            counted = f"; Gruebler's count gives {mobility.gruebler}"
            counted = f"; Gruebler's count gives {mobility.gruebler}"
            ways += f"{counted}: {mobility.redundant} of their equations repeat what the others say"
        yield Text(ways)
    if (singular := balance.singular) is not None:
        what = (
            "relations between its joints lead through"
            if singular.passed
            else f"poses {singular.nearer:g} times nearer to one than usual are left out everywhere, "
            f"{singular.left_out:,} of the random ones"
        )
        where = pose(balance.coordinates, singular.configuration)
        yield Text(f"singular poses lie inside the ranges, one beside {where}: {what}")
    yield verdict(balance)
    if tolerance:
        yield Text(tolerance)
    if m.springs:
        yield Text(basis(balance), style="dim")
    yield torque_table(balance)
    parts = f", springs {energies(balance.springs)}, total {energies(balance.total)}" if m.springs else ""
    yield Text(f"energy: gravity {energies(balance.gravity)}{parts}, mean {balance.constant:.6g} J")
    if not balance.exact and len(balance.coordinates):
        yield Text(f"worst pose: {pose(balance.coordinates, balance.worst_configuration)}")
    yield from spring_lines(balance)


def torque_table(balance: Balance) -> Table:
    """What every coordinate holds without springs and with them."""
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("joint", no_wrap=True)
    cases = [("without springs", balance.unbalanced)]
    if balance.mechanism.springs:
        cases.append(("with springs", balance.residual))
    titles = [title for case, _ in cases for title in (f"{case}: most", "rms")]
    for title in (*titles, "proved at most", "unit"):
        table.add_column(title, justify="right", no_wrap=True)
    floor = EXACT * float(balance.unbalanced.max.max(initial=0))  # less than this counts as nothing
    for j, coordinate in enumerate(balance.coordinates):
        cells = [torque(load[j], floor) for _, loads in cases for load in (loads.max, loads.rms)]
        bound = "-" if balance.bound is None else torque(balance.bound[j], floor)
        table.add_row(Text(coordinate), *cells, bound, coordinate.load_unit)
    return table


def spring_lines(balance: Balance) -> Iterator[Text]:
    """Each spring: how strong, where, and its greatest use."""
    for spring, use in zip(balance.mechanism.springs, balance.use, strict=True):
        yield Text(spring.sentence(use.path, use.force))
        if (made := spring.law.comparison(*use.path)) is not None:
            yield Text(f"  {made}")
            yield from (Text(f"  {fault}", "bold red") for fault in made.faults)
        for one in use.reached:
            style = "bold red" if one.state.limit else "yellow"
            yield Text(
                f"  {reached(one, spring.path_unit)}: {pose(balance.coordinates, np.array(one.configuration))}", style
            )
        if use.margin:
            felt = ", ".join(
                f"{name} ±{most:.3g} {name.load_unit}"
                for name, most in zip(balance.coordinates, use.margin, strict=True)
                if most
            )
            yield Text(f"  friction of ±{spring.law.margin:.4g} {spring.force_unit} adds up to {felt} to the residual")


def reached(one: Reached, unit: str) -> str:
    """That a spring is slack or passes a limit, in words; `unit` is its path's."""
    factor, name = (1e3, "mm") if (one.state.unit or unit) == "m" else (float(np.degrees(1)), "deg")
    side = "above" if one.state.above else "below"
    what = one.state.name.upper() if one.state.limit else one.state.name
    if one.state.unit and not one.state.above:  # that a cable touches nothing is no question of how much
        return f"{what} in {percent(one.share)} of the poses"
    where = f"{side} {factor * one.state.beyond:.5g} {name} in {percent(one.share)} of the poses"
    return f"{what} {where}, at the most {factor * one.path:.5g} {name}"


def design_lines(design: Design) -> Iterator[RenderableType]:
    """What was reached, how that compares with the best possible, the front if there is one, and the verdict."""
    from ..synthesis import METHODS
    from ..synthesis.score import Terms

    method = METHODS[design.method]
    which = "all joints" if design.joints is None else ", ".join(design.joints)
    coordinates = design.balance.coordinates
    counted = [name for name in coordinates if design.joints is None or name in design.joints]
    terms = Terms.of(design.goal.count, counted)
    floor = EXACT * design.unbalanced
    gap = design.certified_gap

    def left(value: float) -> str:
        return terms.show(value) if terms.unit in ("share", "W") else f"{torque(value, floor)} {terms.unit}"

    count = _count(design.mechanism.springs, "spring")
    leave = "leaves" if len(design.mechanism.springs) == 1 else "leave"
    if design.residual < floor:
        what = f"nothing of {terms.show(design.unbalanced)}"
    else:
        share = percent(design.residual / design.unbalanced)
        what = f"{left(design.residual)} of {terms.show(design.unbalanced)}, {share}"
    best = gap is not None and gap <= BEST
    colour = " green" if best else "" if gap is None else " yellow"  # a design that nothing can beat is good news
    yield Text(f"{design.mechanism.name}: {count} {leave} {what}", style=f"bold{colour}")
    ends = " and at ends of the joint ranges" if design.objective == "peak" else ""
    where = "all configurations" if design.averaged else f"{design.samples:,} random poses{ends}"
    where = design.goal.poses.where(design.samples or 0) if design.goal.poses.chosen else where
    what = "force" if terms.unit == "N" else "torque"
    yield Text(f"  counted     {design.objective} {what} of {which} over {where}; method {design.method}")
    if design.bound is not None and gap is not None:
        least = f"{left(design.bound)}  = {percent(design.bound / design.unbalanced)}"
        why = "the balance is exact" if method.exact else "no springs on these pairs and regions leave less"
        won = "so these are the best possible" if best else f"so at most {percent(gap)} of the torque can still be won"
        yield Text(f"  bound       {least}: {why}, {won}")
    if design.counterweights is not None:
        from .weights import weight_lines

        yield from weight_lines(design.counterweights, design.unbalanced)
    for name, least in design.brought.items():
        share = percent(least / design.unbalanced)
        yield Text(f"  {name}: without it at least {left(least)} = {share} would be left")
    if design.by_chance:
        yield Text("  springs from random starts: the program gave none as good; another --seed may find better ones")
    if design.fewest is not None:
        yield Text(f"  fewest      {_count(range(design.fewest.springs), 'spring')} for exact balance; {design.fewest}")
    for load in design.loads if len(design.loads) > 1 else ():
        share = percent(load.residual / load.unbalanced) if load.unbalanced else "-"
        yield Text(f"  {load.name:<11} {left(load.residual)}  = {share} of {terms.show(load.unbalanced)}")
    for name, value in design.free_parameters.items() if method.exact else ():
        yield Text(f"  {name:<11} {free_value(value, method.parameters.get(name))}")
    if design.ordinary is not None:
        yield from _ordinary_lines(design.ordinary)
    if design.infeasible is not None:
        yield Text(f"  {design.infeasible}", style="yellow")
    if design.goal:
        yield Text(f"  goal        {terms.sentence(design.residual, design.unbalanced, design.bound)}", style="bold")
    if design.front:
        yield front_table(design, terms.unit)
    yield from balance_lines(design.balance)


def _ordinary_lines(found: Ordinary) -> Iterator[RenderableType]:
    """What free lengths and room cost: peak residual, and how much stiffer and stronger the springs get."""
    if any(found.free_length.values()):
        yield Text(
            f"  free length: peak residual {percent(found.ideal.relative)} of the unbalanced peak without it, "
            f"{percent(found.plain.relative)} with it, {percent(found.balance.relative)} optimised "
            f"({found.gain:.3g} times smaller)"
        )
    if found.room is not None and not found.room[1].links:
        yield Text(NOT_JUDGED, style="bold yellow")
    if found.moved and found.room is not None:
        before, after = (f"{1e3 * room.least_of_springs:.4g} mm" for room in found.room)
        yield Text(
            f"  clearance: least distance {before} before and {after} now, peak residual "
            f"{percent(found.plain.relative)} of the unbalanced peak before and {percent(found.balance.relative)} now"
        )
    elif found.room is not None and found.room[1].of_springs:
        least = 1e3 * found.room[1].least_of_springs
        yield Text(f"  clearance: least distance {least:.4g} mm; that is enough, and nothing was moved")
    for row in found.to_dict()["springs"] if found.moved else ():
        (k, new_k), (force, new_force) = row["stiffness"], row["max_force"]
        yield Text(
            f"  {row['name']}: {k:.5g} -> {new_k:.5g} N/m, largest force {force:.4g} -> {new_force:.4g} N, "
            f"initial tension {max(0.0, row['preload']):.3g} N"
        )


def front_table(design: Design, unit: str = "N m") -> Table:
    """Residual against number of springs."""
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("springs", justify="right")
    for title in (f"residual [{unit}]", "of unbalanced", f"bound [{unit}]"):
        table.add_column(title, justify="right", no_wrap=True)
    for title in ("which is", "on pairs"):
        table.add_column(title)
    for row in design.front:
        table.add_row(
            str(row.springs),
            "exact" if row.exact else torque(row.residual),
            percent(row.residual / design.unbalanced),
            "-" if row.bound is None else torque(row.bound),
            design.status(row),
            Text(" ".join(":".join(pair) for pair in row.pairs)),
        )
    return table


def methods_table(mechanism: Mechanism) -> Table:
    """Which methods apply to a mechanism, and why the others do not: one line each."""
    from ..synthesis import METHODS

    table = Table(box=None, pad_edge=False, header_style="dim")
    for title in ("method", "applies"):
        table.add_column(title, no_wrap=True)
    table.add_column("what it does, or why not")
    for method in METHODS.values():
        reasons = method.applies(mechanism)
        answer = Text("no", style="dim") if reasons else Text("yes", style="green")
        table.add_row(Text(method.name), answer, Text("; ".join(reasons) or method.summary))
    return table


def method_lines(mechanism: Mechanism, method: Method) -> Iterator[RenderableType]:
    """One method: whether it applies, where it is from, and its parameters."""
    reasons = method.applies(mechanism)
    yield Text(f"{method.name}: {method.summary}", style="bold")
    yield Text(f"  applies: {'no, ' + '; '.join(reasons) if reasons else 'yes'}")
    yield Text(f"  source: {method.source}")
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("--set", no_wrap=True)
    table.add_column("what it is")
    for name, parameter in method.parameters.items():
        unit = SI_UNITS.get(parameter.kind, "")
        choices = f"; {', '.join(parameter.choices)}" if parameter.choices else ""
        label = f"{name}{'.BODY' if parameter.each else ''}{f' [{unit}]' if unit else ''}"
        table.add_row(Text(label), Text(f"{parameter.help}{choices}"))
    yield table


def free_value(value: object, parameter: Parameter | None) -> str:
    """A free parameter's value with its unit."""
    unit = SI_UNITS.get(parameter.kind, "") if parameter else ""
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {free_value(one, parameter)}" for name, one in value.items())
    if isinstance(value, (list, tuple)):
        return ", ".join(free_value(one, parameter) for one in value)
    return f"{value:.6g} {unit}".rstrip() if isinstance(value, float) else str(value)


def _count(items: Sequence[object], noun: str) -> str:
    return f"{len(items)} {noun}{'' if len(items) == 1 else 's'}"

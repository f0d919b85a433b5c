"""The sections about what happens to a design: in simulation, made of real springs, and built with scatter.

Each is there when it was asked for; where it cannot be, it says why.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from ...balance import Balance
from ...energy.exactness import EXACT
from ...hardware import Bill, Limits, Options
from ...hardware.realise.bill import bill, way_dict
from ...hardware.realise.held import Kit, kit, real
from ...hardware.sizing.wire import MM
from ...model.arrays import Array
from ...model.coordinate import Coordinate
from ...model.errors import EquipoiseError
from ...model.progress import Progress
from ...model.units import Amount
from ...robust import Scatter, Tolerance, tolerance
from ...simulate import Release, release
from ...simulate.release import SOFT
from ..style import number
from .content import Block, Cell, Items, Number, Paragraph, Section, Table

EXTRAS = ("simulation", "hardware", "tolerance")
SECONDS, POSES = 5.0, 5  # of the simulation: short, `equipoise simulate` runs longer
BUILDS, LOOKED_AT = 20_000, 500  # builds of the tolerance, and poses of each
NAMED = 6  # parameters that matter most
Result = TypeVar("Result", Release, Bill | Kit, Tolerance)


@dataclass(frozen=True)
class Run:
    """What was asked for and ran, or a text that says why it did not; None for what was not asked for."""

    simulation: Release | str | None = None
    hardware: Bill | Kit | str | None = None
    tolerance: Tolerance | str | None = None


def run(
    balance: Balance, extras: tuple[str, ...], seed: int, radius: Amount | None, limits: Limits, report: Progress
) -> Run:
    """Run what is asked for; what a mechanism does not allow is no error."""
    m = balance.mechanism

    def attempt(name: str, what: str, work: Callable[[], Result]) -> Result | str | None:
        if name not in extras:
            return None
        report(what, 0.0)
        try:
            return work()
        except EquipoiseError as why:
            return str(why)

    simulated = attempt(
        "simulation",
        "simulating",
        lambda: release(m, seconds=SECONDS, poses=POSES, seed=seed, radius=radius, progress=report),
    )
    asked = Options(limits=limits)
    made = attempt(
        "hardware",
        "choosing springs to wind",
        lambda: kit(balance, asked) if real(m) else bill(balance, asked, progress=report),
    )
    # lengths of loops cannot scatter on their own: they would not close
    scatter = Scatter(length=0.0) if m.loops else Scatter()
    scattered = attempt(
        "tolerance",
        "building",
        lambda: tolerance(m, scatter, builds=BUILDS, poses=LOOKED_AT, seed=seed, progress=report),
    )
    return Run(simulated, made, scattered)


def sections(found: Run) -> list[Section]:
    """One for each that was asked for."""
    made: tuple[Section | None, ...] = (
        _section("Simulation", found.simulation, _simulation),
        _section("Hardware", found.hardware, _hardware),
        _section("Tolerance", found.tolerance, _tolerance),
    )
    return [section for section in made if section is not None]


def _section(title: str, result: Result | str | None, blocks: Callable[[Result], list[Block]]) -> Section | None:
    if result is None:
        return None
    if isinstance(result, str):
        return Section(title, (Paragraph("Not run.", strong=True), Paragraph(result)))
    return Section(title, tuple(blocks(result)))


def _simulation(found: Release) -> list[Block]:
    how = f"let go at rest, undamped, from {len(found.poses)} random poses for {found.seconds:g} s each"
    drift = f"no joint moves by more than {_angle(found.design.largest)}"
    if not found.stays:
        _, joint = found.worst
        drift = f"'{joint}' moves by {_angle(found.design.largest)}, more than {_angle(found.tolerance)}"
    blocks: list[Block] = [Paragraph(f"{'It stays' if found.stays else 'It moves'}: {how}, {drift}.", strong=True)]
    if found.control is not None:
        text = f"The same again with '{found.soft}' {100 * SOFT:g} % soft moves by {_angle(found.control.largest)}"
        text += ": the run would have seen a fault." if found.meaningful else ": too little, so staying proves nothing."
        blocks.append(Paragraph(text))
    bare, held = (np.abs(x).max(axis=0) for x in (found.unbalanced, found.design.holding))
    rows = [
        (name, _plain(float(a)), Number(float(b), f"{b:.2g}"), name.load_unit)
        for name, a, b in zip(found.coordinates, bare, held, strict=True)
    ]
    head = ("coordinate", "without springs", "with springs", "unit")
    blocks.append(Table.of("Torque that holds these poses, by an independent engine", head, rows))
    if found.radius is not None:
        sphere = f"Bodies without an inertia are uniform spheres of {1e3 * found.radius:g} mm radius, an assumption"
        blocks.append(Paragraph(f"{sphere} that changes how they move and not whether they stay."))
    return [*blocks, Paragraph(f"Engine: {found.settings}.")]


def _kit(found: Kit) -> list[Block]:
    limits = found.options.limits
    rows: list[list[Cell]] = [
        [i.name, i.order or i.kind, i.realisation, *(_plain(f) for f in i.force), i.unit,
         *("not judged" if x is None else _plain(x) for x in (i.static, i.fatigue))]
        for i in found.items
    ]  # fmt: skip
    head = ("spring", "order or wind", "built in", "least force", "largest", "unit", "static margin", "fatigue margin")
    asked = f"Asked for: a static margin of {limits.safety:g}"
    asked += f" and a fatigue margin of {limits.fatigue:g} at {limits.cycles:g} cycles." if limits.fatigue else "."
    blocks: list[Block] = [Paragraph(asked)]
    said = [f"Warning: {text}" for text in found.warnings]
    said += [f"{item.name}: {note}" for item in found.items for note in item.notes]
    return [*blocks, *([Items(tuple(said))] if said else []), Table.of("Springs as they are built in", head, rows)]


def _hardware(found: Bill | Kit) -> list[Block]:
    if isinstance(found, Kit):
        return _kit(found)
    rows: list[list[Cell]] = []
    for item in found.items:
        way = item.chosen
        if way is None:
            rows.append([item.spring.name, f"cannot be made: {item.ways[0].reason}", *[""] * 10])
            continue
        s, about = way.winding.spring, way_dict(item, way, found.options.limits)
        rows.append([
            item.spring.name, way.kind, _plain(way.winding.count), f"{s.wire.standard} {s.wire.name}",
            _plain(s.d / MM), _plain(s.outer / MM), _plain(s.n), _plain(s.free_length / MM),
            _plain(about["max_force"]), _plain(about["static_margin"]), _plain(about["fatigue_margin"]),
            _plain(1000 * s.mass),
        ])  # fmt: skip
    head = (
        "spring", "made as", "side by side", "wire", "wire d [mm]", "outer d [mm]", "coils", "length [mm]",
        "largest force [N]", "static margin", "fatigue margin", "mass each [g]",
    )  # fmt: skip
    table = Table.of("Helical springs to wind", head, rows)
    limits = found.options.limits
    asked = f"Asked for: a static margin of {limits.safety:g}"
    asked += f" and a fatigue margin of {limits.fatigue:g} at {limits.cycles:g} cycles." if limits.fatigue else "."
    said: list[Block] = [Paragraph(asked)]
    said += [Items(tuple(f"Warning: {text}" for text in found.warnings))] if found.warnings else []
    if found.left is None:
        return [Paragraph("Within the usual limits not every spring can be made.", strong=True), *said, table]
    text = f"Built with these springs, their masses and laws included, {100 * found.left.share:.3g} % of the largest "
    text += f"unbalanced torque is left; the springs weigh {1000 * found.mass:.4g} g together."
    balance = found.balance
    loads = (found.left.residual, found.left.friction)
    left = _loads(balance.coordinates, loads, float(balance.unbalanced.max.max(initial=0)))
    head = ("coordinate", "largest residual", "largest friction of the springs' mounts", "unit")
    return [
        Paragraph(text, strong=True),
        *said,
        table,
        Table.of("What is left when it is built", head, left),
        Paragraph("Friction is an assumed share of each spring's force, not measured; 'equipoise hardware' lists it."),
    ]


def _tolerance(found: Tolerance) -> list[Block]:
    s = found.scatter
    scatter = f"stiffness {100 * s.stiffness:g} %, attachments {1e3 * s.attachment:g} mm, masses {100 * s.mass:g} %, "
    scatter += f"lengths {1e3 * s.length:g} mm"
    text = f"{len(found.peak):,} builds with {s.shape} scatter (standard deviations: {scatter}), "
    text += f"each at {found.poses:,} poses."
    if found.mechanism.loops:
        text += " Lengths do not scatter here, because loops would not close."
    p95 = np.percentile(found.peak, 95, axis=0)
    loads = (found.nominal, found.peak.mean(axis=0), p95)
    rows = _loads(found.coordinates, loads, float(p95.max(initial=0)))
    head = ("coordinate", "as drawn", "mean of all builds", "95 % of builds stay below", "unit")
    ranked = [(p.name, Number(share, f"{100 * share:.1f} %")) for p, share in found.ranked[:NAMED]]
    return [
        Paragraph(text),
        Table.of("Largest residual torque of a build", head, rows),
        Table.of("What causes it: shares of the mean square torque", ("parameter", "share"), ranked),
    ]


def _loads(coordinates: Sequence[Coordinate], loads: Sequence[Array], whole: float) -> list[list[Cell]]:
    """A row for each coordinate; less than `EXACT` of the `whole` counts as nothing."""
    return [
        [c, *(Number(float(x[j]), number(float(x[j]) if x[j] > EXACT * whole else 0.0)) for x in loads), c.load_unit]
        for j, c in enumerate(coordinates)
    ]


def _plain(value: float) -> Number:
    return Number(value, f"{value:.4g}")


def _angle(x: float) -> str:
    return f"{np.degrees(x):.3g}°" if abs(x) >= 1e-4 else f"{x:.2g} rad"

"""The sections about the design: picture, springs, energies and torques, certificate, conventions, where it is from."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from math import degrees
from pathlib import Path
from typing import Any

from ..._version import __version__
from ...balance import Balance
from ...energy.exactness import EXACT
from ...energy.spring_use import SpringUse
from ...io.yaml import to_text
from ...model.coordinate import Coordinate, load_unit
from ...model.masses import lumped_masses
from ...synthesis.fewest import fewest
from ...synthesis.score import score
from ..numbers import percent, torque
from ..schematic import symbols
from ..text import reached
from . import pictures
from .cams import cams
from .content import Block, Cell, Code, Items, Number, Paragraph, Section, Table

HEADS = {
    "m": ("k [N/m]", "free length [mm]", "shortest [mm]", "longest [mm]", "largest force [N]"),
    "rad": ("k [N m/rad]", "relaxed at [deg]", "least [deg]", "largest [deg]", "largest torque [N m]"),
}
"""Columns of a table of springs whose path is a length, or an angle."""
STRENGTHS = {"m": "N/m", "rad": "N m/rad"}
"""The unit of their first numbers."""
CONVENTIONS = (
    "A holding torque is what a joint has to supply to keep a pose: the derivative of the potential energy by its "
    "coordinate.",
    "Attachments are in the frame of their own body; a body's frame sits at the joint that carries it and turns with "
    "it, as in URDF. The frame of 'world' does not move.",
    "A spring is linear, with the energy k/2 (length - free length)²; it also pushes when it is shorter than its free "
    "length. A free length of 0 is the zero-free-length spring of static balancing.",
    "Bodies are rigid and joints are without friction. Only what is listed here has mass.",
    "Whether springs and links are in each other's way is not judged here: that is what 'equipoise clearance' does.",
)


def mechanism_section(balance: Balance) -> Section:
    """What it looks like, and its springs."""
    looks: tuple[Block, ...] = (pictures.two_poses(balance), pictures.scheme(balance))
    if not balance.mechanism.springs:
        return Section("Mechanism", (*looks, Paragraph("It has no springs.")))
    return Section("Mechanism and springs", (*looks, *springs_tables(balance), *_attachments(balance), *cams(balance)))


def springs_tables(balance: Balance) -> list[Table]:
    """Each spring and how it is used; those along a line and those on joints apart."""
    return [table for unit in HEADS if (table := _springs_table(balance, unit)) is not None]


def _springs_table(balance: Balance, unit: str) -> Table | None:
    show, rows = _mm if unit == "m" else _degrees, []
    letters = symbols(balance.mechanism, "k")
    for i, (spring, use) in enumerate(zip(balance.mechanism.springs, balance.use, strict=True)):
        if spring.path_unit == unit:
            (strength, of), most = spring.strength, max(map(abs, use.force))
            own = "" if of == STRENGTHS[unit] else f" {of}"  # a stiffness stands below its unit, a force brings its own
            free = "–" if spring.free is None else show(spring.free)
            rows.append(
                (
                    spring.name, letters[i], Number(strength, f"{strength:.5g}{own}"), free, *map(show, use.path),
                    Number(most, f"{most:.4g}"), _states(use, unit),
                )
            )  # fmt: skip
    title = "Springs, and how they are used over all poses looked at"
    if not any(row[-1] for row in rows):
        return Table.of(title, ("spring", "", *HEADS[unit]), [row[:-1] for row in rows]) if rows else None
    return Table.of(title, ("spring", "", *HEADS[unit], "slack, or past a limit"), rows)


def _states(use: SpringUse, unit: str) -> str:
    return "; ".join(reached(one, unit) for one in use.reached)


def _attachments(balance: Balance) -> list[Table]:
    ends = [
        (symbols(balance.mechanism, letter)[i], spring.name, body, *map(_mm, p))
        for i, spring in enumerate(balance.mechanism.springs)
        for letter, (body, p) in zip("ab", spring.ends, strict=False)
    ]
    head = ("end", "spring", "body", "x [mm]", "y [mm]", "z [mm]")
    return [Table.of("Attachments, each in the frame of its body", head, ends)] if ends else []


def torque_section(balance: Balance) -> Section:
    """Energies and holding torques."""
    if not balance.coordinates:
        return Section("Energy and torque", (Paragraph("Nothing moves: there is no coordinate to balance."),))
    ranges = {"gravity": balance.gravity, "springs": balance.springs, "gravity and springs": balance.total}
    energies = Table.of(
        "Potential energy over all poses looked at",
        ("of", "least [J]", "largest [J]"),
        [(name, *(Number(value, f"{value:.6g}") for value in pair)) for name, pair in ranges.items()],
    )
    blocks: list[Block] = [*pictures.torque_bars(balance), torque_table(balance), *pictures.along_motion(balance)]
    blocks.append(energies)
    if not balance.exact:
        blocks.append(_worst(balance))
    return Section("Energy and torque", tuple(blocks))


def torque_table(balance: Balance) -> Table:
    """What each coordinate has to hold without springs and with them."""
    floor = _floor(balance)
    loads = (balance.unbalanced.max, balance.unbalanced.rms, balance.residual.max, balance.residual.rms)
    rows = []
    for j, name in enumerate(balance.coordinates):
        cells: list[Cell] = [Number(float(load[j]), torque(float(load[j]), floor)) for load in loads]
        bound = "not known" if balance.bound is None else Number(balance.bound[j], torque(balance.bound[j], floor))
        rows.append((name, *cells, bound, name.load_unit))
    head = (
        "coordinate", "largest without springs", "rms without", "largest with springs", "rms with", "proved bound",
        "unit",
    )  # fmt: skip
    return Table.of("Holding torque of each coordinate", head, rows)


def _worst(balance: Balance) -> Table:
    floor = _floor(balance)
    pose = zip(balance.coordinates, balance.worst_configuration.tolist(), balance.worst_torque.tolist(), strict=True)
    rows = [
        (name, Number(value, _value(name, value)), Number(load, _signed(load, floor)), name.load_unit)
        for name, value, load in pose
    ]
    return Table.of("The worst pose that was found", ("coordinate", "value", "holding torque", "unit"), rows)


def _floor(balance: Balance) -> float:
    """[N m or N] what counts as nothing."""
    return EXACT * float(balance.unbalanced.max.max(initial=0))


def _signed(load: float, floor: float) -> str:
    return f"{'-' if load < -floor else ''}{torque(abs(load), floor)}"


def certificate_section(balance: Balance) -> Section:
    """What the verdict rests on, and how near the design is to the best possible."""
    c = balance.certificate
    kinds = {
        "fourier": "Fourier series, a proof for every pose",
        "span": "a proof for every pose, without the terms of the Fourier series",
        "sampled": "random poses, no proof",
    }
    rows: list[tuple[str, Cell]] = [("kind", kinds[c.kind])]
    if c.terms is not None and c.max_coefficient is not None:
        rows.append(("terms", Number(c.terms, f"{c.terms:,}")))
        rows.append(("largest that varies [J]", Number(c.max_coefficient, f"{c.max_coefficient:.2g}")))
    if c.distance is not None:
        share = c.distance.relative
        rows.append(("energy that varies, of what there is to balance", Number(share, f"{share:.2g}")))
    if c.reason:
        rows.append(("no proof, because", c.reason))
    rows.append(("random poses looked at", Number(c.samples, f"{c.samples:,}")))
    rows.append(("mean of the total energy [J]", Number(balance.constant, f"{balance.constant:.6g}")))
    if balance.mobility is not None:
        rows.append(("mobility by rank, by counting", f"{balance.mobility.numerical}, {balance.mobility.gruebler}"))
    blocks: list[Block] = [Table.of("Certificate", ("", "found"), rows)]
    blocks += _bound(balance)
    if (goal := score(balance.mechanism)) is not None:
        blocks.append(Paragraph(f"What it is for: {goal}.", strong=True))
    least = None if goal is not None and goal.goal.poses.chosen else fewest(balance.mechanism)
    if least is not None:
        springs = f"{least.springs} spring{'s' * (least.springs > 1)}"
        blocks.append(Paragraph(f"Exact balance takes at least {springs} of zero free length; {least}."))
    return Section("Certificate, bound and gap", tuple(blocks))


def _bound(balance: Balance) -> Iterator[Block]:
    """As the method that made the design wrote it into the file."""
    made = balance.mechanism.provenance
    unbalanced, left, bound, gap = (made.get(name) for name in ("unbalanced", "residual", "bound", "certified_gap"))
    if "goal" in made:
        return  # said in its own terms
    if not all(isinstance(value, (int, float)) for value in (unbalanced, left)) or not unbalanced or left is None:
        unknown = "The file does not say how its springs were chosen"
        if balance.exact:
            yield Paragraph(f"{unknown}. No others could leave less torque, because the balance is exact.")
        else:
            yield Paragraph(f"{unknown}, so it is not known how near the best possible it is.")
        return
    floor, unit = EXACT * unbalanced, load_unit(balance.coordinates)
    rows: list[tuple[str, Cell]] = [
        (f"without springs [{unit}]", Number(unbalanced, torque(unbalanced, floor))),
        (f"with springs [{unit}]", Number(left, torque(left, floor))),
    ]
    if isinstance(bound, (int, float)) and isinstance(gap, (int, float)):
        rows.append((f"bound: no springs allowed leave less [{unit}]", Number(bound, torque(bound, floor))))
        rows.append(("gap, share of the torque without springs", Number(gap, percent(gap))))
    else:
        rows.append(("bound", "this method gives none"))
    method, objective = made.get("method", "?"), made.get("objective", "")
    caption = f"The {objective} torque of all joints together, as method '{method}' wrote it into the file"
    yield Table.of(caption, ("", "value"), rows)


def conventions_section(balance: Balance) -> Section:
    """What all of this takes for granted."""
    m = balance.mechanism
    gravity = ", ".join(f"{value:g}" for value in m.gravity)
    total = sum(mass for _, mass, _ in lumped_masses(m))
    texts = [
        f"Gravity is ({gravity}) m/s² in the world's frame; all that moves or stands weighs {total:.4g} kg together.",
        *CONVENTIONS,
        f"Extremes are the largest over {balance.certificate.samples:,} random poses inside the joint ranges, each "
        f"improved by a search from there. A proof holds at every configuration, also outside the ranges.",
        f"Torques below {EXACT:g} of the largest one without springs count as nothing.",
    ]
    return Section("Assumptions and conventions", (Items(tuple(texts)),))


def origin_section(balance: Balance, file: Path | None, command: str) -> Section:
    """How to get the same again, and where it is from."""
    m, rows = balance.mechanism, [("report by", f"equipoise {__version__}")]
    blocks: list[Block] = []
    if command:
        blocks = [
            Paragraph("With the same file, this command gives the same report; with --json it prints the numbers too.")
        ]
        blocks.append(Code(command, "Command"))
    if file is not None:
        rows += [("file", file.name), ("SHA-256 of the file", hashlib.sha256(file.read_bytes()).hexdigest())]
    rows += [(str(name), _option(value)) for name, value in m.provenance.items()]
    blocks.append(Table.of("Provenance", ("", "found"), rows))
    blocks.append(Code(to_text(m), "The whole mechanism as a file"))
    return Section("How to reproduce it, and provenance", tuple(blocks))


def _option(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{name}: {_option(one)}" for name, one in value.items()) or "none"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_option(one) for one in value) + "]"
    if value is None or isinstance(value, bool):
        return "yes" if value else "no" if value is False else "none"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _mm(value: float) -> Number:
    return Number(value, f"{round(1e3 * value, 2) + 0.0:g}")


def _degrees(value: float) -> Number:
    return Number(value, f"{round(degrees(value), 2) + 0.0:g}")


def _value(coordinate: Coordinate, value: float) -> str:
    unit = "°" if coordinate.turns else f" {coordinate.shown_unit}"
    return f"{coordinate.scale * value:.1f}{unit}"

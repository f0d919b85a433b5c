"""Places for a spring: a pair of bodies, where on each it may end, and how it is realised between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...model.arrays import Array, vec3
from ...model.elements import Guide, LineElement, Pulley
from ...model.elements.laws import Compression, Extension, Gas
from ...model.region import Region
from ...synthesis.region import project
from ..stock.part import Stock
from .field import Field

Realise = Literal["direct", "eyelet", "pulley"]
REALISE: tuple[Realise, ...] = ("direct", "eyelet", "pulley")


@dataclass(frozen=True)
class Mount:
    """Between a point of body `a` and a point of body `b`; behind an eyelet or a pulley the spring itself is on `a`.

    Attributes:
        region_a, region_b: where the ends may be, and where a spring behind an eyelet or a pulley has its room.
        realise: one of `REALISE`.
        radius: of the pulley, to the middle of the cable [m].
    """

    a: str
    b: str
    region_a: Region
    region_b: Region
    realise: Realise = "direct"
    radius: float = 0.0

    @property
    def cabled(self) -> bool:
        """Whether a cable makes its length free."""
        return self.realise != "direct"

    def points(self, u: Array) -> tuple[Array, Array]:
        """(G, 3) each [m], from the regions' own coordinates (G, 6), which are brought inside."""
        ends = []
        for region, own in ((self.region_a, u[:, :3]), (self.region_b, u[:, 3:6])):
            near = project(own, np.full(len(own), region.shape == "box"))
            ends.append(region.inside(near))
        return ends[0], ends[1]

    def own(self, p_a: Array, p_b: Array) -> Array:
        """(6,) the regions' own coordinates of two points."""
        ends = []
        for region, p in ((self.region_a, p_a), (self.region_b, p_b)):
            half = np.array(region.half)
            ends.append(np.where(half > 0, (p - np.array(region.at)) / np.where(half > 0, half, 1.0), 0.0))
        return np.concatenate(ends)

    def behind(self, field: Field, p_a: Array, p_b: Array) -> tuple[Array, Array]:
        """Where the spring behind an eyelet or pulley is: the direction from it (G, 3), in a's frame, its room (G,).

        Straight behind an eyelet; beside the cable for a pulley, so that the cable lies on it in every pose.
        """
        seen = field.seen_from(self.a, self.b)
        ahead = _unit(p_b @ seen[:, :, :3].mean(axis=0).T + seen[:, :, 3].mean(axis=0) - p_a)
        if self.realise == "eyelet":
            return -ahead, _chord(self.region_a, p_a, -ahead)
        across = _unit(np.cross(self.axis(field, p_a, p_b), ahead))
        rooms = [_chord(self.region_a, p_a, e) for e in (across, -across)]
        return np.where((rooms[0] >= rooms[1])[:, None], across, -across), np.maximum(*rooms)

    def axis(self, field: Field, p_a: Array, p_b: Array) -> Array:
        """(G, 3) the pulley's axis in a's frame: across the plane that the cable moves in most."""
        seen = field.seen_from(self.a, self.b)
        d = np.einsum("nix,gx->gni", seen[:, :, :3], p_b) + seen[:, :, 3] - p_a[:, None]
        _, axes = np.linalg.eigh(np.einsum("gni,gnj->gij", d, d))
        return np.asarray(axes[:, :, 0])

    def element(self, field: Field, u: Array, lead: float, part: Stock, name: str, *, count: int = 1) -> LineElement:
        """The spring as a mechanism file has it, one of `count` equal ones at the same ends.

        Args:
            lead: of a cabled spring [m], how long the cable from the eyelet is where the spring is not stretched yet.
        """
        p_a, p_b = (end[0] for end in self.points(u[None]))
        about = {"mass": part.mass, "diameter": part.outer_diameter, "part": part.part, "realisation": self.realise}
        if not self.cabled:
            return LineElement(name, self.a, vec3(p_a), self.b, vec3(p_b), law(part), **about)
        e = self.behind(field, p_a[None], p_b[None])[0][0]
        seen = field.seen_from(self.a, self.b)
        d = seen[:, :, :3] @ p_b + seen[:, :, 3] - p_a
        within = float(np.linalg.norm(d, axis=1).max()) - lead + part.free_length + 4 * self.radius
        anchor = p_a + within * e
        via: Guide = Guide(self.a, vec3(p_a))
        if self.realise == "pulley":
            out = -_unit(e + _unit(d.mean(axis=0)))
            axis = self.axis(field, p_a[None], p_b[None])[0]
            via = Pulley(self.a, vec3(p_a), self.radius, vec3(axis), vec3(p_a + 2 * self.radius * out))
        own = law(part)
        return LineElement(
            name, self.a, vec3(anchor), self.b, vec3(p_b), _with_cable(own, within + lead - part.free_length), (via,),
            mass_split=1.0, **about,
        )  # fmt: skip


def law(part: Stock) -> Extension | Compression | Gas:
    """A part's force as a function of its length."""
    if part.kind == "gas":
        first = part.max_force - part.rate * part.stroke
        return Gas(first, part.free_length, part.min_length, force_shortest=part.max_force)
    if part.kind == "compression":
        return Compression(part.rate, part.free_length, max(part.min_length, part.free_length - part.stroke))
    return Extension(
        part.rate, part.free_length, part.initial_tension, min(part.free_length + part.stroke, part.max_length)
    )


def _with_cable(own: Extension | Compression | Gas, cable: float) -> Extension:
    assert isinstance(own, Extension)  # only those are behind a cable
    return Extension(own.stiffness, own.body_length, own.initial_tension, own.longest, cable)


def _chord(region: Region, p: Array, e: Array) -> Array:
    """(G,) [m] from points along directions (G, 3) to where the region ends."""
    half, x = np.array(region.half), p - np.array(region.at)
    if region.shape == "box":
        with np.errstate(divide="ignore", invalid="ignore"):
            far = np.where(np.abs(e) > 1e-9, (np.sign(e) * half - x) / e, np.inf)
        return np.maximum(0.0, far.min(axis=1))
    along = np.einsum("gi,gi->g", x, e)
    inside = along**2 + half[0] ** 2 - np.einsum("gi,gi->g", x, x)
    return np.maximum(0.0, np.sqrt(np.maximum(inside, 0.0)) - along)


def _unit(x: Array) -> Array:
    return np.asarray(x / np.maximum(np.linalg.norm(x, axis=-1, keepdims=True), 1e-12))

"""A schematic of a mechanism as papers draw it: links, joints, hatched ground, zig-zag springs, labels a, b and k."""

from __future__ import annotations

import re
from itertools import pairwise

import numpy as np

from ..kinematics import Poses, Tree
from ..model.arrays import Array
from ..model.mechanism import Mechanism
from . import style
from .arm import coiled, window
from .drawing import SMALL, THICK, THIN, Drawing, Label, Line, Pair
from .poses import View, choose
from .skeleton import Bar, Moving, Point, Skeleton

WIDTH, HEIGHT = 160.0, 110.0  # [mm] of the picture
ROW = 4.6  # [mm] a line of the legend
LINK, BRACKET, JOINT, END = 2.6, 0.7, 1.5, 0.75  # [mm] widths of a link and an arm, radii of a joint and a spring's end
GROUND = 3.2  # [mm] half the width of a support
LETTER = 3.4  # [mm] size of the labels
AWAY = (3.2, 4.6, 6.4)  # [mm] from a point to its label
AROUND = np.linspace(0, 2 * np.pi, 16, endpoint=False)  # the directions in which a label may stand
PAPER = "white"
SUBSCRIPT = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def symbols(mechanism: Mechanism, letter: str) -> list[str]:
    """Of each spring: k its stiffness, a and b its ends, with the number in its name, as a paper has it.

    "k12" gives k₁₂, "link 2 spring" k₂, and "spring 2 (1-4)", between links 1 and 4, k₁₄; where two have the same
    number they are told apart, k₁₄,₁ and k₁₄,₂. Springs whose names have no number each are numbered in their order.
    """
    marks = [_number(spring.name) for spring in mechanism.springs]
    if not all(marks):
        marks = [str(i + 1) for i in range(len(marks))]
    told = [mark if marks.count(mark) == 1 else f"{mark},{marks[: i + 1].count(mark)}" for i, mark in enumerate(marks)]
    return [f"{letter}{mark.translate(SUBSCRIPT)}" for mark in told]


def _number(name: str) -> str:
    """The one number in a name, or the two links in brackets; empty where there is none, or more."""
    links = re.search(r"\((\d+)-(\d+)\)", name)
    numbers = re.findall(r"\d+", name)
    return f"{links[1]}{links[2]}" if links else numbers[0] if len(numbers) == 1 else ""


def schematic(mechanism: Mechanism, *, legend: bool = True) -> Drawing:
    """The schematic in a pose that shows the springs; a planar mechanism straight on, a spatial one turned.

    Args:
        legend: also what the letters stand for, below the picture.

    Raises:
        InputError: its loops cannot be closed.
    """
    skeleton = Skeleton.of(mechanism)
    view, q = choose(mechanism, skeleton)
    poses = Tree.of(mechanism).poses(q[1:])
    rows = len(mechanism.springs) if legend else 0
    foot = ROW * (rows + 1) if rows else 0.0  # the heads stand on the picture's lower edge
    drawing = Drawing(WIDTH, HEIGHT + foot)
    _Pen(mechanism, drawing, skeleton, poses, view, foot).draw()
    if rows:
        _legend(drawing, mechanism, foot)
    return drawing


def to_text(mechanism: Mechanism) -> str:
    """The schematic as an SVG file."""
    return schematic(mechanism).svg()


class _Pen:
    def __init__(
        self, mechanism: Mechanism, drawing: Drawing, skeleton: Skeleton, poses: Poses, view: View, foot: float
    ) -> None:
        self.mechanism = mechanism
        self.drawing, self.skeleton, self.poses, self.view = drawing, skeleton, poses, view
        (self.left, right), (self.bottom, _) = window(skeleton, poses, view, WIDTH / HEIGHT)
        self.scale, self.foot = WIDTH / (right - self.left), foot  # sheet mm per metre
        self.taken: list[Array] = []  # (points, 2) [mm] what labels keep clear of

    def draw(self) -> None:
        supports = {tuple(np.round(self.at(point), 3)): point for point in self.skeleton.base}
        for point in supports.values():
            self.support(self.at(point))
        for bar in self.skeleton.brackets:
            self.line([self.at(bar.a), self.at(bar.b)], style.EDGE, BRACKET)
        for bar in sorted(self.skeleton.bars, key=self.depth):
            ends = [self.at(bar.a), self.at(bar.b)]
            width = LINK if bar.a.body == bar.b.body else 0.5 * LINK  # the rod of a sliding joint
            self.line(ends, style.EDGE, width)
            self.line(ends, PAPER, width - 2 * THICK)
        for point in self.skeleton.joints:
            self.disc(self.at(point), JOINT, PAPER, style.EDGE)
        for point in self.skeleton.masses:
            self.square(self.at(point))
        lines = [np.array([self.at(point) for point in line]) for line in self.skeleton.springs]
        for i, line in enumerate(lines):
            path = coiled(line, 0.018 * HEIGHT, 0.017 * HEIGHT, self.skeleton.looks[i])
            self.line(path, PAPER, 5 * THIN)
            self.line(path, style.spring_colour(i), 1.3 * THICK)
            for end in line[[0, -1]]:
                self.disc(end, END, style.spring_colour(i))
        placed: list[Array] = []
        for i, line in enumerate(lines):
            marks = (("a", line[0]), ("b", line[-1])) if self.mechanism.springs[i].ends else ()
            for letter, p in (*marks, ("k", line.mean(axis=0))):
                self.label(symbols(self.mechanism, letter)[i], p, placed)

    def at(self, point: Point | Moving) -> Array:
        """(2,) [mm] on the sheet."""
        x, y = self.view.flat(point.at(self.poses)[0])
        return np.array([(x - self.left) * self.scale, self.foot + (y - self.bottom) * self.scale])

    def depth(self, bar: Bar) -> float:
        return float(self.view.depth((bar.a.at(self.poses)[0] + bar.b.at(self.poses)[0]) / 2))

    def line(self, points: list[Array] | Array, colour: str, width: float) -> None:
        self.drawing.lines.append(Line(_pairs(points), width, colour))
        for a, b in pairwise(points):
            self.taken.append(np.linspace(a, b, 2 + int(np.linalg.norm(b - a))))

    def disc(self, centre: Array, radius: float, colour: str, edge: str = "") -> None:
        turn = np.linspace(0, 2 * np.pi, 33)
        ring = _pairs(centre + radius * np.stack([np.cos(turn), np.sin(turn)], axis=1))
        self.drawing.lines.append(Line(ring, colour=colour, filled=True))
        if edge:
            self.drawing.lines.append(Line(ring, 1.6 * THICK, edge))
        self.taken.append(np.array(ring))

    def square(self, centre: Array) -> None:
        corners = centre + JOINT * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        self.drawing.lines.append(Line(_pairs(corners), colour=style.INK, filled=True))
        self.taken.append(corners)

    def support(self, p: Array) -> None:
        """A triangle on hatched ground, its tip at `p`."""
        s, (x, y) = GROUND, p
        low = y - 1.5 * s
        self.line(np.array([(x, y), (x - s, low), (x + s, low), (x, y)]), style.GROUND, THICK)
        self.line(np.array([(x - 2 * s, low), (x + 2 * s, low)]), style.GROUND, 1.6 * THICK)
        for left in np.linspace(x - 2 * s, x + 1.5 * s, 8):
            self.line(np.array([(left, low - 0.5 * s), (left + 0.5 * s, low)]), style.GROUND, THIN)

    def label(self, text: str, p: Array, placed: list[Array]) -> None:
        """Beside `p`, where it covers least of what is drawn and of the labels in `placed` [mm]."""
        size = np.array([0.62 * LETTER * len(text), LETTER])
        drawn = np.concatenate(self.taken)
        places = [
            (away, p + away * np.array([np.cos(turn), np.sin(turn)])) for away in AWAY for turn in AROUND
        ]  # middles of the label

        def cost(place: tuple[float, Array]) -> float:
            away, middle = place
            covered = (np.abs(drawn - middle) < size / 2 + 0.4).all(axis=1).sum()
            over = sum(bool((np.abs(other - middle) < size + 0.2).all()) for other in placed)
            low, high = np.array([0.0, self.foot]) + size, np.array([WIDTH, self.foot + HEIGHT]) - size
            out = ((middle < low) | (middle > high)).any()
            return float(covered + 60 * over + 500 * out + 0.6 * away)

        _, middle = min(places, key=cost)
        placed.append(middle)
        at = (float(middle[0]), float(middle[1] - 0.35 * LETTER))
        self.drawing.labels.append(Label(at, text, LETTER, "middle"))


def _legend(drawing: Drawing, mechanism: Mechanism, foot: float) -> None:
    name, stiffness, ends = 9.0, 52.0, (54.0, 107.0)  # [mm] where the columns are
    drawing.label((name, foot), "spring", SMALL, bold=True)
    drawing.label((stiffness, foot), "stiffness", SMALL, "end", bold=True)
    for x, letter in zip(ends, "ab", strict=True):
        drawing.label((x, foot), f"{letter} [mm, its body's frame]", SMALL, bold=True)
    for i, spring in enumerate(mechanism.springs):
        y = foot - ROW * (i + 1)
        drawing.label((3.0, y), symbols(mechanism, "k")[i], SMALL, bold=True)
        drawing.label((name, y), style.clean(spring.name, 16), SMALL)
        value, unit = spring.strength
        drawing.label((stiffness, y), f"{value:.5g} {unit}", SMALL, "end")
        if not spring.ends:
            drawing.label((ends[0], y), style.clean(spring.where, 40), SMALL)
        for x, (body, p) in zip(ends, spring.ends, strict=False):
            place = ", ".join(f"{round(1e3 * value, 1) + 0.0:g}" for value in p)
            drawing.label((x, y), f"{style.clean(body, 12)} ({place})", SMALL)


def _pairs(points: list[Array] | Array) -> tuple[Pair, ...]:
    return tuple((float(x), float(y)) for x, y in points)

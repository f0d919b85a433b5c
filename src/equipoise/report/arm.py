"""One pose of a mechanism with its springs, as lines in a picture."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..kinematics import Poses
from ..model.arrays import Array
from ..model.elements.laws.law import Look
from . import style
from .poses import View
from .skeleton import COINCIDE, Bar, Moving, Point, Skeleton

COILS, LEAST = 12, 4  # of a spring; a short one is drawn with fewer, that they stay apart
THICK, MANY = 11.0, 12  # [pt] width of a body; thinner when there are many
SUPPORT = 0.042  # size of what it stands on, of the picture
HALO = 1.6  # [pt]


def window(skeleton: Skeleton, poses: Poses, view: View, aspect: float) -> tuple[tuple[float, float], ...]:
    """((left, right), (bottom, top)) [m] that holds all poses, with width / height = `aspect`."""
    flat = view.flat(skeleton.points(poses)).reshape(-1, 2)
    low, high = flat.min(axis=0), flat.max(axis=0)
    if not view.planar:
        floor = view.flat(_floor(skeleton, poses, view)[0])
        low, high = np.minimum(low, floor.min(axis=0)), np.maximum(high, floor.max(axis=0))
    elif skeleton.base:
        foot = view.flat(np.array([point.p for point in skeleton.base]))
        stand = SUPPORT * max(float(np.ptp(flat, axis=0).max()), 1e-6) * np.array([2.2, 2.0])
        low, high = np.minimum(low, (foot - stand).min(axis=0)), np.maximum(high, (foot + stand).max(axis=0))
    height = max(float((high - low)[1]) * 1.2, float((high - low)[0]) / aspect * 1.08, 1e-6)
    half = np.array([height * aspect, height]) / 2
    middle = (low + high) / 2 - [0.0, 0.05 * height]  # room for the scale below
    return tuple((float(a), float(b)) for a, b in zip(middle - half, middle + half, strict=True))


def draw(axes: Any, skeleton: Skeleton, poses: Poses, shown: int, view: View) -> None:
    """Draw pose number `shown` of `poses`; the floor and the scale are common to all of them."""
    pen = _Pen(axes, skeleton, poses, shown, view)
    if view.planar:
        pen.support()
    else:
        pen.floor()
    for bar in skeleton.brackets:
        pen.bracket(bar)
    for bar in skeleton.bars:
        pen.body(bar)
    for point in skeleton.joints:
        pen.joint(point)
    for point in skeleton.masses:
        pen.mass(point)
    for i, (line, look) in enumerate(zip(skeleton.springs, skeleton.looks, strict=True)):
        pen.spring(line, style.spring_colour(i), look)
    pen.scale()


class _Pen:
    """Draws on axes whose limits are set; what is nearer to the viewer covers what is farther."""

    def __init__(self, axes: Any, skeleton: Skeleton, poses: Poses, shown: int, view: View) -> None:
        self.axes, self.skeleton, self.poses, self.shown, self.view = axes, skeleton, poses, shown, view
        self.size = axes.get_ylim()[1] - axes.get_ylim()[0]
        self.thick = THICK if len(skeleton.bars) <= MANY else THICK * 0.6
        self.drawn: list[tuple[Array, float]] = []  # ends and order of every bar
        depth = view.depth(skeleton.points(poses)[shown])
        self.near, self.range = float(depth.min()), max(float(np.ptp(depth)), 1e-9)

    def at(self, point: Point | Moving) -> Array:
        return point.at(self.poses)[self.shown]

    def order(self, p: Array, first: float = 0.0) -> float:
        """The drawing order of something at the world point `p`: 10 to 20 by depth."""
        return 10 + first + 10 * (float(self.view.depth(p)) - self.near) / self.range

    def line(self, points: Array, colour: str, width: float, order: float, **more: Any) -> None:
        more = {"solid_capstyle": "round", "solid_joinstyle": "round", **more}
        self.axes.plot(*np.asarray(points).T, color=colour, linewidth=width, zorder=order, **more)

    def body(self, bar: Bar) -> None:
        a, b = self.at(bar.a), self.at(bar.b)
        rod = bar.a.body != bar.b.body  # of a sliding joint
        width = self.thick * (0.5 if rod else 1.0)
        colour = style.GROUND if bar.body in self.skeleton.fixed else style.BODIES[bar.body % 2]
        order, flat = self.order((a + b) / 2), self.view.flat(np.array([a, b]))
        self.line(flat, style.EDGE, width + HALO, order)
        self.line(flat, colour, width, order + 0.001)
        self.drawn.append((np.array([a, b]), order))

    def bracket(self, bar: Bar) -> None:
        flat = self.view.flat(np.array([self.at(bar.a), self.at(bar.b)]))
        fixed = bar.body in self.skeleton.fixed
        colour = style.GROUND if fixed else style.BODIES[bar.body % 2]
        self.line(flat, colour, self.thick * 0.28, self.order(self.at(bar.b), -0.3))

    def joint(self, point: Point) -> None:
        p, size = self.at(point), self.thick * 0.78
        order = max(
            (o for ends, o in self.drawn if np.linalg.norm(ends - p, axis=1).min() < COINCIDE), default=self.order(p)
        )
        look = {"marker": "o", "markersize": size, "markerfacecolor": "white", "markeredgecolor": style.EDGE}
        self.line(self.view.flat(p[None]), style.EDGE, 0, order + 0.002, markeredgewidth=1.8, **look)

    def mass(self, point: Point) -> None:
        p = self.at(point)
        look = {"marker": "s", "markersize": self.thick * 1.25, "markerfacecolor": style.INK}
        self.line(self.view.flat(p[None]), style.INK, 0, self.order(p, 1.2), markeredgecolor="white", **look)

    def spring(self, line: tuple[Point | Moving, ...], colour: str, how: Look) -> None:
        places = np.array([self.at(point) for point in line])
        order, flat = self.order(places.mean(axis=0), 2.0), self.view.flat(places)
        path = coiled(flat, 0.018 * self.size, 0.017 * self.size, how)
        self.line(path, "white", 4.0, order, alpha=0.85)
        self.line(path, colour, 2.0, order + 0.001)
        for point, end in zip(places[[0, -1]], flat[[0, -1]], strict=True):
            look = {"marker": "o", "markersize": 6.0, "markerfacecolor": colour, "markeredgecolor": "white"}
            top = max(order, self.order(point, 2.0)) + 0.002  # over its own line, and over the body it is on
            self.line(end[None], colour, 0, top, markeredgewidth=0.9, **look)

    def support(self) -> None:
        """The hatched triangle of a planar mechanism under each place where it stands."""
        from matplotlib.patches import Polygon

        s = SUPPORT * self.size
        for point in self.skeleton.base:
            x, y = self.view.flat(self.at(point))
            self.axes.add_patch(
                Polygon([(x, y), (x - s, y - 1.3 * s), (x + s, y - 1.3 * s)], color=style.GROUND, zorder=2)
            )
            self.line(np.array([[x - 2 * s, y - 1.3 * s], [x + 2 * s, y - 1.3 * s]]), style.GROUND, 2.0, 2)
            for left in np.linspace(x - 2 * s, x + 1.5 * s, 8):
                self.line(np.array([[left, y - 1.8 * s], [left + 0.5 * s, y - 1.3 * s]]), style.GROUND, 1.2, 2)

    def floor(self) -> None:
        """A floor with a grid and the shadow of the arm; a post up to each place where the mechanism stands."""
        from matplotlib.patches import Polygon

        corners, lines = _floor(self.skeleton, self.poses, self.view)
        self.axes.add_patch(Polygon(self.view.flat(corners), facecolor=style.FLOOR, edgecolor=style.GRID, zorder=0))
        for line in lines:
            self.line(self.view.flat(line), style.GRID, 0.8, 0.1)
        for bar in self.skeleton.bars:
            shadow = self.drop(np.array([self.at(bar.a), self.at(bar.b)]), corners[0])
            self.line(self.view.flat(shadow), style.SHADOW, self.thick, 0.5)
        for point in self.skeleton.base:
            top = self.at(point)
            foot = self.drop(top, corners[0])
            self.line(self.view.flat(np.array([foot, top])), style.GROUND, self.thick * 0.5, 1.5)
            turn = np.linspace(0, 2 * np.pi, 60)[:, None]
            across = np.cross(self.view.vertical, self.view.right)
            disc = foot + SUPPORT * self.size * (np.cos(turn) * self.view.right + np.sin(turn) * across)
            self.axes.add_patch(Polygon(self.view.flat(disc), facecolor=style.GROUND, edgecolor="none", zorder=1.6))

    def drop(self, p: Array, floor: Array) -> Array:
        """`p` straight down on the floor, which contains the point `floor`."""
        return p - ((p - floor) @ self.view.vertical)[..., None] * self.view.vertical

    def scale(self) -> None:
        """A bar of a round length in the lower left corner; the picture plane is not foreshortened."""
        (left, right), (bottom, _) = self.axes.get_xlim(), self.axes.get_ylim()
        length = _round(0.22 * (right - left))
        x, y, tick = left + 0.03 * (right - left), bottom + 0.03 * self.size, 0.008 * self.size
        bar = np.array(
            [[x, y + tick], [x, y - tick], [x, y], [x + length, y], [x + length, y + tick], [x + length, y - tick]]
        )
        self.line(bar, style.FAINT, 1.4, 40, solid_capstyle="butt")
        text = f"{length:g} m" if length >= 0.1 else f"{1000 * length:g} mm"
        self.axes.text(x + length / 2, y + 1.6 * tick, text, color=style.FAINT, ha="center", va="bottom", zorder=40)


def coiled(line: Array, amplitude: float, pitch: float, look: Look = "coil") -> Array:
    """A spring along a line (points, 2): coils or a cylinder and its rod between two points, else the line as it is."""
    if len(line) > 2 or look == "line":
        return line
    return zigzag(line[0], line[1], amplitude, pitch) if look == "coil" else strut(line[0], line[1], 0.7 * amplitude)


CYLINDER = np.array([(0, 0), (0.06, 0), (0.06, 1), (0.55, 1), (0.55, -1), (0.06, -1), (0.06, 0), (1, 0)])
"""A cylinder and the rod in it in one line: shares of the way, and of half its width."""


def strut(a: Array, b: Array, half: float) -> Array:
    """A gas spring from `a` to `b` (2,) of half so much width: (points, 2)."""
    along = b - a
    across = np.array([-along[1], along[0]]) / max(float(np.linalg.norm(along)), 1e-12)
    return a + CYLINDER[:, :1] * along + half * CYLINDER[:, 1:] * across


def zigzag(a: Array, b: Array, amplitude: float, pitch: float = 0.0) -> Array:
    """A coil spring from `a` to `b` (2,): straight ends and coils at least `pitch` apart in between, (points, 2)."""
    length = float(np.linalg.norm(b - a))
    if length < 1e-12:
        return np.array([a, b])
    along = (b - a) / length
    across = np.array([-along[1], along[0]]) * min(amplitude, 0.3 * length)
    coils = int(np.clip(0.72 * length / pitch, LEAST, COILS)) if pitch else COILS
    turns = np.arange(2 * coils)
    body = a + np.outer(0.14 + 0.72 * (turns + 0.5) / (2 * coils), b - a) + np.outer((-1.0) ** turns, across)
    return np.vstack([a, a + 0.14 * (b - a), body, b - 0.14 * (b - a), b])


def _floor(skeleton: Skeleton, poses: Poses, view: View) -> tuple[Array, list[Array]]:
    """The corners (4, 3) of a floor under all poses, and its grid lines (2, 3)."""
    points = skeleton.points(poses).reshape(-1, 3)
    ahead = np.eye(3)[np.argmin(np.abs(view.vertical))]
    x = ahead - (ahead @ view.vertical) * view.vertical
    x /= np.linalg.norm(x)
    y = np.cross(view.vertical, x)
    base = np.stack([point.at(poses) for point in skeleton.base], axis=1) if skeleton.base else points[:1]
    u, v, height = points @ x, points @ y, (points @ view.vertical).min()
    step = _round(max(np.ptp(u), np.ptp(v), float((base @ view.vertical).max() - height), 1e-6) / 4)
    grids = [np.arange(np.floor(w.min() / step), np.ceil(w.max() / step) + 1) * step for w in (u, v)]
    us, vs = (grid if len(grid) > 1 else np.array([grid[0] - step, grid[0] + step]) for grid in grids)

    def place(a: float, b: float) -> Array:
        return a * x + b * y + height * view.vertical

    corners = np.array([place(us[i], vs[j]) for i, j in ((0, 0), (-1, 0), (-1, -1), (0, -1))])
    lines = [np.array([place(a, vs[0]), place(a, vs[-1])]) for a in us]
    lines += [np.array([place(us[0], b), place(us[-1], b)]) for b in vs]
    return corners, lines


def _round(length: float) -> float:
    """The largest 1, 2 or 5 times a power of ten that is not longer."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(next(m * power for m in (5, 2, 1) if m * power <= length * (1 + 1e-9)))

"""The pose in which two parts come closest, from two sides, with the room that everything takes."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from ..clearance import Clearance
from ..clearance.pairs import Pairs
from ..clearance.room import LINK, Part
from ..kinematics import Poses, Tree
from ..model.arrays import Array
from ..model.mechanism import Mechanism
from . import arm, style
from .figure import render
from .poses import View, choose
from .skeleton import Skeleton

SIZE = (14.0, 7.0)  # [in]
AROUND = 24  # points of a circle
CLOSE = "#D62728"


def save_worst_pose(mechanism: Mechanism, found: Clearance, path: str | os.PathLike[str]) -> None:
    """Draw the pose of the smallest gap, with a red line between the two parts.

    Raises:
        InputError: nothing to come close to, or as `save_figure`.
    """
    gap, pairs, tree = found.gaps[0], Pairs(mechanism), Tree.of(mechanism)
    poses = tree.poses(gap.configuration[None])
    skeleton = Skeleton.of(mechanism)
    front, _ = choose(mechanism, skeleton)
    level = np.cross(front.vertical, -front.right)  # of the other side everything is seen level
    side = View(level, front.vertical, -front.right, front.vertical, planar=front.planar)
    own = [i for i, name in enumerate(pairs.names) if name == (gap.spring, gap.other)]
    pair = own[int(pairs.distances(poses)[0, own].argmin())]
    ends = np.array(pairs.between(poses, pair))
    close = {int(pairs.first[pair]), int(pairs.second[pair])}

    def drawn(figure: Any) -> None:
        text = f"{gap.spring} to {gap.other}: {1e3 * gap.distance:.4g} mm"
        name = style.clean(mechanism.name, 46)
        figure.text(0.025, 0.93, f"{name}  ·  closest pose", color=style.INK, fontsize=18, weight="bold")
        figure.text(0.975, 0.93, style.clean(text, 80), color=CLOSE, ha="right", fontsize=16, parse_math=False)
        for i, view in enumerate((front, side)):
            axes = figure.add_axes((0.02 + 0.49 * i, 0.05, 0.47, 0.82))
            limits = arm.window(skeleton, poses, view, 0.47 * SIZE[0] / (0.82 * SIZE[1]))
            axes.set(xlim=limits[0], ylim=limits[1], aspect="equal")
            axes.set_axis_off()
            arm.draw(axes, skeleton, poses, 0, view)
            for number, part in enumerate(pairs.room.parts):
                _room(axes, view, _points(pairs, poses, number, part), part, number in close)
            axes.plot(*view.flat(ends).T, color=CLOSE, linewidth=2.5, zorder=60, marker="o", markersize=4)
            where = "seen as in other figures" if not i else "seen from its left"
            axes.text(0.5, 1.04, where, transform=axes.transAxes, ha="center", va="top", color=style.FAINT)

    render(path, SIZE, drawn)


def _points(pairs: Pairs, poses: Poses, number: int, part: Part) -> Array:
    """(K, 3) points whose hull is the part's outline, in the world [m]."""
    if part.solid is not None:
        body = part.bodies[0]
        return poses.p[0, body] + part.solid.outline() @ poses.R[0, body].T
    turn = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
    height = np.linspace(-1, 1, AROUND // 2)[:, None]
    flat = np.sqrt(1 - height**2)
    ball = np.stack([flat * np.cos(turn), flat * np.sin(turn), height + 0 * turn], axis=2).reshape(-1, 3)
    a, b = pairs.points(poses, pairs.ends)[0, number]
    return np.concatenate([a + part.radius * ball, b + part.radius * ball])


def _room(axes: Any, view: View, points: Array, part: Part, close: bool) -> None:
    from scipy.spatial import ConvexHull, QhullError

    flat = view.flat(points)
    try:
        outline = flat[ConvexHull(flat).vertices]
    except QhullError:  # a line
        return
    colour = CLOSE if close else style.FAINT
    look = {"facecolor": colour, "alpha": 0.22 if close or part.kind != LINK else 0.1, "edgecolor": colour}
    axes.fill(*outline.T, zorder=50 if close else 30, linewidth=1.0, **look)

"""The recursions: energy and torque of gravity and springs written down on symbols.

With the stretch of a spring as a sum over frames, ``d = sum_X R_X v_X``, and e_j the part of it that turns with joint
j, a spring of energy ``|d|^2 / 2`` has the torque ``z_j . (e_j x d)``. Gravity is ``w . sum_X R_X h_X`` with the
weight direction w = -g in the place of d. Stiffness is taken into the lengths: everything is scaled by its square root.

- `LOCAL`: e comes inwards and d goes outwards, each in the frames' own axes. Cheapest where springs span few joints.
- `WORLD`: frames, points and moments in the world's axes. One pass serves all springs: cheapest for many or long ones.

Gravity's moment is passed in local axes in both: that is never dearer.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

import numpy as np

from ...model.arrays import Array
from ...model.elements.element import End, LinePen, Pens, Pull
from .flat_tree import FlatTree, Turn
from .trace import Program, Trace, Value, Vector
from .vectors import ZERO, about_x, about_z, add, angle_sum, constant, cross, cross_z, minus, plus, scaled

Recursion = Literal["local", "world"]
RECURSIONS: tuple[Recursion, ...] = ("local", "world")


def programs(layout: FlatTree, split: bool) -> dict[Recursion, Program]:
    """The program of every recursion.

    Its outputs with `split`: gravity's energy, the path of each spring, the torques of gravity (n) and of the
    springs (n). Else the total energy and the total torque (n).
    """
    return {recursion: Recurrence(layout).program(recursion, split) for recursion in RECURSIONS}


class Recurrence:
    """One mechanism written down on one trace."""

    def __init__(self, layout: FlatTree) -> None:
        self.layout, self.tree = layout, layout.tree
        self.t = Trace()
        q = [self.t.input(j) for j in range(self.tree.n)]
        self.values: list[Value] = [
            self.t.total([float(offset), *(self.t.mul(float(ratio), x) for ratio, x in zip(row, q, strict=True))])
            for row, offset in zip(self.tree.C, self.tree.s0, strict=True)
        ]
        self.turns = [self._turn(i) for i in range(len(layout.frames))]

    def program(self, recursion: Recursion, split: bool) -> Program:
        """The program; see `programs` for its outputs."""
        t = self.t
        gravity, gravity_torque = self._gravity()
        paths, energies, torque = self._local() if recursion == "local" else self._world()
        if split:
            outputs = [gravity, *paths, *self._coordinates(gravity_torque), *self._coordinates(torque)]
        else:
            for row, value in torque.items():
                gravity_torque[row] = t.add(gravity_torque.get(row, 0.0), value)
            outputs = [t.total([gravity, *energies]), *self._coordinates(gravity_torque)]
        return t.program(outputs)

    def _turn(self, i: int) -> tuple[Value, Value]:
        """(cos, sin) of frame i's turn about its z axis, gamma included."""
        frame, t = self.layout.frames[i], self.t
        if i == 0:
            return 1.0, 0.0
        s, c = t.sincos(self.values[frame.row])
        return angle_sum(t, (c, s), frame.gamma)

    def _coordinates(self, rows: dict[int, Value]) -> list[Value]:
        """Torque per elementary motion -> per coordinate (n)."""
        t = self.t
        return [t.total([t.mul(float(self.tree.C[row, j]), v) for row, v in rows.items()]) for j in range(self.tree.n)]

    # vectors from frame to frame

    def _inwards(self, i: int, v: Vector) -> tuple[Vector, Vector]:
        """Frame i's vector v before its turn about z (between gamma's and the turn), and in the base frame."""
        frame, t = self.layout.frames[i], self.t
        turned = about_z(t, self.turns[i], v)
        return turned, about_z(t, (frame.alpha.c, frame.alpha.s), about_x(t, frame.beta, turned))

    def _outwards(self, i: int, v: Vector) -> tuple[Vector, Vector]:
        """The base's vector v before frame i's turn about z, and in frame i."""
        frame, t = self.layout.frames[i], self.t
        tilted = about_x(t, Turn(frame.beta.c, -frame.beta.s), about_z(t, (frame.alpha.c, -frame.alpha.s), v))
        c, s = self.turns[i]
        return tilted, about_z(t, (c, -s), tilted)

    def _couple(
        self,
        parts: dict[int, Vector],
        slides: list[tuple[int, int, Array]],
        weight: Vector | None,
        rows: dict[int, Value],
    ) -> Vector:
        """The local recursion for ``d = sum_X R_X parts_X``, or with a `weight` in frame 0 in the place of d.

        Adds the torques of all motions to `rows`, without a spring's factor; `slides` are (frame, row, direction).

        Returns:
            d in the frame where all its parts meet.
        """
        t, layout = self.t, self.layout
        top = 0 if weight is not None else self._meet(parts)
        e = dict(parts)
        before: dict[int, Vector] = {}
        for i in range(len(layout.frames) - 1, 0, -1):  # a frame's number is above its base's
            if i in e and i != top:
                base = layout.frames[i].base
                before[i], inner = self._inwards(i, e[i])
                e[base] = plus(t, e.get(base, ZERO), inner)
        found = e.get(top, ZERO)
        d = {top: found if weight is None else weight}

        def at(frame: int) -> Vector:
            if frame not in d:
                tilted[frame], d[frame] = self._outwards(frame, at(layout.frames[frame].base))
            return d[frame]

        tilted: dict[int, Vector] = {}
        for i, mine in before.items():
            at(i)
            add(t, rows, layout.frames[i].row, cross_z(t, mine, tilted[i]))
        for frame, row, direction in slides:
            add(t, rows, row, t.dot(constant(direction), at(frame)))
        return found

    def _meet(self, parts: Iterable[int]) -> int:
        """The outermost frame that all of these hang on."""
        common: list[int] | None = None
        for frame in parts:
            bases = self.layout.bases(frame)
            common = bases if common is None else [i for i in common if i in bases]
        return common[0] if common else 0

    def _gravity(self) -> tuple[Value, dict[int, Value]]:
        """Energy, and torque per motion."""
        t, layout = self.t, self.layout
        moment, load = layout.moments()
        parts = {frame: constant(h) for frame, h in moment.items()}
        slides = []
        for o, step in enumerate(layout.origins):
            if step.slide is not None and load[o]:
                h = load[o] * step.slide
                slides.append((step.frame, step.row, h))
                parts[step.frame] = plus(t, parts.get(step.frame, ZERO), self._along(step.row, h))
        weight = constant(-layout.gravity)
        rows: dict[int, Value] = {}
        return t.dot(weight, self._couple(parts, slides, weight, rows)), rows

    def _along(self, row: int, direction: Array) -> Vector:
        x, y, z = (self.t.mul(float(a), self.values[row]) for a in direction)
        return x, y, z

    # springs; of those along a line all lengths are multiplied by what makes their law cheapest

    def _elements(self, line: LinePen, rows: dict[int, Value]) -> tuple[list[Value], list[Value]]:
        """Path and energy of each spring; the pens add its torques to `rows` or keep its forces."""
        t = self.t

        def angle(terms: tuple[tuple[str, float], ...]) -> tuple[Value, Pull]:
            own = [(self.tree.rows[joint], float(ratio)) for joint, ratio in terms]

            def pull(force: Value) -> None:
                for row, ratio in own:
                    add(t, rows, row, t.mul(ratio, force))

            return t.total([t.mul(ratio, self.values[row]) for row, ratio in own]), pull

        found = [spring.symbols(t, Pens(line, angle)) for spring in self.tree.mechanism.springs]
        return [path for path, _ in found], [energy for _, energy in found]

    def _ends(self, ends: tuple[End, End], scale: float) -> list[tuple[float, int, int, Array]]:
        """Both ends as (sign and scale, frame, origin, point from the origin)."""
        found = []
        for sign, (body, p) in zip((-1.0, 1.0), ends, strict=True):
            seat = self.layout.seats[self.tree.index[body]]
            found.append((sign * scale, seat.frame, seat.origin, seat.point(np.array(p))))
        return found

    def _local(self) -> tuple[list[Value], list[Value], dict[int, Value]]:
        t, layout = self.t, self.layout
        total: dict[int, Value] = {}

        def line(ends: tuple[End, End], scale: float) -> tuple[Vector, Pull]:
            parts: dict[int, Vector] = {}
            slides: list[tuple[int, int, Array]] = []
            (k_a, X_a, o_a, p_a), (k_b, X_b, o_b, p_b) = self._ends(ends, scale)
            for k, frame, p in ((k_a, X_a, p_a), (k_b, X_b, p_b)):
                parts[frame] = plus(t, parts.get(frame, ZERO), constant(k * p))
            path_a, path_b = layout.path(o_a), layout.path(o_b)
            for k, path, other in ((k_a, path_a, path_b), (k_b, path_b, path_a)):
                for o in (o for o in path if o not in other):
                    step = layout.origins[o]
                    moved = constant(k * step.step)
                    if step.slide is not None:
                        moved = plus(t, moved, self._along(step.row, k * step.slide))
                        slides.append((step.frame, step.row, k * step.slide))
                    parts[step.frame] = plus(t, parts.get(step.frame, ZERO), moved)
            rows: dict[int, Value] = {}

            def pull(share: Value) -> None:
                for row, value in rows.items():
                    add(t, total, row, t.mul(share, value))

            return self._couple(parts, slides, None, rows), pull

        return *self._elements(line, total), total

    def _world(self) -> tuple[list[Value], list[Value], dict[int, Value]]:
        t, layout = self.t, self.layout
        axes = self._axes()
        steps, p = [ZERO], [ZERO]
        for step in layout.origins[1:]:
            local = constant(step.step)
            if step.slide is not None:
                local = plus(t, local, self._along(step.row, step.slide))
            steps.append(self._in_world(axes[step.frame], local))
            p.append(plus(t, p[step.parent], steps[-1]))
        force: dict[int, Vector] = {}  # on each origin
        moment: dict[int, Vector] = {}  # on each frame
        rows: dict[int, Value] = {}

        def line(ends: tuple[End, End], scale: float) -> tuple[Vector, Pull]:
            both = self._ends(ends, scale)
            arms = [self._in_world(axes[frame], constant(scale * point)) for _, frame, _, point in both]
            (_, X_a, o_a, _), (_, X_b, o_b, _) = both
            between = scaled(t, scale, minus(t, p[o_b], p[o_a]))
            d = plus(t, between, minus(t, arms[1], arms[0]))

            def pull(share: Value) -> None:
                f = scaled(t, share, d)
                for sign, frame, origin, arm in ((-1.0, X_a, o_a, arms[0]), (1.0, X_b, o_b, arms[1])):
                    mine = scaled(t, sign, f)
                    moment[frame] = plus(t, moment.get(frame, ZERO), cross(t, arm, mine))
                    force[origin] = plus(t, force.get(origin, ZERO), scaled(t, scale, mine))

            return d, pull

        paths, energies = self._elements(line, rows)
        for o in range(len(layout.origins) - 1, 0, -1):
            if o in force:
                step, f = layout.origins[o], force[o]
                force[step.parent] = plus(t, force.get(step.parent, ZERO), f)
                moment[step.frame] = plus(t, moment.get(step.frame, ZERO), cross(t, steps[o], f))
                if step.slide is not None:
                    add(t, rows, step.row, t.dot(self._in_world(axes[step.frame], constant(step.slide)), f))
        for i in range(len(layout.frames) - 1, 0, -1):
            if i in moment:
                frame = layout.frames[i]
                add(t, rows, frame.row, t.dot([row[2] for row in axes[i]], moment[i]))
                moment[frame.base] = plus(t, moment.get(frame.base, ZERO), moment[i])
        return paths, energies, rows

    def _axes(self) -> list[tuple[Vector, Vector, Vector]]:
        """The rows of each frame's rotation matrix: a row is a world axis, and goes outwards as any vector."""
        found: list[tuple[Vector, Vector, Vector]] = [((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
        for i in range(1, len(self.layout.frames)):
            x, y, z = (self._outwards(i, row)[1] for row in found[self.layout.frames[i].base])
            found.append((x, y, z))
        return found

    def _in_world(self, axes: tuple[Vector, Vector, Vector], v: Vector) -> Vector:
        x, y, z = (self.t.dot(row, v) for row in axes)
        return x, y, z

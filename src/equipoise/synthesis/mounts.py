"""Which bodies springs are mounted on by default, how far apart they are, and how large.

Bodies that fixed joints hold together count as one, and so do the massless, sizeless bodies that stand between the
axes of a compound joint in many URDF files: nothing can be mounted on those.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..kinematics import Tree
from ..kinematics.groups import places
from ..model.mechanism import Mechanism


@dataclass(frozen=True)
class Mounts:
    """The mountable bodies of a mechanism.

    Attributes:
        bodies: names, ground first, one for each rigid group: the body that carries the next moving joint, else the
            first with mass.
        distance: (bodies, bodies) moving joints between them on the shortest way, compound joints counted once.
        size: of each [m]: farthest mass centre or joint from its origin.
        reach: [m] longest chain of joint offsets.
    """

    bodies: tuple[str, ...]
    distance: tuple[tuple[int, ...], ...]
    size: tuple[float, ...]
    reach: float

    def pairs(self, span: int) -> tuple[tuple[str, str], ...]:
        """Every two mountable bodies at most `span` joints apart, nearest to the ground first."""
        return tuple(
            (a, b)
            for i, a in enumerate(self.bodies)
            for j, b in enumerate(self.bodies)
            if i < j and self.distance[i][j] <= span
        )

    def apart(self, pair: tuple[str, str]) -> int:
        """Joints between two mountable bodies."""
        return self.distance[self.bodies.index(pair[0])][self.bodies.index(pair[1])]

    def default_radius(self, body: str) -> float:
        """[m] half the link's size, and at least a tenth of the mechanism's reach."""
        size = self.size[self.bodies.index(body)] if body in self.bodies else 0.0
        return max(size / 2, self.reach / 10)

    @staticmethod
    @lru_cache(maxsize=32)
    def of(mechanism: Mechanism) -> Mounts:
        """The mounts of a mechanism.

        Raises:
            InputError: its loops cannot be closed.
        """
        tree = Tree.of(mechanism)
        place = places(tree, ("fixed",))
        members: dict[int, list[int]] = {0: [0]}
        above: dict[int, int] = {}  # group (named after its root) -> the group its moving joint hangs on
        ends: dict[int, list[np.ndarray]] = {0: []}  # joints and mass centres in each group, in the root's frame
        carrier: dict[int, int] = {}  # group -> first body that carries a moving joint
        path = {0: 0.0}
        for link in tree.links:
            root = place[link.parent].root
            path[link.body] = path[link.parent] + float(np.linalg.norm(link.p0))
            if link.joint.type == "fixed":
                members[root].append(link.body)
            else:
                members[link.body], ends[link.body], above[link.body] = [link.body], [], root
                carrier.setdefault(root, link.parent)
                ends[root].append(place[link.body].base)
        mass = _masses(tree)
        for body, points in mass.items():
            ends[place[body].root] += [place[body].p + place[body].R @ p for p in points]

        solid = [root for root in members if root == 0 or any(b in mass for b in members[root]) or _long(ends[root])]
        chosen = {r: carrier.get(r, next((b for b in members[r] if b in mass), r)) for r in solid}
        size = [max((float(np.linalg.norm(end - place[chosen[r]].p)) for end in ends[r]), default=0.0) for r in solid]
        loops = [(place[tree.index[o.body_a]].root, place[tree.index[o.body_b]].root) for o in mechanism.loops]
        distance = _apart([*above.items(), *loops], solid)
        reach = max([*path.values(), *(path[chosen[r]] + s for r, s in zip(solid, size, strict=True))])
        return Mounts(tuple(tree.names[chosen[r]] for r in solid), distance, tuple(size), reach or 1.0)


def _masses(tree: Tree) -> dict[int, list[np.ndarray]]:
    """Body number -> the places of its mass [m], for the bodies that have any."""
    found: dict[int, list[np.ndarray]] = {}
    for body in tree.mechanism.bodies:
        if body.mass > 0:
            found.setdefault(tree.index[body.name], []).append(np.array(body.com))
    for point in tree.mechanism.masses:
        if point.mass > 0 and tree.index[point.body]:
            found.setdefault(tree.index[point.body], []).append(np.array(point.position))
    return found


def _long(ends: list[np.ndarray]) -> bool:
    return any(np.linalg.norm(end) > 1e-9 for end in ends)


def _apart(edges: Iterable[tuple[int, int]], solid: Sequence[int]) -> tuple[tuple[int, ...], ...]:
    """Between every two solid groups: how many solid ones the shortest way over the edges enters."""
    number = {group: i for i, group in enumerate(dict.fromkeys((*solid, *(end for edge in edges for end in edge))))}
    distance = np.where(np.eye(len(number), dtype=bool), 0, len(number))
    for a, b in edges:
        for start, end in ((a, b), (b, a)):
            if start != end:
                distance[number[start], number[end]] = number[end] < len(solid)
    for k in range(len(number)):
        distance = np.minimum(distance, distance[:, k, None] + distance[k])
    return tuple(tuple(int(d) for d in row[: len(solid)]) for row in distance[: len(solid)])

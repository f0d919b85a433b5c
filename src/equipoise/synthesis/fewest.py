"""How many springs exact balance needs at least, proved by planar sections (docs/theory.md).

Hold some joints so that the others have parallel axes: what is left is a planar arm, or a tree of planar links. In its
plane a link's direction is a complex number x_i, the ground's is x_0 = 1, and a spring of zero free length stretches by
``sum_i w_i x_i`` and a constant along the axes. Exact balance asks that the sum of ``k w w^H`` cancels gravity, which
couples the ground to every link that has a moment, and no two links to each other. So the columns of sqrt(k) w of such
links are orthogonal and none is zero: there are at least as many springs as links that gravity loads.

A ball joint turns about any axis, so it is part of every section.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations, islice, product
from math import atan2, degrees, pi
from typing import Any

import numpy as np

from ..energy.span.nodes import Node, Nodes
from ..kinematics.linkage import Linkage
from ..kinematics.tree import Tree
from ..model.arrays import Array, Booleans
from ..model.coordinate import Coordinate
from ..model.errors import NoFourierForm
from ..model.masses import lumped_masses
from ..model.mechanism import Mechanism

PARALLEL = 1e-9  # the sine of an angle between axes that count as parallel
LOADED = 1e-7  # of all moments before anything cancels: what gravity certainly loads
POSES = 12_000  # over the number of joints: poses of those that are held
MANY = 8  # joints that a sentence names
NUMBERS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")


@dataclass(frozen=True)
class Fewest:
    """At least `springs` springs are needed for exact balance.

    Attributes:
        joints: those that move in the section that proves it.
        held: (coordinate, value [rad or m]) of the others that make it a planar one.
        branched: the section is a tree, not an arm.
    """

    springs: int
    joints: tuple[str, ...]
    held: tuple[tuple[Coordinate, float], ...] = ()
    branched: bool = False

    def __str__(self) -> str:
        links = f"{_word(self.springs)} link{'s' * (self.springs > 1)}"
        what = f"a planar {'tree' if self.branched else 'arm'} of {links} that gravity loads"
        if len(self.joints) > MANY:
            return f"fewer cannot be exact: with the other joints held, {len(self.joints)} joints are {what}"
        *most, last = self.joints
        joints = f"{', '.join(most)} and {last} are" if most else f"{last} is"
        held = " and ".join(
            f"{name} at {degrees(value):.4g} deg" if name.turns else f"{name} at {1e3 * value:.4g} mm"
            for name, value in self.held
        )
        return f"fewer cannot be exact: {f'with {held}, ' if held else ''}{joints} {what}"

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {"springs": self.springs, "joints": list(self.joints), "held": dict(self.held), "why": str(self)}


def fewest(mechanism: Mechanism, counted: Iterable[str] | None = None) -> Fewest | None:
    """The largest bound that is found, for springs of zero free length instead of those of the mechanism.

    Args:
        counted: the coordinates whose torque has to vanish, all by default.

    Returns:
        None where nothing is known: with loops, or where gravity does no work that counts.
    """
    bare = mechanism.with_springs(())
    tree = Tree.of(bare)
    if isinstance(tree, Linkage):
        return None
    try:
        nodes = Nodes(tree)
    except NoFourierForm:
        return None
    names = set(tree.coordinates if counted is None else counted)
    each = [m * nodes.point(tree.index[body], p) for body, m, p in lumped_masses(bare) if m]
    moment = sum(each, nodes.zero())
    g = np.array(mechanism.gravity)
    own, ball = _movable(nodes, names)
    q = _poses(nodes)
    R, axes = _orientations(nodes, q)
    factors = np.concatenate([np.ones((len(q), 1)), q[:, nodes.slides]], axis=1)
    v = np.einsum("pXij,pXj->pXi", R, np.einsum("pm,Xmi->pXi", factors, moment))
    least = LOADED * sum(float(np.linalg.norm(one, axis=-1).sum()) for one in each) * float(np.linalg.norm(g))
    best: Fewest | None = None
    for e in _directions(axes, g, own, ball):
        moves = (np.linalg.norm(np.cross(axes, e[:, None]), axis=-1) < PARALLEL) & own | ball
        loaded = np.linalg.norm(np.cross(_links(nodes, v, moves), e[:, None]), axis=-1)
        loaded = moves & (loaded * np.linalg.norm(np.cross(e, g), axis=-1)[:, None] > least)
        at = int(loaded.sum(axis=1).argmax())
        count = int(loaded[at].sum())
        if count > (best.springs if best else 0):
            section = loaded[at]  # what gravity does not load may be held as well
            above = [_path(nodes, X, section)[-1] for X in np.flatnonzero(section).tolist()]
            best = Fewest(count, _names(nodes, section), _held(nodes, section, q[at]), len({*above}) < len(above))
    return best


def _movable(nodes: Nodes, names: set[str]) -> tuple[Booleans, Booleans]:
    """(nodes,) those that turn by a coordinate of their own, and the first one of each ball joint."""
    tree = nodes.tree
    own, ball, joints = np.zeros(len(nodes), bool), np.zeros(len(nodes), bool), tree.mechanism.joints
    for X, node in enumerate(nodes.nodes, 1):
        driven = np.flatnonzero(tree.C[node.row])
        own[X] = all(np.count_nonzero(tree.C[:, j]) == 1 and tree.coordinates[j] in names for j in driven)
        own[X] &= len(driven) == 1
    for X, node in enumerate(nodes.nodes, 1):
        if any(joint.type == "spherical" and joint.coordinates[0] == tree.motions[node.row] for joint in joints):
            ball[X] = own[X : X + 3].all()
            own[X : X + 3] = False
    return own, ball


def _poses(nodes: Nodes) -> Array:
    """(poses, n) right angles of every joint, and those that make the axes beside it parallel; few joints first."""
    tree, found = nodes.tree, [[0.1] if not turns else [pi / 2, -pi / 2, pi] for turns in nodes.tree.turns]
    for X, node in enumerate(nodes.nodes, 1):
        driven = np.flatnonzero(tree.C[node.row])
        if len(driven) == 1 and node.base:
            below = nodes.nodes[node.base - 1]
            u = below.A0.T @ below.axis  # that axis, in the frame in which this one is given
            for other in nodes.nodes[X:]:
                if other.base == X:
                    ratio = tree.C[node.row, driven[0]]
                    found[driven[0]] += [angle / ratio for angle in _aligning(node, u, other.axis)]
    changes = (
        dict(zip(chosen, values, strict=True))
        for many in range(tree.n + 1)
        for chosen in combinations(range(tree.n), many)
        for values in product(*(found[j] for j in chosen))
    )
    some = list(islice(changes, POSES // max(1, tree.n)))
    q = np.zeros((len(some), tree.n))
    for row, change in zip(q, some, strict=True):
        row[list(change)] = list(change.values())
    return q


def _aligning(node: Node, u: Array, v: Array) -> list[float]:
    """The angles at which a node turns v, fixed in it, to be parallel to u, fixed in its base."""
    w, start = node.axis, (node.A0 + 2 * node.A1.real) @ v
    p = start - w * (w @ start)
    found = []
    for end in (u, -u):
        t = end - w * (w @ end)
        if abs(w @ start - w @ end) < PARALLEL and np.linalg.norm(p) > PARALLEL:
            angle = atan2(w @ np.cross(p, t), p @ t)
            if abs(angle) > PARALLEL:
                found.append(angle)
    return found


def _orientations(nodes: Nodes, q: Array) -> tuple[Array, Array]:
    """(poses, nodes, 3, 3) and each one's axis (poses, nodes, 3) in the world."""
    R, axes = np.empty((len(q), len(nodes), 3, 3)), np.zeros((len(q), len(nodes), 3))
    R[:, 0] = np.eye(3)
    for X, node in enumerate(nodes.nodes, 1):
        phase = np.exp(1j * (q @ nodes.tree.C[node.row]))[:, None, None]
        R[:, X] = R[:, node.base] @ (node.A0 + 2 * (node.A1 * phase).real)
        axes[:, X] = R[:, node.base] @ node.axis
    return R, axes


def _directions(axes: Array, g: Array, own: Booleans, ball: Booleans) -> Iterator[Array]:
    """(poses, 3) unit directions that the axes of a section may have."""
    for X in np.flatnonzero(own):
        yield axes[:, X]
    if ball.any():
        level = np.linalg.svd(g[None])[2][1:]
        yield np.broadcast_to(np.array([0.8, 0.6]) @ level, axes[:, 0].shape)


def _links(nodes: Nodes, v: Array, moves: Booleans) -> Array:
    """(poses, nodes, 3) the moment of all that turns with each node that moves: of it and of those held to it."""
    total, head = np.zeros_like(v), np.zeros(v.shape[:2], int)
    row = np.arange(len(v))
    for X in range(len(nodes)):
        if X:
            head[:, X] = np.where(moves[:, X], X, head[:, nodes.nodes[X - 1].base])
        np.add.at(total, (row, head[:, X]), v[:, X])
    return total


def _names(nodes: Nodes, moves: Booleans) -> tuple[str, ...]:
    joint_of = {name: joint.name for joint in nodes.tree.mechanism.joints for name in joint.coordinates}
    return tuple(joint_of[nodes.tree.motions[nodes.nodes[X - 1].row]] for X in np.flatnonzero(moves))


def _path(nodes: Nodes, X: int, moves: Booleans) -> list[int]:
    """The nodes below X down to the next that moves, or to the world."""
    path = [nodes.nodes[X - 1].base]
    while path[-1] and not moves[path[-1]]:
        path.append(nodes.nodes[path[-1] - 1].base)
    return path


def _held(nodes: Nodes, moves: Booleans, q: Array) -> tuple[tuple[Coordinate, float], ...]:
    """The coordinates that are held between two joints that move, and the others that are not at zero."""
    tree, paths = nodes.tree, [_path(nodes, X, moves) for X in np.flatnonzero(moves).tolist()]
    between = {X for path in paths if path[-1] for X in path[:-1]}
    joints = {*_names(nodes, moves)}
    some = {j for X in between for j in np.flatnonzero(tree.C[nodes.nodes[X - 1].row])} | {*np.flatnonzero(q)}
    return tuple(
        (name, float(q[j])) for j, name in enumerate(tree.coordinates)
        if j in some and (q[j] or not {name, name.rpartition(".")[0]} & joints)
    )  # fmt: skip


def _word(count: int) -> str:
    return NUMBERS[count] if count < len(NUMBERS) else str(count)

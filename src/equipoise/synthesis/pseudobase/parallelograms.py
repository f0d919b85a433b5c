"""The parallelograms of Lin, Shieh and Chen (2010), Sec. 4, as bodies of a mechanism.

A module is the spatial parallelogram O_{i-1} C_i D_i O^_{i-1} of link i, its auxiliary link and the coupler between the
two, the pseudobase. It is written with two `parallelogram` joints: the auxiliary link has the orientation of link i,
and the coupler that of the upright link below. Or with the joints it is built with: the auxiliary links hang on each
other by hinges as the links do, and two ball joints hold a coupler, the second of them by closing a loop. Such a module
folds where C_i, the joint's axis and the vertical come into one plane: there it may leave the branch on which it is a
parallelogram, and joint ranges should keep away; `folding` says which modules do fold.

Only the line C_i D_i of a coupler on spherical joints is defined, for
it may spin about that line: its mass centre and the spring's end lie on it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...kinematics import Tree
from ...kinematics.sampling import sample
from ...model.arrays import Array, frozen, vec3
from ...model.elements import Spring
from ...model.mechanism import Body, Joint, Loop, Mechanism
from ...model.names import Names
from ...model.rotation import to_rpy
from ..arms.moments import Lump, Moment, Segment, upwards

FOLDS = 1024  # poses that are looked at for modules that fold
POSES = 64  # of which the one with the widest parallelograms is where real joints are assembled


@frozen
class Module:
    """A parallelogram O_{i-1} C_i D_i O^_{i-1}: link i, its pseudobase (the coupler C_i D_i) and its auxiliary link.

    Attributes:
        centre: C_i from O_{i-1}, along the link's axes [m].
        mass, com: of the auxiliary link [kg], com as `centre`, but on its own chain [m].
        coupler: mass of the pseudobase [kg]; its mass centre is halfway between C_i and D_i.
        planar: a four-bar with revolute joints at C_i and D_i instead of spherical ones: no idle spin.
    """

    centre: Array
    mass: float
    com: Array
    coupler: float
    planar: bool

    @property
    def lumps(self) -> tuple[Lump, Lump]:
        """What (24)-(25) add to the link: the auxiliary link, and the pseudobase at C_i."""
        return (self.mass, self.com), (self.coupler, self.centre)


class Builder:
    """Adds auxiliary links, pseudobases and springs to an arm whose auxiliary chain is `height` [m] above it.

    Args:
        real: hinges, ball joints and loops in the place of `parallelogram` joints.
    """

    def __init__(self, mechanism: Mechanism, links: Sequence[Segment], height: float, real: bool = False) -> None:
        self.mechanism, self.links, self.height, self.real = mechanism, links, height, real
        self._tree = tree = Tree.of(mechanism)
        self._home = tree.poses(np.zeros((1, tree.n))).R[0]
        self._index = tree.index

    def build(
        self,
        modules: Mapping[int, Module],
        whole: Sequence[Moment],
        sprung: Sequence[int],
        sizes: Mapping[str, tuple[float, float, float]],
    ) -> Mechanism:
        """The balanced arm.

        Args:
            modules: by the number of the link, each after the one it hangs on; no upright link has one.
            whole: moments with the masses of the modules.
            sprung: the links that get a spring.
            sizes: stiffness [N/m], l_CA and l_CB [m] of each one's spring.
        """
        m = self.mechanism
        bodies, joints, loops, springs = list(m.bodies), list(m.joints), [], []
        taken, held = Names(m.body_names), Names(joint.name for joint in m.joints)
        auxiliaries: dict[int, str] = {}
        # ball joints are zero where it is assembled: there their three angles are far from being two
        q = self._widest(modules) if self.real else np.zeros(self._tree.n)
        assembly: dict[str, float] = dict(zip(self._tree.coordinates, q.tolist(), strict=True))
        R = self._tree.poses(q[None]).R[0]
        for i, module in modules.items():
            link = self.links[i]
            parent, xyz = self._foot(link, auxiliaries)
            auxiliaries[i] = taken.new(f"{link.name} auxiliary")
            bodies.append(Body(auxiliaries[i], module.mass, vec3(module.com)))
            aside = Joint(held.new(f"{link.name} auxiliary"), "parallelogram", parent, auxiliaries[i], vec3(xyz),
                          follows=link.name)  # fmt: skip
            frame = self._upright(i)
            stand = self._stand(frame)
            up = stand.T @ self._up(frame)
            base = taken.new(f"{link.name} pseudobase")
            bodies.append(Body(base, module.coupler, vec3(self.height / 2 * up)))
            C = link.origin + module.centre
            over = Joint(held.new(f"{link.name} pseudobase"), "parallelogram", link.name, base, vec3(C), follows=frame)
            if self.real:
                below = self._beneath(link, auxiliaries)
                aside = replace(aside, type="revolute", follows=None, rpy=to_rpy(self._turn(below, link.name)),
                                axis=vec3(link.axis))  # fmt: skip
                over = replace(
                    over,
                    type="spherical",
                    follows=None,
                    rpy=to_rpy(R[self._index[link.name]].T @ R[self._index[frame]] @ stand),
                )
                assert link.joint is not None
                assembly[aside.name] = assembly[link.joint.name]
                D = Loop(base, vec3(self.height * up), auxiliaries[i], vec3(module.centre))
                if module.planar:
                    axis = vec3(stand.T @ self._turn(frame, link.name) @ link.axis)
                    over = replace(over, type="revolute", axis=axis)
                    D = replace(D, axis_a=axis, axis_b=vec3(link.axis))
                loops.append(D)
            joints += [aside, over]
            if i in sprung:
                K, a, b = sizes[link.name]
                towards = whole[i].vector / np.linalg.norm(whole[i].vector)
                A, B = a * up, C + b * towards  # (13), (14)
                springs.append(Spring(f"{link.name} spring", base, vec3(A), link.name, vec3(B), K))
        made = replace(m, bodies=tuple(bodies), joints=tuple(joints), springs=tuple(springs))
        if not self.real:
            return made
        spins = (f"{joint.name}.z" for joint in made.joints[len(m.joints) :] if joint.type == "spherical")
        return replace(
            made,
            loops=tuple(loops),
            independent=(*self._tree.coordinates, *spins),
            assembly=tuple(assembly.items()),
        )

    def _widest(self, modules: Mapping[int, Module]) -> Array:
        """(n,) of some configurations the one furthest from where a parallelogram could fold.

        There C_i, the joint's axis and the vertical are in one plane: turning the auxiliary link leaves |C_i D_i|.
        """
        q = sample(self._tree, POSES)
        return q[int(np.abs(widths(self._tree, self._centres(modules), q)).min(axis=1).argmax())]

    def folding(self, modules: Mapping[int, Module]) -> list[str]:
        """The links whose modules fold somewhere inside the joint ranges: at poses on either side of which they are."""
        q = sample(self._tree, FOLDS)
        sides = np.sign(widths(self._tree, self._centres(modules), q))
        return [self.links[i].name for i, both in zip(modules, np.ptp(sides, axis=0) > 0, strict=True) if both]

    def _centres(self, modules: Mapping[int, Module]) -> list[tuple[Segment, Array]]:
        return [(self.links[i], module.centre) for i, module in modules.items()]

    def _foot(self, link: Segment, auxiliaries: Mapping[int, str]) -> tuple[str, Array]:
        """Where O^_{i-1} is: a body and a point in its frame, above O_{i-1}."""
        assert link.joint is not None
        if link.parent in auxiliaries:
            return auxiliaries[link.parent], link.tip
        body = link.joint.parent  # on an upright link: up is fixed in it
        return body, np.array(link.joint.xyz) + self.height * self._up(body)

    def _beneath(self, link: Segment, auxiliaries: Mapping[int, str]) -> str:
        """The body of the arm that has the orientation of what carries the auxiliary link."""
        assert link.joint is not None
        return self.links[link.parent].name if link.parent in auxiliaries else link.joint.parent

    def _turn(self, a: str, b: str) -> Array:
        """(3, 3) the orientation of body b in body a at q = 0."""
        return self._home[self._index[a]].T @ self._home[self._index[b]]

    def _stand(self, frame: str) -> Array:
        """(3, 3) the axes of a pseudobase in its upright frame: with ball joints z is up, so that it spins about z."""
        if not self.real:
            return np.eye(3)
        up = self._up(frame)
        x = np.cross(up, np.eye(3)[int(np.abs(up).argmin())]).astype(float)
        x /= float(np.linalg.norm(x))
        return np.column_stack([x, np.cross(up, x), up])

    def _upright(self, i: int) -> str:
        """The upright link that carries link i."""
        while not self.links[i].upright:
            i = self.links[i].parent
        return self.links[i].name

    def _up(self, body: str) -> Array:
        """Up in the frame of an upright body."""
        return self._home[self._index[body]].T @ upwards(self.mechanism)


def widths(tree: Tree, modules: Sequence[tuple[Segment, Array]], q: Array) -> Array:
    """(N, modules) how wide each parallelogram is, as a share of the most: it folds where this changes sign.

    Args:
        modules: links with C_i from O_{i-1} along the link's axes [m].
        q: (N, n) configurations of the bare arm.
    """
    R, up = tree.poses(q).R, upwards(tree.mechanism)
    found = []
    for link, centre in modules:
        level = np.cross(link.axis, centre)
        found.append(R[:, tree.index[link.name]] @ level @ up / np.linalg.norm(level))
    return np.stack(found, axis=1)


def mobility(turning: int, modules: int) -> tuple[int, int]:
    """(active, idle) freedoms of an arm with so many freedoms and spatial modules, by Eqs. (19)-(20).

    A module adds an auxiliary link on a revolute joint, and a pseudobase on two spherical joints that may spin about
    the line between them. A planar four-bar moves as one in its plane adds no freedom: it is not counted here.
    """
    links = 1 + turning + 2 * modules
    revolute, spherical = turning + modules, 2 * modules
    freedoms = 6 * (links - (revolute + spherical) - 1) + revolute + 3 * spherical  # (20)
    return freedoms - modules, modules

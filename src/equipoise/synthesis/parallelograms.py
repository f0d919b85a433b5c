"""The parallelograms of Lin, Shieh and Chen (2010), Sec. 4, as bodies of a mechanism.

A module is the spatial parallelogram O_{i-1} C_i D_i O^_{i-1} of link i, its auxiliary link and the coupler between the
two, the pseudobase. It is written with two `parallelogram` joints: the auxiliary link has the orientation of link i,
and the coupler that of the upright link below. Only the line C_i D_i of a coupler on spherical joints is defined, for
it may spin about that line: its mass centre and the spring's end lie on it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array
from ..io.text import Names
from ..kinematics import Tree
from ..mechanism import Body, Joint, Mechanism
from ..spring import Spring, Vec3
from .moments import Lump, Moment, Segment, upwards


@dataclass(frozen=True)
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
    """Adds auxiliary links, pseudobases and springs to an arm whose auxiliary chain is `height` [m] above it."""

    def __init__(self, mechanism: Mechanism, links: Sequence[Segment], height: float) -> None:
        self.mechanism, self.links, self.height = mechanism, links, height
        tree = Tree.of(mechanism)
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
        bodies, joints, springs = list(m.bodies), list(m.joints), []
        taken, held = Names(m.body_names), Names(joint.name for joint in m.joints)
        auxiliaries: dict[int, str] = {}
        for i, module in modules.items():
            link = self.links[i]
            parent, xyz = self._foot(link, auxiliaries)
            auxiliaries[i] = taken.new(f"{link.name} auxiliary")
            bodies.append(Body(auxiliaries[i], module.mass, _vec3(module.com)))
            joints.append(
                Joint(held.new(f"{link.name} auxiliary"), "parallelogram", parent, auxiliaries[i], _vec3(xyz),
                      follows=link.name)
            )  # fmt: skip
            frame = self._upright(i)
            up = self._up(frame)
            base = taken.new(f"{link.name} pseudobase")
            bodies.append(Body(base, module.coupler, _vec3(self.height / 2 * up)))
            C = link.origin + module.centre
            joints.append(
                Joint(held.new(f"{link.name} pseudobase"), "parallelogram", link.name, base, _vec3(C), follows=frame)
            )
            if i in sprung:
                K, a, b = sizes[link.name]
                towards = whole[i].vector / np.linalg.norm(whole[i].vector)
                A, B = a * up, C + b * towards  # (13), (14)
                springs.append(Spring(f"{link.name} spring", base, _vec3(A), link.name, _vec3(B), K))
        return replace(m, bodies=tuple(bodies), joints=tuple(joints), springs=tuple(springs))

    def _foot(self, link: Segment, auxiliaries: Mapping[int, str]) -> tuple[str, Array]:
        """Where O^_{i-1} is: a body and a point in its frame, above O_{i-1}."""
        assert link.joint is not None
        if link.parent in auxiliaries:
            return auxiliaries[link.parent], link.tip
        body = link.joint.parent  # on an upright link: up is fixed in it
        return body, np.array(link.joint.xyz) + self.height * self._up(body)

    def _upright(self, i: int) -> str:
        """The upright link that carries link i."""
        while not self.links[i].upright:
            i = self.links[i].parent
        return self.links[i].name

    def _up(self, body: str) -> Array:
        """Up in the frame of an upright body."""
        return self._home[self._index[body]].T @ upwards(self.mechanism)


def mobility(turning: int, modules: int) -> tuple[int, int]:
    """(active, idle) freedoms of an arm with so many freedoms and spatial modules, by Eqs. (19)-(20).

    A module adds an auxiliary link on a revolute joint, and a pseudobase on two spherical joints that may spin about
    the line between them. A planar four-bar moves as one in its plane adds no freedom: it is not counted here.
    """
    links = 1 + turning + 2 * modules
    revolute, spherical = turning + modules, 2 * modules
    freedoms = 6 * (links - (revolute + spherical) - 1) + revolute + 3 * spherical  # (20)
    return freedoms - modules, modules


def _vec3(v: Array) -> Vec3:
    x, y, z = v.tolist()
    return x, y, z

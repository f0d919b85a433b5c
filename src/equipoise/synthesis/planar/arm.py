"""Planar serial arms as complex numbers: Lee and Chen (2014), Mechanism and Machine Theory 74, sections 2 and 3.

Links are numbered from 1, the ground, to n. The direction of link j is a unit complex number u_j; link j reaches from
its joint to the next by ``r_j = |r_j| u_j``, and the ground's direction x_1 is horizontal, with gravity along -i x_1. A
spring between links i < k stretches::

    d = -a u_i + r_{i+1} + .. + r_{k-1} + b u_k,      a, b complex [m]

so that `a` is measured from the DISTAL joint of link i (the joint to link i+1; for the ground the first joint) and `b`
from the proximal joint of link k. The paper's ``A = a/|r_i|`` and ``B = b/|r_k|``, with ``|x_1| = 1 m``, angles arg a
and arg b.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from ...kinematics import Tree
from ...model.arrays import Array, Complexes, frozen
from ...model.elements import Spring, Vec3, lines
from ...model.errors import UnsupportedError
from ...model.masses import lumped_masses
from ...model.mechanism import WORLD, Joint, Mechanism

PARALLEL = 1e-9  # sine of the angle between axes that count as parallel


@dataclass(frozen=True)
class Installation:
    """A zero-free-length spring between links `i` < `k`.

    Attributes:
        stiffness: [N/m].
        a: [m] from the distal joint of link i, in the direction of link i (ground: of x_1).
        b: [m] from the proximal joint of link k, in the direction of link k.
    """

    i: int
    k: int
    stiffness: float
    a: complex
    b: complex

    @property
    def span(self) -> int:
        """Joints that it spans."""
        return self.k - self.i


@frozen
class PlanarArm:
    """A serial arm whose axes are all parallel.

    Attributes:
        links: body that stands for each link, the ground first; other bodies are fixed to one of these.
        lengths: (n,) ``|r_j|`` [m]; 1 for the ground; for the end link the distance of its mass centre, which scales.
        moments: (n,) complex mass moment [kg m] that gravity sees at the end of each u_j: of the link itself about its
            joint and of all that follows at its distal joint, in the direction of u_j. The ground has none.
        gravity: [m/s^2] in the plane of motion.
        R: (n, 3, 3) orientation of each link at q = 0, in a frame whose x is x_1, y up and z along the axes.
        p: (n, 3) [m] its joint in that frame; the ground's is the first joint.
        u: (n,) direction of each link at q = 0.
        ground: (3,) [m] the first joint in the world.
    """

    links: tuple[str, ...]
    lengths: Array
    moments: Complexes
    gravity: float
    R: Array
    p: Array
    u: Complexes
    ground: Array

    @property
    def n(self) -> int:
        """The number of links, the ground included."""
        return len(self.links)

    @cached_property
    def straight(self) -> bool:
        """Whether every mass moment lies on its link's line."""
        return bool((abs(self.moments.imag) <= 1e-12 * abs(self.moments).max()).all())

    @staticmethod
    def of(mechanism: Mechanism, end: float | None = None) -> PlanarArm:
        """The arm of a mechanism, its springs left aside.

        Args:
            end: [m] length of the end link, which a mechanism file does not say and which scales.

        Raises:
            UnsupportedError: see `obstacles`.
        """
        found = obstacles(mechanism)
        if found:
            raise UnsupportedError(f"'{mechanism.name}' is not a planar serial arm: {'; '.join(found)}")
        tree = Tree.of(mechanism)
        chain = _chain(mechanism)
        poses = tree.poses(np.zeros((1, tree.n)))
        R_W, p_W = poses.R[0], poses.p[0]
        first = p_W[tree.index[chain[0].child]]
        z = _axis(mechanism, chain[0])
        down = np.array(mechanism.gravity)
        down = down - (down @ z) * z
        y = -down / np.linalg.norm(down)
        F = np.array([np.cross(y, z), y, z])  # rows: the frame's axes in the world
        links = (WORLD, *(joint.child for joint in chain))
        joints = np.array([first, *(p_W[tree.index[body]] for body in links[1:])])
        p = (joints - first) @ F.T
        owner = _owners(mechanism, links)
        own = np.zeros(len(links), complex)  # each link's own mass moment about its joint
        mass = np.zeros(len(links))
        for body, m, at in lumped_masses(mechanism.with_springs(())):
            j = owner[body]
            point = F @ (p_W[tree.index[body]] + R_W[tree.index[body]] @ at - joints[j])
            own[j] += m * complex(point[0], point[1])
            mass[j] += m
        reach = np.array([1.0, *np.diff(p[1:, 0] + 1j * p[1:, 1]), 0.0], complex)
        scale = abs(reach[1:]).max() if len(links) > 2 else 0.0
        at_end = own[-1] / mass[-1] if mass[-1] else 0.0
        reach[-1] = at_end if abs(at_end) > 1e-12 * scale and at_end else (scale or 1.0)
        after = np.concatenate([np.cumsum(mass[::-1])[::-1][1:], [0.0]])
        moments = (own + after * np.append(reach[:-1], 0)) * np.exp(-1j * np.angle(reach))
        moments[0] = 0
        R = np.array([F @ R_W[tree.index[body]] for body in links])
        u = np.exp(1j * np.angle(reach))
        lengths: Array = np.abs(reach).astype(np.float64)
        if end is not None:
            lengths[-1] = end
        return PlanarArm(links, lengths, moments, float(np.linalg.norm(down)), R, p, u, first)

    def springs(self, found: Iterable[Installation]) -> tuple[Spring, ...]:
        """Springs between points of the bodies' own frames, all in the plane of the first joint."""
        springs = []
        for number, one in enumerate(found, start=1):
            i, k = one.i - 1, one.k - 1
            from_joint = one.a * self.u[i] + (self.lengths[i] * self.u[i] if i else 0)
            springs.append(
                Spring(
                    f"spring {number} ({one.i}-{one.k})",
                    self.links[i],
                    self._point(i, from_joint),
                    self.links[k],
                    self._point(k, one.b * self.u[k]),
                    float(one.stiffness),
                )
            )
        return tuple(springs)

    def installations(self, mechanism: Mechanism) -> tuple[Installation, ...]:
        """The springs of `mechanism`, which is this arm; an offset along the axes does no work and is left out.

        Raises:
            UnsupportedError: a spring of some free length.
        """
        owner, found = _owners(mechanism, self.links), []
        tree = Tree.of(mechanism)
        poses = tree.poses(np.zeros((1, tree.n)))
        world_p, world_R = poses.p[0], poses.R[0]
        F = self.R[0] @ world_R[0].T
        for spring in lines(mechanism, "a stiffness block"):
            if spring.free_length:
                raise UnsupportedError(f"spring '{spring.name}': a stiffness block needs zero free length")
            ends = []
            for body, at in spring.ends:
                j, index = owner[body], tree.index[body]
                x, y, _ = F @ (world_p[index] + world_R[index] @ np.array(at) - self.ground) - self.p[j]
                ends.append((j, complex(x, y) / complex(self.u[j])))
            (i, a), (k, b) = sorted(ends, key=lambda end: end[0])
            if i == k:
                continue  # between two points of one link: constant
            found.append(Installation(i + 1, k + 1, spring.stiffness, a - (self.lengths[i] if i else 0), b))
        return tuple(found)

    def _point(self, j: int, z: complex) -> Vec3:
        at = np.array([complex(z).real, complex(z).imag, -self.p[j, 2]])  # in the first joint's plane
        point = self.R[j].T @ at + (self.ground if j == 0 else 0)
        x, y, z_ = (float(value) for value in np.where(abs(point) < 1e-15 * max(1.0, abs(point).max()), 0.0, point))
        return x, y, z_


def obstacles(mechanism: Mechanism) -> list[str]:
    """Why a mechanism is no planar serial arm; empty when it is one."""
    if mechanism.loops:
        return ["it has loops"]
    if mechanism.couplings:
        return ["its joints are coupled"]
    other = sorted({joint.type for joint in mechanism.joints} - {"revolute", "fixed"})
    if other:
        return [f"it has {', '.join(other)} joints; all must be revolute (or fixed)"]
    chain = _chain(mechanism)
    turning = sum(joint.type == "revolute" for joint in mechanism.joints)
    if not chain or len(chain) != turning:
        return ["its revolute joints do not form one chain from the world"]
    z = _axis(mechanism, chain[0])
    skewed = [j.name for j in chain if np.linalg.norm(np.cross(z, _axis(mechanism, j))) > PARALLEL]
    if skewed:
        return [f"the axes of {', '.join(skewed)} are not parallel to that of {chain[0].name}"]
    g = np.array(mechanism.gravity)
    if np.linalg.norm(g - (g @ z) * z) <= PARALLEL * np.linalg.norm(g) or not g.any():
        return ["gravity does no work in its plane of motion"]
    tree = Tree.of(mechanism)
    p = tree.poses(np.zeros((1, tree.n))).p[0]
    origin = [p[tree.index[joint.child]] for joint in chain]
    gaps = [np.linalg.norm(np.cross(z, b - a)) for a, b in pairwise(origin)]
    same = [b.name for b, gap in zip(chain[1:], gaps, strict=True) if gap <= PARALLEL * max(gaps)]
    return [f"{', '.join(same)} turns about the same axis as the joint before"] if same else []


def _chain(mechanism: Mechanism) -> list[Joint]:
    """The revolute joints from the world outwards, as far as they do not branch."""
    tree = Tree.of(mechanism)
    above = {link.joint.child: link.joint for link in tree.links}
    chain: list[Joint] = []
    for link in tree.links:
        if link.joint.type != "revolute":
            continue
        body = link.joint.parent
        while body != WORLD and above[body].type == "fixed":
            body = above[body].parent
        if body != (chain[-1].child if chain else WORLD):
            return []
        chain.append(link.joint)
    return chain


def _axis(mechanism: Mechanism, joint: Joint) -> Array:
    """(3,) a joint's unit axis in the world at q = 0."""
    tree = Tree.of(mechanism)
    axis = tree.poses(np.zeros((1, tree.n))).R[0, tree.index[joint.child]] @ np.array(joint.axis)
    return axis / np.linalg.norm(axis)


def _owners(mechanism: Mechanism, links: tuple[str, ...]) -> dict[str, int]:
    """Body -> index of the link that it is fixed to."""
    owner = {body: j for j, body in enumerate(links)}
    for link in Tree.of(mechanism).links:
        if link.joint.child not in owner:
            owner[link.joint.child] = owner[link.joint.parent]
    return owner


def upward(i: int) -> complex:
    """The direction that a spring's `a` on link i is counted along, in the frame of that link."""
    return 1j if i == 1 else 1.0

"""Mass moments of the links of an arm (Lin, Shieh and Chen, J. Mechanisms Robotics 2, 2010, Secs. 2 and 5).

The gravity energy of links that joints turn is a sum over the links, each as if it turned about a fixed point:

    U = -sum_i g . (mu_i sigma_i)                                        (6)

where ``mu_i sigma_i`` is fixed in link i: its own mass and everything beyond it, hung on its end. That holds for any
tree. A link here is all bodies that fixed and prismatic joints hold in one orientation. The paper's r_i points from
O_i to O_{i-1}: -r_i is the `tip` of the next link.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ...kinematics import Tree
from ...kinematics.groups import places
from ...model.arrays import Array, frozen
from ...model.masses import lumped_masses
from ...model.mechanism import Joint, Mechanism

MOMENT_ROUNDING = 1e-12  # relative: what is nothing but rounding
POSES = 64
JOINED = ("fixed", "prismatic")

Lump = tuple[float, Array]
"""A mass [kg] and where it is [m], from O_{i-1} along the axes of its link."""


@frozen
class Segment:
    """Link i of an arm; vectors are along the axes of the body `name`, which stands for it.

    Attributes:
        name: the body that carries the next turning joint, else the first with mass.
        parent: the number of the link it hangs on; the ground, number 0, names itself.
        joint: the joint that turns it; None for the ground.
        axis: that joint's axis.
        origin: O_{i-1}, where that joint is, in the frame of `name` [m].
        tip: the same point from the parent's own origin O_{i-2}, along the parent's axes [m].
        lumps: its masses.
        ups: (POSES, 3) where up is at random configurations.
    """

    name: str
    parent: int
    joint: Joint | None
    axis: Array
    origin: Array
    tip: Array
    lumps: tuple[Lump, ...]
    ups: Array

    @property
    def upright(self) -> bool:
        """Whether it only turns about the vertical: up is fixed in it."""
        return float(np.ptp(self.ups, axis=0).max()) <= MOMENT_ROUNDING

    @property
    def level(self) -> bool:
        """Whether its joint's axis stays horizontal."""
        return float(np.abs(self.ups @ self.axis).max()) <= MOMENT_ROUNDING

    def works(self, moment: Array, unit: float) -> bool:
        """Whether gravity does work on a moment (3,) [kg m] fixed in it: more than rounding of `unit` [kg m]."""
        return float(np.ptp(self.ups @ moment)) > MOMENT_ROUNDING * unit


@frozen
class Moment:
    """The point mass that stands for a link and what it carries: `mass` mu_i [kg], and mu_i sigma_i [kg m].

    `size` [kg m] is the sum of what the masses contribute, before anything cancels.
    """

    mass: float
    vector: Array
    size: float

    @property
    def position(self) -> Array:
        """sigma_i [m], along the axes of the link."""
        return self.vector / self.mass if self.mass else np.zeros(3)


def segments(mechanism: Mechanism) -> tuple[Segment, ...]:
    """The links of a tree, the ground first and each after the one it hangs on.

    Raises:
        UnsupportedError: it has loops.
    """
    tree = Tree.of(mechanism)
    place = places(tree, JOINED)
    roots = [body for body in [0, *(link.body for link in tree.links)] if place[body].root == body]
    lumps = _lumps(tree)
    carriers: dict[int, int] = {}
    for link in tree.links:
        if place[link.body].root == link.body:
            carriers.setdefault(place[link.parent].root, link.parent)
    standing = {  # root -> the body that stands for the link
        root: carriers.get(root, next((b for b in place if place[b].root == root and b in lumps), root))
        for root in roots
    }
    rotations = tree.poses(np.random.default_rng(0).uniform(-np.pi, np.pi, (POSES, tree.n))).R
    up = upwards(mechanism)
    found = []
    for root in roots:
        stand = place[standing[root]]
        link = tree.link_of.get(root)
        above = place[link.parent].root if link else root
        own = [
            (mass, stand.R.T @ (place[body].p + place[body].R @ p))
            for body, masses in lumps.items()
            if place[body].root == root
            for mass, p in masses
        ]
        found.append(
            Segment(
                name=tree.names[standing[root]],
                parent=roots.index(above),
                joint=link.joint if link else None,
                axis=stand.R.T @ link.motions[0].axis if link and link.motions else np.zeros(3),
                origin=-stand.R.T @ stand.p,
                tip=place[standing[above]].R.T @ place[root].base,
                lumps=tuple(own),
                ups=np.swapaxes(rotations[:, standing[root]], 1, 2) @ up,
            )
        )
    return tuple(found)


def moments(links: Sequence[Segment], extra: Mapping[int, Sequence[Lump]] | None = None) -> tuple[Moment, ...]:
    """The moment of each link by Eqs. (7)-(8), or with masses of other bodies that hang on it by (24)-(25).

    Args:
        extra: link number -> masses of its auxiliary link and of its pseudobase, the latter at C_i. Only the
            vertical offset of those bodies is left out, which is constant.
    """
    beyond = np.zeros(len(links))  # sum_j m_j of everything from link i on
    vectors = np.zeros((len(links), 3))
    mu, sizes = np.zeros(len(links)), np.zeros(len(links))
    for i in reversed(range(len(links))):
        link = links[i]
        own = [*link.lumps, *(extra or {}).get(i, ())]
        mass = sum(m for m, _ in own)
        beyond[i] += mass
        mu[i] = mass + beyond[i]  # (7), (24)
        # (8), (25) times mu_i: m_i s_i - m_i r_i is m_i times the place from O_{i-1}; -m_j r_i came from those beyond
        vectors[i] += sum((m * p for m, p in own), np.zeros(3))
        sizes[i] += sum(m * float(np.linalg.norm(p)) for m, p in own)
        if i:
            beyond[link.parent] += beyond[i]
            vectors[link.parent] += beyond[i] * link.tip
            sizes[link.parent] += beyond[i] * float(np.linalg.norm(link.tip))
    return tuple(Moment(float(m), v, float(s)) for m, v, s in zip(mu, vectors, sizes, strict=True))


def upwards(mechanism: Mechanism) -> Array:
    """(3,) the direction against gravity, zero where there is none."""
    g = np.array(mechanism.gravity, float)
    size = float(np.linalg.norm(g))
    return -g / size if size else np.zeros(3)


def slide_faults(mechanism: Mechanism, links: Sequence[Segment]) -> Iterator[str]:
    """Why the moments are not constant where joints slide; nothing when they are.

    A slide is harmless where it is horizontal, on a link that only turns about the vertical, or where the slides on a
    link carry no turning link and their masses move against each other, as the fingers of a gripper do.
    """
    tree = Tree.of(mechanism)
    place = places(tree, JOINED)
    number = {link.joint.child: i for i, link in enumerate(links) if link.joint}
    weight = np.zeros(len(tree.names))  # of each body and what it carries
    for body, masses in _lumps(tree).items():
        weight[body] += sum(m for m, _ in masses)
    turning = np.zeros(len(tree.names), dtype=bool)  # whether a turning joint is on it, or beyond
    for link in reversed(tree.links):
        weight[link.parent] += weight[link.body]
        turning[link.parent] |= turning[link.body] or link.joint.type not in JOINED
    drift: dict[int, Array] = {}  # link -> (3, n) how fast its moment changes [kg]
    slides: dict[int, list[str]] = {}
    for link in filter(lambda link: link.slide, tree.links):
        root, motion = place[link.body].root, link.motions[0]
        segment = links[number.get(tree.names[root], 0)]
        axis = place[link.parent].R @ link.R0 @ motion.axis  # in the frame of the root
        if segment.upright and abs(_vertical(tree, root, axis)) <= MOMENT_ROUNDING:
            continue
        if turning[link.body]:
            yield (
                f"joint '{link.joint.name}' slides what turns beyond it, and not on the level; a fixed joint in its "
                "place would do"
            )
            continue
        slides.setdefault(root, []).append(link.joint.name)
        rate = weight[link.body] * np.outer(axis, tree.C[motion.row])
        drift[root] = drift.get(root, np.zeros((3, tree.n))) + rate
    for root, rate in drift.items():
        if np.abs(rate).max(initial=0) > MOMENT_ROUNDING * weight[0]:
            names = ", ".join(f"'{name}'" for name in slides[root])
            yield (
                f"sliding {names} changes the moment of link '{links[number.get(tree.names[root], 0)].name}' by "
                f"{np.linalg.norm(rate, axis=0).max():.3g} kg m per m: springs on turning links cannot follow; fixed "
                "joints in their place would do"
            )


def _vertical(tree: Tree, body: int, axis: Array) -> float:
    """The vertical component of a direction fixed in a body that only turns about the vertical."""
    return float(upwards(tree.mechanism) @ tree.poses(np.zeros((1, tree.n))).R[0, body] @ axis)


def _lumps(tree: Tree) -> dict[int, list[Lump]]:
    found: dict[int, list[Lump]] = {}
    for body, mass, p in lumped_masses(tree.mechanism):
        if mass:
            found.setdefault(tree.index[body], []).append((mass, p))
    return found

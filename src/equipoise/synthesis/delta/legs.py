"""Finding the legs of a DELTA robot in a mechanism, by its joints and loops and not by names.

Links are numbered as by Simionescu, Ciupitu and Ionita (2015): 2 on the base, 3 across, the rods 4 and 4', 5 at their
ends, the platform 6. A leg's frame stands at A: x outwards, y along the axis of A, z up. The frame of link 3 has x
along C, y along B, and z away from the rods.
"""

from __future__ import annotations

import numpy as np

from ...kinematics import Tree
from ...kinematics.groups import Place, places
from ...kinematics.linkage import Linkage
from ...kinematics.tree import Link
from ...model.arrays import Array, frozen
from ...model.errors import UnsupportedError
from ...model.masses import lumped_masses
from ...model.mechanism import Mechanism
from ...model.rotation import about

Y = (0.0, 1.0, 0.0)
SMALL = 1e-9  # relative: what counts as nothing


class NotDelta(UnsupportedError):
    """The mechanism is no DELTA robot that the method covers; the message says why."""


@frozen
class DeltaLeg:
    """One leg, as its springs need to know it.

    Attributes:
        joints: names of the joints at A and B; signs: +-1, which way they count about y.
        links: names of link 2, link 3, rod 4, rod 4', link 5.
        A: (3,) of the axis, in the world [m]; R_WL: (3, 3) the leg's frame.
        B: (3,) on link 2 [m], perpendicular to the axis of A in the frame of link 2 but for the same place along it.
        R_2, R_3: (3, 3) the leg's frame where joint A is at zero, and the frame of link 3, in bodies 2 and 3.
        zero_2: angle of AB below x [rad] where joint A is at zero; zero_3: psi where joints A and B are.
        C: of rod 4's joint along B, from the joint of link 3 [m].
        lower: CD [m].
        foot: (3,) the platform's origin from the middle of D D' where the rods do not swing aside, seen from A's place
            along y, in the leg's frame [m].
        elbow: +-1, on which side of the line from A to D the point B is; 1 is outwards.
        moment_2: (3,) mass moment of link 2 itself about A, in its frame [kg m].
        moment_3: (3,) that of link 3 itself about B, across B, in its frame: of a bar that it carries, for one.
        moment_4: (3,) that of all that turns about C, link 5 and a third of the platform included, in rod 4's frame.
        load: mass that hangs on B [kg], a third of the platform included.
        misprint: (m4 - m5) CD, see `rocker.Guide.stiffness_11` [kg m].
    """

    joints: tuple[str, str]
    signs: tuple[float, float]
    links: tuple[str, str, str, str, str]
    A: Array
    R_WL: Array
    B: Array
    R_2: Array
    R_3: Array
    zero_2: float
    zero_3: float
    C: float
    lower: float
    foot: Array
    elbow: float
    moment_2: Array
    moment_3: Array
    moment_4: Array
    load: float
    misprint: float

    def actuator(self, P: Array) -> Array:
        """(N,) value of the joint at A with the platform's origin at `P` (N, 3) in the world; NaN out of reach."""
        w = (P - self.A) @ self.R_WL - self.foot
        with np.errstate(invalid="ignore", divide="ignore"):
            lower = np.sqrt(self.lower**2 - w[:, 1] ** 2)  # of the rods, across y
            reach = np.hypot(w[:, 0], w[:, 2])
            inside = np.arccos((self.upper**2 + reach**2 - lower**2) / (2 * self.upper * reach))
        angle = np.arctan2(-w[:, 2], w[:, 0]) - self.elbow * inside
        return self.signs[0] * ((angle - self.zero_2 + np.pi) % (2 * np.pi) - np.pi)

    @property
    def upper(self) -> float:
        """AB, across the axes [m]."""
        return float(np.linalg.norm(self.B - self.R_2[:, 1] * (self.R_2[:, 1] @ self.B)))


def delta_legs(mechanism: Mechanism) -> tuple[tuple[DeltaLeg, ...], str]:
    """The three legs, and the name of the platform: the body with its mass.

    Raises:
        NotDelta: its structure, or a mass centre where no springs of the method balance it.
    """
    if not mechanism.loops:
        raise NotDelta("it has no loops: a DELTA robot closes three legs on a platform")
    if not any(mechanism.gravity):
        raise NotDelta("there is no gravity")
    return _Reader(mechanism).read()


class _Reader:
    """Reads the legs off the assembled pose."""

    def __init__(self, mechanism: Mechanism) -> None:
        linkage = Tree.of(mechanism)
        assert isinstance(linkage, Linkage)
        self.mechanism, self.tree, self.q = mechanism, linkage.open, linkage.branch.assembled
        self.s = self.tree.values(self.q[None])[0]
        poses = self.tree.poses(self.q[None])
        self.R, self.p = poses.R[0], poses.p[0]
        self.place: dict[int, Place] = places(self.tree, ("fixed",))
        self.below: dict[int, list[Link]] = {}
        for link in self.tree.links:
            if link.joint.type != "fixed":
                self.below.setdefault(self.place[link.parent].root, []).append(link)
        self.mass = dict.fromkeys(range(len(self.tree.names)), 0.0)
        self.moment = {body: np.zeros(3) for body in self.mass}  # about the origin of each rigid group's root
        for name, mass, p in lumped_masses(mechanism):
            at = self.place[self.tree.index[name]]
            self.mass[at.root] += mass
            self.moment[at.root] = self.moment[at.root] + mass * (at.p + at.R @ p)
        g = np.array(mechanism.gravity)
        self.up = -g / np.linalg.norm(g)

    def read(self) -> tuple[tuple[DeltaLeg, ...], str]:
        roots = self.below.get(0, [])
        if len(roots) != 3 or any(link.joint.type != "revolute" for link in roots):
            raise NotDelta(f"{len(roots)} joints on the base, where a DELTA robot has three revolute ones")
        chains = [self._chain(root) for root in roots]
        platform = self._platform([chain[4].body for chain in chains])
        group = [body for body, at in self.place.items() if at.root == platform]
        name = max(group, key=lambda body: (self.mechanism.bodies[body - 1].mass, body == platform))
        return tuple(self._leg(chain, platform, self.p[name]) for chain in chains), self.tree.names[name]

    def _chain(self, two: Link) -> tuple[Link, ...]:
        """Links 2, 3, 4, 4', 5 of a leg."""
        (three,) = self._carried(two, 1)
        rods = self._carried(three, 2)
        ends = [self.below.get(rod.body, []) for rod in rods]
        name = self.tree.names[two.body]
        if sorted(len(end) for end in ends) != [0, 1]:
            raise NotDelta(
                f"the leg of '{name}': one of its two rods has to carry link 5, the other to meet it in a loop"
            )
        four, other = rods if ends[0] else rods[::-1]
        five = (ends[0] or ends[1])[0]
        if five.joint.type != "revolute":
            raise NotDelta(f"joint '{five.joint.name}' is {five.joint.type}, not revolute")
        pair = {other.body, five.body}
        if not any(set(self._ends(i)) == pair for i in range(len(self.mechanism.loops))):
            names = (self.tree.names[body] for body in (other.body, five.body))
            raise NotDelta("no loop joins rod '{}' with link 5 '{}'".format(*names))
        return two, three, four, other, five

    def _carried(self, link: Link, count: int) -> list[Link]:
        found = self.below.get(link.body, [])
        if len(found) != count or any(child.joint.type != "revolute" for child in found):
            name = self.tree.names[link.body]
            raise NotDelta(f"'{name}' carries {len(found)} joints, where a DELTA robot has {count} revolute there")
        return found

    def _ends(self, i: int) -> tuple[int, int]:
        """The rigid groups that a loop joins."""
        loop = self.mechanism.loops[i]
        return self.place[self.tree.index[loop.body_a]].root, self.place[self.tree.index[loop.body_b]].root

    def _platform(self, fives: list[int]) -> int:
        """The rigid group that all three links 5 meet: in the tree or by loops."""
        met = []
        for five in fives:
            others = {link.body for link in self.below.get(five, [])}
            for a, b in (self._ends(i) for i in range(len(self.mechanism.loops))):
                others |= {b} if a == five else {a} if b == five else set()
            met.append(others)
        common = set.intersection(*met)
        if len(common) != 1:
            raise NotDelta("the three links 5 do not meet on one platform")
        return common.pop()

    def _leg(self, chain: tuple[Link, ...], platform: int, point: Array) -> DeltaLeg:
        two, three, four, other, five = chain
        R, p, up = self.R, self.p, self.up
        axes = [R[link.body] @ link.motions[0].axis for link in chain]
        y, across = axes[0], axes[2]
        self._want(abs(y @ up), f"the axis of '{two.joint.name}' is not horizontal")
        wrong = f"the axes of '{two.joint.name}' and '{three.joint.name}' differ"
        self._want(float(np.linalg.norm(np.cross(axes[1], y))), wrong)
        for link, axis in zip(chain[3:], axes[3:], strict=True):
            wrong = f"the axes of '{four.joint.name}' and '{link.joint.name}' are not parallel"
            self._want(float(np.linalg.norm(np.cross(axis, across))), wrong)
        wrong = f"the axes of '{three.joint.name}' and '{four.joint.name}' are not perpendicular"
        self._want(abs(across @ y), wrong)
        x = np.cross(y, up)
        if x @ (p[two.body] - point) < 0:  # outwards is away from the platform
            x, y = -x, -y
        R_WL = np.column_stack([x, y, up])
        z = np.cross(across, y)
        rod = p[five.body] - p[four.body]
        if z @ rod > 0:
            across, z = -across, -z
        R_W3 = np.column_stack([across, y, z])
        wrong = (
            f"the axes of '{four.joint.name}' and '{other.joint.name}' do not both meet that of '{three.joint.name}'"
        )
        C = [R_W3.T @ (p[link.body] - p[three.body]) for link in (four, other)]
        size = float(np.linalg.norm(rod))
        self._want(max(abs(c[2]) for c in C) / size, wrong)

        share, R_4 = self.mass[platform] / 3, R[four.body]
        self._on_axis(five, R_W3, f"link 5 '{self.tree.names[five.body]}' is not in line with its joints")
        rods = self.moment[four.body] + R_4.T @ R[other.body] @ self.moment[other.body]
        moment = rods + (self.mass[five.body] + share) * (R_4.T @ rod)
        aside = R_4.T @ across
        wrong = f"the mass centre of a rod of '{self.tree.names[two.body]}' is not in the plane that it turns in"
        self._want(abs(aside @ rods) / max(float(np.linalg.norm(moment)), 1e-300), wrong)
        signs = float(np.sign(axes[0] @ y)), float(np.sign(axes[1] @ y))
        R_2 = R[two.body].T @ R_WL  # of the assembled pose; turned back to that of zero
        angle = signs[0] * self.s[two.motions[0].row]
        R_2 = R_2 @ about(Y, angle)
        B = R[two.body].T @ (p[three.body] - p[two.body])
        b = R_2.T @ B
        own = _across(self.moment[three.body], R[three.body].T @ y)
        tilt = float(np.arctan2(z @ x, z @ up))
        middle = p[five.body] + (p[other.body] - p[four.body]) / 2
        centre = y @ (p[four.body] + p[other.body] - 2 * p[two.body]) / 2
        return DeltaLeg(
            joints=(two.joint.name, three.joint.name),
            signs=signs,
            links=tuple(self.tree.names[link.body] for link in chain),  # type: ignore[arg-type]
            A=p[two.body],
            R_WL=R_WL,
            B=B,
            R_2=R_2,
            R_3=R[three.body].T @ R_W3,
            zero_2=float(np.arctan2(-b[2], b[0])),
            zero_3=tilt - angle - signs[1] * self.s[three.motions[0].row],
            C=float(C[0][1]),
            lower=size,
            foot=R_WL.T @ (point - middle) + centre * np.array(Y),
            elbow=float(np.sign(np.cross(p[three.body] - p[two.body], middle - p[two.body]) @ y)),
            moment_2=_across(self.moment[two.body], R_2[:, 1]),
            moment_3=np.where(abs(own) > SMALL * (self.mass[three.body] + share) * size, own, 0.0),
            moment_4=_across(moment, aside),
            load=sum(self.mass[link.body] for link in chain[1:]) + share,
            misprint=(self.mass[four.body] - self.mass[five.body]) * size,
        )

    def _on_axis(self, link: Link, R_W3: Array, where: str) -> None:
        """Link 5 turns by psi: a mass centre off the line along E would need a spring of its own."""
        moment = R_W3.T @ self.R[link.body] @ self.moment[link.body]
        lever = max(abs(moment[0]), abs(moment[2])) / max(self.mass[link.body], 1e-300)
        self._want(lever, f"the mass centre of {where}: it is {1e3 * lever:.3g} mm off")

    def _want(self, deviation: float, otherwise: str) -> None:
        if deviation > SMALL:
            raise NotDelta(otherwise)


def _across(moment: Array, axis: Array) -> Array:
    """A mass moment without its part along a unit axis, which a turn does not lift."""
    return moment - axis * (axis @ moment)

"""The building blocks of Simionescu, Ciupitu and Ionita (2015): a rocker, and a rocker about two axes with its guide.

A rocker turns about a horizontal axis A and is balanced by spring 7, from a point V on it to a point W above A
(section 3). A two-axis rocker (4) hangs by a cross link (3) from the horizontal axis B and turns about the axis C of
that link, which meets B. The guide is a link (8) of length FH = BF, hinged at F above B, and a slider (9) at H on a bar
of the cross link: H is on the circle about F through B, so link 8 turns by exactly twice the angle psi of the cross
link (section 4). Spring 10 from the slider to the rocker balances the rocker. It stores k10 BF^2 cos 2psi besides, and
that and the weights of the guide are balanced by spring 11, from T above F to U on link 8.

Frames: the upright frame of B has y along B and z up; the cross link's frame has y along B and x along C, and is
upright at psi = 0, where link 8 points up too.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace

import numpy as np

from ...model.arrays import Array, frozen
from ...model.elements import Spring, Vec3
from ...model.errors import Fault, InputError
from ...model.mechanism import Body, Coupling, Joint
from ...model.rotation import to_rpy

Z = np.array([0.0, 0.0, 1.0])

EQUATION_10 = ("exact", "mended", "literal")


@dataclass(frozen=True)
class Guide:
    """Data of the guide and the two springs of a two-axis rocker. Lengths [m], masses [kg].

    Attributes:
        BF, CS, FU, FT: as in the paper; FH = BF.
        link_8, link_9, frame: masses; link 8's mass centre is at FG8 from F, that of the slider at H, and the frame
            (link 12, which carries F) translates with B.
        spring_10, spring_11: masses of the springs.
        share_10, share_11: what share of them counts at S and at U; the rest counts at R and at T.
        m3Q: mass of the cross link's bar that hangs at Q, where the slider is.
        equation_10: how spring 11 gets its stiffness; see `stiffness_11`.
    """

    BF: float = 0.1
    CS: float = 0.1
    FU: float = 0.08
    FT: float = 0.12
    FG8: float = 0.05
    link_8: float = 0.0
    link_9: float = 0.0
    frame: float = 0.0
    spring_10: float = 0.0
    spring_11: float = 0.0
    share_10: float = 0.5
    share_11: float = 0.5
    m3Q: float = 0.0
    equation_10: str = "exact"

    def __post_init__(self) -> None:
        lengths = ("BF", "CS", "FU", "FT")
        if self.equation_10 not in EQUATION_10:
            raise InputError(Fault(("equation_10",), f"there is no '{self.equation_10}'", EQUATION_10))
        for f in fields(self):
            value = getattr(self, f.name)
            if f.name in lengths and not value > 0:
                raise InputError(Fault((f.name,), f"must be more than 0 m, found {value:g}"))
            if f.name.startswith(("link", "frame", "spring", "m3Q")) and not value >= 0:
                raise InputError(Fault((f.name,), f"must be at least 0 kg, found {value:g}"))
            if f.name.startswith("share") and not 0 <= value <= 1:
                raise InputError(Fault((f.name,), f"must be between 0 and 1, found {value:g}"))

    def stiffness_10(self, moment: float, gravity: float) -> float:
        """Of spring 10 [N/m], Eqs. (7) and (9): ``k10 CS (BF + FH) = g (moment + m10S CS)``.

        Args:
            moment: mass moment of what turns about C, about C [kg m]; gravity: [m/s^2].
        """
        return gravity * self._carried(moment) / (self.CS * 2 * self.BF)

    def stiffness_11(self, moment: float, gravity: float, misprint: float = 0.0) -> float:
        """Of spring 11 [N/m]: exact, from the energy, ``k11 FU FT = g (guide's moment about F) + k10 BF^2``.

        Eqs. (8) and (10) have ``g (moment + m10S CS)`` in the place of ``k10 BF^2 = g (moment + m10S CS) BF/(2 CS)``:
        "mended" is that, exact only if BF = 2 CS. Eq. (10) besides prints m4 for m5 and m11 for m11U: "literal".

        Args:
            moment, gravity: as for `stiffness_10`.
            misprint: (m4 - m5) CD [kg m], what the literal Eq. (10) adds to the moment.
        """
        literal = self.equation_10 == "literal"
        weights = self.link_8 * self.FG8
        weights += (self.link_9 + self.m3Q + (1 - self.share_10) * self.spring_10) * self.BF
        weights += (1.0 if literal else self.share_11) * self.spring_11 * self.FU
        extra = self._carried(moment) * (self.BF / (2 * self.CS) if self.equation_10 == "exact" else 1.0)
        return gravity * (weights + extra + literal * misprint) / (self.FU * self.FT)

    def _carried(self, moment: float) -> float:
        return moment + self.share_10 * self.spring_10 * self.CS

    @property
    def mass(self) -> float:
        """Of all that the guide adds [kg]: it loads the axis B."""
        return self.frame + self.link_8 + self.link_9 + self.m3Q + self.spring_10 + self.spring_11


@frozen
class TwoAxisRocker:
    """A rocker in a mechanism, as its guide needs to know it.

    Attributes:
        upright: the body that carries F; its frame is the upright frame of B, or differs from it by `at`.
        at: origin of the upright frame in that body [m].
        cross: link 3; R_3: (3, 3) the cross link's frame, as of this module, in its body frame.
        angle: psi as ``offset + sum(ratio * joint)``.
        rocker: link 4; C: of the rocker's joint along B, from the cross link's own joint [m].
        moment: (3,) mass moment about C of what turns about C, in the rocker's frame [kg m]; perpendicular to C.
        own: (3,) that of link 3 itself about B, in its body frame [kg m]; perpendicular to B.
        misprint: see `Guide.stiffness_11` [kg m].
        places: where B's joint is in link 3's body, and where C meets B in the rocker's [m].
    """

    upright: str
    at: Vec3
    cross: str
    R_3: Array
    angle: tuple[tuple[str, float], ...]
    offset: float
    rocker: str
    C: float
    moment: Array
    own: Array
    misprint: float = 0.0
    places: tuple[Vec3, Vec3] = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

    def bodies(self, guide: Guide, mark: str) -> Iterator[Body]:
        """Link 8 and slider 9; `mark` ends their names."""
        yield Body(f"guide 8{mark}", guide.link_8, (0.0, 0.0, guide.FG8))
        yield Body(f"slider 9{mark}", guide.link_9 + guide.m3Q)

    def joints(self, guide: Guide, mark: str) -> Iterator[Joint]:
        """F, and the slider: carried by link 8, turned as the cross link."""
        F = (self.at[0], self.at[1], self.at[2] + guide.BF)
        yield Joint(f"F{mark}", "revolute", self.upright, f"guide 8{mark}", F, axis=(0.0, 1.0, 0.0))
        parent, H, rpy = f"guide 8{mark}", (0.0, 0.0, guide.BF), to_rpy(self.R_3)
        yield Joint(f"H{mark}", "parallelogram", parent, f"slider 9{mark}", H, rpy, follows=self.cross)

    def coupling(self, mark: str) -> Coupling:
        """Link 8 turns twice as far as the cross link (Eqs. 4-6)."""
        return Coupling(f"F{mark}", tuple((name, 2 * ratio) for name, ratio in self.angle), 2 * self.offset)

    def springs(self, guide: Guide, mark: str, gravity: float) -> Iterator[Spring]:
        """Springs 10 and 11, and one of Eq. (3) for link 3 where its mass centre is off the axis B."""
        size = float(np.linalg.norm(self.moment))
        S = snapped(np.array(self.places[1]) + guide.CS * self.moment / size)
        k10, k11 = guide.stiffness_10(size, gravity), guide.stiffness_11(size, gravity, self.misprint)
        R, T = (0.0, self.C, 0.0), (self.at[0], self.at[1], self.at[2] + guide.BF + guide.FT)
        ten = Spring(f"spring 10{mark}", f"slider 9{mark}", R, self.rocker, S, k10)
        yield replace(ten, mass=guide.spring_10, mass_split=1 - guide.share_10)
        eleven = Spring(f"spring 11{mark}", self.upright, T, f"guide 8{mark}", (0.0, 0.0, guide.FU), k11)
        yield replace(eleven, mass=guide.spring_11, mass_split=1 - guide.share_11)
        if self.own.any():
            lengths, B = (guide.BF, guide.BF), np.array(self.at)
            three = rocker_spring(f"spring 3{mark}", self.own, self.cross, Z, B, lengths, gravity, base=self.upright)
            yield replace(three, p_b=snapped(np.array(self.places[0]) + three.p_b))


def rocker_spring(
    name: str,
    moment: Array,
    rocker: str,
    up: Array,
    A: Array,
    lengths: tuple[float, float],
    gravity: float,
    mass: tuple[float, float] = (0.0, 0.5),
    base: str = "world",
) -> Spring:
    """Spring 7 of a rocker (Eq. 3): ``k AV AW = g (moment + m7V AV)``, V along the rocker's mass moment, W above A.

    Args:
        moment: (3,) mass moment of all that hangs on the rocker about A, in its frame [kg m].
        up: (3,) unit vector; A: (3,) point of the axis, both in the frame of `base`, which stays upright.
        lengths: AV, AW [m].
        mass: of the spring [kg], and the share of it at V.
    """
    size, (AV, AW), (m7, share) = float(np.linalg.norm(moment)), lengths, mass
    k = gravity * (size + share * m7 * AV) / (AV * AW)
    V, W = snapped(AV * moment / size), snapped(A + AW * up)
    return Spring(name, base, W, rocker, V, k, mass=m7, mass_split=1 - share)


def snapped(p: Array) -> Vec3:
    """A point of a file: zeros that are only rounding become zeros."""
    x, y, z = (0.0 if abs(value) < 1e-15 else float(value) for value in p)
    return x, y, z

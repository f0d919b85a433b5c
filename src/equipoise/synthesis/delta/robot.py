"""The DELTA robot as a mechanism with real loops (Simionescu, Ciupitu and Ionita 2015, section 2).

Each leg has five links: 2 turns about A on the base, 3 about B on link 2 (parallel axes), the rods 4 and 4' about C and
C' on link 3, and link 5 joins the rods' ends D and D' and carries the platform 6 at E. All joints are hinges. The
spanning tree cuts D' of every leg and E of legs 2 and 3.

A leg's frame stands at A: x outwards, y along the axis of A, z up. The angle of A counts downwards from the horizontal;
link 3 hangs upright (z up) where the angles of A and B add to nothing, and its rods then point down.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import acos, asin, cos, pi, sin

from ...model.elements import Vec3
from ...model.errors import Fault, InputError
from ...model.mechanism import Body, Joint, Loop, Mechanism

LEGS = (1, 2, 3)
Y: Vec3 = (0.0, 1.0, 0.0)
X: Vec3 = (1.0, 0.0, 0.0)


@dataclass(frozen=True)
class DeltaRobot:
    """Data of a symmetric DELTA; the defaults are the example of the paper's section 9, mass centres at mid-link.

    Attributes:
        base, platform: radius of the axes of A and of E about the centre [m].
        upper: AB [m].
        lower: CD [m].
        rods: distance between the two rods of a leg [m].
        link_2, link_3, link_4, link_5, link_6: masses [kg]; link_4 is one rod.
        com_2: A to the mass centre of link 2, along AB [m]; half of AB by default.
        com_4: C to that of a rod, along CD [m]; half of CD by default.
        range: of the joints A [rad].
    """

    base: float = 0.2
    platform: float = 0.2
    upper: float = 0.5
    lower: float = 0.5
    rods: float = 0.1
    link_2: float = 1.225
    link_3: float = 0.4901
    link_4: float = 1.225
    link_5: float = 0.4901
    link_6: float = 3.687
    com_2: float | None = None
    com_4: float | None = None
    range: tuple[float, float] | None = (-pi / 4, 1.45)

    def assembled(self) -> tuple[float, float]:
        """(A, psi) [rad] of a pose with the platform on the axis: A, and the angle A + B of link 3.

        Raises:
            InputError: the rods cannot reach.
        """
        offset = self.base - self.platform
        for share in (0.6, 0.4, 0.8, 0.2, 0.95, 0.05):
            # the rod leans inwards by psi: base + AB cos A - CD sin psi = platform
            reach = share * self.lower
            if abs(reach - offset) < self.upper:
                return acos((reach - offset) / self.upper), asin(share)
        raise InputError(
            Fault(
                ("lower",),
                f"rods of {self.lower:g} m do not reach from links of {self.upper:g} m to the platform, "
                f"{offset:+g} m inwards",
            )
        )

    def mechanism(self, name: str = "delta robot") -> Mechanism:
        """The robot without springs. Joints `A 1`, `A 2` and `A 3` come first: they are the actuators.

        Raises:
            InputError: the rods cannot reach, or a value is out of range.
        """
        a, psi = self.assembled()
        shoulders = [joint for i in LEGS for joint in self._shoulder(i)]
        rest = [joint for i in LEGS for joint in self._leg(i)]
        guess = {f"A {i}": a for i in LEGS} | {f"B {i}": psi - a for i in LEGS} | {"E 1": -psi}
        return Mechanism(
            name,
            bodies=(
                *(body for i in LEGS for body in self._bodies(i)),
                Body("platform joint"),
                Body("platform", self.link_6),
            ),
            joints=(*shoulders, *rest),
            loops=tuple(loop for i in LEGS for loop in self._loops(i)),
            assembly=tuple(guess.items()),
        )

    def _bodies(self, i: int) -> Iterator[Body]:
        com_2 = self.upper / 2 if self.com_2 is None else self.com_2
        com_4 = self.lower / 2 if self.com_4 is None else self.com_4
        yield Body(f"link 2.{i}", self.link_2, (com_2, 0.0, 0.0))
        yield Body(f"link 3.{i}", self.link_3)
        yield Body(f"rod 4.{i}", self.link_4, (0.0, 0.0, -com_4))
        yield Body(f"rod 4'.{i}", self.link_4, (0.0, 0.0, -com_4))
        yield Body(f"link 5.{i}", self.link_5, (0.0, -self.rods / 2, 0.0))

    def _shoulder(self, i: int) -> Iterator[Joint]:
        turn = _azimuth(i)
        A = (self.base * cos(turn), self.base * sin(turn), 0.0)
        yield Joint(f"A {i}", "revolute", "world", f"link 2.{i}", A, (0.0, 0.0, turn), Y, self.range)

    def _leg(self, i: int) -> Iterator[Joint]:
        half = self.rods / 2
        yield Joint(f"B {i}", "revolute", f"link 2.{i}", f"link 3.{i}", (self.upper, 0.0, 0.0), axis=Y)
        yield Joint(f"C {i}", "revolute", f"link 3.{i}", f"rod 4.{i}", (0.0, half, 0.0), axis=X)
        yield Joint(f"C' {i}", "revolute", f"link 3.{i}", f"rod 4'.{i}", (0.0, -half, 0.0), axis=X)
        yield Joint(f"D {i}", "revolute", f"rod 4.{i}", f"link 5.{i}", (0.0, 0.0, -self.lower), axis=X)
        if i == LEGS[0]:  # at azimuth 0; a fixed joint puts the platform's frame into its centre
            yield Joint("E 1", "revolute", "link 5.1", "platform joint", (0.0, -half, 0.0), axis=Y)
            yield Joint("centre", "fixed", "platform joint", "platform", (-self.platform, 0.0, 0.0))

    def _loops(self, i: int) -> Iterator[Loop]:
        yield Loop(f"rod 4'.{i}", (0.0, 0.0, -self.lower), f"link 5.{i}", (0.0, -self.rods, 0.0), X, X)
        if i != LEGS[0]:
            turn = _azimuth(i)
            E = (self.platform * cos(turn), self.platform * sin(turn), 0.0)
            tangent = (-sin(turn), cos(turn), 0.0)
            yield Loop(f"link 5.{i}", (0.0, -self.rods / 2, 0.0), "platform", E, Y, tangent)


def _azimuth(i: int) -> float:
    return 2 * pi * (i - 1) / len(LEGS)

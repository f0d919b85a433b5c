"""A roll-pitch shoulder: where it is in a mechanism, and what gravity does to it.

The roll axis a_1 is horizontal on a body that stays upright, the pitch axis a_2 crosses it at right angles in O. In
terms of phi and psi, roll and pitch counted from where the link's moment is straight down, the energy of gravity is

    U = -g |sigma_2| cos(phi) cos(psi) - g |sigma_1| cos(phi - phi_1)

where sigma_2 [kg m] is the moment of the pitch link across its axis, and sigma_1 that of all that only rolls: the roll
link itself, and what of the pitch link's moment lies along the pitch axis.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import atan2, pi

import numpy as np

from ...kinematics import Tree
from ...model.arrays import Array, frozen
from ...model.mechanism import Mechanism
from .moments import MOMENT_ROUNDING, Segment, moments, segments, slide_faults, upwards

RIGHT = 1e-9  # how nearly axes have to be perpendicular, and (relative to the sizes) intersect


@frozen
class Shoulder:
    """A roll-pitch shoulder; vectors of a link are along the axes of the body that stands for it.

    Attributes:
        roll, pitch: the two links.
        roll_moment, pitch_moment: sigma_1 and sigma_2 (3,), each across its joint's axis [kg m].
        centre: O in the frame of the pitch link [m].
        up: (3,) up in the frame of the body that the roll joint hangs on.
        phases: (phi_0, psi_0), the roll and pitch at which phi and psi are zero [rad].
        g: [m/s^2].
    """

    roll: Segment
    pitch: Segment
    roll_moment: Array
    pitch_moment: Array
    centre: Array
    up: Array
    phases: tuple[float, float]
    g: float

    @property
    def weight(self) -> float:
        """m g l of the pitch link [N m]."""
        return self.g * float(np.linalg.norm(self.pitch_moment))

    @property
    def roll_weight(self) -> float:
        """The same of what only rolls."""
        return self.g * float(np.linalg.norm(self.roll_moment))

    @property
    def coordinates(self) -> tuple[str, str]:
        """The names of the roll and the pitch joint."""
        assert self.roll.joint is not None
        assert self.pitch.joint is not None
        return self.roll.joint.name, self.pitch.joint.name

    def hemisphere(self) -> dict[str, tuple[float, float]]:
        """Ranges of the two joints [rad] that keep the moment on the side that the roll axis points to."""
        start = self.phases[1]  # the moment's component along a_1 is |sigma_2| sin(psi)
        start -= 2 * pi * round((start + pi / 2) / (2 * pi))
        roll, pitch = self.coordinates
        return {roll: (-pi, pi), pitch: (start, start + pi)}


def find(mechanism: Mechanism) -> tuple[Shoulder | None, list[str]]:
    """The shoulder of a mechanism without springs, or None and the reasons why there is none.

    Raises:
        UnsupportedError: it has loops.
    """
    links = segments(mechanism)
    found = moments(links)
    unit = sum(moment.size for moment in found)
    working = [i for i, link in enumerate(links) if not link.upright and link.works(found[i].vector, unit)]
    if not working:
        return None, ["gravity does no work on any link: nothing to balance"]
    i = next((i for i in working if not links[links[i].parent].upright), None)
    if i is None:
        names = ", ".join(f"'{links[i].name}'" for i in working)
        return None, [f"{names}: turned by one joint only; a roll-pitch shoulder is two joints, one on the other"]
    r = links[i].parent
    roll, pitch = links[r], links[i]
    reasons = [*slide_faults(mechanism, links), *_joint_faults(mechanism, links, roll, pitch)]
    if reasons:
        return None, reasons
    tree = Tree.of(mechanism)
    home = tree.poses(np.zeros((1, tree.n))).R[0]
    R_1, R_2 = home[tree.index[roll.name]], home[tree.index[pitch.name]]
    R_12, up = R_1.T @ R_2, upwards(mechanism)
    a_1, a_2 = roll.axis, R_12 @ pitch.axis  # in the frame of the roll link at roll = pitch = 0
    a_3 = np.cross(a_1, a_2)
    reasons = list(_axis_faults(roll, pitch, a_1, a_2))
    others = ", ".join(f"'{links[j].name}'" for j in working if j not in (r, i))
    if others:
        reasons.append(
            f"gravity also does work on {others}: the mass centre of what turns with '{pitch.name}' must be fixed in "
            "it; fixed joints or counterweights would do"
        )
    if reasons:
        return None, reasons
    along = pitch.axis * (pitch.axis @ found[i].vector)
    across = found[i].vector - along
    if np.linalg.norm(across) <= MOMENT_ROUNDING * unit:
        return None, [f"gravity does no work on '{pitch.name}' when it pitches: a single spring on the roll joint does"]
    rolls = found[r].vector + R_12 @ along
    rolls = rolls - a_1 * (a_1 @ rolls)
    down, u = -R_1.T @ up, R_12 @ across
    return Shoulder(
        roll=roll,
        pitch=pitch,
        roll_moment=rolls if np.linalg.norm(rolls) > MOMENT_ROUNDING * unit else np.zeros(3),
        pitch_moment=across,
        centre=pitch.origin - (pitch.tip @ a_2) * pitch.axis,
        up=home[tree.index[roll.joint.parent]].T @ up if roll.joint else up,
        phases=(-atan2(down @ a_2, down @ a_3), -atan2(u @ a_1, u @ a_3)),
        g=float(np.linalg.norm(mechanism.gravity)),
    ), []


def _joint_faults(m: Mechanism, links: Sequence[Segment], roll: Segment, pitch: Segment) -> Iterator[str]:
    names = set()
    for link in (roll, pitch):
        if link.joint is not None:
            names.add(link.joint.name)
            if link.joint.type != "revolute":
                yield f"joint '{link.joint.name}' is {link.joint.type}: a roll-pitch shoulder has two revolute joints"
    for coupling in m.couplings:
        if coupling.joint in names:
            yield f"joint '{coupling.joint}' is not free but follows others"
    if not links[roll.parent].upright:
        yield (
            f"'{roll.name}', which carries '{pitch.name}', does not itself hang on a body that stays upright: "
            "only two joints may turn the link out of the vertical"
        )


def _axis_faults(roll: Segment, pitch: Segment, a_1: Array, a_2: Array) -> Iterator[str]:
    assert roll.joint is not None
    assert pitch.joint is not None
    tilt = float(np.abs(roll.ups @ roll.axis).max())
    if tilt > RIGHT:
        yield (
            f"the axis of '{roll.joint.name}' is {_degrees(tilt)} off the horizontal: the first axis of a bevel "
            "shoulder must be perpendicular to gravity"
        )
    skew = abs(float(a_1 @ a_2))
    if skew > RIGHT:
        yield (
            f"the axes of '{roll.joint.name}' and '{pitch.joint.name}' are {_degrees(skew)} off a right angle: "
            "they must be perpendicular"
        )
    else:
        gap = abs(float(pitch.tip @ np.cross(a_1, a_2)))
        if gap > RIGHT * max(1.0, float(np.linalg.norm(pitch.tip))):
            yield (
                f"the axes of '{roll.joint.name}' and '{pitch.joint.name}' pass each other at {1e3 * gap:.4g} mm: "
                "bevel gears need axes that intersect"
            )


def _degrees(sine: float) -> str:
    return f"{np.degrees(np.arcsin(min(1.0, sine))):.4g} deg"

"""The method `bevel`: two springs from the disks of a bevel differential to a link on a roll-pitch shoulder.

C. Cho, W. Lee, J. Lee and S. Kang, "A 2-dof gravity compensator with bevel gears", J. Mechanical Science and Technology
26 (2012). A fixed bevel gear turns two others, one on either side of the link; a disk on each carries one end of a
spring, whose energy is then a cosine of roll plus pitch, or of roll minus pitch. The sum of the two is gravity's.

Beyond the paper: any masses and phases. What only rolls, the roll link's own weight among it, gets the one spring of
Eq. (7) to the body below. And gear ratios N other than 1: a spring between a disk and the link only ever gives terms in
N roll +- pitch, wherever its ends are, and gravity only roll +- pitch, so that N = 1 is necessary for exact balance.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import atan2, cos, pi, sin

import numpy as np

from ...balance import payload_residual
from ...kinematics import Tree
from ...kinematics.sampling import bounds
from ...model.arrays import Array, vec3
from ...model.elements import Spring
from ...model.errors import Fault, InfeasibleError, InputError
from ...model.mechanism import Body, Coupling, Joint, Mechanism
from ...model.names import Names
from ...model.payload import Payload
from ...model.units import Amount
from ..arms.shoulder import Shoulder, find
from ..design import Design
from ..given import Given, number, numbers, spring_sizes
from ..margin import torque_margin
from ..method import Method
from ..mounts import Mounts
from ..options import MethodOptions, option, takes
from .differential import ARRANGEMENTS, SIDES, differential

NODES = 64  # of the quadrature over each joint's range
WORKSPACES = ("file", "hemisphere")
ROLL = "roll"  # the third spring, where there is one


@dataclass(frozen=True, kw_only=True)
class BevelOptions(MethodOptions):
    """What the method bevel can be asked for.

    Attributes:
        b, h, stiffness: of the spring on each side: from O to its end on the link and to that on the disk [m], and
            k [N/m]. At most two, the third follows from k b h = m g l / 2 on either side; all three where they fit. By
            default both lengths are half the link's size. "roll" is the spring of what only rolls.
        arrangement: where the fixed gear is on the roll axis: "near", where the axis points away from, or "far".
        gear_ratio: teeth of the fixed gear over those of a disk's gear.
        disk_mass: of each disk with its gear [kg], centred on the pitch axis.
        spacing: from O to either disk along the pitch axis [m]; by default a quarter of the link's size.
        workspace: "file" leaves the joints' ranges; "hemisphere" sets them to the half of the sphere that the roll
            axis points to.
        payload: one mass [kg] to balance besides the file's; or the smallest and largest of a range, and the balanced
            one is the middle: the fixed design with the least peak residual over the range.
        payload_at: where it is in the link's frame [m]; by default at its mass centre.
        friction: torque of the roll and pitch joint, by their names [N m].
    """

    b: Given = option(None, "length", "from O to a spring's end on the link; BODY is left, right or roll", each=True)
    h: Given = option(None, "length", "from O to its end on the disk; two of b, h and k at most", each=True)
    stiffness: Given = option(None, "stiffness", "k of a spring: k b h = m g l / 2 on either side", each=True)
    arrangement: str = option(
        "near", "text", "the side of the fixed gear on the roll axis (default near)", ARRANGEMENTS
    )
    gear_ratio: Amount = option(1.0, "number", "teeth of the fixed gear over a disk's (default 1; others approximate)")
    disk_mass: Given = option(0.0, "mass", "of a disk with its gear (default 0); BODY is left or right", each=True)
    spacing: Amount | None = option(None, "length", "from O to either disk (default a quarter of the link's size)")
    workspace: str = option("file", "text", "joint ranges (default file)", WORKSPACES)
    payload: Sequence[Amount] | None = option(None, "mass", "one mass, or a range LOW,HIGH", many=True)
    payload_at: Sequence[Amount] | None = option(
        None, "length", "x,y,z in the link's frame (default its com)", many=True
    )
    friction: Given = option(None, "torque", "of the joints, for the margin; BODY is a joint's name", each=True)


@takes(BevelOptions)
def design(mechanism: Mechanism, options: BevelOptions) -> Design:
    """Disks on both sides of the pitch link, geared to roll and pitch, and a spring on each.

    Raises:
        InputError: a bad value.
        InfeasibleError: springs do not help at this gear ratio.
    """
    arrangement, workspace, payload = options.arrangement, options.workspace, options.payload
    ratio = number("gear_ratio", options.gear_ratio, positive=True)
    for name, value, choices in (
        ("arrangement", arrangement, ARRANGEMENTS),
        ("workspace", workspace, WORKSPACES),
    ):
        if value not in choices:
            raise InputError(Fault((name,), f"unknown value '{value}'", choices))
    bare = mechanism.with_springs(())
    if workspace == "hemisphere":
        bare = _within(bare, _shoulder(bare).hemisphere())
    first = _shoulder(bare)
    size = Mounts.of(bare).default_radius(first.pitch.name)
    width = size / 2 if options.spacing is None else number("spacing", options.spacing, positive=True)
    masses = dict.fromkeys(SIDES, 0.0) | numbers("disk_mass", options.disk_mass, SIDES, positive=False)
    J = differential(arrangement, ratio)
    geared, disks = _with_disks(bare, first, J, masses, width)
    place = _centre(first) if options.payload_at is None else options.payload_at
    carried = Payload.at(geared, (0.0,) if payload is None else payload, first.pitch.name, place)
    loaded = carried.on(geared, carried.middle)
    s = _shoulder(loaded)

    cosines = _cosines(loaded, s, J)
    strength = {side: float(np.hypot(*pair)) for side, pair in zip(SIDES, cosines, strict=True)}
    if min(strength.values()) <= 1e-6 * s.weight:
        raise InfeasibleError(
            f"with a gear ratio of {ratio:g} no spring helps over these joint ranges: its torque goes with "
            f"{ratio:g} roll +- pitch, gravity's with roll +- pitch"
        )
    if s.roll_weight:
        strength[ROLL] = s.roll_weight  # (7)
    sizes = spring_sizes(strength, dict.fromkeys(strength, size), options.stiffness, b=options.b, h=options.h)
    springs = [
        _disk_spring(s, disk, side, atan2(d, c), width, sizes[side])
        for side, disk, (c, d) in zip(SIDES, disks, cosines, strict=True)
    ]
    if ROLL in sizes:
        springs.append(_roll_spring(s, sizes[ROLL]))
    made = loaded.with_springs(springs)

    free = {
        "b": {side: value for side, (_, value, _) in sizes.items()},
        "h": {side: value for side, (_, _, value) in sizes.items()},
        "stiffness": {side: value for side, (value, _, _) in sizes.items()},
        "arrangement": arrangement,
        "gear_ratio": ratio,
        "disk_mass": masses,
        "spacing": width,
        "workspace": workspace,
    }
    if payload is not None:
        free |= {"payload": carried.span, "payload_at": carried.place.tolist()}
        free["payload_rule"] = _payload_rule(geared, carried, s, free["b"], free["h"])
        if carried.high > carried.low:
            free["payload_residual"] = payload_residual(carried, geared, made.springs)
    if ratio != 1:
        free["approximate"] = (
            f"springs give terms in {ratio:g} roll +- pitch, gravity has roll +- pitch: exact with a gear ratio of 1 "
            "only; these leave the least mean square torque over the joint ranges"
        )
    found = Design.of(made, "bevel", free)
    if options.friction is None:
        return found
    held = numbers("friction", options.friction, s.coordinates, positive=False)
    free |= {"friction": held} | torque_margin(found.balance, held)
    return replace(found, free_parameters=free).with_provenance()


def applies(mechanism: Mechanism) -> list[str]:
    """Why the method does not apply; empty when it does."""
    if mechanism.loops:
        return ["it has loops: a bevel shoulder is two joints of a tree"]
    if not any(mechanism.gravity):
        return ["there is no gravity"]
    found, reasons = find(mechanism.with_springs(()))
    if found is None:
        return reasons
    return [
        f"joint '{coupling.joint}' is geared to the shoulder already: give it without its gears"
        for coupling in mechanism.couplings
        if {name for name, _ in coupling.terms} & {*found.coordinates}
    ]


def _shoulder(mechanism: Mechanism) -> Shoulder:
    found, reasons = find(mechanism)
    if found is None:
        raise InputError(Fault(("payload",), f"leaves no shoulder to balance: {'; '.join(reasons)}"))
    return found


def _centre(shoulder: Shoulder) -> list[float]:
    """(3,) [m] the mass centre of the pitch link, in its frame."""
    link = shoulder.pitch
    own = sum(m for m, _ in link.lumps)
    return (link.origin + (sum((m * p for m, p in link.lumps), np.zeros(3)) / own if own else 0.0)).tolist()


def _within(mechanism: Mechanism, ranges: dict[str, tuple[float, float]]) -> Mechanism:
    joints = tuple(replace(joint, range=ranges.get(joint.name, joint.range)) for joint in mechanism.joints)
    return replace(mechanism, joints=joints)


def _with_disks(
    m: Mechanism, s: Shoulder, J: Array, masses: dict[str, float], width: float
) -> tuple[Mechanism, list[str]]:
    """The mechanism with the two disks on the pitch link, coupled to roll and pitch by (11), and their names."""
    bodies, joints, couplings, disks = list(m.bodies), list(m.joints), list(m.couplings), []
    taken, held = Names(m.body_names), Names(joint.name for joint in m.joints)
    for side, sign, row in zip(SIDES, (1, -1), J.tolist(), strict=True):
        disk, joint = taken.new(f"{side} disk"), held.new(f"{side} disk")
        bodies.append(Body(disk, masses[side]))
        place = s.centre + sign * width * s.pitch.axis
        joints.append(Joint(joint, "revolute", s.pitch.name, disk, vec3(place), axis=vec3(s.pitch.axis)))
        couplings.append(Coupling(joint, tuple(zip(s.coordinates, row, strict=True))))
        disks.append(disk)
    return replace(m, bodies=tuple(bodies), joints=tuple(joints), couplings=tuple(couplings)), disks


def _cosines(m: Mechanism, s: Shoulder, J: Array) -> Array:
    """(2, 2) [N m] c and d of each side's energy c cos(x) + d sin(x), x = -2J theta: what balances gravity.

    With a gear ratio of 1 that is (18); with others it is the least squares of the torque over the joint ranges, the
    ends of the springs left free to turn about the pitch axis.
    """
    x_0 = -J @ np.array(s.phases)
    if abs(J[0, 0]) == 1:
        return s.weight / 2 * np.stack([np.cos(x_0), np.sin(x_0)], axis=1)
    tree = Tree.of(m)
    columns = [tree.coordinates.index(name) for name in s.coordinates]
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    low, high = (end[columns, None] for end in bounds(tree))
    roll, pitch = (low + high) / 2 + (high - low) / 2 * nodes
    q = np.stack(np.meshgrid(roll, pitch, indexing="ij"), axis=-1).reshape(-1, 2)
    root = np.sqrt(np.outer(weights, weights)).reshape(-1, 1, 1)
    x = -q @ J.T
    slopes = np.stack([-np.sin(x), np.cos(x)], axis=-1)  # of cos(x) and sin(x)
    torque = np.einsum("nsf,sj->njsf", slopes, -J).reshape(len(q), 2, 4)
    phi, psi = (q - np.array(s.phases)).T
    gravity = s.weight * np.stack([np.sin(phi) * np.cos(psi), np.cos(phi) * np.sin(psi)], axis=1)
    A, rhs = (root * torque).reshape(-1, 4), (root[:, :, 0] * gravity).reshape(-1)
    return np.linalg.lstsq(A, -rhs, rcond=None)[0].reshape(2, 2)


def _disk_spring(
    s: Shoulder, disk: str, side: str, phase: float, width: float, size: tuple[float, float, float]
) -> Spring:
    """From A_i on a disk to B_i on the link, (12): its energy varies as k b h cos(x - phase)."""
    k, b, h = size
    u = s.pitch_moment / np.linalg.norm(s.pitch_moment)
    A = h * (cos(pi + phase) * u + sin(pi + phase) * np.cross(s.pitch.axis, u))
    B = s.centre + (1 if side == SIDES[0] else -1) * width * s.pitch.axis + b * u
    return Spring(f"{side} spring", disk, vec3(A), s.pitch.name, vec3(B), k)


def _roll_spring(s: Shoulder, size: tuple[float, float, float]) -> Spring:
    """From above the roll axis to the roll link, as in Fig. 2."""
    k, b, h = size
    assert s.roll.joint is not None
    A = np.array(s.roll.joint.xyz) + h * s.up
    B = s.roll.origin + b * s.roll_moment / np.linalg.norm(s.roll_moment)
    return Spring("roll spring", s.roll.joint.parent, vec3(A), s.roll.name, vec3(B), k)


def _payload_rule(
    geared: Mechanism, carried: Payload, s: Shoulder, b: Mapping[str, float], h: Mapping[str, float]
) -> dict[str, dict[str, float]]:
    """What to move for a payload, k unchanged: either b or h, from k b h = m g l / 2, and how far to turn B about O."""
    u = s.pitch_moment / np.linalg.norm(s.pitch_moment)
    rule = {}
    for mass in sorted({0.0, carried.low, carried.high}):
        there = _shoulder(carried.on(geared, mass))
        share, moment = there.weight / s.weight, there.pitch_moment
        rule[f"{mass:g} kg"] = {
            **{f"b.{side} [m]": b[side] * share for side in SIDES},
            **{f"or h.{side} [m]": h[side] * share for side in SIDES},
            "turn [rad]": atan2(float(s.pitch.axis @ np.cross(u, moment)), float(u @ moment)),
        }
    return rule


METHOD = Method(
    "bevel",
    "two springs from the disks of a bevel differential to the link of a roll-pitch shoulder: exact at gear ratio 1",
    "Cho, Lee, Lee and Kang (2012), Eqs. (7), (11)-(18), (23)",
    applies,
    design,
    BevelOptions,
)

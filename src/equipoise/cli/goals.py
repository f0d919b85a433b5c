"""What `design` is asked to minimise: the options, and the goal that they make of the file's own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

import typer

from ..model import slips
from ..model.errors import Fault, InputError
from ..model.goal import SHARES, Goal, Tool
from ..model.units import number, quantity, to_si
from . import terminal

if TYPE_CHECKING:
    from ..model.mechanism import Mechanism

PAYLOAD = "payload"  # the name of what the command line hangs on a body

Payload = Annotated[
    str | None, typer.Option(metavar="MASS|LOW,HIGH", help="what is carried: springs for the whole range")
]
On = Annotated[str | None, typer.Option(metavar="BODY", help="with --payload: the body that carries it")]
At = Annotated[str, typer.Option(metavar="X,Y,Z", help="with --payload: where, in that body's frame")]
Tilt = Annotated[str | None, typer.Option(metavar="ANGLE", help="the base leans by up to this, in any direction")]
ShareOf = Annotated[str | None, typer.Option(metavar="effort", help="torque as a share of what each motor can do")]
Motion = Annotated[
    str | None,
    typer.Option(
        metavar="FILE.csv",
        help="the motion that counts, inertia too: a column 'time' and one for each coordinate that moves, such as "
        "'elbow [deg]'",
    ),
]
Heat = Annotated[bool, typer.Option("--heat", help="the heat in the motors, by torque_constant and resistance")]
Weights = Annotated[
    list[str] | None,
    typer.Option("--joint-weight", metavar="JOINT=FACTOR", help="a joint's torque counts so much; may be repeated"),
]


def asked(
    mechanism: Mechanism,
    payload: str | None,
    payload_on: str | None,
    payload_at: str,
    tilt: str | None,
    share_of: str | None,
    weights: Sequence[str],
    motion: str | None,
    heat: bool,
) -> Goal | None:
    """The file's goal with what the options say instead; None where they say nothing.

    Raises:
        InputError: an option that is no such quantity, or a name that the mechanism has not.
    """
    goal = mechanism.goal
    loads = goal.loads
    if payload is not None:
        loads = replace(loads, tools=(_tool(mechanism, payload, payload_on, payload_at),))
        _say_replaced(mechanism)
    elif payload_on is not None:
        raise InputError(Fault(("--payload-on",), "needs --payload, the masses"))
    if tilt is not None:
        loads = replace(loads, tilt=quantity(tilt, "angle", "--tilt"))
    count = goal.count
    if share_of is not None:
        if share_of not in SHARES:
            raise InputError(Fault(("--share-of",), f"unknown share '{share_of}'", SHARES))
        count = replace(count, share_of=share_of, heat=False)
    if heat:
        if share_of is not None:
            raise InputError(Fault(("--heat",), "is instead of --share-of: give one of them"))
        count = replace(count, share_of=None, heat=True)
    if weights:
        count = replace(count, joints={**count.joints, **dict(map(_weight, weights))})
    poses = goal.poses
    if motion is not None:
        from ..io.motion_table import read_motion

        course = read_motion(motion, mechanism.coordinates)
        poses = replace(poses, motions=(course,), listed=None, box=None, samples=None)
    found = replace(goal, loads=loads, poses=poses, count=count)
    return None if found == goal else found


def _tool(mechanism: Mechanism, masses: str, body: str | None, place: str) -> Tool:
    if body is None:
        raise InputError(
            Fault(("--payload",), "needs --payload-on, the body that carries it", mechanism.body_names[1:])
        )
    bounds = [quantity(text, "mass", "--payload") for text in masses.split(",")]
    point = [quantity(text, "length", "--payload-at") for text in place.split(",")]
    if len(bounds) > 2 or len(point) != 3:
        raise InputError("--payload: expected MASS or LOW,HIGH such as 0,2kg, and --payload-at X,Y,Z such as 0,0,50mm")
    x, y, z = point
    tool = Tool(PAYLOAD, body, (bounds[0], bounds[-1]), (x, y, z))
    from ..model.payload import Payload

    Payload.at(mechanism, bounds, body, point)  # its errors name what can be chosen
    present = [mass for mass in mechanism.masses if mass.name not in {PAYLOAD, *_carried(mechanism)}]
    terminal.slip(slips.twice(mechanism.with_masses(present), body, point))
    return tool


def _carried(mechanism: Mechanism) -> list[str]:
    return [tool.name for tool in mechanism.goal.loads.tools]


def _say_replaced(mechanism: Mechanism) -> None:
    """What the payload of the command line is instead of."""
    gone = dict.fromkeys([*_carried(mechanism), *(m.name for m in mechanism.masses if m.name == PAYLOAD)])
    if gone:
        terminal.say(f"note: --payload is instead of what the file carries: {', '.join(gone)}")


def _weight(text: str) -> tuple[str, float]:
    joint, equals, value = text.rpartition("=")
    if not equals:
        raise InputError(Fault(("--joint-weight",), f"expected JOINT=FACTOR, found '{text}'"))
    try:
        return joint.strip(), number("--joint-weight", to_si(value, "number"), positive=False)
    except InputError as error:
        message = f"'{text}': {error.faults[0].message}"
        raise InputError(Fault(("--joint-weight",), message)) from None

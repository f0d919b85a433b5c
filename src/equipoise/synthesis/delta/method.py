"""The method `delta` (Simionescu, Ciupitu and Ionita 2015): springs that balance a DELTA robot.

full: three zero-free-length springs per leg, exact (section 5). Links 2 and 2' of a parallelogram carry a frame (12)
that stays upright and lends each leg's link 3 the guide of `rocker`. Spring 10 balances the rods, link 5 and a third of
the platform, spring 11 the guide, and spring 7 link 2 with everything that hangs on it.

axis: one spring 7 per leg (section 6, Eqs. 14-15), best where the platform moves on the vertical axis, and exact there
if AB = CD and the axes of E are below those of A. optimum: the same springs, chosen over a stated workspace instead.
rocker: a two-axis rocker by itself, with the guide and springs 10 and 11 (section 4).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Literal, get_args

import numpy as np

from ...model.arrays import Array
from ...model.errors import Fault, InputError
from ...model.mechanism import Body, Joint, Mechanism
from ...model.rotation import to_rpy
from ...model.units import Amount
from ..arms.shoulder import find
from ..design import Design
from ..given import number
from ..method import Method
from ..options import MethodOptions, option, takes
from . import two_axis
from .legs import DeltaLeg, NotDelta, delta_legs
from .rocker import EQUATION_10, Guide, TwoAxisRocker, rocker_spring, snapped
from .workspace import OBJECTIVES, Box, Found, Goal, Objective, best_springs

Variant = Literal["full", "axis", "optimum", "rocker"]
VARIANTS: tuple[str, ...] = get_args(Variant)


@dataclass(frozen=True, kw_only=True)
class DeltaOptions(MethodOptions):
    """What the method delta can be asked for.

    Attributes:
        variant: full, axis, optimum or rocker; see the module. By default what suits the mechanism, full or rocker.
        AV, AW: where spring 7 is attached [m]: V on link 2, W above A.
        spring_7: its mass [kg], `share_7` of it at V.
        link_2p: mass of each link 2' [kg], its mass centre half way along; full only.
        BF, CS, FU, FT, FG8, link_8, link_9, frame, spring_10, spring_11, share_10, share_11, m3Q, equation_10: of full
            and rocker only; see `rocker.Guide`, whose defaults they have.
        heights: smallest and largest depth of the platform below the base [m], of axis and optimum; by default the
            middle half of what the rods allow.
        reach: of optimum: the platform within +-reach of the axis, both ways [m]; axis is judged there too.
        objective: of optimum: rms or peak torque over the workspace.
        samples, seed: random places of the platform.
    """

    variant: Variant | None = option(
        None, "text", "how many springs per leg, and for what (default full); rocker: two axes alone", VARIANTS
    )
    AV: Amount = option(0.25, "length", "A to where spring 7 is attached to link 2 (default 250 mm)")
    AW: Amount = option(0.3, "length", "A to where spring 7 is attached above it (default 300 mm)")
    spring_7: Amount = option(0.0, "mass", "of each spring 7 (default 0)")
    share_7: Amount = option(0.5, "share", "of the mass of spring 7 that counts at V (default 50 %)")
    link_2p: Amount = option(0.0, "mass", "full: of each link 2' (default 0)")
    BF: Amount | None = option(None, "length", "full: B to F, the guide's half height (default 100 mm)")
    CS: Amount | None = option(None, "length", "full: C to where spring 10 is attached to the rod (default 100 mm)")
    FU: Amount | None = option(None, "length", "full: F to where spring 11 is attached to link 8 (default 80 mm)")
    FT: Amount | None = option(None, "length", "full: F to where spring 11 is attached above it (default 120 mm)")
    FG8: Amount | None = option(None, "length", "full: F to the mass centre of link 8 (default 50 mm)")
    link_8: Amount | None = option(None, "mass", "full: of each link 8 (default 0)")
    link_9: Amount | None = option(None, "mass", "full: of each slider 9 (default 0)")
    frame: Amount | None = option(None, "mass", "full: of each frame 12 (default 0)")
    spring_10: Amount | None = option(None, "mass", "full: of each spring 10 (default 0)")
    spring_11: Amount | None = option(None, "mass", "full: of each spring 11 (default 0)")
    share_10: Amount | None = option(None, "share", "full: of the mass of spring 10 that counts at S (default 50 %)")
    share_11: Amount | None = option(None, "share", "full: of the mass of spring 11 that counts at U (default 50 %)")
    m3Q: Amount | None = option(None, "mass", "full: of link 3's bar that hangs at Q, on the slider (default 0)")
    equation_10: str | None = option(
        None, "text", "full: spring 11 exact, by Eq. (10) mended (exact if BF = 2 CS), or literally", EQUATION_10
    )
    heights: Sequence[Amount] | None = option(
        None, "length", "axis, optimum: LOW,HIGH of the platform below the base", many=True
    )
    reach: Amount = option(0.1, "length", "axis, optimum: half width of the workspace (default 100 mm)")
    objective: Objective = option(
        "peak", "text", "optimum: what is least over the workspace (default peak)", OBJECTIVES
    )
    samples: int = option(2000, "whole", "axis, optimum: random places of the platform (default 2000)")
    seed: int = option(0, "whole", "of the random places (default 0)")


@takes(DeltaOptions)
def design(mechanism: Mechanism, options: DeltaOptions) -> Design:
    """Springs for a DELTA robot with real loops, such as `DeltaRobot` makes, or for a two-axis rocker.

    Raises:
        InputError: a value out of range, or a workspace that the robot does not reach.
    """
    variant = options.variant
    if variant is None:
        variant = "rocker" if _is_rocker(mechanism) else "full"
    if variant not in VARIANTS:
        raise InputError(Fault(("variant",), f"there is no '{variant}'", VARIANTS))
    spring = {name: getattr(options, name) for name in ("AV", "AW", "spring_7", "share_7")}
    for name in ("AV", "AW"):
        if not spring[name] > 0:
            raise InputError(Fault((name,), f"must be more than 0 m, found {spring[name]:g}"))
    guide = {f.name: value for f in fields(Guide) if (value := getattr(options, f.name)) is not None}
    if variant == "rocker":
        shoulder, reasons = find(mechanism.with_springs(()))
        if shoulder is None:
            raise InputError(f"'{mechanism.name}' is no two-axis rocker: {'; '.join(reasons)}")
        parts = Guide(**guide)
        made = two_axis.balanced(mechanism, shoulder, parts)
        return Design.of(made, "delta", {"variant": variant, **_used(parts)})
    if variant == "full":
        parts = Guide(**guide)
        link_2p = number("link_2p", options.link_2p, positive=False)
        made = full(mechanism, parts, link_2p=link_2p, **spring)
        return Design.of(made, "delta", {"variant": variant, **spring, "link_2p": link_2p, **_used(parts)})
    for name in guide:
        raise InputError(Fault((name,), f"variant '{variant}' has no such option"))
    goal: Goal = "axis" if variant == "axis" else options.objective
    where: dict[str, Any] = {name: getattr(options, name) for name in ("heights", "reach", "samples", "seed")}
    box, found = one_per_leg(mechanism, goal, **spring, **where)
    area = {"heights": list(box.heights), "reach": box.reach, "objective": options.objective}
    return Design.of(found.mechanism, "delta", {"variant": variant, **spring, **area, **found.numbers})


def one_per_leg(
    mechanism: Mechanism,
    goal: Goal,
    *,
    AV: float = 0.25,
    AW: float = 0.3,
    spring_7: float = 0.0,
    share_7: float = 0.5,
    heights: Sequence[float] | None = None,
    reach: float = 0.1,
    samples: int = 2000,
    seed: int = 0,
) -> tuple[Box, Found]:
    """The springs of the variants axis and optimum, judged in the box of the platform's places only; see `design`."""
    legs, platform = _legs(mechanism)
    box = Box.of(mechanism, legs, platform, heights, reach)
    return box, best_springs(mechanism, legs, box, (AV, AW), (spring_7, share_7), goal, samples, seed)


def applies(mechanism: Mechanism) -> list[str]:
    """Why the method does not apply; empty when it does."""
    try:
        delta_legs(mechanism)
    except (NotDelta, InputError) as why:
        return [] if _is_rocker(mechanism) else [str(why)]
    return []


def _is_rocker(mechanism: Mechanism) -> bool:
    """Whether it is a two-axis rocker that is not geared already."""
    if mechanism.loops or mechanism.couplings or not any(mechanism.gravity):
        return False
    return find(mechanism.with_springs(()))[0] is not None


def _used(guide: Guide) -> dict[str, Any]:
    return {f.name: getattr(guide, f.name) for f in fields(guide)}


def full(
    mechanism: Mechanism, guide: Guide, AV: float, AW: float, spring_7: float, share_7: float, link_2p: float
) -> Mechanism:
    """The robot with its guides, parallelograms and nine springs."""
    legs, _ = _legs(mechanism)
    g = float(np.linalg.norm(mechanism.gravity))
    bodies, joints, couplings, springs = list(mechanism.bodies), list(mechanism.joints), list(mechanism.couplings), []
    for i, leg in enumerate(legs, 1):
        mark = f" {i}"
        two, three, four, _, _ = leg.links
        # link 2' stands above A and turns as link 2; the frame is carried by B and stays upright
        bodies += [Body(f"link 2'{mark}", link_2p, snapped(leg.B / 2)), Body(f"frame 12{mark}", guide.frame)]
        above = snapped(leg.A + (guide.BF + guide.FT) * leg.R_WL[:, 2])
        rpy = to_rpy(leg.R_WL)
        joints += [
            Joint(f"A'{mark}", "parallelogram", "world", f"link 2'{mark}", above, follows=two),
            Joint(f"B'{mark}", "parallelogram", two, f"frame 12{mark}", snapped(leg.B), rpy, follows="world"),
        ]
        angle = tuple(zip(leg.joints, leg.signs, strict=True))
        rocker = TwoAxisRocker(
            f"frame 12{mark}",
            (0.0, 0.0, 0.0),
            three,
            leg.R_3,
            angle,
            leg.zero_3,
            four,
            leg.C,
            leg.moment_4,
            leg.moment_3,
            leg.misprint,
        )
        bodies += rocker.bodies(guide, mark)
        joints += rocker.joints(guide, mark)
        couplings.append(rocker.coupling(mark))
        hanging = across(leg, (leg.load + guide.mass + link_2p / 2) * leg.B + leg.moment_2)
        up, name = leg.R_WL[:, 2], f"spring 7{mark}"
        springs.append(rocker_spring(name, hanging, two, up, leg.A, (AV, AW), g, (spring_7, share_7)))
        springs += rocker.springs(guide, mark, g)
    return replace(
        mechanism, bodies=tuple(bodies), joints=tuple(joints), couplings=tuple(couplings), springs=tuple(springs)
    )


def across(leg: DeltaLeg, moment: Array) -> Array:
    """A mass moment in the frame of link 2 without its part along the axis of A, which a turn does not lift."""
    y = leg.R_2[:, 1]
    return moment - y * (y @ moment)


def _legs(mechanism: Mechanism) -> tuple[tuple[DeltaLeg, ...], str]:
    try:
        return delta_legs(mechanism)
    except NotDelta as why:
        raise InputError(f"'{mechanism.name}' is no DELTA robot that the method covers: {why}") from why


METHOD = Method(
    "delta",
    "a DELTA robot: exact with three springs per leg and a guide, or one per leg, approximate; or a two-axis rocker",
    "Simionescu, Ciupitu and Ionita, Mechanism and Machine Theory 87 (2015), doi 10.1016/j.mechmachtheory.2014.11.008",
    applies,
    design,
    DeltaOptions,
)

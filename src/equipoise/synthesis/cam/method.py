"""The method `cam`: a non-circular pulley, or a cam under a roller, that balances a joint with an ordinary spring.

What loads the joint says which energy is wanted over its range (`wanted`). For any spring whose force goes with its
travel the profile follows in closed form (`envelope`). The spring, its preload and its fixed point are chosen so that
the profile can be cut and its cable stays on it (`search`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...model.elements import Element, JointElement
from ...model.elements.laws import Cam
from ...model.elements.laws.comparison import Comparison
from ...model.elements.laws.profile import Profile
from ...model.errors import Fault, InfeasibleError, InputError, nearest
from ...model.mechanism import Mechanism
from ...model.names import Names
from ...model.progress import silent
from ..design import Design
from ..given import number
from ..method import Method
from ..options import takes
from .make import made
from .options import CamOptions, between, limited, wishes_of
from .search import PARTS, Search, Wishes, usable
from .springs import KINDS, Offer
from .terms import terms
from .wanted import Wanted, of_law, wanted

BIAS = 1.25  # of half the largest torque: what two sides pull against each other with


@takes(CamOptions)
def design(mechanism: Mechanism, options: CamOptions) -> Design:
    """A cam on a joint, or two.

    Raises:
        InputError: a bad option, no such joint, or a range of a turn or more.
        InfeasibleError: no spring meets every demand; the message says which fail and what would help.
    """
    if options.spring is None:
        options = replace(options, spring="compression" if options.follower == "roller" else "extension")
    for name in ("follower", "sides", "fixed_to", "spring"):
        choices = CamOptions.parameters()[name].choices
        if getattr(options, name) not in choices:
            raise InputError(Fault((name,), f"unknown value '{getattr(options, name)}'", choices))
    if options.profile_of is not None:
        return _of_a_cam(mechanism, options.profile_of, options)
    joints, ends = terms(mechanism, options.joint), between(options)
    load = limited(mechanism if options.keep else mechanism.with_springs(()), joints, ends)
    whole = wanted(load, joints, ends)
    half = BIAS * whole.peak / 2
    parts = [whole] if options.sides == "one" else [whole.plus(half, 0.5), whole.plus(-half, 0.5)]
    names, cams = Names(spring.name for spring in load.springs), []
    for part, found in zip(parts, _each(parts, load, options), strict=True):
        name = names.new(f"{'-'.join(name for name, _ in joints)} cam")
        cams.append((JointElement(name, joints, replace(part.law, made=found.profile)), found))
    return _designed(load.with_springs((*load.springs, *(cam for cam, _ in cams))), cams, options)


def _of_a_cam(mechanism: Mechanism, name: str, options: CamOptions) -> Design:
    """A cam of the mechanism with its profile."""
    known = {spring.name: spring for spring in mechanism.springs if isinstance(spring.law, Cam)}
    if name not in known:
        raise InputError(Fault(("profile_of",), f"there is no cam {nearest(name, known)}", tuple(known)))
    cam = known[name]
    part = of_law(mechanism, cam.joints, cam.law, between(options))
    (found,) = _each([part], mechanism, options)
    done = cam.changed(law=replace(cam.law, made=found.profile))
    springs = [done if spring is cam else spring for spring in mechanism.springs]
    return _designed(mechanism.with_springs(springs), [(done, found)], options)


def _each(parts: list[Wanted], load: Mechanism, options: CamOptions) -> Iterator[Found]:
    progress = options.progress or silent
    wishes = wishes_of(load, parts[0].joints, options)
    for i, part in enumerate(parts):
        progress("looking for springs", i / len(parts))
        yield _best(part, wishes, options)


def _designed(mechanism: Mechanism, cams: list[tuple[Element, Found]], options: CamOptions) -> Design:
    (first, _), *_ = cams
    free = {"joint": dict(first.joints), "follower": options.follower, "sides": options.sides, "keep": options.keep}
    chosen = [{"cam": cam.name, **found.numbers} for cam, found in cams]
    return Design.of(mechanism, "cam", {**free, "cams": chosen})


@dataclass(frozen=True)
class Found:
    """A cam that meets every demand, and its numbers in SI units."""

    profile: Profile
    numbers: dict[str, Any]


def _best(part: Wanted, wishes: Wishes, options: CamOptions) -> Found:
    """The best cam.

    Raises:
        InfeasibleError: there is none; the message says why, and which other ways there are.
    """
    found = _found(part, wishes, _offers(part, wishes, options), options)
    if isinstance(found, Found):
        return found
    fails, helps = found.refusal()
    if options.follower == "cable" and options.stock is None:
        # a roller follows what is hollow too; two pulleys never see the torque change its sign
        other = replace(wishes, roller=float(options.roller), guide=True)
        if isinstance(_found(part, other, [Offer("compression")], options), Found):
            helps.append("follower=roller")
        half = BIAS * part.peak / 2
        if options.sides == "one" and isinstance(
            _found(part.plus(half, 0.5), wishes, [Offer(str(options.spring))], options), Found
        ):
            helps.append("sides=two")
    text = f"no spring meets every demand: {fails or 'the rest of each profile is in the way of its cable or roller'}"
    raise InfeasibleError(text + (f"; any one of these would help: {'; '.join(helps)}" if helps else ""))


def _found(part: Wanted, wishes: Wishes, offers: list[Offer], options: CamOptions) -> Found | Search:
    """The best cam, or the search that came nearest to one."""
    friction, diameter = float(options.friction), number("cable", options.cable, positive=False)
    closest: tuple[float, Search] | None = None
    # the cheapest of a list come first: as soon as some do, no other is asked
    for block in (offers[i : i + PARTS] for i in range(0, len(offers), PARTS)):
        search = Search(part, wishes, block, options.seed)
        best = search.best()
        for i in range(len(best.k)):
            if (profile := made(search, best, i, friction, diameter)) is not None:
                return Found(profile, _numbers(profile, part))
        if closest is None or search.miss < closest[0]:
            closest = search.miss, search
    assert closest is not None
    return closest[1]


def _offers(part: Wanted, wishes: Wishes, options: CamOptions) -> list[Offer]:
    if options.stock is None:
        return [Offer(str(options.spring))]
    order = sorted(options.stock, key=lambda one: (one.price, one.mass))
    offers = usable([Offer.of(one) for one in order if one.kind in KINDS], part, wishes)
    if not offers:
        work = float(part.energy(part.angles()).max())
        how = "pulls" if not wishes.guide and wishes.roller is None else "there"
        raise InfeasibleError(
            f"no spring of the list that {how} holds the {work:.4g} J that are needed".replace("that there", "there")
        )
    return offers


def _numbers(profile: Profile, part: Wanted) -> dict[str, Any]:
    run, law = Comparison.of(profile, part.law, part.low, part.high).used, profile.spring.law
    found = {
        "spring": law.kind,
        **({"part": profile.spring.part} if profile.spring.part else {}),
        "stiffness": abs(float(np.ptp(run.force) / np.ptp(run.length))),
        "least_force": float(run.force.min()),
        "largest_force": float(run.force.max()),
        "size": float(run.reach.max()),
        "least_radius": float(np.abs(run.radius).min()),
    }
    if profile.cable:
        return {**found, "fixed": list(profile.cable.point), "cable_length": profile.cable.length}
    return found


def applies(mechanism: Mechanism) -> list[str]:
    """Why the method does not apply; empty when it does."""
    if not any(joint.type == "revolute" for joint in mechanism.joints):
        return ["a cam turns with a revolute joint, and there is none"]
    return []


METHOD = Method(
    "cam",
    "a non-circular pulley or a cam on a joint: exact over its range with one ordinary spring",
    "derived in docs/cams.md: the profile is the envelope of the cable's lines",
    applies,
    design,
    CamOptions,
)

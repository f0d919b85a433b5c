"""What the method cam can be asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import atan2, hypot, inf, nan, pi

import numpy as np

from ...kinematics import Tree
from ...model.elements.laws.law import Terms
from ...model.elements.laws.profile import FIXED_TO
from ...model.elements.plane import Plane
from ...model.errors import Fault, InputError
from ...model.mechanism import Joint, Mechanism
from ...model.units import Amount, quantity
from ..given import number
from ..mounts import Mounts
from ..options import MethodOptions, option
from .search import Wishes
from .springs import KINDS, PUSHING, Part

FOLLOWERS = ("cable", "roller")
SIDES = ("one", "two")
GAS = 0.55  # least force of a gas spring, of its largest


@dataclass(frozen=True, kw_only=True)
class CamOptions(MethodOptions):
    """What the method cam can be asked for.

    Attributes:
        joint: the joint, or a sum such as "shoulder+elbow" or "hip-2*knee"; the only one where there is only one.
        profile_of: the name of a cam of the file: it gets its profile, and nothing else changes.
        keep: the file's own springs stay and count as a load; else they are replaced.
        follower: a cable on a pulley, or a roller on a cam.
        sides: "two" are two pulleys with a spring each that pull against each other.
        fixed_to: the body that the profile turns with, the joint's child or its parent.
        spring: a kind, by default an extension spring to a cable and a compression spring on a roller.
        stiffness [N/m], force: the least [N] it is used with, where they are given.
        stock: springs of a list to take from, see `hardware.stock.parts.read_catalogue`.
        preload: the least force is at least this share of the largest.
        size, least_radius, hub, fixed_within: see `Wishes` [m].
        fixed: the cable's fixed point x, y in the plane of the joint [m]; bearing: its direction, or
            the roller's [rad].
        guide: whether the spring is behind a guide at the fixed point.
        roller: its radius; offset: of its line [m]; lean: of its pressure at most [rad].
        cable: diameter [m]; friction: share of the torque.
        range: the angles that count [rad], by default the joint's; they become its range where it has none or a wider
            one, as its cam ends there.
        seed: of the search.
    """

    joint: str | Mapping[str, float] | None = option(None, "text", "the joint, or a sum such as shoulder+elbow")
    profile_of: str | None = option(None, "text", "a cam of the file that gets its profile; all else stays")
    keep: bool = False
    follower: str = option("cable", "text", "what runs on the profile (default cable)", FOLLOWERS)
    sides: str = option("one", "text", "two: a second pulley and spring pull against the first", SIDES)
    fixed_to: str = option("child", "text", "the body that the profile turns with (default child)", FIXED_TO)
    spring: str | None = option(
        None, "text", "its kind, where there is no list (default extension, compression)", KINDS
    )
    stiffness: Amount | None = option(None, "stiffness", "of the spring (default: chosen)")
    force: Amount | None = option(None, "force", "the spring's least force (default: chosen)")
    stock: Sequence[Part] | None = None
    preload: Amount = option("5%", "share", "least force, as a share of the largest (default 5%)")
    size: Amount | None = option(None, "length", "from the axis to the profile at most (default half the link's size)")
    least_radius: Amount = option(0.004, "length", "least radius of curvature (default 4 mm)")
    hub: Amount | None = option(None, "length", "the axis is so far inside the profile (default: anywhere)")
    fixed_within: Amount | None = option(None, "length", "from the axis to the fixed point at most (default the reach)")
    fixed: Sequence[Amount] | None = option(None, "length", "x,y of the fixed point (default: chosen)", many=True)
    bearing: Amount | None = option(None, "angle", "direction of the fixed point, or of the roller (default: down)")
    guide: bool = option(False, "flag", "the spring is behind a guide at the fixed point (default no)")
    roller: Amount = option(0.008, "length", "radius of the roller (default 8 mm)")
    offset: Amount = option(0.0, "length", "of the roller's line from the axis (default 0)")
    lean: Amount = option(pi / 6, "angle", "of the roller's pressure at most (default 30 deg)")
    cable: Amount = option(0.0, "length", "diameter of the cable, for the drawing (default 0)")
    friction: Amount = option(0.0, "share", "of the torque, lost in the cable or roller: a margin (default 0)")
    range: Sequence[Amount] | None = option(
        None, "angle", "low,high: angles that count (default the joint's)", many=True
    )
    seed: int = option(0, "whole", "of the search (default 0)")


def between(options: CamOptions) -> tuple[float, float] | None:
    """The angles that are given [rad]."""
    if options.range is None:
        return None
    ends = [quantity(one, "angle", "range") for one in options.range]
    if len(ends) != 2 or not ends[0] < ends[1]:
        raise InputError(Fault(("range",), "expected two angles, the lower one first, such as -30deg,60deg"))
    return ends[0], ends[1]


def limited(mechanism: Mechanism, joints: Terms, ends: tuple[float, float] | None) -> Mechanism:
    """The mechanism whose joint ends where its cam does; a sum of joints stays as it is."""
    if ends is None or joints != ((joints[0][0], 1.0),):
        return mechanism
    low, high = ends

    def within(joint: Joint) -> Joint:
        lower, upper = joint.range or (-inf, inf)
        return replace(joint, range=(max(low, lower), min(high, upper)))

    found = (within(joint) if joint.name == joints[0][0] else joint for joint in mechanism.joints)
    return replace(mechanism, joints=tuple(found))


def wishes_of(load: Mechanism, joints: Terms, options: CamOptions) -> Wishes:
    """What is asked of the profile, with what follows from the mechanism where nothing is said."""
    tree, mounts = Tree.of(load), Mounts.of(load)
    plane = Plane.of(tree, joints[0][0])
    other = "parent" if options.fixed_to == "child" else "child"

    def length(name: str, default: float) -> float:
        given = getattr(options, name)
        return default if given is None else number(name, given, positive=True)

    at, bearing = nan, options.bearing
    if options.fixed is not None:
        point = [quantity(one, "length", "fixed") for one in options.fixed]
        if len(point) != 2 or not any(point):
            raise InputError(Fault(("fixed",), "expected x,y in the plane of the joint, and not its axis"))
        at, bearing = hypot(*point), atan2(point[1], point[0])
    if bearing is None:
        bearing = _away(load, tree, plane, other)
    roller = length("roller", 0.008) if options.follower == "roller" else None
    gas = options.spring == "gas" and options.stock is None
    return Wishes(
        turn=1.0 if options.fixed_to == "child" else -1.0,
        size=length("size", mounts.default_radius(plane.child)),
        least_radius=length("least_radius", 0.004),
        hub=None if options.hub is None else number("hub", options.hub, positive=False),
        fixed=length("fixed_within", max(mounts.reach, 0.0 if at != at else at)),
        bearing=quantity(bearing, "angle", "bearing"),
        preload=max(float(options.preload), GAS if gas else 0.0),
        at=at,
        stiffness=length("stiffness", nan),
        force=length("force", nan),
        guide=options.guide or options.spring in PUSHING,
        roller=roller,
        offset=quantity(options.offset, "length", "offset"),
        lean=number("lean", options.lean, positive=True),
    )


def _away(load: Mechanism, tree: Tree, plane: Plane, body: str) -> float:
    """Where a spring has room: below the joint on what stands, else along the link that it is on."""
    if body == "parent" and np.linalg.norm(plane.p0) > 1e-9 and plane.parent != "world":
        way = plane.direction("parent", -plane.p0)
    elif body == "parent":
        upright = tree.poses(tree.rest[None]).R[0, tree.index[plane.parent]]
        way = plane.direction("parent", upright.T @ np.array(load.gravity))
    else:
        way = plane.direction("child", next(b.com for b in load.bodies if b.name == plane.child))
    return round(atan2(way[1], way[0]), 12) if np.linalg.norm(way) > 1e-9 else 0.0

"""What looks like a slip in a mechanism that is valid: degrees for radians, millimetres for metres, a mass forgotten.

Each is said once, and nothing is changed: what looks wrong may be meant.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from math import dist, hypot, isclose, pi

from .elements import OnJoints, Spring
from .mechanism import WORLD, Mechanism

DEGREES = (2.01 * pi, 720.0)  # [rad] whole numbers between these are what angles in degrees look like
APART = 30.0  # how far the longest lengths are above all others when they are in another unit
FEW = 0.25  # of all lengths are that, at most
FAR = 10.0  # times its reach: nothing of a mechanism is that large
EARTH = (9.7, 9.9)  # [m/s^2] gravity on the ground
NAMES_SHOWN = 6  # names in one message; the others are counted


def slips(mechanism: Mechanism) -> list[str]:
    """One message for each kind of slip, with what has it."""
    found: dict[str, list[str]] = defaultdict(list)
    for what, message in (*_angles(mechanism), *_lengths(mechanism), *_masses(mechanism), *_ranges(mechanism)):
        found[message].append(what)
    messages = [f"{_listed(names)}: {message}" for message, names in found.items()]
    size = hypot(*mechanism.gravity)
    if not EARTH[0] <= size <= EARTH[1]:
        messages.append(f"gravity is {size:g} m/s^2" + ("" if size else ": nothing has weight, and nothing to balance"))
    return messages


def weightless(mechanism: Mechanism) -> bool:
    """Whether nothing that moves has a mass, though something moves."""
    moving = {body for group in _groups(mechanism).values() for body in group} - _fixed(mechanism)
    return bool(mechanism.coordinates) and not any(mass for body, mass in _loads(mechanism) if body in moving)


def far(mechanism: Mechanism, radius: float, what: str) -> list[str]:
    """A message when a radius [m] is far beyond what the mechanism reaches; `what` names it."""
    reach = sum(length for _, length in _measures(mechanism))
    if 0 < FAR * reach < radius:
        return [f"{what}: {radius:g} m is far beyond the mechanism, whose lengths add up to {reach:.3g} m"]
    return []


def twice(mechanism: Mechanism, body: str, point: Iterable[float]) -> list[str]:
    """A message when a payload at a point [m] of a body stands in the file already."""
    size = max((length for _, length in _measures(mechanism)), default=1.0)
    same = [m for m in mechanism.masses if m.body == body and dist(m.position, tuple(point)) < 1e-3 * size]
    return [f"mass '{m.name}' of the file, {m.mass:g} kg, is where the payload is: both count" for m in same]


def _listed(names: list[str]) -> str:
    return ", ".join(names[:NAMES_SHOWN]) + (
        f" and {len(names) - NAMES_SHOWN} more" if len(names) > NAMES_SHOWN else ""
    )


def _angles(m: Mechanism) -> Iterator[tuple[str, str]]:
    message = "the angles look like degrees: a bare number is in radians"
    for joint in m.joints:
        angles = [*joint.rpy, *((joint.range or ()) if joint.type == "revolute" else ())]
        if any(DEGREES[0] < abs(x) <= DEGREES[1] and x == round(x) for x in angles):
            yield f"joint '{joint.name}'", message


def _measures(m: Mechanism) -> Iterator[tuple[str, float]]:
    """Every length of the mechanism that is not zero [m]."""
    points = [
        *((f"joint '{j.name}'", j.xyz) for j in m.joints),
        *((f"body '{b.name}'", b.com) for b in m.bodies),
        *((f"mass '{x.name}'", x.position) for x in m.masses),
        *((f"spring '{s.name}'", p) for s in m.springs for _, (_, p) in s.places),
        *((f"the loop of '{x.body_a}' and '{x.body_b}'", p) for x in m.loops for p in (x.p_a, x.p_b)),
    ]
    lengths = [(what, hypot(*p)) for what, p in points]
    lengths += [(f"spring '{s.name}'", abs(s.free_length)) for s in m.springs if isinstance(s, Spring)]
    lengths += [(f"capsule '{c.name}'", c.radius) for c in m.capsules]
    lengths += [(f"joint '{j.name}'", max(map(abs, j.range))) for j in m.joints if j.range and j.type == "prismatic"]
    return ((what, length) for what, length in lengths if length)


def _lengths(m: Mechanism) -> Iterator[tuple[str, str]]:
    """Those above a gap in the upper part of all lengths."""
    found = sorted(_measures(m), key=lambda item: item[1])
    for i in range(max(1, int((1 - FEW) * len(found))), len(found)):
        if found[i][1] > APART * found[i - 1][1]:
            for what, length in found[i:]:
                yield what, f"its length of {length:g} m is out of scale with the others: a bare number is in metres"
            return


def _ranges(m: Mechanism) -> Iterator[tuple[str, str]]:
    for joint in m.joints:
        if joint.range is not None and isclose(*joint.range, rel_tol=1e-12):
            unit = "rad" if joint.type == "revolute" else "m"
            yield f"joint '{joint.name}'", f"its range is a single value, {joint.range[0]:g} {unit}: it does not move"


def _masses(m: Mechanism) -> Iterator[tuple[str, str]]:
    """Ends of chains that move without a mass, and that neither a spring nor a loop holds."""
    if weightless(m):
        yield "nothing that moves", "it has no mass, and there is nothing to balance"
        return
    masses: dict[str, float] = defaultdict(float)
    for body, mass in _loads(m):
        masses[body] += mass
    held = {body for x in m.loops for body in (x.body_a, x.body_b)} | {body for s in m.springs for body, _ in s.ends}
    twisted = {joint for s in m.springs if isinstance(s, OnJoints) for joint, _ in s.joints}
    held |= {j.child for j in m.joints if j.name in twisted} | {j.follows for j in m.joints if j.follows}
    moved = {j.parent for j in m.joints if j.type != "fixed"}
    for root, group in _groups(m).items():
        if root != WORLD and not moved & group and not held & group and not any(masses[body] for body in group):
            yield f"body '{root}'", "it moves at the end of a chain, but has no mass"


def _groups(m: Mechanism) -> dict[str, set[str]]:
    """Bodies that fixed joints hold together, by the one nearest to the world."""
    holder = {joint.child: joint for joint in m.joints}
    root_of = {WORLD: WORLD}
    groups: dict[str, set[str]] = defaultdict(set)
    for body in m.body_names:
        path = [body]
        while path[-1] not in root_of and holder[path[-1]].type == "fixed":
            path.append(holder[path[-1]].parent)
        root = root_of.get(path[-1], path[-1])
        root_of |= dict.fromkeys(path, root)
        groups[root].add(body)
    return groups


def _fixed(m: Mechanism) -> set[str]:
    return _groups(m)[WORLD]


def _loads(m: Mechanism) -> Iterator[tuple[str, float]]:
    """Every mass [kg], with the body that carries it."""
    yield from ((body.name, body.mass) for body in m.bodies)
    yield from ((mass.body, mass.mass) for mass in m.masses)
    yield from ((body, mass) for spring in m.springs for body, mass, _ in spring.lumps())

"""What makes a mechanism consistent. Every fault is found, not only the first."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import islice
from math import isfinite
from numbers import Integral
from typing import TYPE_CHECKING
from unicodedata import category

from .coordinate import Coordinate, Slide
from .errors import COUNTED, Fault, InputError, Path, at_least, finite, known, nearest, positive, shorten

if TYPE_CHECKING:
    from .mechanism import Mechanism

TURNS = "\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"  # of the direction of writing
MAX_SAMPLES = 1_000_000
FARTHEST = 1e9  # [rad or m]: a limit of a model file beyond it means none
MAX_NUMBERS = 30_000_000  # that are held at a time: about a quarter of a gigabyte
LARGEST_COUNTS = {
    "bodies": 300,
    "joints": 300,
    "couplings": 300,
    "loops": 100,
    "springs": 500,
    "masses": 500,
    "capsules": 500,
    "attachments": 500,
    "shapes": 500,
}
"""What a mechanism has at most: no robot comes near it, and the work grows with the cube of some."""


def faults(mechanism: Mechanism) -> list[Fault]:
    """Everything that is wrong with a mechanism, as faults whose paths follow the mechanism file."""
    too_many = list(_sizes(mechanism))
    if too_many:
        return too_many
    checks = (_numbers, _names, _references, _joints, _tree, _couplings, _springs, _loops, _branch, _attachments, _goal)
    return list(islice((fault for check in checks for fault in check(mechanism)), COUNTED))


def _sizes(m: Mechanism) -> Iterator[Fault]:
    for kind, most in LARGEST_COUNTS.items():
        if (count := len(getattr(m, kind))) > most:
            yield Fault((kind,), f"at most {most} are worked with, found {count:,}")


def whole_number(name: str, value: object, least: int, most: int | None = None) -> None:
    """Check an option that counts something.

    Raises:
        InputError: it is not a whole number from `least` to `most`.
    """
    limits = f"from {least} to {most:,}" if most is not None else f"of at least {least}"
    whole = int(value) if isinstance(value, Integral) and not isinstance(value, bool) else None
    if whole is None or whole < least or (most is not None and whole > most):
        raise InputError(Fault((name,), f"must be a whole number {limits}, found {value}"))


def _numbers(m: Mechanism) -> Iterator[Fault]:
    yield from finite(("gravity",), m.gravity)
    for i, body in enumerate(m.bodies):
        yield from finite(("bodies", i, "com"), body.com)
        yield from at_least(("bodies", i, "mass"), body.mass, 0, "kg")
        yield from finite(("bodies", i, "inertia"), body.inertia or ())
    for i, mass in enumerate(m.masses):
        yield from finite(("masses", i, "position"), mass.position)
        yield from at_least(("masses", i, "mass"), mass.mass, 0, "kg")
    for i, capsule in enumerate(m.capsules):
        for end in ("p_a", "p_b"):
            yield from finite(("capsules", i, end), getattr(capsule, end))
        yield from at_least(("capsules", i, "radius"), capsule.radius, 0, "m")
    for i, shape in enumerate(m.shapes):
        yield from (replace(fault, path=("shapes", i, *fault.path)) for fault in shape.faults())
    for i, joint in enumerate(m.joints):
        for name in ("xyz", "rpy", "axis"):
            yield from finite(("joints", i, name), getattr(joint, name))
    for i, coupling in enumerate(m.couplings):
        yield from finite(("couplings", i, "offset"), coupling.offset)
        for name, ratio in coupling.terms:
            yield from finite(("couplings", i, "terms", name), ratio)
    if not 1 <= m.workspace.samples <= MAX_SAMPLES:
        yield Fault(("workspace", "samples"), f"must be between 1 and {MAX_SAMPLES:,}, found {m.workspace.samples}")


def _names(m: Mechanism) -> Iterator[Fault]:
    sections = ("bodies", "joints", "springs", "masses", "capsules", "shapes")
    for kind, items in ((section, getattr(m, section)) for section in sections):
        seen: dict[str, int] = {}
        for i, item in enumerate(items):
            if not item.name:
                yield Fault((kind, i, "name"), "must not be empty")
            elif not printable(item.name):
                yield Fault((kind, i, "name"), f"has a character that cannot be printed: {item.name!a}")
            elif kind == "bodies" and item.name == "world":
                yield Fault((kind, i, "name"), "'world' is the fixed frame and cannot be a body")
            elif item.name in seen:
                yield Fault((kind, i, "name"), f"duplicate name '{item.name}', first used by {kind}[{seen[item.name]}]")
            seen.setdefault(item.name, i)
    if not printable(m.name):
        yield Fault(("name",), f"has a character that cannot be printed: {m.name!a}")
    # a spherical joint's coordinates are name.x, name.y, name.z: no other joint may carry such a name
    spherical = {name for j in m.joints if j.type == "spherical" for name in j.coordinates}
    for i, joint in enumerate(m.joints):
        if joint.name in spherical:
            yield Fault(("joints", i, "name"), f"'{joint.name}' is also a coordinate of a spherical joint")


def _goal(m: Mechanism) -> Iterator[Fault]:
    yield from m.goal.faults(m)


def printable(name: str) -> bool:
    """Whether a name has nothing that would reach terminals and pages: no control characters, line breaks or turns."""
    return not any(category(letter) in ("Cc", "Cs", "Zl", "Zp") or letter in TURNS for letter in name)


def _references(m: Mechanism) -> Iterator[Fault]:
    bodies = tuple(dict.fromkeys(("world", *(body.name for body in m.bodies))))

    for i, joint in enumerate(m.joints):
        for key in ("parent", "child", "follows"):
            yield from known(("joints", i, key), getattr(joint, key), "body", bodies)
    for i, loop in enumerate(m.loops):
        for key in ("body_a", "body_b"):
            yield from known(("loops", i, key), getattr(loop, key), "body", bodies)
    for i, mass in enumerate(m.masses):
        yield from known(("masses", i, "body"), mass.body, "body", bodies)
    for i, capsule in enumerate(m.capsules):
        yield from known(("capsules", i, "body"), capsule.body, "body", bodies)
    for i, shape in enumerate(m.shapes):
        yield from known(("shapes", i, "body"), shape.body, "body", bodies)


def _joints(m: Mechanism) -> Iterator[Fault]:
    types = ("fixed", "revolute", "prismatic", "spherical", "parallelogram")
    for i, joint in enumerate(m.joints):
        if joint.type not in types:
            yield Fault(("joints", i, "type"), f"no joint type {nearest(joint.type, types)}", types)
            continue
        if joint.type in ("revolute", "prismatic"):
            if not any(joint.axis):
                yield Fault(("joints", i, "axis"), "must not be zero")
        elif joint.range is not None:
            yield Fault(("joints", i, "range"), f"a {joint.type} joint has no range; only revolute and prismatic have")
        if joint.range is not None and not (
            all(isfinite(limit) for limit in joint.range) and joint.range[0] <= joint.range[1]
        ):
            found = ", ".join(f"{limit:g}" for limit in joint.range)
            yield Fault(("joints", i, "range"), f"must be two finite numbers, lower first, found [{found}]")
        kind = Slide if joint.type == "prismatic" else Coordinate
        for key, value, per in (("damping", joint.damping, f" s/{kind.unit}"), ("friction", joint.friction, "")):
            yield from at_least(("joints", i, key), value, 0, kind.load_unit + per)
            if value and joint.type in ("fixed", "parallelogram"):
                yield Fault(("joints", i, key), f"a {joint.type} joint has none: it has no coordinate of its own")
        for key, unit in (
            ("effort", kind.load_unit),
            ("torque_constant", f"{kind.load_unit}/A"),
            ("resistance", "ohm"),
        ):
            if (known_value := getattr(joint, key)) is None:
                continue
            yield from positive(("joints", i, key), known_value, unit)
            if joint.type in ("fixed", "parallelogram"):
                yield Fault(("joints", i, key), f"a {joint.type} joint has none: it has no coordinate of its own")
        if joint.type == "parallelogram" and joint.follows is None:
            yield Fault(("joints", i, "follows"), "missing: a parallelogram joint names the body it keeps parallel to")
        if joint.type != "parallelogram" and joint.follows is not None:
            yield Fault(("joints", i, "follows"), f"only a parallelogram joint has it, this one is {joint.type}")


def _tree(m: Mechanism) -> Iterator[Fault]:
    names = {body.name for body in m.bodies}
    parent_joint: dict[str, int] = {}
    for i, joint in enumerate(m.joints):
        if joint.child == "world":
            yield Fault(("joints", i, "child"), "'world' cannot be a child")
        elif joint.child in parent_joint:
            yield Fault(
                ("joints", i, "child"),
                f"body '{joint.child}' already hangs on joint '{m.joints[parent_joint[joint.child]].name}'; "
                "close a loop with an entry in 'loops'",
            )
        else:
            parent_joint[joint.child] = i
    for i, body in enumerate(m.bodies):
        if body.name not in parent_joint:
            yield Fault(("bodies", i, "name"), f"body '{body.name}' is not attached: no joint has it as child")
    placed = {"world"}
    waiting = {name: i for name, i in parent_joint.items() if name in names}
    while waiting:
        ready = [
            name
            for name, i in waiting.items()
            if m.joints[i].parent in placed and (m.joints[i].follows or "world") in placed
        ]
        if not ready:
            break
        placed.update(ready)
        for name in ready:
            del waiting[name]
    unknown = {joint.parent for joint in m.joints} | {joint.follows for joint in m.joints if joint.follows}
    if waiting and unknown <= names | {"world"} and names <= parent_joint.keys():
        i = min(waiting.values())
        yield Fault(("joints", i, "parent"), f"joints form a ring that never reaches the world: {_list(waiting)}")


def _couplings(m: Mechanism) -> Iterator[Fault]:
    single = [joint.name for joint in m.joints if joint.type in ("revolute", "prismatic")]
    dependent: dict[str, int] = {}
    for i, coupling in enumerate(m.couplings):
        for path, name in [(("joint",), coupling.joint), *((("terms", name), name) for name, _ in coupling.terms)]:
            if name not in single:
                yield Fault(
                    ("couplings", i, *path), f"no revolute or prismatic joint {nearest(name, single)}", shorten(single)
                )
        if coupling.joint in dependent:
            yield Fault(("couplings", i, "joint"), f"joint '{coupling.joint}' is already coupled")
        dependent.setdefault(coupling.joint, i)
    for name, i in dependent.items():
        names = [term for term, _ in m.couplings[i].terms]
        for twice in sorted({term for term in names if names.count(term) > 1}):
            yield Fault(("couplings", i, "terms", twice), f"joint '{twice}' is named twice")
        seen, frontier = set(), {name}
        while frontier:
            frontier = {t for f in frontier if f in dependent for t, _ in m.couplings[dependent[f]].terms} - seen
            seen |= frontier
        if name in seen:
            yield Fault(("couplings", i, "terms"), f"joint '{name}' depends on itself")


def _springs(m: Mechanism) -> Iterator[Fault]:
    for i, spring in enumerate(m.springs):
        for fault in spring.faults(m):
            yield replace(fault, path=("springs", i, *fault.path))


def _loops(m: Mechanism) -> Iterator[Fault]:
    for i, loop in enumerate(m.loops):
        axes = {"axis_a": loop.axis_a, "axis_b": loop.axis_b}
        for name, values in {"p_a": loop.p_a, "p_b": loop.p_b, **axes}.items():
            if not all(isfinite(value) for value in values or ()):
                yield Fault(("loops", i, name), "must be finite")
            elif name in axes and values is not None and not any(values):
                yield Fault(("loops", i, name), "must not be zero")
        for name, other in (("axis_a", "axis_b"), ("axis_b", "axis_a")):
            if axes[name] is None and axes[other] is not None:
                yield Fault(("loops", i, name), f"missing: a hinge needs both axes, and '{other}' is given")
        if loop.body_a == loop.body_b:
            yield Fault(("loops", i, "body_b"), f"both points are on '{loop.body_a}'")


def _branch(m: Mechanism) -> Iterator[Fault]:
    """What says how loops are assembled and steered."""
    named = {"independent": m.independent, "assembly": tuple(name for name, _ in m.assembly)}
    for key, names in named.items():
        if names and not m.loops:
            yield Fault((key,), "only a mechanism with 'loops' has it")
            continue
        for i, name in enumerate(names):
            path: Path = (key, name if key == "assembly" else i)
            if name not in m.coordinates:
                yield Fault(path, f"there is no coordinate {nearest(name, m.coordinates)}", shorten(m.coordinates))
            elif name in names[:i]:
                yield Fault(path, f"coordinate '{name}' is named twice")
    for name, value in m.assembly:
        if not isfinite(value):
            yield Fault(("assembly", name), "must be finite")


def _attachments(m: Mechanism) -> Iterator[Fault]:
    for i, one in enumerate(m.attachments):
        path: Path = ("attachments", i)
        yield from known((*path, "body"), one.body, "body", ("world", *(body.name for body in m.bodies)))
        yield from one.region.faults(path)
        try:
            one.region.on(one.body, m.joints)
        except InputError as error:
            yield from (replace(fault, path=(*path, *fault.path)) for fault in error.faults)


def _list(names: Iterable[str]) -> str:
    return ", ".join(shorten(list(names)))

"""A mechanism as exact numbers: what a certificate is about (docs/certificates.md)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from typing import Any

from ..energy.fourier.frames import MAX_DENOMINATOR
from ..kinematics.tree import Link, Tree
from ..model.elements import Element, Spring, laws
from ..model.elements.on_joints import OnJoints
from ..model.errors import NoFourierForm
from ..model.mechanism import Mechanism

ALIKE = 1e-15  # a stored ratio so near a simple fraction is that fraction
DIGITS = 9  # of a claim
X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
Value = tuple[dict[str, Fraction], Fraction]
"""Ratios of coordinates, and an offset."""


def text(x: float | Fraction) -> str:
    """A number as the fraction that it is."""
    return str(Fraction(x))


def rounded(x: Fraction, up: bool) -> str:
    """A number rounded outward to so many digits."""
    context = Context(prec=DIGITS, rounding=ROUND_CEILING if up else ROUND_FLOOR)
    return f"{context.divide(Decimal(x.numerator), Decimal(x.denominator)).normalize(context):e}" if x else "0"


def written(mechanism: Mechanism) -> dict[str, Any]:
    """The mechanism as a certificate holds it.

    Raises:
        NoFourierForm: it has loops, or a spring without a finite form.
    """
    if mechanism.loops:
        raise NoFourierForm("it has loops: its energy is no finite sum over the independent coordinates")
    tree = Tree.of(mechanism)
    values = _values(mechanism, tree)
    points = [(b.name, b.mass, b.com) for b in mechanism.bodies]
    points += [(m.body, m.mass, m.position) for m in mechanism.masses]
    return {
        "gravity": _vector(mechanism.gravity),
        "coordinates": [*map(str, tree.coordinates)],
        "joints": [_joint(link, tree, values) for link in tree.links],
        "masses": _masses(points),
        "spring_masses": _masses(lump for spring in mechanism.springs for lump in spring.lumps()),
        "springs": [_spring(element, values) for element in mechanism.springs],
    }


def _vector(v: Iterable[float]) -> list[str]:
    return [*map(text, v)]


def _masses(points: Iterable[tuple[str, float, Iterable[float]]]) -> list[dict[str, Any]]:
    return [{"body": body, "mass": text(m), "position": _vector(p)} for body, m, p in points if m and body != "world"]


def _values(mechanism: Mechanism, tree: Tree) -> dict[str, Value]:
    """Of every motion; couplings may name joints that are coupled themselves."""
    found: dict[str, Value] = {str(name): ({str(name): Fraction(1)}, Fraction(0)) for name in tree.coordinates}
    waiting = {coupling.joint: coupling for coupling in mechanism.couplings}
    while waiting:
        for name in [name for name, one in waiting.items() if all(joint in found for joint, _ in one.terms)]:
            one = waiting.pop(name)
            found[name] = _sum(one.terms, found, Fraction(one.offset))
    return found


def _sum(terms: Iterable[tuple[str, float]], values: Mapping[str, Value], offset: Fraction = Fraction(0)) -> Value:
    slopes: dict[str, Fraction] = {}
    for joint, ratio in terms:
        own, start = values[joint]
        offset += _ratio(ratio) * start
        for name, slope in own.items():
            slopes[name] = slopes.get(name, Fraction(0)) + _ratio(ratio) * slope
    return {name: slope for name, slope in slopes.items() if slope}, offset


def _ratio(ratio: float) -> Fraction:
    simple = Fraction(ratio).limit_denominator(MAX_DENOMINATOR)
    if abs(float(simple) - ratio) > ALIKE * max(1.0, abs(ratio)):
        raise NoFourierForm(
            f"a coupling ratio ({ratio:g}) is not a fraction with a denominator below {MAX_DENOMINATOR}"
        )
    return simple


def _motion(axis: Iterable[float], value: Value) -> dict[str, Any]:
    slopes, offset = value
    return {"axis": _vector(axis), "by": {name: text(x) for name, x in slopes.items()}, "from": text(offset)}


def _joint(link: Link, tree: Tree, values: Mapping[str, Value]) -> dict[str, Any]:
    joint = link.joint
    still = [(axis, angle) for axis, angle in zip((Z, Y, X), joint.rpy[::-1], strict=True) if angle]
    turns = [_motion(axis, ({}, Fraction(angle))) for axis, angle in still]
    own = (X, Y, Z) if joint.type == "spherical" else (joint.axis,)
    moves = [_motion(a, values[str(c)]) for a, c in zip(own, joint.coordinates, strict=False)]
    slides = joint.type == "prismatic"
    return {
        "child": joint.child,
        "parent": joint.parent,
        "base": tree.names[link.base],
        "xyz": _vector(joint.xyz),
        "turns": turns if slides else [*turns, *moves],
        "slides": moves if slides else [],
    }


def _spring(element: Element, values: Mapping[str, Value]) -> dict[str, Any]:
    if isinstance(element, Spring) and not element.free_length:
        ends = {"body_a": element.body_a, "p_a": _vector(element.p_a), "body_b": element.body_b}
        return {"name": element.name, **ends, "p_b": _vector(element.p_b), "stiffness": text(element.stiffness)}
    if isinstance(element, OnJoints):
        slopes, offset = _sum(element.joints, values)
        on = {"name": element.name, "by": {name: text(x) for name, x in slopes.items()}, "from": text(offset)}
        return {**on, **dict(_energy(element))}
    raise NoFourierForm(f"'{element.name}' is {element.noun} whose energy is no finite sum")


def _energy(element: OnJoints) -> Iterator[tuple[str, Any]]:
    """On the angle s: ``c1 s + c2 s^2``, and a cosine and sine of each multiple."""
    law, waves = element.law, []
    k, s0, torque = Fraction(0), Fraction(0), Fraction(0)
    if isinstance(law, laws.Linear):
        k, s0 = Fraction(law.stiffness), Fraction(law.free_length)
    elif isinstance(law, laws.ConstantTorque):
        torque = Fraction(law.torque)
    elif isinstance(law, laws.Cam) and not law.points:
        both = {n: (a, b) for n, a, b in law.harmonics}
        waves = [_vector(both.get(n, (0, 0))) for n in range(1, max(both) + 1)]
    else:
        raise NoFourierForm(f"'{element.name}' is {element.noun} whose energy is no finite sum")
    yield "powers", [text(torque - k * s0), text(k / 2)]
    yield "waves", waves

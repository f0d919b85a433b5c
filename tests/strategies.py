"""Random valid mechanisms: trees of all joint types, with couplings, loops, springs, masses and odd names."""

from __future__ import annotations

from math import pi
from typing import Any
from unicodedata import category

from hypothesis import strategies as st

from equipoise.model.elements import Spring
from equipoise.model.mechanism import JOINT_TYPES, SINGLE, Body, Coupling, Joint, Loop, Mechanism, PointMass, Workspace
from equipoise.model.validate import TURNS

ODD = [
    "yes",
    "null",
    "~",
    "1.0",
    ".5e3",
    "1e3",
    "0x1F",
    "a: b",
    "- a",
    "#1",
    "[x]",
    "é",
    "关节",
    "💪",
    " a ",
    "2020-01-01",
]
ODD += ["", "<<", "=", "a #b", '"', "'", "\\", "\n", "\t", "\x85\u2028", "\x00\x1b", "y", "k" * 1500, "&a", "*a", "!t"]
reals = st.floats(allow_nan=False, allow_infinity=False)
positive = st.floats(min_value=0, exclude_min=True, allow_infinity=False)
masses = st.floats(min_value=0, allow_infinity=False)
CONTROL = ("Cc", "Cs", "Zl", "Zp")  # not in names
texts = st.sampled_from(ODD) | st.text(max_size=8)
labels = st.sampled_from([name for name in ODD if not any(category(letter) in CONTROL for letter in name)])
labels |= st.text(st.characters(exclude_categories=CONTROL, exclude_characters=TURNS), max_size=8)
vectors = st.tuples(reals, reals, reals)
axes = vectors.filter(any)
scalars = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | texts
plain = st.recursive(scalars, lambda x: st.lists(x, max_size=3) | st.dictionaries(texts, x, max_size=3), max_leaves=8)


def names(count: int) -> st.SearchStrategy[list[str]]:
    """Distinct names that are neither empty, the world, nor like a coordinate of a spherical joint."""
    good = labels.filter(lambda name: name not in ("", "world") and name[-2:] not in (".x", ".y", ".z"))
    return st.lists(good, min_size=count, max_size=count, unique=True)


@st.composite
def mechanisms(draw: st.DrawFn, most_bodies: int = 5) -> Mechanism:
    """A valid mechanism with up to `most_bodies` bodies, in any order in the file."""
    placed = ["world"]
    bodies, joints = [], []
    count = draw(st.integers(0, most_bodies))
    for body, name in zip(draw(names(count)), draw(names(count)), strict=True):
        inertia = draw(st.none() | st.tuples(*[reals] * 6))
        bodies.append(Body(body, draw(masses), draw(vectors), inertia))
        kind = draw(st.sampled_from(JOINT_TYPES))
        limits = draw(st.none() | st.tuples(reals, reals)) if kind in SINGLE else None
        joint = Joint(
            name,
            kind,  # type: ignore[arg-type]  # sampled from the valid ones
            draw(st.sampled_from(placed)),
            body,
            draw(vectors),
            draw(vectors),
            draw(axes) if kind in SINGLE else draw(vectors),
            None if limits is None else (min(limits), max(limits)),
            draw(st.sampled_from(placed)) if kind == "parallelogram" else None,
        )
        joints.append(joint)
        placed.append(body)
    couplings = []
    single = [joint.name for joint in joints if joint.type in SINGLE]
    for i, name in enumerate(single):  # on joints before it only: no ring
        if draw(st.booleans()):
            on = draw(st.lists(st.sampled_from(single[:i]), unique=True, max_size=3)) if i else []
            couplings.append(Coupling(name, tuple((other, draw(reals)) for other in on), draw(reals)))
    pairs = st.permutations(placed).map(lambda order: order[:2])
    springs = []
    loops = []
    if bodies:
        for name in draw(st.integers(0, 3).flatmap(names)):
            (a, b), split = draw(pairs), draw(st.floats(0, 1))
            values = (draw(vectors), b, draw(vectors), draw(positive), draw(masses), draw(masses), split)
            springs.append(Spring(name, a, *values))
        for _ in range(draw(st.integers(0, 2))):
            a, b = draw(pairs)
            hinge = draw(st.just((None, None)) | st.tuples(axes, axes))
            loops.append(Loop(a, draw(vectors), b, draw(vectors), *hinge))
    points = [
        PointMass(name, draw(st.sampled_from(placed)), draw(masses), draw(vectors))
        for name in draw(st.integers(0, 2).flatmap(names))
    ]
    return Mechanism(
        name=draw(labels),
        bodies=tuple(draw(st.permutations(bodies))),
        joints=tuple(draw(st.permutations(joints))),
        couplings=tuple(couplings),
        loops=tuple(loops),
        springs=tuple(springs),
        masses=tuple(points),
        gravity=draw(vectors),
        workspace=Workspace(draw(st.integers(1, 1_000_000))),
        provenance=draw(st.dictionaries(texts, plain, max_size=3)),
    )


@st.composite
def dh_rows(draw: st.DrawFn) -> list[dict[str, Any]]:
    """Rows of a DH table, with right angles among the angles."""
    lengths = st.sampled_from([0.0, 0.3, -0.2]) | st.floats(-2, 2)
    angles = st.sampled_from([0.0, pi / 2, -pi / 2, pi]) | st.floats(-4, 4)
    row = st.fixed_dictionaries(
        {"a": lengths, "alpha": angles, "d": lengths, "theta": angles, "type": st.sampled_from(SINGLE)}
    )
    return draw(st.lists(row, min_size=1, max_size=4))

"""Mechanisms with certificates, small ones, and one with every kind of joint and spring that has a finite form."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

from example_files import FOLDER
from robots import balanced

import equipoise as eq
from equipoise.model.elements import laws

EXACT = ("bevel_balanced", "geared_pair", "lee2014_table5a", "lenzo_layout_b", "parallelogram_lamp", "pendulum")
"""Examples with exact springs whose certificates take no time."""


def mixed() -> eq.Mechanism:
    """A carriage on a slope, a hinge, a ball joint, a gear and a parallelogram, with springs of each kind."""
    joints = (
        eq.Joint("rail", "prismatic", "world", "carriage", (0.1, 0, 0.2), (0.1, 0.2, 0.3), (1, 0.5, 0.2), (-0.3, 0.5)),
        eq.Joint("hinge", "revolute", "carriage", "arm", (0.1, 0.2, 0.3), (0.4, -0.2, 2.0), (0.3, -1, 0.2)),
        eq.Joint("gear", "revolute", "arm", "wheel", (0.3, 0, 0.1), (0, 0.7, 0), (0, 1, 0)),
        eq.Joint("ball", "spherical", "arm", "hand", (0.5, 0, 0.1), (0.2, 0, 0)),
        eq.Joint("guide", "parallelogram", "arm", "tray", (0.2, 0.1, 0), (0, 0, 0.5), follows="carriage"),
        eq.Joint("bolt", "fixed", "hand", "tool", (0, 0.1, 0.1), (1, 0, 0)),
    )
    names = ("carriage", "arm", "wheel", "hand", "tray", "tool")
    return eq.Mechanism(
        "mixed",
        tuple(eq.Body(name, 0.5 + i, (0.1 * i, -0.05, 0.03)) for i, name in enumerate(names)),
        joints,
        (eq.Coupling("gear", (("hinge", -2 / 3),), 0.4),),
        springs=(
            eq.Spring("far", "world", (0.1, 0, 0.4), "tool", (0, 0.1, 0), 120.0, mass=0.3, mass_split=0.25),
            eq.Spring("near", "tray", (0, 0.2, 0), "wheel", (0.1, 0, 0.1), 80.0),
            eq.TorsionSpring("twist", (("hinge", 1.0), ("gear", 0.5)), 3.0, 0.2),
            eq.JointElement("steady", (("hinge", 1.0),), laws.ConstantTorque(0.7)),
            eq.JointElement("cam", (("gear", 1.0),), laws.Cam(cosine=(0.2, 0.0, 0.1), sine=(0.0, 0.3))),
        ),
        masses=(eq.PointMass("load", "hand", 0.4, (0.1, 0.1, 0)),),
    )


@cache
def bounded() -> eq.Mechanism:
    """An arm of two links about skew axes, which springs on these pairs cannot balance exactly."""
    arm = eq.Mechanism(
        "two links",
        (eq.Body("upper", 2.0, (0.2, 0, 0)), eq.Body("fore", 1.0, (0.15, 0.02, 0))),
        (
            eq.Joint("shoulder", "revolute", "world", "upper", axis=(0, 1, 0)),
            eq.Joint("elbow", "revolute", "upper", "fore", (0.4, 0, 0), (0.3, 0, 0), (0, 1, 0)),
        ),
    )
    regions = {"fore": eq.Region.box((0.1, 0.05, 0.0), (0.05, 0, 0))}
    return eq.design(
        arm, pairs=[("world", "upper"), ("upper", "fore")], radius=0.1, regions=regions, springs=2
    ).mechanism


@cache
def certificate(name: str) -> str:
    """The certificate of "mixed", "bounded", "ur5", or of an example, as text."""
    made = {"mixed": mixed, "bounded": bounded, "ur5": lambda: balanced().mechanism}
    mechanism = made[name]() if name in made else eq.load(FOLDER / f"{name}.yaml")
    return json.dumps(eq.certify(mechanism).document)


def document(name: str) -> dict[str, Any]:
    """The same as a value of its own."""
    return json.loads(certificate(name))

"""Mechanisms at an edge: a coupled joint's range, an angle that slides something, weight that gravity does not move."""

from __future__ import annotations

from dataclasses import replace

from scipy.spatial.transform import Rotation
from zoo import geared_pair, hinge, vertical_slide

from equipoise.model.elements import Spring
from equipoise.model.mechanism import Body, Coupling, Joint, Mechanism


def coupled(lower: float, upper: float) -> Mechanism:
    """A driver within +-3 rad and a joint that turns minus twice as far, plus one radian."""
    m = geared_pair(-2.0, 1.0)
    left, right = m.joints
    return replace(m, joints=(replace(left, range=(-3.0, 3.0)), replace(right, range=(lower, upper))))


def drum(limits: tuple[float, float] | None, k: float = 98.1) -> Mechanism:
    """A drum of radius 0.1 m lifts 2 kg: a slide that depends on an angle."""
    m = vertical_slide(k).mechanism
    joint, drum = replace(m.joints[0], range=None), replace(hinge("drum", "world", "drum"), range=limits)
    return replace(
        m,
        bodies=(Body("drum"), *m.bodies),
        joints=(drum, joint),
        couplings=(Coupling("lift", (("drum", 0.1),)),),
    )


def turret(*springs: Spring, arm: float = 0.0, rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Mechanism:
    """Ten tons ten metres off a vertical axis: no work for gravity. On it, without a spring, an arm of mass `arm`."""
    R = Rotation.from_euler("xyz", rpy).as_matrix()
    x, y, z = (R @ [0, 0, -9.81]).tolist()
    return Mechanism(
        "turret",
        (Body("turret", 1e4, (10.0, 0.0, 0.0)), Body("arm", arm, (0.3, 0.0, 0.0))),
        (
            Joint("yaw", "revolute", "world", "turret", rpy=rpy, axis=(0.0, 0.0, 1.0)),
            hinge("shoulder", "turret", "arm"),
        ),
        springs=springs,
        gravity=(x, y, z),
    )

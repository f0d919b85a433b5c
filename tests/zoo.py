"""The zoo: small mechanisms of which everything is known in closed form. Tests, examples and benchmarks share it.

Unless said otherwise: lengths in m, masses in kg, gravity 9.81 m/s^2 along -z, links along x at q = 0 and turning
about -y, so that a positive angle lifts them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import pi, sqrt
from typing import Any

from equipoise.model.elements import Spring
from equipoise.model.mechanism import Body, Capsule, Coupling, Joint, Mechanism, PointMass

G = 9.81  # [m/s^2]
LIFT = (0.0, -1.0, 0.0)  # the axis about which a positive angle lifts what points along x
PENDULUM_K = 196.2  # [N/m] k a b = m g l


@dataclass(frozen=True)
class Known:
    """A mechanism and what is known of it.

    Attributes:
        exact: whether its energy is the same at every configuration.
        energy: [J] that constant energy; None where it is not constant.
        unbalanced, residual: per coordinate, the peak torque [N m or N] of gravity alone, and of gravity and springs;
            None where there is no closed form.
        proved: whether there is a Fourier form: its certificate is a proof, of balance or of the lack of it.
    """

    mechanism: Mechanism
    exact: bool
    unbalanced: tuple[float, ...]
    residual: tuple[float | None, ...]
    energy: float | None = None
    proved: bool = True


def _exact(mechanism: Mechanism, energy: float, *unbalanced: float) -> Known:
    return Known(mechanism, True, unbalanced, (0.0,) * len(unbalanced), energy)


def hinge(name: str, parent: str, child: str, x: float = 0.0, z: float = 0.0, **more: object) -> Joint:
    """A revolute joint that lifts."""
    return Joint(name, "revolute", parent, child, (x, 0.0, z), axis=LIFT, **more)  # type: ignore[arg-type]


def to_ground(name: str, link: str, a: float, b: float, k: float, parent: str = "world", **more: Any) -> Spring:
    """The basic spring: from height `a` above the joint to distance `b` along the link."""
    return Spring(name, parent, (0.0, 0.0, a), link, (b, 0.0, 0.0), k, **more)


# One link -----------------------------------------------------------------------------------------------------------


def pendulum(stiffness: float = PENDULUM_K, free_length: float = 0.0, spring_mass: float = 0.0) -> Mechanism:
    """2 kg at 0.3 m, spring from 0.2 m above the joint to 0.15 m along the link: balanced when k a b = m g l."""
    spring = to_ground("shoulder spring", "arm", 0.2, 0.15, stiffness, free_length=free_length, mass=spring_mass)
    return Mechanism(
        "one-link arm",
        (Body("arm", 2.0, (0.3, 0.0, 0.0)),),
        (hinge("shoulder", "world", "arm"),),
        springs=(spring,),
    )


def with_post(free_length: float = 0.0) -> Mechanism:
    """The pendulum beside a post of 10 mm radius at 0.1 m from its plane; a spring 20 mm thick."""
    m = pendulum(free_length=free_length)
    spring = replace(m.springs[0], diameter=0.02)
    post = Capsule("post", "stand", (0.05, 0.1, -1.0), (0.05, 0.1, 1.0), 0.01)
    stand = Joint("bolts", "fixed", "world", "stand")
    m = replace(m, bodies=(*m.bodies, Body("stand")), joints=(*m.joints, stand), capsules=(post,))
    return m.with_springs((spring,))


def exact_pendulum() -> Known:
    return _exact(pendulum(), PENDULUM_K / 2 * (0.2**2 + 0.15**2), 2 * G * 0.3)


def soft_pendulum() -> Known:
    """1 % soft: 1 % of m g l is left over."""
    return Known(pendulum(0.99 * PENDULUM_K), False, (2 * G * 0.3,), (0.01 * 2 * G * 0.3,))


def free_length_pendulum() -> Known:
    """Free length a/8: the error k L0 a b sin / |d| peaks at L0 / max(a, b) of m g l, here 1/8."""
    m = pendulum(free_length=0.2 / 8)
    return Known(m, False, (2 * G * 0.3,), (0.125 * 2 * G * 0.3,), proved=False)


def heavy_spring() -> Known:
    """A spring of 0.4 kg, a quarter of it at the ground: k a b = m g l + 0.3 kg g b."""
    k = (2 * G * 0.3 + 0.3 * G * 0.15) / (0.2 * 0.15)
    spring = to_ground("spring", "arm", 0.2, 0.15, k, mass=0.4, mass_split=0.25)
    m = pendulum().with_springs((spring,))
    return _exact(m, k / 2 * (0.2**2 + 0.15**2) + 0.1 * G * 0.2, 2 * G * 0.3 + 0.3 * G * 0.15)


def counterweight() -> Known:
    """2 kg at 0.3 m and 3 kg at -0.2 m: exact without a spring, and nothing to balance."""
    mass = PointMass("counterweight", "arm", 3.0, (-0.2, 0.0, 0.0))
    return _exact(pendulum().with_springs(()).with_masses((mass,)), 0.0, 0.0)


def spherical_pendulum() -> Known:
    """The pendulum on a ball joint: the same spring balances all three rotations."""
    link = (Body("arm", 2.0, (0.3, 0.0, 0.0)),)
    joint = (Joint("ball", "spherical", "world", "arm"),)
    m = Mechanism("spherical pendulum", link, joint, springs=(to_ground("spring", "arm", 0.2, 0.15, PENDULUM_K),))
    return _exact(m, PENDULUM_K / 2 * (0.2**2 + 0.15**2), *[2 * G * 0.3] * 3)


# Serial arms ---------------------------------------------------------------------------------------------------------

L1, M1, H1, M2, H2 = 0.3, 2.0, 0.15, 1.2, 0.12


def lenzo_springs(a12: float = 0.05, b12: float = 0.36, k2: float = 400.0) -> tuple[tuple[Spring, Spring], float]:
    """The two springs of Lenzo (2017), Eq. (15), and the constant energy [J]. Layout b: a12 > 0, b12 > l1.

    Spring k2 goes from a2 above the shoulder to b2 from the elbow along link 2, k12 from b12 from the shoulder along
    link 1 to a12 from the elbow along link 2.
    """
    a2 = (M1 * G * H1 + M2 * G * L1) / (k2 * L1)
    b2 = M2 * G * H2 / (k2 * a2)
    k12 = k2 * b2 * L1 / (a12 * (b12 - L1))
    springs = (
        Spring("k2", "world", (0.0, 0.0, a2), "forearm", (b2, 0.0, 0.0), k2),
        Spring("k12", "upper arm", (b12, 0.0, 0.0), "forearm", (a12, 0.0, 0.0), k12),
    )
    return springs, k2 / 2 * (a2**2 + L1**2 + b2**2) + k12 / 2 * ((L1 - b12) ** 2 + a12**2)


_LENZO_BODIES = (Body("upper arm", M1, (H1, 0.0, 0.0)), Body("forearm", M2, (H2, 0.0, 0.0)))
_ELBOW = hinge("elbow", "upper arm", "forearm", L1)
_SHOULDER_PEAK, _ELBOW_PEAK = G * (M1 * H1 + M2 * L1 + M2 * H2), G * M2 * H2


def lenzo_spherical() -> Known:
    """Lenzo's anthropomorphic arm, layout b: ball shoulder, hinge elbow, two springs, no auxiliary links."""
    springs, energy = lenzo_springs()
    joints = (Joint("shoulder", "spherical", "world", "upper arm"), _ELBOW)
    m = Mechanism("anthropomorphic arm", _LENZO_BODIES, joints, springs=springs)
    return _exact(m, energy, *[_SHOULDER_PEAK] * 3, _ELBOW_PEAK)


def lenzo_revolute() -> Known:
    """The same with a shoulder of three hinges: yaw about the vertical, pitch, roll about the upper arm."""
    springs, energy = lenzo_springs()
    joints = (
        Joint("yaw", "revolute", "world", "turret", axis=(0.0, 0.0, 1.0)),
        hinge("pitch", "turret", "yoke"),
        Joint("roll", "revolute", "yoke", "upper arm", axis=(1.0, 0.0, 0.0)),
        _ELBOW,
    )
    bodies = (Body("turret"), Body("yoke"), *_LENZO_BODIES)
    m = Mechanism("arm with three shoulder hinges", bodies, joints, springs=springs)
    return _exact(m, energy, 0.0, _SHOULDER_PEAK, _ELBOW_PEAK, _ELBOW_PEAK)


def planar_two_link() -> Known:
    """Both hinges horizontal; Lenzo's layout a: a12 < 0, b12 < l1."""
    springs, energy = lenzo_springs(a12=-0.05, b12=0.24)
    joints = (hinge("shoulder", "world", "upper arm"), _ELBOW)
    m = Mechanism("planar two-link arm", _LENZO_BODIES, joints, springs=springs)
    return _exact(m, energy, _SHOULDER_PEAK, _ELBOW_PEAK)


def lee_chen_arm() -> Known:
    """Table 4 of Lee and Chen (2014), without springs: links of 0.18, 0.18 and 0.07 m."""
    bodies = (
        Body("link 2", 0.848, (0.09, 0.0, 0.0)),
        Body("link 3", 0.848, (0.09, 0.0, 0.0)),
        Body("link 4", 1.33, (0.06, 0.0, 0.0)),
    )
    joints = (
        hinge("joint 2", "world", "link 2"),
        hinge("joint 3", "link 2", "link 3", 0.18),
        hinge("joint 4", "link 3", "link 4", 0.18),
    )
    wrist = 1.33 * G * 0.06
    elbow = wrist + G * (0.848 * 0.09 + 1.33 * 0.18)
    shoulder = elbow + G * (0.848 * 0.09 + (0.848 + 1.33) * 0.18)
    peaks = (shoulder, elbow, wrist)
    return Known(Mechanism("Lee and Chen's arm", bodies, joints), False, peaks, peaks)


def parallelogram_lamp() -> Known:
    """A desk lamp: parallelograms keep the knee plate and the head upright, so each arm needs one basic spring."""
    bodies = (
        Body("lower arm", 0.5, (0.2, 0.0, 0.0)),
        Body("knee", 0.1),
        Body("upper arm", 0.4, (0.15, 0.0, 0.0)),
        Body("head", 0.3, (0.05, 0.0, -0.02)),
    )
    joints = (
        hinge("base", "world", "lower arm", range=(-pi / 2, pi / 2)),
        Joint("lower bars", "parallelogram", "lower arm", "knee", (0.4, 0.0, 0.0), follows="world"),
        hinge("middle", "knee", "upper arm", range=(-pi / 2, pi / 2)),
        Joint("upper bars", "parallelogram", "upper arm", "head", (0.35, 0.0, 0.0), follows="knee"),
    )
    lower = G * (0.5 * 0.2 + (0.1 + 0.4 + 0.3) * 0.4)
    upper = G * (0.4 * 0.15 + 0.3 * 0.35)
    k1, k2 = lower / (0.1 * 0.08), upper / (0.06 * 0.05)
    springs = (
        to_ground("lower spring", "lower arm", 0.1, 0.08, k1),
        to_ground("upper spring", "upper arm", 0.06, 0.05, k2, parent="knee"),
    )
    energy = k1 / 2 * (0.1**2 + 0.08**2) + k2 / 2 * (0.06**2 + 0.05**2) - 0.3 * G * 0.02
    return _exact(Mechanism("parallelogram lamp", bodies, joints, springs=springs), energy, lower, upper)


# Slides and gears ----------------------------------------------------------------------------------------------------


def vertical_slide(k: float = 98.1, stroke: float = 0.1) -> Known:
    """2 kg on a vertical slide, spring from 0.2 m above: balanced at s = 0 only, k s is left over."""
    height = 2 * G / k
    m = Mechanism(
        "vertical slide",
        (Body("carriage", 2.0),),
        (Joint("lift", "prismatic", "world", "carriage", axis=(0.0, 0.0, 1.0), range=(-stroke, stroke)),),
        springs=(Spring("spring", "world", (0.0, 0.0, height), "carriage", (0.0, 0.0, 0.0), k),),
    )
    return Known(m, False, (2 * G,), (k * stroke,))


def gantry() -> Known:
    """The balanced pendulum on a horizontal slide: the spring rides along."""
    m = Mechanism(
        "gantry",
        (Body("carriage", 1.0, (0.0, 0.0, 0.1)), Body("arm", 2.0, (0.3, 0.0, 0.0))),
        (
            Joint("rail", "prismatic", "world", "carriage", axis=(2.0, 0.0, 0.0), range=(-0.5, 3.0)),
            hinge("shoulder", "carriage", "arm", 0.05),
        ),
        springs=(Spring("spring", "carriage", (0.05, 0.0, 0.2), "arm", (0.15, 0.0, 0.0), PENDULUM_K),),
    )
    return _exact(m, PENDULUM_K / 2 * (0.2**2 + 0.15**2) + 1.0 * G * 0.1, 0.0, 2 * G * 0.3)


def geared_pair(ratio: float = -1.0, offset: float = pi, stiffness: float | None = None) -> Mechanism:
    """Two 1 kg links 0.5 m apart, the right one at ``ratio * left + offset``."""
    k = 2 * 1.0 * G * 0.3 / (0.2 * 0.15) if stiffness is None else stiffness
    return Mechanism(
        "geared pair",
        (Body("left", 1.0, (0.3, 0.0, 0.0)), Body("right", 1.0, (0.3, 0.0, 0.0))),
        (hinge("left pivot", "world", "left"), hinge("right pivot", "world", "right", 0.5)),
        couplings=(Coupling("right pivot", (("left pivot", ratio),), offset),),
        springs=(to_ground("spring", "left", 0.2, 0.15, k),),
    )


def mirrored_pair() -> Known:
    """Gears of ratio -1, mirror images: both masses go up together, so one spring on one link balances both."""
    k = 2 * G * 0.3 / (0.2 * 0.15)
    return _exact(geared_pair(), k / 2 * (0.2**2 + 0.15**2), 2 * G * 0.3)


def two_to_one() -> Known:
    """The right link turns twice as fast: sin q and sin 2q, each with its spring."""
    k = G * 0.3 / (0.2 * 0.15)
    right = Spring("second", "world", (0.5, 0.0, 0.2), "right", (0.15, 0.0, 0.0), k)
    m = geared_pair(2.0, 0.0, k)
    return _exact(m.with_springs((*m.springs, right)), k * (0.2**2 + 0.15**2), 3 * G * 0.3)


def irrational_pair() -> Known:
    """Ratio sqrt 2, each link with its spring: balanced, but no Fourier form says so. Peaks at q = 0."""
    k = G * 0.3 / (0.2 * 0.15)
    right = Spring("second", "world", (0.5, 0.0, 0.2), "right", (0.15, 0.0, 0.0), k)
    m = geared_pair(sqrt(2), 0.0, k)
    peak = (1 + sqrt(2)) * G * 0.3
    return Known(m.with_springs((*m.springs, right)), False, (peak,), (0.0,), proved=False)


ZOO: dict[str, Callable[[], Known]] = {
    make.__name__: make
    for make in (
        exact_pendulum, soft_pendulum, free_length_pendulum, heavy_spring, counterweight, spherical_pendulum,
        lenzo_spherical, lenzo_revolute, planar_two_link, lee_chen_arm, parallelogram_lamp,
        vertical_slide, gantry, mirrored_pair, two_to_one, irrational_pair,
    )
}  # fmt: skip
EXACT = {name: make for name, make in ZOO.items() if make().exact}

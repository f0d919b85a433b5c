"""Write the example files that are computed: the papers' mechanisms, and mechanisms with loops.

Planar ones move in the x-z plane, where a vector (x, z) is a complex number and a positive angle lifts what points
along x. A bar hinged to the ground whose mass moment about its hinge is `moment` needs one spring,
``k |W| |V| = g |moment|``, from W above the hinge to V along the moment.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import pi, radians
from pathlib import Path

import numpy as np

from equipoise import Body, Joint, Loop, Mechanism, PointMass, Spring, design, save
from equipoise.reproduce import cho2012, lee2014, lin2010
from equipoise.synthesis.delta.robot import DeltaRobot

G = 9.81  # [m/s^2]
LIFT = (0.0, -1.0, 0.0)
Range = tuple[float, float]


def hinge(name: str, parent: str, child: str, at: complex = 0, limits: Range | None = None) -> Joint:
    """A hinge that lifts; `limits` [deg]."""
    turn = None if limits is None else (radians(limits[0]), radians(limits[1]))
    return Joint(name, "revolute", parent, child, point(at), axis=LIFT, range=turn)


def meet(body_a: str, p_a: complex, body_b: str, p_b: complex) -> Loop:
    """A hinge that closes a loop."""
    return Loop(body_a, point(p_a), body_b, point(p_b), LIFT, LIFT)


def basic(name: str, base: str, foot: complex, bar: str, moment: complex, W: float, V: float) -> Spring:
    """The spring of a bar with this moment [kg m] that is hinged to an upright body at `foot`."""
    k = G * abs(moment) / (W * V)
    return Spring(name, base, point(foot + 1j * W), bar, point(V * moment / abs(moment)), k)


def point(p: complex) -> tuple[float, float, float]:
    """(x, 0, z)."""
    return (float(np.real(p)), 0.0, float(np.imag(p)))


def four_bar() -> Mechanism:
    """A crank-rocker, exact with two springs. The coupler's mass, off its line, acts at both of its ends:

    its mass centre is at ``(1 - z) A + z B`` with the complex number ``z = com / length``.
    """
    crank, length, rocker, ground = 0.2, 0.5, 0.4, 0.45
    masses = {"crank": (1.0, 0.1), "coupler": (1.5, 0.25 + 0.05j), "rocker": (1.2, 0.2)}
    mass, z = masses["coupler"][0], masses["coupler"][1] / length
    springs = (
        basic("crank spring", "world", 0, "crank", masses["crank"][0] * masses["crank"][1] + mass * (1 - z) * crank,
              0.15, 0.1),
        basic("rocker spring", "world", ground, "rocker",
              masses["rocker"][0] * masses["rocker"][1] + mass * z * rocker, 0.15, 0.15),
    )  # fmt: skip
    return Mechanism(
        "four-bar linkage",
        tuple(Body(name, m, point(com)) for name, (m, com) in masses.items()),
        (
            hinge("crank pivot", "world", "crank"),
            hinge("crank pin", "crank", "coupler", crank),
            hinge("rocker pivot", "world", "rocker", ground),
        ),
        loops=(meet("coupler", length, "rocker", rocker),),
        springs=springs,
        independent=("crank pivot",),
        assembly=(("crank pin", 0.5), ("rocker pivot", 1.8)),
    )


def desk_lamp() -> Mechanism:
    """A desk lamp whose parallelograms are real: two bars, a knee plate, two bars, a head. One spring per arm."""
    lower, upper, apart = 0.4, 0.35, 0.06j  # [m] the second bar of a pair is above the first
    bodies = {
        "lower arm": (0.5, 0.2), "lower rod": (0.15, 0.2), "knee": (0.1, 0.03j),
        "upper arm": (0.4, 0.15), "upper rod": (0.12, 0.175), "head": (0.3, 0.05 - 0.02j),
    }  # fmt: skip
    limits = (-70.0, 75.0)
    moments = {
        name: sum(bodies[bar][0] * bodies[bar][1] for bar in bars) + sum(bodies[body][0] for body in carried) * length
        for name, bars, carried, length in (
            ("lower arm", ("lower arm", "lower rod"), ("knee", "upper arm", "upper rod", "head"), lower),
            ("upper arm", ("upper arm", "upper rod"), ("head",), upper),
        )
    }
    return Mechanism(
        "desk lamp with real parallelograms",
        tuple(Body(name, mass, point(com)) for name, (mass, com) in bodies.items()),
        (
            hinge("base", "world", "lower arm", 0, limits),
            hinge("base rod", "world", "lower rod", apart),
            hinge("lower end", "lower arm", "knee", lower),
            hinge("middle", "knee", "upper arm", 0, limits),
            hinge("middle rod", "knee", "upper rod", apart),
            hinge("upper end", "upper arm", "head", upper),
        ),
        loops=(meet("lower rod", lower, "knee", apart), meet("upper rod", upper, "head", apart)),
        springs=(
            basic("lower spring", "world", 0, "lower arm", moments["lower arm"], 0.1, 0.08),
            basic("upper spring", "knee", 0, "upper arm", moments["upper arm"], 0.06, 0.05),
        ),
        independent=("base", "middle"),
    )


def pantograph() -> Mechanism:
    """A pantograph that carries a tool, exact with two springs and no upright body but the ground.

    Its long bars point along e and f, with gravity's moments `along_e` and `along_f`. A spring from the ground to the
    point ``2 a e + s f`` of the second bar, s in their proportion, balances both but for a term with ``e . f``; a
    spring across the parallelogram from the knee to the outer joint, ``|a e - b f|`` long, takes that away.
    """
    a, b, tool = 0.2, 0.25, 0.8  # [m] half the long bars, [kg]
    masses = {"upper bar": 0.6, "lower bar": 0.5, "inner bar": 0.25, "outer bar": 0.3}
    along_e = masses["upper bar"] * a + 2 * a * (masses["lower bar"] + tool)
    along_e += masses["inner bar"] * a + masses["outer bar"] * 1.5 * a
    along_f = (masses["lower bar"] + 2 * tool) * b + masses["inner bar"] * b / 2 + masses["outer bar"] * b
    height = 0.3
    s = 2 * a * along_f / along_e
    k = G * along_e / (height * 2 * a)
    return Mechanism(
        "pantograph",
        (
            Body("upper bar", masses["upper bar"], (a, 0.0, 0.0)),
            Body("lower bar", masses["lower bar"], (b, 0.0, 0.0)),
            Body("inner bar", masses["inner bar"], (b / 2, 0.0, 0.0)),
            Body("outer bar", masses["outer bar"], (a / 2, 0.0, 0.0)),
        ),
        (
            hinge("shoulder", "world", "upper bar", 0, (10, 120)),
            hinge("knee", "upper bar", "lower bar", 2 * a, (-150, -30)),
            hinge("inner joint", "upper bar", "inner bar", a),
            hinge("outer joint", "inner bar", "outer bar", b),
        ),
        loops=(meet("outer bar", a, "lower bar", b),),
        springs=(
            Spring("ground spring", "world", (0.0, 0.0, height), "lower bar", (s, 0.0, 0.0), k),
            Spring("diagonal spring", "upper bar", (2 * a, 0.0, 0.0), "inner bar", (b, 0.0, 0.0), 2 * k * s / b),
        ),
        masses=(PointMass("tool", "lower bar", tool, (2 * b, 0.0, 0.0)),),
        independent=("shoulder", "knee"),
        assembly=(("shoulder", radians(60)), ("knee", radians(-90)), ("inner joint", radians(-90)),
                  ("outer joint", radians(90))),
    )  # fmt: skip


def rssr() -> Mechanism:
    """Two modules of Lin, Shieh and Chen (2010) with real joints: each pseudobase hangs on two spherical joints.

    The method `pseudobase` gives masses, lengths and springs; its parallelogram joints become an auxiliary link on a
    revolute joint and a coupler on a spherical one, which meet at D. Each coupler may spin about CD, an idle freedom.
    """
    height, limits = 0.12, (radians(-40), radians(40))
    arm = Mechanism(
        "arm of two RSSR modules",
        (Body("link 1", 3.0, (0.2, 0.02, 0.0)), Body("link 2", 1.5, (0.15, 0.0, 0.03))),
        (
            Joint("joint 1", "revolute", "world", "link 1", axis=(0.0, -1.0, 0.0), range=limits),
            Joint("joint 2", "revolute", "link 1", "link 2", (0.4, 0.1, 0.0), axis=(0.3, -1.0, 0.2), range=limits),
        ),
    )
    made = design(arm, "pseudobase", height=height, auxiliary=0.1, pseudobase=0.1).mechanism
    axes = {joint.child: joint.axis for joint in arm.joints}
    joints, loops = [], []
    for joint in made.joints:
        link = joint.child.rpartition(" ")[0]
        if joint.child.endswith("auxiliary"):
            joint = replace(joint, type="revolute", axis=axes[link], follows=None)
        elif joint.child.endswith("pseudobase"):
            loops.append(Loop(joint.child, (0.0, 0.0, height), f"{link} auxiliary", joint.xyz))
            joint = replace(joint, type="spherical", follows=None)
        joints.append(joint)
    return replace(made, joints=tuple(joints), loops=tuple(loops), provenance={})


def hexapod() -> Mechanism:
    """A six-legged platform, the six knees in the place of Gough's and Stewart's struts: exact with two springs a leg.

    The platform's mass is in the plane of its joints, a sixth of it at each. So every leg is an arm of two links with
    a mass at its tip, on a shoulder of two hinges, and is balanced as such an arm by two springs (Lenzo 2017, Eq. 15).
    """
    thigh, shin, tip = 0.35, 0.45, 6.0 / 6  # [m], [m], [kg]
    m1, h1, m2, h2 = 0.8, 0.15, 0.5, 0.2  # [kg], [m] to the mass centres
    k, a12, b12 = 600.0, 0.08, 0.45  # [N/m], [m]
    moment_1, moment_2 = m1 * h1 + (m2 + tip) * thigh, m2 * h2 + tip * shin
    a2 = moment_1 * G / (k * thigh)
    b2 = moment_2 * G / (k * a2)
    k12 = k * b2 * thigh / (a12 * (b12 - thigh))
    bodies, actuators, passive, loops, springs = [], [], [], [], []
    for i in range(6):
        # the feet in pairs on a circle, the platform's joints in pairs half a turn of the pairs further
        foot = 0.3 * np.exp(1j * (2 * pi / 3 * (i // 2) + (-0.2, 0.2)[i % 2]))
        head = 0.2 * np.exp(1j * (2 * pi / 3 * (i // 2) + (-0.8, 0.8)[i % 2]))
        at, end = (float(foot.real), float(foot.imag), 0.0), (float(head.real), float(head.imag), 0.0)
        mark = f" {i + 1}"
        bodies += [Body(f"yoke{mark}"), Body(f"thigh{mark}", m1, (h1, 0, 0)), Body(f"shin{mark}", m2, (h2, 0, 0))]
        azimuth = float(np.angle(foot))
        passive += [
            Joint(f"swing{mark}", "revolute", "world", f"yoke{mark}", at, (0.0, 0.0, azimuth), axis=(1.0, 0.0, 0.0)),
            hinge(f"hip{mark}", f"yoke{mark}", f"thigh{mark}"),
        ]
        actuators.append(hinge(f"knee{mark}", f"thigh{mark}", f"shin{mark}", thigh, (85.0, 105.0)))
        if i == 0:
            passive.append(Joint("ball 1", "spherical", "shin 1", "ball", (shin, 0.0, 0.0), rpy=(0.0, 2.4, 0.0)))
            offset = (-end[0], -end[1], -end[2])
            passive.append(Joint("plate", "fixed", "ball", "platform", offset))
        else:
            loops.append(Loop(f"shin{mark}", (shin, 0.0, 0.0), "platform", end))
        springs += [
            Spring(f"hip spring{mark}", "world", (at[0], at[1], a2), f"shin{mark}", (b2, 0.0, 0.0), k),
            Spring(f"knee spring{mark}", f"thigh{mark}", (b12, 0.0, 0.0), f"shin{mark}", (a12, 0.0, 0.0), k12),
        ]
    bodies += [Body("ball"), Body("platform", 6 * tip)]
    return Mechanism(
        "six-legged platform",
        tuple(bodies),
        (*passive, *actuators),
        loops=tuple(loops),
        springs=tuple(springs),
        independent=tuple(joint.name for joint in actuators),
        assembly=tuple((f"{name} {i + 1}", value) for i in range(6) for name, value in (("hip", 0.75), ("knee", 1.65))),
    )


def delta() -> Mechanism:
    """The example robot of Simionescu, Ciupitu and Ionita (2015), without springs."""
    return DeltaRobot(range=(-0.3, 1.2)).mechanism()


def delta_balanced() -> Mechanism:
    """The same, balanced by the paper's guides and nine springs, their masses included."""
    guide = {"link_8": 0.3, "link_9": 0.2, "frame": 0.4, "link_2p": 0.35}
    return design(delta(), "delta", spring_7=1.8, spring_10=0.5, spring_11=0.6, **guide).mechanism


FILES: dict[str, Callable[[], Mechanism]] = {
    "lin2010_balanced": lambda: lin2010.balanced().mechanism,
    "lin2010_rssr": lambda: lin2010.balanced(real=True).mechanism,
    "bevel_balanced": lambda: cho2012.balanced().mechanism,
    **{f"lee2014_table5{case.letter}": partial(lee2014.balanced, case) for case in lee2014.CASES},
    **{make.__name__: make for make in (four_bar, desk_lamp, pantograph, rssr, hexapod, delta, delta_balanced)},
}

if __name__ == "__main__":
    for name, make in FILES.items():
        save(make(), Path(__file__).parent / f"{name}.yaml")

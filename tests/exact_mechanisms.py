"""Random mechanisms that balance exactly by construction, and the same with one number a little off.

From the tips on, a point mass brings every body's moment about its own joint to zero, its own mass and what it carries
taken together, so that a body acts as a point mass on the one that carries it. On some bodies that the ground carries a
spring does so instead. Pairs of springs that do nothing are added, from a point of the parent to two opposite points
about the joint, and couplings, which cannot spoil what holds at every configuration of the joints.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from equipoise.model.elements import Spring
from equipoise.model.mechanism import Body, Coupling, Joint, Mechanism, PointMass

G = 9.81


def exact_mechanism(seed: int, joints: int | None = None) -> Mechanism:
    """Up to seven joints, or as many as asked for, mostly a chain."""
    rng = np.random.default_rng(seed)

    def vector(size: float) -> tuple[float, float, float]:
        x, y, z = rng.uniform(-size, size, 3).tolist()
        return x, y, z

    count = joints or int(rng.integers(1, 8))
    parents = [int(rng.integers(0, i)) if i and rng.random() < 0.2 else i - 1 for i in range(count)]
    kinds = [str(rng.choice(["revolute", "revolute", "spherical", "parallelogram"])) if i else "revolute"
             for i in range(count)]  # fmt: skip
    if joints or rng.random() < 0.3:  # a carriage on a level rail first
        kinds[0] = "prismatic" if rng.random() < 0.5 else "revolute"
    names = [f"b{i}" for i in range(count)]
    bodies, links, springs, masses = [], [], [], []
    carried = [0.0] * count  # [kg]
    moments = np.zeros((count, 3))  # [kg m] of that
    for i in reversed(range(count)):
        parent = names[parents[i]] if parents[i] >= 0 else "world"
        follows = str(rng.choice(["world", *names[:i]])) if kinds[i] == "parallelogram" else None
        axis = (1.0, 0.0, 0.0) if kinds[i] == "prismatic" else vector(1)
        xyz = vector(0.5)
        rpy = (0.0, 0.0, 0.0) if kinds[i] == "prismatic" else vector(3)
        links.append(Joint(f"j{i}", kinds[i], parent, names[i], xyz, rpy, axis, follows=follows))  # type: ignore[arg-type]
        own, com = float(rng.uniform(0.5, 3)), vector(0.3)
        moment = own * np.array(com) + moments[i]
        total = own + carried[i]
        if parent == "world" and kinds[i] != "prismatic" and rng.random() < 0.5 and follows is None:
            k, a = float(rng.uniform(100, 500)), float(rng.uniform(0.1, 0.4))
            x, y, z = (G * moment / (k * a)).tolist()
            springs.append(Spring(f"lift {i}", "world", (xyz[0], xyz[1], xyz[2] + a), names[i], (x, y, z), k))
        elif kinds[i] != "prismatic":  # a carriage may have its weight anywhere
            weight = float(rng.uniform(0.05, 0.2) if joints else rng.uniform(1, 3)) * total
            x, y, z = (-moment / weight).tolist()
            masses.append(PointMass(f"counterweight {i}", names[i], weight, (x, y, z)))
            total += weight
        if kinds[i] in ("revolute", "spherical") and rng.random() < 0.5:
            x, y, z = vector(0.3)
            k, p = float(rng.uniform(100, 500)), vector(0.3)
            springs += [Spring(f"idle {sign:+.0f} {i}", parent, p, names[i], (sign * x, sign * y, sign * z), k)
                        for sign in (1.0, -1.0)]  # fmt: skip
        if parents[i] >= 0:
            carried[parents[i]] += total
            moments[parents[i]] += total * np.array(xyz)
        bodies.append(Body(names[i], own, com))
    hinges = [f"j{i}" for i in range(count) if kinds[i] == "revolute"]
    couplings = []
    for i, name in enumerate(hinges):
        if i and rng.random() < 0.2:
            couplings.append(Coupling(name, ((hinges[i - 1], float(rng.choice([-1, 1, 2, 0.5]))),), 0.3))
    return Mechanism(
        f"exact {seed}",
        tuple(bodies),
        tuple(links),
        tuple(couplings),
        springs=tuple(springs),
        masses=tuple(masses),
        gravity=(0.0, 0.0, -G),
    )


def spoiled(m: Mechanism, seed: int, off: float) -> Mechanism:
    """One stiffness or one mass off by a share."""
    rng = np.random.default_rng(seed)
    i = int(rng.integers(len(m.springs) + len(m.masses)))
    if i < len(m.springs):
        worse = replace(m.springs[i], stiffness=m.springs[i].stiffness * (1 + off))
        return m.with_springs((*m.springs[:i], worse, *m.springs[i + 1 :]))
    i -= len(m.springs)
    worse = replace(m.masses[i], mass=m.masses[i].mass * (1 + off))
    return m.with_masses((*m.masses[:i], worse, *m.masses[i + 1 :]))

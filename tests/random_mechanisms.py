"""Random valid mechanisms of realistic size: trees of every kind of joint, couplings, springs and masses; chains."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np

from equipoise.model.elements import Guide, JointElement, LineElement, Pulley, Spring, TorsionSpring, Vec3, laws
from equipoise.model.mechanism import JOINT_TYPES, SINGLE, Body, Coupling, Joint, Mechanism, PointMass, Workspace

RATIOS = (-1.0, 2.0, 1.0, -2.0, 3.0, 0.5, -2 / 3, 1 / 3, 0.25)


def random_mechanism(
    seed: int,
    most_joints: int = 8,
    kinds: Sequence[str] = JOINT_TYPES,
    free_lengths: bool = True,
) -> Mechanism:
    """A mechanism with 1 to `most_joints` joints of these kinds; the same for the same arguments.

    Bodies and joints are listed in random order, couplings may depend on couplings, slides on angles and the reverse.
    Without `free_lengths` every spring has zero free length.
    """
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, most_joints + 1))
    placed = ["world"]
    bodies, joints = [], []
    for i in range(count):
        bodies.append(Body(f"b{i}", _maybe(rng, rng.uniform(0.1, 5)), _vector(rng, 0.3), _inertia(rng)))
        joints.append(_joint(rng, i, str(rng.choice(list(kinds))), placed))
        placed.append(f"b{i}")
    couplings = _couplings(rng, [joint.name for joint in joints if joint.type in SINGLE])
    springs = []
    for i in range(int(rng.integers(0, 5))):
        a, b = rng.choice(placed, 2, replace=False)
        free = float(rng.choice([0.0, rng.uniform(0.05, 0.5)])) if free_lengths else 0.0
        mass, split = _maybe(rng, rng.uniform(0, 0.5)), float(rng.uniform())
        k = float(rng.uniform(10, 500))
        springs.append(Spring(f"s{i}", str(a), _vector(rng, 0.4), str(b), _vector(rng, 0.4), k, free, mass, split))
    masses = [
        PointMass(f"m{i}", str(rng.choice(placed)), float(rng.uniform(0, 2)), _vector(rng, 0.4))
        for i in range(int(rng.integers(0, 3)))
    ]
    return Mechanism(
        f"random {seed}",
        tuple(bodies[i] for i in rng.permutation(count)),
        tuple(joints[i] for i in rng.permutation(count)),
        couplings=tuple(couplings[i] for i in rng.permutation(len(couplings))),
        springs=tuple(springs),
        masses=tuple(masses),
        gravity=_vector(rng, 10.0),
    )


def with_torsion(m: Mechanism, seed: int) -> Mechanism:
    """The mechanism with up to three torsion springs more, on single joints and on sums; none without hinges."""
    rng = np.random.default_rng(seed)
    hinges = [joint.name for joint in m.joints if joint.type == "revolute"]
    added = []
    for i in range(int(rng.integers(1, 4)) if hinges else 0):
        some = rng.choice(hinges, int(rng.integers(1, min(3, len(hinges)) + 1)), replace=False)
        terms = tuple((str(name), float(rng.choice(RATIOS))) for name in some)
        added.append(TorsionSpring(f"t{i}", terms, float(rng.uniform(0.5, 20)), float(rng.uniform(-3, 3))))
    return m.with_springs((*m.springs, *added))


def with_elements(m: Mechanism, seed: int, pulleys: bool = True) -> Mechanism:
    """The mechanism with up to five elements more, of every law, on lines, on joints, on cables through points and
    over pulleys."""
    rng = np.random.default_rng(seed)
    bodies, hinges = list(m.body_names), [joint.name for joint in m.joints if joint.type == "revolute"]
    added: list[LineElement | JointElement] = []
    for i in range(int(rng.integers(1, 6))):
        if hinges and rng.random() < 0.3:
            some = rng.choice(hinges, int(rng.integers(1, min(3, len(hinges)) + 1)), replace=False)
            terms = tuple((str(name), float(rng.choice(RATIOS))) for name in some)
            added.append(JointElement(f"e{i}", terms, _of_joint(rng)))
            continue
        a, b, *guides = (str(rng.choice(bodies)) for _ in range(2 + int(rng.choice([0, 0, 1, 2]))))
        if len({a, b, *guides}) > 1 and (guides or a != b):
            via = tuple(
                _guide(rng, body, pulleys and bool(j % 2)) for j, body in enumerate(guides, start=int(rng.integers(2)))
            )
            added.append(LineElement(f"e{i}", a, _vector(rng, 0.4), b, _vector(rng, 0.4), _of_line(rng), via))
    return m.with_springs((*m.springs, *added))


def _guide(rng: np.random.Generator, body: str, pulley: bool) -> Guide:
    point = _vector(rng, 0.4)
    if not pulley:
        return Guide(body, point)
    axis, radius = _vector(rng, 1.0), float(rng.uniform(0.02, 0.15))
    across = np.cross(axis, _vector(rng, 1.0))
    x, y, z = (np.array(point) + 2 * radius * across / np.linalg.norm(across)).tolist()
    return Pulley(body, point, radius, axis, (x, y, z))


def _of_line(rng: np.random.Generator) -> laws.Law:
    """Any law, with its kinks inside the lengths that a random mechanism has."""
    k, length, force = float(rng.uniform(10, 500)), float(rng.uniform(0.2, 1.5)), float(rng.uniform(5, 100))
    points = tuple(zip(np.cumsum(rng.uniform(0.05, 0.4, 6)).tolist(), rng.uniform(-50, 50, 6).tolist(), strict=True))
    found: tuple[laws.Law, ...] = (
        laws.Linear(k, length - 0.5),
        laws.Extension(k, length),
        laws.Extension(k, length, force),
        laws.Compression(k, length),
        laws.Gas(force, length + 0.2, length, progression=float(rng.uniform(1, 2)), temperature=280.0),
        laws.ConstantForce(force),
        laws.Table(points),
    )
    return found[int(rng.integers(len(found)))]


def _of_joint(rng: np.random.Generator) -> laws.Law:
    torques = rng.uniform(-5, 5, 6).tolist()
    points = tuple(zip((np.cumsum(rng.uniform(0.3, 1.5, 6)) - 2).tolist(), torques, strict=True))
    found: tuple[laws.Law, ...] = (
        laws.ConstantTorque(torques[0]),
        laws.Table(points),
        laws.Cam(points),
        laws.Cam(cosine=tuple(torques[:2]), sine=tuple(torques[2:5])),
    )
    return found[int(rng.integers(len(found)))]


def random_poses(mechanism: Mechanism, count: int, seed: int = 0) -> np.ndarray:
    """Configurations (count, n), whatever the joint ranges: -2 to 2 rad or m."""
    return np.random.default_rng(seed).uniform(-2, 2, (count, len(mechanism.coordinates)))


def random_chain(seed: int, links: int, kinds: tuple[str, ...], on_line: bool = False) -> Mechanism:
    """Random links, hinges with random axes or ball joints, a payload and a body held by a fixed joint.

    With `on_line` every mass centre is on the line to the next joint, ahead of its own joint or a little behind.
    """
    rng = np.random.default_rng(seed)

    def vector(size: float) -> tuple[float, float, float]:
        x, y, z = rng.uniform(-size, size, 3).tolist()
        return x, y, z

    bodies, joints = [], []
    parent, xyz = "world", vector(0.3)
    for i in range(links):
        end = vector(0.5)
        share = float(rng.uniform(-0.2, 1))
        x, y, z = (share * e for e in end)
        bodies.append(Body(f"b{i}", float(rng.uniform(0.5, 3)), (x, y, z) if on_line else vector(0.3)))
        joints.append(Joint(f"j{i}", str(rng.choice(kinds)), parent, f"b{i}", xyz, vector(pi), vector(1)))  # type: ignore[arg-type]
        parent, xyz = f"b{i}", end
    hand = Joint("wrist", "fixed", parent, "hand", xyz, vector(pi))
    return Mechanism(
        "random chain",
        (*bodies, Body("hand", 0.3, vector(0.1))),
        (*joints, hand),
        masses=(PointMass("load", parent, 0.5, vector(0.3)),),
        gravity=vector(10),
        workspace=Workspace(100),
    )


def _joint(rng: np.random.Generator, i: int, kind: str, placed: list[str]) -> Joint:
    # mostly chains: the last body is the likeliest parent
    parent = placed[-1] if rng.random() < 0.7 else str(rng.choice(placed))
    single = kind in SINGLE
    limits = sorted(rng.uniform(-3, 3, 2).tolist())
    return Joint(
        f"j{i}",
        kind,  # type: ignore[arg-type]  # one of JOINT_TYPES
        parent,
        f"b{i}",
        _vector(rng, 0.5),
        _angles(rng),
        _vector(rng, 2.0) if single and rng.random() < 0.5 else _along_one(rng),
        (limits[0], limits[1]) if single and rng.random() < 0.5 else None,
        str(rng.choice(placed)) if kind == "parallelogram" else None,
    )


def _couplings(rng: np.random.Generator, single: list[str]) -> list[Coupling]:
    couplings = []
    for i, name in enumerate(single):
        if i and rng.random() < 0.35:
            on = rng.choice(single[:i], min(i, int(rng.integers(1, 4))), replace=False)
            terms = tuple((str(other), float(rng.choice(RATIOS))) for other in on)
            couplings.append(Coupling(name, terms, _maybe(rng, rng.uniform(-2, 2))))
    return couplings


def _maybe(rng: np.random.Generator, value: float) -> float:
    """The value, or now and then nothing."""
    return float(value) if rng.random() < 0.8 else 0.0


def _vector(rng: np.random.Generator, size: float) -> Vec3:
    x, y, z = rng.uniform(-size, size, 3).tolist()
    return x, y, z


def _along_one(rng: np.random.Generator) -> Vec3:
    x, y, z = (float(rng.choice([-1.0, 1.0])) * np.eye(3)[rng.integers(3)]).tolist()
    return x, y, z


def _angles(rng: np.random.Generator) -> Vec3:
    """Any angles, or as often multiples of a right angle: what gives terms that cancel."""
    if rng.random() < 0.5:
        return _vector(rng, pi)
    x, y, z = (pi / 2 * rng.integers(-1, 3, 3)).tolist()
    return x, y, z


def _inertia(rng: np.random.Generator) -> tuple[float, float, float, float, float, float]:
    """Well inside the triangle inequality."""
    x, y, z = rng.uniform(0.02, 0.03, 3).tolist()
    a, b, c = rng.uniform(-0.002, 0.002, 3).tolist()
    return x, y, z, a, b, c

"""Families of mechanisms that a study can draw from, by a few numbers each."""

from __future__ import annotations

from collections.abc import Callable
from inspect import signature

import numpy as np

from ..model.mechanism import Body, Joint, Mechanism
from ..model.units import Amount, quantity
from ..model.validate import whole_number
from ..synthesis.planar.layouts import LENGTH, MASS, MAX_LINKS, example_arm


def planar_arm(links: int = 4, length: Amount = LENGTH, mass: Amount = MASS, centre: float = 0.5) -> Mechanism:
    """A planar arm of equal links, the ground counting as one.

    Args:
        links: 2 to 10, as `equipoise layouts` counts them.
        length, mass: of each link [m, kg].
        centre: where the mass centre is on it, as a share of its length.
    """
    whole_number("links", links, 2, MAX_LINKS)
    size, weight = quantity(length, "length", "length"), quantity(mass, "mass", "mass")
    return example_arm(links, size, weight, quantity(centre, "number", "centre"))


def random_arm(joints: int = 6, length: Amount = 0.3, mass: Amount = 2.0, seed: int = 0) -> Mechanism:
    """A serial arm whose joints point along or across their links, drawn at random.

    Args:
        joints: 1 to 10.
        length, mass: of a link on average [m, kg]; each is drawn from half to one and a half of it.
        seed: of the draws.
    """
    whole_number("joints", joints, 1, 10)
    whole_number("seed", seed, 0)
    rng = np.random.default_rng(seed)
    sizes = quantity(length, "length", "length") * rng.uniform(0.5, 1.5, joints)
    weights = quantity(mass, "mass", "mass") * rng.uniform(0.5, 1.5, joints)
    axes = rng.choice(np.eye(3), joints)
    names = ["world", *(f"link {i}" for i in range(1, joints + 1))]
    places = [0.0, *sizes[:-1].tolist()]
    return Mechanism(
        f"random arm {seed} of {joints} joints",
        bodies=tuple(
            Body(name, float(m), (0.0, 0.0, float(s) * float(rng.uniform(0.3, 0.7))))
            for name, m, s in zip(names[1:], weights, sizes, strict=True)
        ),
        joints=tuple(
            Joint(f"joint {i + 1}", "revolute", names[i], names[i + 1], (0.0, 0.0, z), axis=tuple(axes[i].tolist()))
            for i, z in enumerate(places)
        ),
    )


GENERATORS: dict[str, Callable[..., Mechanism]] = {"planar-arm": planar_arm, "random-arm": random_arm}


def options(generator: str) -> tuple[str, ...]:
    """What a generator can be asked for."""
    return tuple(signature(GENERATORS[generator]).parameters)

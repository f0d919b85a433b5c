"""Springs as tendons of MJCF, see `mjcf`.

What no tendon's spring is gets an actuator on its tendon that nothing steers: one whose force is a constant and a
multiple of the length where that is the law, else one of the type `user`, whose force is left to `beyond`.
"""

from __future__ import annotations

import warnings
from collections import defaultdict
from xml.etree import ElementTree as ET

import numpy as np

from ..model.elements import Pulley
from ..model.elements.laws import Law
from ..model.errors import EquipoiseWarning
from ..model.mechanism import Mechanism
from .text import numbers


def beyond(mechanism: Mechanism) -> dict[str, Law]:
    """The laws that MJCF cannot hold, by the name of the actuator that stands for each: its force is minus ``pull`` of
    its tendon's length."""
    return {s.name: s.law for s in mechanism.springs if not s.mjcf()[1] and s.mjcf_bias() is None}


def warn(mechanism: Mechanism) -> None:
    """Name the springs whose force MJCF cannot hold."""
    if lost := beyond(mechanism):
        some = ", ".join(f"'{name}' ({law.noun})" for name, law in lost.items())
        message = f"MJCF cannot hold the force of {some}: its tendon is written, and an actuator without a force"
        warnings.warn(message, EquipoiseWarning, stacklevel=3)


def write(tendon: ET.Element, mechanism: Mechanism) -> ET.Element:
    """Fill the tendons; the actuators are returned."""
    actuator = ET.Element("actuator")
    for spring in mechanism.springs:
        tag, values, along = spring.mjcf()
        if not values:
            bias, own = spring.mjcf_bias(), {"biastype": "user"}
            if bias is not None:
                own = {"biastype": "affine", "biasprm": numbers([-bias[0], -bias[1], 0.0])}
            given = {"name": spring.name, "tendon": spring.name, "gaintype": "fixed", "gainprm": "0"}
            ET.SubElement(actuator, "general", {**given, **own})
        attributes = {key: numbers(value) for key, value in values.items()}
        element = ET.SubElement(tendon, tag, {"name": spring.name, **attributes})
        for part, runs in along:
            texts = {key: value if isinstance(value, str) else numbers([value]) for key, value in runs.items()}
            ET.SubElement(element, part, texts)
    return actuator


def wheels(m: Mechanism) -> dict[str, list[tuple[str, Pulley]]]:
    """The pulleys on each body, with their names."""
    found: dict[str, list[tuple[str, Pulley]]] = defaultdict(list)
    for spring in m.springs:
        for mark, pulley in spring.wheels:
            found[pulley.body].append((f"{spring.name}.{mark}", pulley))
    return found


def wheel(body: ET.Element, name: str, pulley: Pulley) -> None:
    """A cylinder that a cable lies on: as wide as its radius to be drawn, endless to the cable."""
    half = 0.5 * pulley.radius * pulley.frame[2]
    ends = np.concatenate([np.subtract(pulley.point, half), np.add(pulley.point, half)])
    ET.SubElement(
        body, "geom", name=name, type="cylinder", size=numbers([pulley.radius]), fromto=numbers(ends.tolist())
    )

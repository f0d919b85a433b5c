"""What the joints of a URDF become together: followers whose limits restrict nobody, and chains of simple joints."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite

from ..model.mechanism import WORLD, Body, Coupling, Joint
from ..model.names import Names
from . import freed
from .notes import Notes
from .urdf_known import label
from .xmltree import XmlElement

SLACK = 1e-6  # [rad or m] of limits that are written with few digits

Links = list[tuple[Body, XmlElement]]
Joints = list[tuple[Joint, XmlElement]]


def unrestricted(joints: Joints, couplings: list[tuple[Coupling, XmlElement]], notes: Notes) -> Joints:
    """The joints, followers without limits of their own where these would restrict the leader."""
    ranges, found = {joint.name: joint.range for joint, _ in joints}, {}
    for coupling, element in couplings:
        (leader, ratio), *_ = coupling.terms
        own, leads = ranges.get(coupling.joint), ranges.get(leader)
        ends = None if leads is None else sorted(ratio * end + coupling.offset for end in leads)
        if own is not None and (ends is None or ends[0] < own[0] - SLACK or ends[1] > own[1] + SLACK):
            found[coupling.joint] = None
            message = "a follower's own limits, which would restrict its leader, are ignored as ROS does"
            notes.note(label(element), message, (element.find("limit") or element).line)
    return [(replace(joint, range=found.get(joint.name, joint.range)), element) for joint, element in joints]


def effort(element: XmlElement, kind: str) -> float | None:
    """What the motor of a joint of this kind can do, by its <limit>: exporters write 0 where nobody knows."""
    limit = element.find("limit")
    try:
        value = float(limit.attributes["effort"]) if limit is not None and kind not in freed.STEPS else 0.0
    except (KeyError, ValueError):
        return None
    return value if value > 0 and isfinite(value) else None


def chained(links: Links, joints: Joints) -> tuple[Links, Joints, list[tuple[str, XmlElement]]]:
    """Links and joints with chains in the place of floating and planar joints, and the names of those that float."""
    names, floating = Names([WORLD, *(body.name for body, _ in links)]), []
    more: Links = []
    found: Joints = []
    for joint, element in joints:
        kind = element.attributes.get("type", "") if element.tag == "joint" else ""
        if joint.type == "fixed" or kind not in freed.STEPS:
            found.append((joint, element))
            continue
        bodies, steps = freed.chain(kind, joint, names)
        more += [(body, element) for body in bodies]
        found += [(step, element) for step in steps]
        floating += [(joint.name, element)] if kind == "floating" else []
    return [*links, *more], found, floating

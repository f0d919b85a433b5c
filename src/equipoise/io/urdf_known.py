"""What a URDF may hold: what `urdf` reads, and what acts on no balance. Everything else is named in a warning."""

from __future__ import annotations

from ..model.errors import Fault, InputError
from .notes import Notes
from .xmltree import Document, XmlElement

CONVERTED = {
    ".xacro": "it has macros in it; expand them first: xacro FILE > robot.urdf",
    ".sdf": "turn it into MJCF first, with sdf2mjcf FILE robot.xml of the package sdformat-mjcf",
}
"""What is no mechanism file but becomes one, and how."""

KNOWN = {
    "robot": {"link", "joint", "loop_joint", "gazebo", "material", "transmission", "ros2_control", "sensor"},
    "link": {"inertial", "visual", "collision", "contact", "self_filter", "collision_checking"},
    "joint": {"parent", "child", "origin", "axis", "limit", "dynamics", "mimic", "calibration", "safety_controller"},
    "loop_joint": {"link1", "link2", "axis"},
    "inertial": {"origin", "mass", "inertia"},
    "dynamics": set[str](),
    "mimic": set[str](),
}
"""Of each element that is read, the elements in it that are read too, or that act on nothing that is judged here."""

ATTRIBUTES = {"dynamics": {"damping", "friction"}, "mimic": {"joint", "multiplier", "offset"}}
"""Of elements whose attributes act, those that are read."""

OFF = "gravity that is switched off is left out: the full weight counts"
GAZEBO = {
    "turnGravityOff": ("false", OFF),
    "gravity": ("true", OFF),
    "joint": ("never", "a simulator's joint is left out: write it as <loop_joint>, or as a loop of a mechanism file"),
}
"""What acts among a simulator's settings: the value with which it does not, and what is said of any other."""
BOOLEANS = {"1": "true", "0": "false"}


def unread(document: Document, notes: Notes) -> None:
    """Name every element and attribute that may act and is not read."""
    reading = [document.root]
    while reading:
        element = reading.pop()
        for child in element.children:
            if child.tag not in KNOWN[element.tag]:
                notes.note(f"<{child.tag}> in {label(element)}", "it is unknown, and not read", child.line)
            elif child.tag == "gazebo":
                _settings(child, notes)
            elif child.tag in KNOWN:
                reading.append(child)
        for key in element.attributes.keys() - ATTRIBUTES.get(element.tag, element.attributes.keys()):
            notes.note(f"{key} of <{element.tag}>", "it is unknown, and not read", element.line)


def _settings(gazebo: XmlElement, notes: Notes) -> None:
    for element in gazebo.children:
        idle, message = GAZEBO.get(element.tag, ("", ""))
        text = words(element).lower()
        if message and BOOLEANS.get(text, text) != idle:
            name = gazebo.attributes.get("reference") or element.attributes.get("name", "")
            notes.note(f"<{element.tag}> of '{name}'", message, element.line)


def words(element: XmlElement) -> str:
    """What stands in an element, or is its value."""
    return "".join(element.texts).strip() or element.attributes.get("value", "")


def refuse_xacro(document: Document) -> None:
    """Refuse a file that has macros in it.

    Raises:
        InputError: it does; says what expands them.
    """
    spaces = {"xacro:"}
    for element in document.root.walk():
        for key, value in element.attributes.items():
            if key.startswith("xmlns:") and "xacro" in value:
                spaces.add(key.removeprefix("xmlns:") + ":")
            elif "${" in value or "$(" in value:
                _xacro(document, element, f"{key}='{short(value)}'")
        if element.tag.startswith(tuple(spaces)):
            _xacro(document, element, f"<{element.tag}>")


def _xacro(document: Document, element: XmlElement, found: str) -> None:
    fault = Fault((), f"found {found}: this is a xacro file; expand it with xacro first (xacro FILE > robot.urdf)")
    raise InputError(document.place(fault, element))


def label(element: XmlElement) -> str:
    """An element as a message names it."""
    name = element.attributes.get("name")
    return f"{element.tag} '{name}'" if name is not None else f"<{element.tag}>"


def short(text: str) -> str:
    """The text, or its beginning."""
    return text if len(text) <= 60 else text[:57] + "..."

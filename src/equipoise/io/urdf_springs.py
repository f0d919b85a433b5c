"""Springs on the joints of a URDF, which a simulator's settings hold: <gazebo reference="joint"><springStiffness>."""

from __future__ import annotations

from ..model.elements import TorsionSpring
from ..model.mechanism import Joint
from .notes import Notes
from .urdf_known import words
from .xmltree import XmlElement

STIFFNESS, REFERENCE = ("springStiffness", "spring_stiffness"), ("springReference", "spring_reference")


def springs(root: XmlElement, joints: list[Joint], notes: Notes) -> tuple[TorsionSpring, ...]:
    """Torsion springs of revolute joints; that of another joint is left out, with a word."""
    types, found = {joint.name: joint.type for joint in joints}, {}
    for settings in root.find_all("gazebo"):
        name, values = settings.attributes.get("reference", ""), dict[str, float]()
        for element in settings.children:
            if element.tag in (*STIFFNESS, *REFERENCE):
                try:
                    values[element.tag] = float(words(element))
                except ValueError:
                    notes.refuse(f"<{element.tag}> of '{name}'", f"is no number: '{words(element)}'", element.line)
        stiffness, rest = (next((values[t] for t in tags if t in values), 0.0) for tags in (STIFFNESS, REFERENCE))
        if stiffness and types.get(name) == "revolute":
            found[name] = TorsionSpring(f"{name} spring", ((name, 1.0),), stiffness, rest)
        elif stiffness:
            notes.note(
                f"spring of '{name}'", "a simulator's spring on what is no turning joint is left out", settings.line
            )
    return tuple(found.values())

"""Write the URDF files of this folder from the package example-robot-data.

    pip download --no-deps example-robot-data==6.0.0, unpack the wheel, then
    python make.py .../share/example-robot-data/robots

Only what balancing needs is kept, as it is written upstream: names, mass, com, inertia, joint frames, axes, limits and
mimics. Meshes, colours, collision shapes, transmissions and simulator settings are dropped.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

KEEP = {
    "robot": ("link", "joint"),
    "link": ("inertial",),
    "inertial": ("origin", "mass", "inertia"),
    "joint": ("origin", "parent", "child", "axis", "limit", "mimic"),
}
"""The children that an element keeps, in the order they are written; the order inside a robot is the file's."""

ATTRIBUTES = {
    "robot": ("name",),
    "link": ("name",),
    "joint": ("name", "type"),
    "origin": ("xyz", "rpy"),
    "mass": ("value",),
    "inertia": ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"),
    "parent": ("link",),
    "child": ("link",),
    "axis": ("xyz",),
    "limit": ("lower", "upper", "effort", "velocity"),
    "mimic": ("joint", "multiplier", "offset"),
}


@dataclass(frozen=True)
class Source:
    """Where a robot comes from: a path in the package, the origin its README names, and the licence."""

    path: str
    upstream: str
    licence: str


SOURCES = {
    "ur5": Source(
        "ur_description/urdf/ur5_robot.urdf",
        "https://github.com/ros-industrial/universal_robot/tree/kinetic-devel/ur_description",
        "BSD",
    ),
    "ur10": Source(
        "ur_description/urdf/ur10_robot.urdf",
        "https://github.com/ros-industrial/universal_robot/tree/kinetic-devel/ur_description",
        "BSD",
    ),
    "panda": Source(
        "panda_description/urdf/panda.urdf",
        "https://github.com/frankaemika/franka_ros/tree/noetic-devel/franka_description",
        "Apache-2.0",
    ),
    "xarm7": Source("xarm_description/urdf/xarm7.urdf", "https://github.com/xArm-Developer/xarm_ros2", "BSD-3-Clause"),
    "human": Source("human_description/robots/human.urdf", "original work by Gepetto Team members", "BSD-2-Clause"),
}


def strip(element: ET.Element) -> ET.Element:
    """A copy of an element with only what `KEEP` and `ATTRIBUTES` list."""
    attributes = {
        key: " ".join(element.attrib[key].split()) for key in ATTRIBUTES.get(element.tag, ()) if key in element.attrib
    }
    copy = ET.Element(element.tag, attributes)
    keep = KEEP.get(element.tag, ())
    children = [child for child in element if child.tag in keep]
    if element.tag != "robot":
        children.sort(key=lambda child: keep.index(child.tag))
    copy.extend(strip(child) for child in children)
    return copy


def text(robot: ET.Element, source: Source, version: str) -> str:
    """The stripped robot as text, with a comment that says where it comes from."""
    robot = strip(robot)
    ET.indent(robot)
    comment = (
        f"<!--\n  Kinematic and inertial numbers only, written by make.py.\n"
        f"  Source:   example-robot-data {version}, {source.path}\n"
        f"  Upstream: {source.upstream}\n"
        f"  Licence:  {source.licence}\n-->\n"
    )
    return '<?xml version="1.0" encoding="utf-8"?>\n' + comment + ET.tostring(robot, encoding="unicode") + "\n"


def main(robots: Path) -> None:
    """Write every robot beside this script; `robots` is the folder of that name in the package."""
    version = ET.parse(robots.parent / "package.xml").getroot().findtext("version", "")
    for name, source in SOURCES.items():
        robot = ET.parse(robots / source.path).getroot()
        target = Path(__file__).parent / f"{name}.urdf"
        target.write_text(text(robot, source, version), encoding="utf-8", newline="\n")
        print(target.name)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: make.py FOLDER (share/example-robot-data/robots of the package example-robot-data)")
    main(Path(sys.argv[1]))

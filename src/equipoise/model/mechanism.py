"""The mechanism: frozen values, with everything checked when it is made.

Conventions (Drake's monogram notation): `p_AP` is the position of P in frame A, `R_WB` the rotation of body B in
the world W. Lengths in m, angles in rad, masses in kg. A joint's child frame sits at `xyz`, `rpy` in the parent frame
when its coordinate is zero, and moves about (or along) `axis`, given in the child frame: URDF's convention.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import inf
from typing import Any, Literal, get_args

from .coordinate import Coordinate, Slide
from .elements import Element, Vec3
from .errors import Fault, InputError, finite
from .goal import BY_DEFAULT, Goal
from .immutable import immutable
from .region import Attachment
from .validate import faults

WORLD = "world"
JointType = Literal["fixed", "revolute", "prismatic", "spherical", "parallelogram"]
JOINT_TYPES: tuple[str, ...] = get_args(JointType)
ShapeKind = Literal["box", "cylinder", "ellipsoid", "mesh"]
SHAPES: tuple[str, ...] = get_args(ShapeKind)
SINGLE = ("revolute", "prismatic")  # the joints with one coordinate: only these have an axis, a range, a coupling
MOVING = (*SINGLE, "spherical")  # the joints that have coordinates of their own


@dataclass(frozen=True)
class Body:
    """A rigid body. `com` [m] in the body frame; `inertia` (ixx, iyy, izz, ixy, ixz, iyz) [kg m^2] about the com.

    The products are the entries of the inertia matrix (URDF's sign), not the positive integrals.
    """

    name: str
    mass: float = 0.0
    com: Vec3 = (0.0, 0.0, 0.0)
    inertia: tuple[float, float, float, float, float, float] | None = None


@dataclass(frozen=True)
class Joint:
    """A joint from `parent` to `child`.

    Attributes:
        type: fixed, revolute, prismatic, spherical (three rotations, about x, then the new y, then the new z) or
            parallelogram (the child's origin is carried by the parent, its orientation is that of `follows`).
        xyz, rpy: the child frame in the parent frame at zero [m, rad]; rpy is roll, pitch, yaw about fixed axes. For a
            parallelogram, rpy is the child's orientation in the frame of `follows`.
        axis: of a revolute or prismatic joint, in the child frame; any length but zero.
        range: (lower, upper) [rad or m] of a revolute or prismatic joint; None is unlimited.
        damping, friction: of a joint that moves, about each axis: torque per rate [N m s/rad or N s/m], and dry
            friction [N m or N]. They hold and slow; balance does not count on them.
        effort: [N m or N] what its motor can do about each axis; None where it is not known.
        torque_constant, resistance: of that motor, seen from the joint: torque per current [N m/A or N/A], and [ohm].
    """

    name: str
    type: JointType
    parent: str
    child: str
    xyz: Vec3 = (0.0, 0.0, 0.0)
    rpy: Vec3 = (0.0, 0.0, 0.0)
    axis: Vec3 = (1.0, 0.0, 0.0)
    range: tuple[float, float] | None = None
    follows: str | None = None
    damping: float = 0.0
    friction: float = 0.0
    effort: float | None = None
    torque_constant: float | None = None
    resistance: float | None = None

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """Its own, coupled or not; a spherical joint has three: name.x, name.y and name.z."""
        if self.type == "spherical":
            return tuple(Coordinate(f"{self.name}.{letter}") for letter in "xyz")
        if self.type == "prismatic":
            return (Slide(self.name),)
        return (Coordinate(self.name),) if self.type == "revolute" else ()


@dataclass(frozen=True)
class Coupling:
    """A dependent joint: its coordinate is ``offset + sum(ratio * coordinate of the named joint)``."""

    joint: str
    terms: tuple[tuple[str, float], ...]
    offset: float = 0.0


@dataclass(frozen=True)
class Loop:
    """A loop closure: point `p_a` of `body_a` coincides with `p_b` of `body_b` [m]; two axes make it a hinge."""

    body_a: str
    p_a: Vec3
    body_b: str
    p_b: Vec3
    axis_a: Vec3 | None = None
    axis_b: Vec3 | None = None


@dataclass(frozen=True)
class PointMass:
    """A payload or counterweight: `mass` [kg] at `position` [m] in the frame of `body`."""

    name: str
    body: str
    mass: float
    position: Vec3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Capsule:
    """The space a link takes: everything within `radius` of the segment `p_a`, `p_b` in the frame of `body` [m]."""

    name: str
    body: str
    p_a: Vec3
    p_b: Vec3
    radius: float


@dataclass(frozen=True)
class Shape:
    """The space a link takes, where it is no capsule.

    Attributes:
        kind: box, cylinder (along z), ellipsoid or mesh, each about its own origin; a mesh as its file has it.
        size: from side to side along its own axes [m]; of a cylinder the first two are its diameter. Not of a mesh.
        xyz, rpy: its place and orientation in the frame of `body` [m, rad].
        file: of a mesh.
        scale: by which a mesh's numbers become m, along its axes.
    """

    name: str
    body: str
    kind: ShapeKind
    size: Vec3 = (0.0, 0.0, 0.0)
    xyz: Vec3 = (0.0, 0.0, 0.0)
    rpy: Vec3 = (0.0, 0.0, 0.0)
    file: str = ""
    scale: Vec3 = (1.0, 1.0, 1.0)

    def faults(self) -> Iterator[Fault]:
        """What is wrong with it, paths from it on; its name and its body are checked with all others."""
        yield from finite(("xyz",), self.xyz)
        yield from finite(("rpy",), self.rpy)
        yield from finite(("scale",), self.scale)
        if self.kind == "mesh":
            if not self.file:
                yield Fault(("file",), "missing: a mesh needs it")
            return
        for length in self.size:
            if not 0 < length < inf:
                yield Fault(("size",), f"must be more than 0 m along each axis, found {length:g} m")
                return
        if self.kind == "cylinder" and self.size[0] != self.size[1]:
            yield Fault(("size",), "of a cylinder must be [diameter, diameter, length]")


@dataclass(frozen=True)
class Workspace:
    """Where approximate balance is judged: `samples` random poses inside the joint ranges."""

    samples: int = 4096


@dataclass(frozen=True)
class Mechanism:
    """Bodies, joints and what acts on them. Immutable; equal when all values are equal.

    Attributes:
        provenance: how it was made, as a file says it: text, numbers, None, lists and mappings, all made immutable.
        independent: of a mechanism with loops, the coordinates that determine the others; chosen by itself when empty.
        assembly: coordinate values [rad or m] near a pose in which the loops close.
        attachments: where springs may be attached when they are designed; of other bodies nothing is said.
        goal: what it is designed for; by itself it changes nothing.

    Raises:
        InputError: with one `Fault` for every inconsistency (see `validate.faults`).
    """

    name: str
    bodies: tuple[Body, ...] = ()
    joints: tuple[Joint, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    loops: tuple[Loop, ...] = ()
    springs: tuple[Element, ...] = ()
    masses: tuple[PointMass, ...] = ()
    gravity: Vec3 = (0.0, 0.0, -9.81)
    workspace: Workspace = Workspace()
    provenance: Mapping[str, Any] = field(default_factory=dict, hash=False)
    independent: tuple[str, ...] = ()
    assembly: tuple[tuple[str, float], ...] = ()
    capsules: tuple[Capsule, ...] = ()
    attachments: tuple[Attachment, ...] = ()
    goal: Goal = field(default=BY_DEFAULT, hash=False)
    shapes: tuple[Shape, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "provenance", immutable(self.provenance))
        found = faults(self)
        if found:
            raise InputError(found)

    @property
    def body_names(self) -> tuple[str, ...]:
        """World first, then the bodies in the file's order."""
        return (WORLD, *(body.name for body in self.bodies))

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """What couplings leave free, in the file's order: names that know their units.

        Loops make some of these depend on the others: `Tree.of(mechanism).coordinates` are the independent ones.
        """
        dependent = {coupling.joint for coupling in self.couplings}
        return tuple(c for joint in self.joints if joint.name not in dependent for c in joint.coordinates)

    def with_springs(self, springs: Iterable[Element]) -> Mechanism:
        """A copy with these springs instead of its own."""
        return replace(self, springs=tuple(springs))

    def with_masses(self, masses: Iterable[PointMass]) -> Mechanism:
        """A copy with these point masses instead of its own."""
        return replace(self, masses=tuple(masses))

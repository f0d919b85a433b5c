"""Read MJCF through MuJoCo's own compiler (extra `sim`): its defaults, includes and frames mean what they mean there.

What becomes what, where the two differ:

- A body with several joints becomes a chain of massless bodies; a joint off its body's origin, a fixed joint more.
- A free body becomes a chain of three slides and a ball where loops or springs hold it, fixed where a weld does.
- A spatial tendon with a stiffness, between two sites, is a spring. A spring length that is not given is the tendon's
  length in the reference pose: the compiler says so. A slack range, wrapping and pulleys are refused.
- A linear equality between joints, or of a fixed tendon held at a length, is a coupling; a joint held alone is locked.
- A connect is a loop; two connects between the same bodies make a hinge loop. A weld is a hinge loop and a point more.
- A hinge's stiffness, and a fixed tendon's along hinges, is a torsion spring.
- A massless leaf of a body with nothing but a mass in one point is a point mass.
- What has a name or may touch something is the space that its body takes: see `mjcf_shapes`.
- Loops close as in the keyframe "assembled", else as in the reference pose or the first keyframe that closes them;
  joints with an actuator steer them where that can be.

Other geometry, contacts, sensors and armature do not act on statics, and what actuators do is what is asked for: they
are skipped. What else acts is named, or refused by name: see `mjcf_acts`.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

import os
from dataclasses import replace
from typing import Literal

import numpy as np

from ..model.arrays import Array, vec3
from ..model.errors import Fault, InputError
from ..model.mechanism import SINGLE, WORLD, Body, Joint, JointType, Mechanism, PointMass
from ..model.names import Names
from ..model.rotation import about, from_quaternion, to_rpy
from ..model.validate import LARGEST_COUNTS
from . import files, freed
from .mjcf_acts import Model
from .mjcf_between import Between, Places
from .mjcf_compile import compiled
from .mjcf_pose import assembly, independent, joint_values
from .mjcf_shapes import with_shapes
from .notes import Notes
from .xmltree import lines

MASSLESS = 1e-12  # [kg] what the compiler is told to put in the place of nothing
NO_INERTIA = 1e-11  # [kg m^2] likewise


def read(path: str | os.PathLike[str], base: str | None = None) -> Mechanism:
    """Read an MJCF file.

    Args:
        base: "fixed" holds every free body where it is drawn, "free" lets those be free that nothing holds.

    Raises:
        InputError: the engine is missing, does not compile the file (with its reason), or the file has something that
            acts on statics and cannot be expressed; everything of that kind is named at once.

    Warns:
        EquipoiseWarning: for each kind of thing that acts and is left out, and each flag that is heeded.
    """
    name = os.fspath(path)
    model = compiled(name)
    import mujoco

    if model.nbody > LARGEST_COUNTS["bodies"]:
        raise InputError(
            Fault((), f"has {model.nbody - 1:,} bodies, at most {LARGEST_COUNTS['bodies']} are read", file=name)
        )
    notes = Notes(name)
    reader = _Reader(Model(mujoco, model, notes, lines(files.read_text(name), name)), base)
    try:
        mechanism = reader.mechanism()
    except InputError as error:
        raise InputError([*notes.faults, *(fault.at(name) for fault in error.faults)]) from None
    notes.close()
    return mechanism


TYPES: dict[str, JointType | Literal["floating"]] = {
    "mjJNT_HINGE": "revolute",
    "mjJNT_SLIDE": "prismatic",
    "mjJNT_BALL": "spherical",
    "mjJNT_FREE": "floating",
}


class _Reader:
    def __init__(self, source: Model, base: str | None) -> None:
        self.source, self.mj, self.model, self.base = source, source.mj, source.model, base
        self.bodies: list[Body] = []
        self.joints: list[Joint] = []
        self.masses: list[PointMass] = []
        self._names, self._joint_names = Names([WORLD]), Names()
        self.joint_of: dict[int, str] = {}  # the engine's number -> our name
        self.place: Places = {0: (WORLD, np.zeros(3))}

    def mechanism(self) -> Mechanism:
        model, source = self.model, self.source
        source.say()
        leaves = set(range(1, model.nbody)) - {int(parent) for parent in model.body_parentid[1:]}
        between = Between(source, self.place, self.joint_of)
        self.held = between.held()
        for b in range(1, model.nbody):
            self._body(b, b in leaves)
        couplings, locked = between.couplings()
        loops, springs = between.loops(self.held), between.springs()
        joints = tuple(replace(j, range=(locked[j.name],) * 2) if j.name in locked else j for j in self.joints)
        if source.notes.faults:
            return Mechanism("")
        found = Mechanism(
            model.names[: model.names.index(b"\0")].decode() or "mechanism", tuple(self.bodies), joints, couplings,
            loops, springs, tuple(self.masses), (0.0, 0.0, 0.0) if source.off("gravity") else vec3(model.opt.gravity),
        )  # fmt: skip
        found = with_shapes(found, self.mj, model, self.place, source.notes)
        for j, name in self.joint_of.items():
            if self._type(j) == "floating" and self.base is None and not freed.held(found, name):
                source.refuse("joint", j, freed.FREE)
        if not loops:
            return found
        pose, J = assembly(source)
        found = replace(found, assembly=self._values(found, pose))
        return replace(found, independent=independent(source, found, self.joint_of, J))

    def _values(self, found: Mechanism, pose: Array) -> tuple[tuple[str, float], ...]:
        """The values of our coordinates where the engine's are `pose` (nq,)."""
        values = {}
        for j, name in self.joint_of.items():
            at = int(self.model.jnt_qposadr[j])
            values |= joint_values(self._type(j), name, pose[at : at + 7], self.model.qpos0[at : at + 7])
        return tuple((name, values[name]) for name in found.coordinates)

    def _type(self, j: int) -> JointType | Literal["floating"]:
        return TYPES[str(self.mj.mjtJoint(int(self.model.jnt_type[j])).name)]

    def _body(self, b: int, leaf: bool) -> None:
        model = self.model
        name = self._names.new(self.source.name("body", b) or f"body {b}")
        parent, origin = self.place[int(model.body_parentid[b])]
        position, R = origin + model.body_pos[b], from_quaternion(model.body_quat[b])
        mass, com = float(model.body_mass[b]), model.body_ipos[b]
        axes = from_quaternion(model.body_iquat[b])
        inertia = axes @ np.diag(model.body_inertia[b]) @ axes.T
        first, count = int(model.body_jntadr[b]), int(model.body_jntnum[b])
        if leaf and not count and mass > MASSLESS and np.abs(inertia).max() <= NO_INERTIA and not self._used(b):
            self.masses.append(PointMass(name, parent, mass, vec3(position + R @ com)))
            self.place[b] = parent, position
            return
        at = np.zeros(3)  # the present body's origin, in the frame of `name` as it is before its joints
        turn = R
        shift = position
        for j in range(first, first + count):
            last = j == first + count - 1
            anchor = model.jnt_pos[j]
            child = name if last and np.allclose(anchor, 0) else self._names.new(f"{name}, joint {j - first + 1}")
            turn = self._joint(j, parent, child, shift + turn @ (anchor - at), turn)
            if child != name:
                self.bodies.append(Body(child))
            parent, shift, turn, at = child, np.zeros(3), np.eye(3), anchor
        if not count or parent != name:
            held = self._joint_names.new(f"{name} weld")
            self.joints.append(Joint(held, "fixed", parent, name, vec3(shift + turn @ -at), to_rpy(turn)))
        self.place[b] = name, np.zeros(3)
        i = inertia if np.abs(inertia).max() > NO_INERTIA else np.zeros((3, 3))
        mass = mass if mass > MASSLESS else 0.0
        full = (i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2])
        self.bodies.append(
            Body(name, mass, vec3(com) if mass else (0.0, 0.0, 0.0), tuple(float(x) for x in full) if mass else None)  # type: ignore[arg-type]
        )

    def _joint(self, j: int, parent: str, child: str, shift: Array, turn: Array) -> Array:
        """Add a joint; gives the orientation that is left for the next one: none."""
        model = self.model
        name = self._joint_names.new(self.source.name("joint", j) or f"joint {j}")
        kind = self._type(j)
        if kind == "floating" and (j in self.held or self.base == "fixed"):
            _, R, p = self.held.get(j, (0, turn, shift))
            self.joints.append(Joint(name, "fixed", parent, child, vec3(p), to_rpy(R)))
            return np.eye(3)
        self.joint_of[j] = name
        first, dof = int(model.jnt_qposadr[j]), int(model.jnt_dofadr[j])
        axis, zero = model.jnt_axis[j], float(model.qpos0[first])
        if kind == "revolute" and zero:  # drawn at its reference angle, zero is elsewhere
            turn = turn @ about(axis, np.array([-zero]))[0]
        if kind == "prismatic" and zero:
            shift = shift - turn @ axis * zero
        limited = model.jnt_limited[j] and kind in SINGLE and not self.source.off("limit", "constraint")
        if model.jnt_limited[j] and kind not in SINGLE:
            self.source.note("joint", j, "limits of a ball joint are left out")
        limits = (float(model.jnt_range[j, 0]), float(model.jnt_range[j, 1])) if limited else None
        resists = float(model.dof_damping[dof]), float(model.dof_frictionloss[dof])
        made = Joint(name, "spherical" if kind == "floating" else kind, parent, child, vec3(shift), to_rpy(turn),
                     range=limits, damping=resists[0], friction=resists[1],
                     effort=self.source.effort(j) if kind in SINGLE else None)  # fmt: skip
        if kind == "floating":
            bodies, joints = freed.chain(kind, made, self._names)
            self.bodies += bodies
            self.joints += joints
        else:
            self.joints.append(replace(made, axis=vec3(axis)) if kind in SINGLE else made)
        return np.eye(3)

    def _used(self, b: int) -> bool:
        """Whether a site of the body is the end of a tendon or of an equality, or the body itself is."""
        model = self.model
        body, site = int(self.mj.mjtObj.mjOBJ_BODY), int(self.mj.mjtObj.mjOBJ_SITE)
        for i in range(model.neq):
            ends = (int(model.eq_obj1id[i]), int(model.eq_obj2id[i]))
            if model.eq_objtype[i] == body and b in ends:
                return True
            if model.eq_objtype[i] == site and b in [int(model.site_bodyid[s]) for s in ends]:
                return True
        sites = [int(s) for s, t in zip(model.wrap_objid, model.wrap_type, strict=True)
                 if t == int(self.mj.mjtWrap.mjWRAP_SITE)]  # fmt: skip
        return any(int(model.site_bodyid[s]) == b for s in sites)

"""Read MJCF through MuJoCo's own compiler (extra `sim`): its defaults, includes and frames mean what they mean there.

What becomes what, where the two differ:

- A body with several joints becomes a chain of massless bodies; a joint off its body's origin, a fixed joint more.
- A spatial tendon with a stiffness, between two sites, is a spring. A spring length that is not given is the tendon's
  length in the reference pose: the compiler says so. A slack range, wrapping and pulleys are refused.
- A linear equality between joints, or of a fixed tendon held at a length, is a coupling; a joint held alone is locked.
- A connect is a loop; two connects between the same bodies make a hinge loop, a third one is refused as a weld is.
- A hinge's stiffness, and a fixed tendon's along hinges, is a torsion spring.
- A massless leaf of a body with nothing but a mass in one point is a point mass.

- A capsule or sphere with a name is the space that its body takes. The keyframe "assembled" says how loops close.

Other geometry, contacts, actuators, sensors and armature do not act on statics and are skipped. What acts and has no
counterpart (free joints, springs of slides and balls, gravity compensation, curved equalities) is refused by name.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

import os
from dataclasses import replace
from typing import Any

import numpy as np

from ..model.arrays import Array
from ..model.errors import Fault, InputError
from ..model.mechanism import WORLD, Body, Capsule, Joint, JointType, Mechanism, PointMass
from ..model.rotation import about, ball_angles, from_quaternion, to_rpy
from ..model.validate import MOST
from . import mjcf
from .mjcf_between import Between, Places, vec3
from .mjcf_compile import compiled
from .text import Names

MASSLESS = 1e-12  # [kg] what the compiler is told to put in the place of nothing
NOTHING = 1e-11  # [kg m^2] likewise


def read(path: str | os.PathLike[str]) -> Mechanism:
    """Read an MJCF file.

    Raises:
        InputError: the engine is missing, does not compile the file (with its reason), or the file has something that
            acts on statics and cannot be expressed; everything of that kind is named at once.
    """
    name = os.fspath(path)
    model = compiled(name)
    import mujoco

    if model.nbody > MOST["bodies"]:
        raise InputError(Fault((), f"has {model.nbody - 1:,} bodies, at most {MOST['bodies']} are read", file=name))
    reader = _Reader(mujoco, model)
    try:
        mechanism = reader.mechanism()
    except InputError as error:
        raise InputError([fault.at(name) for fault in error.faults]) from None
    if reader.faults:
        raise InputError([Fault((), problem, file=name) for problem in reader.faults])
    return mechanism


class _Reader:
    def __init__(self, mj: Any, model: Any) -> None:
        self.mj, self.model = mj, model
        self.faults: list[str] = []
        self.bodies: list[Body] = []
        self.joints: list[Joint] = []
        self.masses: list[PointMass] = []
        self._names, self._joint_names = Names([WORLD]), Names()
        self.joint_of: dict[int, str] = {}  # the engine's number -> our name
        self.place: Places = {0: (WORLD, np.zeros(3))}

    def mechanism(self) -> Mechanism:
        model = self.model
        leaves = set(range(1, model.nbody)) - {int(parent) for parent in model.body_parentid[1:]}
        for b in range(1, model.nbody):
            self._body(b, b in leaves)
        between = Between(self.mj, model, self.place, self.joint_of, self.faults)
        couplings, locked = between.couplings()
        loops, springs = between.loops(), between.springs()
        if self.faults:
            return Mechanism("")
        joints = tuple(replace(j, range=(locked[j.name],) * 2) if j.name in locked else j for j in self.joints)
        found = Mechanism(
            model.names[: model.names.index(b"\0")].decode() or "mechanism", tuple(self.bodies), joints, couplings,
            loops, springs, tuple(self.masses), vec3(model.opt.gravity), capsules=self._capsules(),
        )  # fmt: skip
        return replace(found, independent=self._independent(), assembly=self._assembly(found)) if loops else found

    def _independent(self) -> tuple[str, ...]:
        model = self.model
        for i in range(model.ntext):
            if self.mj.mj_id2name(model, int(self.mj.mjtObj.mjOBJ_TEXT), i) == mjcf.INDEPENDENT:
                first, size = int(model.text_adr[i]), int(model.text_size[i])
                return tuple(model.text_data[first : first + size].rstrip(b"\0").decode().split("\n"))
        return ()

    def _assembly(self, found: Mechanism) -> tuple[tuple[str, float], ...]:
        """The values of our coordinates in the keyframe."""
        mj, model = self.mj, self.model
        key = mj.mj_name2id(model, int(mj.mjtObj.mjOBJ_KEY), mjcf.ASSEMBLED)
        if key < 0:
            return ()
        values = {}
        for j, name in self.joint_of.items():
            at = int(model.jnt_qposadr[j])
            if int(model.jnt_type[j]) == int(mj.mjtJoint.mjJNT_BALL):
                angles = ball_angles(from_quaternion(model.key_qpos[key, at : at + 4]))
                values |= {f"{name}.{letter}": x for letter, x in zip("xyz", angles, strict=True)}
            else:
                values[name] = float(model.key_qpos[key, at])
        return tuple((name, values[name]) for name in found.coordinates)

    def _capsules(self) -> tuple[Capsule, ...]:
        mj, model, found = self.mj, self.model, []
        for g in range(model.ngeom):
            kind, name = int(model.geom_type[g]), model.geom(g).name
            if not name or kind not in (int(mj.mjtGeom.mjGEOM_CAPSULE), int(mj.mjtGeom.mjGEOM_SPHERE)):
                continue
            radius, half = (float(x) for x in model.geom_size[g, :2])
            body, origin = self.place[int(model.geom_bodyid[g])]
            half = half if kind == int(mj.mjtGeom.mjGEOM_CAPSULE) else 0.0
            reach = half * from_quaternion(model.geom_quat[g])[:, 2]
            p_a, p_b = (vec3(origin + model.geom_pos[g] + sign * reach) for sign in (1, -1))
            found.append(Capsule(name, body, p_a, p_b, radius))
        return tuple(found)

    def _body(self, b: int, leaf: bool) -> None:
        model = self.model
        name = self._names.new(model.body(b).name or f"body {b}")
        parent, origin = self.place[int(model.body_parentid[b])]
        position, R = origin + model.body_pos[b], from_quaternion(model.body_quat[b])
        if model.body_gravcomp[b]:
            self.faults.append(f"body '{name}' has gravity compensation: leave that to springs, or to a counterweight")
        mass, com = float(model.body_mass[b]), model.body_ipos[b]
        axes = from_quaternion(model.body_iquat[b])
        inertia = axes @ np.diag(model.body_inertia[b]) @ axes.T
        first, count = int(model.body_jntadr[b]), int(model.body_jntnum[b])
        if leaf and not count and mass > MASSLESS and np.abs(inertia).max() <= NOTHING and not self._used(b):
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
        i = inertia if np.abs(inertia).max() > NOTHING else np.zeros((3, 3))
        mass = mass if mass > MASSLESS else 0.0
        full = (i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2])
        self.bodies.append(
            Body(name, mass, vec3(com) if mass else (0.0, 0.0, 0.0), tuple(float(x) for x in full) if mass else None)  # type: ignore[arg-type]
        )

    def _joint(self, j: int, parent: str, child: str, shift: Array, turn: Array) -> Array:
        """Add a joint; gives the orientation that is left for the next one: none."""
        mj, model = self.mj, self.model
        name = self._joint_names.new(model.joint(j).name or f"joint {j}")
        self.joint_of[j] = name
        kind = int(model.jnt_type[j])
        types: dict[int, JointType] = {
            int(mj.mjtJoint.mjJNT_HINGE): "revolute",
            int(mj.mjtJoint.mjJNT_SLIDE): "prismatic",
            int(mj.mjtJoint.mjJNT_BALL): "spherical",
        }
        if kind not in types:
            self.faults.append(f"joint '{name}' is free: a mechanism that is not held falls; weld it to the world")
            return turn
        if model.jnt_stiffness[j] and types[kind] != "revolute":
            self.faults.append(f"joint '{name}' has a spring (stiffness): only that of a hinge is known, torsion")
        axis, zero = model.jnt_axis[j], float(model.qpos0[model.jnt_qposadr[j]])
        if types[kind] == "revolute" and zero:  # drawn at its reference angle, zero is elsewhere
            turn = turn @ about(axis, np.array([-zero]))[0]
        if types[kind] == "prismatic" and zero:
            shift = shift - turn @ axis * zero
        limits = (float(model.jnt_range[j, 0]), float(model.jnt_range[j, 1])) if model.jnt_limited[j] else None
        held = float(model.dof_damping[model.jnt_dofadr[j]]), float(model.dof_frictionloss[model.jnt_dofadr[j]])
        found = Joint(name, types[kind], parent, child, vec3(shift), to_rpy(turn), damping=held[0], friction=held[1])
        if types[kind] != "spherical":
            found = replace(found, axis=vec3(axis), range=limits)
        self.joints.append(found)
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

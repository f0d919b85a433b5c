"""Read MJCF through MuJoCo's own compiler (extra `sim`): its defaults, includes and frames mean what they mean there.

What becomes what, where the two differ:

- A body with several joints becomes a chain of massless bodies; a joint off its body's origin, a fixed joint more.
- A spatial tendon with a stiffness, between two sites, is a spring. A spring length that is not given is the tendon's
  length in the reference pose: the compiler says so. A slack range, wrapping and pulleys are refused.
- A linear equality between joints, or of a fixed tendon held at a length, is a coupling; a joint held alone is locked.
- A connect is a loop; two connects between the same bodies make a hinge loop, a third one is refused as a weld is.
- A massless leaf of a body with nothing but a mass in one point is a point mass.

Geometry, contacts, actuators, sensors, damping and armature do not act on statics and are skipped. What acts and has no
counterpart (free joints, joint springs, gravity compensation, curved equalities) is refused by name.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

import os
from collections import defaultdict
from dataclasses import replace
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import Fault, InputError
from ..mechanism import WORLD, Body, Coupling, Joint, JointType, Loop, Mechanism, PointMass
from ..rotation import about, to_rpy
from ..spring import Spring, Vec3
from . import files
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
    files.read_text(name)  # a missing, empty or huge file is said as of every other kind
    try:
        import mujoco
    except ImportError:
        message = "an MJCF file is read through MuJoCo, which comes with: pip install 'equipoise[sim]'"
        raise InputError(Fault((), message, file=name)) from None
    try:
        model = mujoco.MjModel.from_xml_path(name)
    except ValueError as error:
        reason = " ".join(str(error).split()).removeprefix("Error: ")
        raise InputError(Fault((), f"MuJoCo does not compile it: {reason}", file=name)) from None
    reader = _Reader(mujoco, model)
    mechanism = reader.mechanism()
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
        # a body of the engine: which body of ours has its frame, and where its origin is there (a point mass has none)
        self.place: dict[int, tuple[str, Array]] = {0: (WORLD, np.zeros(3))}

    def mechanism(self) -> Mechanism:
        model = self.model
        leaves = set(range(1, model.nbody)) - {int(parent) for parent in model.body_parentid[1:]}
        for b in range(1, model.nbody):
            self._body(b, b in leaves)
        couplings, locked = self._couplings()
        loops, springs = self._loops(), self._springs()
        if self.faults:
            return Mechanism("")
        joints = tuple(replace(j, range=(locked[j.name],) * 2) if j.name in locked else j for j in self.joints)
        name = model.names[: model.names.index(b"\0")].decode() or "mechanism"
        bodies, masses, gravity = tuple(self.bodies), tuple(self.masses), _vec3(model.opt.gravity)
        return Mechanism(name, bodies, joints, couplings, loops, springs, masses, gravity)

    def _body(self, b: int, leaf: bool) -> None:
        model = self.model
        name = self._names.new(model.body(b).name or f"body {b}")
        parent, origin = self.place[int(model.body_parentid[b])]
        position, R = origin + model.body_pos[b], _matrix(model.body_quat[b])
        if model.body_gravcomp[b]:
            self.faults.append(f"body '{name}' has gravity compensation: leave that to springs, or to a counterweight")
        mass, com = float(model.body_mass[b]), model.body_ipos[b]
        axes = _matrix(model.body_iquat[b])
        inertia = axes @ np.diag(model.body_inertia[b]) @ axes.T
        first, count = int(model.body_jntadr[b]), int(model.body_jntnum[b])
        if leaf and not count and mass > MASSLESS and np.abs(inertia).max() <= NOTHING and not self._used(b):
            self.masses.append(PointMass(name, parent, mass, _vec3(position + R @ com)))
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
            self.joints.append(Joint(held, "fixed", parent, name, _vec3(shift + turn @ -at), to_rpy(turn)))
        self.place[b] = name, np.zeros(3)
        i = inertia if np.abs(inertia).max() > NOTHING else np.zeros((3, 3))
        mass = mass if mass > MASSLESS else 0.0
        full = (i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2])
        self.bodies.append(
            Body(name, mass, _vec3(com) if mass else (0.0, 0.0, 0.0), tuple(float(x) for x in full) if mass else None)  # type: ignore[arg-type]
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
        if model.jnt_stiffness[j]:
            self.faults.append(
                f"joint '{name}' has a torsion spring (stiffness): only springs between points are known"
            )
        axis, zero = model.jnt_axis[j], float(model.qpos0[model.jnt_qposadr[j]])
        if types[kind] == "revolute" and zero:  # drawn at its reference angle, zero is elsewhere
            turn = turn @ about(axis, np.array([-zero]))[0]
        if types[kind] == "prismatic" and zero:
            shift = shift - turn @ axis * zero
        limits = (float(model.jnt_range[j, 0]), float(model.jnt_range[j, 1])) if model.jnt_limited[j] else None
        if types[kind] == "spherical":
            self.joints.append(Joint(name, "spherical", parent, child, _vec3(shift), to_rpy(turn)))
        else:
            self.joints.append(
                Joint(name, types[kind], parent, child, _vec3(shift), to_rpy(turn), _vec3(axis), limits)
            )  # fmt: skip
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

    def _point(self, site: int) -> tuple[str, Vec3]:
        body, origin = self.place[int(self.model.site_bodyid[site])]
        return body, _vec3(origin + self.model.site_pos[site])

    def _couplings(self) -> tuple[tuple[Coupling, ...], dict[str, float]]:
        mj, model = self.mj, self.model
        found: list[Coupling] = []
        locked: dict[str, float] = {}
        for i in range(model.neq):
            kind, name = int(model.eq_type[i]), model.eq(i).name or f"equality {i}"
            a, b, c = int(model.eq_obj1id[i]), int(model.eq_obj2id[i]), model.eq_data[i, :5]
            joint, tendon = int(mj.mjtEq.mjEQ_JOINT), int(mj.mjtEq.mjEQ_TENDON)
            if kind not in (joint, tendon) or not model.eq_active0[i]:
                continue
            if np.any(c[2:]):
                self.faults.append(f"equality '{name}' is curved (polycoef): a coupling is linear")
            elif kind == joint:
                zero = [float(model.qpos0[model.jnt_qposadr[j]]) if j >= 0 else 0.0 for j in (a, b)]
                if b < 0:
                    locked[self.joint_of[a]] = float(c[0]) + zero[0]
                else:
                    offset = float(c[0]) + zero[0] - float(c[1]) * zero[1]
                    found.append(Coupling(self.joint_of[a], ((self.joint_of[b], float(c[1])),), offset))
            elif b >= 0 or int(model.wrap_type[model.tendon_adr[a]]) != int(mj.mjtWrap.mjWRAP_JOINT):
                self.faults.append(f"equality '{name}' is of two tendons or of one in space: it has no counterpart")
            else:
                first = int(model.tendon_adr[a])
                terms = [
                    (self.joint_of[int(model.wrap_objid[k])], float(model.wrap_prm[k]))
                    for k in range(first, first + int(model.tendon_num[a]))
                ]
                (dependent, ratio), *others = terms
                length = float(c[0]) + float(model.tendon_length0[a])
                rest = tuple((other, -coef / ratio) for other, coef in others)
                found.append(Coupling(dependent, rest, length / ratio))
        return tuple(found), locked

    def _loops(self) -> tuple[Loop, ...]:
        mj, model = self.mj, self.model
        ends: dict[tuple[str, str], list[tuple[Vec3, Vec3]]] = defaultdict(list)
        for i in range(model.neq):
            kind, name = int(model.eq_type[i]), model.eq(i).name or f"equality {i}"
            if kind in (int(mj.mjtEq.mjEQ_JOINT), int(mj.mjtEq.mjEQ_TENDON)) or not model.eq_active0[i]:
                continue
            if kind != int(mj.mjtEq.mjEQ_CONNECT):
                self.faults.append(f"equality '{name}' is no connect: loops close in a point, or on a hinge by two")
                continue
            a, b = int(model.eq_obj1id[i]), int(model.eq_obj2id[i])
            if model.eq_objtype[i] == int(mj.mjtObj.mjOBJ_SITE):
                (body_a, p_a), (body_b, p_b) = self._point(a), self._point(b)
            else:
                (body_a, at_a), (body_b, at_b) = self.place[a], self.place[b]
                p_a, p_b = _vec3(at_a + model.eq_data[i, :3]), _vec3(at_b + model.eq_data[i, 3:6])
            ends[body_a, body_b].append((p_a, p_b))
        loops = []
        for (body_a, body_b), points in ends.items():
            (p_a, p_b), *more = points
            if len(more) > 1:
                self.faults.append(f"'{body_a}' and '{body_b}' are connected in {len(points)} points: that is a weld")
            elif more:
                ((q_a, q_b),) = more
                axes = _vec3(np.subtract(q_a, p_a)), _vec3(np.subtract(q_b, p_b))
                loops.append(Loop(body_a, p_a, body_b, p_b, *axes))
            else:
                loops.append(Loop(body_a, p_a, body_b, p_b))
        return tuple(loops)

    def _springs(self) -> tuple[Spring, ...]:
        model = self.model
        names, springs = Names(), []
        for t in range(model.ntendon):
            stiffness = float(model.tendon_stiffness[t])
            if not stiffness:
                continue
            name = names.new(model.tendon(t).name or f"spring {t}")
            first, count = int(model.tendon_adr[t]), int(model.tendon_num[t])
            wraps = slice(first, first + count)
            low, high = (float(x) for x in model.tendon_lengthspring[t])
            if count != 2 or (model.wrap_type[wraps] != int(self.mj.mjtWrap.mjWRAP_SITE)).any():
                self.faults.append(
                    f"tendon '{name}' does not run straight between two sites: that is no spring we know"
                )
            elif high - low > 1e-12 * max(high, 1.0):
                self.faults.append(
                    f"tendon '{name}' is slack from {low:g} to {high:g} m: give springlength one length twice, '0 0'"
                )
            else:
                (body_a, p_a), (body_b, p_b) = (self._point(int(s)) for s in model.wrap_objid[wraps])
                springs.append(Spring(name, body_a, p_a, body_b, p_b, stiffness, free_length=low))
        return tuple(springs)


def _matrix(quaternion: Array) -> Array:
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _vec3(v: Array) -> Vec3:
    x, y, z = (float(c) for c in v)
    return x, y, z

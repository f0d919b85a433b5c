"""What joins the bodies of an MJCF model beside its tree: couplings, loops and springs. See `mjcf_read`."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

from collections import defaultdict
from typing import Any

import numpy as np

from ..model.arrays import Array, frozen
from ..model.elements import Element, Spring, TorsionSpring, Vec3
from ..model.mechanism import Coupling, Loop
from .text import Names

Places = dict[int, tuple[str, Array]]
"""A body of the engine: which body of ours has its frame, and where its origin is there (a point mass has none)."""


@frozen
class Between:
    """Reads them; what has no counterpart is added to `faults`.

    Attributes:
        mj, model: the engine, and the compiled model.
        joint_of: the engine's number of a joint -> our name.
    """

    mj: Any
    model: Any
    place: Places
    joint_of: dict[int, str]
    faults: list[str]

    def _point(self, site: int) -> tuple[str, Vec3]:
        body, origin = self.place[int(self.model.site_bodyid[site])]
        return body, vec3(origin + self.model.site_pos[site])

    def couplings(self) -> tuple[tuple[Coupling, ...], dict[str, float]]:
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
                if not ratio:
                    self.faults.append(f"equality '{name}' holds a tendon whose first joint has the coefficient 0")
                    continue
                length = float(c[0]) + float(model.tendon_length0[a])
                rest = tuple((other, -coef / ratio) for other, coef in others)
                found.append(Coupling(dependent, rest, length / ratio))
        return tuple(found), locked

    def loops(self) -> tuple[Loop, ...]:
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
                p_a, p_b = vec3(at_a + model.eq_data[i, :3]), vec3(at_b + model.eq_data[i, 3:6])
            ends[body_a, body_b].append((p_a, p_b))
        loops = []
        for (body_a, body_b), points in ends.items():
            (p_a, p_b), *more = points
            if len(more) > 1:
                self.faults.append(f"'{body_a}' and '{body_b}' are connected in {len(points)} points: that is a weld")
            elif more:
                ((q_a, q_b),) = more
                axes = vec3(np.subtract(q_a, p_a)), vec3(np.subtract(q_b, p_b))
                loops.append(Loop(body_a, p_a, body_b, p_b, *axes))
            else:
                loops.append(Loop(body_a, p_a, body_b, p_b))
        return tuple(loops)

    def springs(self) -> tuple[Element, ...]:
        model = self.model
        names, springs = Names(), list[Element]()
        for j, name in self.joint_of.items():
            if model.jnt_stiffness[j] and int(model.jnt_type[j]) == int(self.mj.mjtJoint.mjJNT_HINGE):
                rest = float(model.qpos_spring[model.jnt_qposadr[j]])
                springs.append(TorsionSpring(names.new(f"{name} spring"), ((name, 1.0),), model.jnt_stiffness[j], rest))
        for t in range(model.ntendon):
            stiffness = float(model.tendon_stiffness[t])
            if not stiffness:
                continue
            name = names.new(model.tendon(t).name or f"spring {t}")
            first, count = int(model.tendon_adr[t]), int(model.tendon_num[t])
            wraps = slice(first, first + count)
            low, high = (float(x) for x in model.tendon_lengthspring[t])
            along = [self.joint_of.get(int(j), "") for j in model.wrap_objid[wraps]]
            if high - low > 1e-12 * max(high, 1.0):
                self.faults.append(
                    f"tendon '{name}' is slack from {low:g} to {high:g} m: give springlength one length twice, '0 0'"
                )
            elif (model.wrap_type[wraps] == int(self.mj.mjtWrap.mjWRAP_JOINT)).all():
                hinges = (model.jnt_type[model.wrap_objid[wraps]] == int(self.mj.mjtJoint.mjJNT_HINGE)).all()
                ratios = [float(ratio) for ratio in model.wrap_prm[wraps]]
                if hinges:
                    springs.append(TorsionSpring(name, tuple(zip(along, ratios, strict=True)), stiffness, low))
                else:
                    self.faults.append(f"tendon '{name}' is a spring along slides: only one along hinges is known")
            elif count != 2 or (model.wrap_type[wraps] != int(self.mj.mjtWrap.mjWRAP_SITE)).any():
                self.faults.append(
                    f"tendon '{name}' does not run straight between two sites: that is no spring we know"
                )
            else:
                (body_a, p_a), (body_b, p_b) = (self._point(int(s)) for s in model.wrap_objid[wraps])
                springs.append(Spring(name, body_a, p_a, body_b, p_b, stiffness, free_length=low))
        return tuple(springs)


def vec3(v: Array) -> Vec3:
    x, y, z = (float(c) for c in v)
    return x, y, z

"""What joins the bodies of an MJCF model beside its tree: couplings, loops and springs. See `mjcf_read`.

A weld is three points, as two connects are a hinge.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from ..model.arrays import Array, frozen, vec3
from ..model.elements import Element, Guide, JointElement, LineElement, Pulley, Spring, TorsionSpring, Vec3, laws
from ..model.elements.laws.compression import ENDLESS
from ..model.mechanism import Coupling, Loop
from ..model.names import Names
from ..model.rotation import from_quaternion
from .mjcf import HINGE_ARM
from .mjcf_acts import Model

Places = dict[int, tuple[str, Array]]
"""A body of the engine: which body of ours has its frame, and where its origin is there (a point mass has none)."""
Held = Mapping[int, tuple[int, Array, Array]]
"""A free joint -> the weld that holds its body, and the body's orientation and position [m] in the world."""


@frozen
class Between:
    """Reads them; what has no counterpart is refused in `source.notes`.

    Attributes:
        source: the compiled model.
        joint_of: the engine's number of a joint -> our name.
    """

    source: Model
    place: Places
    joint_of: dict[int, str]

    def _point(self, site: int) -> tuple[str, Vec3]:
        model = self.source.model
        body, origin = self.place[int(model.site_bodyid[site])]
        return body, vec3(origin + model.site_pos[site])

    def _equalities(self, *kinds: str) -> Iterator[tuple[int, int, int]]:
        """Numbers of the active equalities of these kinds, and of the two objects that each joins."""
        mj, model = self.source.mj, self.source.model
        wanted = [int(getattr(mj.mjtEq, f"mjEQ_{kind}")) for kind in kinds]
        for i in np.flatnonzero(model.eq_active0) if not self.source.off("equality", "constraint") else ():
            if int(model.eq_type[i]) in wanted:
                yield int(i), int(model.eq_obj1id[i]), int(model.eq_obj2id[i])

    def _ends(self, i: int, a: int, b: int) -> tuple[int, Array, Array, int, Array, Array]:
        """Of a connect or weld: each end's body, its point there, and the orientation that a weld gives both."""
        mj, model, welded = self.source.mj, self.source.model, self.source.model.eq_data[i, 6:10]
        if model.eq_objtype[i] == int(mj.mjtObj.mjOBJ_SITE):
            (A, p_a, R_a), (B, p_b, R_b) = ((int(model.site_bodyid[s]), model.site_pos[s],
                                             from_quaternion(model.site_quat[s])) for s in (a, b))  # fmt: skip
            return A, p_a, R_a, B, p_b, R_b
        data = model.eq_data[i]
        if int(model.eq_type[i]) == int(mj.mjtEq.mjEQ_CONNECT):
            return a, data[:3], np.eye(3), b, data[3:6], np.eye(3)
        return a, data[3:6], from_quaternion(welded), b, data[:3], np.eye(3)

    def held(self) -> Held:
        """The free joints of bodies that are welded to one that does not move."""
        model, found = self.source.model, dict[int, tuple[int, Array, Array]]()
        free = int(self.source.mj.mjtJoint.mjJNT_FREE)
        for i, a, b in self._equalities("WELD"):
            A, p_a, R_a, B, p_b, R_b = self._ends(i, a, b)
            for body, p, R, other, q, T in ((A, p_a, R_a, B, p_b, R_b), (B, p_b, R_b, A, p_a, R_a)):
                j = int(model.body_jntadr[body])
                still = self._still(other)
                if j >= 0 and int(model.jnt_type[j]) == free and still is not None and j not in found:
                    S, s = still
                    turn = S @ T @ R.T
                    found[j] = i, turn, s + S @ q - turn @ p
        return found

    def _still(self, body: int) -> tuple[Array, Array] | None:
        """Where a body is whose ancestors have no joints."""
        model, R, p = self.source.model, np.eye(3), np.zeros(3)
        while body:
            if model.body_jntnum[body]:
                return None
            turn = from_quaternion(model.body_quat[body])
            R, p = turn @ R, model.body_pos[body] + turn @ p
            body = int(model.body_parentid[body])
        return R, p

    def couplings(self) -> tuple[tuple[Coupling, ...], dict[str, float]]:
        mj, model = self.source.mj, self.source.model
        found: list[Coupling] = []
        locked: dict[str, float] = {}
        for i, a, b in self._equalities("JOINT", "TENDON"):
            c = model.eq_data[i, :5]
            if np.any(c[2:]):
                self.source.refuse("equality", i, "is curved (polycoef): a coupling is linear")
            elif int(model.eq_type[i]) == int(mj.mjtEq.mjEQ_JOINT):
                zero = [float(model.qpos0[model.jnt_qposadr[j]]) if j >= 0 else 0.0 for j in (a, b)]
                if b < 0:
                    locked[self.joint_of[a]] = float(c[0]) + zero[0]
                else:
                    offset = float(c[0]) + zero[0] - float(c[1]) * zero[1]
                    found.append(Coupling(self.joint_of[a], ((self.joint_of[b], float(c[1])),), offset))
            elif b >= 0 or int(model.wrap_type[model.tendon_adr[a]]) != int(mj.mjtWrap.mjWRAP_JOINT):
                self.source.refuse("equality", i, "is of two tendons or of one in space: it has no counterpart")
            else:
                first = int(model.tendon_adr[a])
                terms = [
                    (self.joint_of[int(model.wrap_objid[k])], float(model.wrap_prm[k]))
                    for k in range(first, first + int(model.tendon_num[a]))
                    if model.wrap_prm[k]
                ]
                if not terms:
                    continue  # coefficients of zero hold nothing
                (dependent, ratio), *others = terms
                length = float(c[0]) + float(model.tendon_length0[a])
                rest = tuple((other, -coef / ratio) for other, coef in others)
                found.append(Coupling(dependent, rest, length / ratio))
        return tuple(found), locked

    def loops(self, held: Held) -> tuple[Loop, ...]:
        """Loops of connects and welds, but for the welds that hold free bodies."""
        mj, model = self.source.mj, self.source.model
        found: dict[tuple[str, str, int], list[Loop]] = {}
        holding = {i for i, _, _ in held.values()}
        for i, a, b in self._equalities("CONNECT", "WELD"):
            A, p_a, R_a, B, p_b, R_b = self._ends(i, a, b)
            (body_a, at_a), (body_b, at_b) = self.place[A], self.place[B]
            ends = at_a + p_a, at_b + p_b
            if i in holding:
                continue
            if max(model.body_mocapid[[A, B]]) >= 0:
                self.source.note("equality", i, "what ties it to a mocap body, which a program moves, is left out")
            elif int(model.eq_type[i]) == int(mj.mjtEq.mjEQ_WELD):
                arms = [(ends[0] + HINGE_ARM * R_a[:, k], ends[1] + HINGE_ARM * R_b[:, k]) for k in (2, 0)]
                for two in (ends, *arms):
                    _connect(found.setdefault((body_a, body_b, i), []), body_a, body_b, *two)
            else:
                _connect(found.setdefault((body_a, body_b, -1), []), body_a, body_b, *ends)
        known = {int(getattr(mj.mjtEq, f"mjEQ_{kind}")) for kind in ("CONNECT", "WELD", "JOINT", "TENDON")}
        for i in np.flatnonzero(model.eq_active0):
            if int(model.eq_type[i]) not in known:
                self.source.refuse("equality", int(i), "is no connect, weld, joint or tendon: it has no counterpart")
        return tuple(loop for made in found.values() for loop in made)

    def springs(self) -> tuple[Element, ...]:
        """Springs of hinges and of tendons; what is none that is known is refused."""
        source, model = self.source, self.source.model
        names, springs = Names(), list[Element]()
        if source.off("spring", "passive"):
            return ()
        for j, name in self.joint_of.items():
            if model.jnt_stiffness[j] and int(model.jnt_type[j]) == int(source.mj.mjtJoint.mjJNT_HINGE):
                rest = float(model.qpos_spring[model.jnt_qposadr[j]])
                stiffness = float(model.jnt_stiffness[j])
                springs.append(TorsionSpring(names.new(f"{name} spring"), ((name, 1.0),), stiffness, rest))
        for t in range(model.ntendon):
            if self._bent(t):
                source.refuse("tendon", t, "is a spring that is curved or yields: only linear ones are known")
            elif model.tendon_stiffness[t]:
                springs += [replace(found, name=names.new(found.name)) for found in self._tendon(t)]
        if not source.off("actuation"):
            for a in range(model.nu):
                if (bias := source.bias(a)) is not None:
                    tendon, b0, b1 = bias
                    name = source.name("actuator", a) or f"actuator {a}"
                    springs += [replace(one, name=names.new(name)) for one in self._along(tendon, _affine(b0, b1))]
        return tuple(springs)

    def _bent(self, t: int) -> bool:
        bends = (getattr(self.source.model, array, None) for array in ("tendon_stiffnesspoly", "tendon_springyield"))
        return any(values is not None and np.any(values[t]) for values in bends)  # an older engine has no such thing

    def _tendon(self, t: int) -> list[Element]:
        """The springs that a tendon is: two where it is slack between two lengths; none where that is refused."""
        model = self.source.model
        k, (low, high) = float(model.tendon_stiffness[t]), (float(x) for x in model.tendon_lengthspring[t])
        if high - low <= 1e-12 * max(high, 1.0):
            return self._along(t, laws.Linear(k, low))
        pulls = self._along(t, laws.Extension(k, high)) if high < ENDLESS else []
        return [*pulls, *(self._along(t, laws.Compression(k, low)) if low > 0 or high >= ENDLESS else [])]

    def _along(self, t: int, law: laws.Law) -> list[Element]:
        """The element of a law on a tendon's path; nothing where that is refused, or holds nothing."""
        source, model, wrap = self.source, self.source.model, self.source.mj.mjtWrap
        name = source.name("tendon", t) or f"spring {t}"
        first, count = int(model.tendon_adr[t]), int(model.tendon_num[t])
        along, kinds = (array[first : first + count] for array in (model.wrap_objid, model.wrap_type))
        if (kinds == int(wrap.mjWRAP_JOINT)).all():
            ratios = zip(along.tolist(), model.wrap_prm[first : first + count].tolist(), strict=True)
            terms = [(int(j), ratio) for j, ratio in ratios if ratio]
            joints = tuple((self.joint_of[j], ratio) for j, ratio in terms)
            if not all(int(model.jnt_type[j]) == int(source.mj.mjtJoint.mjJNT_HINGE) for j, _ in terms):
                source.refuse("tendon", t, "is a spring along slides: only one along hinges is known")
            elif isinstance(law, laws.Linear):
                return [TorsionSpring(name, joints, law.stiffness, law.free_length)] if joints else []
            elif isinstance(law, laws.ConstantForce):
                return [JointElement(name, joints, laws.ConstantTorque(law.force))] if joints else []
            else:
                source.refuse("tendon", t, "is slack between two angles: such a spring on joints is not known")
            return []
        guides = [self._guide(t, int(i)) for i in range(first, first + count)]
        if None in guides:
            return []
        begin, *via, end = (guide for guide in guides if guide is not None)
        own = name, begin.body, begin.point, end.body, end.point
        if not via and isinstance(law, laws.Linear):
            return [Spring(*own, law.stiffness, law.free_length)]
        return [LineElement(*own, law, tuple(via))]

    def _guide(self, t: int, i: int) -> Guide | None:
        """A site that a tendon runs through, or a cylinder that it lies on; None where that is refused."""
        model, wrap = self.source.model, self.source.mj.mjtWrap
        kind, number, side = int(model.wrap_type[i]), int(model.wrap_objid[i]), int(model.wrap_prm[i])
        if kind == int(wrap.mjWRAP_SITE):
            return Guide(*self._point(number))
        if kind != int(wrap.mjWRAP_CYLINDER) or side < 0:
            what = "no side site" if kind == int(wrap.mjWRAP_CYLINDER) else "a sphere or a pulley block"
            problem = f"is a spring with {what}: it runs through sites and on cylinders with a side"
            self.source.refuse("tendon", t, problem)
            return None
        body, origin = self.place[int(model.geom_bodyid[number])]
        beside, p = self._point(side)
        if beside != body:
            self.source.refuse("tendon", t, "has a side site on another body than its cylinder: none such is known")
            return None
        axis = from_quaternion(model.geom_quat[number])[:, 2]
        centre = vec3(origin + model.geom_pos[number])
        return Pulley(body, centre, float(model.geom_size[number, 0]), vec3(axis), p)


def _affine(b0: float, b1: float) -> laws.Law:
    """The law of the force ``b0 + b1 s``."""
    return laws.Linear(b1, -b0 / b1) if b1 else laws.ConstantForce(b0)


def _connect(made: list[Loop], body_a: str, body_b: str, p_a: Array, p_b: Array) -> None:
    """Add a point where two bodies meet to their loops: the second makes the first a hinge, more are points again."""
    if len(made) == 1 and made[0].axis_a is None:
        axes = p_a - np.array(made[0].p_a), p_b - np.array(made[0].p_b)
        if all(axis.any() for axis in axes):
            made[0] = Loop(body_a, made[0].p_a, body_b, made[0].p_b, vec3(axes[0]), vec3(axes[1]))
            return
    made.append(Loop(body_a, vec3(p_a), body_b, vec3(p_b)))

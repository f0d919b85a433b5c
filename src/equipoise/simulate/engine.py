"""A mechanism in MuJoCo: compiled from its MJCF text, placed, and asked for forces.

The poses come from our own kinematics, loop closure included, which is the reference: the engine's equalities are soft.
What they leave open is the constraint error. Torques come from the engine alone: its bias and passive forces, and its
own constraint Jacobian to refer them to the independent coordinates.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..io import mjcf
from ..kinematics import Tree
from ..kinematics.linkage import ClosedPoses
from ..model.arrays import Array
from ..model.errors import EquipoiseError, Fault, InputError
from ..model.mechanism import Mechanism
from ..model.rotation import about, ball_angles, from_quaternion
from .own_laws import OwnLaws

TIMESTEP = {False: 1e-3, True: 1e-4}  # [s] without and with equalities, which are stiff
SOLREF = (2e-4, 1.0)  # time constant [s] (two steps, the least that is stable) and damping ratio of equalities
SOLIMP = (0.9999, 0.9999, 0.001, 0.5, 2.0)  # as hard as the engine allows
ARMATURE = 1e-4  # of the mechanism's mass times the square of its size: the least inertia that a joint turns
DEFAULT_RADIUS = 0.05  # [m] of the uniform sphere that stands for a body, where one is asked for


class EngineError(EquipoiseError):
    """The simulation did not run to its end."""


@dataclass(frozen=True)
class Settings:
    """What the run rests on, for the report: time step [s], integrator, equalities, and made-up inertias."""

    timestep: float
    held: bool  # by friction or damping
    integrator: str
    equalities: int
    armature: float  # [kg m^2, or kg of slides] the largest that joints got
    raised: tuple[str, ...]  # these joints

    def __str__(self) -> str:
        held = "friction and damping of the joints" if self.held else "no friction or damping"
        text = f"time step {1e3 * self.timestep:g} ms, {self.integrator}, {held}, no contact"
        if self.equalities:
            text += f"; {self.equalities} equalities, time constant {1e3 * SOLREF[0]:g} ms, impedance {SOLIMP[0]:g}"
        if self.raised:
            text += f"; armature of up to {self.armature:.2g} kg m^2 (kg of slides) on joints with little inertia: "
            text += ", ".join(self.raised[:3]) + (f" and {len(self.raised) - 3} more" if len(self.raised) > 3 else "")
        return text


class Engine:
    """A mechanism compiled by MuJoCo.

    Args:
        radius: [m] of the uniform sphere that stands for a body with a mass and no inertia.
        friction: with the joints' friction and damping. Without, what stays is balanced, and not held.

    Attributes:
        modelled: the mechanism with the inertias that the engine knows.
        tree: our kinematics, which say where the bodies are.
        settings: of the solver.

    Raises:
        InputError: MuJoCo is not installed, or a body has a mass and no inertia and no radius is given.
        UnsupportedError: MJCF cannot express the mechanism.
    """

    def __init__(self, mechanism: Mechanism, radius: float | None = None, friction: bool = False) -> None:
        try:
            import mujoco
        except ImportError:
            message = "MuJoCo is not installed; it comes with: pip install 'equipoise[sim]'"
            raise InputError(message) from None
        self._mj: Any = mujoco
        self.mechanism = mechanism
        self.tree = Tree.of(mechanism)
        unknown = [body.name for body in mechanism.bodies if body.mass and body.inertia is None]
        if unknown and radius is None:
            some = ", ".join(f"'{name}'" for name in unknown[:6]) + (" .." if len(unknown) > 6 else "")
            ask = f"give it in the file, or --radius {1e3 * DEFAULT_RADIUS:g}mm for uniform spheres of that size"
            raise InputError(Fault(("bodies", unknown[0], "inertia"), f"motion depends on it, of {some}: {ask}"))
        if not friction:
            mechanism = replace(
                mechanism, joints=tuple(replace(j, damping=0.0, friction=0.0) for j in mechanism.joints)
            )
        bodies = (
            replace(body, inertia=_sphere(body.mass, radius or 0.0)) if body.name in unknown else body
            for body in mechanism.bodies
        )
        self.modelled = replace(mechanism, bodies=tuple(bodies))
        self.model = mujoco.MjModel.from_xml_string(mjcf.to_text(self.modelled, warn=False))
        self.data = mujoco.MjData(self.model)
        self._joints = mjcf.joint_map(mechanism)
        self._own = OwnLaws(mujoco, mechanism)
        with self._own.acting():
            self.settings = self._prepare()

    def _prepare(self) -> Settings:
        mj, model = self._mj, self.model
        soft = model.neq > 0
        model.opt.timestep = TIMESTEP[soft]
        model.opt.integrator = mj.mjtIntegrator.mjINT_EULER if soft else mj.mjtIntegrator.mjINT_RK4
        model.opt.jacobian = mj.mjtJacobian.mjJAC_DENSE
        model.opt.solver, model.opt.iterations, model.opt.tolerance = mj.mjtSolver.mjSOL_NEWTON, 50, 1e-14
        model.opt.disableflags |= mj.mjtDisableBit.mjDSBL_LIMIT | mj.mjtDisableBit.mjDSBL_REFSAFE
        model.opt.enableflags |= mj.mjtEnableBit.mjENBL_ENERGY
        model.eq_solref[:], model.eq_solimp[:] = SOLREF, SOLIMP
        held = bool(model.dof_damping.any() or model.dof_frictionloss.any())
        integrator = "semi-implicit Euler" if soft else "Runge-Kutta of order 4"
        return Settings(model.opt.timestep, held, integrator, int(model.neq), *self._armature())

    def _armature(self) -> tuple[float, tuple[str, ...]]:
        """Raise the inertia of joints that turn next to nothing, and of joints that follow others.

        With none, rounding would throw them about; and the engine holds equalities the more softly the less inertia
        is behind them. Inertia changes how fast a mechanism moves, not whether it does.
        """
        mj, model, data = self._mj, self.model, self.data
        model.dof_armature[:] = 1.0  # while it is asked: no inertia is singular
        mj.mj_forward(model, data)
        size = max(float(np.abs(x).max(initial=0.0)) for x in (data.xipos, data.site_xpos))
        inertia = np.zeros((model.nv, model.nv))
        mj.mj_fullM(model, data, inertia)
        own = np.diag(inertia) - model.dof_armature
        least = np.full(model.nv, ARMATURE * float(model.body_mass.sum()) * max(size, DEFAULT_RADIUS) ** 2)
        for dofs in self._followers():
            least[dofs] = np.maximum(least[dofs], own[dofs].max())
        low = own < least
        model.dof_armature[:] = np.where(low, least - own, 0.0)
        mj.mj_setConst(model, data)  # what the engine thinks is behind an equality follows from the inertias
        joints = dict.fromkeys(model.joint(int(j)).name for j in model.dof_jntid[low])
        return float(model.dof_armature.max(initial=0.0)), tuple(joints)

    def _followers(self) -> Iterator[list[int]]:
        """The degrees of freedom that each equality between joints ties together."""
        mj, model = self._mj, self.model
        for i in range(model.neq):
            ends = [int(j) for j in (model.eq_obj1id[i], model.eq_obj2id[i]) if j >= 0]
            if model.eq_type[i] == int(mj.mjtEq.mjEQ_JOINT):
                yield [int(model.jnt_dofadr[j]) for j in ends]
            elif model.eq_type[i] == int(mj.mjtEq.mjEQ_TENDON):
                first = int(model.tendon_adr[ends[0]])
                joints = model.wrap_objid[first : first + int(model.tendon_num[ends[0]])]
                yield [int(model.jnt_dofadr[j]) for j in joints]

    def place(self, q: Array) -> None:
        """Put it at rest at the independent coordinates `q` (n,) [rad or m].

        Raises:
            InputError: its loops do not close there, or a joint is outside its range; the message says which.
        """
        values = self.values(q)
        self._mj.mj_resetData(self.model, self.data)
        for name, joint in self._joints.items():
            own, address = joint.qpos(values), self.model.joint(name).qposadr[0]
            self.data.qpos[address : address + len(own)] = own
        with self._own.acting():
            self._mj.mj_forward(self.model, self.data)

    def values(self, q: Array) -> dict[str, float]:
        """The coordinates of the spanning tree at independent ones `q` (n,); those inside their ranges only."""
        poses = self.tree.poses(np.asarray(q, float)[None])
        if isinstance(poses, ClosedPoses):
            full, tree = poses.q[0], self.tree.open
            if np.isnan(full).any():
                at = ", ".join(f"{name} {x:.4g}" for name, x in zip(self.tree.coordinates, q, strict=True))
                raise InputError(f"the loops of '{self.mechanism.name}' do not close at {at} [rad or m]")
        else:
            full, tree = np.asarray(q, float), self.tree
        s = tree.values(full[None])[0]
        off = np.maximum(tree.lower - s, s - tree.upper)
        if (off > 1e-9).any():
            i = int(off.argmax())
            child = next(link.joint.child for link in tree.links if any(m.row == i for m in link.motions))
            motion = tree.motions[i]
            unit = motion.shown_unit
            low, high, found = (f"{motion.scale * x:.6g}" for x in (tree.lower[i], tree.upper[i], s[i]))
            raise InputError(
                f"pose outside the limits: joint '{motion}' of body '{child}' is at {found} {unit}, its range "
                f"is {low} to {high} {unit}"
            )
        return dict(zip(tree.coordinates, full.tolist(), strict=True))

    def holding(self) -> Array:
        """(n,) [N m or N] what holds the present pose at the independent coordinates, by the engine."""
        data = self.data
        return self.at_coordinates(data.qfrc_bias - data.qfrc_passive - data.qfrc_actuator)

    def at_coordinates(self, force: Array) -> Array:
        """(n,) generalised forces (nv,) of the engine, referred to the independent coordinates.

        What the equalities carry is left out: ``force = S tau + J' lambda`` in the least squares sense, exact where
        the independent coordinates determine the others.
        """
        mj, model, data = self._mj, self.model, self.data
        E, names = self._rates()
        rows = data.efc_type == int(mj.mjtConstraint.mjCNSTR_EQUALITY)
        J = data.efc_J.reshape(-1, model.nv)[rows] @ E if data.nefc else np.zeros((0, E.shape[1]))
        S = np.zeros((len(names), self.tree.n))
        for j, name in enumerate(self.tree.coordinates):
            S[names.index(name), j] = 1.0
        weight = np.linalg.norm(J, axis=1, keepdims=True)
        A = np.hstack([S, (J / np.where(weight > 0, weight, 1.0)).T])
        return np.asarray(np.linalg.lstsq(A, E.T @ force, rcond=1e-11)[0], float)[: self.tree.n]

    def _rates(self) -> tuple[Array, list[str]]:
        """(nv, scalars) the engine's velocities per rate of each scalar joint value, and the names of these."""
        model = self.model
        E, names = np.zeros((model.nv, model.nv)), []
        for j in range(model.njnt):
            joint, start = self._joints[model.joint(j).name], int(model.jnt_dofadr[j])
            if joint.type != "ball":
                E[start, len(names)] = 1.0
                names.append(model.joint(j).name)
                continue
            # the engine turns a ball by its angular velocity in the child's frame, we by three angles in turn
            address = int(model.jnt_qposadr[j])
            angles = ball_angles(from_quaternion(self.data.qpos[address : address + 4]))
            R = np.eye(3)
            for axis, angle, (name, _) in zip(
                np.eye(3)[::-1], angles[::-1], joint.terms[::-1], strict=True
            ):  # z last: R is what follows
                E[start : start + 3, len(names)] = R.T @ axis
                R = about(axis, np.array([angle]))[0] @ R
                names.append(name)
        return E, names

    @property
    def constraint_error(self) -> float:
        """[m or rad] how far the equalities are open at the present pose."""
        rows = self.data.efc_type == int(self._mj.mjtConstraint.mjCNSTR_EQUALITY)
        return float(np.abs(self.data.efc_pos[rows]).max(initial=0.0))

    @property
    def energy(self) -> float:
        """[J] potential and kinetic, up to a constant."""
        return float(self.data.energy.sum()) + self._own.energy(self.data)

    def run(self, seconds: float) -> None:
        """Go on by `seconds`, at least one time step.

        Raises:
            EngineError: it diverged; the message says which joint first.
        """
        steps = max(1, round(seconds / self.model.opt.timestep))
        with self._own.acting():
            self._mj.mj_step(self.model, self.data, nstep=steps)
        bad = ~np.isfinite(self.data.qvel) | (np.abs(self.data.qvel) > 1e6)
        if bad.any() or self.data.warning[int(self._mj.mjtWarning.mjWARN_BADQACC)].number:
            dof = int(np.argmax(bad)) if bad.any() else 0
            joint = self.model.joint(int(self.model.dof_jntid[dof]))
            body = self.model.body(int(joint.bodyid[0])).name
            raise EngineError(
                f"the simulation diverged at {self.data.time:.3g} s, first at body '{body}' (joint '{joint.name}'): "
                "its inertia may be too small for what the springs do to it"
            )

    def moved(self, start: Array) -> Array:
        """(njnt,) [rad, or m of slides] how far every joint is from where it was at qpos `start`."""
        mj, model = self._mj, self.model
        apart = np.zeros(model.nv)
        mj.mj_differentiatePos(model, apart, 1.0, start, self.data.qpos)
        return np.array([float(np.linalg.norm(apart[model.dof_jntid == j])) for j in range(model.njnt)])


def _sphere(mass: float, radius: float) -> tuple[float, float, float, float, float, float]:
    moment = 0.4 * mass * radius**2
    return moment, moment, moment, 0.0, 0.0, 0.0

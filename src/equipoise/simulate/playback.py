"""Drive a mechanism through a motion in the engine: what the actuators have to do, with and without springs."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..io import Source, loaded
from ..kinematics import Tree
from ..model.arrays import Array, frozen
from ..model.coordinate import Coordinate
from ..model.errors import InputError
from ..model.mechanism import Mechanism
from ..model.notebook import Shown
from ..model.units import Amount, quantity
from ..synthesis.states import States, load_torque
from .engine import Engine
from .quiet import quiet


@frozen
class Playback(Shown):
    """A motion, and what it takes.

    Attributes:
        name: of the mechanism; coordinates: its own.
        time: (T,) [s]; motion: (T, n) independent coordinates [rad or m].
        torque, unsprung: (T, n) of the actuators with the springs and without them [N m or N].
        gravity, springs: (T,) potential energies [J], each counted from its value at the start.
        kinetic: (T,) [J].
        predicted: (T, n) what this program says of `torque`, from the same rates and accelerations [N m or N]; None
            where the engine's joints are none of ours: with loops or balls.
    """

    name: str
    coordinates: tuple[Coordinate, ...]
    time: Array
    motion: Array
    torque: Array
    unsprung: Array
    gravity: Array
    springs: Array
    kinetic: Array
    predicted: Array | None = None

    @property
    def apart(self) -> float | None:
        """How far the prediction and the engine are apart at most, as a share of the largest torque."""
        if self.predicted is None:
            return None
        return float(np.abs(self.predicted - self.torque).max() / (np.abs(self.torque).max() or 1.0))

    @property
    def power(self) -> tuple[Array, Array]:
        """(T, n) each: what the actuators put in [W], with springs and without."""
        rate = np.gradient(self.motion, self.time, axis=0)
        return self.torque * rate, self.unsprung * rate

    @property
    def peak(self) -> tuple[Array, Array]:
        """(n,) each: largest torque with springs and without [N m or N]."""
        return np.abs(self.torque).max(axis=0), np.abs(self.unsprung).max(axis=0)

    @property
    def work(self) -> tuple[Array, Array]:
        """(n,) each: what the actuators put in or take out, ``integral |torque rate| dt`` [J], with and without."""
        rate = np.gradient(self.motion, self.time, axis=0)
        sprung, bare = (np.trapezoid(np.abs(x * rate), self.time, axis=0) for x in (self.torque, self.unsprung))
        return sprung, bare

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        (peak, bare_peak), (work, bare_work) = self.peak, self.work
        return {
            "seconds": float(self.time[-1] - self.time[0]),
            "joints": [
                {"joint": name, "peak": a, "peak_without_springs": b, "work": c, "work_without_springs": d}
                for name, a, b, c, d in zip(
                    self.coordinates, *(x.tolist() for x in (peak, bare_peak, work, bare_work)), strict=True
                )
            ],
            "energy_variation": float(np.ptp(self.gravity + self.springs)),
            "gravity_variation": float(np.ptp(self.gravity)),
            "prediction_apart": self.apart,
        }


def play(mechanism: Source, time: Array, motion: Array, radius: Amount | None = None) -> Playback:
    """Inverse dynamics along a motion, by the engine, with the friction and damping that the joints have.

    Args:
        mechanism: or the path of its file.
        time: (T,) [s], increasing; motion: (T, n) independent coordinates [rad or m], smooth.
        radius: as `release`.

    Raises:
        InputError: the loops do not close somewhere, a joint leaves its range, or as `Engine`.
    """
    mechanism, radius = loaded(mechanism), None if radius is None else quantity(radius, "length", "radius")
    if len(time) < 3 or (np.diff(time) <= 0).any():
        raise InputError("a motion needs at least three times, in increasing order")
    sprung, bare = (Engine(m, radius, friction=True) for m in (mechanism, mechanism.with_springs(())))
    torque, total, kinetic, course = _torques(sprung, time, motion)
    unsprung, gravity, _, _ = _torques(bare, time, motion)
    springs = total - gravity
    tree = sprung.tree
    return Playback(
        mechanism.name, tree.coordinates, time, motion, torque, unsprung, gravity - gravity[0],
        springs - springs[0], kinetic, _predicted(sprung.modelled, course),
    )  # fmt: skip


def _predicted(mechanism: Mechanism, course: tuple[Array, Array, Array] | None) -> Array | None:
    """(T, n) by this program, along positions, rates and accelerations (T, n)."""
    if course is None:
        return None
    q = course[0]
    states = States(q, np.full(len(q), 1 / len(q)), *course[1:])
    return load_torque(mechanism, states, states.moving(Tree.of(mechanism)))


def _torques(
    engine: Engine, time: Array, motion: Array
) -> tuple[Array, Array, Array, tuple[Array, Array, Array] | None]:
    """(T, n) torques, (T,) potential and kinetic energy, and (T, n) positions, rates and accelerations of ours."""
    mj, model, data = engine._mj, engine.model, engine.data
    placed = []
    for q in motion:
        engine.place(q)
        placed.append(data.qpos.copy())
    velocity = np.array([_velocity(engine, time, placed, i) for i in range(len(time))])
    acceleration = np.gradient(velocity, time, axis=0, edge_order=2)
    torques, potential, kinetic = [], [], []
    for qpos, qvel, qacc in zip(placed, velocity, acceleration, strict=True):
        data.qpos[:], data.qvel[:] = qpos, qvel
        with quiet(mj):
            mj.mj_forward(model, data)
        inertial = np.zeros(model.nv)
        mj.mj_mulM(model, data, inertial, qacc)
        inertial -= model.dof_armature * qacc  # it is none of the mechanism's: see `Engine`
        dry = model.dof_frictionloss * np.sign(qvel)
        torques.append(engine.at_coordinates(inertial + dry + data.qfrc_bias - data.qfrc_passive))
        potential.append(data.energy[0])
        kinetic.append(data.energy[1])
    return np.array(torques), np.array(potential), np.array(kinetic), _course(engine, motion, velocity, acceleration)


def _course(engine: Engine, q: Array, velocity: Array, acceleration: Array) -> tuple[Array, Array, Array] | None:
    """(T, n) each: positions, rates and accelerations of the independent coordinates, from the engine's (T, nv)."""
    model, mechanism = engine.model, engine.mechanism
    if mechanism.loops or any(joint.type == "spherical" for joint in mechanism.joints):
        return None
    names = [model.joint(int(j)).name for j in model.dof_jntid]
    columns = [names.index(name) for name in engine.tree.coordinates]
    return q, velocity[:, columns], acceleration[:, columns]


def _velocity(engine: Engine, time: Array, placed: list[Array], i: int) -> Array:
    """(nv,) of the parabola through three positions, the i-th and its neighbours: the next two at the ends."""
    last = len(time) - 1
    near = (1, 2) if i == 0 else (last - 1, last - 2) if i == last else (i - 1, i + 1)
    apart = np.zeros((2, engine.model.nv))
    for step, j in zip(apart, near, strict=True):
        engine._mj.mj_differentiatePos(engine.model, step, 1.0, placed[i], placed[j])
    a, b = (time[j] - time[i] for j in near)
    return (apart[0] * b**2 - apart[1] * a**2) / (a * b * (b - a))

"""What a cam has to do: the energy over the angle of a joint, or of a sum of joints, that balances best.

A cam's torque on the joints is ``J' t(angle)``, with the angle's Jacobian J. The best t leaves the least mean square
torque over the poses: it is a regression of the torque that is there on the angle, here by Chebyshev polynomials, in
which it is a small least-squares problem. Where the torque depends on that angle alone, nothing is left.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.polynomial import Chebyshev

from ...energy.evaluate import Potential
from ...kinematics import Tree, sample
from ...kinematics.sampling import bounds
from ...model.arrays import Array, frozen
from ...model.elements import JointElement
from ...model.elements.laws import Cam, Law
from ...model.elements.laws.law import Terms
from ...model.errors import Fault, InputError
from ...model.mechanism import Mechanism

DEGREE_ALONE, DEGREE, DEGREE_OF_LAW = 30, 14, 40
"""Of the polynomials where the angle alone decides, where other joints scatter the torque, and for a given law."""
ALONE = 1025  # angles where it does
NOISE = 1e-13
ROUNDING = 1e-28  # share of a sum of squares
HARMONICS = 3
EXACT = 1e-9  # share of the torque up to which a series is the torque itself


@frozen
class Wanted:
    """The energy that a cam should have on ``sum(ratio * angle)`` of `joints`.

    Attributes:
        low, high: the angles between which [rad].
        torque: slope of that energy [N m].
    """

    joints: Terms
    low: float
    high: float
    torque: Chebyshev

    @cached_property
    def energy(self) -> Chebyshev:
        """[J], 0 at its least."""
        whole = self.torque.integ()
        return whole - float(whole(self.angles()).min())

    def angles(self, count: int = 1001) -> Array:
        """(count,) from the lower to the upper end [rad]."""
        return np.linspace(self.low, self.high, count)

    @property
    def peak(self) -> float:
        """Its largest torque [N m]."""
        return float(np.abs(self.torque(self.angles())).max())

    def plus(self, torque: float, share: float) -> Wanted:
        """A share of it and a constant torque."""
        return Wanted(self.joints, self.low, self.high, share * self.torque + torque)

    @cached_property
    def law(self) -> Cam:
        """It as the law of an element: a Fourier series where that is the same, else by points."""
        angle = self.angles()
        n = np.arange(1, HARMONICS + 1)
        columns = np.hstack([-n * np.sin(angle[:, None] * n), n * np.cos(angle[:, None] * n)])
        found, *_ = np.linalg.lstsq(columns, self.torque(angle), rcond=None)
        if np.abs(columns @ found - self.torque(angle)).max() <= EXACT * self.peak:
            found[np.abs(found) < EXACT * np.abs(found).max()] = 0.0
            cosine, sine = (np.trim_zeros(part, "b").tolist() for part in np.split(found, 2))
            return Cam(cosine=tuple(cosine), sine=tuple(sine))
        places = self.angles(POINTS)
        return Cam(points=tuple(zip(places.tolist(), self.energy(places).tolist(), strict=True)))


POINTS = 121  # of energy; the cubics through them have the torque to 1e-6 of its peak


def wanted(mechanism: Mechanism, joints: Terms, between: tuple[float, float] | None = None) -> Wanted:
    """The best energy on a sum of joints, for what loads the mechanism as it is.

    Args:
        joints: (name, ratio) of each.
        between: the angles that count [rad]; by default all that the joints' ranges allow.

    Raises:
        InputError: no such joint, nothing to balance, or a range of a turn or more.
    """
    angle, tree = _angle(mechanism, joints), Tree.of(mechanism)
    q, psi, J = _poses(tree, angle)
    low, high = _ends(tree, angle, between)
    inside = (psi >= low - 1e-9) & (psi <= high + 1e-9)
    if inside.sum() < 2 * DEGREE:
        raise InputError(Fault(("range",), f"'{angle.where}' is hardly ever between {low:.4g} and {high:.4g} rad"))
    q, psi, J = q[inside], psi[inside], J[inside]
    load = Potential(mechanism)(q).torque
    degree = DEGREE_ALONE if tree.n == 1 else DEGREE
    rows = np.polynomial.chebyshev.chebvander((2 * psi - low - high) / (high - low), degree)
    A = (J[:, :, None] * rows[:, None, :]).reshape(-1, degree + 1)
    found = _regression(A, -load.ravel())
    found[np.abs(found) < NOISE * np.abs(found).max(initial=0)] = 0.0
    torque = Chebyshev(found, domain=[low, high])
    if not np.abs(found).max() > 1e-9 * max(float(np.abs(load).max(initial=0)), 1e-12):
        raise InputError(Fault(("joint",), f"'{angle.where}' carries no torque that goes with its angle"))
    return Wanted(joints, low, high, torque)


def _regression(A: Array, b: Array) -> Array:
    """The coefficients (columns,) of so many first columns of A as the data speak for, the rest 0.

    By the Bayesian information criterion: what scatters with the other joints is no reason for a wavy torque.
    """
    Q, R = np.linalg.qr(A)
    along = Q.T @ b
    total = float(b @ b) or 1.0
    rest = b - Q @ along
    beyond = np.append(np.cumsum(along[:0:-1] ** 2)[::-1], 0.0)  # without cancellation
    left = np.maximum(rest @ rest + beyond, ROUNDING * total)
    used = np.arange(1, len(along) + 1)
    count = int(used[np.argmin(len(b) * np.log(left / len(b)) + used * np.log(len(b)))])
    found = np.zeros(len(along))
    found[:count] = np.linalg.solve(R[:count, :count], along[:count])
    return found


def of_law(mechanism: Mechanism, joints: Terms, law: Law, between: tuple[float, float] | None = None) -> Wanted:
    """The energy that an element on joints has.

    Raises:
        InputError: as `wanted`.
    """
    angle, tree = _angle(mechanism, joints), Tree.of(mechanism)
    low, high = _ends(tree, angle, between)
    return Wanted(joints, low, high, Chebyshev.interpolate(law.pull, DEGREE_OF_LAW, domain=[low, high]))


def _angle(mechanism: Mechanism, joints: Terms) -> JointElement:
    angle = JointElement("cam", joints, Cam(cosine=(1.0,)))
    if faults := [fault for fault in angle.faults(mechanism) if "cosine" not in fault.path]:
        raise InputError([Fault(("joint",), fault.message, fault.choices) for fault in faults])
    return angle


def _ends(tree: Tree, angle: JointElement, between: tuple[float, float] | None) -> tuple[float, float]:
    """The angles that count [rad]."""
    low, high = between or _reached(tree, angle)
    if high - low > 2 * np.pi - 0.1:
        what = "angles over a turn or more" if between else "a range of a turn or more"
        raise InputError(Fault(("joint",), f"'{angle.where}' has {what}, and a profile has less: give 'range'"))
    return low, high


def _reached(tree: Tree, angle: JointElement) -> tuple[float, float]:
    """The least and the largest sum of angles inside the joints' ranges [rad]."""
    if tree.mechanism.loops:
        psi = _poses(tree, angle)[1]
        return float(psi.min()), float(psi.max())
    rows, ratios = [tree.rows[joint] for joint, _ in angle.joints], np.array([ratio for _, ratio in angle.joints])
    c, (lower, upper) = ratios @ tree.C[rows], bounds(tree)
    middle, half = float(ratios @ tree.s0[rows] + c @ (lower + upper) / 2), float(np.abs(c) @ (upper - lower) / 2)
    return middle - half, middle + half


def _poses(tree: Tree, angle: JointElement) -> tuple[Array, Array, Array]:
    """Poses (N, n), the angle there (N,), and its slope (N, n)."""
    if tree.n == 1:
        low, high = (float(end[0]) for end in bounds(tree))
        q = (low + high) / 2 - (high - low) / 2 * np.cos(np.linspace(0, np.pi, ALONE))[:, None]
    else:
        q = sample(tree, tree.mechanism.workspace.samples)
    poses = tree.poses(q)
    return q, angle.path(tree, poses), angle.lever_arms(tree, poses, tree.velocities(q, poses))

"""The cams of one joint, or of one sum of joints: the Fourier coefficients of their energy are free.

What it bounds is what any cam or non-circular pulley there can do whose energy has so many harmonics. Whether an
ordinary spring gives it is for the method `cam` to say. Cams on one sum add up, so one is as good as any number.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from ...energy.fourier.frames import Frames
from ...energy.fourier.series import Series
from ...kinematics import Poses, Tree, Velocities
from ...model.arrays import Array
from ...model.elements import JointElement
from ...model.elements.laws import Cam
from ...model.elements.laws.law import Terms
from ...model.errors import Fault, InputError
from ...model.mechanism import Mechanism
from ...model.names import Names
from ..cam.terms import terms
from .ball_block import BallBlock
from .blocks import Cone

HARMONICS = 4
ROUNDING = 1e-9  # of the largest coefficient: one that is zero


@dataclass(frozen=True)
class CamBlock(BallBlock):
    """A cam on the sum of ratio times angle of `joints`.

    The unknowns are an amplitude, which does nothing itself, and the coefficients of cosines and sines of one to
    `harmonics` times the angle, at most that amplitude together [J]. A part is a cam, its shape the coefficients of
    one of amplitude 1.
    """

    joints: Terms
    harmonics: int = HARMONICS

    @staticmethod
    def each(mechanism: Mechanism, given: Iterable[str]) -> Iterator[CamBlock]:
        """One for every joint or sum such as "shoulder+elbow".

        Raises:
            InputError: no such joint, or one twice.
        """
        seen: set[Terms] = set()
        for text in given:
            joints = terms(mechanism, text, "cams")
            if joints in seen:
                raise InputError(Fault(("cams",), f"'{text}' is there twice"))
            seen.add(joints)
            yield CamBlock(joints)

    @property
    def unknowns(self) -> int:
        return 1 + 2 * self.harmonics

    @property
    def shape(self) -> int:
        return 2 * self.harmonics

    @property
    def place(self) -> tuple[str, ...]:
        return (f"cam on {self._element(1.0, np.eye(self.shape)[0], 'cam').where}",)

    @property
    def _amplitudes(self) -> list[tuple[int, float, float]]:
        """(times, cosine, sine) of each unknown but the first."""
        n = range(1, self.harmonics + 1)
        return [*((times, 1.0, 0.0) for times in n), *((times, 0.0, 1.0) for times in n)]

    def series(self, frames: Frames) -> Series:
        found = [(frames.harmonics(self.joints, [one]), i) for i, one in enumerate(self._amplitudes, start=1)]
        rows = np.eye(self.unknowns)
        return Series.sum([Series(one.keys, one.coef[:, :, 0] * rows[i]) for one, i in found])

    def sampled(self, tree: Tree, q: Array, poses: Poses, velocities: Velocities) -> tuple[Array, Array]:
        element = self._element(1.0, np.eye(self.shape)[0], "cam")
        angle, arms = element.path(tree, poses), element.lever_arms(tree, poses, velocities)
        turn = angle[:, None] * np.arange(1, self.harmonics + 1)
        n = np.arange(1, self.harmonics + 1)
        nothing = np.zeros((len(q), 1))
        torque = np.hstack([nothing, -n * np.sin(turn), n * np.cos(turn)])
        return arms[:, :, None] * torque[:, None], np.hstack([nothing, np.cos(turn), np.sin(turn)]).sum(axis=0)

    def cones(self) -> Iterable[Cone]:
        yield Cone("second order", np.eye(self.unknowns))

    def cost(self, energy: Array) -> Array:
        return np.eye(self.unknowns)[0]

    def add(self, mechanism: Mechanism, k: float, u: Array) -> Mechanism:
        names = Names(spring.name for spring in mechanism.springs)
        name = names.new(f"{'-'.join(joint for joint, _ in self.joints)} cam")
        return mechanism.with_springs((*mechanism.springs, self._element(k, u, name)))

    def _element(self, k: float, u: Array, name: str) -> JointElement:
        coefficients = k * np.where(np.abs(u) < ROUNDING * np.abs(u).max(), 0.0, u)
        cosine, sine = (np.trim_zeros(part, "b").tolist() for part in np.split(coefficients, 2))
        return JointElement(name, self.joints, Cam(cosine=tuple(cosine), sine=tuple(sine)))

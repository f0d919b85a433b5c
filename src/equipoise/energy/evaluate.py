"""Energy and torque of any mechanism at any number of poses: compiled where that pays, else the slow sum."""

from __future__ import annotations

from numpy.typing import ArrayLike

from ..model.mechanism import Mechanism
from .reference import Reference, State

FEW = 32  # poses for which writing down a program does not pay


class Potential:
    """Energy and torque of a mechanism at given configurations.

    Attributes:
        reference: the slow sum, with which the tests of `kernel` compare the compiled one.

    Raises:
        InputError: its loops cannot be closed.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.reference = Reference(mechanism)
        self.tree = self.reference.tree

    def __call__(self, q: ArrayLike) -> State:
        """Energies, paths and torques at `q`, (N, n) or (n,) for one pose (N = 1)."""
        q = self.tree.batch(q)
        if len(q) < FEW or self.mechanism.loops or not all(spring.compiled for spring in self.mechanism.springs):
            return self.reference(q)
        from .kernel import Kernel  # only who has many poses waits for it

        parts = Kernel.of(self.mechanism).parts(q)
        return State.of(self.mechanism, parts.gravity, parts.path, parts.gravity_torque, parts.spring_torque)

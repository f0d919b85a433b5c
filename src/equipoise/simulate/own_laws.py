"""Laws of springs that MuJoCo lacks, asked of ours at its own lengths: they then act at its own lever arms."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from ..io.mjcf_springs import beyond
from ..model.mechanism import Mechanism
from .quiet import quiet


class OwnLaws:
    """Those of a mechanism; `mj` is the engine."""

    def __init__(self, mj: Any, mechanism: Mechanism) -> None:
        self._mj, self._laws = mj, beyond(mechanism)
        self._actuated = [(spring.name, spring.law) for spring in mechanism.springs if not spring.mjcf()[1]]

    def _bias(self, model: Any, data: Any, actuator: int) -> float:
        """The force [N or N m] of an actuator that stands for a law."""
        law = self._laws[model.actuator(actuator).name]
        return -float(law.pull(np.array(data.actuator_length[actuator])))

    @contextmanager
    def acting(self) -> Iterator[None]:
        """With the laws as the engine's own, which has one place for them in a process; it says nothing meanwhile."""
        mj = self._mj
        with quiet(mj):
            if not self._laws:
                yield
                return
            before = mj.get_mjcb_act_bias()
            mj.set_mjcb_act_bias(self._bias)
            try:
                yield
            finally:
                mj.set_mjcb_act_bias(before)

    def energy(self, data: Any) -> float:
        """[J] of all that are actuators, which the engine does not count."""
        return sum(float(law.energy(np.array(data.tendon(name).length[0]))) for name, law in self._actuated)

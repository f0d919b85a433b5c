"""What acts in an MJCF model beside what `mjcf_read` reads: flags that switch things off, forces without counterpart.

A force that the engine counts as passive or as bias at rest is either read, or named by one of these.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .notes import Notes

LEFT_OUT = (
    ("body", "body_gravcomp", "gravity compensation (gravcomp) is left out: the full weight counts"),
    ("joint", "jnt_stiffness", "the spring (stiffness) of a joint that is no hinge is left out"),
    ("joint", "jnt_stiffnesspoly", "what is curved in a joint's spring (stiffness with several numbers) is left out"),
    ("joint", "jnt_springyield", "a joint's spring is read as one that does not yield"),
    ("tendon", "tendon_limited", "limits of a tendon's length are left out"),
    ("tendon", "tendon_frictionloss", "friction of a tendon is left out"),
)
"""What belongs to each kind of element, by the array of the model that holds it, and what is said where it is not 0."""

TAGS = {"joint": ("joint", "freejoint"), "tendon": ("spatial", "fixed"), "equality": ("connect", "weld"),
        "flex": ("flex", "flexcomp"), "actuator": ("general", "muscle")}  # fmt: skip
"""How the elements of a kind may be called in a file, where not as the kind."""


@dataclass(frozen=True)
class Model:
    """A compiled model with the means to name its parts.

    Attributes:
        mj, model: the engine, and the compiled model.
        notes: what is to be said.
        lines: of the elements of the file itself, by tag and name.
    """

    mj: Any
    model: Any
    notes: Notes
    lines: Mapping[tuple[str, str], int]

    def name(self, kind: str, i: int) -> str:
        """The engine's name of an element of a kind, empty where it has none."""
        return self.mj.mj_id2name(self.model, int(getattr(self.mj.mjtObj, f"mjOBJ_{kind.upper()}")), i) or ""

    def note(self, kind: str, i: int, message: str) -> None:
        self.notes.note(*self._place(kind, i, message))

    def refuse(self, kind: str, i: int, message: str) -> None:
        self.notes.refuse(*self._place(kind, i, message))

    def _place(self, kind: str, i: int, message: str) -> tuple[str, str, int | None]:
        name = self.name(kind, i)
        found = (self.lines.get((tag, name)) for tag in TAGS.get(kind, (kind,)))
        line = next((line for line in found if name and line is not None), None)
        return f"{kind} '{name}'" if name else f"{kind} {i}", message, line

    def off(self, *flags: str) -> bool:
        """Whether a flag of these is disabled; engines differ in the flags they have."""
        bits = (int(getattr(self.mj.mjtDisableBit, f"mjDSBL_{flag.upper()}", 0)) for flag in flags)
        return any(self.model.opt.disableflags & bit for bit in bits)

    def alone(self, actuator: int) -> bool:
        """Whether an actuator exerts a force that nothing steers."""
        model = self.model
        return not np.any(model.actuator_gainprm[actuator]) and bool(np.any(model.actuator_biasprm[actuator, :2]))

    def bias(self, a: int) -> tuple[int, float, float] | None:
        """Of such an actuator on a tendon: the tendon, and (b0, b1) of its force ``-(b0 + b1 length)``; else None."""
        model, mj = self.model, self.mj
        if not self.alone(a) or int(model.actuator_trntype[a]) != int(mj.mjtTrn.mjTRN_TENDON):
            return None
        b0, b1, damping = (-float(x) for x in model.actuator_biasprm[a, :3])
        plain = int(model.actuator_biastype[a]) == int(mj.mjtBias.mjBIAS_AFFINE) and model.actuator_gear[a, 0] == 1.0
        limited = model.actuator_forcelimited[a]
        return (int(model.actuator_trnid[a, 0]), b0, b1) if plain and b1 >= 0 and not damping and not limited else None

    def effort(self, j: int) -> float | None:
        """What the actuators of a hinge or slide can do together, where all of them or the joint have a limit."""
        model, mj, found = self.model, self.mj, 0.0
        for a in np.flatnonzero(model.actuator_trnid[:, 0] == j) if model.nu else ():
            at_joint = int(model.actuator_trntype[a]) in (
                int(mj.mjtTrn.mjTRN_JOINT),
                int(mj.mjtTrn.mjTRN_JOINTINPARENT),
            )
            if at_joint and not self.alone(int(a)):
                found += abs(float(model.actuator_gear[a, 0])) * self._limit(int(a))
        own = float(np.abs(model.jnt_actfrcrange[j]).max()) if model.jnt_actfrclimited[j] else np.inf
        found = min(found or np.inf, own)
        return found if 0 < found < np.inf else None

    def _limit(self, a: int) -> float:
        """[N m or N] the most force of an actuator, by its forcerange, or of a motor by its ctrlrange."""
        model, mj = self.model, self.mj
        if model.actuator_forcelimited[a]:
            return float(np.abs(model.actuator_forcerange[a]).max())
        plain = int(model.actuator_gaintype[a]) == int(mj.mjtGain.mjGAIN_FIXED)
        motor = plain and int(model.actuator_biastype[a]) == int(mj.mjtBias.mjBIAS_NONE)
        if motor and int(model.actuator_dyntype[a]) == int(mj.mjtDyn.mjDYN_NONE) and model.actuator_ctrllimited[a]:
            return float(np.abs(model.actuator_gainprm[a, 0] * model.actuator_ctrlrange[a]).max())
        return np.inf

    def say(self) -> None:
        """Name what acts and is not read, and the flags that are heeded."""
        model, notes = self.model, self.notes
        self._flags()
        springs = not self.off("spring", "passive")
        for kind, array, message in LEFT_OUT:
            values = getattr(model, array, np.zeros(0))  # an older engine has no such thing
            if array == "jnt_stiffness":
                values = np.where(model.jnt_type == int(self.mj.mjtJoint.mjJNT_HINGE), 0.0, values)
            for i in np.flatnonzero(values.reshape(len(values), -1).any(axis=1)) if len(values) else ():
                if springs or "spring" not in message:
                    self.note(kind, int(i), message)
        for f in range(model.nflex):
            self.refuse("flex", f, "is an elastic body: only rigid ones are known")
        for b in np.flatnonzero(model.body_plugin >= 0):
            self.note("body", int(b), "the force of a plugin is left out")
        if np.any(model.opt.wind) and (model.opt.density or model.opt.viscosity):
            notes.note("<option wind>", "the force of wind is left out")
        for a in range(getattr(model, "nactuator", model.nu)):
            kind, bias = int(model.actuator_biastype[a]), self.mj.mjtBias
            own = kind in (int(bias.mjBIAS_MUSCLE), int(bias.mjBIAS_USER))
            if own or (self.alone(a) and self.bias(a) is None):
                self.note("actuator", a, "what it pulls without being told to is left out")

    def _flags(self) -> None:
        model, elastic = self.model, (self.model.tendon_stiffness, self.model.jnt_stiffness)
        for flags, acts, what in (
            (("spring", "passive"), any(np.any(values) for values in elastic), "springs"),
            (("equality", "constraint"), bool(np.any(model.eq_active0)), "equalities"),
            (("limit", "constraint"), bool(np.any(model.jnt_limited)), "ranges of joints"),
            (("gravity",), True, "gravity"),
        ):
            if acts and self.off(*flags):
                self.notes.note(
                    f"<flag {flags[0]}='disable'>", f"{what} off: it is heeded", self.lines.get(("flag", ""))
                )

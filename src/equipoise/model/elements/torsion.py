"""The torsion spring: the angle of a joint, or a sum of several with ratios, as path, times the linear law."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import degrees, isfinite, pi
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..arrays import Array
from ..errors import Fault, finite, known, positive
from .element import Element, End, Knob, Pens, Range, Tendon
from .law import Linear

if TYPE_CHECKING:
    from ...energy.fourier.frames import Frames
    from ...energy.fourier.series import Series
    from ...energy.kernel.trace import Trace, Value
    from ...energy.span.nodes import Nodes
    from ...kinematics import Poses, Tree, Velocities
    from ..mechanism import Mechanism

TURNS, POINTS = 2.5, 49  # of the spiral that stands for it in pictures
SPIRAL = 0.25  # its radius, of the distance to what its joint carries


@dataclass(frozen=True)
class TorsionSpring(Element):
    """A linear spring on the angle of a joint, or on ``sum(ratio * angle)`` of several.

    Its energy is ``stiffness/2 * (angle - rest)**2``: it turns back both ways.

    Attributes:
        joints: (name, ratio) of each revolute joint.
        stiffness: [N m/rad], positive.
        rest: the angle at which it exerts nothing [rad].
    """

    kind: ClassVar[str] = "torsion"
    noun: ClassVar[str] = "a torsion spring"
    knobs: ClassVar[tuple[Knob, ...]] = (
        Knob("stiffness", "stiffness [N m/rad]"),
        Knob("rest", "relaxed at [deg]", 180 / pi, -360.0, 360.0),
    )
    path_unit: ClassVar[str] = "rad"
    force_unit: ClassVar[str] = "N m"

    name: str
    joints: tuple[tuple[str, float], ...]
    stiffness: float
    rest: float = 0.0

    @property
    def law(self) -> Linear:
        return Linear(self.stiffness, self.rest)

    def path(self, tree: Tree, poses: Poses) -> Array:
        return sum((ratio * poses.s[:, tree.rows[joint]] for joint, ratio in self.joints), np.zeros(len(poses.s)))

    def state(self, tree: Tree, poses: Poses, velocities: Velocities) -> tuple[Array, Array]:
        angle = self.path(tree, poses)
        rows, ratios = [tree.rows[joint] for joint, _ in self.joints], [ratio for _, ratio in self.joints]
        rate = np.einsum("r,nrj->nj", ratios, velocities.s[:, rows])
        return angle, self.law.force(angle)[:, None] * rate

    def series(self, frames: Frames) -> Series:
        c0, c1, c2 = self.law.polynomial
        angle = frames.value(self.joints)
        return angle.sum([frames.constant(np.array([[c0]])), angle.scaled(c1), (angle @ angle).scaled(c2)])

    def affine(self, nodes: Nodes) -> Array:
        angle = nodes.zero()
        angle[0, :, 0] = nodes.value(self.joints)
        angle[0, 0, 0] -= self.rest
        return np.sqrt(self.stiffness) * angle

    @property
    def turns(self) -> tuple[str, ...]:
        return tuple(joint for joint, _ in self.joints)

    def symbols(self, t: Trace, pens: Pens) -> tuple[Value, Value]:
        angle, pull = pens.angle(self.joints)
        energy, force = self.law.of_path(t, angle)
        pull(force)
        return angle, energy

    def faults(self, mechanism: Mechanism) -> Iterator[Fault]:
        revolute = [joint.name for joint in mechanism.joints if joint.type == "revolute"]
        if not self.joints:
            yield Fault(("joints",), "names no joint")
        for i, (joint, ratio) in enumerate(self.joints):
            yield from known(("joints", joint), joint, "revolute joint", revolute)
            if joint in [name for name, _ in self.joints[:i]]:
                yield Fault(("joints", joint), f"joint '{joint}' is named twice")
            if not (isfinite(ratio) and ratio):
                yield Fault(("joints", joint), f"its ratio must be finite and not 0, found {ratio:g}")
        yield from positive(("stiffness",), self.stiffness, "N m/rad")
        yield from finite(("rest",), self.rest)

    def to_dict(self, path: Range, force: Range) -> dict[str, Any]:
        return {
            "name": self.name,
            "kind": self.kind,
            "joints": dict(self.joints),
            "stiffness": self.stiffness,
            "rest": self.rest,
            "path": list(path),
            "force": list(force),
            "unit": self.force_unit,
        }

    def mjcf(self) -> Tendon:
        sign = -1.0 if self.rest == -1.0 else 1.0  # that number means "as in the model's zero pose" to the engine
        numbers = {"stiffness": [self.stiffness], "springlength": [sign * self.rest] * 2}
        return "fixed", numbers, [("joint", {"joint": joint, "coef": sign * ratio}) for joint, ratio in self.joints]

    def outline(self, tree: Tree) -> tuple[End, ...]:
        """A spiral about the first joint's axis, as large as what the joint carries suggests."""
        joint = self.joints[0][0]
        link = next(link for link in tree.links if link.joint.name == joint)
        axis = link.motions[0].axis
        ahead = [np.linalg.norm(other.p0) for other in tree.links if other.parent == link.body]
        com = np.linalg.norm(tree.mechanism.bodies[link.body - 1].com)
        radius = SPIRAL * float(max([*ahead, com], default=0.0) or np.linalg.norm(link.p0) or 1.0)
        x = np.eye(3)[int(np.argmin(np.abs(axis)))]
        x = x - (x @ axis) * axis
        x /= np.linalg.norm(x)
        y = np.cross(axis, x)
        turn = 2 * pi * TURNS * np.linspace(0, 1, POINTS)
        spiral = (
            radius * np.linspace(0.15, 1, POINTS)[:, None] * (np.cos(turn)[:, None] * x + np.sin(turn)[:, None] * y)
        )
        places = link.p0 + spiral @ link.R0.T
        parent = tree.names[link.parent]
        return tuple((parent, (float(a), float(b), float(c))) for a, b, c in places)

    @property
    def where(self) -> str:
        parts = [f"{'-' if ratio < 0 else '+'} {'' if abs(ratio) == 1 else f'{abs(ratio):g} '}{joint}"
                 for joint, ratio in self.joints]  # fmt: skip
        return " ".join(parts).removeprefix("+ ")

    @property
    def between(self) -> str:
        return f"on {self.where}"

    @property
    def strength(self) -> tuple[float, str]:
        return self.stiffness, "N m/rad"

    @property
    def free(self) -> float:
        return self.rest

    def sentence(self, path: Range, force: Range) -> str:
        low, high = (degrees(angle) for angle in path)
        use = f"{low:.1f} to {high:.1f} deg, up to {max(map(abs, force)):.3g} N m"
        return (
            f"{self.name}: {self.stiffness:.5g} N m/rad on {self.where}, relaxed at {degrees(self.rest):.4g} deg, {use}"
        )

    def scaled(self, factor: float) -> TorsionSpring:
        return replace(self, stiffness=factor * self.stiffness)

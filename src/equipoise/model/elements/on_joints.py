"""Elements on joints: the angle of a joint, or a sum of several with ratios, as path."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees, isfinite, pi
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..arrays import Array, vec3
from ..errors import Fault, NoFourierForm, known
from ..rotation import frame_of
from .cam_outline import Track, outline
from .element import Element, End, Pens, Range, Tendon
from .laws import Cam
from .laws.law import Terms

if TYPE_CHECKING:
    from ...energy.fourier.frames import Frames
    from ...energy.fourier.series import Series
    from ...energy.kernel.trace import Trace, Value
    from ...energy.span.nodes import Nodes
    from ...kinematics import Poses, Tree, Velocities
    from ..mechanism import Mechanism

TURNS, POINTS = 2.5, 49  # of the spiral that stands for it in pictures
SPIRAL = 0.25  # its radius, of the distance to what its joint carries


class OnJoints(Element):
    """An element on ``sum(ratio * angle)`` of the `joints` (name, ratio)."""

    path_unit: ClassVar[str] = "rad"
    force_unit: ClassVar[str] = "N m"

    if TYPE_CHECKING:
        joints: Terms

    # physics

    def path(self, tree: Tree, poses: Poses) -> Array:
        return sum((ratio * poses.s[:, tree.rows[joint]] for joint, ratio in self.joints), np.zeros(len(poses.s)))

    def lever_arms(self, tree: Tree, poses: Poses, velocities: Velocities) -> Array:
        rows, ratios = [tree.rows[joint] for joint, _ in self.joints], [ratio for _, ratio in self.joints]
        return np.einsum("r,nrj->nj", ratios, velocities.s[:, rows])

    def series(self, frames: Frames) -> Series:
        found = self.law.series(frames, self.joints)
        if found is None:
            raise NoFourierForm(f"'{self.name}' is {self.noun} by points: its energy is no finite sum of sines")
        return found

    def affine(self, nodes: Nodes) -> Array:
        _, c1, c2 = self.law.polynomial or (0.0, 0.0, 0.0)
        if not c2 > 0:
            raise NoFourierForm(f"'{self.name}' is {self.noun}: its energy is no square of an angle")
        angle = nodes.zero()
        angle[0, :, 0] = nodes.value(self.joints)
        angle[0, 0, 0] += c1 / (2 * c2)
        return np.sqrt(2 * c2) * angle

    @property
    def turns(self) -> tuple[str, ...]:
        return tuple(joint for joint, _ in self.joints)

    def symbols(self, t: Trace, pens: Pens) -> tuple[Value, Value]:
        angle, pull = pens.angle(self.joints)
        energy, force = self.law.of_path(t, angle)
        pull(force)
        return angle, energy

    # files

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
        yield from self.law.faults()

    @property
    def keys(self) -> dict[str, Any]:
        return {"joints": dict(self.joints), **self.law.values()}

    def mjcf(self) -> Tendon:
        numbers, sign = dict(self.law.mjcf() or {}), 1.0
        if -1.0 in numbers.get("springlength", ()):  # that number means "as in the model's zero pose" to the engine
            sign, numbers["springlength"] = -1.0, tuple(-x for x in numbers["springlength"][::-1])
        return "fixed", numbers, [("joint", {"joint": joint, "coef": sign * ratio}) for joint, ratio in self.joints]

    # pictures and words

    def outline(self, tree: Tree) -> tuple[End | Track, ...]:
        """A cam's profile with what runs on it, where that is known; else a spiral about the first joint's axis.

        It is as large as what the joint carries suggests.
        """
        if isinstance(self.law, Cam) and self.law.made is not None and not self.law.made.run.folds:
            return outline(self.law.made, tree, self.joints)
        joint = self.joints[0][0]
        link = next(link for link in tree.links if link.joint.name == joint)
        axis = link.motions[0].axis
        ahead = [np.linalg.norm(other.p0) for other in tree.links if other.parent == link.body]
        com = np.linalg.norm(tree.mechanism.bodies[link.body - 1].com)
        radius = SPIRAL * float(max([*ahead, com], default=0.0) or np.linalg.norm(link.p0) or 1.0)
        x, y, _ = frame_of(axis)
        turn = 2 * pi * TURNS * np.linspace(0, 1, POINTS)
        spiral = (
            radius * np.linspace(0.15, 1, POINTS)[:, None] * (np.cos(turn)[:, None] * x + np.sin(turn)[:, None] * y)
        )
        places = link.p0 + spiral @ link.R0.T
        parent = tree.names[link.parent]
        return tuple((parent, vec3(p)) for p in places)

    @property
    def where(self) -> str:
        parts = [f"{'-' if ratio < 0 else '+'} {'' if abs(ratio) == 1 else f'{abs(ratio):g} '}{joint}"
                 for joint, ratio in self.joints]  # fmt: skip
        return " ".join(parts).removeprefix("+ ")

    @property
    def between(self) -> str:
        return f"on {self.where}"

    def sentence(self, path: Range, force: Range) -> str:
        low, high = (degrees(angle) for angle in path)
        use = f"{low:.1f} to {high:.1f} deg, {force[0]:.4g} to {force[1]:.4g} N m"
        return f"{self.name}: {self.law.noun.split(' ', 1)[1]}, {self.law.words()}, on {self.where}, {use}"

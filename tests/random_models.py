"""Random MJCF models with random features of the format: what we read, what we have no counterpart for, and flags."""

from __future__ import annotations

import numpy as np

FLAGS = ("gravity", "spring", "equality", "limit", "constraint", "damper", "contact")
INERTIAL = '<inertial pos="{}" mass="{:.4f}" diaginertia="0.02 0.03 0.04"/>'


class RandomModel:
    """A model; the same for the same seed. `text` is the file."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.degrees = self.chance(0.5)
        self.joints: list[str] = []
        self.free: list[str] = []
        self.count = int(self.rng.integers(1, 6))
        world = "".join(self._site("world", k) for k in range(2)) + self._bodies()
        between = self._equalities() + self._tendons() + self._actuators()
        option = f'<option gravity="{self.vector(10)}"{self._air()}>{self._flags()}</option>'
        angle = "degree" if self.degrees else "radian"
        self.text = (
            f'<mujoco model="random {seed}"><compiler angle="{angle}"/>{option}'
            f'<default><joint damping="0.1"/></default>'
            f"<worldbody>{world}</worldbody>{between}</mujoco>"
        )

    def chance(self, share: float) -> bool:
        return bool(self.rng.random() < share)

    def vector(self, size: float) -> str:
        return " ".join(f"{x:.4f}" for x in self.rng.uniform(-size, size, 3))

    def angle(self, size: float) -> str:
        return f"{self.rng.uniform(-size, size) * (180 / np.pi if self.degrees else 1):.4f}"

    def name(self, k: int) -> str:
        return "world" if k < 0 else f"b{k}"

    def pair(self) -> tuple[str, str]:
        a, b = self.rng.choice(np.arange(-1, self.count), 2, replace=False)
        return self.name(int(a)), self.name(int(b))

    def _site(self, body: str, k: int) -> str:
        return f'<site name="{body} {k}" pos="{self.vector(0.3)}" quat="{self.vector(1)} 1"/>'

    def _bodies(self) -> str:
        inside: dict[int, str] = dict.fromkeys(range(-1, self.count), "")
        for k in reversed(range(self.count)):
            parent = int(self.rng.integers(-1, k)) if k and self.chance(0.8) else -1
            if k and self.chance(0.6):
                parent = k - 1
            kinds = self._joints(k, parent)
            turn = f'quat="{self.vector(1)} 1"' if self.chance(0.5) else f'euler="{self.angle(3)} {self.angle(3)} 0"'
            mass = INERTIAL.format(self.vector(0.2), self.rng.uniform(0.2, 3))
            if self.chance(0.3):
                density = self.rng.uniform(100, 2000)
                mass = f'<geom type="box" size=".1 .05 .02" pos="{self.vector(0.2)}" density="{density:.1f}"/>'
            held = ' gravcomp="0.5"' if self.chance(0.05) else ""
            sites = "".join(self._site(self.name(k), i) for i in range(2))
            body = f'<body name="b{k}" pos="{self.vector(0.4)}" {turn}{held}>{kinds}{mass}{sites}{inside[k]}</body>'
            inside[parent] += body
        return inside[-1]

    def _joints(self, k: int, parent: int) -> str:
        if parent < 0 and self.chance(0.1):
            self.free.append(f"b{k}")
            return f'<freejoint name="f{k}"/>'
        text = ""
        for i in range(int(self.rng.choice([0, 1, 1, 1, 2, 3]))):
            kind, name = str(self.rng.choice(["hinge", "hinge", "hinge", "slide"])), f"j{k}{'abc'[i]}"
            more = f' axis="{self.vector(1)}" pos="{self.vector(0.2)}"'
            size = (
                (lambda x: f"{x:.4f}")
                if kind == "slide"
                else (lambda x: f"{x * (57.29578 if self.degrees else 1):.4f}")
            )
            if self.chance(0.2):
                more += f' ref="{size(self.rng.uniform(-1, 1))}"'
            if self.chance(0.4):
                low, high = sorted(self.rng.uniform(-2, 2, 2))
                more += f' range="{size(low)} {size(high)}" limited="true"'
            if self.chance(0.05):
                more += ' stiffness="3"'
            self.joints.append(name)
            text += f'<joint name="{name}" type="{kind}"{more}/>'
        if not text and self.chance(0.4):
            text = f'<joint name="ball{k}" type="ball"/>'
        return text

    def _equalities(self) -> str:
        text = ""
        if len(self.joints) > 1 and self.chance(0.3):
            a, b = self.rng.choice(self.joints, 2, replace=False)
            curve = 0.3 if self.chance(0.1) else 0
            coefficients = f"{self.angle(0.5)} {self.rng.uniform(-2, 2):.3f} {curve} 0 0"
            text += f'<joint joint1="{a}" joint2="{b}" polycoef="{coefficients}"/>'
        elif self.joints and self.chance(0.1):
            text += f'<joint joint1="{self.rng.choice(self.joints)}" polycoef="0.2 0 0 0 0"/>'
        for body in self.free:
            if self.chance(0.7):
                anchor = f'anchor="{self.vector(0.2)}"' if self.chance(0.5) else ""
                text += (
                    f'<weld body1="{body}" body2="world" relpose="{self.vector(0.3)} 1 {self.vector(0.5)}" {anchor}/>'
                )
        if 1 < self.count < 4 and self.chance(0.25):  # larger ones take long to close
            a, b = self.pair()
            text += f'<connect body1="{a}" body2="{b}" anchor="{self.vector(0.3)}"/>'
        return f"<equality>{text}</equality>"

    def _tendons(self) -> str:
        text = ""
        for t in range(int(self.rng.integers(0, 3))):
            a, b = (f'<site site="{body} {self.rng.integers(2)}"/>' for body in self.pair())
            length = str(
                self.rng.choice(
                    ["", ' springlength="0 0"', ' springlength="0.1"', ' springlength="0 0.1"'],
                    p=[0.3, 0.4, 0.25, 0.05],
                )
            )
            more = '<site site="world 0"/>' if self.chance(0.05) else ""
            stiffness = f' stiffness="{self.rng.uniform(10, 300):.2f}"' if self.chance(0.9) else ""
            limited = ' limited="true" range="0 1"' if self.chance(0.05) else ""
            text += f'<spatial name="t{t}"{stiffness}{length}{limited}>{a}{b}{more}</spatial>'
        if self.joints and self.chance(0.05):
            text += f'<fixed name="f" stiffness="4"><joint joint="{self.rng.choice(self.joints)}" coef="2"/></fixed>'
        return f"<tendon>{text}</tendon>"

    def _actuators(self) -> str:
        chosen = [name for name in self.joints if self.chance(0.3)]
        motors = "".join(f'<motor joint="{name}"/>' for name in chosen)
        return f"<actuator>{motors}</actuator>"

    def _air(self) -> str:
        if not self.chance(0.1):
            return ""
        return ' density="1.2"' if self.chance(0.5) else f' viscosity="0.01" wind="{self.vector(3)}"'

    def _flags(self) -> str:
        off = [flag for flag in FLAGS if self.chance(0.02)]
        settings = " ".join(f'{flag}="disable"' for flag in off)
        return f"<flag {settings}/>" if off else ""

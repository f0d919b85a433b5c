"""The widgets of one spring at a time: its stiffness, its attachment points as numbers and as handles to drag."""

from __future__ import annotations

from collections.abc import Callable
from threading import RLock
from typing import Any

import numpy as np

from ..errors import EquipoiseError
from .model import Model
from .scene import Scene

MOST = 3.0  # the stiffness slider goes to this many times the present one
SAME = 5e-5  # [m] a number field shows tenths of a millimetre


class SpringPanel:
    """Chooses a spring of the model and changes it, while it holds `lock`.

    Afterwards `rebuilt` brings the page to the model's state; `say` shows a title and a text.
    """

    def __init__(
        self,
        server: Any,
        model: Model,
        scene: Scene,
        lock: RLock,
        rebuilt: Callable[[], None],
        say: Callable[[str, str], None],
    ) -> None:
        self.server, self.model, self.scene, self.lock = server, model, scene, lock
        self.rebuilt, self.say, self.widgets = rebuilt, say, []
        self.folder = server.gui.add_folder("Springs")
        self.quiet = False
        self.rebuild()

    def rebuild(self) -> None:
        """The springs themselves have changed."""
        for widget in self.widgets:
            widget.remove()
        self.widgets, self.handles = [], []
        with self.folder:
            self._widgets()

    def _widgets(self) -> None:
        springs, gui = self.model.springs, self.server.gui
        if not springs:
            self.widgets = [gui.add_markdown("No springs yet: *Re-optimise* chooses three.")]
            return
        names = tuple(f"{i + 1}: {spring.name}" for i, spring in enumerate(springs))
        self.choice = gui.add_dropdown("spring", names)
        self.choice.on_update(lambda _: self._chosen())
        self.here = gui.add_checkbox("this one is on", self.model.on[0])
        self.here.on_update(lambda _: self._switched())
        self.stiffness = gui.add_slider("stiffness [N/m]", 1.0, 2.0, 0.1, 1.0)
        self.stiffness.on_update(lambda _: self._edited())
        self.points = [gui.add_vector3(label, (0.0, 0.0, 0.0), step=1.0) for label in ("a [mm]", "b [mm]")]
        for point in self.points:
            point.on_update(lambda _: self._edited())
        self.drag = gui.add_checkbox("drag handles", False)
        self.drag.on_update(lambda _: self._dragging())
        self.widgets = [self.choice, self.here, self.stiffness, *self.points, self.drag]
        size = 0.18 * self.scene.size
        for j in range(2):
            handle = self.server.scene.add_transform_controls(
                f"/handle{j}", size, disable_rotations=True, visible=False, depth_test=False
            )
            handle.on_update(lambda event, j=j: self._dragged(j, event.target))
            self.handles.append(handle)
            self.widgets.append(handle)
        self._chosen()

    @property
    def number(self) -> int:
        return int(self.choice.value.partition(":")[0]) - 1

    def follow(self) -> None:
        """Keep the handles on the spring's ends while the mechanism moves."""
        if self.handles and self.drag.value:
            for handle, point in zip(self.handles, self.scene.skeleton.springs[self.number], strict=True):
                handle.position = self.scene.world(point)

    def _chosen(self) -> None:
        with self.lock:
            self._values()
            self.follow()

    def _values(self) -> None:
        spring = self.model.springs[self.number]
        self.quiet = True
        top = float(f"{MOST * spring.stiffness:.2g}")
        self.stiffness.max, self.stiffness.min, self.stiffness.step = top, top / 1000, top / 1000
        self.stiffness.value = spring.stiffness
        self.here.value = self.model.on[self.number]
        for point, p in zip(self.points, (spring.p_a, spring.p_b), strict=True):
            point.value = tuple(round(1000.0 * x, 1) + 0.0 for x in p)  # no minus zero
        self.quiet = False

    def _switched(self) -> None:
        if not self.quiet:
            with self.lock:
                self.model.switch(self.number, self.here.value)
                self.rebuilt()

    def _edited(self) -> None:
        """Take the fields' numbers, where they differ from the spring by more than their own rounding."""
        if self.quiet:
            return
        with self.lock:
            spring, values = self.model.springs[self.number], {}
            if abs(self.stiffness.value - spring.stiffness) > 0.51 * self.stiffness.step:
                values["stiffness"] = max(self.stiffness.value, self.stiffness.min)
            for name, point in zip(("p_a", "p_b"), self.points, strict=True):
                p = np.array(point.value) / 1000.0
                if np.abs(p - getattr(spring, name)).max() > 1.01 * SAME:
                    values[name] = tuple(float(x) for x in p)
            self._change(values)

    def _dragged(self, j: int, handle: Any) -> None:
        with self.lock:
            spring = self.model.springs[self.number]
            body = (spring.body_a, spring.body_b)[j]
            place = self.scene.local(body, handle.position)
            self._change({("p_a", "p_b")[j]: tuple(float(x) for x in place)})
            self._values()

    def _change(self, values: dict[str, Any]) -> None:
        if not values:
            return
        try:
            self.model.change(self.number, **values)
        except EquipoiseError as error:
            self.say("Not possible", str(error))
            self._values()
            return
        self.rebuilt()

    def _dragging(self) -> None:
        with self.lock:
            for handle in self.handles:
                handle.visible = self.drag.value
            self.follow()

"""The widgets of one spring at a time: its stiffness, its attachment points as numbers and as handles to drag."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import EquipoiseError

if TYPE_CHECKING:
    from .panel import Panel

MOST = 3.0  # the stiffness slider goes to this many times the present one
SAME = 5e-5  # [m] a number field shows tenths of a millimetre
FAR = 10.0  # sizes of the mechanism: attachments are this near their bodies' origins, or as the file has them


class SpringPanel:
    """Chooses a spring of the panel's model and changes it."""

    def __init__(self, panel: Panel) -> None:
        self.panel, self.widgets = panel, []
        self.folder = panel.gui.add_folder("Springs")
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
        springs, gui = self.panel.model.springs, self.panel.gui
        if not springs:
            self.widgets = [gui.add_markdown("No springs yet: *Re-optimise* chooses three.")]
            return
        names = tuple(f"{i + 1}: {spring.name}" for i, spring in enumerate(springs))
        self.choice = gui.add_dropdown("spring", names)
        self.choice.on_update(lambda _: self._chosen())
        self.here = gui.add_checkbox("this one is on", self.panel.model.on[0])
        self.here.on_update(lambda _: self._switched())
        self.stiffness = gui.add_slider("stiffness [N/m]", 1.0, 2.0, 0.1, 1.0)
        self.stiffness.on_update(lambda _: self._edited())
        points = [x for spring in springs for p in (spring.p_a, spring.p_b) for x in p]
        self.far = 1000.0 * max(FAR * self.panel.scene.size, 2 * float(np.abs(points).max()))
        ends = {"min": (-self.far,) * 3, "max": (self.far,) * 3, "step": 1.0}
        self.points = [gui.add_vector3(label, (0.0, 0.0, 0.0), **ends) for label in ("a [mm]", "b [mm]")]
        for point in self.points:
            point.on_update(lambda _: self._edited())
        self.drag = gui.add_checkbox("drag handles", False)
        self.drag.on_update(lambda _: self._dragging())
        self.widgets = [self.choice, self.here, self.stiffness, *self.points, self.drag]
        size = 0.18 * self.panel.scene.size
        for j in range(2):
            handle = self.panel.server.scene.add_transform_controls(
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
            for handle, point in zip(self.handles, self.panel.scene.skeleton.springs[self.number], strict=True):
                handle.position = self.panel.scene.world(point)

    def _chosen(self) -> None:
        with self.panel.lock:
            self._values()
            self.follow()

    def _values(self) -> None:
        spring = self.panel.model.springs[self.number]
        self.quiet = True
        top = float(f"{MOST * spring.stiffness:.2g}")
        self.stiffness.max, self.stiffness.min, self.stiffness.step = top, top / 1000, top / 1000
        self.stiffness.value = spring.stiffness
        self.here.value = self.panel.model.on[self.number]
        for point, p in zip(self.points, (spring.p_a, spring.p_b), strict=True):
            point.value = tuple(round(1000.0 * x, 1) + 0.0 for x in p)  # no minus zero
        self.quiet = False

    def _switched(self) -> None:
        if not self.quiet:
            with self.panel.lock:
                self.panel.model.switch(self.number, self.here.value)
                self.panel.show(rebuild=True)

    def _edited(self) -> None:
        """Take the fields' numbers, where they differ from the spring by more than their own rounding."""
        if self.quiet:
            return
        with self.panel.lock:
            spring, values = self.panel.model.springs[self.number], {}
            if abs(self.stiffness.value - spring.stiffness) > 0.51 * self.stiffness.step:
                values["stiffness"] = max(self.stiffness.value, self.stiffness.min)
            for name, point in zip(("p_a", "p_b"), self.points, strict=True):
                p = np.array(point.value) / 1000.0
                if np.abs(p - getattr(spring, name)).max() > 1.01 * SAME:
                    values[name] = tuple(float(x) for x in p)
            self._change(values)

    def _dragged(self, j: int, handle: Any) -> None:
        with self.panel.lock:
            spring = self.panel.model.springs[self.number]
            body = (spring.body_a, spring.body_b)[j]
            place = np.clip(self.panel.scene.local(body, handle.position), -self.far / 1000.0, self.far / 1000.0)
            self._change({("p_a", "p_b")[j]: tuple(float(x) for x in place)})
            self._values()

    def _change(self, values: dict[str, Any]) -> None:
        if not values:
            return
        try:
            self.panel.model.change(self.number, **values)
        except EquipoiseError as error:
            self.panel.say("Not possible", str(error))
            self._values()
            return
        self.panel.show(rebuild=True)

    def _dragging(self) -> None:
        with self.panel.lock:
            for handle in self.handles:
                handle.visible = self.drag.value
            self.follow()

"""The widgets of one spring at a time: its stiffness, its attachment points as numbers and as handles to drag."""

from __future__ import annotations

from collections.abc import Callable
from threading import RLock
from typing import Any

import numpy as np

from ..model.errors import EquipoiseError
from .model import Model
from .scene import Scene

SLIDER_REACH = 3.0  # the stiffness slider goes to this many times the present one
FIELD_ROUNDING = 5e-5  # [m] a number field shows tenths of a millimetre
FAR = 10.0  # sizes of the mechanism: attachments are this near their bodies' origins, or as the file has them


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
        self.rebuilt, self.say = rebuilt, say
        self._forget()
        self.folder = server.gui.add_folder("Springs")
        self.quiet = False
        self.rebuild()

    def rebuild(self) -> None:
        """The springs themselves have changed."""
        for widget in (*self.widgets, *self._own()):
            widget.remove()
        self._forget()
        springs, gui = self.model.springs, self.server.gui
        with self.folder:
            if not springs:
                self.widgets = [gui.add_markdown("No springs yet: *Re-optimise* chooses three.")]
                return
            self.choice = gui.add_dropdown("spring", tuple(f"{i + 1}: {s.name}" for i, s in enumerate(springs)))
            self.choice.on_update(lambda _: self._chosen())
            self.here = gui.add_checkbox("this one is on", self.model.on[0])
            self.here.on_update(lambda _: self._switched())
        points = [x for spring in springs for _, p in spring.ends for x in p]
        self.far = 1000.0 * max(FAR * self.scene.size, 2 * float(np.abs(points).max(initial=0.0)))
        self.widgets = [self.choice, self.here]
        self._numbers()
        self._chosen()

    def _own(self) -> tuple[Any, ...]:
        """The widgets of the chosen spring's own numbers."""
        return (*self.sliders, *self.points, *self.handles, *([self.drag] if self.drag else []))

    def _forget(self) -> None:
        self.widgets: list[Any] = []
        self.sliders: list[Any] = []
        self.points: list[Any] = []
        self.handles: list[Any] = []
        self.drag: Any = None

    def _numbers(self) -> None:
        """The widgets of the chosen spring's own numbers, which are those of its kind."""
        for widget in self._own():
            widget.remove()
        spring, gui = self.model.springs[self.number], self.server.gui
        self.shown = spring.kind, spring.knobs, len(spring.ends)
        with self.folder:
            self.sliders = [gui.add_slider(knob.label, 1.0, 2.0, 0.1, 1.0) for knob in spring.knobs]
            labels = ("a [mm]", "b [mm]") if spring.ends else ()
            ends = {"min": (-self.far,) * 3, "max": (self.far,) * 3, "step": 1.0}
            self.points = [gui.add_vector3(label, (0.0, 0.0, 0.0), **ends) for label in labels]
            for widget in (*self.sliders, *self.points):
                widget.on_update(lambda _: self._edited())
            self.handles, self.drag = [], None
            if spring.ends:
                self.drag = gui.add_checkbox("drag handles", False)
                self.drag.on_update(lambda _: self._dragging())
        size = 0.18 * self.scene.size
        for j in range(len(spring.ends)):
            handle = self.server.scene.add_transform_controls(
                f"/handle{j}", size, disable_rotations=True, visible=False, depth_test=False
            )
            handle.on_update(lambda event, j=j: self._dragged(j, event.target))
            self.handles.append(handle)

    @property
    def number(self) -> int:
        return int(self.choice.value.partition(":")[0]) - 1

    def follow(self) -> None:
        """Keep the handles on the spring's ends while the mechanism moves."""
        if self.drag and self.drag.value:
            line = self.scene.skeleton.springs[self.number]
            for handle, point in zip(self.handles, (line[0], line[-1]), strict=True):
                handle.position = self.scene.world(point)

    def _chosen(self) -> None:
        with self.lock:
            spring = self.model.springs[self.number]
            if self.shown != (spring.kind, spring.knobs, len(spring.ends)):
                self._numbers()
            self._values()
            self.follow()

    def _values(self) -> None:
        spring = self.model.springs[self.number]
        self.quiet = True
        for slider, knob in zip(self.sliders, spring.knobs, strict=True):
            value = knob.factor * spring.number(knob.field)
            top = float(f"{SLIDER_REACH * value:.2g}") if knob.high is None else knob.high
            low = top / 1000 if knob.low is None else knob.low
            slider.max, slider.min, slider.step = top, low, (top - low) / 1000 if knob.low is not None else top / 1000
            slider.value = value
        self.here.value = self.model.on[self.number]
        for point, (_, p) in zip(self.points, spring.ends, strict=True):
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
            for slider, knob in zip(self.sliders, spring.knobs, strict=True):
                if abs(slider.value - knob.factor * spring.number(knob.field)) > 0.51 * slider.step:
                    values[knob.field] = max(slider.value, slider.min) / knob.factor
            for name, point, (_, now) in zip(("p_a", "p_b"), self.points, spring.ends, strict=False):
                p = np.array(point.value) / 1000.0
                if np.abs(p - now).max() > 1.01 * FIELD_ROUNDING:
                    values[name] = tuple(float(x) for x in p)
            self._change(values)

    def _dragged(self, j: int, handle: Any) -> None:
        with self.lock:
            spring = self.model.springs[self.number]
            body, _ = spring.ends[j]
            place = np.clip(self.scene.local(body, handle.position), -self.far / 1000.0, self.far / 1000.0)
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

"""The viewer's widgets: sliders for the coordinates, springs to change, buttons that judge, design, play and save."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ..io import save
from ..kinematics.sampling import bounds
from ..model.errors import EquipoiseError
from . import readout
from .model import Model
from .motions import RATE, motions
from .scene import Scene
from .springs import SpringPanel

STEP = 0.1  # of a coordinate's slider [deg or mm]
HEAVIEST = 3.0  # the slider of a point mass goes to this many times what it is
DRAWN = 15  # poses a second when a motion is played


class Panel:
    """Widgets on a viser server that change a model and show what becomes of it.

    Callbacks run in threads: one at a time holds `lock`, and each reads the newest values of all sliders, so that a
    backlog of old ones does nothing.
    """

    def __init__(self, server: Any, model: Model, scene: Scene, output: Path) -> None:
        self.server, self.gui, self.model, self.scene, self.output = server, server.gui, model, scene, output
        self.lock, self.playing = threading.RLock(), False
        self.gui.set_panel_label(model.file.name)
        self.status = self.gui.add_html(readout.status(model))
        with self.gui.add_folder("Pose"):
            self._poses()
        with self.gui.add_folder("Plots"):
            self.torques = self.gui.add_html(readout.torques(model))
            self.energies = self.gui.add_html(readout.energies(model))
        with self.gui.add_folder("Design"):
            self._design()
        self.weights = [self._weight(k) for k in range(len(model.masses))]
        self.springs = SpringPanel(server, model, scene, self.lock, lambda: self.show(rebuild=True), self.say)
        self.quiet = False

    def show(self, rebuild: bool = False) -> None:
        """Bring scene and plots to the model's state."""
        with self.server.atomic():
            self.scene.rebuild() if rebuild else self.scene.update()
            self.springs.follow()
            self.status.content = readout.status(self.model)
            self.torques.content = readout.torques(self.model)
            self.energies.content = readout.energies(self.model)

    def go(self, q: Any) -> bool:
        """Move to a pose, sliders too; False where it cannot be reached."""
        with self.lock:
            reached = self.model.pose(q)
            self._set_sliders()
            if reached:
                self.show()
            return reached

    def say(self, title: str, body: str, seconds: float = 6.0) -> None:
        for client in self.server.get_clients().values():
            client.add_notification(title, body, auto_close_seconds=seconds)

    def guarded(self, what: str, work: Callable[[], None]) -> None:
        """Run `work` and say what went wrong, when the user can do something about it."""
        try:
            work()
        except EquipoiseError as error:
            self.say(what, str(error), 12.0)

    def _poses(self) -> None:
        low, high = bounds(self.model.tree)
        self.sliders = []
        for j, name in enumerate(self.model.tree.coordinates):
            scale = name.scale
            now = _steps(scale * self.model.q[j])
            least = min(_steps(scale * low[j], np.ceil), now)  # within the range, on a step
            most = max(_steps(scale * high[j], np.floor), now, least + STEP)
            slider = self.gui.add_slider(f"{name} [{name.shown_unit}]", least, most, STEP, now)
            slider.on_update(lambda _: self._slid())
            self.sliders.append((slider, scale))
        self.motions = motions(self.model.file, self.model.rest)
        if self.motions:
            self.motion = self.gui.add_dropdown("motion", tuple(self.motions))
            self.play = self.gui.add_button("Play")
            self.play.on_click(lambda _: self._play())
        worst = self.gui.add_button("Worst pose")
        worst.on_click(lambda _: self.guarded("Worst pose", lambda: self._worst()))

    def _design(self) -> None:
        self.on = self.gui.add_checkbox("springs on", True)
        self.on.on_update(lambda _: self._switch())
        most = max(1.0, float(f"{sum(b.mass for b in self.model.file.bodies) / 2:.1g}"))
        self.payload = self.gui.add_slider("payload [kg]", 0.0, most, most / 100, 0.0)
        self.payload.on_update(lambda _: self._load())
        self.again = self.gui.add_button("Re-optimise")
        self.again.on_click(lambda _: self.guarded("Re-optimise", self._redesign))
        self.progress = self.gui.add_progress_bar(0.0, visible=False)
        judge = self.gui.add_button("Judge: is it balanced?")
        judge.on_click(lambda _: self.guarded("Judge", self._judge))
        keep = self.gui.add_button(f"Save to {self.output.name}")
        keep.on_click(lambda _: self.guarded("Save", self._save))

    def _weight(self, number: int) -> Any:
        """The slider of one of the file's point masses, up to a multiple of what it is."""
        mass = self.model.masses[number]
        most = float(f"{HEAVIEST * mass.mass:.2g}") or 1.0
        slider = self.gui.add_slider(f"{mass.name} [kg]", 0.0, most, most / 300, min(mass.mass, most))
        slider.on_update(lambda _: self._weigh(number))
        return slider

    def _weigh(self, number: int) -> None:
        with self.lock:
            slider = self.weights[number]
            if abs(slider.value - self.model.masses[number].mass) > 0.51 * slider.step:
                self.model.weigh(number, slider.value)
                self.show(rebuild=True)

    def _set_sliders(self) -> None:
        self.quiet = True
        for (slider, scale), value in zip(self.sliders, self.model.q, strict=True):
            slider.value = _steps(scale * value)
        self.quiet = False

    def _slid(self) -> None:
        if self.quiet or self.playing:
            return
        with self.lock:
            q = np.array([slider.value / scale for slider, scale in self.sliders])
            step = np.array([slider.step / scale for slider, scale in self.sliders])
            near = np.abs(q - self.model.q) < 0.51 * step  # a slider only knows its steps
            q = np.where(near, self.model.q, q)
            if near.all():
                return
            if not self.go(q):
                self.say("Not reachable", "the loops do not close there, or a coupled joint would leave its range", 3.0)

    def _play(self) -> None:
        if self.playing:
            self.playing = False
            return
        self.playing, self.play.label = True, "Stop"
        self.model.trail.clear()
        frames = self.motions[self.motion.value]
        start = time.monotonic()
        try:
            while self.playing:
                i = int((time.monotonic() - start) * RATE)
                self.go(frames[min(i, len(frames) - 1)])
                if i >= len(frames) - 1:
                    break
                time.sleep(1 / DRAWN)
        finally:
            self.playing, self.play.label = False, "Play"

    def _worst(self) -> None:
        with self.lock:
            q = self.model.worst()
        self.go(q)

    def _switch(self) -> None:
        with self.lock:
            self.model.switch(None, self.on.value)
            self.show(rebuild=True)

    def _load(self) -> None:
        with self.lock:
            if self.model.payload != self.payload.value:
                self.model.load(self.payload.value)
                self.show(rebuild=True)

    def _redesign(self) -> None:
        with self.lock:
            self.again.disabled, self.progress.visible = True, True
            try:
                better = self.model.redesign(self._report)
            finally:
                self.again.disabled, self.progress.visible = False, False
            if better:
                self.springs.rebuild()
                self.show(rebuild=True)
            else:
                self.say("Re-optimise", "no better springs were found on these pairs of bodies")

    def _report(self, _what: str, share: float) -> None:
        self.progress.value = 100.0 * min(max(share, 0.0), 1.0)

    def _judge(self) -> None:
        with self.lock:
            self.model.judge()
            self.status.content = readout.status(self.model)

    def _save(self) -> None:
        with self.lock:
            save(self.model.saved(), self.output)
        self.say("Saved", str(self.output))


def _steps(value: float, rounded: Callable[[float], float] = np.round) -> float:
    """The value as a whole number of steps."""
    return round(float(rounded(round(value / STEP, 6))) * STEP, 6)

"""Verification in an independent engine, MuJoCo (extra `sim`): the model that `io.mjcf` writes, nothing of `energy`.

- `engine`: the compiled model, its poses, and what holds it;
- `release`: put it at rest in random poses and let go: does it stay where you leave it?
- `playback`: drive it through a motion: what do the actuators do?
"""

from __future__ import annotations

from .engine import Engine, EngineError
from .playback import Playback, play
from .release import Release, release

__all__ = ["Engine", "EngineError", "Playback", "Release", "play", "release"]

"""What the viewer's page may say: a value within its control's range, where its camera is, where a handle goes."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

from ..model.errors import shortened, visible

FARTHEST = 1e9  # [m] of a camera or a handle
ROUNDING = 1e-9  # of a range: the page writes the ends of a slider's steps otherwise
LINES = 20  # that are written about messages; more would only fill the terminal

SHAPES: Mapping[str, Mapping[str, int | type]] = {
    "ViewerCameraMessage": {
        "wxyz": 4, "position": 3, "fov": float, "near": float, "far": float, "image_height": float,
        "image_width": float, "look_at": 3, "up_direction": 3,
    },
    "TransformControlsUpdateMessage": {"name": str, "wxyz": 4, "position": 3, "owner": str},
    "TransformControlsDragStartMessage": {"name": str, "owner": str},
    "TransformControlsDragEndMessage": {"name": str, "owner": str},
    "GuiUpdateMessage": {"uuid": str, "updates": dict},
}  # fmt: skip
"""The messages that are heard, and their fields: text, a finite number, or so many finite numbers."""


class Messages:
    """Passes the messages that mean something, and ignores every other one with a line on standard error."""

    def __init__(self) -> None:
        self._controls: Mapping[str, Any] | None = None
        self._written: set[str] = set()

    def hear(self, server: Any) -> None:
        """Begin to listen: the controls of this viser server are complete."""
        self._controls = server.gui._gui_input_handle_from_uuid  # viser has no public way from a message to its control

    def passes(self, data: object) -> bool:
        """Whether a message may reach viser."""
        reason = self.objection(data)
        if reason is not None and reason not in self._written and len(self._written) < LINES:
            self._written.add(reason)
            print(f"viewer: ignored {visible(reason)}", file=sys.stderr, flush=True)
        return reason is None

    def objection(self, data: object) -> str | None:
        """What is wrong with a message; None when it is fine."""
        import msgspec

        if not isinstance(data, bytes):
            return "a message that is text"
        try:
            message = msgspec.msgpack.decode(data)
        except (msgspec.MsgspecError, ValueError, RecursionError):
            return "a message that cannot be decoded"
        kind = message.pop("type", None) if isinstance(message, dict) else None
        if not isinstance(kind, str) or kind not in SHAPES:
            return f"an unknown message {shortened(repr(kind), 60)}"
        shape = SHAPES[kind]
        if message.keys() != shape.keys() or not all(_fits(message[key], shape[key]) for key in shape):
            return f"a message {kind} with wrong values"
        if kind == "GuiUpdateMessage":
            return self._value(message["uuid"], message["updates"])
        return None

    def _value(self, uuid: str, updates: dict[Any, Any]) -> str | None:
        control = (self._controls or {}).get(uuid)
        if control is None:
            return "a value for a control that is not there"
        name = shortened(str(getattr(control, "label", "a control")), 60)
        if updates.keys() != {"value"}:
            return f"a change of '{name}' in something else than its value"
        if getattr(control, "disabled", False):
            return f"a value for '{name}', which is disabled"
        return None if _within(control, updates["value"]) else f"a value for '{name}' that is out of its range"


def _fits(value: object, shape: int | type) -> bool:
    if isinstance(shape, int):
        return isinstance(value, list) and len(value) == shape and all(_number(x) for x in value)
    return _number(value) if shape is float else isinstance(value, shape)


def _number(value: object) -> bool:
    return (
        isinstance(value, (int, float))
        and not isinstance(value, bool)
        and abs(value) <= FARTHEST  # not so where it is NaN
    )


def _within(control: Any, value: object) -> bool:
    """Whether a control can have the value: True or False, one of its options, or numbers within its range."""
    if hasattr(control, "options"):
        return isinstance(value, str) and value in control.options
    now = control.value
    if isinstance(now, bool):
        return isinstance(value, bool)
    if getattr(control, "min", None) is None or control.max is None:  # nothing that a page changes
        return False
    many = isinstance(now, tuple)
    values: Any = value if many else [value]
    if not isinstance(values, list) or len(values) != (len(now) if many else 1) or not all(map(_number, values)):
        return False
    low, high = ((end if many else [end]) for end in (control.min, control.max))
    return all(
        a - ROUNDING * (b - a) <= x <= b + ROUNDING * (b - a) for x, a, b in zip(values, low, high, strict=True)
    )  # fmt: skip

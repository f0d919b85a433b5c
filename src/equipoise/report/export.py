"""A mechanism in another format, or as a drawing."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module

from ..io import WRITERS, Source, loaded
from ..kinematics import Linkage, Tree
from ..model.errors import Fault, InputError, nearest
from ..model.mechanism import Mechanism
from .cam import cam_text

FORMATS = {name: f"equipoise.io.{name}" for name in WRITERS} | {
    "svg": "equipoise.report.schematic",
    "dxf": "equipoise.report.attachments",
    "sheet": "equipoise.report.body_sheet",
    "sheet-dxf": "equipoise.report.body_sheet:to_dxf",
    "order": "equipoise.report.order",
}
"""Name -> the module whose `to_text`, or other function, writes it."""


def export(mechanism: Source, to: str, *, cam: str | None = None) -> str:
    """A mechanism as text: yaml, urdf, mjcf; svg is a schematic, dxf the attachment points.

    For a workshop: sheet and sheet-dxf are a dimensioned drawing of each body's attachment points, order is the order
    list as CSV.

    Args:
        cam: its name; then svg and dxf are its profile at full size, to cut.

    Raises:
        InputError: another format, or one that cannot hold the mechanism; no such cam.
    """
    if to not in FORMATS:
        raise InputError(Fault(("--to",), f"unknown format {nearest(to, FORMATS)}", tuple(FORMATS)))
    if cam is not None:
        return cam_text(loaded(mechanism), cam, to)
    module, _, function = FORMATS[to].partition(":")
    mechanism, write = loaded(mechanism), getattr(import_module(module), function or "to_text")
    return write(*assembled(mechanism)) if to == "mjcf" else write(mechanism)


def assembled(mechanism: Mechanism) -> tuple[Mechanism, dict[str, float] | None]:
    """With the coordinates that steer its loops, and a pose in which they close."""
    tree = Tree.of(mechanism)
    if not isinstance(tree, Linkage):
        return mechanism, None
    pose: dict[str, float] = dict(zip(tree.open.coordinates, tree.branch.assembled.tolist(), strict=True))
    return replace(mechanism, independent=tree.coordinates), pose

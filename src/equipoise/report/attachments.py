"""Where springs are attached, as a DXF drawing in mm: in the plane of a planar mechanism, else in space.

The mechanism is drawn at rest, where its coordinates are zero or its loops are assembled. Every end is a point with its
letter, its body and its place in that body's frame.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from importlib.util import find_spec
from itertools import pairwise

import numpy as np

from ..kinematics import Tree
from ..model.arrays import Array
from ..model.errors import InputError
from ..model.mechanism import Mechanism
from .poses import choose
from .skeleton import Moving, Point, Skeleton
from .style import clean

MM = 1000.0  # per metre
LAYERS = {"LINKS": 8, "JOINTS": 7, "SPRINGS": 3, "ATTACHMENTS": 1, "LABELS": 7}  # name -> colour number
TEXT, JOINT = 0.018, 0.012  # height of a label, radius of a joint, of the drawing's size
CROSSED = 35  # PDMODE: a point is drawn as a circle with a cross


def to_text(mechanism: Mechanism) -> str:
    """The drawing as a DXF file.

    Raises:
        InputError: ezdxf is not installed, there are no springs, or its loops cannot be closed.
    """
    if find_spec("ezdxf") is None:
        raise InputError("DXF drawings need ezdxf: pip install 'equipoise[cad]'")
    if not mechanism.springs:
        raise InputError(f"mechanism '{mechanism.name}' has no springs, so nothing is attached; design some first")
    from ezdxf.filemanagement import new
    from ezdxf.units import MM as MILLIMETRES

    skeleton, place = _places(mechanism)
    document = new("R2010", units=MILLIMETRES)
    document.header["$PDMODE"] = CROSSED
    for name, colour in LAYERS.items():
        document.layers.add(name, color=colour)
    space = document.modelspace()
    drawn = [place(end) for bar in skeleton.bars for end in (bar.a, bar.b)]
    drawn += [place(point) for line in skeleton.springs for point in line]
    size = float(np.ptp(np.array(drawn), axis=0).max())
    for bar in skeleton.bars:
        space.add_line(place(bar.a), place(bar.b), dxfattribs={"layer": "LINKS"})
    for point in skeleton.joints:
        space.add_circle(place(point), JOINT * size, dxfattribs={"layer": "JOINTS"})
    for i, (spring, line) in enumerate(zip(mechanism.springs, skeleton.springs, strict=True), start=1):
        for a, b in pairwise(line):
            space.add_line(place(a), place(b), dxfattribs={"layer": "SPRINGS"})
        value, unit = spring.strength
        texts = [(f"k{i} = {value:.6g} {unit}, {spring.name}", np.mean([place(point) for point in line], axis=0))]
        for letter, end, (body, p) in zip("ab", (line[0], line[-1]), spring.ends, strict=False):
            space.add_point(place(end), dxfattribs={"layer": "ATTACHMENTS"})
            own = ", ".join(f"{round(MM * value, 3) + 0.0:g}" for value in p)
            texts.append((f"{letter}{i} {body} ({own})", place(end)))
        for text, at in texts:
            label = space.add_text(clean(text, 200), height=TEXT * size, dxfattribs={"layer": "LABELS"})
            label.set_placement(tuple(at + np.array([TEXT * size, 0.5 * TEXT * size, 0.0])))
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue()


def _places(mechanism: Mechanism) -> tuple[Skeleton, Callable[[Point | Moving], Array]]:
    """The skeleton, and where its points are at rest: (3,) [mm], with z = 0 in the plane of a planar mechanism."""
    skeleton, tree = Skeleton.of(mechanism), Tree.of(mechanism)
    view, _ = choose(mechanism, skeleton)
    poses = tree.poses(tree.rest[None])

    def place(point: Point | Moving) -> Array:
        p = MM * point.at(poses)[0]
        return np.array([*view.flat(p), 0.0]) if view.planar else p

    return skeleton, place

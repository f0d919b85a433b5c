"""Bodies that joints of some types hold together, each with its place in the group."""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass

import numpy as np

from ..model.arrays import Array
from .tree import Tree


@dataclass(frozen=True)
class Place:
    """Where a body is in its group: orientation `R` and origin `p` [m] in the frame of the body `root`.

    `base` is where the body's joint is: on the parent's group, in the frame of that group's root [m].
    """

    root: int
    R: Array
    p: Array
    base: Array


def places(tree: Tree, joined: Container[str]) -> dict[int, Place]:
    """Body number -> its place, with the joints of the types `joined` at the value they have at zero."""
    found = {0: Place(0, np.eye(3), np.zeros(3), np.zeros(3))}
    for link in tree.links:
        parent, shift = found[link.parent], link.p0
        if link.slide:
            shift = shift + tree.s0[link.slide.row] * (link.R0 @ link.slide.axis)
        base = parent.p + parent.R @ shift
        if link.joint.type in joined:
            found[link.body] = Place(parent.root, parent.R @ link.R0, base, base)
        else:
            found[link.body] = Place(link.body, np.eye(3), np.zeros(3), base)
    return found

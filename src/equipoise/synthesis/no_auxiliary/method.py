"""The method `no-auxiliary`: springs between the links of an open chain, without auxiliary links.

B. Lenzo, "Gravity balancing of a spatial serial 4-dof arm without auxiliary links using minimum number of springs",
AIMETA 2017. Two links have the paper's layouts a to d (`two_links`); any number of links has springs that all start
from the ground (`from_ground`), as many as links. The equations hold for ball joints, and so for hinges too.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...kinematics import Tree
from ...kinematics.groups import places
from ...model.arrays import Array
from ...model.elements import Spring
from ...model.errors import Fault, InfeasibleError, InputError, nearest
from ...model.mechanism import Mechanism
from ...model.units import Amount
from ..arms.chain import Chain, ChainLink, chain, reasons
from ..design import Design
from ..given import Given, number, numbers
from ..method import Method
from ..mounts import Mounts
from ..options import MethodOptions, option, takes
from ..products import Product, fill
from . import from_ground, two_links
from .from_ground import fewest_springs
from .two_links import FREE_3, LAYOUTS, TwoLinks

GROUND = "ground"
CHOICES = (*sorted(LAYOUTS), GROUND)
SHARE = 0.5
OF_TWO = ("k1", "a1", "b1", "k2", "a2", "b2", "k12", "a12", "b12")  # the options of layouts a to d
OF_GROUND = ("k", "b", "height")


@dataclass(frozen=True, kw_only=True)
class NoAuxiliaryOptions(MethodOptions):
    """What the method no-auxiliary can be asked for.

    Attributes:
        layout: a to d for two loaded links, or ground. By default the first that suits of b, a, c, d; for any other
            number of links ground.
        springs: 2, or 3 with spring k1, of layouts a to d; by default 3 only where mass centre 1 is off the line.
        k2, a2, b2, k12, a12, b12, k1, a1, b1: see `two_links` [N/m, m]; lengths may be negative. With two springs b2
            follows, one of k2 and a2 is free, and two of k12, a12, b12. With three, two of each three are free.
        direction: of link 2 in its frame: what h2 > 0 means. By default where the next joint or the origin of a
            body fixed to it is, else the positive axis of its frame that its mass centre is nearest to.
        k, b, height: of layout ground: stiffness of the two springs on the last link [N/m], where they are attached [m]
            and how far apart on the ground [m]; two are free.
        share: of layout ground: where the spring of another link is attached, as a share of its length.
    """

    layout: str | None = option(None, "text", "of two links (Fig. 5), or all springs from the ground", CHOICES)
    springs: int | None = option(None, "whole", "2, or 3 with k1 as in (14) (default: as few as do), of layouts a to d")
    k2: Amount | None = option(None, "stiffness", "of the spring from the ground to link 2")
    a2: Amount | None = option(None, "length", "its height above the shoulder")
    b2: Amount | None = option(None, "length", "its end on link 2, from the elbow")
    k12: Amount | None = option(None, "stiffness", "of the spring from link 1 to link 2")
    a12: Amount | None = option(None, "length", "its end on link 2, from the elbow")
    b12: Amount | None = option(None, "length", "its end on link 1, from the shoulder")
    k1: Amount | None = option(None, "stiffness", "of the third spring, from the ground to link 1")
    a1: Amount | None = option(None, "length", "its height above the shoulder")
    b1: Amount | None = option(None, "length", "its end on link 1, from the shoulder")
    direction: Sequence[float] | None = option(None, "number", "x,y,z of link 2 in its frame: where h2 > 0", many=True)
    k: Amount | None = option(None, "stiffness", "layout ground: of the springs on the last link")
    b: Amount | None = option(None, "length", "layout ground: their ends on it, from its joint")
    height: Amount | None = option(None, "length", "layout ground: how far apart they are on the ground")
    share: Given = option(None, "share", "layout ground: end on another link as a share of its length", each=True)


@takes(NoAuxiliaryOptions)
def design(mechanism: Mechanism, options: NoAuxiliaryOptions) -> Design:
    """As few springs as links. The mechanism's own springs are replaced.

    Raises:
        InputError: a bad value.
        InfeasibleError: no springs of this kind balance it; the message names the condition.
    """
    layout, springs, direction, share = options.layout, options.springs, options.direction, options.share
    bare = mechanism.with_springs(())
    found = chain(bare)
    of_two = {name: number(name, value, None if name[0] != "k" else True) for name, value in _given(options, OF_TWO)}
    of_ground = {name: number(name, value, positive=True) for name, value in _given(options, OF_GROUND)}
    size = {link.body: Mounts.of(bare).default_radius(link.body) for link in found.loaded}
    if _grounded(layout, len(found.loaded)):
        _no_use("layout ground", [*of_two, *dict(_given(options, ("springs", "direction")))])
        made, free = _from_ground(found, of_ground, share, size)
    else:
        _no_use("a layout of two links", [*of_ground, *dict(_given(options, ("share",)))])
        if springs not in (None, 2, 3):
            raise InputError(Fault(("springs",), f"must be 2 or 3 with layouts a to d, found {springs}"))
        if springs == 2:
            _no_use("an arm with two springs", [name for name in FREE_3 if name in of_two])
        first, second = found.loaded
        x2, ahead = _direction(found, second, direction)
        arm = TwoLinks(found, x2, (size[first.body], size[second.body]))
        made, free = two_links.springs(arm, layout, springs, of_two)
        free |= {"direction": ahead}
    if all(link.free for link in found.loaded):
        free |= {"fewest": fewest_springs(found)}
    return Design.of(bare.with_springs(made), "no-auxiliary", free)


def _given(options: NoAuxiliaryOptions, names: Iterable[str]) -> Iterator[tuple[str, Any]]:
    for name in names:
        if getattr(options, name) is not None:
            yield name, getattr(options, name)


def _no_use(what: str, names: Iterable[str]) -> None:
    for name in names:
        raise InputError(Fault((name,), f"{what} has no such parameter"))


def _grounded(layout: str | None, links: int) -> bool:
    """Whether the springs all start from the ground."""
    if layout not in (None, GROUND, *LAYOUTS):
        raise InputError(Fault(("layout",), f"there is no layout {nearest(layout, CHOICES)}", CHOICES))
    if layout in LAYOUTS and links == 1:
        raise InfeasibleError(
            f"layout {layout} needs h2 {'>' if LAYOUTS[layout][2] > 0 else '<'} 0: gravity has a moment on one link "
            "only, and one spring balances it (layout ground)"
        )
    if layout in LAYOUTS and links != 2:
        raise InputError(
            Fault(("layout",), f"layouts a to d are for two links with a moment, and it has {links}", (GROUND,))
        )
    return layout == GROUND or links != 2


def _from_ground(
    found: Chain, given: Mapping[str, float], share: Given, size: Mapping[str, float]
) -> tuple[tuple[Spring, ...], dict[str, Any]]:
    first, last = found.loaded[0], found.loaded[-1]
    strength = found.weight * float(np.linalg.norm(last.moment))
    product = Product(f"k b height, the moment of '{last.body}',", strength, "N m", ("k", "b", "height"))
    values = fill([product], given, {"b": size[last.body], "height": size[first.body]})
    between = [link.body for link in found.loaded[1:-1]]
    shares = dict.fromkeys(between, SHARE) | numbers("share", share, between, positive=True)
    made = from_ground.springs(found, values["k"], values["height"], shares, size)
    return made, {"layout": GROUND, **values, "share": shares}


def _direction(found: Chain, link: ChainLink, given: Sequence[float] | None) -> tuple[Array, list[float]]:
    """(3,) the unit vector along the moment of the last link, on the side where the link is; and that, in its frame."""
    tree = Tree.of(found.mechanism)
    zero, body = tree.poses(np.zeros((1, tree.n))), tree.index[link.body]
    if given is not None:
        if len(given) != 3 or not np.isfinite(given).all() or not np.any(given):
            raise InputError(Fault(("direction",), f"must be three numbers x,y,z, not all 0, found {list(given)}"))
        ahead = zero.R[0, body] @ np.array(given, float)
    elif link.length is not None:
        ahead = link.length
    else:
        place = places(tree, ("fixed",))
        ends = [zero.p[0, i] - link.centre for i in place if place[i].root == place[body].root]
        ahead = max(ends, key=lambda end: float(np.linalg.norm(end)))
        if np.linalg.norm(ahead) <= found.near:  # nothing but the link's own frame
            axes = zero.R[0, body]
            ahead = axes[:, np.argmax(np.abs(axes.T @ link.moment))]
    x2 = link.moment / np.linalg.norm(link.moment)
    local = zero.R[0, body].T @ ahead
    return (x2 if x2 @ ahead >= 0 else -x2), (local / np.linalg.norm(local)).tolist()


METHOD = Method(
    "no-auxiliary",
    "as few springs as links, from the ground or between the links of an open chain, without auxiliary links",
    "Lenzo (2017), Eqs. (11)-(15)",
    reasons,
    design,
    NoAuxiliaryOptions,
)

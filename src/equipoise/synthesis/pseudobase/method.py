"""The method `pseudobase`: one spring per link, from a body that stays upright and rides along.

P.-Y. Lin, W.-B. Shieh and D.-Z. Chen, "Design of a gravity-balanced general spatial serial-type manipulator",
J. Mechanisms Robotics 2 (2010). Beside the arm runs a chain of auxiliary links, each parallel to its link and `height`
above it; the bar C_i D_i between the two, the pseudobase, therefore stays vertical, and a spring from it balances
link i as one from the ground balances a link that is hinged to the ground. Here the chain branches where the arm does;
the first links, which only turn about the vertical, carry the foot of the chain themselves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...model.arrays import Array
from ...model.errors import Fault, InputError, nearest
from ...model.mechanism import Mechanism
from ...model.units import Amount
from ..arms.moments import MOMENT_ROUNDING, Moment, Segment, moments, segments, slide_faults
from ..design import Design
from ..given import Given, number, numbers, spring_sizes, vectors
from ..method import Method
from ..mounts import Mounts
from ..options import MethodOptions, option, takes
from .parallelograms import Builder, Module, mobility


@dataclass(frozen=True, kw_only=True)
class PseudobaseOptions(MethodOptions):
    """What the method pseudobase can be asked for. All but `height` and `planar` may differ from link to link.

    A link is named by the body that stands for it, in whose frame its points are given (see `Segment`).

    Attributes:
        stiffness, l_CA, l_CB: of a link's spring [N/m, m, m]: at most two, the third follows from Eq. (16). By default
            both lengths are half the link's size, or equal where only the stiffness is given.
        centre: C_i [m]; by default off the joint's axis by half the link's size, on the side of its moment.
        height: of the auxiliary chain above the arm [m]; by default a tenth of the arm's reach.
        auxiliary: mass of an auxiliary link as a share of its link's own.
        auxiliary_mass: the same [kg], in place of the share.
        auxiliary_com: the point of the link that its mass centre is above [m]; by default the link's own mass centre.
        pseudobase: mass of a pseudobase [kg].
        planar: links whose parallelogram is a planar four-bar; by default those whose axis stays horizontal.
        real: hinges, ball joints and loops in the place of parallelogram joints.
    """

    stiffness: Given = option(None, "stiffness", "of a link's spring", each=True)
    l_CA: Given = option(None, "length", "from C up to the spring's end on the pseudobase", each=True)
    l_CB: Given = option(None, "length", "from C to its end on the link; two of the three at most", each=True)
    centre: Given = option(None, "length", "x,y,z of C in the link's frame", each=True, many=True)
    height: Amount | None = option(
        None, "length", "of the auxiliary chain above the arm (default a tenth of the reach)"
    )
    auxiliary: Given = option(0.0, "share", "mass of an auxiliary link as a share of its link's, such as 5%", each=True)
    auxiliary_mass: Given = option(None, "mass", "the same, in kg in place of a share", each=True)
    auxiliary_com: Given = option(None, "length", "x,y,z in the link's frame (default its com)", each=True, many=True)
    pseudobase: Given = option(0.0, "mass", "of a pseudobase (default 0)", each=True)
    planar: Sequence[str] | None = option(
        None, "names", "A,B,...: links with a planar four-bar (default: all whose axis stays level)"
    )
    real: bool = option(False, "flag", "hinges, ball joints and loops in place of parallelogram joints (default no)")


@takes(PseudobaseOptions)
def design(mechanism: Mechanism, options: PseudobaseOptions) -> Design:
    """One spring for each link on whose moment gravity does work. The mechanism's own springs are replaced.

    Raises:
        InputError: a bad value.
    """
    bare = mechanism.with_springs(())
    links = segments(bare)
    primary = moments(links)
    unit = _unit(primary)
    chain = _chain(links, primary, unit)
    names = [links[i].name for i in chain]
    mounts = Mounts.of(bare)
    height = mounts.reach / 10 if options.height is None else number("height", options.height, positive=True)
    flat = _planar(links, chain, options.planar)
    centres = vectors("centre", options.centre, names)
    shares = numbers("auxiliary", options.auxiliary, names, positive=False)
    weights = numbers("auxiliary_mass", options.auxiliary_mass, names, positive=False)
    coms = vectors("auxiliary_com", options.auxiliary_com, names)
    couplers = numbers("pseudobase", options.pseudobase, names, positive=False)

    modules: dict[int, Module] = {}
    for i in chain:
        link = links[i]
        own = sum(m for m, _ in link.lumps)
        middle = sum((m * p for m, p in link.lumps), np.zeros(3)) / own if own else np.zeros(3)
        C = centres.get(link.name)
        C = _beside(link, primary[i], unit, mounts.default_radius(link.name)) if C is None else C - link.origin
        if np.linalg.norm(np.cross(link.axis, C)) <= 1e-9:
            raise InputError(Fault(("centre", link.name), "is on the joint's axis, where a parallelogram has no width"))
        com = coms.get(link.name)
        modules[i] = Module(
            centre=C,
            mass=weights.get(link.name, shares.get(link.name, 0.0) * own),
            com=middle if com is None else com - link.origin,
            coupler=couplers.get(link.name, 0.0),
            planar=link.name in flat,
        )
    whole = moments(links, {i: module.lumps for i, module in modules.items()})  # (24)-(25)
    sprung = [i for i in chain if links[i].works(whole[i].vector, _unit(whole))]
    g = float(np.linalg.norm(bare.gravity))
    sizes = spring_sizes({links[i].name: g * float(np.linalg.norm(whole[i].vector)) for i in sprung},  # (16)
                         {links[i].name: mounts.default_radius(links[i].name) for i in sprung},
                         options.stiffness, l_CA=options.l_CA, l_CB=options.l_CB)  # fmt: skip
    builder = Builder(bare, links, height, options.real)
    balanced = builder.build(modules, whole, sprung, sizes)
    turning, idle = mobility(len(bare.coordinates), sum(not module.planar for module in modules.values()))
    free = {
        "stiffness": {name: K for name, (K, _, _) in sizes.items()},
        "l_CA": {name: a for name, (_, a, _) in sizes.items()},
        "centre": {links[i].name: (links[i].origin + modules[i].centre).tolist() for i in chain},
        "height": height,
        "auxiliary_mass": {links[i].name: modules[i].mass for i in chain},
        "auxiliary_com": {links[i].name: (links[i].origin + modules[i].com).tolist() for i in chain},
        "pseudobase": {links[i].name: modules[i].coupler for i in chain},
        "planar": flat,
        "mobility": {"active": turning, "idle": idle},
    }
    if options.real:
        free["folds"] = builder.folding(modules)
    return Design.of(balanced, "pseudobase", free)


def applies(mechanism: Mechanism) -> list[str]:
    """Why the method does not apply; empty when it does."""
    if mechanism.loops:
        return ["it has loops: the auxiliary chain needs a tree"]
    if not any(mechanism.gravity):
        return ["there is no gravity"]
    reasons = [
        f"joint '{joint.name}' is {joint.type}: {what}"
        for joint in mechanism.joints
        for what in (_UNFIT.get(joint.type),)
        if what
    ]
    if reasons:
        return reasons
    links = segments(mechanism.with_springs(()))
    reasons = list(slide_faults(mechanism.with_springs(()), links))
    found = moments(links)
    if not reasons and not _chain(links, found, _unit(found)):
        reasons.append("gravity does no work on any link: nothing to balance")
    return reasons


_UNFIT = {
    "spherical": "a module has one revolute joint in common with the arm; write it as three revolute joints",
    "parallelogram": "its child does not turn with the link that carries it; give the arm without its parallelograms",
}


def _chain(links: Sequence[Segment], found: Sequence[Moment], unit: float) -> list[int]:
    """The links that get a module: those on whose moment gravity does work, and those that carry their chain."""
    needed: set[int] = set()
    for i, link in enumerate(links):
        if not link.upright and link.works(found[i].vector, unit):
            while not links[i].upright:
                needed.add(i)
                i = links[i].parent
    return sorted(needed)


def _unit(found: Sequence[Moment]) -> float:
    """[kg m] what rounding is a share of."""
    return sum(moment.size for moment in found)


def _beside(link: Segment, moment: Moment, unit: float, distance: float) -> Array:
    """A point at a distance from the joint's axis, on the side of the moment where it has one."""
    sideways = np.eye(3) - np.outer(link.axis, link.axis)
    direction = sideways @ moment.vector
    if np.linalg.norm(direction) <= MOMENT_ROUNDING * unit:
        direction = sideways[:, np.argmin(np.abs(link.axis))]
    return distance * direction / np.linalg.norm(direction)


def _planar(links: Sequence[Segment], chain: Sequence[int], asked: Sequence[str] | None) -> list[str]:
    level = [links[i].name for i in chain if links[i].level]
    for name in asked or ():
        if name not in level:
            raise InputError(Fault(("planar",), f"no link with a joint that stays horizontal {nearest(name, level)}",
                                   tuple(level)))  # fmt: skip
    return level if asked is None else list(asked)


METHOD = Method(
    "pseudobase",
    "one spring per link from an upright bar that rides along on an auxiliary chain of parallelograms: always exact",
    "Lin, Shieh and Chen (2010), Eqs. (7)-(8), (13)-(16), (24)-(25)",
    applies,
    design,
    PseudobaseOptions,
)

"""The balance certificate of mechanisms with loops.

On closed poses two kinds of identities hold, and an energy that is constant up to them is constant:

- linear relations between joint angles, such as those of a parallelogram. They are looked for on random closed poses.
  The poses of one branch are an analytic set, so a relation that holds at random ones, to rounding, holds on all of
  the branch; it becomes a coupling, and the loops' finite Fourier series shrink or vanish;
- the loop equations themselves: any constant multiple of ``p_a - p_b`` (and of the difference of a hinge's axes) may
  be added. The multipliers are forces in the loops, constant in the world or in the frame of the body that they act on,
  and follow from linear least squares.

What remains zero proves balance on the whole branch; what does not proves nothing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ...kinematics import Tree, sample
from ...kinematics.linkage import Linkage
from ...kinematics.relations import relations
from ...model.arrays import Array, Complexes, Integers
from ...model.errors import NoFourierForm
from ...model.mechanism import SINGLE, Mechanism
from .energy import FourierEnergy
from .frames import MAX_TERMS, Frames
from .series import Series

POSES = 96
CLOSURE_ROUNDING = 1e-12  # [m] a loop that the relations close by themselves


class ClosedEnergy(FourierEnergy):
    """The energy of a mechanism with loops, up to what is zero on closed poses; over the coordinates of its open tree.

    `exact` proves that it is balanced at every closed pose of its branch. `torque_bound` says nothing about actuators.

    Raises:
        NoFourierForm: as `FourierEnergy`.
    """

    def __init__(self, mechanism: Mechanism, max_terms: int = MAX_TERMS) -> None:
        super().__init__(opened(mechanism), max_terms)
        frames = Frames(self.tree, max_terms)
        keys = np.hstack([np.rint(self.frequency * frames.denominators), self.degree]).astype(int)
        start = keys, self.c
        zeros: list[Series] = []
        for bound in (False, True):  # forces that turn with a body take longer, and few mechanisms need them
            try:
                zeros += [
                    zero for zero in _closures(frames, mechanism, bound) if np.abs(zero.coef).max() > CLOSURE_ROUNDING
                ]
            except NoFourierForm:
                if bound:
                    return
                raise
            if zeros:
                every, self.c = _least(*start, zeros)
                self.frequency = every[:, : self.tree.n] / frames.denominators
                self.degree = every[:, self.tree.n :]
                self.__dict__.pop("amplitude", None)
            if not zeros or self.exact:
                return


def _least(keys: Integers, c: Complexes, zeros: list[Series]) -> tuple[Integers, Complexes]:
    """Terms and coefficients of a series, less the multiples of the zeros that leave its terms least."""
    every, inverse = np.unique(np.vstack([keys, *(z.keys for z in zeros)]), axis=0, return_inverse=True)
    columns = np.zeros((len(every), 1 + len(zeros)), complex)
    start = 0
    for i, (one, coef) in enumerate([(keys, c), *((z.keys, z.coef[:, 0, 0]) for z in zeros)]):
        np.add.at(columns[:, i], inverse.ravel()[start : start + len(one)], coef)
        start += len(one)
    varies = every.any(axis=1)
    A = np.vstack([np.real(columns[varies]), np.imag(columns[varies])])
    forces = np.linalg.lstsq(A[:, 1:], -A[:, 0], rcond=1e-12)[0]
    return every, np.asarray(columns[:, 0] + columns[:, 1:] @ forces, complex)


def _closures(frames: Frames, mechanism: Mechanism, bound: bool) -> Iterator[Series]:
    """What every loop makes zero, as series in the coordinates of the open tree: components of points and of axes.

    Args:
        bound: components along the axes of the loop's second body, not of the world.
    """
    index = frames.tree.index
    for loop in mechanism.loops:
        a, b = index[loop.body_a], index[loop.body_b]
        body = b if bound else 0
        points = frames.moment([(a, 1.0, np.array(loop.p_a)), (b, -1.0, np.array(loop.p_b))])
        yield from (frames.linear(axis, points, body) for axis in np.eye(3) if points)
        if loop.axis_a is not None and loop.axis_b is not None:
            for axis in np.eye(3):
                ends = [frames.linear(axis, {end: Series.constant(_unit(v)[:, None], frames.tree.n)}, body)
                        for end, v in ((a, loop.axis_a), (b, loop.axis_b))]  # fmt: skip
                yield Series.sum([ends[0], ends[1].scaled(-1)])


def _unit(v: tuple[float, float, float]) -> Array:
    return np.array(v) / np.linalg.norm(v)


def opened(mechanism: Mechanism) -> Mechanism:
    """The mechanism without loops, the linear relations between its joints as couplings."""
    linkage = Tree.of(mechanism)
    if not isinstance(linkage, Linkage):
        return mechanism
    bare = replace(mechanism, loops=(), independent=(), assembly=())
    q = linkage.branch.solve(sample(linkage, POSES))[0]
    single = {joint.name for joint in mechanism.joints if joint.type in SINGLE}
    names = linkage.open.coordinates
    couplings = list(relations(q, [name in single for name in names], names))
    return replace(bare, couplings=(*bare.couplings, *couplings))

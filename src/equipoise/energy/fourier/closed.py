"""The balance certificate of mechanisms with loops.

On closed poses two kinds of identities hold, and an energy that is constant up to them is constant:

- linear relations between joint angles, such as those of a parallelogram. They are looked for on random closed poses.
  The poses of one branch are an analytic set, so a relation that holds at random ones, to rounding, holds on all of
  the branch; it becomes a coupling, and the loops' finite Fourier series shrink or vanish;
- the loop equations themselves: any constant multiple of ``p_a - p_b`` (and of the difference of a hinge's axes) may
  be added. The multipliers are constant forces in the loops, and follow from linear least squares.

What remains zero proves balance on the whole branch; what does not proves nothing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np

from ...kinematics import Tree, sample
from ...kinematics.linkage import Linkage
from ...model.arrays import Array
from ...model.mechanism import SINGLE, Coupling, Mechanism
from .energy import FourierEnergy
from .frames import MAX_TERMS, Frames
from .series import Series

POSES = 96
CLOSURE_ROUNDING = 1e-12  # [m] a loop that the relations close by themselves
HOLDS = 1e-9  # [rad or m] a relation holds
RATIO = 24  # largest denominator of a relation's coefficients


class ClosedEnergy(FourierEnergy):
    """The energy of a mechanism with loops, up to what is zero on closed poses; over the coordinates of its open tree.

    `exact` proves that it is balanced at every closed pose of its branch. `torque_bound` says nothing about actuators.

    Raises:
        NoFourierForm: as `FourierEnergy`.
    """

    def __init__(self, mechanism: Mechanism, max_terms: int = MAX_TERMS) -> None:
        opened = _opened(mechanism)
        super().__init__(opened, max_terms)
        n = self.tree.n
        frames = Frames(self.tree, max_terms)
        zeros = [series for series in _closures(frames, mechanism) if np.abs(series.coef).max() > CLOSURE_ROUNDING]
        if not zeros:
            return
        keys = np.hstack([np.rint(self.frequency * frames.denominators), self.degree]).astype(int)
        every, inverse = np.unique(np.vstack([keys, *(z.keys for z in zeros)]), axis=0, return_inverse=True)
        columns = np.zeros((len(every), 1 + len(zeros)), complex)
        start = 0
        for i, (one, coef) in enumerate([(keys, self.c), *((z.keys, z.coef[:, 0, 0]) for z in zeros)]):
            np.add.at(columns[:, i], inverse.ravel()[start : start + len(one)], coef)
            start += len(one)
        varies = every.any(axis=1)
        A = np.vstack([np.real(columns[varies]), np.imag(columns[varies])])
        forces = np.linalg.lstsq(A[:, 1:], -A[:, 0], rcond=1e-12)[0]
        self.frequency = every[:, :n] / frames.denominators
        self.degree = every[:, n:]
        self.c = columns[:, 0] + columns[:, 1:] @ forces


def _closures(frames: Frames, mechanism: Mechanism) -> Iterator[Series]:
    """What every loop makes zero, as series in the coordinates of the open tree: components of points and of axes."""
    index = frames.tree.index
    for loop in mechanism.loops:
        a, b = index[loop.body_a], index[loop.body_b]
        points = frames.moment([(a, 1.0, np.array(loop.p_a)), (b, -1.0, np.array(loop.p_b))])
        yield from (frames.linear(axis, points) for axis in np.eye(3) if points)
        if loop.axis_a is not None and loop.axis_b is not None:
            for axis in np.eye(3):
                ends = [frames.linear(axis, {body: Series.constant(_unit(v)[:, None], frames.tree.n)})
                        for body, v in ((a, loop.axis_a), (b, loop.axis_b))]  # fmt: skip
                yield Series.sum([ends[0], ends[1].scaled(-1)])


def _unit(v: tuple[float, float, float]) -> Array:
    return np.array(v) / np.linalg.norm(v)


def _opened(mechanism: Mechanism) -> Mechanism:
    """The mechanism without loops, the linear relations between its joints as couplings."""
    linkage = Tree.of(mechanism)
    if not isinstance(linkage, Linkage):
        return mechanism
    bare = replace(mechanism, loops=(), independent=(), assembly=())
    q = linkage.branch.solve(sample(linkage, POSES))[0]
    single = {joint.name for joint in mechanism.joints if joint.type in SINGLE}
    names = linkage.open.coordinates
    couplings = list(_relations(q, [name in single for name in names], names))
    return replace(bare, couplings=(*bare.couplings, *couplings))


def _relations(q: Array, single: list[bool], names: tuple[str, ...]) -> Iterator[Coupling]:
    """Coordinates that are a constant plus a fixed rational combination of earlier ones, at all of `q` (N, n)."""
    free: list[int] = []  # coordinates that no relation gives
    for j in range(q.shape[1]):
        A = np.column_stack([np.ones(len(q)), q[:, free]])
        x = np.linalg.lstsq(A, q[:, j], rcond=1e-10)[0]
        ratios = [float(Fraction(value).limit_denominator(RATIO)) for value in x[1:]]
        given = q[:, j] - q[:, free] @ np.array(ratios)
        if single[j] and all(single[i] for i, r in zip(free, ratios, strict=True) if r) and np.ptp(given) < HOLDS:
            terms = tuple((names[i], r) for i, r in zip(free, ratios, strict=True) if r)
            yield Coupling(names[j], terms, float(given.mean()))
        else:
            free.append(j)

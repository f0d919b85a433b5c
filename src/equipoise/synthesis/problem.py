"""What may be changed and what for: the body pairs, where springs may be attached, the poses, and the goal.

Building a problem is separate from solving it, so that it can be looked at and altered in between: a problem is a
value, and `dataclasses.replace` and its own methods make another one of it, checked again.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..io import Source, loaded
from ..kinematics import Tree, sample
from ..model.arrays import Array
from ..model.errors import Fault, InputError, nearest
from ..model.goal import BY_DEFAULT, TORQUES, Goal, Torque
from ..model.mechanism import Mechanism
from ..model.region import SHAPES, Shape
from ..model.units import Amount
from ..model.validate import MAX_SAMPLES, whole_number
from .convex.beside import beside
from .convex.blocks import Block
from .convex.set_block import without
from .convex.spring_block import SpringBlock
from .goal import asked, motor_scale, stated
from .load import OWN, Load, with_means
from .mounts import Mounts
from .named import Pair, counted, distinct, known, weight_of_each
from .options import Options, option, takes
from .region import Given, Region, given_regions
from .states import States, chosen

__all__ = ["OBJECTIVES", "Objective", "Pair", "Problem", "ProblemOptions", "Region"]

Objective = Torque
OBJECTIVES = TORQUES


@dataclass(frozen=True, kw_only=True)
class ProblemOptions(Options):
    """What `Problem.of` can be asked for.

    Attributes:
        span: without `pairs`, every two bodies at most this many moving joints apart.
        pairs: the pairs of bodies that may be joined by springs.
        radius: [m] of every region without one of its own in `regions`; by default from each link's size.
        shape: of those regions, ball or box.
        regions: body -> where springs may be attached to it, several regions are a union, a length is the region of
            that radius and `shape`; by default the `attachments` of the mechanism.
        objective: "rms" (mean square over configurations and joints) or "peak" (the largest torque).
        joints: the joints or coordinates whose torque counts, all by default; a spherical joint stands for its three.
        weights: joint or coordinate -> the factor by which its torque counts, 1 where none is given.
        samples: random poses inside the joint ranges that the goal is judged on; by default exact averages over all
            configurations where the mechanism allows it, else the workspace's number of samples.
        seed: of those poses.
        unlimited: judge over all configurations, ignoring the ranges of the joints that turn.
        keep: the mechanism's own springs stay and count as a load; else they are replaced.
        counterweights, cams: weights within so much [m] of every link's origin, or body -> distance; and sums of joints
            such as "hip+knee" that may have a cam: see `CounterweightBlock` and `CamBlock`.
        loads: what has to be balanced, by default the mechanism as it is; of several the weighted mean of the mean
            squares counts, or the largest of all peaks.
        goal: what the design is for, by default the mechanism's own; the options above that are given count instead.
    """

    span: int = option(2, "whole", "springs join bodies at most this many moving joints apart (default 2)")
    pairs: Iterable[Pair] | None = None
    radius: Amount | None = option(None, "length", "of every attachment region (default: from each link's size)")
    shape: Shape = "ball"
    regions: Mapping[str, Given] | None = None
    objective: Objective | None = option(None, "text", "what is minimised (default rms torque)", OBJECTIVES)
    joints: Iterable[str] | None = option(None, "names", "A,B,...: the joints whose torque counts (default: all)")
    weights: Mapping[str, float] | None = option(
        None, "number", "factor by which a joint's torque counts (default 1); BODY is a joint's name", each=True
    )
    samples: int | None = option(None, "whole", "random poses to judge on (default: exact averages where possible)")
    seed: int = option(0, "whole", "of the random poses (default 0)")
    unlimited: bool = False
    keep: bool = False
    torsion: Iterable[str] | None = option(None, "names", "A,B,...: joints that may have a torsion spring too; or all")
    tune: Iterable[str] | None = option(None, "names", "A,B,...: springs of the file whose numbers are chosen too")
    counterweights: Amount | Mapping[str, Amount] | None = option(
        None, "length", "weights too, within this of each link's origin, or of one BODY's", each=True
    )
    cams: Iterable[str] | None = option(None, "names", "A,B+C,...: cams too, on joints or sums of joints")
    loads: Iterable[Load] | None = None
    goal: Goal | None = None


@dataclass(frozen=True)
class Problem:
    """Choose springs for `mechanism`.

    Attributes:
        pairs: the pairs of bodies that may be joined by springs; `span` is set where they come from one.
        regions: body -> attachment regions, where some are given, here or in the mechanism; `attachments` has those of
            every body in `pairs`.
        radius, shape: of the other regions [m]; by default from each link's size.
        beside: other blocks of unknowns than the springs of the pairs.
        objective, joints, weights, samples, seed, unlimited, keep, loads: see `ProblemOptions`.
        goal: what else counts: the motors.

    Raises:
        InputError: an unknown body or joint, a pair of one body, nothing to choose, an option out of range, a region
            of no size or out of all proportion to the mechanism, loads of one name, loops that cannot be closed.
    """

    mechanism: Mechanism
    pairs: tuple[Pair, ...]
    regions: Mapping[str, Given] = field(default_factory=dict)
    objective: Objective = "rms"
    joints: tuple[str, ...] | None = None
    weights: Mapping[str, float] = field(default_factory=dict)
    samples: int | None = None
    seed: int = 0
    unlimited: bool = False
    keep: bool = False
    loads: tuple[Load, ...] = (OWN,)
    radius: float | None = None
    shape: Shape = "ball"
    beside: tuple[Block, ...] = ()
    span: int | None = None
    goal: Goal = BY_DEFAULT

    @staticmethod
    @takes(ProblemOptions)
    def of(mechanism: Source, options: ProblemOptions) -> Problem:
        """The problem with sensible defaults; see `ProblemOptions`, and `Problem` for what it raises."""
        given = options.of(ProblemOptions)
        mechanism = loaded(mechanism)
        goal = mechanism.goal if options.goal is None else options.goal
        given |= asked(goal, given)
        if given["pairs"] is None:
            whole_number("span", options.span, 1)
            mounts = Mounts.of(mechanism if options.keep else mechanism.with_springs(()))
            if len(mounts.bodies) < 2:
                raise InputError(f"mechanism '{mechanism.name}': there are no two bodies that a spring could join")
            given["pairs"] = mounts.pairs(options.span)
        else:
            given["span"] = None
        given["regions"] = options.regions or {}
        asked_for = ("counterweights", "cams", "torsion", "tune")
        given["beside"] = beside(mechanism, *(given.pop(name) for name in asked_for), moves=bool(goal.poses.motions))
        mechanism = without(mechanism, given["beside"])
        problem = Problem(mechanism, **given)
        written = stated(goal, problem)
        if written or mechanism.goal:
            problem = replace(problem, mechanism=with_means(mechanism, written), goal=written)
        return problem

    def __post_init__(self) -> None:
        whole_number("seed", self.seed, 0)
        if self.samples is not None:
            whole_number("samples", self.samples, 1, MAX_SAMPLES)
        for name, value, valid in (("objective", self.objective, OBJECTIVES), ("shape", self.shape, SHAPES)):
            if value not in valid:
                raise InputError(Fault((name,), f"unknown {name} {nearest(value, valid)}", valid))
        for body in self.regions:
            known(self.mechanism, "regions", (body,))
        self._set("pairs", distinct(known(self.mechanism, "pairs", p) for p in self.pairs))
        if not self.pairs and not self.beside and not self.keep:
            raise InputError(Fault(("pairs",), "there is none; name at least one pair of bodies"))
        self._set("regions", given_regions(self.mechanism, self.regions, self.shape))
        self._set("joints", None if self.joints is None else counted(self.judged, self.joints))
        self._set("weights", weight_of_each(self.judged, self.weights))
        self._set("loads", tuple(self.loads))
        names = [load.name for load in self.loads]
        if not names or len({*names}) < len(names):
            raise InputError(Fault(("loads",), f"must be one or more with different names, found {names}"))
        reach = Mounts.of(self.judged).reach
        for name in dict.fromkeys(name for pair in self.pairs for name in pair):
            for region in self.attachments[name]:
                region.check(name, reach)

    def _set(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)

    def with_pairs(self, pairs: Iterable[Pair]) -> Problem:
        """The same problem on other pairs."""
        return replace(self, pairs=tuple(pairs), span=None)

    def with_regions(self, regions: Mapping[str, Given]) -> Problem:
        """The same problem with other attachment regions for some bodies."""
        return replace(self, regions={**self.regions, **regions})

    def with_weights(self, weights: Mapping[str, float]) -> Problem:
        """The same problem where the torque of these joints or coordinates counts by other factors."""
        return replace(self, weights={**self.weights, **weight_of_each(self.judged, weights)})

    def with_poses(self, samples: int | None = None, *, seed: int = 0, unlimited: bool = False) -> Problem:
        """The same problem judged on other poses; see `ProblemOptions`."""
        return replace(self, samples=samples, seed=seed, unlimited=unlimited)

    def with_loads(self, loads: Iterable[Load]) -> Problem:
        """The same problem for other loads."""
        return replace(self, loads=tuple(loads))

    def enlarged(self, factor: float) -> Problem:
        """The same problem with every region enlarged about its centre."""
        larger = {name: [region.times(factor) for region in own] for name, own in self.attachments.items()}
        return self.with_regions(larger)

    @cached_property
    def attachments(self) -> Mapping[str, tuple[Region, ...]]:
        """The attachment regions of every body named in `pairs`, and of the others that some are given for."""
        mounts = Mounts.of(self.judged)
        make = Region.ball if self.shape == "ball" else Region.box
        found = given_regions(self.mechanism, self.regions, self.shape)
        for name in (name for pair in self.pairs for name in pair if name not in found):
            found[name] = (make(mounts.default_radius(name) if self.radius is None else self.radius),)
        return found

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        """The unknowns: the springs between every two regions of each pair, and what is beside them."""
        at = self.attachments
        return (*(SpringBlock(a, b, p, q) for a, b in self.pairs for p in at[a] for q in at[b]), *self.beside)

    @cached_property
    def kept(self) -> Mechanism:
        """What stays of the mechanism: without the springs that are replaced."""
        return self.mechanism if self.keep else self.mechanism.with_springs(())

    @cached_property
    def judged(self) -> Mechanism:
        """What stays, over the poses that count: without the ranges of revolute joints where they are ignored."""
        if not self.unlimited:
            return self.kept
        joints = (replace(j, range=None) if j.type == "revolute" else j for j in self.kept.joints)
        return replace(self.kept, joints=tuple(joints))

    @cached_property
    def cases(self) -> tuple[Mechanism, ...]:
        """`judged` under each load, of a tilt in several directions."""
        return tuple(case for load in self.loads for case in load.each(self.judged))

    @cached_property
    def shares(self) -> Array:
        """(cases,) what the mean square torque of each of `cases` counts; they add up to 1."""
        each = [(load.weight, len(load.each(self.judged))) for load in self.loads]
        every = np.array([weight / count for weight, count in each for _ in range(count)])
        return np.asarray(every / every.sum())

    @cached_property
    def states(self) -> States:
        """The poses that count: those that the goal gives, else random ones inside the joint ranges."""
        return self._chosen or States.still(sample(Tree.of(self.judged), self.count, self.seed))

    @property
    def given_poses(self) -> bool:
        """Whether the goal gives them."""
        return self.goal.poses.chosen

    @cached_property
    def _chosen(self) -> States | None:
        return chosen(self.goal.poses, Tree.of(self.judged), self.count, self.seed)

    @property
    def count(self) -> int:
        """The number of random poses where averages are not exact."""
        return self.samples or self.mechanism.workspace.samples

    @cached_property
    def scale(self) -> Array:
        """(n,) what each coordinate's torque counts: 1 for an angle, the mechanism's reach [m] for a slide's force.

        Or what its motor makes of it. Times its weight, and 0 for those that do not count.

        Raises:
            InputError: a joint that counts has no motor that is known.
        """
        tree = Tree.of(self.judged)
        counts = [self.joints is None or name in self.joints for name in tree.coordinates]
        weights = np.where(counts, [self.weights.get(name, 1.0) for name in tree.coordinates], 0.0)
        every = motor_scale(self.goal.count, tree, weights > 0)
        reach = Mounts.of(self.judged).reach if tree.turns[weights > 0].any() else 1.0  # slides alone: their forces
        return weights * (np.where(tree.turns, 1.0, reach) if every is None else every)

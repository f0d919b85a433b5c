"""Energy and torque of many poses behind one call: numpy, one compiled kernel for all mechanisms, or one generated.

The work done so far and to be done chooses: compiling has to pay for itself, as `COSTS` estimates it.
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property, lru_cache
from importlib.util import find_spec
from typing import Any, Literal, NamedTuple, Protocol, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...kinematics.linkage import Linkage
from ...kinematics.tree import Tree
from ...model.arrays import Array
from ...model.errors import Fault, InputError, UnsupportedError, nearest
from ...model.mechanism import Mechanism
from . import by_numpy, generic, sines
from .flat_tree import FlatTree
from .recursions import programs
from .trace import Program

Tier = Literal["numpy", "generic", "generated"]
TIERS: tuple[Tier, ...] = get_args(Tier)
COSTS = {  # seconds: to start, to start for each operation, for each operation and pose
    "numpy": (0.0, 0.0, 2.5e-9),
    "generic": (0.7, 0.0, 2e-10),
    "generated": (0.1, 6e-4, 5e-11),
}
CHUNK = 32_768  # poses that a thread takes at a time, at most
LINE = 64  # bytes of a cache's line, and of the longest vectors
CACHE = 2**22  # bytes: results of more have left the caches before anybody reads them
Real = NDArray[Any]  # double or single


class Batch(NamedTuple):
    """Of N poses: `energy` (N,) [J] and holding `torque` (N, n) [N m or N], gravity and springs together."""

    energy: Real
    torque: Real


class Parts(NamedTuple):
    """`gravity` (N,) energy [J], `path` (N, springs) [m or rad], torque of gravity and springs (N, n) [N m or N]."""

    gravity: Array
    path: Array
    gravity_torque: Array
    spring_torque: Array


class Kernel:
    """Energy and torque of a mechanism without loops, compiled; the same numbers as `Potential` to rounding.

    A pose with a coordinate that is not finite is NaN in everything.

    Raises:
        UnsupportedError: the mechanism has loops, or a cable on a pulley.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        tree = Tree.of(mechanism)
        if isinstance(tree, Linkage):
            raise UnsupportedError(f"mechanism '{mechanism.name}' has loops: the kernel covers trees")
        for spring in mechanism.springs:
            if not spring.compiled:
                raise UnsupportedError(f"'{spring.name}' lies on a pulley: the kernel covers straight cables")
        self.mechanism, self.tree = mechanism, tree
        self._total, self._split = _Code(tree, False), _Code(tree, True)

    @staticmethod
    @lru_cache(maxsize=32)
    def of(mechanism: Mechanism) -> Kernel:
        """The kernel of a mechanism; the last few are remembered."""
        return Kernel(mechanism)

    def __call__(self, q: ArrayLike, *, out: Real | None = None, threads: int = 1, tier: Tier | None = None) -> Batch:
        """Energy and torque at `q` (N, n) [rad or m]; of single precision when `q` is.

        Fastest where a coordinate's values lie next to each other (Fortran's order); the torque is given so.

        Args:
            out: (1 + n, N) to write to, energy first, as a row each; a fresh large array costs more than the work. Best
                one of `room`.
            threads: that share the work.
            tier: what computes; by default what is estimated to be done first.
        """
        q = self._poses(q)
        rows = self._total.rows
        if out is None:
            out = _empty(rows, len(q), q.dtype)
        elif out.shape != (rows, len(q)) or out.dtype != q.dtype or (len(q) > 1 and out.strides[1] != out.itemsize):
            raise InputError(f"out has shape {out.shape} and {out.dtype}, expected rows of {(rows, len(q))}, {q.dtype}")
        self._total.run(q.T, out, threads, tier)
        return Batch(out[0], out[1:].T)

    def room(self, N: int, dtype: type[np.floating] = np.float64) -> Real:
        """(1 + n, N) for `out`, not filled: aligned for vectors, so that large results can go past the caches."""
        return _empty(self._total.rows, N, np.dtype(dtype))

    def parts(self, q: ArrayLike, *, threads: int = 1, tier: Tier | None = None) -> Parts:
        """Energies, paths and torques of gravity and springs apart, at `q` (N, n) [rad or m]."""
        q = self._poses(q).astype(float, copy=False)
        out = _empty(self._split.rows, len(q), q.dtype)
        self._split.run(q.T, out, threads, tier)
        n, springs = self.tree.n, len(self.mechanism.springs)
        gravity, path, gravity_torque, spring_torque = np.split(out, np.cumsum([1, springs, n]))
        return Parts(gravity[0], path.T, gravity_torque.T, spring_torque.T)

    def _poses(self, q: ArrayLike) -> Real:
        q = np.asarray(q)
        if q.dtype not in (np.float32, np.float64):
            q = q.astype(float)
        if q.ndim != 2 or q.shape[1] != self.tree.n:
            raise InputError(f"q has shape {q.shape}, expected (N, {self.tree.n}) for {self.tree.coordinates}")
        fits = q.flags.aligned and all(stride % q.itemsize == 0 for stride in q.strides)
        return q if fits else q.copy()

    @property
    def programs(self) -> dict[str, Program]:
        """The program of every recursion, for who wants to count or to translate them."""
        return dict(self._total.programs)


class _Runs(Protocol):
    def __call__(self, q: Real, out: Real, streamed: bool) -> float: ...


class _Code:
    """One program of a mechanism and what runs it, each made when it is first needed."""

    def __init__(self, tree: Tree, split: bool) -> None:
        self.tree, self.split = tree, split
        self.rows = 1 + (len(tree.mechanism.springs) + 2 * tree.n if split else tree.n)
        self._work = 0  # poses so far
        self._started: dict[tuple[Tier, bool], _Runs] = {}
        # a sum of |q| below this keeps every angle within what the compiled sines are exact for
        reach = np.abs(tree.C[tree.rotates]).max(initial=1.0)
        self._far = (sines.FARTHEST - np.abs(tree.s0[tree.rotates]).max(initial=0.0)) / reach

    @cached_property
    def programs(self) -> dict[str, Program]:
        return {str(name): program for name, program in programs(FlatTree.of(self.tree), self.split).items()}

    @cached_property
    def program(self) -> Program:
        """The cheapest."""
        return min(self.programs.values(), key=lambda program: program.cost)

    def run(self, q: Real, out: Real, threads: int, tier: Tier | None) -> None:
        """Compute `out` (rows, N) at `q` (n, N)."""
        N, single = q.shape[1], q.dtype == np.float32
        self._work += N
        call = self._runner(tier or self._choice(single), single)
        streamed = out.nbytes > CACHE

        # whole lines of a cache, and enough parts that no thread waits long for another
        size = min(CHUNK, max(4096, -(-N // (4 * threads)) // 512 * 512))

        def work(chunks: Iterator[int]) -> None:
            for start in chunks:
                part = slice(start, start + size)
                # a sine of single precision is no better than its angle, so far away is no matter
                if not call(q[:, part], out[:, part], streamed) <= self._far:
                    by_numpy.run(self.program, q[:, part], out[:, part])

        chunks = iter(range(0, N, size))  # each thread takes the next: a slow one holds nobody up
        if threads <= 1 or size >= N:
            work(chunks)
            return
        with ThreadPoolExecutor(threads - 1) as pool:
            others = [pool.submit(work, chunks) for _ in range(threads - 1)]
            work(chunks)
            for done in others:
                done.result()

    def _choice(self, single: bool) -> Tier:
        if find_spec("numba") is None:
            return "numpy"
        operations = len(self.program.code)

        def seconds(tier: Tier) -> float:
            start, start_each, each = COSTS[tier]
            begin = 0.0 if (tier, single) in self._started else start + start_each * operations
            return begin + each * operations * self._work

        return min(TIERS, key=seconds)

    def _runner(self, tier: Tier, single: bool) -> _Runs:
        if (tier, single) not in self._started:
            self._started[tier, single] = self._start(tier, single)
        return self._started[tier, single]

    def _start(self, tier: Tier, single: bool) -> _Runs:
        program = self.program
        if tier == "generated":
            from .generated import Generated

            return Generated(program, single)
        if tier == "generic":
            return lambda q, out, streamed: generic.run(program, q, out)
        if tier == "numpy":
            return lambda q, out, streamed: by_numpy.run(program, q, out)
        raise InputError(Fault(("tier",), f"there is no tier {nearest(tier, TIERS)}", TIERS))


def _empty(rows: int, N: int, dtype: np.dtype) -> Real:
    """(rows, N); long rows begin at whole lines of a cache, and not all at the same ones of it."""
    if N <= 512:
        return np.empty((rows, N), dtype)
    row, line = N + (72 - N) % 512, LINE // np.dtype(dtype).itemsize
    found = np.empty(rows * row + line, dtype)
    skip = -found.ctypes.data % LINE // found.itemsize
    return found[skip : skip + rows * row].reshape(rows, row)[:, :N]

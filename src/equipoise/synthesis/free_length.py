"""Ordinary springs: attachments, stiffness and preload that make the best of springs with a free length.

A free length L0 adds ``-k L0 d/|d|`` to the force of the zero-free-length spring: no moment matrix, no bound, but small
changes of a design that was optimal without it. Where a spring's length changes little over the workspace, L0/|d| is
nearly constant and only weakens the spring: so one attachment moves close to its joint and the spring gets stiffer.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array
from ..balance import Balance, check
from ..energy.potential import Potential
from ..errors import Fault, InputError, nearest
from ..kinematics import Tree, sample
from ..mechanism import Mechanism
from ..validate import MAX_SAMPLES, whole_number
from .gram import stretch
from .polish import project
from .problem import Problem, Region

WIDTH = 8  # unknowns of a spring: log stiffness, u_a, u_b in their regions' coordinates (as in `polish`), preload
SHRUNK = (1.0, 0.5, 0.25)  # starts: one attachment of every spring drawn in by so much, stiffened by as much
SLACK = 10.0  # weight of a spring shorter than its free length, per share of it
ITERATIONS, STALLED = 150, 15
Penalty = Callable[[Array, Array], tuple[Array, Array]]
"""Attachments (springs, 2, 3) [m] and free lengths -> rows to keep at zero, and their derivative by the attachments."""


@dataclass(frozen=True)
class Ordinary:
    """What is lost with ordinary springs.

    Attributes:
        ideal: the design with zero free length.
        plain: the same springs with their free lengths, nothing else changed.
        balance: with attachments, stiffness and preload optimised.
        free_length: spring -> free length as bought [m]; what the preload makes of it stands with the spring.
    """

    ideal: Balance
    plain: Balance
    balance: Balance
    free_length: Mapping[str, float]

    @property
    def mechanism(self) -> Mechanism:
        return self.balance.mechanism

    @cached_property
    def gain(self) -> float:
        """How many times smaller the peak residual has become."""
        return self.plain.relative / self.balance.relative if self.balance.relative else np.inf

    def to_dict(self) -> dict[str, Any]:
        """The ``free_length`` part of ``equipoise design --json``."""
        old = {s.name: (s, use) for s, use in zip(self.ideal.mechanism.springs, self.ideal.use, strict=True)}
        springs = []
        for spring, use in zip(self.mechanism.springs, self.balance.use, strict=True):
            before, before_use = old[spring.name]
            bought = self.free_length.get(spring.name, 0.0)
            springs.append(
                {
                    "name": spring.name,
                    "free_length": bought,
                    "preload": spring.stiffness * (bought - spring.free_length),
                    "stiffness": [before.stiffness, spring.stiffness],
                    "max_force": [float(before_use.max_force), float(use.max_force)],
                }
            )
        return {
            "residual": {
                "ideal": self.ideal.relative,
                "plain": self.plain.relative,
                "optimised": self.balance.relative,
            },
            "gain": self.gain if np.isfinite(self.gain) else None,
            "springs": springs,
        }


def ordinary(
    mechanism: Mechanism,
    free_length: float | Mapping[str, float],
    *,
    regions: Mapping[str, Region] | None = None,
    stiffness_factor: float = 5.0,
    preload: float = 0.0,
    penalty: Callable[[Mechanism, Array], Penalty] | None = None,
    poses: int = 200,
    seed: int = 0,
) -> Ordinary:
    """Give the springs of a zero-free-length design a free length, and make the best of it.

    Args:
        free_length: of all springs, or spring -> free length [m]; other springs stay as they are.
        regions: where the ends on a body may be; by default a ball as large as they are away from its origin.
        stiffness_factor: stiffness stays between its old value over this and times this.
        preload: the share of the free length that initial tension may take away; a rod in series may double it.
        penalty: more rows, made from the mechanism and the poses, that are zero where a design is allowed.
        poses: random ones that the residual torque is minimised on, root mean square.

    Raises:
        InputError: a bad option, or no such spring.
    """
    lengths = _lengths(mechanism, free_length)
    if not (1 <= stiffness_factor < np.inf and 0 <= preload <= 1):
        raise InputError("stiffness_factor must be at least 1 and preload a share from 0 to 1")
    whole_number("poses", poses, 1, MAX_SAMPLES)
    fit = _Fit(mechanism, lengths, regions or {}, sample(Tree.of(mechanism), poses, seed), penalty)
    plain = mechanism.with_springs(
        replace(s, free_length=lengths.get(s.name, s.free_length)) for s in mechanism.springs
    )
    found = [fit.solve(x, stiffness_factor, preload) for x in fit.starts(stiffness_factor)]
    best, _ = min(found, key=lambda one: one[1])
    return Ordinary(check(mechanism), check(plain), check(fit.mechanism_of(best)), lengths)


def _lengths(mechanism: Mechanism, given: float | Mapping[str, float]) -> dict[str, float]:
    names = tuple(spring.name for spring in mechanism.springs)
    if not names:
        raise InputError(f"mechanism '{mechanism.name}' has no springs that could have a free length")
    lengths = dict(given) if isinstance(given, Mapping) else dict.fromkeys(names, float(given))
    for name, value in lengths.items():
        if name not in names:
            raise InputError(Fault(("free_length",), f"there is no spring {nearest(name, names)}", names))
        if not 0 < value < np.inf:
            raise InputError(Fault(("free_length", name), f"must be more than 0 m, found {value:g}"))
    return lengths


class _Fit:
    """The least-squares problem; `x` (springs, WIDTH) flat, lengths in shares of each spring's free length."""

    def __init__(
        self,
        mechanism: Mechanism,
        lengths: Mapping[str, float],
        regions: Mapping[str, Region],
        q: Array,
        penalty: Callable[[Mechanism, Array], Penalty] | None,
    ) -> None:
        self.mechanism = mechanism
        self.springs = [spring for spring in mechanism.springs if spring.name in lengths]
        self.free = np.array([lengths[spring.name] for spring in self.springs])
        tree = Tree.of(mechanism)
        pairs = tuple((s.body_a, s.body_b) for s in self.springs)
        ends = [end for s in self.springs for end in ((s.body_a, s.p_a), (s.body_b, s.p_b))]
        own = {b: Region.ball(max(float(np.linalg.norm(p)) for c, p in ends if c == b)) for b, _ in ends}
        own = {body: region for body, region in own.items() if region.half[0] > 0}  # else as large as its link
        self.problem = Problem.of(mechanism, pairs=pairs, regions=own | dict(regions))
        self.lift = np.array([[self.problem.regions[b].lift for b in pair] for pair in pairs])  # (springs, 2, 4, 4)
        self.box = np.array([[self.problem.regions[b].shape == "box" for b in pair] for pair in pairs])
        poses = tree.poses(q)
        velocities = tree.velocities(q, poses)
        self.Z, self.dZ = zip(*(stretch(poses, velocities, *(tree.index[b] for b in p)) for p in pairs), strict=True)
        rest = mechanism.with_springs(s for s in mechanism.springs if s.name not in lengths)
        self.load = Potential(rest)(q).torque * self.problem.weights
        for dZ in self.dZ:
            dZ *= self.problem.weights[:, None, None]
        gravity = Potential(mechanism)(q).gravity_torque * self.problem.weights
        self.unit = float(np.linalg.norm(gravity)) or 1.0
        self.penalty = None if penalty is None else penalty(mechanism, q)

    def starts(self, factor: float) -> Iterator[Array]:
        """The springs as they are, and with the end that is nearer its body's origin drawn in."""
        x = np.zeros((len(self.springs), WIDTH))
        x[:, 0] = np.log([spring.stiffness for spring in self.springs])
        for i, spring in enumerate(self.springs):
            for end, p in enumerate((spring.p_a, spring.p_b)):
                L = self.lift[i, end]
                u = (np.array(p) - L[:3, 3]) / np.where(np.diag(L)[:3] > 0, np.diag(L)[:3], 1.0)
                x[i, 1 + 3 * end : 4 + 3 * end] = project(u, self.box[i, end])
        for share in SHRUNK:
            if share * factor >= 1:
                start = x.copy()
                for row, spring in zip(start, self.springs, strict=True):
                    end = int(np.linalg.norm(spring.p_b) <= np.linalg.norm(spring.p_a))
                    row[1 + 3 * end : 4 + 3 * end] *= share
                    row[0] -= np.log(share)
                yield start

    def solve(self, start: Array, factor: float, preload: float) -> tuple[Array, float]:
        """Projected Levenberg-Marquardt, as `polish` for one design: the best x and its cost."""
        log_k = np.log([spring.stiffness for spring in self.springs])
        lower, upper = np.full(start.shape, -1.0), np.ones(start.shape)
        lower[:, 0], upper[:, 0] = log_k - np.log(factor), log_k + np.log(factor)
        lower[:, 7] = -preload
        low, high = lower.ravel(), upper.ravel()
        x = np.clip(start.ravel(), low, high)
        r, J = self.evaluate(x)
        damping, slow = 1e-3, 0
        for _ in range(ITERATIONS):
            g = J.T @ r
            free = ~(((x <= low) & (g > 0)) | ((x >= high) & (g < 0)))
            H = (J[:, free].T @ J[:, free]) + 0.0
            diagonal = np.diag(H)
            H += np.diag(damping * (diagonal + 1e-6 * diagonal.max(initial=0) + 1e-30))
            step = np.zeros(len(x))
            step[free] = np.clip(-np.linalg.solve(H, g[free]), -0.5, 0.5)
            trial = np.clip(x + step, low, high)
            r_trial, J_trial = self.evaluate(trial)
            better = r_trial @ r_trial < r @ r
            slow = slow + 1 if not better or r_trial @ r_trial > (1 - 1e-5) * (r @ r) else 0
            if better:
                x, r, J, damping = trial, r_trial, J_trial, max(damping * 0.2, 1e-12)
            else:
                damping *= 8.0
            if slow >= STALLED or damping > 1e8:
                break
        return x, float(r @ r)

    def mechanism_of(self, x: Array) -> Mechanism:
        k, p, free = self._values(x)
        new = {
            s.name: replace(s, stiffness=float(k[i]), p_a=_vec(p[i, 0]), p_b=_vec(p[i, 1]), free_length=float(free[i]))
            for i, s in enumerate(self.springs)
        }
        return self.mechanism.with_springs(new.get(s.name, s) for s in self.mechanism.springs)

    def _values(self, x: Array) -> tuple[Array, Array, Array]:
        """Stiffness (springs,), attachments (springs, 2, 3) [m], free lengths (springs,) [m]."""
        x = x.reshape(-1, WIDTH)
        u = project(x[:, 1:7].reshape(-1, 2, 3), self.box)
        p = np.einsum("seij,sej->sei", self.lift[..., :3, :3], u) + self.lift[..., :3, 3]
        return np.exp(x[:, 0]), p, self.free * (1 + x[:, 7])

    def evaluate(self, x: Array) -> tuple[Array, Array]:
        """Rows: residual torque as a share of the unbalanced one, slack, what else is asked for; and their Jacobian."""
        k, p, free = self._values(x)
        inner = np.einsum("seij,sejk->seik", self.lift[..., :3, :3], self._projector(x))  # dp/du
        torque, S = self.load.copy(), len(k)
        J = np.zeros((S, WIDTH, *torque.shape))
        slack, J_slack = np.zeros((S, len(torque))), np.zeros((S, WIDTH, len(torque)))
        for i in range(S):
            z = np.array([*p[i, 0], 1.0, *p[i, 1]])
            d, rate = self.Z[i] @ z, self.dZ[i] @ z  # (N, 3), (N, n, 3)
            length = np.maximum(np.linalg.norm(d, axis=1), 1e-9)
            power = np.einsum("ni,nji->nj", d, rate)
            share = 1 - free[i] / length
            torque += k[i] * share[:, None] * power
            toward = np.einsum("nia,ni->na", self.Z[i], d)  # Z'd: how the length grows, times itself
            by_z = share[:, None, None] * (
                np.einsum("nia,nji->nja", self.Z[i], rate) + np.einsum("ni,njia->nja", d, self.dZ[i])
            )
            by_z += (free[i] / length**3)[:, None, None] * power[..., None] * toward[:, None]
            J[i, 0] = k[i] * share[:, None] * power
            J[i, 1:7] = k[i] * self._by_u(by_z, inner[i]).transpose(2, 0, 1)
            J[i, 7] = -k[i] * self.free[i] / length[:, None] * power
            # a spring that only pulls must not get shorter than its free length
            short = free[i] > length
            slack[i] = np.where(short, (free[i] - length) / self.free[i], 0.0)
            J_slack[i, 1:7] = np.where(short, -self._by_u(toward / length[:, None], inner[i]).T / self.free[i], 0.0)
            J_slack[i, 7] = np.where(short, 1.0, 0.0)
        weight = SLACK / np.sqrt(slack.shape[1])
        rows = [torque.ravel() / self.unit, weight * slack.ravel()]
        blocks = [J.reshape(S * WIDTH, -1).T / self.unit, weight * _diagonal(J_slack)]
        if self.penalty is not None:
            more, by_p = self.penalty(self._all_ends(p), free)
            own = [self.mechanism.springs.index(spring) for spring in self.springs]
            by_u = np.einsum("rsei,seij->rsej", by_p[:, own], inner).reshape(len(more), S, 6)
            block = np.zeros((len(more), S, WIDTH))
            block[..., 1:7] = by_u
            rows.append(more)
            blocks.append(block.reshape(len(more), -1))
        return np.concatenate(rows), np.concatenate(blocks)

    def _all_ends(self, p: Array) -> Array:
        """(all springs, 2, 3) attachments, those of other springs as they are."""
        ends = np.array([(s.p_a, s.p_b) for s in self.mechanism.springs])
        ends[[self.mechanism.springs.index(spring) for spring in self.springs]] = p
        return ends

    def _projector(self, x: Array) -> Array:
        """(springs, 2, 3, 3) derivative of `project`: outside a ball only the tangent counts."""
        u = x.reshape(-1, WIDTH)[:, 1:7].reshape(-1, 2, 3)
        norm = np.linalg.norm(u, axis=-1)[..., None, None]
        outside = (norm > 1) & ~self.box[..., None, None]
        n = np.divide(u[..., None], norm, out=np.zeros((*u.shape, 1)), where=norm > 0)
        return np.where(outside, (np.eye(3) - n * np.swapaxes(n, -1, -2)) / np.maximum(norm, 1.0), np.eye(3))

    @staticmethod
    def _by_u(by_z: Array, inner: Array) -> Array:
        """(..., 7) derivatives by z -> (..., 6) by u_a and u_b."""
        return np.concatenate([by_z[..., :3] @ inner[0], by_z[..., 4:] @ inner[1]], axis=-1)


def _diagonal(J: Array) -> Array:
    """(springs, WIDTH, N) of rows that concern one spring each -> (springs N, springs WIDTH)."""
    S, width, N = J.shape
    out = np.zeros((S, N, S, width))
    for i in range(S):
        out[i, :, i] = J[i].T
    return out.reshape(S * N, S * width)


def _vec(p: Array) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in p)
    return x, y, z

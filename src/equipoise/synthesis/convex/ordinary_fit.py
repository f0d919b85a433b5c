"""Few springs made the best of under what is not a moment matrix: free lengths, and rows that must stay at zero.

A projected Levenberg-Marquardt method like `polish`, for one design at sampled poses. A penalty, room for the springs
for example, adds rows of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from ...energy.evaluate import Potential
from ...kinematics import Tree
from ...model.arrays import Array, vec3
from ...model.elements import lines
from ...model.mechanism import Mechanism
from ..problem import Problem
from ..region import Region, nearest_region, project
from .spring_block import at_ends, between, stretch

WIDTH = 8  # unknowns of a spring: log stiffness, u_a, u_b in their regions' coordinates (as in `polish`), preload
SHRUNK = (1.0, 0.5, 0.25)  # starts: one attachment of every spring drawn in by so much, stiffened by as much
SLACK = 10.0  # weight of a spring shorter than its free length, per share of it
ITERATIONS, STALLED = 150, 15
FREE_LENGTHS = "what gives springs a free length, or room,"  # in messages
Penalty = Callable[[Array], tuple[Array, Array]]
"""Attachments (springs, 2, 3) [m] -> rows to keep at zero, and their derivative (rows, springs, 2, 3)."""


def both(one: Penalty, other: Penalty) -> Penalty:
    """The rows of two penalties."""

    def rows(ends: Array) -> tuple[Array, Array]:
        found = one(ends), other(ends)
        return np.concatenate([r for r, _ in found]), np.concatenate([J for _, J in found])

    return rows


class Fit:
    """The least-squares problem; `x` (springs, WIDTH) flat, lengths in shares of each spring's free length."""

    def __init__(
        self,
        mechanism: Mechanism,
        lengths: Mapping[str, float],
        regions: Mapping[str, tuple[Region, ...]],
        q: Array,
        penalty: Penalty | None,
    ) -> None:
        self.mechanism = mechanism
        self.springs = [spring for spring in lines(mechanism, FREE_LENGTHS) if spring.name in lengths]
        self.free = np.array([lengths[spring.name] for spring in self.springs])
        self.size = np.where(self.free > 0, self.free, 1.0)  # that slack is a share of
        tree = Tree.of(mechanism)
        pairs = tuple((s.body_a, s.body_b) for s in self.springs)
        ends = [end for s in self.springs for end in ((s.body_a, s.p_a), (s.body_b, s.p_b))]
        far = {b: max(float(np.linalg.norm(p)) for c, p in ends if c == b) for b, _ in ends if b not in regions}
        own = {body: Region.ball(radius) for body, radius in far.items() if radius > 0}  # else as large as its link
        self.problem = Problem.of(mechanism, pairs=pairs, regions=own | dict(regions))
        found = [nearest_region(self.problem.attachments[b], p) for b, p in ends]
        self.regions = list(zip(found[::2], found[1::2], strict=True))  # of both ends of each spring
        self.lift = np.array([[region.lift for region in pair] for pair in self.regions])  # (springs, 2, 4, 4)
        self.box = np.array([[region.shape == "box" for region in pair] for pair in self.regions])
        poses = tree.poses(q)
        velocities = tree.velocities(q, poses)
        self.Z, self.dZ = zip(*(stretch(poses, velocities, *(tree.index[b] for b in p)) for p in pairs), strict=True)
        rest = mechanism.with_springs(s for s in mechanism.springs if s.name not in lengths)
        self.load = Potential(rest)(q).torque * self.problem.scale
        for dZ in self.dZ:
            dZ *= self.problem.scale[:, None, None]
        gravity = Potential(mechanism)(q).gravity_torque * self.problem.scale
        self.unit = float(np.linalg.norm(gravity)) or 1.0
        self.penalty = penalty

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
        k, _, free = self._values(x)
        ends = [
            [vec3(region.inside(u)) for region, u in zip(*both, strict=True)]
            for both in zip(self.regions, self._shapes(x), strict=True)
        ]
        new = {
            s.name: replace(s, stiffness=float(k[i]), p_a=ends[i][0], p_b=ends[i][1], free_length=float(free[i]))
            for i, s in enumerate(self.springs)
        }
        return self.mechanism.with_springs(new.get(s.name, s) for s in self.mechanism.springs)

    def _values(self, x: Array) -> tuple[Array, Array, Array]:
        """Stiffness (springs,), attachments (springs, 2, 3) [m], free lengths (springs,) [m]."""
        p = np.einsum("seij,sej->sei", self.lift[..., :3, :3], self._shapes(x)) + self.lift[..., :3, 3]
        x = x.reshape(-1, WIDTH)
        return np.exp(x[:, 0]), p, self.free * (1 + x[:, 7])

    def _shapes(self, x: Array) -> Array:
        """(springs, 2, 3) attachments in their regions' own coordinates."""
        return project(x.reshape(-1, WIDTH)[:, 1:7].reshape(-1, 2, 3), self.box)

    def evaluate(self, x: Array) -> tuple[Array, Array]:
        """Rows: residual torque as a share of the unbalanced one, slack, what else is asked for; and their Jacobian."""
        k, p, free = self._values(x)
        inner = np.einsum("seij,sejk->seik", self.lift[..., :3, :3], self._projector(x))  # dp/du
        torque, S = self.load.copy(), len(k)
        J = np.zeros((S, WIDTH, *torque.shape))
        slack, J_slack = np.zeros((S, len(torque))), np.zeros((S, WIDTH, len(torque)))
        for i in range(S):
            z = between(p[i])
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
            slack[i] = np.where(short, (free[i] - length) / self.size[i], 0.0)
            J_slack[i, 1:7] = np.where(short, -self._by_u(toward / length[:, None], inner[i]).T / self.size[i], 0.0)
            J_slack[i, 7] = np.where(short, 1.0, 0.0)
        weight = SLACK / np.sqrt(slack.shape[1])
        rows = [torque.ravel() / self.unit, weight * slack.ravel()]
        blocks = [J.reshape(S * WIDTH, -1).T / self.unit, weight * _diagonal(J_slack)]
        if self.penalty is not None:
            more, by_p = self.penalty(self._all_ends(p))
            own = [self.mechanism.springs.index(spring) for spring in self.springs]
            by_u = np.einsum("rsei,seij->rsej", by_p[:, own], inner).reshape(len(more), S, 6)
            block = np.zeros((len(more), S, WIDTH))
            block[..., 1:7] = by_u
            rows.append(more)
            blocks.append(block.reshape(len(more), S * WIDTH))
        return np.concatenate(rows), np.concatenate(blocks)

    def _all_ends(self, p: Array) -> Array:
        """(all springs, 2, 3) attachments, those of other springs as they are."""
        ends = np.array([(s.p_a, s.p_b) for s in lines(self.mechanism, FREE_LENGTHS)])
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
        """Derivatives by z -> (..., 6) by u_a and u_b."""
        by_u = at_ends(by_z)[..., None, :] @ inner
        return by_u.reshape(*by_z.shape[:-1], -1)


def _diagonal(J: Array) -> Array:
    """(springs, WIDTH, N) of rows that concern one spring each -> (springs N, springs WIDTH)."""
    S, width, N = J.shape
    out = np.zeros((S, N, S, width))
    for i in range(S):
        out[i, :, i] = J[i].T
    return out.reshape(S * N, S * width)

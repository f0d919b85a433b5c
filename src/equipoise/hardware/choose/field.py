"""Where the points of bodies are and how they move, as linear maps, over the poses that a choice is judged on."""

from __future__ import annotations

from itertools import product

import numpy as np

from ...energy.reference import Reference
from ...kinematics import Tree, sample
from ...kinematics.sampling import bounds, inside
from ...model.arrays import Array
from ...model.elements import Element
from ...model.mechanism import Mechanism

CORNERED = 6  # coordinates, at most, whose box has all its corners among the poses
ALONG = 61  # poses of a mechanism with one coordinate, evenly


class Field:
    """N poses of a mechanism with n coordinates, and the torque that its springs are to balance there.

    Attributes:
        mechanism: with the springs that stay.
        load: (N * n,) holding torque without the springs that are chosen, each coordinate times its `scale`.
    """

    def __init__(self, mechanism: Mechanism, scale: Array, count: int, seed: int) -> None:
        self.mechanism, self.scale = mechanism, scale
        self.tree = tree = Tree.of(mechanism)
        self.q = _poses(tree, count, seed)
        self.poses = tree.poses(self.q)
        self.velocities = tree.velocities(self.q, self.poses)
        self.load = (Reference(mechanism)(self.q).torque * scale).ravel()
        self._maps: dict[str, tuple[Array, Array]] = {}
        self._falls: dict[str, Array] = {}
        self._seen: dict[tuple[str, str], Array] = {}

    def maps(self, body: str) -> tuple[Array, Array]:
        """(N, 3, 4) and (N, n, 3, 4): place [m] and its change by each coordinate of a point p are ``map @ [p; 1]``."""
        if body not in self._maps:
            B = self.tree.index[body]
            place = np.concatenate([self.poses.R[:, B], self.poses.p[:, B, :, None]], axis=2)
            origin = self.velocities.v[:, B]
            axes = [self.velocities.point(self.poses, B, e) - origin for e in np.eye(3)]
            moves = np.stack([*axes, origin], axis=3).transpose(0, 2, 1, 3)
            self._maps[body] = place, np.ascontiguousarray(moves)
        return self._maps[body]

    def lines(self, a: str, p_a: Array, b: str, p_b: Array) -> tuple[Array, Array, Array]:
        """Of G lines between points (G, 3) of two bodies: what their pull k s - c does.

        Returns:
            (G, N * n) the torque of k = 1, (G, N * n) that of c = -1, both times `scale`, and (G, N) lengths [m].
        """
        (place_a, move_a), (place_b, move_b) = self.maps(a), self.maps(b)
        one = np.ones((len(p_a), 1))
        x_a, x_b = np.hstack([p_a, one]), np.hstack([p_b, one])
        d = np.einsum("nix,gx->gni", place_b, x_b) - np.einsum("nix,gx->gni", place_a, x_a)
        rate = np.einsum("njix,gx->gnji", move_b, x_b) - np.einsum("njix,gx->gnji", move_a, x_a)
        s = np.maximum(np.sqrt(np.einsum("gni,gni->gn", d, d)), 1e-12)
        K = np.einsum("gni,gnji->gnj", d, rate) * self.scale
        return K.reshape(len(s), -1), (K / s[..., None]).reshape(len(s), -1), s

    def weight(self, body: str, p: Array) -> Array:
        """(G, N * n) torque of 1 kg at points (G, 3) of a body, times `scale`."""
        if body not in self._falls:
            falls = np.einsum("njix,i->njx", self.maps(body)[1], -np.array(self.mechanism.gravity))
            self._falls[body] = (falls * self.scale[:, None]).reshape(-1, 4)
        falls = self._falls[body]
        return p @ falls[:, :3].T + falls[:, 3]

    def element(self, element: Element) -> tuple[Array, Array]:
        """(N * n,) torque of a unit force, times `scale`, and (N,) path [m or rad] of an element."""
        arms = element.lever_arms(self.tree, self.poses, self.velocities)
        return (arms * self.scale).ravel(), element.path(self.tree, self.poses)

    def seen_from(self, a: str, b: str) -> Array:
        """(N, 3, 4) where the point p of body `b` is in a's frame [m]: ``map @ [p; 1]``."""
        if (a, b) not in self._seen:
            A = self.tree.index[a]
            there = self.maps(b)[0].copy()
            there[:, :, 3] -= self.poses.p[:, A]
            self._seen[a, b] = np.einsum("nji,njx->nix", self.poses.R[:, A], there)
        return self._seen[a, b]


def _poses(tree: Tree, count: int, seed: int) -> Array:
    """Random poses and the corners of the ranges, where springs are longest and shortest; one coordinate evenly."""
    lower, upper = bounds(tree)
    if tree.n == 1:
        return np.linspace(lower, upper, ALONG)
    q = sample(tree, count, seed)
    if tree.n > CORNERED or tree.mechanism.loops:
        return q
    corners = np.array(list(product(*zip(lower, upper, strict=True))))
    return np.concatenate([q, corners[inside(tree, corners)]])

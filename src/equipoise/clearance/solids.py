"""Distances of capsules to boxes, cylinders, ellipsoids and meshes, by the collision library coal (extra `room`).

A solid lies in a capsule of its own, which tells without the library that something is far away. A mesh is its surface:
what is wholly inside it is as far away as its nearest triangle.
"""

# pyright: reportAttributeAccessIssue=false, reportMissingImports=false
# (coal's names come from a compiled module that ships no type stubs)

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from ..model.arrays import Array
from ..model.errors import InputError
from ..model.mechanism import Shape
from ..model.rotation import from_rpy

POINT = 1e-9  # [m] half the length of a capsule that is a ball
DEEPEST = 1e6  # [m]
FINE = 1e-10  # [m] what the library iterates to


class Solid:
    """A shape, placed in its body.

    Attributes:
        ends: (2, 3) of the capsule that it lies in, in the frame of its body [m].
        radius: of that capsule [m].
    """

    def __init__(self, shape: Shape) -> None:
        self._shape, self._coal = shape, library(shape.name)
        coal = self._coal
        self.R, self.p = from_rpy(shape.rpy), np.array(shape.xyz)
        half = np.array(shape.size) / 2
        match shape.kind:
            case "box":
                self._geometry, middle = coal.Box(*shape.size), np.zeros(3)
            case "cylinder":
                self._geometry, middle = coal.Cylinder(float(half[0]), shape.size[2]), np.zeros(3)
            case "ellipsoid":
                self._geometry, middle = coal.Ellipsoid(*half), np.zeros(3)
            case _:
                self._geometry = coal.MeshLoader().load(shape.file, np.array(shape.scale))
                points = np.array(self._geometry.vertices())
                low, high = points.min(axis=0), points.max(axis=0)
                middle, half = (low + high) / 2, (high - low) / 2
        axis = 2 if shape.kind == "cylinder" else int(np.argmax(half))
        others = np.delete(half, axis)
        wide = {"cylinder": others.max(), "ellipsoid": others.max()}.get(shape.kind, np.linalg.norm(others))
        reach = half[axis] * np.eye(3)[axis]
        self.radius = float(wide)
        self.ends = self.p + np.stack([middle - reach, middle + reach]) @ self.R.T

    def outline(self) -> Array:
        """(K, 3) points on it whose hull it fills, or would if it were convex, in the frame of the body [m]."""
        if self._shape.kind == "mesh":
            own = np.array(self._geometry.vertices())
        elif self._shape.kind == "box":
            own = np.array(list(product((-0.5, 0.5), repeat=3))) * self._shape.size
        else:
            turn, rise = np.meshgrid(np.linspace(0, 2 * np.pi, 25), np.linspace(-np.pi / 2, np.pi / 2, 13))
            wide = np.cos(rise) if self._shape.kind == "ellipsoid" else np.ones_like(rise)
            unit = np.stack([wide * np.cos(turn), wide * np.sin(turn), np.sin(rise)], axis=2).reshape(-1, 3)
            own = unit * self._shape.size / 2
        return self.p + own @ self.R.T

    def distances(self, a: Array, b: Array, radius: float) -> tuple[Array, Array, Array]:
        """To capsules from `a` to `b`, (M, 3) each in the frame of the body [m].

        Returns:
            Distance (M,) [m], less than 0 where they overlap; where along the capsule it is, (M,) from 0 to 1; and the
            unit normal (M, 3) towards the capsule, in the frame of the body.
        """
        coal = self._coal
        capsule, here, there = coal.Capsule(radius, 0.0), coal.Transform3s(), coal.Transform3s()
        measure, request = coal.ComputeDistance(capsule, self._geometry), coal.DistanceRequest()
        request.gjk_tolerance = request.epa_tolerance = FINE
        a, b = ((x - self.p) @ self.R for x in (a, b))
        length = np.maximum(np.linalg.norm(b - a, axis=1), POINT)
        middle, half, R = (a + b) / 2, (length / 2).tolist(), _along((b - a) / length[:, None])
        found, point, n = np.empty(len(a)), np.empty((len(a), 3)), np.empty((len(a), 3))
        for i in range(len(a)):
            capsule.halfLength = half[i]
            here.setRotation(R[i])
            here.setTranslation(middle[i])
            result = coal.DistanceResult()
            found[i] = measure(here, there, request, result)
            if found[i] < -DEEPEST:  # overlapping, and the library has not found how deep
                found[i], n[i], point[i] = -radius, 0.0, middle[i]
            else:
                n[i], point[i] = result.normal, result.getNearestPoint1()
        on_axis = point - radius * n - a  # the library's normals point away from the capsule
        s = np.clip(np.einsum("ni,ni->n", on_axis, b - a) / length**2, 0, 1)
        return found, s, -n @ self.R.T


def _along(z: Array) -> Array:
    """(M, 3, 3) rotations that take the z axis to the directions z (M, 3); where one has no length, none."""
    z = np.where(np.linalg.norm(z, axis=1, keepdims=True) > 0.5, z, (0.0, 0.0, 1.0))
    x: Array = np.eye(3)[np.abs(z).argmin(axis=1)]
    x = x - np.einsum("ni,ni->n", x, z)[:, None] * z
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    y: Array = np.asarray(np.cross(z, x), float)
    return np.stack([x, y, z], axis=2)


def library(name: str) -> Any:
    """The collision library.

    Raises:
        InputError: it is missing, and `name` needs it.
    """
    try:
        import coal
    except ImportError:
        raise InputError(
            f"the distance to shape '{name}' needs a collision library: pip install 'equipoise[room]'"
        ) from None
    return coal


def solids(shapes: tuple[Shape, ...]) -> tuple[dict[str, Solid], list[str]]:
    """The solid of each shape by its name, and the shapes whose meshes are missing or cannot be read."""
    found: dict[str, Solid] = {}
    missing = []
    for shape in shapes:
        if shape.kind == "mesh" and not Path(shape.file).is_file():
            missing.append(f"{shape.name} ({shape.file})")
            continue
        try:
            found[shape.name] = Solid(shape)
        except (ValueError, RuntimeError) as error:
            if isinstance(error, InputError):
                raise
            missing.append(f"{shape.name} ({shape.file}: cannot be read)")
    return found, missing

"""The mechanism as a scene: links as capsules, joints, mass centres, coils that stretch and take a force's colour."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from ..model.arrays import Array
from ..model.elements.laws.law import Look
from ..report import style
from ..report.skeleton import Moving, Point, Skeleton
from .meshes import PlacedMesh
from .model import Model
from .shapes import across, capsule, coil, colour, strut, wire

THICK = 0.032  # radius of a link, of the mechanism's size
TURNS = 12
FIXED = (70, 80, 92)
SKY, GROUND, BRIGHT = (255, 255, 255), (150, 160, 172), 2.5  # the light from everywhere
JOINT, MASS, LOAD = (236, 240, 244), (20, 26, 33), (214, 122, 30)


class Scene:
    """Draws a `Model` with a viser scene, and keeps it up to date."""

    def __init__(self, server: Any, model: Model, pictures: Sequence[PlacedMesh] = ()) -> None:
        self.server, self.model, self.pictures = server, model, pictures
        self.springs: list[dict[str, Any]] = []
        points = Skeleton.of(model.mechanism).points(model.tree.poses(model.rest[None]))[0]
        self.size = max(float(np.ptp(points, axis=0).max()), 1e-3)
        self.middle = (points.max(axis=0) + points.min(axis=0)) / 2
        self.thick = THICK * self.size * (0.6 if len(model.file.bodies) > 12 else 1.0)
        self._stage(float((points @ model.view.vertical).min()))
        self.rebuild()

    def rebuild(self) -> None:
        """Draw everything anew: springs or the payload have changed."""
        model, scene = self.model, self.server.scene
        self.skeleton = Skeleton.of(model.file.with_springs(model.springs).with_masses(model.mechanism.masses))
        self.reach = self._reach()
        with self.server.atomic():
            scene.add_frame("/arm", show_axes=False)  # replaces whatever hung on it
            names = model.tree.names
            self.bodies = [scene.add_frame(f"/arm/{i}", show_axes=False) for i in range(len(names))]
            self._links()
            self._coils()
            self.update()

    def update(self) -> None:
        """Move everything to the model's pose."""
        poses = self.model.tree.poses(self.model.q[None])
        shares = self._shares()
        with self.server.atomic():
            for i, frame in enumerate(self.bodies):
                frame.wxyz, frame.position = _quaternion(poses.R[0, i]), poses.p[0, i]
            for handle, a, b in self.rods:
                handle.vertices = capsule(a.at(poses)[0], b.at(poses)[0], 0.5 * self.thick)[0].astype(np.float32)
            for i, (parts, line) in enumerate(zip(self.springs, self.skeleton.springs, strict=True)):
                places, on = np.array([point.at(poses)[0] for point in line]), self.model.on[i]
                parts["coil"].visible = on
                parts["coil"].vertices = self._wire(places, self.skeleton.looks[i])[0].astype(np.float32)
                parts["coil"].color = colour(shares[i]) if on else FIXED
                parts["ends"][0].position, parts["ends"][1].position = places[0], places[-1]

    def world(self, point: Point | Moving) -> Array:
        """(3,) where a point of a body is now."""
        return point.at(self.model.tree.poses(self.model.q[None]))[0]

    def local(self, body: str, place: Array) -> Array:
        """(3,) a place in the world in the frame of `body`."""
        poses = self.model.tree.poses(self.model.q[None])
        i = self.model.tree.index[body]
        return poses.R[0, i].T @ (np.asarray(place, float) - poses.p[0, i])

    def _stage(self, floor: float) -> None:
        view, scene = self.model.view, self.server.scene
        scene.set_up_direction(view.vertical)
        # no shadows and no environment map: without a graphics card the first picture would take ten times as long
        scene.configure_default_lights(True, cast_shadow=False)
        scene.configure_environment_map(None)
        scene.add_light_hemisphere("/sky", sky_color=SKY, ground_color=GROUND, intensity=BRIGHT)
        cell = 10.0 ** np.floor(np.log10(self.size))
        R = np.stack([*across(view.vertical), view.vertical], axis=1)
        scene.add_grid(
            "/floor", 40 * cell, 40 * cell, cell_size=cell, section_size=5 * cell, cell_color=(226, 231, 236),
            section_color=(208, 215, 222), fade_distance=14 * self.size, infinite_grid=True,
            wxyz=_quaternion(R), position=self.middle
            + (floor - 1.5 * self.thick - float(self.middle @ view.vertical)) * view.vertical,
        )  # fmt: skip
        camera = self.server.initial_camera
        away = view.normal if not view.planar else view.normal + 0.25 * view.vertical + 0.25 * view.right
        aim = self.middle + 0.22 * self.size * view.right  # the panel covers the right of the page
        camera.look_at = aim
        camera.position = aim + 1.45 * self.size * away / np.linalg.norm(away)

    def _links(self) -> None:
        scene, skeleton, thick = self.server.scene, self.skeleton, self.thick
        self._bodies()
        self.rods = []
        for k, (bar, radius) in enumerate(
            [(bar, thick) for bar in skeleton.bars] + [(bar, 0.35 * thick) for bar in skeleton.brackets]
        ):
            look = _rgb(style.BODIES[bar.body % 2]) if bar.body not in skeleton.fixed else FIXED
            if bar.a.body == bar.b.body:
                vertices, faces = capsule(bar.a.p, bar.b.p, radius)
                scene.add_mesh_simple(f"/arm/{bar.body}/bar{k}", vertices, faces, color=look)
            else:  # a sliding joint's rod
                vertices, faces = capsule(bar.a.p, bar.b.p, radius)
                self.rods.append((scene.add_mesh_simple(f"/arm/rod{k}", vertices, faces, color=look), bar.a, bar.b))
        for k, link in enumerate(self.model.tree.links):
            for motion in link.motions if link.joint.type in ("revolute", "prismatic") else ():
                half = 1.25 * thick * motion.axis
                vertices, faces = capsule(-half, half, 0.75 * thick)
                scene.add_mesh_simple(f"/arm/{link.body}/joint{k}", vertices, faces, color=JOINT)
        for k, link in enumerate(self.model.tree.links):
            if link.joint.type in ("spherical", "parallelogram"):
                scene.add_icosphere(f"/arm/{link.body}/ball{k}", 1.25 * thick, JOINT, subdivisions=2)
        for k, point in enumerate(skeleton.base):
            scene.add_icosphere(f"/arm/0/base{k}", 1.5 * thick, FIXED, position=point.p, subdivisions=2)
        for k, body in enumerate(self.model.file.bodies):
            if body.mass > 0:
                scene.add_icosphere(f"/arm/{k + 1}/com", 1.12 * thick, MASS, position=body.com, subdivisions=2)
        for k, point in enumerate(skeleton.masses):
            scene.add_icosphere(f"/arm/{point.body}/load{k}", 2.0 * thick, LOAD, position=point.p, subdivisions=3)

    def _bodies(self) -> None:
        """The file's own capsules, translucent as space is, and meshes."""
        scene, index = self.server.scene, self.model.tree.index
        for k, own in enumerate(self.model.file.capsules):
            vertices, faces = capsule(np.array(own.p_a), np.array(own.p_b), own.radius)
            look = _rgb(style.BODIES[index[own.body] % 2])
            scene.add_mesh_simple(f"/arm/{index[own.body]}/capsule{k}", vertices, faces, color=look, opacity=0.35)
        for k, picture in enumerate(self.pictures):
            if picture.body in index:
                name = f"/arm/{index[picture.body]}/mesh{k}"
                scene.add_mesh_trimesh(name, picture.mesh, wxyz=_quaternion(picture.R), position=picture.position)

    def _coils(self) -> None:
        scene, poses = self.server.scene, self.model.tree.poses(self.model.q[None])
        self.springs = []
        for i, line in enumerate(self.skeleton.springs):
            vertices, faces = self._wire(np.array([point.at(poses)[0] for point in line]), self.skeleton.looks[i])
            mark = _rgb(style.spring_colour(i))
            handle = scene.add_mesh_simple(f"/arm/spring{i}", vertices, faces, color=mark, side="double")
            ends = [scene.add_icosphere(f"/arm/end{i}{j}", 0.6 * self.thick, mark, subdivisions=2) for j in "ab"]
            self.springs.append({"coil": handle, "ends": ends})

    def _wire(self, line: Array, look: Look) -> tuple[Array, Any]:
        """A coil or a cylinder with its rod between two points, else a wire along them (points, 3)."""
        if len(line) > 2 or look == "line":
            return wire(line, 0.25 * self.thick)
        if look == "strut":
            return strut(line[0], line[1], 0.7 * self.thick)
        return coil(line[0], line[1], 0.85 * self.thick, 0.19 * self.thick, TURNS)

    def _shares(self) -> list[float]:
        """Force of each spring, a share of the largest that any of its unit has over the random poses; 0 if off."""
        on = iter(zip(self.model.mechanism.springs, self.model.state.path[0], strict=True))
        found = []
        for present in self.model.on:
            if present:
                spring, path = next(on)
                found.append(abs(float(spring.law.pull(path))) / self.reach[spring.force_unit])
            else:
                found.append(0.0)
        return found

    def _reach(self) -> dict[str, float]:
        """The largest force of any spring over the random poses, of each unit [N or N m]."""
        reach: dict[str, float] = {}
        for spring, path in zip(self.model.mechanism.springs, self.model.paths().T, strict=True):
            most = float(np.abs(spring.law.pull(path)).max())
            reach[spring.force_unit] = max(most, reach.get(spring.force_unit, 1e-9))
        return reach


def _rgb(text: str) -> tuple[int, int, int]:
    return int(text[1:3], 16), int(text[3:5], 16), int(text[5:7], 16)


def _quaternion(R: Array) -> Array:
    """(4,) w, x, y, z of the rotation matrix `R` (3, 3)."""
    return Rotation.from_matrix(R).as_quat(scalar_first=True)

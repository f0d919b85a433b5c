"""The room that the bodies of an MJCF model take: its geometry that has a name, or that may touch something.

What is only drawn has neither. A capsule or a sphere becomes a `Capsule`, a box, cylinder, ellipsoid or mesh a `Shape`.
Planes and height fields are ground that nothing stands on: they are left out.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..model.arrays import Array, vec3
from ..model.mechanism import Capsule, Mechanism, Shape
from ..model.names import Names
from ..model.rotation import from_quaternion, to_rpy
from ..model.validate import LARGEST_COUNTS
from .mesh_files import mesh_file
from .mjcf_between import Places
from .notes import Notes

SOLID = {"mjGEOM_BOX": "box", "mjGEOM_CYLINDER": "cylinder", "mjGEOM_ELLIPSOID": "ellipsoid"}
GROUND = ("mjGEOM_PLANE", "mjGEOM_HFIELD")
MOST = min(LARGEST_COUNTS["capsules"], LARGEST_COUNTS["shapes"])


def with_shapes(mechanism: Mechanism, mj: Any, model: Any, place: Places, notes: Notes) -> Mechanism:
    """The mechanism with the geometry of its bodies; `place` says where the engine's bodies are."""
    names, capsules, shapes = Names(), list[Capsule](), list[Shape]()
    for g in range(model.ngeom):
        name, kind = model.geom(g).name, mj.mjtGeom(int(model.geom_type[g])).name
        body, origin = place[int(model.geom_bodyid[g])]
        if kind in GROUND or not (name or model.geom_contype[g] or model.geom_conaffinity[g]):
            continue
        size, xyz, R = model.geom_size[g], origin + model.geom_pos[g], from_quaternion(model.geom_quat[g])
        name = names.new(name or body)
        if len(capsules) + len(shapes) == MOST:
            notes.note(f"geom '{name}'", f"it is left out of its body's room: {MOST} shapes are worked with")
        elif kind in ("mjGEOM_CAPSULE", "mjGEOM_SPHERE"):
            reach = (size[1] if kind == "mjGEOM_CAPSULE" else 0.0) * R[:, 2]
            capsules.append(Capsule(name, body, vec3(xyz + reach), vec3(xyz - reach), float(size[0])))
        elif kind in SOLID:
            whole = (size[0], size[0], size[1]) if SOLID[kind] == "cylinder" else size
            shapes.append(Shape(name, body, SOLID[kind], vec3(2 * np.array(whole)), vec3(xyz), to_rpy(R)))  # type: ignore[arg-type]
        elif kind == "mjGEOM_MESH" and (file := _file(model, int(model.geom_dataid[g]), Path(notes.file).parent)):
            xyz, R, scale = _as_in_its_file(model, int(model.geom_dataid[g]), xyz, R)
            shapes.append(Shape(name, body, "mesh", xyz=vec3(xyz), rpy=to_rpy(R), file=file, scale=vec3(scale)))
        else:
            notes.note(f"geom '{name}'", "it is left out of its body's room: no shape that is worked with")
    return replace(mechanism, capsules=tuple(capsules), shapes=tuple(shapes))


def _file(model: Any, mesh: int, folder: Path) -> str:
    """The file of a mesh; empty where its points stand in the model."""
    at = int(model.mesh_pathadr[mesh])
    if at < 0:
        return ""
    name = model.paths[at : model.paths.index(b"\0", at)].decode()
    return str(mesh_file(folder, name) or name)


def _as_in_its_file(model: Any, mesh: int, xyz: Array, R: Array) -> tuple[Array, Array, Array]:
    """Place, orientation and scale of a mesh's own numbers: the engine moves them to its middle and its main axes."""
    turned = R @ from_quaternion(model.mesh_quat[mesh]).T
    return xyz - turned @ model.mesh_pos[mesh], turned, model.mesh_scale[mesh]

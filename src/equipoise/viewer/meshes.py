"""The pictures of a URDF's links: meshes that are there and can be read; what is not there is drawn as ever."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from ..io import files
from ..io.mesh_files import mesh_file
from ..io.xmltree import Document, XmlElement
from ..model.arrays import Array, frozen
from ..model.rotation import from_rpy


@frozen
class PlacedMesh:
    """A mesh of `body`, with its place and orientation in the body's frame [m]."""

    body: str
    mesh: Any
    position: Array
    R: Array


def pictures(path: str | os.PathLike[str]) -> list[PlacedMesh]:
    """The visual meshes of a URDF; none for other files, and none for what is missing or cannot be read.

    Names are looked up as `mesh_file` does.
    """
    if Path(path).suffix.lower() != ".urdf":
        return []
    document = Document(files.read_text(path), os.fspath(path))
    found = []
    for link in document.root.find_all("link"):
        for visual in link.find_all("visual"):
            geometry = visual.find("geometry")
            shape = geometry.find("mesh") if geometry is not None else None
            mesh = None if shape is None else _mesh(Path(path), shape)
            if mesh is not None:
                origin = visual.find("origin")
                xyz, rpy = (_three(origin, key) for key in ("xyz", "rpy"))
                found.append(PlacedMesh(link.attributes.get("name", ""), mesh, xyz, from_rpy(rpy)))
    return found


def _mesh(urdf: Path, shape: XmlElement) -> Any:
    name = shape.attributes.get("filename", "")
    file = mesh_file(urdf.parent, name)
    if file is None:
        return None
    import trimesh

    try:
        mesh = trimesh.load(file, force="mesh")
    except Exception:  # of another format, or broken: there is no common base class
        return None
    mesh.apply_scale(_three(shape, "scale", 1.0))
    return mesh


def _three(element: XmlElement | None, key: str, default: float = 0.0) -> Array:
    try:
        values = [float(word) for word in (element.attributes.get(key, "") if element is not None else "").split()]
    except ValueError:
        values = []
    return np.array(values) if len(values) == 3 else np.full(3, default)

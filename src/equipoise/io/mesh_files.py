"""Where the mesh is that a model file names."""

from __future__ import annotations

from pathlib import Path

PACKAGE = "package://"


def mesh_file(folder: Path, name: str) -> Path | None:
    """The whole path of a mesh, or None where there is no such file.

    A name ``package://NAME/REST`` is looked for as NAME/REST and as REST in `folder` and in the folders above it.
    """
    folder = folder.resolve()
    if name.startswith(PACKAGE):
        whole = name.removeprefix(PACKAGE)
        places = [above / part for above in (folder, *folder.parents) for part in (whole, whole.partition("/")[2])]
    else:
        places = [folder / name.removeprefix("file://")]
    try:
        return next((place for place in places if place.is_file()), None)
    except (OSError, ValueError):  # no name that a file could have
        return None

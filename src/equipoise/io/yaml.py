"""The mechanism file: YAML of schema 1 to a `Mechanism` and back, without loss."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path as FilePath
from typing import TypeVar

from ..model.elements import Element, Vec3
from ..model.errors import Fault, InputError, Path, nearest
from ..model.mechanism import Body, Capsule, Coupling, Joint, Loop, Mechanism, PointMass, Shape, Workspace
from ..model.units import quantity
from . import dh, models
from .emit import to_text
from .fields import DIMENSION_OF
from .files import read_text
from .mesh_files import mesh_file
from .schema import SCHEMA, MechanismFile, validate
from .yaml_positions import Located, parse

__all__ = ["built", "read", "to_text"]
_SINGULAR = {"bodies": "body", "joints": "joint", "couplings": "coupling"}


def read(path: str | os.PathLike[str], base: str | None = None) -> Mechanism:
    """Read a mechanism file; `base` is for its model, see `load`.

    Raises:
        InputError: with a fault for everything that is wrong, each with its file, line and column.
    """
    name = os.fspath(path)
    return built(parse(read_text(name), name), base)


def built(located: Located, base: str | None = None) -> Mechanism:
    """The mechanism of a file's data.

    Raises:
        InputError: as `read`.
    """
    file, found = validate(located.data)
    if file is None or located.faults:
        if isinstance(located.data, dict) and located.data.get("schema", SCHEMA) != SCHEMA:
            found = [(fault, on_key) for fault, on_key in found if fault.path == ("schema",)]  # the rest means nothing
        raise located.error(located.locate(fault, on_key) for fault, on_key in found)
    return _mechanism(file, located, base)


@dataclass(frozen=True)
class _Origin:
    """Where in the file an item of the mechanism comes from, and who made it if it is not written there."""

    path: Path
    maker: str = ""

    def __str__(self) -> str:
        return self.maker or Fault(self.path, "").field


@dataclass
class _Tree:
    """Bodies, joints and couplings in the order of the mechanism, each with its origin."""

    bodies: list[tuple[Body, _Origin]] = field(default_factory=list)
    joints: list[tuple[Joint, _Origin]] = field(default_factory=list)
    couplings: list[tuple[Coupling, _Origin]] = field(default_factory=list)
    gravity: Vec3 | None = None  # of the model, where the file has none
    capsules: tuple[Capsule, ...] = ()  # of the model, like its shapes
    shapes: tuple[Shape, ...] = ()


def _mechanism(file: MechanismFile, located: Located, base: str | None) -> Mechanism:
    tree, faults = _tree(file, located, base)
    assembly, more = _assembly(file, tree)
    springs, wrong = _springs(file, located)
    faults += more + wrong
    try:
        mechanism = Mechanism(
            name=file.name,
            bodies=tuple(body for body, _ in tree.bodies),
            joints=tuple(joint for joint, _ in tree.joints),
            couplings=tuple(coupling for coupling, _ in tree.couplings),
            loops=tuple(Loop(**item.values()) for item in file.loops),
            springs=springs,
            masses=tuple(PointMass(**item.values()) for item in file.masses),
            capsules=_own([Capsule(**item.values()) for item in file.capsules], tree.capsules),
            attachments=tuple(item.attachment() for item in file.attachments),
            shapes=_own(list(_shapes(file, FilePath(located.file).parent)), tree.shapes),
            gravity=tree.gravity or file.gravity,
            workspace=Workspace(**file.workspace.values()),
            provenance=file.provenance,
            independent=tuple(file.independent),
            assembly=tuple(assembly.items()),
        )
    except InputError as error:
        raise located.error([*faults, *_translate(error.faults, tree)]) from None
    if faults:
        raise located.error(faults)
    try:
        goal = file.goal.goal(FilePath(located.file).parent, mechanism.coordinates)
        return replace(mechanism, goal=goal)
    except InputError as error:
        inside = (fault if fault.file or fault.path[:1] == ("goal",) else replace(fault, path=("goal", *fault.path))
                  for fault in error.faults)  # fmt: skip
        raise located.error(inside) from None


T = TypeVar("T", Capsule, Shape)


def _own(written: list[T], model: Sequence[T]) -> tuple[T, ...]:
    """What is written in the file, then what its model has under other names."""
    names = {one.name for one in written}
    return (*written, *(one for one in model if one.name not in names))


def _shapes(file: MechanismFile, folder: FilePath) -> Iterator[Shape]:
    """The file's shapes; meshes by their whole paths."""
    for item in file.shapes:
        shape = Shape(**item.values())
        yield replace(shape, file=str(mesh_file(folder, shape.file) or shape.file)) if shape.file else shape


def _springs(file: MechanismFile, located: Located) -> tuple[tuple[Element, ...], list[Fault]]:
    """The springs, and what is wrong with the files of tables."""
    found, faults = [], []
    for i, item in enumerate(file.springs):
        try:
            found.append(item.element(FilePath(located.file).parent))
        except InputError as error:
            own = (fault if fault.file else replace(fault, path=("springs", i, *fault.path)) for fault in error.faults)
            faults += [Fault(("springs", i, "file"), f"'{item.file}' cannot be used as a table"), *own]
    return tuple(found), faults


def _tree(file: MechanismFile, located: Located, base: str | None) -> tuple[_Tree, list[Fault]]:
    """The tree of the model, the dh table and the file itself, and the faults that do not hide others."""
    tree = _Tree()
    for key, other in (("joints", file.joints), ("model", file.model)):
        if file.dh is not None and other:
            raise located.error([Fault(("dh",), f"give either '{key}' or 'dh', not both")])
    if file.model is not None:
        model = _model(file.model, located, base)
        tree.capsules, tree.shapes = model.capsules, model.shapes
        tree.gravity = None if "gravity" in file.model_fields_set else model.gravity
        origin = _Origin(("model",), "the model")
        tree.bodies += [(body, origin) for body in model.bodies]
        tree.joints += [(joint, origin) for joint in model.joints]
        tree.couplings += [(coupling, origin) for coupling in model.couplings]
    bodies = [Body(**item.values()) for item in file.bodies]
    if file.dh is None:
        tree.bodies += [(body, _Origin(("bodies", i))) for i, body in enumerate(bodies)]
        tree.joints += [(Joint(**item.values()), _Origin(("joints", i))) for i, item in enumerate(file.joints)]
    else:
        if len(file.dh.rows) != len(bodies):
            message = f"expected {len(bodies)} rows, one for each entry of 'bodies', found {len(file.dh.rows)}"
            raise located.error([Fault(("dh", "rows"), message)])
        with_axes, joints = dh.expand(file.dh, bodies)
        tree.bodies += [(b, _Origin(("bodies", i), "" if b is bodies[i] else "the dh table")) for b, i in with_axes]
        tree.joints += [(j, _Origin(("dh", "rows", i), "the dh table" if j.type == "fixed" else "")) for j, i in joints]
    types = {joint.name: joint.type for joint, _ in tree.joints}
    faults: list[Fault] = []
    for i, item in enumerate(file.couplings):
        offset = 0.0
        if item.joint in types and types[item.joint] in DIMENSION_OF:  # if not, that is the fault
            try:
                offset = quantity(item.offset, DIMENSION_OF[types[item.joint]], "couplings", i, "offset")
            except InputError as error:
                faults += error.faults
        tree.couplings.append((Coupling(item.joint, tuple(item.terms.items()), offset), _Origin(("couplings", i))))
    return tree, faults


def _assembly(file: MechanismFile, tree: _Tree) -> tuple[dict[str, float], list[Fault]]:
    """Coordinate values near the assembly pose in SI units, and the faults."""
    types = {joint.name: joint.type for joint, _ in tree.joints}
    values: dict[str, float] = {}
    faults: list[Fault] = []
    for name, value in file.assembly.items():
        try:
            values[name] = quantity(value, DIMENSION_OF.get(types.get(name, ""), "angle"), "assembly", name)
        except InputError as error:
            values[name] = 0.0
            if name in types or "." in name:  # if not, that is the fault
                faults += error.faults
    return values, faults


def _model(name: str, located: Located, base: str | None) -> Mechanism:
    """The mechanism of a model file; its name is relative to the folder of the mechanism file."""
    path = FilePath(located.file).parent / name
    suffix = path.suffix.lower()
    if suffix not in models.MODEL_SUFFIXES:
        message = f"'{name}' cannot be read: a model is a URDF or an MJCF file"
        raise located.error([Fault(("model",), message, models.MODEL_SUFFIXES)])
    if not path.is_file():
        beside = sorted(p.name for p in path.parent.glob("*") if p.suffix.lower() in models.MODEL_SUFFIXES)
        raise located.error([Fault(("model",), f"there is no file {nearest(name, beside)}", tuple(beside[:12]))])
    try:
        model = models.read(path, base)
    except InputError as error:
        raise located.error([Fault(("model",), f"'{name}' cannot be used as a model"), *error.faults]) from error
    for key in ("loops", "springs", "masses"):
        if getattr(model, key):
            problem = f"'{name}' has {key} of its own, and a model gives bodies, joints and couplings"
            how = f"load it by itself, or make it a mechanism file: equipoise export {name} --to yaml"
            raise located.error([Fault(("model",), f"{problem}: {how}")])
    return model


def _translate(faults: Sequence[Fault], tree: _Tree) -> list[Fault]:
    """Faults of the mechanism as faults of the file: its items are numbered differently with a model or a dh table."""

    def origin_of(numbered: re.Match[str]) -> str:
        return str(getattr(tree, numbered[1])[int(numbered[2])][1])

    written, made = [], []
    for fault in faults:
        kind, index, *rest = (*fault.path, None, None)[: max(2, len(fault.path))]
        message = re.sub(r"\b(bodies|joints|couplings)\[(\d+)\]", origin_of, fault.message)
        if kind not in _SINGULAR or not isinstance(index, int):
            written.append(replace(fault, message=message))
            continue
        item, origin = getattr(tree, kind)[index]
        if origin.maker:
            name = item.joint if kind == "couplings" else item.name
            message = f"{_SINGULAR[kind]} '{name}' of {origin.maker}: {message}"
        # a row of a dh table has no parent and no child: only a faulty body can make them faulty
        from_others = bool(origin.maker) or (origin.path[0] == "dh" and rest[:1] not in (["name"], ["range"]))
        path = origin.path if from_others else (*origin.path, *rest)
        (made if from_others else written).append(replace(fault, path=path, message=message))
    return written or made  # what is made from a faulty entry is faulty too: only the entry is worth showing

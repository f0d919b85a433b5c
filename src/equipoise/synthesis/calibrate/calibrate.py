"""The best settings for hardware that is there: at given poses or over the whole workspace, globally, with a proof."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...balance import Balance, check
from ...io import Source, loaded
from ...kinematics import Tree
from ...model.arrays import Array, Integers, frozen
from ...model.coordinate import Coordinate
from ...model.errors import Fault, InputError
from ...model.errors import nearest as nearest_name
from ...model.mechanism import Mechanism
from ...model.progress import Progress, silent
from ...model.units import Amount, quantity
from ..convex.peak import peak_poses
from ..dials import Dial, Limits, columns, dials, set_to
from .minimax import Held, Least, least, nearest

EXACT = 1e-9  # of the torque before: less is balance


@frozen
class Proof:
    """Why no settings leave less than `least` [N m, slides N]: the weighted sum of these torques is never less.

    Attributes:
        unit: of the torques.
        terms: (coordinate, pose, weight): the weights' absolute values add up to 1.
    """

    unit: str
    least: float
    terms: tuple[tuple[Coordinate, int, float], ...]


@frozen
class Change:
    """A number that was set: SI units; `limits` are those it could be set within."""

    item: str
    field: str
    before: float
    after: float
    limits: Limits


@frozen
class Calibration:
    """The best settings.

    Attributes:
        mechanism: with them; an element whose best rate is nothing is left out.
        poses: (N, n) where it was judged; given: whether they were named, or stand for the whole workspace.
        before, after: (N, n) torque [N m, slides N] with the file's settings and with the best.
        changes: every number that could be set.
        unused: elements and masses that do no good, and are left out.
        held: those that stay as they are.
        proofs: of the least largest torque over the joints that turn, and over slides apart; none where it is zero.
    """

    mechanism: Mechanism
    coordinates: tuple[Coordinate, ...]
    poses: Array
    given: bool
    before: Array
    after: Array
    changes: tuple[Change, ...]
    unused: tuple[str, ...]
    held: tuple[str, ...]
    proofs: tuple[Proof, ...]

    def largest(self, unit: str) -> float:
        """The largest absolute torque ("N m") or force of a slide ("N") that is left."""
        own = [c.load_unit == unit for c in self.coordinates]
        return float(np.abs(self.after[:, own]).max(initial=0.0))

    @property
    def exact(self) -> bool:
        """Whether nothing is left at the poses, to rounding."""
        most = np.abs(self.before).max(axis=0, initial=0.0).max(initial=0.0)
        return float(np.abs(self.after).max(initial=0.0)) <= EXACT * max(float(most), 1.0)

    def balance(self) -> Balance:
        """The verdict over the whole workspace."""
        return check(self.mechanism)

    def to_dict(self) -> dict[str, Any]:
        """The JSON object of ``equipoise calibrate --json``."""
        units = dict.fromkeys(c.load_unit for c in self.coordinates)
        return {
            "mechanism": self.mechanism.name,
            "coordinates": list(self.coordinates),
            "exact": self.exact,
            "residual": {unit: self.largest(unit) for unit in units},
            "bound": {unit: next((p.least for p in self.proofs if p.unit == unit), 0.0) for unit in units},
            "poses": self.poses.tolist() if self.given else len(self.poses),
            **({"before": self.before.tolist(), "after": self.after.tolist()} if self.given else {}),
            "changes": [
                {"item": c.item, "field": c.field, "before": c.before, "after": c.after, "limits": list(c.limits)}
                for c in self.changes
            ],
            "unused": list(self.unused),
            "held": list(self.held),
            "proofs": [
                {
                    "unit": proof.unit,
                    "least": proof.least,
                    "terms": [{"coordinate": c, "pose": pose, "weight": w} for c, pose, w in proof.terms],
                }
                for proof in self.proofs
            ],
        }


def calibrate(
    mechanism: Source,
    poses: Iterable[Mapping[str, Amount]] | None = None,
    *,
    bounds: Mapping[str, Mapping[str, Limits]] | None = None,
    hold: Sequence[str] = (),
    seed: int = 0,
    progress: Progress | None = None,
) -> Calibration:
    """Find the rates, free lengths or preloads, and masses that leave the least largest torque.

    Args:
        mechanism: or the path of its file.
        poses: for each the value of every coordinate [rad or m, or text with a unit]; None is the whole workspace.
        bounds: item -> field -> (low, high) in SI units. Masses that have none stay.
        hold: springs that stay as they are.

    Raises:
        InputError: a pose without one of the coordinates, or outside a joint's range; an unknown item or field;
            nothing to set.
    """
    mechanism, report = loaded(mechanism), progress or silent
    tree = Tree.of(mechanism)
    q = peak_poses(tree, mechanism.workspace.samples, seed) if poses is None else _given(tree, poses)
    found = dials(mechanism, q, bounds or {}, hold)
    report("computing torques", 0.1)
    torque, load = columns(mechanism, found, q)
    report("solving the linear program", 0.3)
    groups: list[Held] = []  # torques first, then forces of slides
    best, proofs = None, []
    for turns in (True, False):
        own = np.flatnonzero(tree.turns == turns)
        if len(own):
            A, b = torque[:, own].reshape(-1, torque.shape[-1]), load[:, own].ravel()
            alone = least(A, b, found)
            best = least(A, b, found, groups[0]) if groups else alone
            groups.append(Held(A, b, best.value))
            proofs += _proof(tree, own, alone, groups[-1].unit)
    report("looking for the nearest", 0.6)
    x = nearest(groups, found, best.x) if best else np.zeros(0)
    now = np.concatenate([dial.now for dial in found])
    made, changes, unused = _set(mechanism, found, x)
    x = np.concatenate([dial.unknowns(*values) for dial, values in _values(found, x)])
    names = {dial.item for dial in found}
    return Calibration(
        mechanism=replace(made, provenance={}),
        coordinates=tree.coordinates,
        poses=q,
        given=poses is not None,
        before=load + torque @ now,
        after=load + torque @ x,
        changes=changes,
        unused=unused,
        held=tuple(item.name for item in (*mechanism.springs, *mechanism.masses) if item.name not in names),
        proofs=tuple(proofs),
    )


def _given(tree: Tree, poses: Iterable[Mapping[str, Amount]]) -> Array:
    """(N, n) of named poses."""
    rows, valid = [], tuple(tree.coordinates)
    for pose in poses:
        for name in pose:
            if name not in valid:
                raise InputError(Fault(("pose",), f"no independent joint {nearest_name(name, valid)}", valid))
        missing = [name for name in valid if name not in pose]
        if missing:
            raise InputError(Fault(("pose",), f"has no value for {', '.join(missing)}", valid))
        row = [quantity(pose[name], "angle" if name.turns else "length", "pose", name) for name in tree.coordinates]
        for name, value, index in zip(tree.coordinates, row, tree.coordinate_rows, strict=True):
            low, high = tree.lower[index], tree.upper[index]
            if not low - 1e-9 <= value <= high + 1e-9:
                limits = " to ".join(name.show(float(limit)).removeprefix(f"{name} ") for limit in (low, high))
                raise InputError(Fault(("pose", name), f"is outside its range, {limits}: found {name.show(value)}"))
        rows.append(row)
    if not rows:
        raise InputError(Fault(("pose",), "there is none: give poses, or the whole workspace"))
    return np.array(rows, float)


def _values(found: Sequence[Dial], x: Array) -> list[tuple[Dial, tuple[float, ...]]]:
    start, each = 0, []
    for dial in found:
        width = len(dial.settings)
        each.append((dial, dial.values(x[start : start + width])))
        start += width
    return each


def _set(
    mechanism: Mechanism, found: Sequence[Dial], x: Array
) -> tuple[Mechanism, tuple[Change, ...], tuple[str, ...]]:
    """The mechanism with the settings, what they are, and what is left out because it does nothing."""
    springs = {element.name: element for element in mechanism.springs}
    masses = {mass.name: mass for mass in mechanism.masses}
    changes, unused = [], []
    for dial, values in _values(found, x):
        changes += [
            Change(dial.item, own.field, own.now, value, own.limits)
            for own, value in zip(dial.settings, values, strict=True)
        ]
        if abs(values[0]) <= 1e-9 * dial.size[0] and not any(values[1:] if not dial.product else ()):
            unused.append(dial.item)
            springs.pop(dial.item, None)
            masses.pop(dial.item, None)
        elif dial.item in springs:
            springs[dial.item] = set_to(springs[dial.item], dial, values)
        else:
            masses[dial.item] = replace(masses[dial.item], mass=values[0])
    return mechanism.with_springs(springs.values()).with_masses(masses.values()), tuple(changes), tuple(unused)


def _proof(tree: Tree, own: Integers, best: Least, unit: float) -> list[Proof]:
    """For the coordinates `own`, if something must be left."""
    if best.bound <= EXACT * unit:
        return []
    terms = tuple(
        (tree.coordinates[own[row % len(own)]], int(row // len(own)), float(w))
        for row, w in zip(best.rows.tolist(), best.weights, strict=True)
    )
    return [Proof(terms[0][0].load_unit, best.bound, terms)]

"""`certify`: what is claimed of a mechanism, and what proves it; `verify` asks the program that stands alone."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import inf
from typing import Any

import numpy as np

from .._version import __version__
from ..energy.fourier.frames import denominators
from ..energy.span.nodes import reach
from ..io import Source, loaded
from ..io.files import read_text, write_text
from ..kinematics import Tree
from ..kinematics.sampling import whole_turns
from ..model.arrays import vec3
from ..model.errors import EquipoiseError, Fault, InputError, NoFourierForm
from ..model.mechanism import Mechanism
from ..model.notebook import Shown
from ..model.units import Amount, quantity
from ..synthesis.convex.spring_block import SpringBlock
from ..synthesis.fewest import Fewest, fewest
from ..synthesis.load import OWN
from ..synthesis.problem import Problem
from ..synthesis.region import Region
from . import verify as alone
from .closed import forces, pairs_of_points, tree_of
from .dual import lower_bound
from .enclosure import Enclosure
from .statement import rounded, text, written

FORMAT = "equipoise certificate 1"
STIFFNESS = 1e6  # [N/m] all springs of a bound together
FLOOR = Fraction(1, 10**40)  # a torque that is exactly 0 is claimed to be at most so much


class Refused(EquipoiseError):
    """A certificate that does not prove what it claims."""

    exit_code = 1


@dataclass(frozen=True)
class Certified(Shown):
    """A certificate.

    Attributes:
        document: what is written; see docs/certificates.md.
        left_out: claim -> why it is not made.
    """

    document: Mapping[str, Any]
    left_out: Mapping[str, str]

    @property
    def claims(self) -> Mapping[str, Any]:
        """Name -> what is claimed."""
        return self.document["claims"]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it.

        Raises:
            InputError: it cannot be written.
        """
        write_text(path, json.dumps(self.document, indent=1, ensure_ascii=False) + "\n")

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {"mechanism": self.document["of"], "claims": dict(self.claims), "left_out": dict(self.left_out)}


def certify(mechanism: Source, *, stiffness: Amount = STIFFNESS, problem: Problem | None = None) -> Certified:
    """Prove what can be proved of a mechanism with its springs, so that another program can check it.

    Args:
        stiffness: [N/m] of all springs together, up to which the bound holds.
        problem: what the bound is about, with this mechanism; by default what its provenance says that it was designed
            for.

    Raises:
        NoFourierForm: its energy has no finite form.
        InputError: python-flint is not installed, or a stiffness that is not positive.
    """
    mechanism, limit = loaded(mechanism), quantity(stiffness, "stiffness", "stiffness")
    if not 0 < limit < inf:
        raise InputError(Fault(("stiffness",), f"must be more than 0 N/m and finite, found {limit:g}"))
    if mechanism.loops:
        return _of_loops(mechanism)
    data = written(mechanism)
    enclosure = Enclosure(data)
    claims: dict[str, Any] = {"torque": _torque(mechanism, enclosure)}
    proof: dict[str, Any] = {}
    left_out: dict[str, str] = {}
    try:
        claims["bound"], proof["bound"] = _bound(problem or _designed_for(mechanism), enclosure, limit)
    except EquipoiseError as why:
        left_out["bound"] = str(why)
    found = fewest(mechanism)
    if found is None:
        left_out["fewest"] = "no planar section that gravity loads was found"
    else:
        claims["fewest"] = _fewest(mechanism, found)
    return Certified(_document(mechanism, data, claims, proof), left_out)


def _document(
    mechanism: Mechanism, data: dict[str, Any], claims: dict[str, Any], proof: dict[str, Any]
) -> dict[str, Any]:
    head = {"format": FORMAT, "of": mechanism.name, "program": f"equipoise {__version__}"}
    return {**head, "claims": claims, "mechanism": data, "proof": proof}


def _of_loops(mechanism: Mechanism) -> Certified:
    """That the energy hardly varies: the torque at the actuators follows where the loops are not singular."""
    tree = tree_of(mechanism)
    data, loops = written(tree), pairs_of_points(mechanism)
    enclosure = Enclosure(data)
    within = _within(tree, enclosure)
    most, proof = forces(enclosure, loops, within)
    claim = {"energy": rounded(most + FLOOR, up=True), "within": _texts(within), "loops": loops}
    why = "loops: what holds at closed poses is about the energy"
    left_out: dict[str, str] = dict.fromkeys(("torque", "bound", "fewest"), why)
    return Certified(_document(mechanism, data, {"closed": claim}, {"closed": proof}), left_out)


def verify(certificate: Certified | Mapping[str, Any] | str | os.PathLike[str]) -> tuple[str, ...]:
    """The names of the claims of a certificate, or of a file with one: all of them are proved.

    Raises:
        Refused: one is not, or it is no certificate; the message says why.
        InputError: the file cannot be read.
    """
    if isinstance(certificate, Certified):
        certificate = certificate.document
    try:
        if not isinstance(certificate, Mapping):
            certificate = json.loads(read_text(certificate))
        return alone.check(certificate)
    except EquipoiseError:
        raise
    except Exception as why:
        raise Refused(str(why) if type(why) is ValueError else f"it cannot be read: {why!r}") from None


def _torque(mechanism: Mechanism, enclosure: Enclosure) -> dict[str, Any]:
    within = _within(mechanism, enclosure)
    most = [rounded(x + FLOOR, up=True) for x in enclosure.torque(within)]
    return {
        "at_most": dict(zip(enclosure.names, most, strict=True)),
        "within": _texts(within),
    }


def _within(mechanism: Mechanism, enclosure: Enclosure) -> dict[str, Fraction]:
    """How far the coordinates go of which the energy has powers."""
    sizes = dict(zip(enclosure.names, reach(Tree.of(mechanism)).tolist(), strict=True))
    return {name: Fraction(sizes[name]) for name in enclosure.powers}


def _texts(numbers: Mapping[str, Fraction]) -> dict[str, str]:
    return {name: text(x) for name, x in numbers.items()}


def _bound(problem: Problem, enclosure: Enclosure, stiffness: float) -> tuple[dict[str, Any], dict[str, Any]]:
    tree = Tree.of(problem.judged)
    if not whole_turns(tree, denominators(tree)):
        raise NoFourierForm("its joints do not turn through whole turns: the mean over their ranges is not enclosed")
    if problem.keep or problem.loads != (OWN,):
        raise NoFourierForm("springs that stay, and loads beside the mechanism's own, are not covered")
    scale = problem.scale
    blocks = [block for block in problem.blocks if isinstance(block, SpringBlock)]
    found = lower_bound(enclosure, blocks, scale, stiffness)
    if found is None:
        raise NoFourierForm("springs on these pairs may leave nothing, as far as is known")
    claim = {
        "at_least": rounded(found.least - FLOOR, up=False),
        "pairs": [
            {
                "body_a": block.body_a,
                "region_a": _region(block.region_a),
                "body_b": block.body_b,
                "region_b": _region(block.region_b),
            }
            for block in blocks
        ],
        "counted": {name: text(x) for name, x in zip(enclosure.names, scale.tolist(), strict=True) if x},
        "stiffness": text(stiffness),
    }
    return claim, found.proof


def _region(region: Region) -> dict[str, Any]:
    return {"shape": region.shape, "centre": [*map(text, region.at)], "half": [*map(text, region.half)]}


def _designed_for(mechanism: Mechanism) -> Problem:
    """The problem whose answer the mechanism is, as its provenance says.

    Raises:
        NoFourierForm: it does not say, or the bound of such a problem is not certified.
    """
    options = mechanism.provenance.get("options", {})
    if mechanism.provenance.get("method") != "convex" or "pairs" not in options:
        raise NoFourierForm("the file does not say for which pairs and regions it was designed")
    for name in ("keep", "loads"):
        if options.get(name):
            raise NoFourierForm(f"it was designed with '{name}', whose bound is not certified")
    regions = {
        body: [Region(vec3(one["centre"]), vec3(one["half"]), one["shape"]) for one in _several(own)]
        for body, own in options["regions"].items()
    }
    return Problem.of(
        mechanism.with_springs(()),
        pairs=[tuple(pair) for pair in options["pairs"]],
        regions=regions,
        joints=options.get("joints"),
        weights=options.get("weights"),
        unlimited=options.get("unlimited", False),
    )


def _several(regions: Any) -> Iterable[Mapping[str, Any]]:
    """One region or a union of them."""
    return [regions] if isinstance(regions, Mapping) else regions


def _fewest(mechanism: Mechanism, found: Fewest) -> dict[str, Any]:
    bare = mechanism.with_springs(())
    tree = Tree.of(bare)
    held = {str(name): value for name, value in found.held}
    q = np.array([[held.get(str(name), 0.0) for name in tree.coordinates]])
    axes = tree.axes(q, tree.poses(q))[0]
    joints = [joint for joint in mechanism.joints if joint.name in found.joints]
    turning = [joint for joint in joints if joint.type == "revolute"]
    if turning:
        axis = axes[tree.rows[turning[0].name]]
    else:
        axis = np.array([0.8, 0.6]) @ np.linalg.svd(np.array([mechanism.gravity]))[2][1:]
    return {
        "springs": found.springs,
        "links": [joint.child for joint in joints],
        "held": {name: text(value) for name, value in held.items()},
        "axis": [*map(text, axis.tolist())],
    }

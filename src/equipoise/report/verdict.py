"""The verdict in plain words: what the joints hold with springs and without. What it rests on is a line of its own."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rich.text import Text

from ..balance import Balance
from ..energy.exactness import EXACT
from .numbers import percent, rounded


def verdict(balance: Balance) -> Text:
    """One line: exact, or what the joints still hold."""
    most = balance.unbalanced.max
    if not len(balance.coordinates):
        return Text("nothing moves: there is no joint to balance", style="bold")
    if balance.exact:
        alone = "" if not balance.mechanism.springs else f"; without springs {_heaviest(balance)}"
        return Text(f"EXACT: balanced in every pose, proved{alone if most.any() else ''}", style="bold green")
    if np.isinf(balance.relative):
        return Text("NOT BALANCED: the springs load joints that gravity does not", style="bold yellow")
    if not balance.mechanism.springs:
        return Text(f"no springs: {_heaviest(balance)}", style="bold")
    if balance.relative < EXACT:
        return Text("BALANCED as far as can be seen, not proved: no pose that was tried loads a joint", style="bold")
    left = "; ".join(_left(balance))
    if balance.relative > 1:
        return Text(f"NOT EXACT: these springs make it worse: {left}", style="bold yellow")
    return Text(f"NOT EXACT: {percent(balance.relative)} of the load is left: {left}", style="bold")


def basis(balance: Balance) -> str:
    """What the verdict rests on, in mathematics."""
    certificate = balance.certificate
    poses = f"{certificate.samples:,} random poses and a search for the worst"
    if certificate.distance is None:
        return f"judged on {poses}, not proved: {certificate.reason}"
    if certificate.terms is None:
        varies = f"the energy varies by {certificate.distance.relative:.2g} of what there is to balance"
    else:
        varies = (
            f"of {certificate.terms:,} Fourier terms of the energy the largest that varies is "
            f"{certificate.max_coefficient:.2g} J"
        )
    return f"proof: {varies}" if balance.exact else f"judged on {poses}; {varies}"


def next_step(balance: Balance, file: Path) -> str:
    """The command that a user would want now, or nothing."""
    name = shlex.quote(str(file))
    if not balance.mechanism.springs:
        return "" if balance.exact else f"next: equipoise design {name} -o balanced.yaml    finds springs for it"
    if cams := [one.name for one in balance.mechanism.springs if one.law.comparison(0.0, 0.0) is not None]:
        cut = f"--to dxf --cam {shlex.quote(cams[0])} -o cam.dxf"
        return f"next: equipoise export {name} {cut}    draws the profile to cut"
    if balance.relative < EXACT:
        return f"next: equipoise hardware {name}    says which springs to buy or wind"
    return f"next: equipoise design {name} -o better.yaml    finds the best springs to compare with"


def _heaviest(balance: Balance) -> str:
    """The joint that gravity loads most, of each unit, and how many it loads."""
    loaded = balance.unbalanced.max > EXACT * balance.unbalanced.max.max()
    first = " and ".join(
        f"{balance.coordinates[j]} holds up to {rounded(balance.unbalanced.max[j])} {unit}"
        for unit, j in _largest(balance, balance.unbalanced.max)
    )
    others = int(loaded.sum()) - first.count(" holds up to ")
    return first if not others else f"{first}, and {others} more {'joint holds' if others == 1 else 'joints hold'} less"


def _left(balance: Balance) -> Iterator[str]:
    """What the joint that is loaded most still holds, of each unit, and what the largest load was."""
    before = dict(_largest(balance, balance.unbalanced.max))
    for unit, j in _largest(balance, balance.residual.max):
        floor = EXACT * float(balance.unbalanced.max.max())
        was = rounded(balance.unbalanced.max[before[unit]]) if unit in before else "0"
        now = rounded(balance.residual.max[j], floor)
        yield f"{balance.coordinates[j]} holds up to {now} {unit}, where the largest without springs is {was} {unit}"


def _largest(balance: Balance, loads: np.ndarray) -> Iterator[tuple[str, int]]:
    """Each unit of load, torques first, and the coordinate with the largest, where there is any."""
    units = [coordinate.load_unit for coordinate in balance.coordinates]
    for unit in ("N m", "N"):
        own = [j for j, one in enumerate(units) if one == unit and loads[j] > 0]
        if own:
            yield unit, max(own, key=lambda j: loads[j])

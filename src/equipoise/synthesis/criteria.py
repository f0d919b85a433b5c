"""Why a layout balances no planar arm: the criteria of Lee and Chen (2014), Table 1, and the bound by rank.

A layout is a multiset of pairs of links, the ground being link 1. Some criteria are necessary, whatever the attachment
angles and the mass centres, provided that gravity acts on every link and differently on neighbours; only these exclude
a layout. With ``K_uv`` the blocks of `energy.blocks`, off the diagonal zero in the sum:

rank  `n - 1` springs at least. Without its first row and column the springs' matrix is diagonal, and no entry there is
      zero: the matrix is positive semidefinite and ``K_1v`` is not. So its rank is n - 1 at least, and each spring's is
      one. (The least rank of a semidefinite matrix with the pattern of a star, or any tree, on n vertices.)
G1    Only springs between 1 and n act on K_1n.
G2    One spring between 1 and n leaves ``k B`` in K_2n, unless another between 1 or 2 and n cancels it.
G3    Without springs from the ground to v and v + 1, those that reach further act on K_1v and K_1(v+1) alike. (The
      paper's number of such springs, "greater than" ceil((n-1)/2), has to read "at least": Table 2, n = 3.)
G5    For 2 <= u < v, springs that reach beyond both u and v add their stiffness to K_uv; one at u or v must take it
      away. A single spring that acts on K_uv takes nothing away either.

The others hold for the signs and the objective that the paper assumes, and explain: G4 and the angles in G1 and S1-S3,
J1-J4. J4 has an exception of its own, the last paragraph of section 7.2: springs 23 and 24 may be 24 and 34 instead.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from ..energy.planar import Installation
from .exclusion import Layout

Objective = Literal["springs", "span"]
NECESSARY = ("rank", "G1", "G2", "G3", "G5")


@dataclass(frozen=True)
class Failure:
    """A criterion that a layout fails, and where."""

    criterion: str
    text: str

    @property
    def necessary(self) -> bool:
        """Whether it excludes the layout."""
        return self.criterion in NECESSARY

    def __str__(self) -> str:
        return f"fails {self.criterion} {self.text}"


def failures(layout: Layout, n: int) -> Iterator[Failure]:
    """The necessary criteria that a layout for n links fails, the cheapest first."""
    for test in (_rank, _G1, _G2, _G3, _G5):
        yield from test(layout, n)


def objections(layout: Layout, n: int, objective: Objective) -> Iterator[Failure]:
    """What else the paper asks for one objective: S1-S3 for the fewest springs, J1-J4 for the smallest span."""
    yield from _fewest_springs(layout, n) if objective == "springs" else _smallest_span(layout, n)


def sign_objections(springs: Sequence[Installation], n: int) -> Iterator[Failure]:
    """What the paper says of attachment angles, for springs on the link lines: G1, G4."""
    if not any(_up(one) * one.b.real > 0 for one in springs if (one.i, one.k) == (1, n)):
        yield Failure("G1", f"at links 1-{n}: no spring with angles (90, 0) or (270, 180) deg")
    for one in springs:
        if one.i == 1 and _up(one) < 0 < one.b.real and one.k > 2:
            yield Failure("G4", f"at links 1-{one.k}: a spring with angles (270, 0) deg")


def _up(one: Installation) -> float:
    """The ground's attachment [m] above the first joint."""
    return one.a.imag


def _rank(layout: Layout, n: int) -> Iterator[Failure]:
    if len(layout) < n - 1:
        yield Failure("rank", f"bound: {n} links need {n - 1} springs, it has {len(layout)}")


def _G1(layout: Layout, n: int) -> Iterator[Failure]:
    if (1, n) not in layout:
        yield Failure("G1", f"at links 1-{n}: no spring between ground and end link")


def _G2(layout: Layout, n: int) -> Iterator[Failure]:
    if n > 2 and sum(k == n and i <= 2 for i, k in layout) < 2:
        yield Failure("G2", f"at link {n}: fewer than two springs to it from links 1 and 2")


def _G3(layout: Layout, n: int) -> Iterator[Failure]:
    for v in range(2, n):
        if not {(1, v), (1, v + 1)} & set(layout):
            yield Failure("G3", f"at links {v}-{v + 1}: no spring from the ground to either")


def _G5(layout: Layout, n: int) -> Iterator[Failure]:
    for u in range(2, n):
        for v in range(u + 1, n + 1):
            acting = [(i, k) for i, k in layout if i <= u and v <= k]
            beyond = [(i, k) for i, k in acting if i < u and v < k]
            if acting and len(beyond) == len(acting):
                yield Failure("G5", f"at links {u}-{v}: nothing cancels the springs that reach beyond both")
            elif len(acting) == 1:
                yield Failure("G5", f"at links {u}-{v}: one spring alone acts there")


def _fewest_springs(layout: Layout, n: int) -> Iterator[Failure]:
    if (1, n) not in layout:
        yield Failure("S1", f"at links 1-{n}: no spring between ground and end link")
    ends = layout.count((1, n)) + layout.count((2, n)) if n > 2 else 2
    if ends != 2:
        yield Failure("S2", f"at link {n}: {ends} springs to it from links 1 and 2, not two")
    for v in range(3, n):
        if layout.count((1, v)) != 1:
            yield Failure("S3", f"at link {v}: {layout.count((1, v))} springs to it from the ground, not one")


def _smallest_span(layout: Layout, n: int) -> Iterator[Failure]:
    for i, k in sorted({pair for pair in layout if layout.count(pair) > 1}):
        yield Failure("J1", f"at links {i}-{k}: {layout.count((i, k))} springs")
    for name, pair in (("J2", (1, n)), ("J3", (2, n))):
        if pair not in layout and n > 2:
            yield Failure(name, f"at links {pair[0]}-{pair[1]}: no spring")
    for v in range(3, n):
        if not {(1, v), (2, v)} & set(layout):
            yield Failure("J4", f"at link {v}: no spring to it from links 1 and 2")

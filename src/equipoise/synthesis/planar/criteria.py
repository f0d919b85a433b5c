"""Why a layout balances no planar arm: the criteria of Lee and Chen (2014), Table 1, and the bound by rank.

A layout is a multiset of pairs of links, the ground being link 1. Some criteria are necessary, whatever the attachment
angles and the mass centres, provided that gravity acts on every link and differently on neighbours; only these exclude
a layout. With ``K_uv`` the blocks of `energy.blocks`, off the diagonal zero in the sum:

- rank: n - 1 springs at least. Without its first row and column the springs' matrix is diagonal, and no entry there is
  zero: the matrix is positive semidefinite, and K_1v is not zero. So its rank is n - 1 at least, and each spring's is
  one. (The least rank of a semidefinite matrix with the pattern of a star, or any tree, on n vertices.)
- G1: Only springs between 1 and n act on K_1n.
- G2: One spring between 1 and n leaves ``k B`` in K_2n, unless another between 1 or 2 and n cancels it.
- G3: Without springs from the ground to v and v + 1, those that reach further act on K_1v and K_1(v+1) alike. (The
  paper's number of such springs, "greater than" ceil((n-1)/2), has to read "at least": Table 2, n = 3.)
- G5: For 2 <= u < v, springs that reach beyond both u and v add their stiffness to K_uv; one at u or v must take it
  away. A single spring that acts on K_uv takes nothing away either.

G4 and the angles in G1 depend on signs: `sign_failures`. S1-S3 and J1-J4 hold for the paper's objectives, and explain.
J4 has an exception of its own, the last paragraph of section 7.2: springs 23 and 24 may be 24 and 34 instead.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from .arm import Installation, PlanarArm
from .exclusion import Layout

LayoutObjective = Literal["springs", "span", "weighted"]
"""What is to be small: the number of springs, the joints that they span, or a weighted sum of both."""


@dataclass(frozen=True)
class Failure:
    """A criterion that a layout fails, and where."""

    criterion: str
    text: str

    def __str__(self) -> str:
        return f"fails {self.criterion} {self.text}"


def failures(layout: Layout, n: int) -> Iterator[Failure]:
    """The necessary criteria that a layout for n links fails, the cheapest first."""
    for test in (_rank, _G1, _G2, _G3, _G5):
        yield from test(layout, n)


def objections(layout: Layout, n: int, objective: LayoutObjective) -> Iterator[Failure]:
    """What else the paper asks for an objective: S1-S3 for the fewest springs, J1-J4 for the smallest span."""
    if objective == "springs":
        yield from _fewest_springs(layout, n)
    elif objective == "span":
        yield from _smallest_span(layout, n)


def sign_failures(arm: PlanarArm, springs: Sequence[Installation]) -> Iterator[Failure]:
    """The angles of G1 and G4 that springs on the link lines fail, where mass centres lie between the joints.

    Both follow from ``K_12 > K_13 > .. > K_1n > 0``: springs 1n alone act on K_1n, and the springs that tell K_1(v-1)
    from K_1v are those between the ground and either. G4's ban on (270, 0) deg does not follow, and is left out.
    """
    lift = {v: [(one.stiffness * one.a.imag, one.b.real / arm.lengths[v - 1]) for one in springs
                if (one.i, one.k) == (1, v)] for v in range(2, arm.n + 1)}  # fmt: skip
    for v in range(3, arm.n + 2):
        beyond = sum(up * (1 - share) for up, share in lift.get(v, []))
        if beyond <= 0 and not any(up * share > 0 for up, share in lift[v - 1]):
            criterion = "G1" if v > arm.n else "G4"
            yield Failure(criterion, f"at links 1-{v - 1}: no spring with angles (90, 0) or (270, 180) deg")


def span_failures(n: int, springs: Sequence[Installation]) -> Iterator[Failure]:
    """What Eqs. (31) and (32) ask of the ground's springs, for the smallest span, and these do not have.

    A spring between neighbours, on link 2, has two equivalent installations: (90, 0) deg is (270, 180).
    """
    angles = {one.k: {(90 if one.a.imag > 0 else 270, 0 if one.b.real > 0 else 180)} for one in springs if one.i == 1}
    if 2 in angles:
        angles[2] |= {((alpha + 180) % 360, 180 - beta) for alpha, beta in angles[2]}
    for v in range(3, n + 1):
        above, below = angles.get(v, set()), angles.get(v - 1)
        if above & {(90, 0), (90, 180)}:
            allowed = {(90, 180)} | ({(90, 0)} if v == 4 else set())
            wrong = below is not None and (v == 3 or not below & allowed)
            text, equation = "none" if v == 3 else f"none or one at {_degrees(allowed)}", "(31)"
        else:
            allowed = {(270, 180)} | ({(90, 0)} if v < 5 else set())
            wrong, text, equation = not (below and below & allowed), f"one at {_degrees(allowed)}", "(32)"
        if wrong:
            found = f"one at {_degrees(below)}" if below else "none"
            yield Failure(equation, f"at link {v - 1}: {text} from the ground, found {found}")


def _degrees(angles: set[tuple[int, int]]) -> str:
    return " or ".join(map(str, sorted(angles))) + " deg"


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

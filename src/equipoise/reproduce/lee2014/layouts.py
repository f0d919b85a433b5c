"""The layouts of lee2014: Tables 2 and 3, equivalent installations (28), and what (29) to (33) say about them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from math import pi

import numpy as np

from ...synthesis.planar.arm import Installation
from ...synthesis.planar.criteria import LayoutObjective, span_failures
from ...synthesis.planar.equivalent import exchanged, resized, turned
from ...synthesis.planar.layouts import LayoutSearch, name, search, span
from ...synthesis.planar.stiffness_blocks import StiffnessBlocks
from ..record import Row
from .arm import completed, planar
from .tables import CASES, TABLE_2, TABLE_3, THIRD

PAPER = "lee2014"


def equivalent() -> Iterator[Row]:
    """Equivalent installations (28a, b) and of mono-articular springs, section 5.2."""
    _, one, two = completed(CASES[0])  # springs 14_1 and 14_2, the second turned to (90, 0) deg: in a balanced arm the
    two = replace(two, b=-two.b)  # links between count nothing in one mix of the rows (43), and (28b) has no spring
    for equation, end, links in (("28a", "lower", (2, 4)), ("28b", "upper", (1, 3))):
        pair = exchanged(planar(), one, two, end)  # pyright: ignore[reportArgumentType]
        joins = sorted((spring.i, spring.k) for spring in pair)
        yield Row(PAPER, f"({equation}): one of two springs 14 becomes {links[0]}{links[1]}: 1 if so", "1",
                  int(joins == sorted([(1, 4), links])), exact=True)  # fmt: skip
        yield _same(f"({equation})", (one, two), pair)
    mono = completed(CASES[1])[0]  # spring 12
    yield _same("spring 12 at (270, 180) instead of (90, 0) deg, Fig. 7", (mono,), (turned(mono, pi),))
    yield _same("spring 12 with both lengths doubled", (mono,), (resized(mono, 2 * abs(mono.a), 2 * abs(mono.b)),))


def _same(what: str, before: tuple[Installation, ...], after: tuple[Installation, ...]) -> Row:
    """How far the blocks off the diagonal differ, over the largest."""
    x, y = (
        sum((StiffnessBlocks.spring(planar(), spring).off_diagonal for spring in springs), np.zeros(6, complex))
        for springs in (before, after)
    )
    share = float(abs(x - y).max() / abs(x).max())
    return Row(PAPER, f"blocks that {what} changes, over the largest", "0", share, exact=True, golden="<= 1e-12")


def fewest_springs() -> Iterator[Row]:
    """The fewest springs (29), Table 2."""
    for n, published in TABLE_2.items():
        found = _search(n, "springs")
        note = _LIN_2012 if n == 5 else ""
        item = f"fewest springs for n = {n} (29)"
        yield Row(PAPER, item, str(n - 1), len(found.feasible[0].layout), exact=True, note=note)
        yield from _printed("Table 2", n, published, found)
    three = {name(one.layout): one for one in _search(3, "springs").feasible}
    few = sum(i == 1 for i, _ in ((1, 3), (2, 3)))
    yield Row(
        PAPER,
        "ground springs of 13,23, Table 2; G3: greater than ceil((n-1)/2) = 1",
        ">= 2",
        few,
        exact=True,
        golden=1.0,
        against="erratum",
        why=_G3,
        proof="13,23" in three and three["13,23"].balance.exact,
    )


def smallest_span() -> Iterator[Row]:
    """The smallest span (30)-(33), Table 3."""
    for n, published in TABLE_3.items():
        found = _search(n, "span")
        least = (n * n + n - 6) // 2
        yield Row(PAPER, f"smallest span for n = {n} (33)", str(least), span(found.feasible[0].layout), exact=True)
        yield from _printed("Table 3 and Fig. 8", n, published, found)
        failed = [str(one) for layout in found.feasible for one in span_failures(n, layout.found.springs)]
        yield Row(
            PAPER,
            f"ground springs of these layouts that break (31), (32), n = {n}",
            "0",
            len(failed),
            exact=True,
            note="; ".join(failed),
        )
    yield Row(PAPER, "span of the third matrix for n = 5, Table 3", "12", span(THIRD), exact=True, golden=15.0,
              against="differs", why=_THIRD)  # fmt: skip


_LIN_2012 = (
    "stiffnesses are free and links may share several springs; where stiffnesses are given and each pair of links has "
    "at most one spring, the paper says ceil(n(n-1)/4) = 5, after Lin et al. (2012)"
)
_G3 = (
    "'greater than' ceil((n-1)/2) has to read 'at least': the paper's own matrix for n = 3 has ceil(2/2) = 1, and an "
    "exact design"
)
_THIRD = (
    "the matrix, as far as our copy can be read 12,13,15,24,25,35,45, spans more than Eq. (33) says; without its rows "
    "3 and 4 it is 12,13,15,24,25, which spans 12 and is feasible"
)


def _printed(table: str, n: int, published: tuple[str, ...], found: LayoutSearch) -> Iterator[Row]:
    """The layouts in print that the search finds, each exact by the certificate, and how many more it finds."""
    names = [name(one.layout) for one in found.feasible if one.balance.exact]
    both = [layout for layout in published if layout in names]
    more = [layout for layout in names if layout not in published]
    counts = (
        f"searched {found.candidates}: {sum(map(len, found.pruned.values()))} pruned by criteria, {len(found.proved)} "
        f"proved infeasible, {len(found.open)} open"
    )
    item = f"layouts for n = {n}, {table}"
    yield Row(PAPER, item, str(len(published)), len(both), exact=True, note="; ".join((*both, counts)))
    yield Row(PAPER, f"{item}: further ones", None, len(more), golden=float(FURTHER.get((table[:7], n), 0)),
              note="; ".join(more))  # fmt: skip
    yield Row(PAPER, f"{item}: undecided ones", None, len(found.open), golden=0.0)


FURTHER = {("Table 3", 5): 1}  # (table, n): feasible layouts that the paper does not list


@cache
def _search(n: int, objective: LayoutObjective) -> LayoutSearch:
    return search(n, objective)

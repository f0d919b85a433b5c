"""Stiffness blocks and design equations in symbols: Lee and Chen (2014), Eqs. (7)-(8), (18), (24)-(27), (39)-(54).

Every block is a sum of terms ``+- (product of symbols) / (product of symbols)`` times a rotation. With angles given as
multiples of 90 degrees the rotations are I and I' up to sign, and equations read as in the paper; without, they are
written R(..). Names are k13, a13, b13 and for angles alpha13, beta13, with _1, _2 where springs join the same links.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import reduce
from operator import add

from .arm import Installation

Turn = tuple[tuple[int, str], ...]  # signed symbols of angles


@dataclass(frozen=True)
class Term:
    """sign * product(above) / product(below) * R(quarters 90 deg + turn); quarters is 0 or 1."""

    sign: int
    above: tuple[str, ...]
    below: tuple[str, ...] = ()
    quarters: int = 0
    turn: Turn = ()

    @staticmethod
    def of(sign: int, above: Iterable[str], below: Iterable[str] = (), quarters: int = 0, turn: Turn = ()) -> Term:
        """A term whose quarter turns may be any number: two of them are a sign."""
        return Term(sign * (-1 if quarters % 4 > 1 else 1), tuple(above), tuple(below), quarters % 2, turn)

    @property
    def unit(self) -> str:
        """The rotation: I, I' or R(..)."""
        if not self.turn:
            return "I'" if self.quarters else "I"
        return f"R({_signed([*([(1, '90')] if self.quarters else []), *self.turn])})"


@dataclass(frozen=True)
class Angles:
    """Where a spring's ends lie, in multiples of 90 deg; None leaves the angle a symbol."""

    alpha: int | None = None
    beta: int | None = None

    @staticmethod
    def of(one: Installation) -> Angles:
        """The angles of a spring whose ends lie on lines along and across its links; a symbol for any other."""
        return Angles(_quarter(one.a), _quarter(one.b))


@dataclass(frozen=True)
class SymbolicBlocks:
    """Upper triangle of a symmetric stiffness block matrix: (u, v) -> terms, links numbered from 1."""

    n: int
    blocks: Mapping[tuple[int, int], tuple[Term, ...]]

    @staticmethod
    def gravity(n: int, straight: bool = True) -> SymbolicBlocks:
        """Eq. (18), or Eq. (24) for mass centres on the link lines: K_1j = -(s_j/r_j m_j + sum of m beyond) g I'."""
        blocks = {}
        for j in range(2, n + 1):
            turn = () if straight else ((1, f"delta{j}"),)
            own = Term.of(-1, (f"s{j}", f"m{j}", "g"), (f"r{j}",), 1, turn)
            blocks[1, j] = (own, *(Term.of(-1, (f"m{w}", "g"), (), 1) for w in range(j + 1, n + 1)))
        return SymbolicBlocks(n, blocks)

    @staticmethod
    def spring(n: int, i: int, k: int, label: str, angles: Angles | None = None) -> SymbolicBlocks:
        """Eqs. (7)-(8): w = (.., -A, 1, .., 1, B, ..), K_uv = k w_u^T w_v."""
        angles = angles or Angles()
        A = _end(-1, f"a{label}", () if i == 1 else (f"r{i}",), angles.alpha, f"alpha{label}")
        B = _end(1, f"b{label}", (f"r{k}",), angles.beta, f"beta{label}")
        w = {i: A, **{j: Term(1, ()) for j in range(i + 1, k)}, k: B}
        blocks = {(u, v): (_product(f"k{label}", w[u], w[v]),) for u in w for v in w if u <= v}
        return SymbolicBlocks(n, blocks)

    def __add__(self, other: SymbolicBlocks) -> SymbolicBlocks:
        keys = sorted({*self.blocks, *other.blocks})
        return SymbolicBlocks(self.n, {key: self.blocks.get(key, ()) + other.blocks.get(key, ()) for key in keys})

    def equations(self) -> dict[tuple[int, int], tuple[Term, ...]]:
        """The blocks that must vanish: those off the diagonal, Eq. (23)."""
        return {(u, v): terms for (u, v), terms in self.blocks.items() if u < v and terms}

    def __str__(self) -> str:
        """The design equations as text, one a line."""
        return "\n".join(f"K_{_pair(u, v)} = {_sum(terms, _text)} = 0" for (u, v), terms in self.equations().items())

    def latex(self) -> str:
        """The design equations as LaTeX lines."""
        lines = (
            rf"\mathbf{{K}}_{{{_pair(u, v)}}} = {_sum(terms, _latex)} = \mathbf{{0}}"
            for (u, v), terms in self.equations().items()
        )
        return " \\\\\n".join(lines)

    def matrix(self) -> str:
        """The upper triangle as text, a row on each line, its blocks with semicolons between."""
        rows = range(1, self.n + 1)
        return "\n".join("[ " + " ; ".join(self._cell(u, v, _text) for v in rows if v >= u) + " ]" for u in rows)

    def matrix_latex(self) -> str:
        """The upper triangle as a LaTeX matrix."""
        links = range(1, self.n + 1)
        rows = (" & ".join(self._cell(u, v, _latex) if v >= u else "" for v in links) for u in links)
        return "\\begin{bmatrix} " + " \\\\ ".join(rows) + " \\end{bmatrix}"

    def _cell(self, u: int, v: int, write: _Writer) -> str:
        terms = self.blocks.get((u, v), ())
        return _sum(terms, write) if terms else "0"


def design_equations(
    n: int, springs: Iterable[tuple[int, int, str, Angles | None]], straight: bool = True
) -> SymbolicBlocks:
    """Gravity and springs (i, k, label, angles): what has to vanish off the diagonal, Eq. (23)."""
    blocks = (SymbolicBlocks.spring(n, i, k, label, angles) for i, k, label, angles in springs)
    return reduce(add, blocks, SymbolicBlocks.gravity(n, straight))


def _end(sign: int, length: str, below: tuple[str, ...], quarters: int | None, angle: str) -> Term:
    if quarters is None:
        return Term(sign, (length,), below, 0, ((1, angle),))
    return Term(sign, (length,), below, quarters)


def _product(k: str, one: Term, two: Term) -> Term:
    """k times the transpose of one times two: a rotation transposed turns back."""
    turn = (*two.turn, *((-sign, name) for sign, name in one.turn)) if one != two else ()
    quarters = two.quarters - one.quarters
    return Term.of(one.sign * two.sign, (k, *one.above, *two.above), one.below + two.below, quarters, turn)


def _quarter(z: complex) -> int | None:
    for quarters, along in enumerate((z, z / 1j, -z, z * 1j)):
        if along.real > 0 and abs(along.imag) <= 1e-9 * abs(along):
            return quarters
    return None


def _pair(u: int, v: int) -> str:
    return f"{u}{v}" if v < 10 else f"{u},{v}"


class _Writer:
    """How one term and a unit are written."""

    def __init__(self, latex: bool) -> None:
        self.latex = latex

    def term(self, term: Term) -> str:
        above, below = (" ".join(map(self.symbol, names)) for names in (term.above, term.below))
        if not below:
            return above
        return rf"\frac{{{above}}}{{{below}}}" if self.latex else f"{above}/{f'({below})' if ' ' in below else below}"

    def symbol(self, name: str) -> str:
        if not self.latex:
            return name
        letter, number, which = re.fullmatch(r"([a-z]+)([\d-]*)(_\d+)?", name).groups()  # type: ignore[union-attr]
        letter = f"\\{letter}" if len(letter) > 1 else letter
        if letter in "gmrs" or letter == "\\delta":
            return f"{letter}_{{{number}}}" if number else letter
        return f"{letter}^{{{number}{which or ''}}}"

    def unit(self, unit: str) -> str:
        if not self.latex:
            return unit
        if unit in ("I", "I'"):
            return rf"\mathbf{{{unit[0]}}}{unit[1:]}"
        angles = re.sub(r"[a-z]+[\d_-]*\d", lambda found: self.symbol(found[0]), unit[2:-1])
        angles = angles.replace("90", r"90^\circ")
        return rf"\mathbf{{R}}({angles})"


_text, _latex = _Writer(latex=False), _Writer(latex=True)


def _sum(terms: tuple[Term, ...], write: _Writer) -> str:
    """Terms grouped by rotation: [..] I + [..] I'."""
    groups: dict[str, list[Term]] = {}
    for term in terms:
        groups.setdefault(term.unit, []).append(term)
    parts = []
    for unit, members in groups.items():
        inside = _signed((one.sign, write.term(one)) for one in members)
        parts.append(f"{inside if len(members) == 1 else f'[{inside}]'} {write.unit(unit)}")
    return " + ".join(parts).replace("+ -", "- ")


def _signed(parts: Iterable[tuple[int, str]]) -> str:
    """-x + y - z."""
    text = "".join(f" {'-' if sign < 0 else '+'} {part}" for sign, part in parts)
    return f"-{text[3:]}" if text.startswith(" -") else text[3:]

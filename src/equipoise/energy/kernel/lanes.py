"""Arithmetic on vectors in LLVM's assembly language, one lane for each pose."""

from __future__ import annotations

from math import inf

from . import sines, trace

BINARY = {trace.ADD: "fadd", trace.SUB: "fsub", trace.MUL: "fmul", trace.ADDK: "fadd", trace.MULK: "fmul"}


class Lanes:
    """Writes an instruction at a time to `lines`; values are names.

    Constants come from a table that the compiler cannot tell from the output: else it would keep every one of them as
    a whole vector on the stack, more than a cache holds.

    Attributes:
        scalar, real: LLVM's names of the program's precision, alone and as a vector; kind: their intrinsics' ending.
        bytes: of one number.
        constants, wide_constants: value -> place in the table of its precision; both are double unless `single`.
    """

    def __init__(self, lanes: int, single: bool) -> None:
        self.lanes, self.single, self.bytes = lanes, single, 4 if single else 8
        self.scalar, self.kind = ("float", f"v{lanes}f32") if single else ("double", f"v{lanes}f64")
        self.real, self.wide, self.whole = f"<{lanes} x {self.scalar}>", f"<{lanes} x double>", f"<{lanes} x i64>"
        self.lines: list[str] = []
        self.constants: dict[float, int] = {}
        self.wide_constants: dict[float, int] = {}
        self._count = 0

    def declarations(self) -> list[str]:
        """What the module has to declare."""
        found = [
            f"declare {self.real} @llvm.fmuladd.{self.kind}({self.real}, {self.real}, {self.real})",
            f"declare {self.real} @llvm.sqrt.{self.kind}({self.real})",
            f"declare {self.real} @llvm.fabs.{self.kind}({self.real})",
        ]
        if self.single:
            found.append(f"declare {self.wide} @llvm.fmuladd.v{self.lanes}f64({self.wide}, {self.wide}, {self.wide})")
        return found

    def new(self, expression: str) -> str:
        """The name of a new value."""
        self._count += 1
        name = f"%v{self._count}"
        self.lines.append(f"  {name} = {expression}")
        return name

    def splat(self, x: float, wide: bool = False) -> str:
        """A constant in all lanes."""
        wide = wide and self.single
        table = self.wide_constants if wide else self.constants
        at = table.setdefault(float(x), len(table))
        scalar, real = ("double", self.wide) if wide else (self.scalar, self.real)
        pointer = self.new(f"getelementptr {scalar}, ptr {'%w' if wide else '%k'}, i64 {at}")
        value = self.new(f"load {scalar}, ptr {pointer}")
        one = self.new(f"insertelement {real} poison, {scalar} {value}, i64 0")
        return self.new(f"shufflevector {real} {one}, {real} poison, <{self.lanes} x i32> zeroinitializer")

    def fma(self, a: str, b: str, c: str, wide: bool = False) -> str:
        """``a b + c``."""
        real, kind = (self.wide, f"v{self.lanes}f64") if wide else (self.real, self.kind)
        return self.new(f"call {real} @llvm.fmuladd.{kind}({real} {a}, {real} {b}, {real} {c})")

    def at(self, base: str, row: str, step: int, pose: str) -> str:
        """The address of a pose in row `step` of rows that are `row` apart."""
        start = self.new(f"mul i64 {row}, {step}")
        return self.new(f"getelementptr {self.scalar}, ptr {base}, i64 {self.new(f'add i64 {start}, {pose}')}")

    def load(self, pointer: str) -> str:
        """A vector, wherever it begins."""
        return self.new(f"load {self.real}, ptr {pointer}, align {self.bytes}")

    def gather(self, base: str, row: str, step: int, apart: str, pose: str) -> str:
        """A vector of poses from this one on that are `apart`, in row `step` of rows that are `row` apart."""
        start, vector = self.new(f"mul i64 {row}, {step}"), "poison"
        for lane in range(self.lanes):
            offset = self.new(f"mul i64 {self.new(f'add i64 {pose}, {lane}')}, {apart}")
            place = self.new(f"add i64 {start}, {offset}")
            pointer = self.new(f"getelementptr {self.scalar}, ptr {base}, i64 {place}")
            one = self.new(f"load {self.scalar}, ptr {pointer}, align {self.bytes}")
            vector = self.new(f"insertelement {self.real} {vector}, {self.scalar} {one}, i64 {lane}")
        return vector

    def store(self, value: str, pointer: str, past_caches: bool = False) -> None:
        """Write a vector; past the caches it has to begin at a multiple of its size."""
        how = f"{self.bytes * self.lanes}, !nontemporal !0" if past_caches else f"{self.bytes}"
        self.lines.append(f"  store {self.real} {value}, ptr {pointer}, align {how}")

    def prefetch(self, pointer: str, vectors: int, write: bool) -> None:
        """Fetch what is so many vectors on."""
        later = self.new(f"getelementptr {self.real}, ptr {pointer}, i64 {vectors}")
        self.lines.append(f"  call void @llvm.prefetch.p0(ptr {later}, i32 {int(write)}, i32 3, i32 1)")

    def operation(self, code: int, a: str, b: str, c: str, k: float, m: float) -> str:
        real = self.real
        match code:
            case trace.ADD | trace.SUB | trace.MUL:
                return self.new(f"{BINARY[code]} {real} {a}, {b}")
            case trace.ADDK | trace.MULK:
                return self.new(f"{BINARY[code]} {real} {a}, {self.splat(k)}")
            case trace.FMA:
                return self.fma(a, b, c)
            case trace.FMS:
                return self.fma(a, b, self.new(f"fneg {real} {c}"))
            case trace.FNM:
                return self.fma(self.new(f"fneg {real} {a}"), b, c)
            case trace.FMAK:
                return self.fma(a, self.splat(k), c)
            case trace.FMSK:
                return self.fma(a, self.splat(k), self.new(f"fneg {real} {c}"))
            case trace.FMAM:
                return self.fma(a, self.splat(k), self.splat(m))
            case trace.SQRT:
                kind = f"v{self.lanes}f{32 if self.single else 64}"
                return self.new(f"call {real} @llvm.sqrt.{kind}({real} {a})")
            case trace.CLAMP:
                above = self._positive(a := self.new(f"fsub {real} {a}, {self.splat(k)}"), a)
                if m == inf:
                    return above
                most = self.splat(m)
                within = self.new(f"fcmp olt {real} {above}, {most}")
                return self.new(f"select <{self.lanes} x i1> {within}, {real} {above}, {real} {most}")
            case trace.STEP:
                return self._positive(a, self.splat(1.0))
            case trace.INVERSE:
                return self._positive(a, self.new(f"fdiv {real} {self.splat(1.0)}, {a}"))
        # what is left is trace.SHARE
        ratio = self.new(f"fdiv {real} {self.splat(k)}, {a}")
        share = self.new(f"fsub {real} {self.splat(1.0)}, {ratio}")
        return self._positive(a, share)

    def _positive(self, a: str, value: str) -> str:
        """The value where a is more than 0, else 0."""
        some = self.new(f"fcmp ogt {self.real} {a}, zeroinitializer")
        return self.new(f"select <{self.lanes} x i1> {some}, {self.real} {value}, {self.real} zeroinitializer")

    def sincos(self, x: str) -> tuple[str, str]:
        wide = self.wide
        if self.single:  # in double: the reduction of large angles needs it
            x = self.new(f"fpext {self.real} {x} to {wide}")
        rounded = self.fma(x, self.splat(sines.INVERSE_PI, True), self.splat(sines.ROUND, True), True)
        k = self.new(f"fsub {wide} {rounded}, {self.splat(sines.ROUND, True)}")
        r = self.fma(k, self.splat(-sines.PI_HIGH, True), x, True)
        r = self.fma(k, self.splat(-sines.PI_LOW, True), r, True)
        z = self.new(f"fmul {wide} {r}, {r}")
        P, Q = self.splat(sines.SIN[-1], True), self.splat(sines.COS[-1], True)
        for coefficient in reversed(sines.SIN[:-1]):
            P = self.fma(P, z, self.splat(coefficient, True), True)
        for coefficient in (*reversed(sines.COS[:-1]), 1.0):
            Q = self.fma(Q, z, self.splat(coefficient, True), True)
        s = self.fma(self.new(f"fmul {wide} {r}, {z}"), P, r, True)
        bits = self.new(f"bitcast {wide} {rounded} to {self.whole}")
        shift = "<" + ", ".join(["i64 63"] * self.lanes) + ">"
        flip = self.new(f"shl {self.whole} {bits}, {shift}")
        found = []
        for value in (s, Q):
            turned = self.new(f"xor {self.whole} {self.new(f'bitcast {wide} {value} to {self.whole}')}, {flip}")
            back = self.new(f"bitcast {self.whole} {turned} to {wide}")
            found.append(self.new(f"fptrunc {wide} {back} to {self.real}") if self.single else back)
        return found[0], found[1]

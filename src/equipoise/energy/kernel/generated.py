"""A kernel generated from the mechanism: its program as vector code of the machine at hand, through LLVM.

The code is written with explicit vectors, one lane for each pose, and compiled in about a tenth of a second; llvmlite
comes with numba. Poses lie next to each other in memory: arrays (rows, N), rows `stride` numbers apart.
"""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Callable, Iterator
from functools import cached_property

import numpy as np

from . import sines, trace
from .trace import Program

BINARY = {trace.ADD: "fadd", trace.SUB: "fsub", trace.MUL: "fmul", trace.ADDK: "fadd", trace.MULK: "fmul"}
SIGNATURE = ctypes.CFUNCTYPE(
    ctypes.c_double, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64
)


class Generated:
    """The compiled program; `run` is safe to call from several threads at once and holds no lock.

    Attributes:
        lanes: poses computed at a time; `run` takes multiples of it.
    """

    def __init__(self, program: Program, single: bool = False) -> None:
        import llvmlite.binding as llvm

        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        features = llvm.get_host_cpu_features()
        bits = 512 if features.get("avx512f") else 256 if features.get("avx") else 128
        self.lanes = bits // (32 if single else 64)
        machine = llvm.Target.from_default_triple().create_target_machine(
            cpu=llvm.get_host_cpu_name(), features=features.flatten(), opt=2
        )
        self._text = _Writer(program, self.lanes, single).text()
        module = llvm.parse_assembly(self._text)
        module.triple, module.data_layout = llvm.get_default_triple(), str(machine.target_data)
        module.verify()
        options = llvm.create_pipeline_tuning_options(speed_level=1)
        options.loop_unrolling = options.loop_vectorization = options.slp_vectorization = False
        llvm.create_pass_builder(machine, options).getModulePassManager().run(module, llvm.create_pass_builder(machine, options))
        self._engine = llvm.create_mcjit_compiler(module, machine)
        self._engine.finalize_object()
        self._call: Callable[..., float] = SIGNATURE(self._engine.get_function_address("kernel"))
        self._gather: Callable[..., float] = SIGNATURE(self._engine.get_function_address("gather"))

    def run(self, q: np.ndarray, out: np.ndarray) -> float:
        """Compute `out` (outputs, N) at `q` (inputs, N), N a multiple of `lanes`, rows of `out` without gaps.

        Returns:
            The largest sum of |q| of any pose: beyond `sines.FARTHEST` the sines may be wrong.
        """
        size = q.itemsize
        between_rows, between_poses = q.strides[0] // size, q.strides[1] // size
        call = self._call if between_poses == 1 else self._gather
        return call(q.ctypes.data, between_rows, between_poses, out.ctypes.data, out.strides[0] // size, q.shape[1])


class _Writer:
    """LLVM's assembly language, one pose a lane."""

    def __init__(self, program: Program, lanes: int, single: bool) -> None:
        self.program, self.lanes, self.single = program, lanes, single
        self.scalar = "float" if single else "double"
        self.real, self.wide, self.whole = f"<{lanes} x {self.scalar}>", f"<{lanes} x double>", f"<{lanes} x i64>"
        self.lines: list[str] = []
        self.count = 0

    def text(self) -> str:
        """The module."""
        kind = f"v{self.lanes}f{32 if self.single else 64}"
        head = [
            f"declare {self.real} @llvm.fmuladd.{kind}({self.real}, {self.real}, {self.real})",
            f"declare {self.real} @llvm.sqrt.{kind}({self.real})",
            f"declare {self.real} @llvm.fabs.{kind}({self.real})",
        ]
        if self.single:
            head.append(f"declare {self.wide} @llvm.fmuladd.v{self.lanes}f64({self.wide}, {self.wide}, {self.wide})")
        return "\n".join([*head, *self._function("kernel", False), *self._function("gather", True)])

    def _function(self, name: str, gather: bool) -> Iterator[str]:
        yield f"define double @{name}(ptr noalias %q, i64 %qrow, i64 %qpose, ptr noalias %out, i64 %outrow, i64 %n) {{"
        yield "entry:\n  %any = icmp sgt i64 %n, 0\n  br i1 %any, label %loop, label %done"
        yield "loop:"
        yield f"  %i = phi i64 [0, %entry], [%next, %loop]\n  %far = phi {self.real} [zeroinitializer, %entry], [%farther, %loop]"
        self.lines = []
        self._body(gather)
        yield from self.lines
        yield f"  %next = add i64 %i, {self.lanes}"
        yield "  %more = icmp slt i64 %next, %n\n  br i1 %more, label %loop, label %end"
        yield "end:"
        reduce = f"@llvm.vector.reduce.fmax.v{self.lanes}f{32 if self.single else 64}"
        yield f"  %most = call {self.scalar} {reduce}({self.real} %farther)"
        yield "  %found = fpext float %most to double" if self.single else "  %found = fadd double %most, 0.0"
        yield "  br label %done"
        yield "done:\n  %result = phi double [0.0, %entry], [%found, %end]\n  ret double %result\n}"

    def _new(self, expression: str) -> str:
        self.count += 1
        name = f"%v{self.count}"
        self.lines.append(f"  {name} = {expression}")
        return name

    def _splat(self, x: float, wide: bool = False) -> str:
        x = float(x)
        single = self.single and not wide
        value = struct.unpack(">Q", struct.pack(">d", float(np.float32(x)) if single else x))[0]
        kind = "float" if single else "double"
        return "<" + ", ".join([f"{kind} 0x{value:016X}"] * self.lanes) + ">"

    def _fma(self, a: str, b: str, c: str, wide: bool = False) -> str:
        real = self.wide if wide else self.real
        bits = 64 if wide or not self.single else 32
        return self._new(f"call {real} @llvm.fmuladd.v{self.lanes}f{bits}({real} {a}, {real} {b}, {real} {c})")

    def _load(self, row: int, gather: bool) -> str:
        base = self._new(f"mul i64 %qrow, {row}")
        if not gather:
            at = self._new(f"add i64 {base}, %i")
            pointer = self._new(f"getelementptr {self.scalar}, ptr %q, i64 {at}")
            return self._new(f"load {self.real}, ptr {pointer}, align {4 if self.single else 8}")
        vector = "poison"
        for lane in range(self.lanes):
            pose = self._new(f"add i64 %i, {lane}")
            offset = self._new(f"mul i64 {pose}, %qpose")
            at = self._new(f"add i64 {base}, {offset}")
            pointer = self._new(f"getelementptr {self.scalar}, ptr %q, i64 {at}")
            one = self._new(f"load {self.scalar}, ptr {pointer}, align {4 if self.single else 8}")
            vector = self._new(f"insertelement {self.real} {vector}, {self.scalar} {one}, i64 {lane}")
        return vector

    def _body(self, gather: bool) -> None:
        program = self.program
        rows = [self._load(row, gather) for row in range(program.inputs)]
        size = "zeroinitializer"
        for q in rows:
            kind = f"v{self.lanes}f{32 if self.single else 64}"
            size = self._new(f"fadd {self.real} {size}, {self._new(f'call {self.real} @llvm.fabs.{kind}({self.real} {q})')}")
        beyond = self._new(f"fcmp ogt {self.real} {size}, %far")
        self.lines.append(f"  %farther = select <{self.lanes} x i1> {beyond}, {self.real} {size}, {self.real} %far")
        nothing = self._new(f"fmul {self.real} {size}, zeroinitializer")  # NaN where the input is no finite number
        register = [""] * program.registers
        columns = (program.code, program.to, program.a, program.b, program.c, program.k, program.m)
        for code, to, a, b, c, k, m in zip(*(column.tolist() for column in columns), strict=True):
            match code:
                case trace.INPUT:
                    register[to] = rows[int(k)]
                case trace.SINCOS:
                    register[to], register[b] = self._sincos(register[a])
                case _:
                    register[to] = self._operation(code, register[a], register[b], register[c], k, m)
        for row, (from_, sign) in enumerate(zip(program.outputs.tolist(), program.sign.tolist(), strict=True)):
            if from_ < 0:
                value = self._new(f"fadd {self.real} {nothing}, {self._splat(sign)}")
            else:
                value = self._new(f"{'fadd' if sign > 0 else 'fsub'} {self.real} {nothing}, {register[from_]}")
            base = self._new(f"mul i64 %outrow, {row}")
            at = self._new(f"add i64 {base}, %i")
            pointer = self._new(f"getelementptr {self.scalar}, ptr %out, i64 {at}")
            self.lines.append(f"  store {self.real} {value}, ptr {pointer}, align {4 if self.single else 8}")

    def _operation(self, code: int, a: str, b: str, c: str, k: float, m: float) -> str:
        real = self.real
        match code:
            case trace.ADD | trace.SUB | trace.MUL:
                return self._new(f"{BINARY[code]} {real} {a}, {b}")
            case trace.ADDK | trace.MULK:
                return self._new(f"{BINARY[code]} {real} {a}, {self._splat(k)}")
            case trace.FMA:
                return self._fma(a, b, c)
            case trace.FMS:
                return self._fma(a, b, self._new(f"fneg {real} {c}"))
            case trace.FNM:
                return self._fma(self._new(f"fneg {real} {a}"), b, c)
            case trace.FMAK:
                return self._fma(a, self._splat(k), c)
            case trace.FMSK:
                return self._fma(a, self._splat(k), self._new(f"fneg {real} {c}"))
            case trace.FMAM:
                return self._fma(a, self._splat(k), self._splat(m))
            case trace.SQRT:
                kind = f"v{self.lanes}f{32 if self.single else 64}"
                return self._new(f"call {real} @llvm.sqrt.{kind}({real} {a})")
            case trace.SHARE:
                ratio = self._new(f"fdiv {real} {self._splat(k)}, {a}")
                share = self._new(f"fsub {real} {self._splat(1.0)}, {ratio}")
                some = self._new(f"fcmp ogt {real} {a}, zeroinitializer")
                return self._new(f"select <{self.lanes} x i1> {some}, {real} {share}, {real} zeroinitializer")
        raise AssertionError(f"operation {code}")

    def _sincos(self, x: str) -> tuple[str, str]:
        wide = self.wide
        if self.single:  # in double: the reduction of large angles needs it
            x = self._new(f"fpext {self.real} {x} to {wide}")
        rounded = self._fma(x, self._splat(sines.INVERSE_PI, True), self._splat(sines.ROUND, True), True)
        k = self._new(f"fsub {wide} {rounded}, {self._splat(sines.ROUND, True)}")
        r = self._fma(k, self._splat(-sines.PI_HIGH, True), x, True)
        r = self._fma(k, self._splat(-sines.PI_LOW, True), r, True)
        z = self._new(f"fmul {wide} {r}, {r}")
        P, Q = self._splat(sines.SIN[-1], True), self._splat(sines.COS[-1], True)
        for coefficient in reversed(sines.SIN[:-1]):
            P = self._fma(P, z, self._splat(coefficient, True), True)
        for coefficient in (*reversed(sines.COS[:-1]), 1.0):
            Q = self._fma(Q, z, self._splat(coefficient, True), True)
        s = self._fma(self._new(f"fmul {wide} {r}, {z}"), P, r, True)
        bits = self._new(f"bitcast {wide} {rounded} to {self.whole}")
        shift = "<" + ", ".join(["i64 63"] * self.lanes) + ">"
        flip = self._new(f"shl {self.whole} {bits}, {shift}")
        found = []
        for value in (s, Q):
            turned = self._new(f"xor {self.whole} {self._new(f'bitcast {wide} {value} to {self.whole}')}, {flip}")
            back = self._new(f"bitcast {self.whole} {turned} to {wide}")
            found.append(self._new(f"fptrunc {wide} {back} to {self.real}") if self.single else back)
        return found[0], found[1]

"""A kernel generated from the mechanism: its program as vector code of the machine at hand, through LLVM.

The code is written with explicit vectors, one lane for each pose, and compiled in about a tenth of a second; llvmlite
comes with numba. Poses lie next to each other in memory. Constants come from a table that the compiler cannot tell from
the output: else it would keep every one of them as a whole vector on the stack, more than a cache holds.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator

import numpy as np

from . import sines, trace
from .trace import Program

BINARY = {trace.ADD: "fadd", trace.SUB: "fsub", trace.MUL: "fmul", trace.ADDK: "fadd", trace.MULK: "fmul"}
AHEAD = 256  # vectors that are fetched before their turn, all rows together: a third of the first cache
SIGNATURE = ctypes.CFUNCTYPE(
    ctypes.c_double, *(ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64) * 2, *(ctypes.c_void_p,) * 2
)


class Generated:
    """The compiled program; safe to call from several threads at once, and holds no lock.

    Attributes:
        lanes: poses computed at a time.
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
        writer = _Writer(program, self.lanes, single)
        module = llvm.parse_assembly(writer.text())
        module.triple, module.data_layout = llvm.get_default_triple(), str(machine.target_data)
        module.verify()
        options = llvm.create_pipeline_tuning_options(speed_level=1)
        options.loop_unrolling = options.loop_vectorization = options.slp_vectorization = False
        passes = llvm.create_pass_builder(machine, options)
        passes.getModulePassManager().run(module, passes)
        self._constants = np.array(list(writer.constants), np.float32 if single else np.float64)
        self._wide = np.array(list(writer.wide_constants), np.float64)
        self._engine = llvm.create_mcjit_compiler(module, machine)
        self._engine.finalize_object()
        self._call: Callable[..., float] = SIGNATURE(self._engine.get_function_address("kernel"))
        self._gather: Callable[..., float] = SIGNATURE(self._engine.get_function_address("gather"))

    def __call__(self, q: np.ndarray, out: np.ndarray) -> float:
        """Compute `out` (outputs, N) at `q` (inputs, N), any strides in q; rows of `out` without gaps.

        Returns:
            The largest sum of |q| of any pose: beyond `sines.FARTHEST` the sines may be wrong.
        """
        N = q.shape[1]
        whole = N - N % self.lanes
        far = self._run(q, out, whole) if whole else 0.0
        if whole == N:
            return far
        rest, result = np.zeros((len(q), self.lanes), q.dtype), np.empty((len(out), self.lanes), q.dtype)
        rest[:, : N - whole] = q[:, whole:]
        far = max(far, self._run(rest, result, self.lanes))
        out[:, whole:] = result[:, : N - whole]
        return far

    def _run(self, q: np.ndarray, out: np.ndarray, N: int) -> float:
        size = q.itemsize
        rows, poses = (stride // size for stride in q.strides)
        call = self._call if poses == 1 else self._gather
        output = (out.ctypes.data, out.strides[0] // size, N)
        return call(q.ctypes.data, rows, poses, *output, self._constants.ctypes.data, self._wide.ctypes.data)


class _Writer:
    """LLVM's assembly language, one pose a lane."""

    def __init__(self, program: Program, lanes: int, single: bool) -> None:
        self.program, self.lanes, self.single = program, lanes, single
        self.scalar = "float" if single else "double"
        self.real, self.wide, self.whole = f"<{lanes} x {self.scalar}>", f"<{lanes} x double>", f"<{lanes} x i64>"
        self.lines: list[str] = []
        self.count = 0
        self.constants: dict[float, int] = {}  # value -> place in the table
        self.wide_constants: dict[float, int] = {}  # the same of double precision, where the rest is single

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
        yield f"define double @{name}(ptr noalias %q, i64 %qrow, i64 %qpose, "
        yield "  ptr %out, i64 %outrow, i64 %n, ptr %k, ptr %w) {"
        yield "entry:\n  %any = icmp sgt i64 %n, 0\n  br i1 %any, label %loop, label %done"
        yield "loop:"
        yield "  %i = phi i64 [0, %entry], [%next, %loop]"
        yield f"  %far = phi {self.real} [zeroinitializer, %entry], [%farther, %loop]"
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
        wide = wide and self.single
        table = self.wide_constants if wide else self.constants
        at = table.setdefault(float(x), len(table))
        scalar, real = ("double", self.wide) if wide else (self.scalar, self.real)
        pointer = self._new(f"getelementptr {scalar}, ptr {'%w' if wide else '%k'}, i64 {at}")
        value = self._new(f"load {scalar}, ptr {pointer}")
        one = self._new(f"insertelement {real} poison, {scalar} {value}, i64 0")
        return self._new(f"shufflevector {real} {one}, {real} poison, <{self.lanes} x i32> zeroinitializer")

    def _fma(self, a: str, b: str, c: str, wide: bool = False) -> str:
        real = self.wide if wide else self.real
        bits = 64 if wide or not self.single else 32
        return self._new(f"call {real} @llvm.fmuladd.v{self.lanes}f{bits}({real} {a}, {real} {b}, {real} {c})")

    def _load(self, row: int, gather: bool) -> str:
        base = self._new(f"mul i64 %qrow, {row}")
        if not gather:
            at = self._new(f"add i64 {base}, %i")
            pointer = self._new(f"getelementptr {self.scalar}, ptr %q, i64 {at}")
            self._ahead(pointer, 0)
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

    def _ahead(self, pointer: str, write: int) -> None:
        """Fetch what comes later: many rows are more streams than processors foresee."""
        ahead = max(2, min(16, AHEAD // (self.program.inputs + len(self.program.outputs))))
        later = self._new(f"getelementptr {self.real}, ptr {pointer}, i64 {ahead}")
        self.lines.append(f"  call void @llvm.prefetch.p0(ptr {later}, i32 {write}, i32 3, i32 1)")

    def _body(self, gather: bool) -> None:
        program = self.program
        rows = [self._load(row, gather) for row in range(program.inputs)]
        size = "zeroinitializer"
        for q in rows:
            kind = f"v{self.lanes}f{32 if self.single else 64}"
            size = self._new(
                f"fadd {self.real} {size}, {self._new(f'call {self.real} @llvm.fabs.{kind}({self.real} {q})')}"
            )
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
            self._ahead(pointer, 1)
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

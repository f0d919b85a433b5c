"""A program as a module in LLVM's assembly language."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from . import trace
from .lanes import Lanes
from .trace import Program

Form = Literal["rows", "gathered", "streamed"]
"""How poses come and go: the values of each coordinate next to each other; anywhere; next to each other, with results
that go past the caches and begin at multiples of a vector's size."""
AHEAD = 256  # vectors that are fetched before their turn, all rows together: a third of the first cache
PARAMETERS = "ptr noalias %q, i64 %qrow, i64 %qpose, ptr %out, i64 %outrow, i64 %n, ptr %k, ptr %w"


class KernelModule:
    """The module of a program.

    Its function `kernel` takes the `PARAMETERS`: inputs with the steps between their rows and between poses; outputs
    with the step between their rows; the number of poses, whole vectors and not zero; both tables of constants. It
    returns the largest sum of |input| of any pose.

    Attributes:
        text: the module.
        constants, wide_constants: the tables, see `Lanes`.
    """

    def __init__(self, program: Program, lanes: int, single: bool, form: Form) -> None:
        self.program, self.form = program, form
        self.lanes = Lanes(lanes, single)
        self._body()
        self.text = "\n".join([*self.lanes.declarations(), *self._kernel(self.lanes.lines), "!0 = !{i32 1}"])
        self.constants, self.wide_constants = list(self.lanes.constants), list(self.lanes.wide_constants)

    def _kernel(self, body: list[str]) -> Iterator[str]:
        lanes = self.lanes
        # vectors kept on a stack that is not aligned to them would lie across two lines of the cache
        yield f"define double @kernel({PARAMETERS}) alignstack({lanes.bytes * lanes.lanes}) {{"
        yield "entry:\n  br label %loop"
        yield "loop:"
        yield "  %i = phi i64 [0, %entry], [%next, %loop]"
        yield f"  %far = phi {lanes.real} [zeroinitializer, %entry], [%farther, %loop]"
        yield from body
        yield f"  %next = add i64 %i, {lanes.lanes}"
        yield "  %more = icmp slt i64 %next, %n\n  br i1 %more, label %loop, label %end"
        yield "end:"
        yield f"  %most = call {lanes.scalar} @llvm.vector.reduce.fmax.{lanes.kind}({lanes.real} %farther)"
        yield "  %found = fpext float %most to double" if lanes.single else "  %found = fadd double %most, 0.0"
        yield "  ret double %found\n}"

    def _body(self) -> None:
        """A vector of poses."""
        lanes, program = self.lanes, self.program
        rows = [self._input(row) for row in range(program.inputs)]
        size = "zeroinitializer"
        for q in rows:
            distance = lanes.new(f"call {lanes.real} @llvm.fabs.{lanes.kind}({lanes.real} {q})")
            size = lanes.new(f"fadd {lanes.real} {size}, {distance}")
        beyond = lanes.new(f"fcmp ogt {lanes.real} {size}, %far")
        lanes.lines.append(f"  %farther = select <{lanes.lanes} x i1> {beyond}, {lanes.real} {size}, {lanes.real} %far")
        nothing = lanes.new(f"fmul {lanes.real} {size}, zeroinitializer")  # NaN where the input is no finite number
        register = [""] * program.registers
        columns = (program.code, program.to, program.a, program.b, program.c, program.k, program.m)
        for code, to, a, b, c, k, m in zip(*(column.tolist() for column in columns), strict=True):
            match code:
                case trace.INPUT:
                    register[to] = rows[int(k)]
                case trace.SINCOS:
                    register[to], register[b] = lanes.sincos(register[a])
                case _:
                    register[to] = lanes.operation(code, register[a], register[b], register[c], k, m)
        for row, (from_, sign) in enumerate(zip(program.outputs.tolist(), program.sign.tolist(), strict=True)):
            if from_ < 0:
                value = lanes.new(f"fadd {lanes.real} {nothing}, {lanes.splat(sign)}")
            else:
                value = lanes.new(f"{'fadd' if sign > 0 else 'fsub'} {lanes.real} {nothing}, {register[from_]}")
            self._output(row, value)

    def _input(self, row: int) -> str:
        lanes = self.lanes
        if self.form == "gathered":
            return lanes.gather("%q", "%qrow", row, "%qpose", "%i")
        pointer = lanes.at("%q", "%qrow", row, "%i")
        lanes.prefetch(pointer, self._ahead, write=False)
        return lanes.load(pointer)

    def _output(self, row: int, value: str) -> None:
        past_caches = self.form == "streamed"
        pointer = self.lanes.at("%out", "%outrow", row, "%i")
        if not past_caches:
            self.lanes.prefetch(pointer, self._ahead, write=True)
        self.lanes.store(value, pointer, past_caches)

    @property
    def _ahead(self) -> int:
        """Vectors: many rows are more streams than processors foresee."""
        return max(2, min(16, AHEAD // (self.program.inputs + len(self.program.outputs))))

"""The same job in C: the cheapest program of the mechanism as vector code, compiled by the machine's own compiler."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from equipoise.energy.kernel import sines
from equipoise.energy.kernel.trace import INPUT, MEANING, SHARE, SINCOS, SQRT, Program

FLAGS = (
    "-O3",
    "-march=native",
    "-mprefer-vector-width=512",
    "-ffp-contract=fast",
    "-fno-math-errno",
    "-shared",
    "-fPIC",
)
HEAD = """
#include <stdint.h>
#include <string.h>
#define LANES 8
typedef double v __attribute__((vector_size(8 * LANES)));
typedef int64_t w __attribute__((vector_size(8 * LANES)));
static inline void sincos_(v x, v *s, v *c) {
  v t = x * INVERSE_PI + ROUND, k = t - ROUND;
  v r = (x - k * PI_HIGH) - k * PI_LOW, z = r * r;
  w flip = (w)t << 63;
  v P = SIN_POLYNOMIAL, Q = COS_POLYNOMIAL;
  *s = (v)((w)(r + r * z * P) ^ flip);
  *c = (v)((w)(1.0 + z * Q) ^ flip);
}
void kernel(const double *restrict q, double *restrict out, int64_t stride_q, int64_t stride_out, int64_t N) {
  for (int64_t i = 0; i < N; i += LANES) {
"""


def source(program: Program) -> str:
    """The C code of a program of zero-free-length springs."""
    text = HEAD
    for name, coefficients in (("SIN", sines.SIN), ("COS", sines.COS)):
        horner = repr(coefficients[-1])
        for coefficient in reversed(coefficients[:-1]):
            horner = f"({horner} * z + {coefficient!r})"
        text = text.replace(f"{name}_POLYNOMIAL", horner)
    for name in ("INVERSE_PI", "PI_HIGH", "PI_LOW", "ROUND"):
        text = text.replace(name, repr(getattr(sines, name)))
    lines = []
    register = [""] * program.registers
    columns = (program.code, program.to, program.a, program.b, program.c, program.k, program.m)
    for n, (code, to, a, b, c, k, m) in enumerate(zip(*(column.tolist() for column in columns), strict=True)):
        if code in (SQRT, SHARE):
            raise NotImplementedError("free lengths")
        if code == INPUT:
            lines.append(f"v x{n}; memcpy(&x{n}, q + {int(k)} * stride_q + i, sizeof(v));")
        elif code == SINCOS:
            lines.append(f"v x{n}, y{n}; sincos_({register[a]}, &x{n}, &y{n});")
            register[b] = f"y{n}"
        else:
            values = {"a": register[a], "b": register[b], "c": register[c], "k": repr(k), "m": repr(m)}
            lines.append(f"v x{n} = {''.join(values.get(letter, letter) for letter in MEANING[code])};")
        register[to] = f"x{n}"
    for row, (from_, sign) in enumerate(zip(program.outputs.tolist(), program.sign.tolist(), strict=True)):
        value = f"(v){{}} + {sign!r}" if from_ < 0 else f"{'-' if sign < 0 else ''}{register[from_]}"
        lines.append(f"v o{row} = {value}; memcpy(out + {row} * stride_out + i, &o{row}, sizeof(v));")
    return text + "\n    ".join(lines) + "\n  }\n}\n"


def compiled(program: Program) -> Callable[[np.ndarray, np.ndarray], None] | None:
    """A function of q (inputs, N) and out (outputs, N), N a multiple of 8; None where there is no compiler."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        return None
    with tempfile.TemporaryDirectory() as directory:
        code, library = Path(directory) / "kernel.c", Path(directory) / "kernel.so"
        code.write_text(source(program))
        subprocess.run([compiler, *FLAGS, str(code), "-o", str(library)], check=True)
        function = ctypes.CDLL(str(library)).kernel
    function.argtypes = [ctypes.c_void_p] * 2 + [ctypes.c_int64] * 3
    function.restype = None

    def run(q: np.ndarray, out: np.ndarray) -> None:
        function(q.ctypes.data, out.ctypes.data, q.strides[0] // 8, out.strides[0] // 8, q.shape[1])

    return run

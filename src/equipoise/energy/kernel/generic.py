"""One compiled kernel for every mechanism: an interpreter of programs that works on a block of poses at a time.

numba compiles it once and keeps it on disk; where no directory is writable it is compiled anew in each process. It is
never compiled with `parallel`: threads take blocks of poses instead, so there is one kernel, and one file of it.
"""

from __future__ import annotations

import numpy as np

from ...model.compiled import Compiled
from . import sines, trace
from .trace import ADD, ADDK, FMA, FMAK, FMAM, FMS, FMSK, FNM, INPUT, MUL, MULK, SHARE, SINCOS, SQRT, SUB, Program

LANES = 128  # poses in a block: their registers stay in the second cache, most of them in the first


def run(program: Program, q: np.ndarray, out: np.ndarray) -> float:
    """Compute `out` (outputs, N) at `q` (inputs, N), any strides, both double or both single; holds no lock.

    Returns:
        The largest sum of |q| of any pose: beyond `sines.FARTHEST` the sines may be wrong.
    """
    registers = np.empty((program.registers, LANES), out.dtype)
    p = program
    return _compiled(p.code, p.to, p.a, p.b, p.c, p.k, p.m, p.outputs, p.sign, q, registers, out)


def interpret(code, to, a, b, c, k, m, outputs, sign, q, registers, out):
    """Run a program; see `run`. Compiled by numba: every inner loop is one vector instruction over the lanes."""
    lanes = registers.shape[1]
    N = q.shape[1]
    far = 0.0
    size = np.empty(lanes, registers.dtype)
    for start in range(0, N, lanes):
        width = min(lanes, N - start)
        size[:] = 0.0
        for i in range(len(code)):
            op = code[i]
            y, x, v, w = registers[to[i]], registers[a[i]], registers[b[i]], registers[c[i]]
            K, M = registers.dtype.type(k[i]), registers.dtype.type(m[i])
            if op == FMA:
                for j in range(lanes):
                    y[j] = x[j] * v[j] + w[j]
            elif op == FMAK:
                for j in range(lanes):
                    y[j] = x[j] * K + w[j]
            elif op == FNM:
                for j in range(lanes):
                    y[j] = w[j] - x[j] * v[j]
            elif op == MUL:
                for j in range(lanes):
                    y[j] = x[j] * v[j]
            elif op == ADD:
                for j in range(lanes):
                    y[j] = x[j] + v[j]
            elif op == SUB:
                for j in range(lanes):
                    y[j] = x[j] - v[j]
            elif op == MULK:
                for j in range(lanes):
                    y[j] = x[j] * K
            elif op == ADDK:
                for j in range(lanes):
                    y[j] = x[j] + K
            elif op == FMS:
                for j in range(lanes):
                    y[j] = x[j] * v[j] - w[j]
            elif op == FMSK:
                for j in range(lanes):
                    y[j] = x[j] * K - w[j]
            elif op == FMAM:
                for j in range(lanes):
                    y[j] = x[j] * K + M
            elif op == INPUT:
                row = int(k[i])
                for j in range(width):
                    y[j] = q[row, start + j]
                    size[j] += abs(y[j])
                for j in range(width, lanes):
                    y[j] = 0.0
            elif op == SINCOS:
                for j in range(lanes):
                    angle = np.float64(x[j])
                    turns = (angle * sines.INVERSE_PI + sines.ROUND) - sines.ROUND
                    odd = turns - 2.0 * ((turns * 0.5 + sines.ROUND) - sines.ROUND)  # -1, 0 or 1
                    flip = 1.0 - 2.0 * odd * odd
                    r = (angle - turns * sines.PI_HIGH) - turns * sines.PI_LOW
                    z = r * r
                    s = sines.SIN[6]
                    for n in range(5, -1, -1):
                        s = s * z + sines.SIN[n]
                    t = sines.COS[7]
                    for n in range(6, -1, -1):
                        t = t * z + sines.COS[n]
                    y[j] = flip * (r + r * z * s)
                    v[j] = flip * (1.0 + z * t)
            elif op == SQRT:
                for j in range(lanes):
                    y[j] = np.sqrt(x[j])
            elif op == SHARE:
                for j in range(lanes):
                    y[j] = 1 - K / x[j] if x[j] > 0 else 0.0
        for j in range(width):
            far = max(far, np.float64(size[j]))
            size[j] *= 0.0  # NaN where the input is no finite number
        for row in range(len(outputs)):
            if outputs[row] < 0:
                for j in range(width):
                    out[row, start + j] = sign[row] + size[j]
            else:
                y = registers[outputs[row]]
                for j in range(width):
                    out[row, start + j] = sign[row] * y[j] + size[j]
    return far


_compiled = Compiled(interpret, sines, trace)

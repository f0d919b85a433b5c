"""A program on numpy: one call for each operation and chunk of poses. Needs nothing compiled."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import trace
from .trace import Program

CHUNK = 4096  # poses: registers stay in the cache


def run(program: Program, q: NDArray[Any], out: NDArray[Any]) -> float:
    """Compute `out` (outputs, N) at `q` (inputs, N), any strides, and return 0: no pose is too far."""
    N = q.shape[1]
    registers = np.empty((program.registers + 1, min(N, CHUNK)), out.dtype)
    with np.errstate(all="ignore"):  # what is not a number comes from input that is not
        for start in range(0, N, CHUNK):
            part = q[:, start : start + CHUNK]
            r = registers[:, : part.shape[1]]
            _run(program, part, r)
            bad = ~np.isfinite(part).all(axis=0)
            for row, (register, sign) in enumerate(zip(program.outputs, program.sign, strict=True)):
                mine = out[row, start : start + CHUNK]
                if register < 0:
                    mine[:] = sign
                else:
                    np.multiply(r[register], sign, out=mine)
                mine[bad] = np.nan
    return 0.0


def _run(program: Program, q: NDArray[Any], r: NDArray[Any]) -> None:
    scratch = r[-1]
    columns = (program.code, program.to, program.a, program.b, program.c, program.k, program.m)
    for code, to, a, b, c, k, m in zip(*(column.tolist() for column in columns), strict=True):
        match code:
            case trace.ADD:
                np.add(r[a], r[b], out=r[to])
            case trace.SUB:
                np.subtract(r[a], r[b], out=r[to])
            case trace.MUL:
                np.multiply(r[a], r[b], out=r[to])
            case trace.ADDK:
                np.add(r[a], k, out=r[to])
            case trace.MULK:
                np.multiply(r[a], k, out=r[to])
            case trace.FMA:
                np.multiply(r[a], r[b], out=scratch)
                np.add(scratch, r[c], out=r[to])
            case trace.FMS:
                np.multiply(r[a], r[b], out=scratch)
                np.subtract(scratch, r[c], out=r[to])
            case trace.FNM:
                np.multiply(r[a], r[b], out=scratch)
                np.subtract(r[c], scratch, out=r[to])
            case trace.FMAK:
                np.multiply(r[a], k, out=scratch)
                np.add(scratch, r[c], out=r[to])
            case trace.FMSK:
                np.multiply(r[a], k, out=scratch)
                np.subtract(scratch, r[c], out=r[to])
            case trace.FMAM:
                np.multiply(r[a], k, out=scratch)
                np.add(scratch, m, out=r[to])
            case trace.SQRT:
                np.sqrt(r[a], out=r[to])
            case trace.SHARE:
                r[to] = np.where(r[a] > 0, 1 - k / r[a], 0.0)
            case trace.CLAMP:
                np.subtract(r[a], k, out=scratch)
                np.clip(scratch, 0.0, m, out=r[to])
            case trace.STEP:
                r[to] = r[a] > 0
            case trace.INVERSE:
                r[to] = np.where(r[a] > 0, 1 / r[a], 0.0)
            case trace.INPUT:
                r[to] = q[int(k)]
            case trace.SINCOS:
                np.sin(r[a], out=r[to])
                np.cos(r[a], out=r[b])

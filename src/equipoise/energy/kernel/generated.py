"""A kernel generated from the mechanism: its program as vector code of the machine at hand, through LLVM.

Compiled in about a tenth of a second; llvmlite comes with numba. Poses lie next to each other in memory.
"""

from __future__ import annotations

import ctypes
from functools import cache
from threading import Lock
from typing import TYPE_CHECKING

import numpy as np

from .assembly import Form, KernelModule
from .trace import Program

if TYPE_CHECKING:
    import llvmlite.binding as llvm

SIGNATURE = ctypes.CFUNCTYPE(
    ctypes.c_double, *(ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64) * 2, *(ctypes.c_void_p,) * 2
)


class Generated:
    """The compiled program; safe to call from several threads at once, and holds no lock.

    Attributes:
        lanes: poses computed at a time.
    """

    def __init__(self, program: Program, single: bool = False) -> None:
        self.program, self.single = program, single
        features = _features()
        bits = 512 if features.get("avx512f") else 256 if features.get("avx") else 128
        self.lanes = bits // (32 if single else 64)
        self._forms: dict[Form, _Compiled] = {}
        self._compiling = Lock()

    def __call__(self, q: np.ndarray, out: np.ndarray, streamed: bool = False) -> float:
        """Compute `out` (outputs, N) at `q` (inputs, N), any strides in q; rows of `out` without gaps.

        Args:
            streamed: nobody reads the result soon; what is computed goes past the caches where it is aligned.

        Returns:
            The largest sum of |q| of any pose: beyond `sines.FARTHEST` the sines may be wrong.
        """
        N = q.shape[1]
        whole = N - N % self.lanes
        far = self._run(q, out, whole, streamed) if whole else 0.0
        if whole == N:
            return far
        rest, result = np.zeros((len(q), self.lanes), q.dtype), np.empty((len(out), self.lanes), q.dtype)
        rest[:, : N - whole] = q[:, whole:]
        far = max(far, self._run(rest, result, self.lanes, False))
        out[:, whole:] = result[:, : N - whole]
        return far

    def _run(self, q: np.ndarray, out: np.ndarray, N: int, streamed: bool) -> float:
        vector = self.lanes * out.itemsize
        aligned = out.ctypes.data % vector == 0 and (out.strides[0] % vector == 0 or len(out) == 1)
        gathered = q.strides[1] != q.itemsize
        form: Form = "gathered" if gathered else "streamed" if streamed and aligned else "rows"
        with self._compiling:
            if form not in self._forms:
                self._forms[form] = _Compiled(KernelModule(self.program, self.lanes, self.single, form))
        return self._forms[form](q, out, N)


@cache
def _features() -> llvm.FeatureMap:
    """Of the processor; starts LLVM."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.get_host_cpu_features()


class _Compiled:
    """A module, compiled."""

    def __init__(self, code: KernelModule) -> None:
        import llvmlite.binding as llvm

        machine = llvm.Target.from_default_triple().create_target_machine(
            cpu=llvm.get_host_cpu_name(), features=_features().flatten(), opt=2
        )
        module = llvm.parse_assembly(code.text)
        module.triple, module.data_layout = llvm.get_default_triple(), str(machine.target_data)
        module.verify()
        options = llvm.create_pipeline_tuning_options(speed_level=1)
        options.loop_unrolling = options.loop_vectorization = options.slp_vectorization = False
        passes = llvm.create_pass_builder(machine, options)
        passes.getModulePassManager().run(module, passes)
        real = np.float32 if code.lanes.single else np.float64
        self._tables = np.array(code.constants, real), np.array(code.wide_constants, np.float64)
        self._engine = llvm.create_mcjit_compiler(module, machine)
        self._engine.finalize_object()
        self._call = SIGNATURE(self._engine.get_function_address("kernel"))

    def __call__(self, q: np.ndarray, out: np.ndarray, N: int) -> float:
        size = q.itemsize
        rows, poses = (stride // size for stride in q.strides)
        tables = (table.ctypes.data for table in self._tables)
        return self._call(q.ctypes.data, rows, poses, out.ctypes.data, out.strides[0] // size, N, *tables)

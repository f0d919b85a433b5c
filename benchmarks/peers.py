"""The same torques by other programs: each takes poses (N, n), and says first whether it agrees."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

import equipoise as eq
from equipoise.kinematics import Tree
from equipoise.model.rotation import to_quaternion

LEAN = """
typedef void (*call)(const void *, void *);
typedef void (*rne)(const void *, void *, int, double *);
void lean(call *calls, int count, rne mj_rne, const void *model, void *data, double *qpos, double *bias,
          const double *passive, const double *q, double *torque, long n, long N) {
  for (long i = 0; i < N; i++) {
    for (long j = 0; j < n; j++) qpos[j] = q[i * n + j];
    for (int c = 0; c < count; c++) calls[c](model, data);
    mj_rne(model, data, 0, bias);
    for (long j = 0; j < n; j++) torque[i * n + j] = bias[j] - passive[j];
  }
}
"""
CALLS = ("mj_kinematics", "mj_comPos", "mj_tendon", "mj_passive")


def pinocchio(urdf: Path, q: np.ndarray, threads: int) -> tuple[np.ndarray, Callable[[], object]]:
    """Gravity's torque (n, N) alone, batched over threads."""
    import pinocchio as pin

    model = pin.buildModelFromUrdf(str(urdf))
    pool = pin.ModelPool(model, threads)
    poses, nothing, torque = np.asfortranarray(q.T), np.zeros(q.T.shape, order="F"), np.zeros(q.T.shape, order="F")

    def run() -> object:
        return pin.rneaInParallel(threads, pool, poses, nothing, nothing, torque)

    run()
    return torque, run


def mujoco_lean(mechanism: eq.Mechanism, q: np.ndarray, threads: int) -> tuple[np.ndarray, Callable[[], object]]:
    """Gravity and springs as tendons, torque (N, n), by the library's own calls from a loop in C where there is a
    compiler, else from one in Python."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(mjcf(mechanism))
    datas = [mujoco.MjData(model) for _ in range(threads)]
    poses, torque = np.ascontiguousarray(q), np.zeros(q.shape)
    loop = _loop()

    def part(number: int) -> None:
        data = datas[number]
        mine = slice(number * len(q) // threads, (number + 1) * len(q) // threads)
        if loop is not None:
            library = ctypes.CDLL(str(next(Path(mujoco.__path__[0]).glob("libmujoco.*"))))
            *calls, rne = (ctypes.cast(getattr(library, name), ctypes.c_void_p).value for name in (*CALLS, "mj_rne"))
            loop((ctypes.c_void_p * len(calls))(*calls), len(calls), rne, model._address, data._address,
                 data.qpos.ctypes.data, data.qfrc_bias.ctypes.data, data.qfrc_passive.ctypes.data,
                 poses[mine].ctypes.data, torque[mine].ctypes.data, q.shape[1], len(poses[mine]))  # fmt: skip
            return
        functions = [getattr(mujoco, name) for name in CALLS]
        for i in range(mine.start, mine.stop):
            data.qpos[:] = poses[i]
            for function in functions:
                function(model, data)
            mujoco.mj_rne(model, data, 0, data.qfrc_bias)
            torque[i] = data.qfrc_bias - data.qfrc_passive

    def run() -> None:
        if threads == 1:
            part(0)
            return
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(part, range(threads)))

    run()
    return torque, run


def _loop() -> Callable[..., None] | None:
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        return None
    with tempfile.TemporaryDirectory() as directory:
        code, library = Path(directory) / "lean.c", Path(directory) / "lean.so"
        code.write_text(LEAN)
        subprocess.run([compiler, "-O3", "-shared", "-fPIC", str(code), "-o", str(library)], check=True)
        function = ctypes.CDLL(str(library)).lean
    pointer = ctypes.c_void_p
    function.argtypes = [pointer, ctypes.c_int, *[pointer] * 8, ctypes.c_long, ctypes.c_long]
    function.restype = None
    return function


def mjcf(m: eq.Mechanism) -> str:
    """A chain of revolute and fixed joints with zero-free-length springs as MuJoCo's model."""
    tree = Tree.of(m)
    children: dict[int, list[str]] = {}
    sites: dict[str, list[str]] = {name: [] for name in tree.names}
    tendons = []
    for i, spring in enumerate(m.springs):
        for end, body, p in (("a", spring.body_a, spring.p_a), ("b", spring.body_b, spring.p_b)):
            sites[body].append(f'<site name="{i}{end}" pos="{_text(p)}"/>')
        ends = f'<site site="{i}a"/><site site="{i}b"/>'
        tendons.append(f'<spatial stiffness="{spring.stiffness!r}" springlength="0 0">{ends}</spatial>')
    for link in reversed(tree.links):
        name = link.joint.child
        body = m.bodies[link.body - 1]
        inertial = f'<inertial mass="{max(body.mass, 1e-12)!r}" pos="{_text(body.com)}" diaginertia="1e-3 1e-3 1e-3"/>'
        motion = f'<joint axis="{_text(link.motions[0].axis)}"/>' if link.motions else ""
        inner = "".join(children.get(link.body, []))
        frame = f'pos="{_text(link.p0)}" quat="{_text(to_quaternion(link.R0))}"'
        text = f"<body name={quoteattr(name)} {frame}>{inertial}{motion}{''.join(sites[name])}{inner}</body>"
        children.setdefault(link.parent, []).insert(0, text)
    world = "".join(sites["world"]) + "".join(children[0])
    options = f'<compiler angle="radian" balanceinertia="true"/><option gravity="{_text(m.gravity)}"/>'
    return f"<mujoco>{options}<worldbody>{world}</worldbody><tendon>{''.join(tendons)}</tendon></mujoco>"


def _text(v: object) -> str:
    return " ".join(repr(float(x)) for x in np.asarray(v).ravel())

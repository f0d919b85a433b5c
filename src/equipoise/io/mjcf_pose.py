"""How the loops of an MJCF model are assembled and steered: in which pose, by which joints. See `mjcf_read`."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..model.arrays import Array, Integers
from ..model.mechanism import Mechanism
from ..model.rotation import ball_angles, from_quaternion
from . import mjcf
from .mjcf_acts import Model

CLOSED = 3e-3  # [m or rad] at most this is open in a pose that closes: keyframes are written with few digits
RANK = 1e-6  # of the largest singular value: a smaller one is redundancy
SHARE = 1e-3  # of a column: what it must add to those before it to be a direction of its own


def joint_values(kind: str, name: str, now: Array, zero: Array) -> dict[str, float]:
    """Our coordinates of a joint from the engine's, which begin with `now`, and with `zero` as the model is drawn."""
    if kind == "floating":
        R = from_quaternion(zero[3:7])
        slides = R.T @ (now[:3] - zero[:3])
        turn = ball_angles(R.T @ from_quaternion(now[3:7]))
        return {f"{name} {letter}": float(x) for letter, x in zip("xyz", slides, strict=True)} | _ball(name, turn)
    return _ball(name, ball_angles(from_quaternion(now[:4]))) if kind == "spherical" else {name: float(now[0])}


def _ball(name: str, angles: tuple[float, float, float]) -> dict[str, float]:
    return {f"{name}.{letter}": x for letter, x in zip("xyz", angles, strict=True)}


def assembly(source: Model) -> tuple[Array, Array]:
    """The pose (nq,) to assemble in, and the Jacobian (equations, nv) of all equalities there.

    The keyframe "assembled" if there is one; else, of the reference pose and the keyframes in their order, the first
    that closes without being singular, the first that closes, or the one that comes nearest.
    """
    mj, model = source.mj, source.model
    own = mj.mj_name2id(model, int(mj.mjtObj.mjOBJ_KEY), mjcf.ASSEMBLED)
    poses = [model.key_qpos[own]] if own >= 0 else [model.qpos0, *model.key_qpos]
    model.opt.jacobian = int(mj.mjtJacobian.mjJAC_DENSE)
    data, found = mj.MjData(model), []
    for i, pose in enumerate(poses):
        mj.mj_resetData(model, data)
        data.qpos[:] = pose
        mj.mj_fwdPosition(model, data)
        rows = data.efc_type == int(mj.mjtConstraint.mjCNSTR_EQUALITY)
        J = data.efc_J.reshape(data.nefc, model.nv)[rows].copy()
        gap = float(np.abs(data.efc_pos[rows]).max(initial=0))
        found.append(((gap > CLOSED, -_rank(J) if gap <= CLOSED else gap, i), np.array(pose), J))
    _, pose, J = min(found, key=lambda item: item[0])
    return pose, J


def independent(source: Model, found: Mechanism, joint_of: Mapping[int, str], J: Array) -> tuple[str, ...]:
    """The coordinates that steer: those of the custom text, else joints with an actuator where these determine all.

    Args:
        J: as `assembly` gives it.

    Returns:
        Nothing where there is no such choice: then the kinematics choose.
    """
    mj, model = source.mj, source.model
    for i in range(model.ntext):
        if mj.mj_id2name(model, int(mj.mjtObj.mjOBJ_TEXT), i) == mjcf.INDEPENDENT:
            first, size = int(model.text_adr[i]), int(model.text_size[i])
            return tuple(model.text_data[first : first + size].rstrip(b"\0").decode().split("\n"))
    own = (int(mj.mjtTrn.mjTRN_JOINT), int(mj.mjtTrn.mjTRN_JOINTINPARENT))
    driven = {int(joint) for joint, _ in model.actuator_trnid[np.isin(model.actuator_trntype, own)]}
    names = {int(model.jnt_dofadr[j]): joint_of[j] for j in driven if joint_of.get(j) in found.coordinates}
    others = [d for d in range(model.nv) if d not in names]
    rank = _rank(J)
    if not model.nv - rank <= len(names):
        return ()
    # the others depend as far as they can; then, of those with an actuator, as many as are too many
    basis = _directions(J, np.array(others, int), np.zeros((len(J), 0)), rank)
    left = set(range(model.nv)) - set(basis)
    more = _directions(J, np.array(sorted(left & set(names)), int), J[:, basis], rank - len(basis))
    left -= set(more)
    return (
        tuple(name for name in found.coordinates if name in {names.get(d) for d in left}) if left <= set(names) else ()
    )


def _directions(J: Array, columns: Integers, before: Array, most: int) -> list[int]:
    """At most so many of the columns, the one that adds most first, each of which adds a direction to those before."""
    Q = np.linalg.qr(before)[0] if before.shape[1] else before
    rest = J[:, columns] - Q @ (Q.T @ J[:, columns])
    size, found = np.linalg.norm(J, axis=0).max(initial=0), []
    while len(found) < min(most, len(columns)):
        norms = np.linalg.norm(rest, axis=0)
        best = int(norms.argmax())
        if norms[best] <= SHARE * size:
            break
        found.append(int(columns[best]))
        unit = rest[:, best] / norms[best]
        rest = rest - np.outer(unit, unit @ rest)
    return found


def _rank(J: Array) -> int:
    S = np.linalg.svd(J, compute_uv=False) if J.size else np.zeros(1)
    return int((RANK * S.max(initial=0) < S).sum())

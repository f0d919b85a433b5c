"""MJCF: MuJoCo compiles what is written, and agrees with the mechanism on poses, masses and energy."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np
import pytest
from in_mujoco import set_pose
from scipy.spatial.transform import Rotation
from slow_reference import SlowPoses, slow_poses

from equipoise.io import mjcf, urdf
from equipoise.model.elements import Spring
from equipoise.model.errors import EquipoiseWarning, UnsupportedError
from equipoise.model.mechanism import Body, Coupling, Joint, Loop, Mechanism, PointMass

ROBOTS = Path(__file__).parents[1] / "examples" / "robots"
NAMES = ("ur5", "ur10", "panda", "xarm7", "human")
TENSOR = (0.02, 0.03, 0.04, 0.001, -0.002, 0.003)


def robot(name: str) -> Mechanism:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EquipoiseWarning)  # test_urdf looks at these
        return urdf.read(ROBOTS / f"{name}.urdf")


def place(m: Mechanism, q: dict[str, float]) -> SlowPoses:
    """R_WB and p_WB of every body."""
    return slow_poses(m, np.array([q[name] for name in m.coordinates]))


def energy(m: Mechanism, poses: SlowPoses) -> float:
    """Gravity's and the springs' potential [J]."""

    def at(body: str, point: tuple[float, float, float]) -> np.ndarray:
        return poses[body][1] + poses[body][0] @ np.array(point)

    lumps = [(b.mass, at(b.name, b.com)) for b in m.bodies] + [(x.mass, at(x.body, x.position)) for x in m.masses]
    total = 0.0
    for s in m.springs:
        p_a, p_b = at(s.body_a, s.p_a), at(s.body_b, s.p_b)
        total += s.stiffness / 2 * (np.linalg.norm(p_b - p_a) - s.free_length) ** 2
        # an end on the world does not move: the simulator has no body for it
        lumps += [(s.mass * s.mass_split, p_a)] * (s.body_a != "world")
        lumps += [(s.mass * (1 - s.mass_split), p_b)] * (s.body_b != "world")
    return float(total - sum(mass * np.dot(m.gravity, p) for mass, p in lumps))


@pytest.fixture
def complaints() -> Iterator[list[str]]:
    """What MuJoCo warns of."""
    found: list[str] = []
    mujoco.set_mju_user_warning(found.append)
    yield found
    mujoco.set_mju_user_warning(None)


def check(m: Mechanism, model: mujoco.MjModel, poses: int = 5, loops: bool = False) -> None:
    rng = np.random.default_rng(7)
    for _ in range(poses):
        q: dict[str, float] = {name: float(rng.uniform(-2, 2)) for name in m.coordinates}
        expected = place(m, q)
        data = set_pose(m, model, q)
        for body in m.body_names:
            np.testing.assert_allclose(data.body(body).xpos, expected[body][1], atol=1e-12)
            np.testing.assert_allclose(data.body(body).xmat.reshape(3, 3), expected[body][0], atol=1e-12)
        mujoco.mj_energyPos(model, data)
        assert data.energy[0] == pytest.approx(energy(m, expected), abs=1e-10)
        if not loops:  # the coordinates satisfy every coupling
            assert np.abs(data.efc_pos[data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY]).max(initial=0) < 1e-12


@pytest.mark.parametrize("name", NAMES)
def test_robots(name: str, complaints: list[str]) -> None:
    m = robot(name)
    model = mujoco.MjModel.from_xml_string(mjcf.to_text(m))
    check(m, model)
    assert complaints == []
    for joint in m.joints:
        if joint.range is not None:
            assert model.joint(joint.name).limited == 1
            assert tuple(model.joint(joint.name).range) == joint.range


@pytest.mark.parametrize("name", NAMES)
def test_robots_agree_with_the_urdf_compiler_of_mujoco(name: str) -> None:
    m = robot(name)
    ours = mujoco.MjModel.from_xml_string(mjcf.to_text(m))
    options = "<mujoco><compiler fusestatic='false' boundmass='1e-13' boundinertia='1e-12'/></mujoco></robot>"
    text = (ROBOTS / f"{name}.urdf").read_text().replace("</robot>", options)
    theirs = mujoco.MjModel.from_xml_string(text[text.index("<robot") :])
    data = [mujoco.MjData(ours), mujoco.MjData(theirs)]
    rng = np.random.default_rng(3)
    for i in range(ours.njnt):
        joint = ours.joint(i).name
        data[0].joint(joint).qpos[:] = data[1].joint(joint).qpos[:] = rng.uniform(-2, 2)
    for model, d in zip((ours, theirs), data, strict=True):
        mujoco.mj_forward(model, d)
    names = {theirs.body(i).name for i in range(1, theirs.nbody)}
    assert names >= {joint.child for joint in m.joints if joint.parent != "world"}
    for body in names - {"world"}:
        a, b = ours.body(body), theirs.body(body)
        np.testing.assert_allclose(a.mass, b.mass, rtol=1e-14)
        np.testing.assert_allclose(data[0].body(body).xpos, data[1].body(body).xpos, atol=1e-12)
        np.testing.assert_allclose(np.sort(a.inertia), np.sort(b.inertia), rtol=1e-9)
        if a.mass > 1e-12:  # the centre of nothing may be anywhere
            np.testing.assert_allclose(data[0].body(body).xipos, data[1].body(body).xipos, atol=1e-12)
    for i in range(ours.njnt):
        a, b = ours.joint(i).dofadr[0], theirs.joint(ours.joint(i).name).dofadr[0]
        assert data[0].qfrc_bias[a] == pytest.approx(data[1].qfrc_bias[b], abs=1e-11)


def chain(*joints: Joint, **more: object) -> Mechanism:
    names = list(dict.fromkeys(joint.child for joint in joints))
    bodies = tuple(
        Body(name, 1.0 + i, (0.1 * i, 0.05, -0.02 * i), (0.02 + i, 0.03 + i, 0.04 + i, 0.001, -0.002, 0.003))
        for i, name in enumerate(names)
    )
    return Mechanism("m", bodies, joints, **more)  # type: ignore[arg-type]


SPHERICAL = chain(
    Joint("hip", "spherical", "world", "a", (0.1, 0.2, 0.3), (0.4, -0.5, 0.6)),
    Joint("knee", "spherical", "a", "b", (0, 0, -0.4), (0, 1.2, 0)),
    gravity=(1.0, -2.0, -9.0),
)
# the parent's and the followed body's chains both turn, share their first joint, slide, and are prerotated; a second
# parallelogram hangs on the first, so one path runs through `follows`
PARALLELOGRAM = chain(
    Joint("yaw", "revolute", "world", "base", (0, 0, 0.2), (0.1, 0.2, 0.3), (0, 0, 1), (-1, 2)),
    Joint("lower", "revolute", "base", "upper arm", (0.1, 0, 0), (0.5, 0, 0.2), (1, 2, 3)),
    Joint("upper", "revolute", "upper arm", "forearm", (0.3, 0.1, 0), (0, -0.7, 0), (0, -1, 0)),
    Joint("rail", "prismatic", "base", "slider", (0, 0.1, 0), (1, 1, 1), (1, 1, 0)),
    Joint("crank", "revolute", "slider", "disk", (0, 0, 0.1), (0, 0, 0.3), (0, 3, 4)),
    Joint("keep", "parallelogram", "forearm", "plate", (0.2, 0, 0.1), (0.3, 0.2, 0.1), follows="disk"),
    Joint("tilt", "revolute", "plate", "tool", (0.1, 0.1, 0), (0, 0, 1), (1, 0, 0)),
    Joint("level", "parallelogram", "tool", "tray", (0, 0, 0.2), (0, 0.4, 0), follows="world"),
    Joint("parent", "parallelogram", "tray", "copy", (0, 0.3, 0), (0.1, 0, 0), follows="tray"),
)
COUPLED = chain(
    Joint("gear 3", "revolute", "gear 2", "d", (0, 0, 0.1), (0.2, 0, 0), (0, 1, 0)),  # before those it depends on
    Joint("roll", "revolute", "world", "a", (0, 0, 1), axis=(1, 0, 0)),
    Joint("pitch", "revolute", "a", "b", (0, 0.1, 0), axis=(0, 1, 0)),
    Joint("gear", "revolute", "a", "c", (0.1, 0, 0), axis=(0, 1, 0)),
    Joint("gear 2", "prismatic", "c", "gear 2", axis=(0, 0, 2)),
    Joint("lock", "revolute", "b", "e", axis=(0, 0, 1)),
    couplings=(
        Coupling("gear 3", (("gear 2", 2.0), ("gear", -1.0)), 0.1),
        Coupling("gear", (("roll", -1.0), ("pitch", -1.5)), 0.2),
        Coupling("gear 2", (("gear", 0.5),), -0.3),
        Coupling("lock", (), 0.7),
    ),
)
SPRINGS = chain(
    Joint("shoulder", "revolute", "world", "arm", (0, 0, 0.5), axis=(0, 1, 0)),
    Joint("elbow", "revolute", "arm", "forearm", (0.4, 0, 0), axis=(0, 1, 0)),
    springs=(
        Spring("zero", "world", (0, 0, 0.9), "arm", (0.2, 0, 0), 500.0),
        Spring("long", "arm", (0, 0, 0.1), "forearm", (0.1, 0, 0.05), 300.0, 0.15, mass=0.4, mass_split=0.25),
        Spring("heavy", "world", (0, 0.1, 0), "forearm", (0.2, 0, 0), 50.0, 2.0, mass=0.3),
    ),
    masses=(PointMass("arm", "forearm", 0.7, (0.3, 0, 0.1)), PointMass("nothing", "arm", 0.0)),
)
HAND_MADE = {"spherical": SPHERICAL, "parallelogram": PARALLELOGRAM, "coupled": COUPLED, "springs": SPRINGS}


@pytest.mark.parametrize("m", HAND_MADE.values(), ids=HAND_MADE.keys())
def test_hand_made(m: Mechanism, complaints: list[str]) -> None:
    check(m, mujoco.MjModel.from_xml_string(mjcf.to_text(m)), poses=20)
    assert complaints == []


@pytest.mark.parametrize("m", HAND_MADE.values(), ids=HAND_MADE.keys())
def test_inertia_is_kept(m: Mechanism) -> None:
    model = mujoco.MjModel.from_xml_string(mjcf.to_text(m))
    for body in m.bodies:
        found = model.body(body.name)
        w, x, y, z = found.iquat
        R = Rotation.from_quat([x, y, z, w]).as_matrix()
        ixx, iyy, izz, ixy, ixz, iyz = body.inertia or (0.0,) * 6
        tensor = [[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]
        np.testing.assert_allclose(R @ np.diag(found.inertia) @ R.T, tensor, atol=1e-12)


def test_torques_are_the_gradient_of_the_energy() -> None:
    """In the motion that the equalities allow, MuJoCo's gravity and spring forces are minus dU/dq."""
    for m in (SPRINGS, robot("ur5")):
        model = mujoco.MjModel.from_xml_string(mjcf.to_text(m))
        q: dict[str, float] = {name: 0.3 + 0.1 * i for i, name in enumerate(m.coordinates)}
        data = set_pose(m, model, q)
        mujoco.mj_forward(model, data)
        for name in m.coordinates:
            up, down = ({**q, name: q[name] + step} for step in (1e-5, -1e-5))
            slope = (energy(m, place(m, up)) - energy(m, place(m, down))) / 2e-5
            dof = model.joint(name).dofadr[0]
            assert data.qfrc_bias[dof] - data.qfrc_passive[dof] == pytest.approx(slope, abs=1e-6)


def test_joint_map() -> None:
    found = mjcf.joint_map(COUPLED)
    assert found["pitch"] == mjcf.JointValue("hinge", (("pitch", 1.0),), 0.0)
    assert found["gear"] == mjcf.JointValue("hinge", (("roll", -1.0), ("pitch", -1.5)), 0.2)
    assert found["gear 2"] == mjcf.JointValue("slide", (("roll", -0.5), ("pitch", -0.75)), -0.3 + 0.5 * 0.2)
    assert found["gear 3"] == mjcf.JointValue(
        "hinge", (("roll", 0.0), ("pitch", 0.0)), 0.1 + 2 * (-0.3 + 0.5 * 0.2) - 0.2
    )
    assert found["lock"] == mjcf.JointValue("hinge", (), 0.7)
    assert mjcf.joint_map(SPHERICAL)["knee"] == mjcf.JointValue(
        "ball", (("knee.x", 1.0), ("knee.y", 1.0), ("knee.z", 1.0))
    )
    replicas = [name for name in mjcf.joint_map(PARALLELOGRAM) if name.startswith("keep.")]
    assert replicas == ["keep.upper", "keep.lower", "keep.crank"]  # yaw carries both, rail does not turn


@pytest.mark.parametrize("m", [COUPLED, PARALLELOGRAM])
def test_every_dependent_joint_is_held(m: Mechanism) -> None:
    model = mujoco.MjModel.from_xml_string(mjcf.to_text(m))
    joints = mjcf.joint_map(m)
    assert model.neq == len(joints) - len(m.coordinates)
    for moved in joints.keys() - set(m.coordinates):
        data = set_pose(m, model, dict.fromkeys(m.coordinates, 0.4))
        data.joint(moved).qpos[:] += 0.25
        mujoco.mj_fwdPosition(model, data)
        # its own equality sees it, and so do those that depend on it
        assert np.sort(np.abs(data.efc_pos[: model.neq]))[-1] >= 0.1


def test_a_ball_on_a_parallelogram_path_is_refused() -> None:
    m = chain(
        Joint("ball", "spherical", "world", "a"),
        Joint("keep", "parallelogram", "a", "b", follows="world"),
    )
    for function in (mjcf.to_text, mjcf.joint_map):
        with pytest.raises(UnsupportedError, match="parallelogram joint 'keep': the spherical joint 'ball'"):
            function(m)
    above = chain(
        Joint("ball", "spherical", "world", "a"),
        Joint("hinge", "revolute", "a", "b", (0.1, 0, 0)),
        Joint("keep", "parallelogram", "b", "c", (0.1, 0, 0), follows="a"),
    )
    check(above, mujoco.MjModel.from_xml_string(mjcf.to_text(above)))  # a ball that carries both is none of its path


FOUR_BAR = (
    Joint("left", "revolute", "world", "a", (0, 0, 0), axis=(0, 1, 0)),
    Joint("top", "revolute", "a", "b", (0, 0, 0.5), axis=(0, 1, 0)),
    Joint("right", "revolute", "world", "c", (0.4, 0, 0), axis=(0, 1, 0)),
)


@pytest.mark.parametrize("hinge", [False, True])
def test_loops(hinge: bool) -> None:
    axes = {"axis_a": (0.0, 1.0, 0.0), "axis_b": (0.0, 2.0, 0.0)} if hinge else {}
    m = chain(*FOUR_BAR, loops=(Loop("b", (0.4, 0, 0), "c", (0, 0, 0.5), **axes),))
    model = mujoco.MjModel.from_xml_string(mjcf.to_text(m))
    assert model.neq == (2 if hinge else 1)
    check(m, model, loops=True)
    closed = set_pose(m, model, {"left": 0.6, "top": -0.6, "right": 0.6})  # a parallelogram closes at any angle
    assert np.abs(closed.efc_pos[: 3 * model.neq]).max() < 1e-12
    open_ = set_pose(m, model, {"left": 0.6, "top": 0.0, "right": 0.6})
    assert np.abs(open_.efc_pos[: 3 * model.neq]).max() > 0.1


def test_a_locked_joint_is_held() -> None:
    m = chain(Joint("j", "revolute", "world", "a", range=(0.3, 0.3)))
    model = mujoco.MjModel.from_xml_string(mjcf.to_text(m))
    assert set_pose(m, model, {"j": 0.3}).efc_pos[0] == pytest.approx(0)
    assert set_pose(m, model, {"j": 0.5}).efc_pos[0] == pytest.approx(0.2)


def test_unknown_and_impossible_inertias_are_replaced_with_a_warning() -> None:
    bodies = (
        Body("a", 2),
        Body("b", 3),
        Body("c", 1, inertia=(1, 1, 4, 0, 0, 0)),
        Body("d", 1, inertia=(2, 1, 1, 0, 0, 0)),
    )
    joints = tuple(Joint(f"j{b.name}", "revolute", "world", b.name, (0, 0, 1), axis=(0, 1, 0)) for b in bodies)
    with (
        pytest.warns(EquipoiseWarning, match=r"bodies 'a', 'b': unknown inertia.*0\.05 m"),
        pytest.warns(EquipoiseWarning, match="bodies 'c': impossible inertia"),
    ):
        text = mjcf.to_text(Mechanism("m", bodies, joints))
    model = mujoco.MjModel.from_xml_string(text)
    np.testing.assert_allclose(model.body("a").inertia, 0.4 * 2 * 0.05**2, rtol=1e-14)
    np.testing.assert_allclose(model.body("c").inertia, 2, rtol=1e-14)
    np.testing.assert_allclose(np.sort(model.body("d").inertia), [1, 1, 2], rtol=1e-14)  # a plate, but for rounding


def test_massless_moving_bodies_compile_and_weigh_nothing() -> None:
    joints = [Joint(f"j{i}", "revolute", f"b{i}", f"b{i + 1}", (0.3, 0, 0), axis=(0, 1, 0)) for i in range(20)]
    joints[0] = Joint("j0", "revolute", "world", "b1", axis=(0, 1, 0))
    m = Mechanism("m", tuple(Body(f"b{i + 1}") for i in range(20)), tuple(joints), masses=(PointMass("end", "b20", 1),))
    check(m, mujoco.MjModel.from_xml_string(mjcf.to_text(m)))


def test_any_name_is_written() -> None:
    name = "a/b \"c\" <d> & é\\ [2]: 'x'"
    m = Mechanism(
        name,
        (Body(name, 1, inertia=TENSOR), Body("b", 1, inertia=TENSOR), Body("c", 1, inertia=TENSOR)),
        (
            Joint("j", "revolute", "world", name),
            Joint("keep.j", "revolute", name, "b"),
            Joint("keep", "parallelogram", name, "c", follows="world"),
        ),
        springs=(Spring(name, "world", (0, 0, 0), name, (1, 0, 0), 1),),
        masses=(PointMass(name, name, 1), PointMass("world", name, 1)),
    )
    model = mujoco.MjModel.from_xml_string(mjcf.to_text(m))
    check(m, model)
    assert {"world", name, "b", "c", f"{name}_2", "world_2"} == {model.body(i).name for i in range(model.nbody)}
    assert list(mjcf.joint_map(m)) == ["j", "keep.j", "keep.j_2"]  # a replica never takes the name of a joint


def test_too_deep_a_chain_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("equipoise.model.validate.LARGEST_COUNTS", {})  # as if a mechanism might have so many
    joints = tuple(Joint(f"j{i}", "revolute", f"b{i - 1}" if i else "world", f"b{i}") for i in range(2000))
    m = Mechanism("m", tuple(Body(f"b{i}", 1, inertia=TENSOR) for i in range(2000)), joints)
    with pytest.raises(UnsupportedError, match="more than 400 bodies"):
        mjcf.to_text(m)
    deepest = Mechanism("m", m.bodies[:400], m.joints[:400])
    assert mujoco.MjModel.from_xml_string(mjcf.to_text(deepest)).nbody == 401

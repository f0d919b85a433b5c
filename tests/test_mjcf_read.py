"""Reading MJCF: what is written is read back, and what the engine's compiler makes of a file is what counts."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from campaign import campaign
from engine import Engine
from loop_zoo import delta, four_bar, spatial_parallelogram
from random_mechanisms import random_mechanism, random_poses
from zoo import ZOO, exact_pendulum

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.io import mjcf
from equipoise.kinematics import Tree
from equipoise.kinematics.linkage import Linkage
from equipoise.kinematics.sampling import sample
from equipoise.model.errors import EquipoiseWarning, InputError, UnsupportedError
from equipoise.model.mechanism import Capsule
from equipoise.report.export import assembled

EXAMPLES = Path(__file__).parents[1] / "examples" / "mechanisms"


def back(m: eq.Mechanism, folder: Path) -> eq.Mechanism:
    """Written and read."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EquipoiseWarning)
        (folder / "model.xml").write_text(mjcf.to_text(*assembled(m)))
    return eq.load(folder / "model.xml")


def assert_same(m: eq.Mechanism, n: eq.Mechanism) -> None:
    """The same coordinates, energies up to a constant, and torques; and the same springs."""
    a, b = Tree.of(m), Tree.of(n)
    assert set(a.coordinates) == set(b.coordinates)
    q = sample(a, 20, 1) if m.loops else random_poses(m, 20, 1)
    order = [a.coordinates.index(name) for name in b.coordinates]
    inverse = np.argsort(order)
    before, after = Potential(m)(q), Potential(n)(q[:, order])
    size = max(1e-3, float(np.abs(before.gravity_torque).max(initial=0)), float(np.abs(before.springs).max(initial=0)))
    np.testing.assert_allclose(after.torque[:, inverse], before.torque, atol=1e-9 * size)
    np.testing.assert_allclose(after.gravity_torque[:, inverse], before.gravity_torque, atol=1e-9 * size)
    assert np.ptp(after.energy - before.energy) < 1e-9 * size
    assert [s.name for s in n.springs] == [s.name for s in m.springs]
    for found, spring in zip(n.springs, m.springs, strict=True):
        assert (found.stiffness, found.free_length) == pytest.approx((spring.stiffness, spring.free_length), rel=1e-12)


@pytest.mark.parametrize("name", ZOO)
def test_the_zoo_round_trip(name, tmp_path):
    m = ZOO[name]().mechanism
    assert_same(m, back(m, tmp_path))


@pytest.mark.parametrize("m", [four_bar(), delta(), spatial_parallelogram()], ids=["four-bar", "delta", "spatial"])
def test_loops_round_trip(m, tmp_path):
    n = back(m, tmp_path)
    assert len(n.loops) == len(m.loops)
    assert all((loop.axis_a is None) == (known.axis_a is None) for loop, known in zip(n.loops, m.loops, strict=True))
    assert n.independent == Tree.of(m).coordinates
    tree = Tree.of(m)
    assert isinstance(tree, Linkage)
    assert dict(n.assembly) == pytest.approx(dict(zip(m.coordinates, tree.branch.assembled, strict=True)), abs=1e-12)
    assert_same(m, n)


@pytest.mark.parametrize("name", ["four_bar", "hexapod", "rssr", "delta_balanced", "lin2010_rssr"])
def test_the_keyframe_is_assembled(name):
    """What the engine's own viewer opens: at its keyframe the loops are closed, and the model is drawn."""
    m = eq.load(EXAMPLES / f"{name}.yaml")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EquipoiseWarning)
        model = mujoco.MjModel.from_xml_string(mjcf.to_text(*assembled(m)))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, mjcf.ASSEMBLED))
    mujoco.mj_forward(model, data)
    held = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    assert held.sum() >= 3 * len(m.loops)
    assert np.abs(data.efc_pos[held]).max() < 1e-9
    assert model.ngeom > 0
    assert data.ncon == 0
    mujoco.mj_step(model, data, 50)  # and it does not burst
    assert not any(warning.number for warning in data.warning)


def test_friction_damping_and_capsules_round_trip(tmp_path):
    m = exact_pendulum().mechanism
    joints = tuple(replace(joint, damping=0.3, friction=0.2) for joint in m.joints)
    capsules = (
        Capsule("rod", "arm", (0.1, 0.0, 0.02), (0.4, 0.05, 0.0), 0.03),
        Capsule("ball", "arm", (0.5, 0.0, 0.0), (0.5, 0.0, 0.0), 0.06),
    )
    m = replace(m, joints=joints, capsules=capsules)
    n = back(m, tmp_path)
    assert n.joints == m.joints
    for found, known in zip(n.capsules, capsules, strict=True):
        assert (found.name, found.body) == (known.name, known.body)
        np.testing.assert_allclose(
            [*found.p_a, *found.p_b, found.radius], [*known.p_a, *known.p_b, known.radius], atol=1e-15
        )


@campaign(1_000)
def test_random_mechanisms_round_trip(tmp_path, seeds):
    done = 0
    for seed in seeds:
        m = random_mechanism(seed)
        try:
            n = back(m, tmp_path)
        except UnsupportedError:
            continue  # a ball joint between what a parallelogram joins and what it follows
        done += 1
        assert_same(m, n)
    assert done >= 0.8 * len(seeds)


def test_an_equal_mechanism_where_nothing_is_lost(tmp_path):
    m = exact_pendulum().mechanism
    m = replace(m, bodies=tuple(replace(b, inertia=(0.02, 0.02, 0.03, 0.001, 0.002, 0.003)) for b in m.bodies))
    n = back(m, tmp_path)
    assert (n.name, n.joints, n.springs, n.gravity) == (m.name, m.joints, m.springs, m.gravity)
    assert n.bodies[0].inertia == pytest.approx(m.bodies[0].inertia, rel=1e-9)


# The engine's own defaults ------------------------------------------------------------------------------------------


ONE_KG = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'


def read(tmp_path: Path, inside: str, more: str = "", world: str = "") -> eq.Mechanism:
    """A model with an arm of 2 kg on a hinge, `inside` the arm, `more` after the world's bodies."""
    path = tmp_path / "robot.xml"
    path.write_text(
        f"""<?xml version="1.0"?>
        <!-- <robot> is elsewhere -->
        <mujoco model="arm"><default><joint axis="0 -1 0"/></default><worldbody>
        <site name="hook" pos="0 0 0.2"/>{world}
        <body name="arm"><joint name="shoulder"/><inertial pos="0.3 0 0" mass="2" diaginertia="0.01 0.01 0.01"/>
        <site name="end" pos="0.15 0 0"/>{inside}</body></worldbody>{more}</mujoco>"""
    )
    return eq.load(path)


def spring(attributes: str) -> str:
    return f'<tendon><spatial name="s" {attributes}><site site="hook"/><site site="end"/></spatial></tendon>'


def test_defaults_and_names(tmp_path):
    m = read(tmp_path, "")
    assert (m.name, m.joints[0].axis, m.bodies[0].com) == ("arm", (0.0, -1.0, 0.0), (0.3, 0.0, 0.0))
    assert m.joints[0].range is None


def test_an_unset_spring_length_is_that_of_the_reference_pose(tmp_path):
    m = read(tmp_path, "", spring('stiffness="100"'))
    assert m.springs[0].free_length == pytest.approx(0.25, rel=1e-9)
    zero = read(tmp_path, "", spring('stiffness="196.2" springlength="0 0"'))
    assert zero.springs[0].free_length == 0
    assert eq.check(zero).exact


def test_several_joints_anchors_and_references(tmp_path):
    """A body with two hinges, the second away from its origin and with a reference angle: as the engine places it."""
    import mujoco

    inside = """<body name="hand" pos="0.5 0 0" euler="0 30 0"><joint name="a" pos="0.1 0.02 0"/>
    <joint name="b" axis="0 0 1" ref="20" range="-50 70" limited="true"/>
    <inertial pos="0.1 0 0.05" mass="1" diaginertia="1 1 1"/></body>"""
    m = read(tmp_path, inside)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    data = mujoco.MjData(model)
    data.qpos[:] = 0.3, -0.7, 0.9
    mujoco.mj_forward(model, data)
    tree = Tree.of(m)
    assert tree.coordinates == ("shoulder", "a", "b")
    poses = tree.poses(np.array([[0.3, -0.7, 0.9]]))
    hand = tree.index["hand"]
    np.testing.assert_allclose(poses.p[0, hand], data.body("hand").xpos, atol=1e-12)
    np.testing.assert_allclose(poses.R[0, hand].ravel(), data.body("hand").xmat, atol=1e-12)
    np.testing.assert_allclose(Potential(m)(np.array([[0.3, -0.7, 0.9]])).torque[0], data.qfrc_bias, atol=1e-9)
    assert m.joints[-1].range == pytest.approx(tuple(np.radians([-50, 70])))


def test_equalities(tmp_path):
    inside = f"""<body name="lever" pos="0.4 0 0"><joint name="elbow"/>{ONE_KG}</body>
    <body name="slider" pos="0.4 0 0"><joint name="slide" type="slide"/>{ONE_KG}</body>"""
    equality = """<equality><joint joint1="elbow" joint2="shoulder" polycoef="0.1 -2 0 0 0"/>
    <joint joint1="slide" polycoef="0.05 0 0 0 0"/></equality>"""
    m = read(tmp_path, inside, equality)
    assert m.couplings == (eq.Coupling("elbow", (("shoulder", -2.0),), 0.1),)
    assert m.joints[2].range == (0.05, 0.05)


@pytest.mark.parametrize(
    ("inside", "more", "message"),
    [
        ("", '<tendon><fixed name="s" stiffness="100" springlength="0 0.2"><joint joint="shoulder" coef="1"/></fixed>'
         '</tendon>', "tendon 's' is slack between two angles"),
        (f'<body name="hand"><joint name="w"/>{ONE_KG}</body>',
         '<equality><joint joint1="w" joint2="shoulder" polycoef="0 0 1 0 0"/></equality>', "is curved"),
        ('<geom name="ball" size="0.01" mass="0.1"/>',
         '<tendon><spatial name="f" stiffness="3" springlength="1"><site site="hook"/><geom geom="ball"/>'
         '<site site="end"/></spatial></tendon>', "tendon 'f' is a spring with a sphere or a pulley block"),
    ],
)  # fmt: skip
def test_what_has_no_counterpart_is_named(tmp_path, inside, more, message):
    with pytest.raises(InputError, match=message):
        read(tmp_path, inside, more)


def test_a_free_body_is_refused(tmp_path):
    world = f'<body name="ball"><freejoint name="f"/>{ONE_KG}</body>'
    with pytest.raises(InputError, match=r"robot.xml:4: joint 'f' is free, and nothing holds .* --base fixed"):
        read(tmp_path, "", world=world)


def test_what_does_not_compile_says_why(tmp_path):
    with pytest.raises(InputError, match=r"robot.xml: MuJoCo does not compile it: .*hing"):
        read(tmp_path, '<joint type="hing"/>')


def test_as_a_model_of_a_mechanism_file(tmp_path):
    read(tmp_path, "")
    text = (
        "schema: 1\nname: x\nmodel: robot.xml\nsprings:\n  - {name: s, body_a: world, p_a: [0, 0, 0.2], body_b: arm, "
    )
    (tmp_path / "m.yaml").write_text(text + "p_b: [0.15, 0, 0], stiffness: 196.2}\n")
    assert eq.check(eq.load(tmp_path / "m.yaml")).exact
    read(tmp_path, "", spring('stiffness="100"'))
    with pytest.raises(InputError, match=r"m.yaml:3:8: model: 'robot.xml' has springs of its own"):
        eq.load(tmp_path / "m.yaml")


def test_command_line(run, tmp_path):
    read(tmp_path, "", spring('stiffness="196.2" springlength="0 0"'))
    code, text, _ = run("check", tmp_path / "robot.xml")
    assert code == 0
    assert "EXACT" in text


def spoken(folder: Path, *arguments: str, base: str | None = None) -> tuple[eq.Mechanism, str]:
    """A model, and what is said while it is read."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        read(folder, *arguments)
        m = eq.load(folder / "robot.xml", base=base)
    return m, "\n".join(dict.fromkeys(str(one.message) for one in caught))


@pytest.mark.parametrize(
    ("inside", "more", "message"),
    [
        (f'\n<body name="hand"><joint name="w" type="slide" stiffness="3"/>{ONE_KG}</body>', "",
         "joint 'w' (line 7): the spring (stiffness) of a joint that is no hinge is left out"),
        (f'<body name="hand"><joint name="w" stiffness="3 1"/>{ONE_KG}</body>', "",
         "joint 'w' (line 6): what is curved in a joint's spring"),
        (f'\n<body name="hand" gravcomp="1"><joint/>{ONE_KG}</body>', "",
         "body 'hand' (line 7): gravity compensation (gravcomp) is left out"),
        ("", '<option wind="1 0 0" density="1.2"/>', "<option wind>: the force of wind is left out"),
        ("", '<option><flag spring="disable"/></option>' + spring('stiffness="3"'), "springs off: it is heeded"),
        ("", '<option><flag gravity="disable"/></option>', "gravity off: it is heeded"),
        (f'<body name="hand"><joint name="w" range="0 9" limited="true"/>{ONE_KG}</body>',
         '<option><flag limit="disable"/></option>', "ranges of joints off: it is heeded"),
        ("", spring('limited="true" range="0 1"'), "tendon 's' (line 6): limits of a tendon's length are left out"),
        ("", '<actuator><general name="pull" joint="shoulder" gainprm="0" biastype="affine" biasprm="3"/></actuator>',
         "actuator 'pull' (line 6): what it pulls without being told to is left out"),
        (f'<body name="hand"><joint name="w" type="ball" range="0 40" limited="true"/>{ONE_KG}</body>', "",
         "joint 'w' (line 6): limits of a ball joint are left out"),
    ],
)  # fmt: skip
def test_what_acts_and_is_left_out_or_heeded_is_named(tmp_path, inside, more, message):
    assert message in spoken(tmp_path, inside, more)[1]


def test_flags_are_heeded(tmp_path):
    off = '<option><flag {}="disable"/></option>'
    assert spoken(tmp_path, "", off.format("gravity"))[0].gravity == (0, 0, 0)
    assert not spoken(tmp_path, "", off.format("spring") + spring('stiffness="100"'))[0].springs
    limited = f'<body name="hand"><joint name="w" range="0 9" limited="true"/>{ONE_KG}</body>'
    assert spoken(tmp_path, limited, off.format("limit"))[0].joints[-1].range is None
    lock = '<equality><joint joint1="shoulder" polycoef="0.05 0 0 0 0"/></equality>'
    for flag in ("equality", "constraint"):
        assert spoken(tmp_path, "", off.format(flag) + lock)[0].joints[0].range is None


def test_a_free_body_can_be_held_or_set_free(tmp_path):
    path = tmp_path / "robot.xml"
    path.write_text(
        f"""<mujoco><worldbody><body name="trunk" pos="1 2 3" euler="0 0 30"><freejoint name="f"/>{ONE_KG}
        <body name="leg"><joint name="hip" axis="0 1 0"/>{ONE_KG}</body></body></worldbody></mujoco>"""
    )
    with pytest.raises(InputError, match="joint 'f' is free"):
        eq.load(path)
    held = eq.load(path, base="fixed")
    assert held.coordinates == ("hip",)
    poses = Tree.of(held).poses(np.zeros((1, 1)))
    np.testing.assert_allclose(poses.p[0, Tree.of(held).index["trunk"]], (1, 2, 3))
    loose = eq.load(path, base="free")
    assert loose.coordinates == ("f x", "f y", "f z", "f.x", "f.y", "f.z", "hip")
    weight = Potential(loose)(np.zeros((1, 7))).torque[0]
    np.testing.assert_allclose(weight[:3], (0, 0, 2 * 9.81), atol=1e-12)
    assert str(Tree.of(loose).turns.tolist()) == str([False] * 3 + [True] * 4)


def test_a_weld_holds_a_free_body(tmp_path):
    path = tmp_path / "robot.xml"
    path.write_text(
        f"""<mujoco><worldbody><body name="post" pos="0 0 1" euler="0 20 0"/>
        <body name="trunk" pos="1 2 3" euler="0 0 30"><freejoint name="f"/>{ONE_KG}
        <body name="leg"><joint name="hip" axis="0 1 0"/>{ONE_KG}</body></body></worldbody>
        <equality><weld body1="trunk" body2="post" relpose="0.1 0.2 0.3 0.9 0.1 0.2 0.3" anchor="0.2 0 0"/></equality>
        </mujoco>"""
    )
    m = eq.load(path)
    assert m.coordinates == ("hip",)
    assert not m.loops
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    data.qpos[:] = Engine(path, m).qpos(np.zeros((1, 1)))[0]
    mujoco.mj_forward(model, data)
    assert np.abs(data.efc_pos[data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)]).max() < 1e-12


ROD = """<body name="{0}" pos="{1} 0 0"><joint name="{2}" axis="0 1 0" range="-80 80"/>
<geom type="capsule" fromto="0 0 0 0 0 0.3" size="0.01" mass="0.2"/></body>"""
TABLE = f"""<mujoco><worldbody>{ROD.format("r1", 0.3, "j1")}{ROD.format("r2", -0.3, "j2")}
<body name="table" pos="0 0 0.3"><freejoint name="table"/><geom type="box" size="0.3 0.1 0.01" mass="4"/></body>
</worldbody><equality>{{}}</equality>{{}}</mujoco>"""
CONNECT = '<connect body1="{}" body2="table" anchor="{} {} 0.3"/>'
HINGES = "".join(CONNECT.format(rod, 0, y) for rod in ("r1", "r2") for y in (0.05, -0.05))


def test_a_free_body_that_loops_hold(tmp_path):
    (tmp_path / "table.xml").write_text(TABLE.format(HINGES, ""))
    balance = eq.check(eq.load(tmp_path / "table.xml"), samples=200)
    assert balance.coordinates == ("j1",)
    assert balance.unbalanced.max == pytest.approx([9.81 * (2 * 0.2 * 0.15 + 4 * 0.3) * np.sin(np.radians(80))])


def test_the_joint_with_an_actuator_steers(tmp_path):
    (tmp_path / "table.xml").write_text(TABLE.format(HINGES, '<actuator><motor joint="j2"/></actuator>'))
    m = eq.load(tmp_path / "table.xml")
    assert m.independent == ("j2",)
    assert Tree.of(m).coordinates == ("j2",)


def test_more_than_two_points_and_a_weld_are_loops_too(tmp_path):
    """A table that a weld, or four points, hold on one rod turns with it."""
    four = "".join(CONNECT.format("r1", x, y) for x in (-0.1, 0.1) for y in (0, 0.1))
    for equalities in (four, '<weld body1="r1" body2="table"/>', '<weld body1="table" body2="r1" anchor="0.1 0 0"/>'):
        (tmp_path / "table.xml").write_text(TABLE.format(equalities, ""))
        balance = eq.check(eq.load(tmp_path / "table.xml"), samples=200)
        assert balance.coordinates == ("j1", "j2")
        arm = np.hypot(0.2 * 0.15 + 4 * 0.3, 4 * 0.3)  # the table's centre is 0.3 m aside, and 0.3 m above
        assert balance.unbalanced.max == pytest.approx(
            [9.81 * arm, 9.81 * 0.2 * 0.15 * np.sin(np.radians(80))], rel=1e-6
        )


def test_a_keyframe_says_how_loops_close(tmp_path):
    """Loops that are open as the model is drawn, far from any pose that the solver would think of by itself."""
    model = """<mujoco><compiler angle="radian"/><worldbody>
    <body name="crank"><joint name="drive" axis="0 -1 0"/>{0}
    <body name="coupler" pos=".1 0 0"><joint name="pin" axis="0 -1 0"/>{0}
    <site name="a" pos=".4 0 0"/></body></body>
    <body name="rocker" pos=".35 0 0"><joint name="post" axis="0 -1 0"/>{0}
    <site name="b" pos=".3 0 0"/></body></worldbody>
    <equality><connect site1="a" site2="b"/></equality>
    <keyframe><key name="open" qpos="0 0 0"/><key name="home" qpos="{1}"/></keyframe></mujoco>"""
    found = []
    for up in (1, -1):
        # crank along x, the triangle of coupler 0.4 m, rocker 0.3 m and ground 0.25 m above it or below
        x = (0.4**2 - 0.3**2 + 0.25**2) / (2 * 0.25)
        z = up * np.sqrt(0.4**2 - x**2)
        (tmp_path / "fourbar.xml").write_text(model.format(ONE_KG, f"0 {np.arctan2(z, x)} {np.arctan2(z, x - 0.25)}"))
        m = eq.load(tmp_path / "fourbar.xml")
        tree = Tree.of(m)
        assert isinstance(tree, Linkage)
        np.testing.assert_allclose(tree.branch.assembled, [v for _, v in m.assembly], atol=1e-3)
        found.append(dict(m.assembly)["pin"])
    assert found[0] == pytest.approx(-found[1])
    assert found[0] > 0.5


def test_equalities_with_what_a_program_moves_are_left_out(tmp_path):
    """A hand that follows a mocap body is held by nothing when no program runs."""
    inside = f'<body name="hand" pos="0.4 0 0"><joint name="w"/>{ONE_KG}</body>'
    world = '<body name="target" mocap="true" pos="0.4 0 0"/>'
    with pytest.warns(EquipoiseWarning, match="equality 0: what ties it to a mocap body"):
        m = read(tmp_path, inside, '<equality><weld body1="hand" body2="target"/></equality>', world)
    assert not m.loops
    assert m.coordinates == ("shoulder", "w")


def test_a_tendon_that_holds_nothing_is_no_coupling(tmp_path):
    tendon = '<tendon><fixed name="f"><joint joint="shoulder" coef="0"/></fixed></tendon>'
    m = read(tmp_path, "", tendon + '<equality><tendon tendon1="f"/></equality>')
    assert m.couplings == ()

"""URDF: the example robots, every error with its line, the lint, and writing."""

from __future__ import annotations

import importlib.util
import warnings
from pathlib import Path

import numpy as np
import pytest
from peers import peer

from equipoise.io import urdf
from equipoise.io.lint import inertia_lint
from equipoise.model.elements import Spring
from equipoise.model.errors import EquipoiseWarning, InputError, UnsupportedError
from equipoise.model.mechanism import Body, Coupling, Joint, Loop, Mechanism, PointMass

ROBOTS = Path(__file__).parents[1] / "examples" / "robots"
NAMES = ("ur5", "ur10", "panda", "xarm7", "human")
MASSES = {"ur5": 20.9939, "ur10": 32.7, "panda": 17.451901, "xarm7": 11.31706, "human": 74.712}
COORDINATES = {"ur5": 6, "ur10": 6, "panda": 8, "xarm7": 7, "human": 36}

quiet = pytest.mark.filterwarnings("ignore::equipoise.model.errors.EquipoiseWarning")


def read(body: str) -> Mechanism:
    """A robot whose elements start on line 2."""
    return urdf.read_text(f"<robot name='r'>\n{body}\n</robot>", "r.urdf")


def faults(text: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        urdf.read_text(text, "r.urdf")
    return [str(fault) for fault in caught.value.faults]


def inertial(mass: float = 1, moments: str = "1 1 1 0 0 0", origin: str = "") -> str:
    keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    attributes = " ".join(f"{key}='{value}'" for key, value in zip(keys, moments.split(), strict=True))
    return f"<inertial>{origin}<mass value='{mass}'/><inertia {attributes}/></inertial>"


def joint(kind: str, inside: str = "", name: str = "j", parent: str = "a", child: str = "b") -> str:
    return f"<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>{inside}</joint>"


TWO = "<link name='a'/><link name='b'/>\n"
LIMIT = "<limit lower='-1' upper='2'/>"


@quiet
@pytest.mark.parametrize("name", NAMES)
def test_robots_read(name: str) -> None:
    m = urdf.read(ROBOTS / f"{name}.urdf")
    assert sum(body.mass for body in m.bodies) == pytest.approx(MASSES[name], rel=1e-12)
    assert len(m.coordinates) == COORDINATES[name]
    assert len(m.bodies) == len(m.joints)


@quiet
@pytest.mark.parametrize("name", NAMES)
def test_robots_agree_with_pinocchio(name: str) -> None:
    """Masses, centres of mass and inertias, each moved by a second parser to the joint that carries the body."""
    pin = peer("pinocchio")
    m = urdf.read(ROBOTS / f"{name}.urdf")
    model = pin.buildModelFromUrdf(str(ROBOTS / f"{name}.urdf"))
    q = np.random.default_rng(1).uniform(-1, 1, model.nq)
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    values = {model.names[i]: q[model.joints[i].idx_q] for i in range(1, model.njoints)}
    poses = place(m, values)
    total = {i: pin.Inertia.Zero() for i in range(model.njoints)}
    for body in m.bodies:
        frame = model.frames[model.getFrameId(body.name, pin.FrameType.BODY)]
        R, p = poses[body.name]
        pose = data.oMi[frame.parentJoint] * frame.placement
        np.testing.assert_allclose(R, pose.rotation, atol=1e-12)
        np.testing.assert_allclose(p, pose.translation, atol=1e-12)
        ixx, iyy, izz, ixy, ixz, iyz = body.inertia or (0.0,) * 6
        tensor = np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
        total[frame.parentJoint] += frame.placement.act(pin.Inertia(body.mass, np.array(body.com), tensor))
    for i in range(1, model.njoints):
        np.testing.assert_allclose(total[i].matrix(), model.inertias[i].matrix(), atol=1e-12)


def place(m: Mechanism, q: dict[str, float]) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Body poses by the definition of URDF, from one value per joint."""
    from scipy.spatial.transform import Rotation

    poses = {"world": (np.eye(3), np.zeros(3))}
    while len(poses) <= len(m.bodies):
        for j in m.joints:
            if j.parent in poses:
                R, p = poses[j.parent]
                axis = np.array(j.axis) / np.linalg.norm(j.axis)
                turn, slide = np.eye(3), np.zeros(3)
                if j.type == "revolute":
                    turn = Rotation.from_rotvec(axis * q[j.name]).as_matrix()
                elif j.type == "prismatic":
                    slide = axis * q[j.name]
                R_PC = Rotation.from_euler("xyz", j.rpy).as_matrix()
                poses[j.child] = (R @ R_PC @ turn, p + R @ (np.array(j.xyz) + R_PC @ slide))
    return poses


@quiet
@pytest.mark.parametrize("name", NAMES)
def test_robots_survive_writing(name: str) -> None:
    m = urdf.read(ROBOTS / f"{name}.urdf")
    assert urdf.read_text(urdf.to_text(m), name) == m


@quiet
def test_ur5() -> None:
    m = urdf.read(ROBOTS / "ur5.urdf")
    assert m.name == "ur5"
    assert m.coordinates == (
        "shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint",
    )  # fmt: skip
    bodies = {body.name: body for body in m.bodies}
    assert bodies["upper_arm_link"] == Body(
        "upper_arm_link", 8.393, (0.0, 0.0, 0.28), (0.22689067591, 0.22689067591, 0.0151074, 0.0, 0.0, 0.0)
    )
    lift = next(j for j in m.joints if j.name == "shoulder_lift_joint")
    assert lift.range == (-6.28318530718, 6.28318530718)
    assert lift.axis == (0.0, 1.0, 0.0)
    assert next(j for j in m.joints if j.parent == "world").name == "world_joint"  # its own link named world


@quiet
def test_panda_has_a_weld_and_a_mimic() -> None:
    m = urdf.read(ROBOTS / "panda.urdf")
    assert m.joints[0] == Joint("world_to_panda_link0", "fixed", "world", "panda_link0")
    assert m.couplings == (Coupling("panda_finger_joint2", (("panda_finger_joint1", 1.0),), 0.0),)
    assert "world_to_panda_link0" not in urdf.to_text(m)


@pytest.mark.parametrize("name", NAMES)
def test_robots_name_their_source_and_licence(name: str) -> None:
    head = (ROBOTS / f"{name}.urdf").read_text().split("-->")[0]
    assert all(word in head for word in ("Source:", "Upstream:", "Licence:"))


def test_the_script_that_made_the_robots_drops_all_else() -> None:
    spec = importlib.util.spec_from_file_location("make_robots", ROBOTS / "make.py")
    assert spec is not None
    assert spec.loader is not None
    make = importlib.util.module_from_spec(spec)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(__import__("sys").modules, "make_robots", make)  # dataclasses look their module up
        spec.loader.exec_module(make)
    noise = "<visual/><collision/>"
    source = make.ET.fromstring(
        f"<robot name='r'><gazebo/><link name='a'>{noise}</link><link name='b'>{inertial()}</link>"
        f"{joint('revolute', LIMIT + '<dynamics/>')}<transmission><joint name='j'/></transmission></robot>"
    )
    text = make.text(source, make.SOURCES["ur5"], "1")
    for dropped in ("gazebo", "visual", "collision", "dynamics", "transmission"):
        assert dropped not in text
    assert urdf.read_text(text, "r").coordinates == ("j",)


def test_joint_types() -> None:
    m = read(
        "<link name='world'/><link name='a'/><link name='b'/><link name='c'/><link name='d'/>"
        + joint("fixed", "<origin xyz='1 2 3' rpy='.1 -.2 3e-1'/>", "f", "world", "a")
        + joint("revolute", LIMIT + "<axis xyz='0 0 2'/>", "r", "a", "b")
        + joint("continuous", "<limit effort='1'/><mimic joint='r' multiplier='-2' offset='.5'/>", "c", "b", "c")
        + joint("prismatic", "<limit upper='2'/><safety_controller/>", "p", "c", "d")
    )  # fmt: skip
    assert m.joints == (
        Joint("f", "fixed", "world", "a", (1.0, 2.0, 3.0), (0.1, -0.2, 0.3)),
        Joint("r", "revolute", "a", "b", axis=(0.0, 0.0, 2.0), range=(-1.0, 2.0)),
        Joint("c", "revolute", "b", "c", axis=(1.0, 0.0, 0.0), effort=1.0),
        Joint("p", "prismatic", "c", "d", axis=(1.0, 0.0, 0.0), range=(0.0, 2.0)),
    )
    assert m.couplings == (Coupling("c", (("r", -2.0),), 0.5),)
    assert m.bodies[0] == Body("a")
    assert urdf.read_text(urdf.to_text(m), "again") == m


def test_inertia_is_rotated_into_the_body_frame() -> None:
    quarter = "<origin xyz='1 2 3' rpy='0 0 1.5707963267948966'/>"
    m = read(f"<link name='a'>{inertial(2, '1 2 2.5 0 0 0', quarter)}</link>")
    assert m.bodies[0].com == (1.0, 2.0, 3.0)
    np.testing.assert_allclose(np.array(m.bodies[0].inertia), [2, 1, 2.5, 0, 0, 0], atol=1e-15)
    eighth = "<origin rpy='0.7853981633974483 0 0'/>"
    m = read(f"<link name='a'>{inertial(2, '1 2 2.5 0 0 0', eighth)}</link>")
    # R I R^T with R = Rx(45 deg): the yz block is [[2.25, -0.25], [-0.25, 2.25]]
    np.testing.assert_allclose(np.array(m.bodies[0].inertia), [1, 2.25, 2.25, 0, 0, -0.25], atol=1e-15)


BAD = {
    "malformed": ("<robot name='r'>\n<link></robot>", "r.urdf:2:9: not well-formed XML: mismatched tag"),
    "undefined entity": ("<robot name='&a;'/>", "not well-formed XML: undefined entity"),
    "doctype": ("\n<!DOCTYPE robot>\n<robot name='r'/>", "r.urdf:2:16: a document type declaration"),
    "entity bomb": (
        "<!DOCTYPE r [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;&a;'>]><robot name='&b;'/>",
        "a document type declaration (<!DOCTYPE ...>) is not accepted: remove it",
    ),
    "external entity": ("<!DOCTYPE r [<!ENTITY a SYSTEM 'file:///secret'>]><r>&a;</r>", "document type declaration"),
    "sdf": ("<sdf/>", "whose root element is <robot>, found <sdf>: turn it into MJCF first, with sdf2mjcf"),
    "another format": ("<mujoco/>", "expected a URDF file, whose root element is <robot>, found <mujoco>"),
    "no name": ("<robot><link name='a'/></robot>", "robot.name: missing"),
    "no links": ("<robot name='r'/>", "robot: has no link"),
    "xacro element": (
        "<robot name='r' xmlns:xacro='http://wiki.ros.org/xacro'>\n<xacro:include filename='a'/></robot>",
        "r.urdf:2:1: found <xacro:include>: this is a xacro file; expand it with xacro first",
    ),
    "xacro by another prefix": (
        "<robot name='r' xmlns:x='http://www.ros.org/wiki/xacro'><x:macro/></robot>", "found <x:macro>"
    ),
    "xacro value": ("<robot name='r'>\n<link name='${p}a'/></robot>", "r.urdf:2:1: found name='${p}a': this is a"),
}  # fmt: skip

BAD_ROBOTS = {
    "floating": (TWO + joint("floating"), "r.urdf:3:1: joint 'j' is free, and nothing holds what it carries: it falls; "
                 "--base fixed holds it where it is drawn"),
    "link without name": ("<link/>", "r.urdf:2:1: link.name: missing"),
    "duplicate link": (TWO + "<link name='a'/>" + joint("fixed"), "r.urdf:3:1: link 'a'.name: duplicate name 'a'"),
    "duplicate joint": (TWO + "<link name='c'/>" + joint("fixed") + joint("fixed", child="c"), "duplicate name 'j'"),
    "misspelt type": (TWO + joint("revolut"), "there is no joint type 'revolut'; did you mean 'revolute'?"),
    "no type": (TWO + joint("fixed").replace("type='fixed'", ""), "joint 'j'.type: missing (valid: fixed, revolute"),
    "no parent": (TWO + "<joint name='j' type='fixed'>\n<child link='b'/></joint>",
                  "r.urdf:3:1: joint 'j'.parent: missing: a joint needs <parent link='...'/>"),
    "unnamed child": (TWO + joint("fixed", child=""), "joint 'j'.child.link: missing"),
    "unknown parent": (TWO + joint("fixed", parent="aa"), "r.urdf:3:1: joint 'j'.parent: there is no body 'aa'; "
                       "did you mean 'a'? (valid: world, a, b)"),
    "unknown child": (TWO + joint("fixed", child="bb"), "joint 'j'.child: there is no body 'bb'"),
    "two roots": ("<link name='a'/>\n<link name='b'/>", "r.urdf:3:1: link 'b': more than one root link: 'a', 'b'"),
    "two parents": (TWO + joint("fixed") + joint("fixed", name="k"), "body 'b' already hangs on joint 'j'"),
    "ring": (TWO + joint("fixed") + joint("fixed", name="k", parent="b", child="a"), "form a ring"),
    "world as a child": ("<link name='a'/><link name='world'/>" + joint("fixed", child="world"), "cannot be a child"),
    "swapped limits": (TWO + joint("revolute", "<limit lower='1' upper='-1'/>"),
                       "joint 'j'.limit: must be two finite"),
    "bad limit": (TWO + joint("revolute", "\n<limit lower='1' upper='90deg'/>"),
                  "r.urdf:4:1: joint 'j'.limit.upper: expected a number, found '90deg'"),
    "zero axis": (TWO + joint("continuous", "<axis xyz='0 0 0'/>"), "joint 'j'.axis: must not be zero"),
    "short vector": (TWO + joint("fixed", "\n<origin xyz='1 2'/>"),
                     "r.urdf:4:1: joint 'j'.origin.xyz: expected 3 numbers, found '1 2'\n    4 | <origin xyz='1 2'/>"),
    "not a number": (TWO + joint("fixed", "<origin rpy='0 nan 0'/>"), "expected 3 numbers, found '0 nan 0'"),
    "infinite": (TWO + joint("fixed", "<origin rpy='0 1e999 0'/>"), "expected 3 numbers, found '0 1e999 0'"),
    "underscore": (TWO + joint("fixed", "<origin rpy='0 1_0 0'/>"), "expected 3 numbers"),
    "long text": (TWO + joint("fixed", f"<origin xyz='{'1 ' * 200}'/>"), "1 1..."),
    "negative mass": (f"<link name='a'>{inertial(-1)}</link>", "link 'a'.inertial: must be at least 0 kg, found -1"),
    "mimic of nothing": (TWO + joint("continuous", "<mimic/>"), "joint 'j'.mimic.joint: missing"),
    "mimic of itself": (TWO + joint("continuous", "<mimic joint='j'/>"), "joint 'j' depends on itself"),
    "bad multiplier": (TWO + joint("continuous", "<mimic joint='j' multiplier='x'/>"), "multiplier: expected a number"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "message"), BAD.values(), ids=BAD.keys())
def test_bad_files(text: str, message: str) -> None:
    assert message in "\n".join(faults(text))


@pytest.mark.parametrize(("body", "message"), BAD_ROBOTS.values(), ids=BAD_ROBOTS.keys())
def test_bad_robots(body: str, message: str) -> None:
    assert message in "\n".join(faults(f"<robot name='r'>\n{body}\n</robot>"))


def test_every_fault_is_reported_once_in_the_order_of_the_file() -> None:
    body = TWO + joint("screw", "\n<origin xyz='x'/><mimic joint='k'/>") + "\n<link name='c'/>\n"
    body += joint("revolute", "\n<axis xyz='0 0'/><limit lower='x' upper='-1'/>", name="k", parent="z", child="c")
    found = faults(f"<robot name='r'>\n{body}\n</robot>")
    assert [text.splitlines()[0].split(": ")[:3:2] for text in found] == [
        ["r.urdf:3:1", "there is no joint type 'screw' (valid"],
        ["r.urdf:4:1", "expected 3 numbers, found 'x'"],
        ["r.urdf:6:1", "there is no body 'z' (valid"],
        ["r.urdf:7:1", "expected 3 numbers, found '0 0'"],
        ["r.urdf:7:18", "expected a number, found 'x'"],
    ]


def test_a_deep_file_is_no_trouble() -> None:
    deep = "<a>" * 49_000 + "</a>" * 49_000
    assert read(f"<gazebo>{deep}</gazebo><link name='a'/>").body_names == ("world", "a")


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.urdf"):
        urdf.read(tmp_path / "none.urdf")


def body(name: str, mass: float = 1, inertia: tuple[float, ...] | None = (1, 1, 1, 0, 0, 0)) -> Body:
    return Body(name, mass, inertia=inertia)  # type: ignore[arg-type]


def lint(*bodies: Body) -> list[str]:
    joints = tuple(Joint(f"j{b.name}", "fixed", "world", b.name) for b in bodies)
    return inertia_lint(Mechanism("m", bodies, joints))


def test_lint_is_silent_about_frames_rods_plates_and_rounding() -> None:
    assert lint(
        body("none", inertia=None),
        body("massless", 0, None),
        body("frame", 0, (0, 0, 0, 0, 0, 0)),
        body("rod", 1, (1, 1, 0, 0, 0, 0)),
        body("plate", 1, (1, 1, 2.0000001, 0, 0, 0)),
        body("turned plate", 1, (1.5, 1.5, 1, 0.5, 0, 0)),
    ) == []  # fmt: skip


def test_lint_findings() -> None:
    assert lint(body("a", 2, (0,) * 6)) == ["link 'a': zero inertia with a mass of 2 kg"]
    assert lint(body("a", 0)) == ["link 'a': inertia without mass"]
    assert lint(body("a", 1, (1, 1, 3, 0, 0, 0))) == [
        "link 'a': impossible inertia, principal moments 1, 1, 3 kg m^2: none can exceed the sum of the other two, "
        "2 kg m^2"
    ]
    assert lint(body("a", 1, (1, 1, 1, 2, 0, 0))) == [
        "link 'a': impossible inertia, principal moments -1, 1, 3 kg m^2: none can be negative"
    ]
    assert lint(body("a"), body("b"), body("c"), body("d", 2), body("e", 2), body("f", 3)) == [
        "links with identical inertials, copied placeholders? 'a', 'b', 'c' (1 kg); 'd', 'e' (2 kg)"
    ]


def test_reading_warns() -> None:
    with pytest.warns(EquipoiseWarning, match="'wrist_1_link', 'wrist_2_link'") as caught:
        urdf.read(ROBOTS / "ur5.urdf")
    assert len(caught) == 1
    with pytest.warns(EquipoiseWarning, match="zero inertia"):
        read(f"<link name='a'>{inertial(1, '0 0 0 0 0 0')}</link>")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        urdf.read(ROBOTS / "xarm7.urdf")


ARM = Mechanism(
    "arm",
    bodies=(Body("a & 'b'", 1, (0.1, 0, 0), (1, 1, 1, 0, 0, 0)), Body("b")),
    joints=(
        Joint("ball", "spherical", "world", "a & 'b'", (1, 2, 3), (0.1, 0.2, 0.3)),
        Joint("hinge", "revolute", "a & 'b'", "b", axis=(0, 1, 0)),
    ),
)


def test_a_spherical_joint_is_written_as_three_hinges() -> None:
    m = urdf.read_text(urdf.to_text(ARM), "arm")
    assert m.coordinates == ARM.coordinates
    assert set(m.bodies) == {*ARM.bodies, Body("ball.x"), Body("ball.y")}
    assert [j.axis for j in m.joints if j.name.startswith("ball")] == [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    assert next(j for j in m.joints if j.name == "ball.x").rpy == (0.1, 0.2, 0.3)
    assert next(j for j in m.joints if j.name == "ball.z").rpy == (0, 0, 0)


def test_a_point_mass_is_written_as_a_link() -> None:
    text = urdf.to_text(ARM.with_masses([PointMass("b", "b", 2, (1, 0, 0)), PointMass("floor", "world", 1)]))
    with pytest.warns(EquipoiseWarning, match="zero inertia"):
        m = urdf.read_text(text, "arm")
    assert Body("b_2", 2, inertia=(0, 0, 0, 0, 0, 0)) in m.bodies  # the name b was taken
    assert Joint("b_joint", "fixed", "b", "b_2", (1, 0, 0)) in m.joints


def test_writing_warns_of_what_is_left_out() -> None:
    spring = Spring("s", "world", (0, 0, 1), "b", (0, 0, 0), 100, mass=1)
    with pytest.warns(EquipoiseWarning, match="URDF cannot hold springs: 1 springs left out"):
        text = urdf.to_text(ARM.with_springs([spring]))
    assert text == urdf.to_text(ARM)
    with pytest.warns(EquipoiseWarning, match="cannot hold gravity"):
        urdf.to_text(Mechanism("m", gravity=(0, -9.81, 0)))
    slide = Mechanism("m", (Body("a", 1),), (Joint("j", "prismatic", "world", "a"),))
    with (
        pytest.warns(EquipoiseWarning, match="inertia: written as zero for 'a'"),
        pytest.warns(EquipoiseWarning, match="'j' written with 1000 m"),
    ):
        urdf.to_text(slide)


def test_writing_refuses_what_urdf_cannot_hold() -> None:
    bodies = tuple(Body(name) for name in "abcd")
    joints = (
        Joint("p", "revolute", "world", "a"),
        Joint("q", "revolute", "a", "b"),
        Joint("r", "revolute", "b", "c"),
        Joint("keep", "parallelogram", "c", "d", follows="world"),
    )
    coupling = Coupling("r", (("p", 1.0), ("q", 1.0)))
    m = Mechanism("m", bodies, joints, (coupling,), (Loop("world", (0, 0, 0), "d", (0, 0, 0)),))
    with pytest.raises(UnsupportedError) as caught:
        urdf.to_text(m)
    assert str(caught.value).splitlines() == [
        "URDF cannot hold the parallelogram joint 'keep'; yaml and mjcf can",
        "URDF cannot hold the coupling of joint 'r', which has 2 terms, not one; yaml and mjcf can",
        "URDF cannot hold the loop between 'world' and 'd'; yaml and mjcf can",
    ]

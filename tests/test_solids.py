"""Distances to solids against sampled points of them and MuJoCo's own, and the readers that bring them."""

from dataclasses import replace

import numpy as np
import pytest
import zoo
from campaign import campaign
from peers import peer

import equipoise as eq
from equipoise.clearance import clearance
from equipoise.clearance.pairs import Pairs
from equipoise.clearance.solids import Solid
from equipoise.kinematics import Tree, sample
from equipoise.model.errors import EquipoiseWarning, InputError
from equipoise.model.mechanism import Capsule, Mechanism, PointMass, Shape
from equipoise.model.rotation import from_rpy

peer("coal")
KINDS = ("box", "cylinder", "ellipsoid")


def random_shape(rng: np.random.Generator, kind: str, body: str = "arm", name: str = "solid") -> Shape:
    size = rng.uniform(0.02, 0.3, 3)
    if kind == "cylinder":
        size[1] = size[0]
    xyz, rpy = rng.uniform(-0.2, 0.2, 3), rng.uniform(-3, 3, 3)
    return Shape(name, body, kind, *(tuple(x.tolist()) for x in (size, xyz, rpy)))  # type: ignore[arg-type]


def surface(shape: Shape, u: np.ndarray) -> np.ndarray:
    """The nearest points of a shape about its own origin to points u (N, 3) outside of it; of an ellipsoid some."""
    half = np.array(shape.size) / 2
    if shape.kind == "box":
        return np.clip(u, -half, half)
    if shape.kind == "cylinder":
        flat = np.linalg.norm(u[:, :2], axis=1, keepdims=True)
        return np.hstack([u[:, :2] * np.minimum(1, half[0] / flat), np.clip(u[:, 2:], -half[2], half[2])])
    return u / np.linalg.norm(u / half, axis=1, keepdims=True)


@campaign(100)
def test_a_capsule_is_as_far_as_its_points_are(seeds):
    """A thousand points of its axis, each projected onto the shape: never nearer, and as near as their spacing."""
    for seed in seeds:
        rng = np.random.default_rng(seed)
        for kind in KINDS:
            shape = random_shape(rng, kind)
            a, b = rng.uniform(-0.6, 0.6, (2, 20, 3))
            R, p = from_rpy(shape.rpy), np.array(shape.xyz)
            found, s, n = Solid(shape).distances(a, b, 0.01)
            t = np.linspace(0, 1, 1001)[:, None]
            for i in np.flatnonzero(found > 1e-4):
                axis = a[i] + t * (b[i] - a[i])
                own = (axis - p) @ R
                near = surface(shape, own)
                apart = np.linalg.norm(own - near, axis=1).min() - 0.01
                loose = 1e-9 if kind != "ellipsoid" else 0.3  # a radial projection is farther away
                assert found[i] <= apart + 1e-8
                assert found[i] >= apart - 1e-3 - loose
                at = a[i] + s[i] * (b[i] - a[i]) - (found[i] + 0.01) * n[i]  # on the surface of the shape
                inside = (at - p)[None] @ R
                assert np.linalg.norm(inside - surface(shape, inside * (1 + 1e-9))) < 1e-6


def scene(rng: np.random.Generator) -> Mechanism:
    """A pendulum with weights, a spring and solids on it and beside it."""
    m = zoo.with_post()
    shapes = [random_shape(rng, kind, body, f"{kind} {body}") for kind in KINDS for body in ("stand", "arm")]
    return replace(
        m.with_springs([replace(m.springs[0], p_b=tuple(rng.uniform(-0.2, 0.2, 3).tolist()))]),
        shapes=tuple(shapes),
        masses=(PointMass("weight", "arm", 0.5, (0.4, 0.1, 0.0)),),
    )


@campaign(60)
def test_a_whole_mechanism_as_mujoco_measures_it(seeds):
    """Every pair at random poses, as capsules and geoms placed in MuJoCo by hand: `mj_geomDistance`."""
    mujoco = peer("mujoco")
    for seed in seeds:
        rng = np.random.default_rng(seed)
        m = scene(rng)
        tree, pairs = Tree.of(m), Pairs(m)
        q = sample(tree, 5, seed)
        poses = tree.poses(q)
        own = pairs.distances(poses)
        assert {name for pair in pairs.names for name in pair} >= {"weight", "shoulder spring", "post", "box stand"}
        ends = pairs.points(poses, pairs.ends)
        shapes = {shape.name: shape for shape in m.shapes}
        for k in range(len(q)):
            spec = mujoco.MjSpec()
            for part, (a, b) in zip(pairs.room.parts, ends[k], strict=True):
                geom = spec.worldbody.add_geom(name=part.name)
                if part.name in shapes:
                    shape, body = shapes[part.name], tree.index[shapes[part.name].body]
                    R, half = poses.R[k, body] @ from_rpy(shape.rpy), np.array(shape.size) / 2
                    geom.type = getattr(mujoco.mjtGeom, f"mjGEOM_{shape.kind.upper()}")
                    geom.size = [half[0], half[2], 0] if shape.kind == "cylinder" else half
                    geom.pos, quat = poses.point(body, np.array(shape.xyz))[k], np.zeros(4)
                    mujoco.mju_mat2Quat(quat, R.ravel())
                    geom.quat = quat
                elif np.allclose(a, b):
                    geom.type, geom.size, geom.pos = mujoco.mjtGeom.mjGEOM_SPHERE, [part.radius, 0, 0], a
                else:
                    geom.type, geom.size = mujoco.mjtGeom.mjGEOM_CAPSULE, [part.radius, 0, 0]
                    geom.fromto = [*a, *b]
            model = spec.compile()
            data = mujoco.MjData(model)
            mujoco.mj_forward(model, data)
            for (first, second), distance in zip(pairs.names, own[k], strict=True):
                measured = mujoco.mj_geomDistance(
                    model, data, model.geom(first).id, model.geom(second).id, 10.0, np.zeros(6)
                )
                if min(distance, measured) > 1e-3:  # a depth of overlap is another question
                    assert distance == pytest.approx(measured, abs=2e-5)
                else:
                    assert distance < 2e-3
                    if measured > 2e-3:  # it has taken an axis through a box for one 14 mm away: points decide
                        shape, i = shapes[second], pairs.names.index((first, second))
                        a, b = ends[k, pairs.first[i]]
                        axis = a + np.linspace(0, 1, 2001)[:, None] * (b - a)
                        at = tree.index[shape.body]
                        u = ((axis - poses.p[k, at]) @ poses.R[k, at] - shape.xyz) @ from_rpy(shape.rpy)
                        assert np.linalg.norm(u - surface(shape, u), axis=1).min() - 0.01 < 2e-3


@pytest.mark.slow(reason="a climb with six solids")
def test_the_least_is_that_of_a_dense_scan():
    m = scene(np.random.default_rng(5))
    found = clearance(m, samples=100)
    tree, pairs = Tree.of(m), Pairs(m)
    q = np.linspace(-np.pi, np.pi, 801)[:, None]
    scan = dict(zip(pairs.names, pairs.distances(tree.poses(q)).min(axis=0), strict=True))
    for gap in found.gaps:
        if gap.distance > 0:
            assert gap.distance <= scan[gap.spring, gap.other] + 1e-9
            assert gap.distance >= scan[gap.spring, gap.other] - 8e-3
    assert found.nearest == pytest.approx(pairs.distances(tree.poses(sample(tree, 100, 0))).min(axis=1), abs=1e-8)


URDF = """<robot name="arm"><link name="base"><collision>
<geometry><box size="0.1 0.2 0.3"/></geometry></collision></link>
<link name="arm"><inertial><mass value="2"/><origin xyz="0.3 0 0"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision name="tube"><origin xyz="0.2 0 0" rpy="0 1.5707963267948966 0"/>
<geometry><cylinder radius="0.02" length="0.4"/></geometry></collision>
<collision><geometry><sphere radius="0.05"/></geometry></collision>
<collision><geometry><mesh filename="package://arm/part.stl" scale="0.001 0.001 0.001"/></geometry></collision>
<collision><geometry><box size="0.1 nan 0.3"/></geometry></collision></link>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 -1 0"/></joint></robot>"""


def test_the_links_own_geometry_from_a_urdf(tmp_path):
    (tmp_path / "arm.urdf").write_text(URDF)
    with pytest.warns(EquipoiseWarning, match=r"geometry of link 'arm' \(line 9\).*expected a number, found 'nan'"):
        m = eq.load(tmp_path / "arm.urdf")
    assert m.capsules == (Capsule("arm", "arm", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.05),)
    assert [(s.name, s.kind, s.size) for s in m.shapes] == [
        ("base", "box", (0.1, 0.2, 0.3)),
        ("tube", "cylinder", (0.04, 0.04, 0.4)),
        ("arm_2", "mesh", (0.0, 0.0, 0.0)),
    ]
    m = m.with_springs([eq.Spring("s", "world", (0.0, 0.3, 0.2), "arm", (0.15, 0.3, 0.0), 200.0)])
    with pytest.warns(EquipoiseWarning, match=r"meshes that are not there.*arm_2 \(package://arm/part.stl\)"):
        found = clearance(m, samples=50)
    assert found.left_out == ("arm_2 (package://arm/part.stl)",)
    assert found.gaps[0].other == "base"
    assert found.least == pytest.approx(0.2, abs=1e-9)
    eq.save(m, tmp_path / "arm.yaml")
    assert eq.load(tmp_path / "arm.yaml") == m


def test_a_mesh_is_its_triangles(tmp_path):
    """A tetrahedron as text; the file is found where the model says, in its own units and place."""
    corners = ((0, 0, 0), (100, 0, 0), (0, 100, 0), (0, 0, 100))
    faces = [(corners[i], corners[j], corners[k]) for i, j, k in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))]
    stl = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {x} {y} {z}\n" for x, y, z in face)
        + "endloop\nendfacet\n"
        for face in faces
    )
    (tmp_path / "part.stl").write_text(f"solid t\n{stl}endsolid t\n")
    (tmp_path / "arm.urdf").write_text(URDF.replace("nan", "0.1"))
    m = eq.load(tmp_path / "arm.urdf")
    mesh = next(shape for shape in m.shapes if shape.kind == "mesh")
    assert mesh.file == str(tmp_path / "part.stl")
    a, b = np.array([[0.1, 0.1, 0.1], [-0.02, 0.0, 0.05]]), np.array([[0.2, 0.2, 0.2], [-0.02, 0.0, 0.06]])
    found, _, n = Solid(mesh).distances(a, b, 0.001)
    assert found == pytest.approx([0.2 / np.sqrt(3) - 0.001, 0.019], abs=1e-7)
    assert n == pytest.approx(np.array([[3**-0.5] * 3, [-1.0, 0.0, 0.0]]), abs=1e-6)
    (tmp_path / "own.yaml").write_text(
        "schema: 1\nname: one\nmodel: arm.urdf\nshapes:\n- {name: cover, body: arm, kind: mesh, file: part.stl}\n"
    )
    own = eq.load(tmp_path / "own.yaml")
    assert [shape.name for shape in own.shapes][:2] == ["cover", "base"]
    assert own.shapes[0].file == mesh.file


def test_geometry_from_mjcf(tmp_path):
    peer("mujoco")
    (tmp_path / "arm.xml").write_text(
        """<mujoco><worldbody><geom type="plane" size="1 1 1"/><body name="arm">
        <joint name="j" type="hinge" axis="0 1 0"/>
        <geom type="box" size="0.1 0.02 0.03" pos="0.1 0 0"/><geom type="capsule" size="0.02" fromto="0 0 0 0.2 0 0"/>
        <geom type="sphere" size="0.1" contype="0" conaffinity="0"/></body></worldbody></mujoco>"""
    )
    m = eq.load(tmp_path / "arm.xml")
    assert [(s.kind, s.size, s.xyz) for s in m.shapes] == [("box", (0.2, 0.04, 0.06), (0.1, 0.0, 0.0))]
    (capsule,) = m.capsules
    assert capsule.radius == 0.02
    assert sorted((capsule.p_a, capsule.p_b)) == [
        pytest.approx((0.0, 0.0, 0.0), abs=1e-12),
        pytest.approx((0.2, 0.0, 0.0)),
    ]


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        ("kind: ball, size: [1 m, 1 m, 1 m]", "no kind of shape 'ball'"),
        ("kind: box, size: [1 m, 0, 1 m]", r"shapes\[0\].size: must be more than 0 m along each axis"),
        ("kind: cylinder, size: [1 m, 2 m, 1 m]", r"must be \[diameter, diameter, length\]"),
        ("kind: mesh", r"shapes\[0\].file: missing: a mesh needs it"),
    ],
)
def test_what_is_no_shape_is_said(tmp_path, bad, message):
    eq.save(zoo.pendulum(), tmp_path / "m.yaml")
    text = (tmp_path / "m.yaml").read_text()
    (tmp_path / "m.yaml").write_text(text + f"shapes:\n- {{name: s, body: arm, {bad}}}\n")
    with pytest.raises(InputError, match=message):
        eq.load(tmp_path / "m.yaml")

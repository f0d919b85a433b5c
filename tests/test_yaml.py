"""The YAML mechanism file: what is read, what is written, and that nothing is lost."""

from __future__ import annotations

import contextlib
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import mechanisms

from equipoise import io
from equipoise.io import yaml
from equipoise.io.yaml_positions import parse, resolve
from equipoise.model.elements import Spring
from equipoise.model.errors import InputError
from equipoise.model.mechanism import Body, Coupling, Joint, Loop, Mechanism, PointMass, Workspace

EXAMPLE = """\
schema: 1
name: one-link arm
gravity: [0, 0, -9.81]               # [m/s^2], world frame; this is the default

bodies:
  - name: arm
    mass: 2.0                        # [kg]
    com: [0.3, 0, 0]                 # [m], body frame
    # inertia: [ixx, iyy, izz, ixy, ixz, iyz]    # [kg m^2] about the com; only simulation needs it

joints:
  - name: shoulder
    type: revolute                   # fixed | revolute | prismatic | spherical | parallelogram
    parent: world
    child: arm
    xyz: [0, 0, 0]                   # child origin in the parent frame at q = 0 (URDF convention)
    rpy: [0, 0, 0]
    axis: [0, -1, 0]                 # in the joint (child) frame
    range: [-180 deg, 180 deg]       # optional; a revolute joint without it is unlimited

springs:
  - name: shoulder spring
    body_a: world
    p_a: [0, 0, 0.2]
    body_b: arm
    p_b: [0.15, 0, 0]
    stiffness: 196.2 N/m
    free_length: 0                   # default
    mass: 0                          # split evenly between the two ends unless mass_split says otherwise

masses:                              # payloads and counterweights
  - {name: payload, body: arm, mass: 0.5, position: [0.6, 0, 0]}

workspace: {samples: 4096}           # optional: where approximate balance is judged
"""

ONE_LINK = Mechanism(
    name="one-link arm",
    bodies=(Body("arm", 2.0, (0.3, 0.0, 0.0)),),
    joints=(Joint("shoulder", "revolute", "world", "arm", axis=(0.0, -1.0, 0.0), range=(-math.pi, math.pi)),),
    springs=(Spring("shoulder spring", "world", (0.0, 0.0, 0.2), "arm", (0.15, 0.0, 0.0), 196.2),),
    masses=(PointMass("payload", "arm", 0.5, (0.6, 0.0, 0.0)),),
)

MADE = Mechanism(
    name="slide: 1",
    bodies=(Body("cart", 1.5), Body("gear", inertia=(1.0, 1.0, 2.0, 0.0, 0.0, -1e-07)), Body("plate")),
    joints=(
        Joint("rail", "prismatic", "world", "cart"),
        Joint("pinion", "revolute", "cart", "gear", xyz=(0.0, 0.0, 0.1), axis=(0.0, 1.0, 0.0)),
        Joint("guide", "parallelogram", "gear", "plate", follows="world"),
    ),
    couplings=(Coupling("pinion", (("rail", -20.0),), 0.5),),
    loops=(Loop("plate", (0.5, 0.0, 0.0), "world", (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0)),),
    springs=(Spring("1.0", "world", (0.0, 0.0, 1.0), "gear", (0.0, 0.1, 0.0), 250.0, 0.05),),
    gravity=(0.0, -9.81, 0.0),
    workspace=Workspace(100),
    provenance={"method": "convex", "exact": True, "pairs": [["world", "gear"]], "steps": [{"gap": 1e-9}, None]},
)

MADE_TEXT = """\
schema: 1
name: "slide: 1"
gravity: [0.0, -9.81, 0.0]

bodies:
  - name: cart
    mass: 1.5
  - name: gear
    inertia: [1.0, 1.0, 2.0, 0.0, 0.0, -1e-07]
  - name: plate

joints:
  - name: rail
    type: prismatic
    parent: world
    child: cart
    axis: [1.0, 0.0, 0.0]
  - name: pinion
    type: revolute
    parent: cart
    child: gear
    xyz: [0.0, 0.0, 0.1]
    axis: [0.0, 1.0, 0.0]
  - name: guide
    type: parallelogram
    parent: gear
    child: plate
    follows: world

couplings:
  - joint: pinion
    terms: {rail: -20.0}
    offset: 0.5

loops:
  - body_a: plate
    p_a: [0.5, 0.0, 0.0]
    body_b: world
    p_b: [0.0, 0.0, 0.0]
    axis_a: [0.0, 1.0, 0.0]
    axis_b: [0.0, 1.0, 0.0]

springs:
  - name: "1.0"
    body_a: world
    p_a: [0.0, 0.0, 1.0]
    body_b: gear
    p_b: [0.0, 0.1, 0.0]
    stiffness: 250.0
    free_length: 0.05

workspace:
  samples: 100

provenance:
  method: convex
  exact: true
  pairs: [[world, gear]]
  steps:
    - gap: 1e-09
    - null
"""


def read(tmp_path: Path, text: str) -> Mechanism:
    path = tmp_path / "mechanism.yaml"
    path.write_text(text, encoding="utf-8", newline="\n")
    return io.load(path)


def test_example(tmp_path):
    assert read(tmp_path, EXAMPLE) == ONE_LINK


def test_everything_else_in_a_file(tmp_path):
    assert read(tmp_path, MADE_TEXT) == MADE
    assert yaml.to_text(MADE) == MADE_TEXT


def test_numbers_with_units(tmp_path):
    text = """\
schema: 1
name: units
gravity: [0, 0, -981 cm/s^2]
bodies: [{name: cart, mass: 850 g, com: [1 cm, 2e1 mm, .03], inertia: [1 g m^2, 1e-3, 1E-3, 0, 0, 0]}, {name: arm}]
joints:
  - {name: rail, type: prismatic, parent: world, child: cart, axis: [1, 0, 0], range: [-10 cm, 1e0]}
  - {name: elbow, type: revolute, parent: cart, child: arm, rpy: [0, 90 deg, 0], axis: [0, 1e3, 0], range: [0, 1 rad]}
couplings: [{joint: elbow, terms: {rail: 0x10}, offset: 180 deg}]
springs: [{name: s, body_a: world, p_a: [0, 0, 5 mm], body_b: arm, p_b: [0, 0, 0], stiffness: 20 kN/m, mass: 10 g}]
workspace: {samples: 1e4}
"""
    found = read(tmp_path, text)
    cart, (rail, elbow), spring = found.bodies[0], found.joints, found.springs[0]
    assert found.gravity == pytest.approx((0, 0, -9.81))
    assert (cart.mass, cart.com) == (pytest.approx(0.85), pytest.approx((0.01, 0.02, 0.03)))
    assert cart.inertia == pytest.approx((0.001, 0.001, 0.001, 0, 0, 0))
    assert rail.range == pytest.approx((-0.1, 1.0))
    assert (elbow.rpy, elbow.axis) == (pytest.approx((0, math.pi / 2, 0)), (0.0, 1000.0, 0.0))
    assert found.couplings[0] == Coupling("elbow", (("rail", 16.0),), math.pi)
    assert (spring.stiffness, spring.p_a[2], spring.mass) == pytest.approx((20e3, 0.005, 0.01))
    assert found.workspace.samples == 10_000


def test_offset_of_a_prismatic_joint_is_a_length(tmp_path):
    swapped = MADE_TEXT.replace("joint: pinion", "joint: rail").replace("{rail: -20.0}", "{pinion: 0.05}")
    assert read(tmp_path, swapped.replace("offset: 0.5", "offset: 5 cm")).couplings[0].offset == pytest.approx(0.05)
    with pytest.raises(InputError, match=r"couplings\[0\].offset: expected a number \[m\].*found '5 deg'"):
        read(tmp_path, swapped.replace("offset: 0.5", "offset: 5 deg"))


@settings(derandomize=True, deadline=None, max_examples=60)
@given(mechanisms())
def test_round_trip_loses_nothing(tmp_path_factory, mechanism):
    text = yaml.to_text(mechanism)
    again = read(tmp_path_factory.getbasetemp(), text)
    assert again == mechanism
    assert repr(again.provenance) == repr(mechanism.provenance)  # 1 == 1.0 == True, but they are not the same
    assert yaml.to_text(again) == text


@settings(derandomize=True, deadline=None, max_examples=300)
@given(st.text(alphabet="ab:-#[]{}&*!|>'\"%@`?, \n\t\\0.1\x85", max_size=40))
def test_any_text_is_read_or_refused(text):
    with contextlib.suppress(InputError):  # and no other error
        parse(text, "any.yaml")


def test_windows_and_byte_order_mark(tmp_path):
    path = tmp_path / "windows.yml"
    path.write_bytes(b"\xef\xbb\xbf" + EXAMPLE.replace("\n", "\r\n").encode())
    assert io.load(path) == ONE_LINK


@pytest.mark.parametrize(
    ("text", "value"),
    [
        *[("", None), ("~", None), ("null", None), ("true", True), ("FALSE", False), ("yes", "yes"), ("017", 17)],
        *[("0o17", 15), ("0x1F", 31), ("-0x1F", "-0x1F"), ("1e3", 1000.0), (".5", 0.5), ("1.", 1.0), ("1_0", "1_0")],
        *[("-.inf", -math.inf), ("2020-01-01", "2020-01-01"), ("1:30", "1:30"), ("9" * 5000, math.inf)],
    ],
    ids=lambda value: str(value)[:12],
)
def test_plain_scalars_follow_yaml_1_2(text, value):
    assert resolve(text) == value
    assert type(resolve(text)) is type(value)


def test_provenance_takes_tuples_and_numpy_and_refuses_the_rest(tmp_path):
    mechanism = replace(ONE_LINK, provenance={"gap": np.float64(0.1), "pairs": (("a", np.int64(2)),)})
    assert read(tmp_path, yaml.to_text(mechanism)).provenance == {"gap": 0.1, "pairs": [["a", 2]]}
    with pytest.raises(InputError, match=r"provenance.when\[0\]: cannot be written to a file: a set"):
        yaml.to_text(replace(ONE_LINK, provenance={"when": [{1}]}))
    with pytest.raises(InputError, match="keys that are not text"):
        yaml.to_text(replace(ONE_LINK, provenance={"by": {1: 2}}))


URDF = """\
<robot name="base and arm">
  <link name="base"/>
  <link name="arm"><inertial><mass value="2"/><origin xyz="0.3 0 0"/>
    <inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="turn.x" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
</robot>
"""
WITH_MODEL = """\
schema: 1
name: arm with a hand
model: parts/arm.urdf
bodies: [{name: hand, mass: 0.2}]
joints: [{name: wrist, type: spherical, parent: arm, child: hand, xyz: [0.6, 0, 0]}]
springs: [{name: s, body_a: base, p_a: [0, 0, 0.2], body_b: arm, p_b: [0.1, 0, 0], stiffness: 100}]
"""


def test_model_gives_the_tree_and_the_file_adds_to_it(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "arm.urdf").write_text(URDF)
    model = io.load(tmp_path / "parts" / "arm.urdf")
    found = read(tmp_path, WITH_MODEL)
    assert found.name == "arm with a hand"
    assert found.bodies == (*model.bodies, Body("hand", 0.2))
    assert found.joints[:-1] == model.joints
    assert found.joints[-1].name == "wrist"
    assert [spring.name for spring in found.springs] == ["s"]
    assert "model" not in yaml.to_text(found)
    assert read(tmp_path, yaml.to_text(found)) == found


def test_faults_of_the_model_point_at_the_model_line(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "arm.urdf").write_text(URDF)
    with pytest.raises(InputError) as caught:
        read(tmp_path, WITH_MODEL.replace("wrist", "turn"))
    (fault,) = caught.value.faults
    assert (fault.line, fault.column, fault.field) == (3, 8, "model")
    assert fault.message == "joint 'turn.x' of the model: 'turn.x' is also a coordinate of a spherical joint"
    (tmp_path / "parts" / "arm.urdf").write_text("<robot>")
    with pytest.raises(InputError) as caught:
        read(tmp_path, WITH_MODEL)
    first, *others = caught.value.faults
    assert (first.line, first.field) == (3, "model")
    assert all(fault.file == str(tmp_path / "parts" / "arm.urdf") for fault in others)
    assert others

"""Springs on joints that a simulator's settings hold act on the balance."""

from __future__ import annotations

import numpy as np
import pytest
from test_urdf import TWO, faults, inertial, joint, read

from equipoise.energy import Potential
from equipoise.model.elements import TorsionSpring
from equipoise.model.errors import EquipoiseWarning

SETTINGS = "<gazebo reference='j'><springStiffness>5</springStiffness><springReference>{}</springReference></gazebo>"
ARM = "<link name='a'/><link name='b'>" + inertial(3, origin="<origin xyz='.2 0 0'/>") + "</link>"


def test_a_spring_with_a_reference_angle() -> None:
    m = read(ARM + joint("continuous", "<axis xyz='0 -1 0'/>") + SETTINGS.format(1.2))
    assert m.springs == (TorsionSpring("j spring", (("j", 1.0),), 5.0, 1.2),)
    q = np.array([[0.0], [-1.0], [0.7]])
    by_hand = 3 * 9.81 * 0.2 * np.cos(q) + 5 * (q - 1.2)
    np.testing.assert_allclose(Potential(m)(q).torque, by_hand, atol=1e-12)


def test_the_new_names_and_no_reference() -> None:
    settings = "<gazebo reference='j'><spring_stiffness value='2'/></gazebo>"
    assert read(TWO + joint("continuous") + settings).springs == (TorsionSpring("j spring", (("j", 1.0),), 2.0),)


def test_other_joints_and_numbers() -> None:
    with pytest.warns(EquipoiseWarning, match="spring of 'j'.*on what is no turning joint is left out"):
        assert read(TWO + joint("prismatic", "<limit lower='0' upper='1'/>") + SETTINGS.format(0)).springs == ()
    text = f"<robot name='r'>{TWO}{joint('continuous')}{SETTINGS.format('half')}</robot>"
    assert "<springReference> of 'j' is no number: 'half'" in faults(text)[0]
    negative = SETTINGS.replace("5", "-5").format(0)
    (problem,) = faults(f"<robot name='r'>{TWO}{joint('continuous')}{negative}</robot>")
    assert "stiffness: must be more than 0 N m/rad, found -5" in problem

"""Motions: rest to rest along cubics."""

import numpy as np
import pytest

from equipoise.kinematics.motion import CubicMove, follow
from equipoise.model.errors import InputError


def test_the_cubic_is_that_of_lin2010():
    # Table 4, joint 4: from 0 to 1 rad between 1 and 3 s, printed coefficients 1, -2.25, 1.5, -0.25
    t = np.linspace(1, 3, 9)
    assert CubicMove("joint 4", 1, 3, 0, 1).at(t) == pytest.approx(1 - 2.25 * t + 1.5 * t**2 - 0.25 * t**3, abs=1e-14)


def test_held_before_between_and_after():
    moves = [CubicMove("b", 1, 2, 0.5, 1.5), CubicMove("b", 3, 4, 1.5, 0.0)]
    q = follow(("a", "b"), moves, np.array([0.0, 1.0, 1.5, 2.5, 3.5, 9.0]))
    assert q[:, 1] == pytest.approx([0.5, 0.5, 1.0, 1.5, 0.75, 0.0])
    assert not q[:, 0].any()


def test_no_such_coordinate():
    with pytest.raises(InputError, match="no coordinate 'c'"):
        follow(("a",), [CubicMove("c", 0, 1, 0, 1)], np.zeros(1))

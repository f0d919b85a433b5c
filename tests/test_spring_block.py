"""The moment matrix of the springs between two bodies: its form as a vector, and its cone."""

import numpy as np
import pytest
from robots import planar_arm

from equipoise.synthesis.convex.blocks import Block
from equipoise.synthesis.convex.spring_block import SpringBlock, smat, svec
from equipoise.synthesis.region import Region

BALL_AND_BOX = SpringBlock("world", "arm", Region.ball(0.2, (0, 0, 0.1)), Region.box((0.1, 0.05, 0.3), (0.2, 0, 0)))


def test_svec_keeps_the_inner_product_and_smat_undoes_it():
    A, B = np.random.default_rng(0).normal(size=(2, 5, 7, 7))
    A, B = A + A.swapaxes(1, 2), B + B.swapaxes(1, 2)
    assert np.einsum("ni,ni->n", svec(A), svec(B)) == pytest.approx(np.einsum("nij,nij->n", A, B))
    assert np.allclose(smat(svec(A)), A)


def test_slopes_are_central_differences():
    u = np.random.default_rng(1).uniform(-1, 1, (4, 6))
    slopes = BALL_AND_BOX.slopes(u)
    for i, h in enumerate(1e-6 * np.eye(6)):
        difference = (BALL_AND_BOX.part(u + h) - BALL_AND_BOX.part(u - h)) / 2e-6
        np.testing.assert_allclose(slopes[:, i], difference, atol=1e-9)  # a quadratic form: nothing but rounding


def test_quadratic_forms_do_what_their_columns_do():
    rng = np.random.default_rng(3)
    columns, u = rng.normal(size=(5, 28)), rng.uniform(-1, 1, (4, 6))
    form = BALL_AND_BOX.form(columns)
    assert BALL_AND_BOX.columns(form) == pytest.approx(columns)
    for found, expected in zip(BALL_AND_BOX.acts(form, u), Block.acts(BALL_AND_BOX, columns, u), strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-13)


def test_parts_in_their_regions_lie_in_the_cones_and_others_do_not():
    semidefinite, limits, products, *with_ball = BALL_AND_BOX.cones()
    u = BALL_AND_BOX.project(np.random.default_rng(2).uniform(-3, 3, (50, 6)))
    inside = BALL_AND_BOX.part(u).sum(axis=0)
    assert np.linalg.eigvalsh(smat(semidefinite.F @ inside)).min() > 0
    assert (limits.F @ inside >= 0).all()
    assert (products.F @ inside >= 0).all()
    assert len(with_ball) == 6
    for cone in with_ball:
        first, *others = cone.F @ inside
        assert first >= np.linalg.norm(others)
    for far in ([1.1, 0, 0, 0, 0, 0], [0.8, 0.8, 0, 0, 0, 0], [0, 0, 0, 1.1, 0, 0], [0, 0, 0, 0, 0, -1.1]):
        assert (limits.F @ BALL_AND_BOX.part(np.array([far]))[0] < 0).sum() == 1
    corner = BALL_AND_BOX.part(np.array([[0.0, 0, 0, 1, 1, 1]]))[0]
    assert (limits.F @ corner >= 0).all()  # a box, not a ball


@pytest.mark.parametrize("shape", ["ball", "box"])
def test_no_end_lies_outside_its_region_rounding_included(shape):
    rng = np.random.default_rng(4)
    arm = planar_arm([1.0], [0.4], [0.2])
    for _ in range(300):
        centre, size = rng.uniform(-2, 2, 3), float(np.exp(rng.uniform(-4, 1)))
        half = np.full(3, size) if shape == "ball" else size * rng.integers(0, 2, 3) * rng.uniform(0.1, 1, 3)
        region = Region(tuple(centre.tolist()), tuple(half.tolist()), shape)
        block = SpringBlock("world", "link2", region, region)
        u = block.project(5 * rng.normal(size=(1, block.shape)) * rng.integers(0, 2, block.shape))[0]
        (spring,) = block.add(arm, 100.0, u).springs
        off = np.abs(np.array([spring.p_a, spring.p_b]) - centre)
        assert (np.linalg.norm(off, axis=1) <= size).all() if shape == "ball" else (off <= half).all()
        whole = np.zeros((2, 3))
        whole[:, region.axes] = u.reshape(2, -1)
        np.testing.assert_allclose(off, half * np.abs(whole), rtol=1e-12, atol=1e-13)

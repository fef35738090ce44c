"""Triangle areas against shapely, shape gradients against the linear functions they differentiate."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from garmentcad.geometry.triangle import corner_shares, shape_gradients, signed_areas


def test_areas_agree_with_shapely_and_carry_the_sense_of_rotation() -> None:
    points = np.random.default_rng(1).normal(size=(30, 2))
    triangles = np.random.default_rng(2).permuted(np.tile(np.arange(30), (40, 1)), axis=1)[:, :3]
    areas = signed_areas(points, triangles)
    rings = [shapely.LinearRing(points[corners]) for corners in triangles]
    assert np.abs(areas) == pytest.approx([shapely.Polygon(ring).area for ring in rings], rel=1e-12)
    assert np.array_equal(areas > 0.0, [ring.is_ccw for ring in rings])


def test_gradients_differentiate_linear_fields_exactly() -> None:
    points = np.random.default_rng(3).normal(size=(12, 2))
    triangles = np.arange(12).reshape(4, 3)
    slope = np.array([0.7, -1.3])
    field = points @ slope + 5.0
    found = np.einsum("tk,tkd->td", field[triangles], shape_gradients(points, triangles))
    assert found == pytest.approx(np.tile(slope, (4, 1)), abs=1e-10)


@pytest.mark.parametrize("dimensions", [2, 3])
def test_corners_have_what_is_nearest_to_them(dimensions: int) -> None:
    """By 400 x 400 points in each of twenty triangles without an obtuse angle, in the plane and in space."""
    random = np.random.default_rng(3)
    corners = random.normal(size=(400, 3, dimensions))
    sides = np.roll(corners, -1, axis=1) - corners
    angles = -np.einsum("tkd,tkd->tk", sides, np.roll(sides, 1, axis=1))
    acute = corners[(angles > 0.0).all(axis=1)][:20]
    assert len(acute) == 20
    u, v = np.meshgrid((np.arange(400) + 0.5) / 400, (np.arange(400) + 0.5) / 400)
    root = np.sqrt(u.ravel())
    weights = np.stack([1.0 - root, root * (1.0 - v.ravel()), root * v.ravel()], axis=1)  # evenly over the area
    points = np.einsum("nk,tkd->tnd", weights, acute)
    nearest = np.linalg.norm(points[:, :, None] - acute[:, None], axis=3).argmin(axis=2)
    counted = np.stack([(nearest == corner).mean(axis=1) for corner in range(3)], axis=1)
    assert corner_shares(acute) == pytest.approx(counted, abs=3e-3)


def test_shares_of_obtuse_right_and_empty_triangles() -> None:
    obtuse, thin = [[0.0, 0.0], [10.0, 0.0], [-1.0, 1.0]], [[0.0, 0.0], [1e-7, 0.0], [0.5, 1.0]]
    right, point = [[0.0, 0.0], [3.0, 0.0], [0.0, 4.0]], [[2.0, 2.0]] * 3
    shares = corner_shares(np.array([obtuse, right, point, thin]))
    assert shares[:3] == pytest.approx(np.array([[0.5, 0.25, 0.25], [0.5, 0.25, 0.25], [1 / 3, 1 / 3, 1 / 3]]))
    assert shares.sum(axis=1) == pytest.approx(np.ones(4), rel=1e-15)

"""Triangle areas against shapely, shape gradients against the linear functions they differentiate."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from garmentcad.geometry.triangle import shape_gradients, signed_areas


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

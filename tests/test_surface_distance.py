"""Distances of surfaces against closed forms: shifted sheets, and a tube in a tube."""

from __future__ import annotations

import numpy as np
import pytest
from hand_made import flat, rectangles, tube

from garmentcad.analysis.surface_distance import Surface, surface_distance
from garmentcad.errors import InputError


def test_a_sheet_before_another_and_one_that_is_longer() -> None:
    cloth, finer = rectangles(6, 6, 0.02, 1, sewn=False), rectangles(12, 12, 0.01, 1, sewn=False)
    sheet = Surface(flat(cloth), cloth.particle_triangles)
    away = surface_distance(sheet, Surface(flat(finer) + np.array([0.0, 0.0, 0.007]), finer.particle_triangles))
    assert (away.rms_mm, away.max_mm) == pytest.approx((7.0, 7.0))
    slid = surface_distance(sheet, Surface(flat(finer) + np.array([0.0, 0.01, 0.0]), finer.particle_triangles))
    # one row of each sheet stands over by 10 mm: half the corners of 1 row of cells in 6, and of 1 in 12, of equal areas
    assert slid.max_mm == pytest.approx(10.0)
    assert slid.rms_mm == pytest.approx(10.0 * np.sqrt((0.5 / 6 + 0.5 / 12) / 2))
    assert (slid.from_first_mm > 0).sum() == 7
    assert (slid.from_second_mm > 0).sum() == 13


def test_tubes() -> None:
    cloth = rectangles(30, 5, 0.02, 2, sewn=True)
    inner, outer = (tube(cloth, 30, 2, lambda row, angle, radius=radius: np.full_like(angle, radius), lambda row: 0.02 * row) for radius in (0.19, 0.20))
    found = surface_distance(Surface(inner, cloth.particle_triangles), Surface(outer, cloth.particle_triangles))
    assert found.from_second_mm == pytest.approx(10.0)  # corners from corners
    assert found.from_first_mm == pytest.approx(200.0 * np.cos(np.pi / 60) - 190.0 * np.cos(np.pi / 60), abs=0.6)
    same = surface_distance(*[Surface(inner, cloth.particle_triangles)] * 2)
    assert (same.rms_mm, same.max_mm) == pytest.approx((0.0, 0.0), abs=1e-9)


def test_surfaces_without_area_have_no_distance() -> None:
    flat = Surface(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]), np.array([[0, 1, 2]], dtype=np.int32))
    with pytest.raises(InputError, match="area"):
        surface_distance(flat, flat)

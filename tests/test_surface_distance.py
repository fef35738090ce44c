"""Distances of surfaces against closed forms: shifted sheets, and a tube in a tube."""

from __future__ import annotations

import numpy as np
import pytest
from hand_made import flat, rectangles, tube

from garmentcad.analysis.surface_distance import surface_distance


def test_a_sheet_before_another_and_one_that_is_longer() -> None:
    cloth, finer = rectangles(6, 6, 0.02, 1, sewn=False), rectangles(12, 12, 0.01, 1, sewn=False)
    away = surface_distance(cloth, flat(cloth), finer, flat(finer) + np.array([0.0, 0.0, 0.007]))
    assert (away.rms_mm, away.max_mm) == pytest.approx((7.0, 7.0))
    slid = surface_distance(cloth, flat(cloth), finer, flat(finer) + np.array([0.0, 0.01, 0.0]))
    # one row of each sheet stands over: 7 of 49 particles by 10 mm, and 13 of 169
    assert slid.max_mm == pytest.approx(10.0)
    assert slid.rms_mm == pytest.approx(10.0 * np.sqrt((7 + 13) / (49 + 169)))
    assert (slid.from_first > 0).sum() == 7
    assert (slid.from_second > 0).sum() == 13


def test_tubes() -> None:
    cloth = rectangles(30, 5, 0.02, 2, sewn=True)
    inner, outer = (tube(cloth, 30, 2, lambda row, angle, radius=radius: np.full_like(angle, radius), lambda row: 0.02 * row) for radius in (0.19, 0.20))
    found = surface_distance(cloth, inner, cloth, outer)
    assert found.from_second == pytest.approx(0.01)  # corners from corners
    assert found.from_first == pytest.approx(0.2 * np.cos(np.pi / 60) - 0.19 * np.cos(np.pi / 60), abs=6e-4)
    same = surface_distance(cloth, inner, cloth, inner)
    assert (same.rms_mm, same.max_mm) == pytest.approx((0.0, 0.0), abs=1e-9)

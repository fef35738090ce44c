"""Hem height against a tilted and a wavy hem."""

from __future__ import annotations

import numpy as np
import pytest
from hand_made import rectangles, tube

from garmentcad.analysis.hem import hem_height, rest_lengths_mm


def test_level_and_tilted_hem() -> None:
    cloth = rectangles(20, 5, 0.01, 2, sewn=True)
    level = tube(cloth, 20, 2, lambda row, angle: np.full_like(angle, 0.1), lambda row: 0.6 + 0.01 * row)
    found = hem_height(cloth, level, ["front.hem", "back.hem"])
    assert found is not None
    assert (found.mean_mm, found.low_mm, found.high_mm) == pytest.approx((600.0, 600.0, 600.0))
    assert found.uneven_mm == pytest.approx(0.0, abs=1e-4)
    tilted = level.copy()
    tilted[:, 1] += 0.2 * tilted[:, 2]  # z runs from -0.1 to 0.1
    found = hem_height(cloth, tilted, ["front.hem", "back.hem"])
    assert found is not None
    assert (found.mean_mm, found.low_mm, found.high_mm) == pytest.approx((600.0, 580.0, 620.0))
    # a wave of 20 mm has 20/sqrt(2) mm of RMS; chords of a circle of 40 lie a little inside
    assert found.uneven_mm == pytest.approx(20.0 / 2.0**0.5, rel=0.005)


def test_mean_is_weighted_by_length_on_the_pattern() -> None:
    """One edge of two stretches, 10 mm and 30 mm long, at mean heights 5 and 20 mm: (10*5 + 30*20)/40."""
    cloth = rectangles(2, 1, 0.01, 1, sewn=False)
    uv = cloth.vertex_uv_mm.copy()
    uv[2, 0] = 40.0
    object.__setattr__(cloth, "vertex_uv_mm", uv)
    positions = np.zeros((cloth.particle_count, 3))
    positions[:3, 1] = [0.0, 0.010, 0.030]
    found = hem_height(cloth, positions, ["front.hem"])
    assert found is not None
    assert found.mean_mm == pytest.approx(16.25)
    # mean square of height: (10 * 10^2/3 + 30 * (10^2 + 10 * 30 + 30^2)/3) / 40
    assert found.uneven_mm**2 == pytest.approx((1000.0 / 3.0 + 13000.0) / 40.0 - 16.25**2)


def test_the_mouth_of_a_dart_is_no_hem() -> None:
    """Between the two stretches of an edge lie 20 mm whose ends are sewn together: 10 mm at 5 mm and 10 at 15, in the mean."""
    cloth = rectangles(3, 1, 0.01, 1, sewn=False)
    particle = cloth.vertex_particle.copy()
    particle[2] = particle[1]
    object.__setattr__(cloth, "vertex_particle", particle)
    positions = np.zeros((cloth.particle_count, 3))
    positions[:4, 1] = [0.0, 0.010, 9.0, 0.020]
    found = hem_height(cloth, positions, ["front.hem"])
    assert found is not None
    assert (found.mean_mm, found.low_mm, found.high_mm) == pytest.approx((10.0, 0.0, 20.0))
    assert rest_lengths_mm(cloth, cloth.edge_vertices["front.hem"]).tolist() == [10.0, 0.0, 10.0]


def test_no_hem() -> None:
    cloth = rectangles(2, 1, 0.01, 1, sewn=False)
    assert hem_height(cloth, np.zeros((6, 3)), []) is None
    with pytest.raises(KeyError):
        hem_height(cloth, np.zeros((6, 3)), ["front.nothing"])

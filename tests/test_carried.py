"""How far a waist came down and how far armholes are from the shoulders, on a tube whose place is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hand_made import cylinder_body, rectangles, tube

from garmentcad.analysis.carried import carried

CLOTH = rectangles(30, 40, 0.015, 2, sewn=True)
PLACED = tube(CLOTH, 30, 2, lambda row, angle: np.full_like(angle, 0.15), lambda row: 0.63 + 0.015 * row)
BODY = cylinder_body()


def test_a_waist_that_slid_down_is_measured_and_a_tilt_does_not_count() -> None:
    draped = PLACED - [0.0, 0.012, 0.0] + 0.05 * PLACED[:, :1] * [0.0, 1.0, 0.0]
    found = carried(CLOTH, PLACED[CLOTH.vertex_particle], draped, BODY, {"waist": ["front.hem", "back.hem"]})
    assert found.waist_drop_mm == pytest.approx(12.0, abs=1e-9)
    assert found.armhole_to_shoulder_mm == {"left": None, "right": None}


def test_armholes_are_measured_to_the_nearest_point_between_particles() -> None:
    left, right = (PLACED[CLOTH.vertex_particle[CLOTH.edge_vertices[f"{panel}.hem"]]] for panel in ("front", "back"))
    middle = 0.5 * (left[3] + left[4])
    body = replace(BODY, landmarks={"shoulder_point_left": middle - np.array([0.0, 0.02, 0.0]), "shoulder_point_right": right[3] - np.array([0.0, 0.03, 0.0])})
    found = carried(CLOTH, PLACED[CLOTH.vertex_particle], PLACED, body, {"armhole": ["front.hem", "back.hem"]})
    assert found.waist_drop_mm is None
    assert found.armhole_to_shoulder_mm == pytest.approx({"left": 20.0, "right": 30.0}, abs=1e-9)


def test_an_armhole_on_one_side_is_none_of_the_other() -> None:
    body = replace(BODY, landmarks={f"shoulder_point_{side}": np.array([x, 0.63, 0.0]) for side, x in (("left", 0.2), ("right", -0.2))})
    for panel, measured, other in (("front", "left", "right"), ("back", "right", "left")):
        found = carried(CLOTH, PLACED[CLOTH.vertex_particle], PLACED, body, {"armhole": [f"{panel}.hem"]})
        assert found.armhole_to_shoulder_mm == {measured: pytest.approx(50.0, abs=0.5), other: None}

"""Shadows of shapes whose area, rim and nodes are known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from garmentcad.rigs.shadow import cast_shadow, drape_coefficient


def fan(radius: np.ndarray, height: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """A disc of triangles around the axis whose rim lies at `radius` (N,) m."""
    angle = 2.0 * math.pi * np.arange(len(radius)) / len(radius)
    rim = np.column_stack([radius * np.cos(angle), np.full(len(radius), height), radius * np.sin(angle)])
    number = np.arange(len(radius))
    triangles = np.column_stack([np.full(len(radius), len(radius)), number, (number + 1) % len(radius)])
    return np.vstack([rim, [0.0, 0.0, 0.0]]), triangles


def test_a_flat_disc_drapes_not_at_all_and_one_that_hangs_straight_down_fully() -> None:
    flat = cast_shadow(*fan(np.full(720, 0.15)))
    assert drape_coefficient(flat.area_m2, 180.0, 300.0) == pytest.approx(100.0, abs=0.01)
    hanging = cast_shadow(*fan(np.full(720, 0.09), -0.06))
    assert drape_coefficient(hanging.area_m2, 180.0, 300.0) == pytest.approx(0.0, abs=0.01)
    assert flat.nodes == hanging.nodes == 0
    assert flat.rim_mm == pytest.approx(np.full(720, 150.0), abs=1e-3)


@pytest.mark.parametrize("folds", [3, 7])
def test_lobes_are_nodes_and_the_area_is_the_integral_of_the_rim(folds: int) -> None:
    angle = 2.0 * math.pi * np.arange(1440) / 1440
    shadow = cast_shadow(*fan(0.12 + 0.01 * np.cos(folds * angle)))
    assert shadow.nodes == folds
    assert shadow.area_m2 == pytest.approx(math.pi * (0.12**2 + 0.5 * 0.01**2), rel=1e-4)
    assert (shadow.rim_mm.max(), shadow.rim_mm.min()) == pytest.approx((130.0, 110.0), abs=0.01)


def test_a_fold_that_lies_over_another_counts_once_in_the_area() -> None:
    positions, triangles = fan(np.full(720, 0.1))
    twice = cast_shadow(np.vstack([positions, positions]), np.vstack([triangles, triangles + len(positions)]))
    assert twice.area_m2 == pytest.approx(cast_shadow(positions, triangles).area_m2, rel=1e-9)


def test_ripples_below_three_millimetres_are_no_nodes() -> None:
    angle = 2.0 * math.pi * np.arange(720) / 720
    assert cast_shadow(*fan(0.12 + 0.0014 * np.cos(9 * angle))).nodes == 0
    assert cast_shadow(*fan(0.12 + 0.0016 * np.cos(9 * angle))).nodes == 9

"""Polygons: areas and crossings against shapes known by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from garmentcad.geometry.curve import Arc, Line
from garmentcad.geometry.polygon import crossing_point, loop_points, signed_area

SQUARE = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])


def test_signed_area() -> None:
    assert signed_area(SQUARE) == 100.0
    assert signed_area(SQUARE[::-1]) == -100.0
    assert signed_area(SQUARE + 2.0**40) == 100.0  # far from the origin no digit is lost


def test_loop_points() -> None:
    half_disc = [Arc((100.0, 0.0), (-100.0, 0.0), (0.0, 0.0), False), Line((-100.0, 0.0), (100.0, 0.0))]
    points = loop_points(half_disc, 0.01)
    assert len({tuple(point) for point in points}) == len(points)
    area = math.pi * 1e4 / 2
    assert area - 100 * math.pi * 0.01 < signed_area(points) < area


def test_crossing_point() -> None:
    assert crossing_point(SQUARE) is None
    assert crossing_point(np.array([[0.0, 0.0], [10.0, 10.0], [10.0, 0.0], [0.0, 10.0]])) == pytest.approx((5.0, 5.0))  # a bow tie
    touching = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [5.0, 0.0], [0.0, 10.0]])
    assert crossing_point(touching) == pytest.approx((5.0, 0.0))
    spike = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 5.0], [20.0, 5.0], [10.0, 5.0], [10.0, 10.0], [0.0, 10.0]])
    assert crossing_point(spike) == pytest.approx((10.0, 5.0))

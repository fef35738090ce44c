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


def test_an_outline_that_runs_back_along_itself() -> None:
    """A curve that goes out and back within rounding of itself, as fuzzing found it: GEOS nodes it only on a grid."""
    steps = np.linspace(0.0, 1.0, 40)[:, None]
    a, b, c = np.array([200.0, 0.0]), np.array([200.0, 0.0]), np.array([100.0, 150.0])
    loop = 3.0 * (1.0 - steps) ** 2 * steps * b + 3.0 * (1.0 - steps) * steps**2 * c + ((1.0 - steps) ** 3 + steps**3) * a
    outline = np.vstack([[[0.0, 0.0], [200.0, 0.0], [200.0, 300.0], [0.0, 300.0]], loop[:-1], [[200.0, 0.0]]])
    assert crossing_point(outline) == pytest.approx((200.0, 0.0), abs=1e-5)

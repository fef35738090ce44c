"""Constrained triangulation against shapely's areas and against the definition of Delaunay, on regions with holes, inner points, needles and slits."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from garmentcad.geometry.triangle import signed_areas
from garmentcad.geometry.triangulate import TriangulationError, constrained_triangles


def ring(first: int, count: int) -> np.ndarray:
    numbers = np.arange(first, first + count)
    return np.stack([numbers, np.roll(numbers, -1)], axis=1)


def edge_set(triangles: np.ndarray) -> set[tuple[int, int]]:
    return {(int(t[k]), int(t[(k + 1) % 3])) for t in triangles for k in range(3)}


def worst_angle_sum(points: np.ndarray, triangles: np.ndarray) -> float:
    """Largest sum of the two angles opposite an inner edge: at most pi where the triangulation is Delaunay between its constraints."""
    opposite = {}
    for t in triangles.tolist():
        for k in range(3):
            a, b, c = points[t[k]], points[t[(k + 1) % 3]], points[t[(k + 2) % 3]]
            opposite[t[k], t[(k + 1) % 3]] = math.acos(np.clip(np.dot(a - c, b - c) / (math.dist(a, c) * math.dist(b, c)), -1, 1))
    return max((angle + opposite[edge[::-1]] for edge, angle in opposite.items() if edge[::-1] in opposite), default=0.0)


def check(points: np.ndarray, border: np.ndarray, area: float, used: int) -> np.ndarray:
    triangles = constrained_triangles(points, border)
    areas = signed_areas(points, triangles)
    assert areas.min() > 0.0
    assert areas.sum() == pytest.approx(area, rel=1e-9)
    edges = edge_set(triangles)
    assert len(edges) == 3 * len(triangles), "an edge is used twice in the same direction"
    assert {(int(a), int(b)) for a, b in border} <= edges
    rims = {edge for edge in edges if edge[::-1] not in edges}
    assert rims == {(int(a), int(b)) for a, b in border}
    assert len(np.unique(triangles)) == used
    assert worst_angle_sum(points, triangles) <= math.pi + 1e-4
    return triangles


def test_points_within_straight_sides_make_no_flat_triangles() -> None:
    side = np.arange(10.0)
    outline = np.concatenate([np.stack(pair, axis=1) for pair in ((side, 0 * side), (10 + 0 * side, side), (10 - side, 10 + 0 * side), (0 * side, 10 - side))])
    triangles = check(outline, ring(0, 40), 100.0, 40)
    assert signed_areas(outline, triangles).min() > 0.1


def test_square_grid_is_filled_whatever_the_ties() -> None:
    x, y = np.meshgrid(np.arange(8.0), np.arange(6.0))
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    number = np.arange(48).reshape(6, 8)
    around = np.concatenate([number[0, :-1], number[:-1, -1], number[-1, :0:-1], number[:0:-1, 0]])
    triangles = check(points, np.stack([around, np.roll(around, -1)], axis=1), 35.0, 48)
    assert signed_areas(points, triangles) == pytest.approx(np.full(70, 0.5))


def test_hole_touched_corner_to_corner_and_inner_points() -> None:
    # Two square holes that share a corner, as full cells do.
    outline = np.array([[0, 0], [10, 0], [10, 10], [0, 10]], dtype=float)
    lattice = np.array([[3, 3], [5, 3], [5, 5], [3, 5], [7, 5], [7, 7], [5, 7], [1.5, 8]], dtype=float)
    first, second = np.array([4, 7, 6, 5]), np.array([6, 10, 9, 8])  # clockwise: the region is outside them
    border = np.concatenate([ring(0, 4), np.stack([first, np.roll(first, -1)], axis=1), np.stack([second, np.roll(second, -1)], axis=1)])
    check(np.concatenate([outline, lattice]), border, 100.0 - 8.0, 12)


def test_narrow_slit() -> None:
    leg = np.linspace(0.0, 1.0, 12)[:-1, None]
    tip, left, right = np.array([50.0, 10.0]), np.array([49.9, 100.0]), np.array([50.1, 100.0])
    outline = np.concatenate([[[0.0, 0.0], [100.0, 0.0], [100.0, 100.0]], right + leg * (tip - right), tip + leg * (left - tip), [left], [[0.0, 100.0]]])
    check(outline, ring(0, len(outline)), shapely.Polygon(outline).area, len(outline))


def test_unconstrained_result_is_delaunay() -> None:
    points = np.random.default_rng(5).uniform(size=(40, 2))
    hull = shapely.MultiPoint(points).convex_hull
    corners = [int(np.argmin(np.hypot(*(points - corner).T))) for corner in hull.exterior.coords[-1:0:-1]]
    border = np.stack([corners, np.roll(corners, -1)], axis=1)
    triangles = check(points, border, hull.area, 40)
    for t in triangles:
        (ax, ay), (bx, by), (cx, cy) = points[t]
        lhs = 2 * np.array([[bx - ax, by - ay], [cx - ax, cy - ay]])
        center = np.linalg.solve(lhs, [bx**2 + by**2 - ax**2 - ay**2, cx**2 + cy**2 - ax**2 - ay**2])
        assert np.hypot(*(points - center).T).min() >= math.dist(points[t[0]], center) * (1 - 1e-6)


def test_crossing_and_open_borders_are_refused() -> None:
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    with pytest.raises(TriangulationError, match="cross"):
        constrained_triangles(square, np.array([[0, 2], [2, 1], [1, 3], [3, 0]]))
    with pytest.raises(TriangulationError, match="open"):
        constrained_triangles(square, np.array([[0, 1], [1, 2], [2, 3]]))
    with pytest.raises(TriangulationError):
        constrained_triangles(square, np.array([[0, 1], [2, 1], [2, 3], [3, 0]]))


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.integers(3, 60), st.floats(0.02, 0.95), st.integers(0, 30))
def test_random_stars(seed: int, count: int, spread: float, extra: int) -> None:
    random = np.random.default_rng(seed)
    shift = 0.4 if count > 3 else 0.2  # no gap of half a turn: the corners then go around counter-clockwise whatever their radii are
    angle = (np.arange(count) + shift * random.uniform(-1, 1, count)) * 2 * math.pi / count
    radius = 100 * (1 - spread * random.uniform(size=count))
    outline = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    polygon = shapely.Polygon(outline)
    inner = random.uniform(-100, 100, (extra, 2))
    inner = inner[shapely.contains_xy(polygon, *inner.T) & (shapely.distance(polygon.exterior, shapely.points(inner)) > 0.5)]
    check(np.concatenate([outline, inner]), ring(0, count), polygon.area, count + len(inner))

"""Closest-point kernels against dense sampling and closed forms, degenerate shapes included."""

from __future__ import annotations

import igl
import numpy as np
import pytest
import trimesh

from garmentcad.geometry.closest import CORNER, EDGE, FACE, closest_face, point_segment, point_triangle, segment_segment


def as_tuple(point: np.ndarray) -> tuple[float, float, float]:
    return float(point[0]), float(point[1]), float(point[2])


def shapes(rng: np.random.Generator, count: int) -> list[np.ndarray]:
    """Triples and more of points: general, on a coarse grid (degenerate and coplanar by the dozen), needles, and coincident."""
    found = []
    for k in range(count):
        points = rng.normal(0, 1, (4, 3))
        if k % 4 == 1:
            points = rng.integers(-1, 2, (4, 3)).astype(float)
        if k % 4 == 2:
            points[2] = points[0] + (points[1] - points[0]) * rng.uniform(-1, 2) + rng.normal(0, 1e-7, 3)
        if k % 4 == 3:
            points[rng.integers(4)] = points[rng.integers(4)]
        found.append(points)
    return found


def test_point_triangle_is_the_minimum() -> None:
    """Convex minimisation has one minimum: no sampled point of the triangle may be closer, and the weights must give the distance."""
    rng = np.random.default_rng(1)
    u = rng.dirichlet([0.7, 0.7, 0.7], 400)
    samples = np.concatenate([u, np.eye(3), *(np.stack([np.roll([t, 1 - t, 0], k) for t in np.linspace(0, 1, 60)]) for k in range(3))])
    for p, a, b, c in shapes(rng, 800):
        *weights, distance2, feature = point_triangle(*map(as_tuple, (p, a, b, c)))
        corners = np.stack([a, b, c])
        assert min(weights) >= 0.0
        assert sum(weights) == pytest.approx(1.0, abs=1e-12)
        foot = np.array(weights) @ corners
        assert np.linalg.norm(p - foot) == pytest.approx(np.sqrt(distance2), abs=1e-9)
        best = np.linalg.norm(samples @ corners - p, axis=1).min()
        assert np.sqrt(distance2) <= best + 1e-6  # a needle of 1e-7 counts as its edges
        zero = [k for k in range(3) if weights[k] == 0.0]
        if feature < EDGE:
            assert weights[feature - CORNER] == 1.0
        elif feature < FACE:
            assert zero == [(feature - EDGE + 2) % 3]
        else:
            assert not zero
            for side in (b - a, c - a):
                assert abs((p - foot) @ side) < 1e-6 * (1 + np.linalg.norm(side))


def test_point_triangle_closed_forms() -> None:
    a, b, c = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    assert point_triangle((0.25, 0.25, 2.0), a, b, c)[3:] == (4.0, FACE)
    assert point_triangle((2.0, -1.0, 0.0), a, b, c)[3:] == (2.0, CORNER + 1)
    assert point_triangle((0.5, -3.0, 4.0), a, b, c)[3:] == (25.0, EDGE)
    assert point_triangle((1.0, 1.0, 0.0), a, b, c)[3:] == (pytest.approx(0.5), EDGE + 1)
    # All corners in one place, and all on one line.
    assert point_triangle((3.0, 4.0, 0.0), a, a, a)[3] == 25.0
    assert point_triangle((5.0, 2.0, 0.0), a, b, (9.0, 0.0, 0.0))[3] == 4.0


def test_segment_segment_is_the_minimum() -> None:
    rng = np.random.default_rng(2)
    grid = np.linspace(0, 1, 41)
    for a, b, c, d in shapes(rng, 800):
        s, t, distance2 = segment_segment(*map(as_tuple, (a, b, c, d)))
        assert 0.0 <= s <= 1.0
        assert 0.0 <= t <= 1.0
        assert np.linalg.norm(a + s * (b - a) - c - t * (d - c)) == pytest.approx(np.sqrt(distance2), abs=1e-9)
        sampled = np.linalg.norm((a + grid[:, None] * (b - a))[:, None] - (c + grid[:, None] * (d - c))[None], axis=2).min()
        assert np.sqrt(distance2) <= sampled + 1e-9
        # And for every s the best t, exactly: a far finer sampling along one segment.
        for value in np.linspace(0, 1, 101):
            assert distance2 <= point_segment(as_tuple(a + value * (b - a)), as_tuple(c), as_tuple(d))[1] + 1e-9


def test_segment_segment_closed_forms() -> None:
    o, x = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)
    assert segment_segment(o, x, (0.3, -1.0, 2.0), (0.3, 1.0, 2.0)) == (pytest.approx(0.3), pytest.approx(0.5), pytest.approx(4.0))
    assert segment_segment(o, x, (2.0, 1.0, 0.0), (4.0, 1.0, 0.0)) == (1.0, 0.0, 2.0)
    assert segment_segment(o, x, (0.2, 3.0, 0.0), (0.6, 3.0, 0.0))[2] == 9.0  # parallel
    assert segment_segment(o, x, (0.5, 0.0, 0.0), (3.0, 0.0, 0.0))[2] == 0.0  # on one line
    assert segment_segment(o, o, x, x) == (0.0, 0.0, 1.0)
    assert segment_segment(o, x, (0.5, 0.0, 0.0), (0.5, 1e-300, 0.0))[2] == 0.0


def test_closest_face_is_that_of_libigl() -> None:
    body = trimesh.creation.icosphere(subdivisions=2)
    body.vertices *= [1.0, 2.0, 0.5]
    points = np.random.default_rng(5).uniform(-2.5, 2.5, (60, 3))
    squares, _, closest = igl.point_mesh_squared_distance(points, np.array(body.vertices), np.array(body.faces))
    for point, there, away in zip(points, closest, np.sqrt(squares)):
        face, *weights = closest_face(point, np.array(body.vertices), np.array(body.faces, dtype=np.int32))
        found = np.array(weights) @ body.vertices[body.faces[face]]
        assert min(weights) >= 0.0
        assert sum(weights) == pytest.approx(1.0, abs=1e-12)
        assert np.linalg.norm(found - point) == pytest.approx(away, abs=1e-9)
        assert np.allclose(found, there, rtol=0, atol=1e-7)

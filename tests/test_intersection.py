"""The judge of crossings against an independent checker, hand-made cases on the edge of rounding, and exact arithmetic."""

from __future__ import annotations

import ipctk
import numpy as np
import pytest
import trimesh

import garmentcad.geometry.intersection as intersection
from garmentcad.geometry.intersection import _cross_exactly, crossing_owners, crossing_triangle_pairs, crossing_triangle_pairs_between


def independent(positions: np.ndarray, triangles: np.ndarray) -> set[tuple[int, int]]:
    """Pairs without a common vertex that cross, by ipctk's edge-triangle test of all whose boxes touch."""
    found = set()
    low, high = positions[triangles].min(axis=1), positions[triangles].max(axis=1)
    for i, one in enumerate(triangles):
        for j in np.flatnonzero(((low[i] <= high) & (low <= high[i])).all(axis=1)).tolist():
            other = triangles[j]
            if j <= i or set(one) & set(other):
                continue
            for edges, face in ((one, other), (other, one)):
                for k in range(3):
                    p, q = positions[edges[k]], positions[edges[(k + 1) % 3]]
                    if ipctk.is_edge_intersecting_triangle(p, q, *positions[face]):
                        found.add((i, j))
    return found


def as_set(pairs: np.ndarray) -> set[tuple[int, int]]:
    return {(int(a), int(b)) for a, b in pairs}


@pytest.mark.parametrize("seed", range(4))
def test_soup_of_triangles_agrees_with_ipctk(seed: int) -> None:
    rng = np.random.default_rng(seed)
    centers = rng.uniform(-1, 1, (90, 1, 3))
    positions = (centers + rng.uniform(-0.6, 0.6, (90, 3, 3))).reshape(-1, 3)
    triangles = np.arange(270).reshape(-1, 3)
    expected = independent(positions, triangles)
    assert len(expected) > 50
    assert as_set(crossing_triangle_pairs(positions, triangles)) == expected


def test_between_two_meshes_agrees_with_ipctk() -> None:
    ball = trimesh.creation.icosphere(subdivisions=2, radius=1.0)
    other = trimesh.creation.icosphere(subdivisions=2, radius=0.7)
    shifted = other.vertices + np.array([0.61, 0.13, 0.07])
    pairs = crossing_triangle_pairs_between(ball.vertices, ball.faces, shifted, other.faces)
    joined = np.concatenate([ball.vertices, shifted])
    faces = np.concatenate([ball.faces, other.faces + len(ball.vertices)])
    expected = {(i, j - len(ball.faces)) for i, j in independent(joined, faces)}
    assert len(expected) > 20
    assert as_set(pairs) == expected
    assert len(crossing_triangle_pairs_between(ball.vertices, ball.faces, other.vertices, other.faces)) == 0


@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_flat_and_tilted_grids_are_clean(tilt: float) -> None:
    """Coplanar neighbours everywhere: nothing but doubt for orientation signs."""
    x, y = np.meshgrid(np.arange(40) * 0.01, np.arange(40) * 0.01)
    positions = np.stack([x.ravel(), y.ravel(), tilt * x.ravel() + 0.2 * tilt * y.ravel()], axis=1)
    corner = (np.arange(39)[:, None] * 40 + np.arange(39)).ravel()
    triangles = np.concatenate([np.stack([corner, corner + 1, corner + 41], 1), np.stack([corner, corner + 41, corner + 40], 1)])
    assert len(crossing_triangle_pairs(positions, triangles)) == 0


def test_gap_of_one_rounding_decides() -> None:
    """A vertex one floating point step above, on, and one below a tilted plane's triangle."""
    face = np.array([[0.1, 0.2, 0.7], [1.3, 0.2, 0.7], [0.1, 1.7, 0.7]])
    for z, crossing in ((np.nextafter(0.7, 1), 0), (0.7, 1), (np.nextafter(0.7, 0), 1)):
        needle = np.array([[0.4, 0.5, z], [0.4, 0.6, 2.0], [0.5, 0.5, 2.0]])
        pairs = crossing_triangle_pairs(np.concatenate([face, needle]), np.array([[0, 1, 2], [3, 4, 5]]))
        assert len(pairs) == crossing


def test_coplanar_triangles() -> None:
    base = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    for other, crossing in (
        ([[0.1, 0.1, 0], [0.3, 0.1, 0], [0.1, 0.3, 0]], 1),  # inside
        ([[-1.0, -1, 0], [4, -1, 0], [-1, 4, 0]], 1),  # around
        ([[0.5, 0.5, 0], [1, 1, 0], [0.5, 1, 0]], 1),  # touching the long edge
        ([[0.51, 0.5, 0], [1, 1, 0], [0.5, 1, 0]], 0),
        ([[0.2, 0.2, 1e-12], [0.3, 0.2, 1e-12], [0.2, 0.3, 1e-12]], 0),  # hovering
    ):
        pairs = crossing_triangle_pairs(np.concatenate([base, np.array(other)]), np.array([[0, 1, 2], [3, 4, 5]]))
        assert len(pairs) == crossing, other


def test_shared_vertex_counts_only_a_pass_through_the_inside() -> None:
    # Through the inside; beyond the far edge, which then passes through the other; on the far edge.
    fan = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, -0.2], [0.3, 0.3, 0.2], [0.6, 0.6, -0.2], [0.6, 0.6, 0.2], [0.5, 0.5, -0.2], [0.5, 0.5, 0.2]])
    for a, b, crossing in ((3, 4, 1), (5, 6, 1), (7, 8, 0)):
        assert len(crossing_triangle_pairs(fan, np.array([[0, 1, 2], [0, a, b]]))) == crossing


def test_filter_never_contradicts_exact_arithmetic() -> None:
    """Coordinates on a coarse grid, so that every second pair is degenerate: touching, coplanar or without area."""
    rng = np.random.default_rng(7)
    positions = rng.integers(0, 4, (600, 3)) * 0.1
    triangles = np.arange(600).reshape(-1, 3)
    found = as_set(crossing_triangle_pairs(positions, triangles))
    pairs = rng.integers(0, 200, (1500, 2))
    crossing = 0
    for i, j in pairs:
        if i < j:
            expected = _cross_exactly(positions, triangles[i], triangles[j])
            crossing += expected
            assert ((int(i), int(j)) in found) == expected
    assert crossing > 100


@pytest.mark.parametrize("seed", range(4))
def test_owners_that_cross_are_those_of_the_triangles_that_do(seed: int) -> None:
    """In space, and in one plane, where every verdict is in doubt."""
    rng = np.random.default_rng(seed)
    positions = (rng.uniform(-1, 1, (60, 1, 3)) + rng.uniform(-0.25, 0.25, (60, 3, 3))).reshape(-1, 3)
    triangles, owner = np.arange(180).reshape(-1, 3), rng.integers(0, 8, 60)
    for placed in (positions, positions * [1.0, 1.0, 0.0]):
        pairs = [tuple(pair) for pair in np.sort(owner[crossing_triangle_pairs(placed, triangles)], axis=1).tolist()]
        expected = sorted({(a, b) for a, b in pairs if a != b})
        assert len(expected) > 0
        found = crossing_owners(placed, triangles, owner)
        assert list(found) == expected
        assert all(1 <= found[pair] <= pairs.count(pair) for pair in expected)


def test_parts_that_lie_on_each_other_are_judged_exactly_once(monkeypatch: pytest.MonkeyPatch) -> None:
    x, y = np.meshgrid(np.arange(6.0), np.arange(6.0))
    sheet = np.column_stack([x.ravel(), y.ravel(), np.zeros(36)])
    corner = (np.arange(5)[:, None] * 6 + np.arange(5)).ravel()
    faces = np.concatenate([np.stack([corner, corner + 1, corner + 7], axis=1), np.stack([corner, corner + 7, corner + 6], axis=1)])
    judged = []
    monkeypatch.setattr(intersection, "_cross_exactly", lambda *of: judged.append(of) or _cross_exactly(*of))
    owner = np.repeat([0, 1, 2], 50)
    placed = np.concatenate([sheet, sheet, sheet + np.array([0.0, 0.0, 1.0])])
    assert crossing_owners(placed, np.concatenate([faces, faces + 36, faces + 72]), owner) == {(0, 1): 1}
    assert len(judged) == 1


def test_nothing_in_nothing_out() -> None:
    assert crossing_triangle_pairs(np.zeros((0, 3)), np.zeros((0, 3), dtype=int)).shape == (0, 2)

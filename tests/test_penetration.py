"""Signed distances against libigl and closed forms."""

from __future__ import annotations

import igl
import numpy as np
import pytest
import trimesh

from garmentcad.analysis.penetration import distances_and_normals, penetration_mm, signed_distances


def bumpy(seed: int) -> trimesh.Trimesh:
    """A closed star-shaped body with hollows and ridges."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    rng = np.random.default_rng(seed)
    wave = sum(np.cos(ball.vertices @ rng.normal(0, 4, 3) + rng.uniform(0, 6)) for _ in range(4))
    return trimesh.Trimesh(ball.vertices * (1 + 0.12 * wave)[:, None], ball.faces, process=False)


@pytest.mark.parametrize("seed", range(3))
def test_against_libigl(seed: int) -> None:
    body = bumpy(seed)
    rng = np.random.default_rng(seed + 10)
    near = body.vertices[rng.integers(0, len(body.vertices), 1500)] + rng.normal(0, 0.05, (1500, 3))
    points = np.concatenate([near, rng.uniform(-2, 2, (500, 3))])
    found = igl.signed_distance(points, np.asarray(body.vertices), np.asarray(body.faces), sign_type=igl.SIGNED_DISTANCE_TYPE_WINDING_NUMBER)
    expected, closest = found[0], found[2]
    ours, normals = distances_and_normals(points, body.vertices, body.faces)
    assert (expected < 0).sum() > 300
    np.testing.assert_allclose(ours, expected, atol=1e-12)
    np.testing.assert_allclose(points - ours[:, None] * normals, closest, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-9)


def test_box_sides_edges_and_corners() -> None:
    box = trimesh.creation.box(extents=(2, 2, 2))
    points = np.array([[0.0, 0, 0.9], [0, 0, 1.5], [2, 2, 0], [2, 2, 2], [1.0, 1.0, 0.3], [0.9, 0.95, 0.0], [1.0, 1.0, 1.0]])
    expected = [-0.1, 0.5, np.sqrt(2), np.sqrt(3), 0.0, -0.05, 0.0]
    np.testing.assert_allclose(signed_distances(points, box.vertices, box.faces), expected, atol=1e-15)
    # on the surface no vector leads from the closest point: a face's normal serves
    on = np.array([[1.0, 0.3, 0.2], [1.0, 1.0, 0.3], [-0.2, 0.1, -1.0]])
    normals = distances_and_normals(on, box.vertices, box.faces)[1]
    np.testing.assert_allclose(normals[[0, 2]], [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0]], atol=1e-12)
    assert sorted(normals[1].tolist()) == pytest.approx([0.0, 0.0, 1.0])


def test_sphere_depth_at_particles_and_between_them() -> None:
    ball = trimesh.creation.icosphere(subdivisions=5, radius=0.1)
    level = np.array([[-0.03, -0.02, 0], [0.03, -0.02, 0], [0.0, 0.04, 0]])
    triangles = np.array([[0, 1, 2]])
    assert penetration_mm(level + np.array([0, 0, 0.102]), triangles, ball.vertices, ball.faces) == 0.0
    # Corners outside, the inner points r = 0.0204 from the axis 1.3 mm inside.
    raised = level + np.array([0, 0, 0.0965])
    inner = raised.T @ np.array([2 / 3, 1 / 6, 1 / 6])
    assert (np.linalg.norm(raised, axis=1) > 0.1).sum() == 3
    expected = 1000 * (0.1 - np.linalg.norm([raised.T @ np.roll([2 / 3, 1 / 6, 1 / 6], k) for k in range(3)], axis=1).min())
    assert expected > 1000 * (0.1 - np.linalg.norm(inner)) - 1e-9
    assert penetration_mm(raised, triangles, ball.vertices, ball.faces) == pytest.approx(expected, abs=0.12)
    assert expected > 1.0

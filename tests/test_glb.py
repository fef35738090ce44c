"""GLB read back by trimesh."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from hand_made import cylinder_body, rectangles, tube

from garmentcad.export.glb import write_garment_glb
from garmentcad.export.normals import particle_normals, split_at_creases


def test_panels_and_mannequin(tmp_path: Path) -> None:
    cloth = rectangles(12, 7, 0.01, 2, sewn=True)
    positions = tube(cloth, 12, 2, lambda row, angle: np.full_like(angle, 0.13), lambda row: 0.6 + 0.01 * row)
    body = cylinder_body()
    scene = trimesh.load(write_garment_glb(tmp_path / "garment.glb", cloth, positions, body))
    assert set(scene.geometry) == {"panel_front", "panel_back", "mannequin"}
    panels = [scene.geometry["panel_front"], scene.geometry["panel_back"]]
    expected = trimesh.Trimesh(positions, cloth.particle_triangles, process=False).area
    assert sum(panel.area for panel in panels) == pytest.approx(expected, rel=1e-6)
    assert [len(panel.vertices) for panel in panels] == [13 * 8] * 2
    assert panels[0].visual.uv == pytest.approx(cloth.vertex_uv_mm[: 13 * 8] / 1000.0, abs=1e-6)
    assert panels[0].visual.material.doubleSided
    assert scene.geometry["mannequin"].volume == pytest.approx(trimesh.Trimesh(body.vertices, body.faces).volume, rel=1e-5)


def test_normals_of_a_tube_point_outward() -> None:
    cloth = rectangles(30, 5, 0.01, 2, sewn=True)
    positions = tube(cloth, 30, 2, lambda row, angle: np.full_like(angle, 0.13), lambda row: 0.6 + 0.01 * row)
    normals = particle_normals(positions, cloth.particle_triangles)
    radial = positions * [1.0, 0.0, 1.0] / 0.13
    assert np.einsum("pd,pd->p", normals, radial).min() > 0.998
    assert (particle_normals(np.zeros((3, 3)), np.array([[0, 1, 2]])) == 0.0).all()


@pytest.mark.parametrize(("angle_deg", "split"), [(85.0, False), (95.0, True)])
def test_shading_stops_at_a_crease(angle_deg: float, split: bool) -> None:
    """A strip of 2 x 6 squares, folded over its middle line: three particles there, of which a crease makes six; one square is turned over."""
    x, y = np.meshgrid(np.arange(7.0), np.arange(3.0))
    angle = np.radians(angle_deg)
    positions = np.column_stack([np.where(x <= 3, x, 3 + (x - 3) * np.cos(angle)).ravel(), y.ravel(), np.where(x <= 3, 0.0, (x - 3) * np.sin(angle)).ravel()])
    quads = np.array([[7 * j + i, 7 * j + i + 1, 7 * j + i + 8, 7 * j + i + 7] for j in range(2) for i in range(6)])
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    triangles[::12] = triangles[::12, ::-1]
    particle, corners = split_at_creases(positions, triangles)
    assert (particle[corners] == triangles).all()
    assert np.bincount(particle).tolist() == [2 if split and k % 7 == 3 else 1 for k in range(21)]
    if split:
        corners[::12] = corners[::12, ::-1]
        normals = particle_normals(positions[particle], corners)
        sizes = np.abs(normals @ [-np.sin(angle), 0.0, np.cos(angle)]), np.abs(normals[:, 2])
        assert np.maximum(*sizes) == pytest.approx(1.0)


def test_a_crease_in_a_panel_has_two_normals(tmp_path: Path) -> None:
    """A tube pressed flat: the rows of particles along both of its ridges have a normal of each side."""
    cloth = rectangles(12, 7, 0.01, 2, sewn=True)
    positions = tube(cloth, 12, 2, lambda row, angle: np.full_like(angle, 0.13), lambda row: 0.6 + 0.01 * row)
    positions[:, 2] *= 1e-3
    scene = trimesh.load(write_garment_glb(tmp_path / "garment.glb", cloth, positions))
    assert sum(len(panel.vertices) for panel in scene.geometry.values()) == 2 * 13 * 8 + 2 * 8

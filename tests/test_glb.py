"""GLB read back by trimesh."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from hand_made import cylinder_body, rectangles, tube

from garmentcad.export.glb import write_garment_glb
from garmentcad.export.normals import particle_normals


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

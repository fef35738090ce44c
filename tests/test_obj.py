"""OBJ files read back by an independent library."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hand_made import cylinder_body, rectangles, tube

from garmentcad.errors import MeshError
from garmentcad.export.obj import read_garment_obj, read_mannequin_obj, write_garment_obj, write_mannequin_obj


def test_garment_read_back(tmp_path: Path) -> None:
    cloth = rectangles(12, 7, 0.01, 2, sewn=True)
    positions = tube(cloth, 12, 2, lambda row, angle: 0.1 + 0.01 * np.cos(3 * angle), lambda row: 0.6 + row / 99.0)
    path = write_garment_obj(tmp_path / "garment.obj", cloth, positions)
    lines = path.read_text().splitlines()
    assert sum(line.startswith("v ") for line in lines) == cloth.particle_count
    assert sum(line.startswith("vt ") for line in lines) == len(cloth.vertex_uv_mm)
    assert [line for line in lines if line.startswith("g ")] == ["g front", "g back"]
    groups = "\n".join(lines).split("\ng ")[1:]
    assert [group.count("\nf ") for group in groups] == [2 * 12 * 7] * 2
    mesh = trimesh.load(path, process=False)
    assert len(mesh.faces) == len(cloth.triangles)
    assert mesh.area == pytest.approx(trimesh.Trimesh(positions, cloth.particle_triangles, process=False).area, rel=1e-7)
    uv = np.asarray(mesh.visual.uv)[mesh.faces]
    flat = 0.5 * np.cross(np.append(uv[:, 1] - uv[:, 0], np.zeros((len(uv), 1)), 1), np.append(uv[:, 2] - uv[:, 0], np.zeros((len(uv), 1)), 1))[:, 2]
    assert flat == pytest.approx(np.full(len(cloth.triangles), 50.0))  # mm2, half a cell
    mesh = trimesh.load(path, process=True, merge_tex=True, merge_norm=True)
    assert len(mesh.vertices) == cloth.particle_count  # seam vertices are shared: the tube has two rims and no side openings
    assert mesh.euler_number == 0


def test_nine_digits(tmp_path: Path) -> None:
    cloth = rectangles(1, 1, 0.01, 1, sewn=False)
    positions = np.full((4, 3), 1.0 / 3.0)
    assert "v 0.333333333 0.333333333 0.333333333" in write_garment_obj(tmp_path / "a.obj", cloth, positions).read_text()


def test_mannequin_read_back(tmp_path: Path) -> None:
    body = cylinder_body()
    path = write_mannequin_obj(tmp_path / "mannequin.obj", body)
    mesh = trimesh.load(path, process=False)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(trimesh.Trimesh(body.vertices, body.faces).volume, rel=1e-8)
    assert mesh.volume > 0.0  # faces keep looking outward
    again = read_mannequin_obj(path)
    assert again.vertices == pytest.approx(body.vertices, abs=1e-9)
    assert (again.faces == body.faces).all()
    assert again.part_names == ("torso",)


@pytest.mark.parametrize(
    "text", ["", "v 0 0\n", "g a\nv 0 0 0\nf 1 2 3\n", "g a\nv nan 0 0\nf 1 1 1\n", "v 0 0 0\nf 1 1 1\n", "g\n", "g a\nf 9999999999999 1 1\n"]
)
def test_foreign_mannequin_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "mannequin.obj"
    path.write_text(text)
    with pytest.raises(MeshError, match=r"mannequin\.obj"):
        read_mannequin_obj(path)


def test_a_garment_beyond_all_bounds_is_refused(tmp_path: Path) -> None:
    (tmp_path / "garment.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1e300 0\nf 1/1 2/2 3/3\n")
    with pytest.raises(MeshError, match="is not a garment written by garmentcad"):
        read_garment_obj(tmp_path / "garment.obj")


@pytest.mark.parametrize("reader", [read_garment_obj, read_mannequin_obj])
@pytest.mark.parametrize("text", ["v 0 0\nv 1 0\nv 0 1\ng a\nf 1 2 2\n", "v 0 0 0\nv 1 0 0\nv 0 1 0\ng a\nf 1 2\nf 2 3\nf 3 1\n"], ids=["points", "edges"])
def test_numbers_that_only_fit_in_all_are_refused(reader: Callable[[Path], object], text: str, tmp_path: Path) -> None:
    """Three points of two numbers are not two points of three."""
    (tmp_path / "a.obj").write_text(text)
    with pytest.raises(MeshError, match="points of three numbers and triangles are wanted"):
        reader(tmp_path / "a.obj")

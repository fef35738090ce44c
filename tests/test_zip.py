"""Zips: what of them is joined, by length, and what stays an outline."""

from __future__ import annotations

import numpy as np
import pytest
from test_hardware import FRONT, PEGS, job

from garmentcad.cloth.contour import sample_contours
from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.weld import weld
from garmentcad.simulation.materials import lay_out


def test_a_zip_joins_its_closed_part_and_leaves_the_rest_open() -> None:
    """Closed over 60 mm of 120 from below: pairs up to there are one particle, those above are two, and the opening shows on the body."""
    made = job(lambda data: data.update(closures=[{"name": "fly", "zip": {"a": FRONT["a"][::-1], "b": FRONT["b"][::-1]}, "closed": 0.5}], pins=PEGS[:1]))
    materials, material_of = lay_out(made)
    flat = build_cloth(made.pattern, material_of, materials, 20.0)
    cloth, _ = weld(flat)
    left, right = (cloth.edge_vertices[f"{name}.front"] for name in ("left", "right"))
    right = right[np.argsort(cloth.vertex_uv_mm[right, 1])]
    left = left[np.argsort(cloth.vertex_uv_mm[left, 1])]
    joined = cloth.vertex_particle[left] == cloth.vertex_particle[right]
    assert joined.tolist() == [height <= 60.0 + 1e-6 for height in cloth.vertex_uv_mm[left, 1]]
    for share, pairs in ((0.0, 0), (1.0, len(left))):
        fly = {"name": "fly", "zip": {"a": FRONT["a"], "b": FRONT["b"]}, "closed": share}
        other = job(lambda data, fly=fly: data.update(closures=[fly]))
        stitched = build_cloth(other.pattern, material_of, materials, 20.0)
        assert (stitched.seam_names[-1], int((stitched.stitch_seam == 1).sum())) == ("fly", pairs)


def test_a_zip_is_closed_by_length_and_its_open_part_is_an_outline() -> None:
    """Two notches near the top put samples there: half of the length is closed all the same. What is open bends as an edge of the panel does."""
    front = {"a": FRONT["a"][::-1], "b": FRONT["b"][::-1]}
    notches = [{"edge": "front", "at": at, "name": f"n{k}"} for k, at in enumerate((0.85, 0.9, 0.95))]
    made = job(lambda data: (data.update(closures=[{"name": "fly", "zip": front, "closed": 0.5}]), data["panels"]["left"].update(notches=notches)))
    materials, material_of = lay_out(made)
    flat = build_cloth(made.pattern, material_of, materials, 20.0)
    assert made.pattern.seams[-1].closed == 0.5
    closed = flat.stitches[flat.stitch_seam == flat.seam_names.index("fly")]
    assert flat.vertex_uv_mm[closed.ravel(), 1].max() == pytest.approx(60.0, abs=10.0)
    contours, _ = sample_contours(made.pattern, 20.0)
    for name in ("left", "right"):
        contour = contours[name]
        number = [edge.name for edge in made.pattern.panels[name].edges].index("front")
        segments = contour.edge_points[number][:-1]
        heights = contour.points_mm[contour.segments[segments]][:, :, 1].mean(axis=1)
        assert contour.sewn[segments].tolist() == [height < 60.0 for height in heights]

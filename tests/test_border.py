"""Border triangles: exact under any affine map, areas and patches by brute force."""

from __future__ import annotations

import numpy as np
import pytest
from drawn import GRAINS, disc, mesh, rectangle

from garmentcad.cloth.border import border_triangles


@pytest.mark.parametrize("grain", GRAINS)
def test_affine_maps_are_exact(grain: float) -> None:
    made = mesh(rectangle(150.0, 50.0, grain), 10.0)
    border = border_triangles(made, np.zeros(len(made.triangles), dtype=np.int32))
    affine = np.random.default_rng(0).normal(size=(3, 2))  # weft and warp columns
    x = made.points * 1e-3 @ affine.T
    for gradient, column in ((border.weft_gradient, 0), (border.warp_gradient, 1)):
        found = np.einsum("tk,tkd->td", gradient, x[border.corners])
        assert found == pytest.approx(np.tile(affine[:, column], (len(found), 1)), abs=1e-12)


def test_areas_fill_the_strip() -> None:
    made = mesh(disc(150.0, 20.0), 10.0)
    border = border_triangles(made, np.zeros(len(made.triangles), dtype=np.int32))
    assert border.area.sum() == pytest.approx((made.contour.polygon.area - len(made.cells) * 100.0) * 1e-6, rel=1e-9)


def test_patches_are_the_triangles_around_a_lattice_point_or_two_neighbours_on_the_contour() -> None:
    made = mesh(rectangle(150.0, 50.0, 30.0), 10.0)
    material = (made.points[made.triangles][..., 0].mean(axis=1) > 40.0).astype(np.int32)
    border = border_triangles(made, material)
    first = made.lattice_count
    pairs = [np.arange(k, min(k + 2, len(made.points))) for k in range(first, len(made.points), 2)]
    groups = [np.array([k]) for k in range(first) if (border.corners == k).any()] + pairs
    assert len(border.patch_start) == len(groups) + 1
    for number, group in enumerate(groups):
        mine = np.isin(border.corners, group)
        around = np.repeat(np.arange(len(mine)), mine.sum(axis=1))  # a triangle with two corners in the patch counts twice
        assert border.patch_triangle[border.patch_start[number] : border.patch_start[number + 1]].tolist() == around.tolist()
        assert np.array_equal(mine, border.patch == number)
        in_first = border.area[around][material[around] == 0].sum()
        if in_first != pytest.approx(0.5 * border.area[around].sum()):
            assert border.patch_material[number] == (0 if in_first > 0.5 * border.area[around].sum() else 1)

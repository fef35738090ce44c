"""Gathers: the strip beside a gathered seam rests as long as the seam, however that lies to the grain, and nothing else changes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn import materials, pattern, rectangle

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.gathers import EASED
from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.weld import weld
from garmentcad.pattern.pattern import EdgeUse, Seam
from garmentcad.simulation.job import make_job
from garmentcad.simulation.lattices import grids_of

MATERIALS = materials(0.12)
LONG_MM = 300.0


def unsewn(seam_mm: tuple[float, ...], grain_deg: float = 0.0, swapped: bool = False) -> tuple[Cloth, Cloth]:
    """The top of a panel sewn to bands so long, the second one caught in the seam of the first: as laid out, and with the rest lengths of what is welded."""
    panels = [rectangle(LONG_MM, 120.0, grain_deg, name="skirt"), *(rectangle(length, 40.0, name=f"band{k}") for k, length in enumerate(seam_mm))]
    top = (EdgeUse("skirt", 2, False),)
    seams = []
    for k in range(len(seam_mm)):
        sides = top, (EdgeUse(f"band{k}", 0, True),)
        seams.append(Seam(f"seam{k}", *(sides[::-1] if swapped else sides), caught_in="seam0" if k else None))
    cloth = build_cloth(pattern(*panels, seams=tuple(seams)), lambda _, points: np.zeros(len(points), dtype=np.int32), MATERIALS, 10.0)
    return cloth, replace(cloth, border=weld(cloth)[0].border._replace(corners=cloth.border.corners))


def changed(before: Cloth, after: Cloth) -> np.ndarray:
    """Border triangles whose rest lengths differ."""
    warp, weft = after.border.warp_gradient - before.border.warp_gradient, after.border.weft_gradient - before.border.weft_gradient
    return np.flatnonzero(np.abs(np.hstack([warp, weft])).max(axis=1) > 1e-9)


def stretches(cloth: Cloth, rows: np.ndarray, ratio: float) -> np.ndarray:
    """How long border triangles are, over their rest lengths, in the directions in which they are longest and shortest (T,2), where the whole pattern lies flat
    and is drawn together along the seam, which runs along x, to 1/ratio."""
    places = 1e-3 * cloth.vertex_uv_mm * [1.0 / ratio, 1.0]
    vectors = [
        np.einsum("tk,tkx->tx", gradient[rows], places[cloth.border.corners[rows]]) for gradient in (cloth.border.warp_gradient, cloth.border.weft_gradient)
    ]
    return np.linalg.svd(np.stack(vectors, axis=2), compute_uv=False)


@pytest.mark.parametrize("grain_deg", [0.0, 25.0, 90.0])
@pytest.mark.parametrize("swapped", [False, True])
def test_triangles_on_the_seam_are_at_rest_at_its_length(grain_deg: float, swapped: bool) -> None:
    before, after = unsewn((200.0,), grain_deg, swapped)
    rows = changed(before, after)
    on_top = np.isclose(before.vertex_uv_mm[before.border.corners, 1], 120.0) & (before.vertex_panel[before.border.corners] == 0)
    assert np.array_equal(rows, np.flatnonzero(on_top.sum(axis=1) == 2))
    assert len(rows) == len(before.stitches) - 1
    assert np.allclose(stretches(before, rows, 1.5), [1.0, 1.0 / 1.5], atol=1e-9)
    assert np.allclose(stretches(after, rows, 1.5), 1.0, atol=1e-9)
    assert np.array_equal(before.border.area, after.border.area)


@pytest.mark.parametrize(("seam_mm", "some"), [(LONG_MM / EASED + 0.1, False), (LONG_MM / EASED - 0.1, True), (LONG_MM, False)])
def test_what_is_eased_in_keeps_its_rest_lengths(seam_mm: float, some: bool) -> None:
    assert (len(changed(*unsewn((seam_mm,)))) > 0) == some


def test_of_layers_in_one_seam_the_shortest_counts() -> None:
    before, after = unsewn((240.0, 200.0))
    rows = changed(before, after)
    rows = rows[before.vertex_panel[before.border.corners[rows, 0]] == 0]
    assert np.allclose(stretches(after, rows, 1.5), 1.0, atol=1e-9)


@pytest.mark.parametrize(
    ("band_mm", "grid_mm", "grids"), [(600.0, 10.0, (20.0, 10.0)), (510.0, 10.0, (20.0, 10.0)), (400.0, 10.0, (10.0,)), (400.0, 5.0, (10.0, 5.0))]
)
def test_gathers_are_sewn_on_no_coarse_lattice(band_mm: float, grid_mm: float, grids: tuple[float, ...]) -> None:
    """A skirt 600 mm wide on bands of these lengths, either side of its seam named first. Eased by 1.18 to 1 it is sewn as before."""
    for sides in ((("skirt", 2, False), ("band", 0, True)), (("band", 0, False), ("skirt", 2, True))):
        seam = Seam("waist", *((EdgeUse(*side),) for side in sides))
        sewn = pattern(rectangle(600.0, 500.0, name="skirt"), rectangle(band_mm, 40.0, name="band"), seams=(seam,))
        assert grids_of(replace(make_job("flared-skirt", grid_mm=grid_mm), pattern=sewn)) == grids

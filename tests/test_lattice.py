"""Cloth from patterns: masses, areas, exactness under affine maps, materials by region, numbering, refused input."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from drawn import GRAINS, disc, materials, panel, pattern, rectangle
from elastic import linear

from garmentcad.arrays import floats
from garmentcad.cloth.cloth import WARP, WEFT, Cloth
from garmentcad.cloth.contour import sample_contours
from garmentcad.cloth.lattice import build_cloth, panel_cloth, rectangle_cloth
from garmentcad.cloth.panel_mesh import to_grain
from garmentcad.errors import GarmentError, InputError, LimitError, SpecError
from garmentcad.forces.internal import internal_forces
from garmentcad.geometry.triangle import signed_areas
from garmentcad.pattern.pattern import EdgeUse, Seam

MATERIALS = materials(0.12, 0.30)
DART = [(0, 0), (300, 0), (300, 200), (165, 200), (150, 100), (135, 200), (0, 200)]


def one_material(_, points: np.ndarray) -> np.ndarray:
    return np.zeros(len(points), dtype=int)


def two_panels(grid: float = 10.0) -> Cloth:
    seams = (Seam("side", (EdgeUse("front", 1, False),), (EdgeUse("back", 3, True),), fold_angle_deg=30.0, bend_factor=3.0),)
    return build_cloth(pattern(panel(DART, 10.0), rectangle(150, 210, -20.0, name="back"), seams=seams), one_material, MATERIALS, grid)


@pytest.mark.parametrize("grain", GRAINS)
@pytest.mark.parametrize("drawn", [rectangle(150, 50), panel(DART), disc(150.0), rectangle(60, 8)], ids=["strip", "dart", "disc", "tape"])
def test_mass_is_area_times_areal_mass(drawn, grain: float) -> None:
    drawn = replace(drawn, grain_deg=grain)
    cloth = panel_cloth(drawn, MATERIALS, 1)
    area = sample_contours(pattern(drawn), 10.0)[0][drawn.name].polygon.area * 1e-6
    assert cloth.masses.sum() == pytest.approx(0.30 * area, rel=1e-13)
    assert cloth.masses.min() > 0.0
    assert cloth.cells.shear_area.sum() + cloth.border.area.sum() == pytest.approx(area, rel=1e-9)
    if len(cloth.cells.corners):
        assert cloth.cells.twist_area.sum() == pytest.approx(area, rel=1e-9)
    contact = signed_areas(cloth.vertex_uv_mm, cloth.triangles)
    assert contact.min() > 0.0
    assert contact.sum() * 1e-6 == pytest.approx(area, rel=1e-9)


@pytest.mark.parametrize(("width", "height"), [(153.7, 71.3), (206.0, 60.4), (150.0, 80.0)])
def test_particles_of_a_straight_edge_weigh_alike(width: float, height: float) -> None:
    """Whichever way the diagonals of its strip run: along each edge, but for its ends, as the area over the length of a piece says within 15 %."""
    cloth = panel_cloth(rectangle(width, height), MATERIALS, 1)
    for axis, far in ((1, 0.0), (1, height), (0, 0.0), (0, width)):
        on_edge = cloth.vertex_on_contour & (np.abs(cloth.vertex_uv_mm[:, axis] - far) < 1e-6)
        along = cloth.vertex_uv_mm[:, 1 - axis]
        inner = on_edge & (along > 20.0) & (along < (width, height)[1 - axis] - 20.0)
        nearest = np.abs(cloth.vertex_uv_mm[~cloth.vertex_on_contour][:, axis] - far).min()
        piece = np.diff(np.sort(along[on_edge])).mean()
        assert inner.sum() > 1
        assert cloth.masses[cloth.vertex_particle[inner]] == pytest.approx(np.full(inner.sum(), 0.30 * 0.5 * nearest * piece * 1e-6), rel=0.15)


@pytest.mark.parametrize("grain", GRAINS)
def test_affine_maps_are_exact_in_links_cells_and_triangles(grain: float) -> None:
    cloth = panel_cloth(panel(DART, grain), MATERIALS)
    columns = np.random.default_rng(1).normal(size=(3, 2))  # images of the weft and of the warp unit vector
    x = to_grain(cloth.vertex_uv_mm, grain) * 1e-3 @ columns.T
    weft, warp = columns.T
    along = (x[cloth.links.ends[:, 1]] - x[cloth.links.ends[:, 0]]) / cloth.links.rest_length[:, None]
    assert along == pytest.approx(np.where((cloth.links.direction == WARP)[:, None], warp, weft), abs=1e-12)
    c = x[cloth.cells.corners]
    spacing = cloth.cells.spacing[:, None]
    assert (c[:, 1] + c[:, 2] - c[:, 0] - c[:, 3]) / (2 * spacing) == pytest.approx(np.tile(weft, (len(c), 1)), abs=1e-12)
    assert (c[:, 3] + c[:, 2] - c[:, 0] - c[:, 1]) / (2 * spacing) == pytest.approx(np.tile(warp, (len(c), 1)), abs=1e-12)
    for gradient, column in ((cloth.border.weft_gradient, weft), (cloth.border.warp_gradient, warp)):
        assert np.einsum("tk,tkd->td", gradient, x[cloth.border.corners]) == pytest.approx(np.tile(column, (len(gradient), 1)), abs=1e-12)


def test_links_are_the_sides_of_full_cells_with_half_a_grid_for_each() -> None:
    cloth = panel_cloth(disc(60.0, 20.0), MATERIALS)
    cells = [set(map(int, corners)) for corners in cloth.cells.corners]
    for ends, width, direction in zip(cloth.links.ends, cloth.links.width, cloth.links.direction):
        beside = sum(set(map(int, ends)) <= cell for cell in cells)
        assert width == pytest.approx(0.005 * beside)
        assert beside in (1, 2)
        step = to_grain(cloth.vertex_uv_mm[ends[1:]] - cloth.vertex_uv_mm[ends[:1]], 20.0)[0]
        assert step == pytest.approx([0.0, 10.0] if direction == WARP else [10.0, 0.0], abs=1e-9)
    # Each cell has two sides each way, each with h/2: the widths times lengths add to the cells' area.
    for direction in (WARP, WEFT):
        mine = cloth.links.direction == direction
        assert np.sum((cloth.links.width * cloth.links.rest_length)[mine]) == pytest.approx(cloth.cells.shear_area.sum())


def test_uniform_stretch_stands_for_the_whole_area() -> None:
    # Widths and patch areas together carry tension on exactly the panel's area, in both directions.
    cloth = panel_cloth(panel(DART, 17.0), MATERIALS)
    patch_area = np.add.reduceat(cloth.border.area[cloth.border.patch_triangle], cloth.border.patch_start[:-1]) / 3.0
    area = (300 * 200 - 15 * 100) * 1e-6
    for direction in (WARP, WEFT):
        mine = cloth.links.direction == direction
        assert np.sum((cloth.links.width * cloth.links.rest_length)[mine]) + patch_area.sum() == pytest.approx(area, rel=1e-9)


def test_regions_are_told_apart_by_the_centres_of_elements() -> None:
    drawn = rectangle(200, 100)
    split = build_cloth(pattern(drawn), lambda _, points: (points[:, 0] > 101.0).astype(int), MATERIALS, 10.0)
    uv = split.vertex_uv_mm
    for family, corners in (
        (split.links.material, split.links.ends),
        (split.cells.material, split.cells.corners),
        (split.border.material, split.border.corners),
    ):
        assert np.array_equal(family, uv[corners].mean(axis=1)[:, 0] > 101.0)
    assert np.array_equal(split.bends.material, uv[split.bends.center, 0] > 101.0)
    areas = signed_areas(uv, split.triangles) * 1e-6
    assert split.masses.sum() == pytest.approx(np.sum(areas * MATERIALS.areal_mass[split.triangle_material]), rel=1e-13)


def test_numbering_panel_by_panel_rows_first_then_contour() -> None:
    cloth = two_panels()
    assert cloth.panel_names == ("front", "back")
    assert np.all(np.diff(cloth.vertex_panel) >= 0)
    for number, grain in enumerate((10.0, -20.0)):
        mine = np.flatnonzero(cloth.vertex_panel == number)
        on_contour = cloth.vertex_on_contour[mine]
        assert np.all(np.diff(on_contour.astype(int)) >= 0)
        lattice = to_grain(cloth.vertex_uv_mm[mine[~on_contour]], grain).round(6)
        assert np.array_equal(np.lexsort((lattice[:, 0], lattice[:, 1])), np.arange(len(lattice)))
        assert set(mine[on_contour]) == set(np.concatenate([v for k, v in cloth.edge_vertices.items() if k.startswith(cloth.panel_names[number])]))
    for corners in (cloth.links.ends, cloth.cells.corners, cloth.border.corners, cloth.bends.arm_a, cloth.triangles):
        assert np.ptp(cloth.vertex_panel[corners], axis=1).max() == 0
    border = cloth.border
    for patch in range(len(border.patch_material)):
        members = border.patch_triangle[border.patch_start[patch] : border.patch_start[patch + 1]]
        assert (border.patch == patch).sum() == len(members)  # a triangle with two corners in a patch counts twice
        assert len(np.unique(border.corners[members][border.patch[members] == patch])) in (1, 2)


def test_edges_and_seams_keep_their_names() -> None:
    cloth = two_panels()
    right = cloth.edge_vertices["front.e1"]
    assert cloth.vertex_uv_mm[right] == pytest.approx(np.stack([np.full(22, 300.0), np.linspace(0, 200, 22)], axis=1))
    assert cloth.seam_names == ("side",)
    assert cloth.stitches[:, 0].tolist() == right.tolist()
    assert cloth.stitches[:, 1].tolist() == cloth.edge_vertices["back.e3"][::-1].tolist()
    assert cloth.seam_fold.tolist() == [math.radians(30.0)]
    assert cloth.seam_bend_factor.tolist() == [3.0]


def test_diagonals_of_cells_form_a_checkerboard() -> None:
    cloth = rectangle_cloth(100, 80, 10, 0.0, MATERIALS)
    sense = set()
    halves = cloth.triangles[: 2 * len(cloth.cells.corners)].reshape(-1, 2, 3)
    for corners, (one, two) in zip(cloth.cells.corners, halves):
        diagonal = set(one.tolist()) & set(two.tolist())
        assert diagonal in (set(corners[[0, 2]].tolist()), set(corners[[1, 3]].tolist()))
        assert set(one.tolist()) | set(two.tolist()) == set(corners.tolist())
        column, row = (cloth.vertex_uv_mm[corners[0]] / 10).round().astype(int)
        sense.add((diagonal == set(corners[[0, 2]].tolist())) ^ ((column + row) % 2 == 0))
    assert len(sense) == 1


def test_same_input_gives_the_same_bits() -> None:
    one, two = two_panels(), two_panels()
    assert one.masses.tobytes() == two.masses.tobytes()
    assert one.triangles.tobytes() == two.triangles.tobytes()
    assert all(a.tobytes() == b.tobytes() for a, b in zip((*one.bends, *one.border), (*two.bends, *two.border)))


def test_refused_input() -> None:
    drawn = pattern(rectangle(100, 50))
    for grid in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(InputError, match="grid_mm: a grid of"):
            build_cloth(drawn, one_material, MATERIALS, grid)
    with pytest.raises(LimitError, match="grid_mm: outlines of 300 mm need more than 1,000,000 particles"):
        build_cloth(drawn, one_material, MATERIALS, 1e-9)
    with pytest.raises(LimitError, match=r"panels\.back: about \d+ particles .* at most \d+ are allowed"):
        build_cloth(pattern(rectangle(100, 100), rectangle(100, 100, name="back")), one_material, MATERIALS, 10.0, particle_cap=200)
    with pytest.raises(InputError, match=r"one row of 0\.\.1"):
        build_cloth(drawn, lambda _, points: np.full(len(points), 2), MATERIALS)
    with pytest.raises(SpecError, match="no panels"):
        build_cloth(pattern(), one_material, MATERIALS)
    with pytest.raises(GarmentError, match="positive lengths"):
        rectangle_cloth(0.0, 50.0, 10.0, 0.0, MATERIALS)


@pytest.mark.parametrize(("width", "bends"), [(8.0, 0.0), (10.0, 1.0), (11.0, 1.0), (14.9, 1.0), (15.0, 1.0), (16.0, 1.0), (25.0, 1.0)])
def test_a_strap_bends_along_its_length_by_its_stiffness(width: float, bends: float) -> None:
    """Rolled on a cylinder, against B/2 kappa^2 of its area: from one spacing on it has a line of the lattice; below there is room for none."""
    table = linear(0.15, 2000.0, 0.1, 50.0, 0.3e-3, 0.3)
    cloth = rectangle_cloth(width, 200.0, 10.0, 0.0, table)
    uv, radius = cloth.vertex_uv_mm / 1000.0, 0.1
    rolled = floats(np.column_stack([uv[:, 0], radius * np.sin(uv[:, 1] / radius), radius * np.cos(uv[:, 1] / radius)]))
    energy = sum(energy for force in internal_forces(cloth, table) for name, energy in force.energies(rolled, force.slack()).items() if name == "bend")
    exact = 0.5 * 1e-5 / radius**2 * width * 200e-6
    assert energy / exact == pytest.approx(bends, abs=0.02)

"""Strain along the yarns against imposed deformations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from elastic import linear
from hand_made import flat, materials, rectangles

from garmentcad.analysis.maps import fabric_maps
from garmentcad.analysis.strain import (
    bias_strain,
    element_panels,
    of_limit_percent,
    particle_mean,
    share_over_limit_percent,
    strain_percentiles,
    trellis,
    trellis_summary,
    weighted_quantile,
    yarn_strain,
)
from garmentcad.analysis.tension import carried_strain, panels_at_limit, panels_pulled, tension_n_m, tension_summary
from garmentcad.analysis.tributary import draped_areas
from garmentcad.cloth.cloth import WARP, WEFT
from garmentcad.cloth.lattice import rectangle_cloth


@pytest.mark.parametrize("border", [False, True])
def test_stretched_grid(border: bool) -> None:
    cloth = rectangles(8, 6, 0.01, 1, sewn=False, border=border)
    positions = flat(cloth) * [1.02, 1.05, 1.0]
    for direction, expected in ((WARP, 5.0), (WEFT, 2.0)):
        found = strain_percentiles(yarn_strain(cloth, positions, direction))
        assert [found[key] for key in ("p50", "p99", "max", "min")] == pytest.approx([expected] * 4, abs=1e-9)
    assert trellis_summary(trellis(cloth, positions))["max"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("border", [False, True])
def test_sheared_grid(border: bool) -> None:
    """x -> x + tan(g) y turns warp by g; its length becomes 1/cos(g), weft keeps its own."""
    cloth = rectangles(8, 6, 0.01, 1, sewn=False, border=border)
    positions = flat(cloth)
    shear = math.radians(12.0)
    positions[:, 0] += math.tan(shear) * positions[:, 1]
    angles = trellis_summary(trellis(cloth, positions))
    assert angles["p99"] == pytest.approx(12.0, abs=1e-9)
    assert angles["max"] == pytest.approx(12.0, abs=1e-9)
    assert angles["over_8_percent"] == pytest.approx(100.0)
    assert strain_percentiles(yarn_strain(cloth, positions, WARP))["max"] == pytest.approx(100.0 * (1.0 / math.cos(shear) - 1.0))
    assert strain_percentiles(yarn_strain(cloth, positions, WEFT))["max"] == pytest.approx(0.0, abs=1e-9)


def test_trellis_of_a_cell_takes_mean_directions() -> None:
    """One corner moved 2 mm along weft: mean warp (1, 10), mean weft (1, 0)."""
    cloth = rectangles(1, 1, 0.01, 1, sewn=False)
    positions = flat(cloth)
    positions[3, 0] += 0.002
    assert trellis(cloth, positions).angle == pytest.approx([math.atan(0.1)])


def test_rigid_motion_is_no_strain() -> None:
    cloth = rectangles(5, 5, 0.01, 1, sewn=False)
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    positions = flat(cloth) @ turn.T + [1.0, 2.0, 3.0]
    for direction in (WARP, WEFT):
        assert np.abs(yarn_strain(cloth, positions, direction).strain).max() < 1e-12
    assert np.abs(trellis(cloth, positions).angle).max() < 1e-12


def test_area_of_elements_is_the_cloth_in_both_directions() -> None:
    for border in (False, True):
        cloth = rectangles(7, 4, 0.01, 1, sewn=False, border=border)
        for direction in (WARP, WEFT):
            assert yarn_strain(cloth, flat(cloth), direction).area.sum() == pytest.approx(28e-4)
        assert trellis(cloth, flat(cloth)).area.sum() == pytest.approx(28e-4)
        assert draped_areas(cloth, flat(cloth)).sum() == pytest.approx(28e-4)
        assert draped_areas(cloth, flat(cloth) * [1.1, 0.9, 1.0]).sum() == pytest.approx(0.99 * 28e-4)
    corner, side, middle = draped_areas(cloth := rectangles(7, 4, 0.01, 1, sewn=False), flat(cloth))[[0, 1, 9]]
    assert [corner, side, middle] == pytest.approx([0.25e-4, 0.5e-4, 1e-4])


def test_half_of_the_cloth_over_its_limit() -> None:
    """The upper half is stretched 6 % along warp (limit 5 %), weft is at rest (limit 8 %): half of the warp elements, a quarter of all."""
    cloth = rectangles(4, 8, 0.01, 1, sewn=False)
    positions = flat(cloth)
    above = np.maximum(positions[:, 1] - 0.04, 0.0)
    positions[:, 1] += 0.06 * above
    warp, weft = yarn_strain(cloth, positions, WARP), yarn_strain(cloth, positions, WEFT)
    assert share_over_limit_percent(warp, weft, materials()) == pytest.approx(25.0)
    assert strain_percentiles(warp)["p50"] == pytest.approx(0.0, abs=1e-9)
    assert strain_percentiles(warp)["p99"] == pytest.approx(6.0)


@pytest.mark.parametrize(("strain", "share"), [(0.094, 0.0), (0.096, 0.5), (0.2, 0.5)])
@pytest.mark.parametrize("border", [False, True])
def test_panels_at_their_limit(strain: float, share: float, border: bool) -> None:
    """The second of two panels is drawn along warp: one direction of two. Its limit is 10 %."""
    cloth = rectangles(4, 8, 0.01, 2, sewn=False, border=border)
    positions = flat(cloth)
    second = np.arange(cloth.particle_count) >= cloth.particle_count // 2
    positions[second, 1] *= 1.0 + strain
    positions[~second, 1] *= 1.09
    table = materials()._replace(strain_limit=np.full((2, 2), 0.1))
    found = panels_at_limit(cloth, positions, table)
    assert found == ({"back": pytest.approx(share)} if share else {})


@pytest.mark.parametrize("border", [False, True])
def test_elements_on_a_seam_belong_to_one_panel(border: bool) -> None:
    """Three rectangles sewn to a tube: their particles on a seam lie on two of them. A link along a seam is of either."""
    cloth = rectangles(4, 3, 0.01, 3, sewn=True, border=border)
    part = yarn_strain(cloth, np.zeros((cloth.particle_count, 3)), WEFT)
    assert cloth.particle_count < len(cloth.vertex_panel)
    wanted = cloth.vertex_panel[cloth.triangles[:, 0]] if border else np.repeat([0, 1, 2], 4 * 4)  # links go across, panel after panel
    assert element_panels(cloth, part).tolist() == wanted.tolist()


def test_a_band_narrower_than_a_cell_can_be_too_tight() -> None:
    """It has no link; its seams share every particle with what they are sewn to."""
    table = linear(0.15, 2000.0, 0.1, 50.0, 0.3e-3, 0.3)
    cloth = rectangle_cloth(200.0, 8.0, 10.0, 0.0, table)
    assert len(cloth.links.ends) == 0
    positions = np.column_stack([cloth.vertex_uv_mm / 1000.0, np.zeros(len(cloth.vertex_panel))])
    for stretch, share in ((1.09, []), (1.11, [pytest.approx(0.5)])):
        assert list(panels_at_limit(cloth, positions * [stretch, 1.0, 1.0], table).values()) == share
    for stretch, share in ((1.049, []), (1.051, [pytest.approx(0.5)])):  # of 2000 N/m
        assert list(panels_pulled(cloth, positions * [stretch, 1.0, 1.0], table, 100.0, 0.03).values()) == share


def test_map_of_a_uniform_strain_is_uniform_across_seams() -> None:
    cloth = rectangles(6, 6, 0.01, 2, sewn=True)
    warp = yarn_strain(cloth, np.zeros((cloth.particle_count, 3)), WARP)
    assert particle_mean(warp, np.full(len(warp.strain), 0.03), cloth.particle_count) == pytest.approx(0.03)
    assert fabric_maps(cloth, np.zeros((cloth.particle_count, 3)), materials())["strain"] == pytest.approx(-1.0)


def test_quantiles_are_weighted() -> None:
    values = np.array([3.0, 1.0, 2.0])
    assert weighted_quantile(values, np.array([1.0, 1.0, 1.0]), 0.5) == 2.0
    assert weighted_quantile(values, np.array([8.0, 1.0, 1.0]), 0.5) == 3.0
    assert weighted_quantile(values, np.array([1.0, 9.0, 1.0]), 0.5) == 1.0
    assert weighted_quantile(values[:0], values[:0], 0.5) is None


def test_tension_follows_the_tensile_curve() -> None:
    """Fm at em; work under the curve LT Fm em / 2 with LT = 2 (e^x - 1 - x) / (x (e^x - 1)); the tangent outside."""
    table = materials()
    row = np.zeros(1, dtype=np.int32)

    def force(strain: float, material: int = 0) -> float:
        return float(tension_n_m(np.array([strain]), row + material, table, WARP)[0])

    assert force(0.04) == pytest.approx(490.33)
    assert force(0.0) == 0.0
    grid = np.linspace(0.0, 0.04, 4001)
    work = np.trapezoid(tension_n_m(grid, np.zeros(len(grid), dtype=np.int32), table, WARP), grid)
    linearity = 2.0 * (math.exp(2.0) - 3.0) / (2.0 * (math.exp(2.0) - 1.0))
    assert work == pytest.approx(0.5 * linearity * 490.33 * 0.04, rel=1e-6)
    assert force(0.05) - force(0.04) == pytest.approx(0.01 * (force(0.04) - force(0.04 - 1e-7)) / 1e-7, rel=1e-5)
    assert force(-0.01) == pytest.approx(-0.01 * force(1e-7) / 1e-7, rel=1e-5)
    assert force(0.05, material=1) == pytest.approx(490.33 / 2.0)


def test_maps_take_the_larger_direction() -> None:
    cloth = rectangles(4, 4, 0.01, 1, sewn=False)
    maps = fabric_maps(cloth, flat(cloth) * [1.06, 1.02, 1.0], materials())
    assert maps["tension"] == pytest.approx(490.33)
    assert (maps["strain"], maps["warp"], maps["weft"]) == (pytest.approx(0.06), pytest.approx(0.02), pytest.approx(0.06))
    assert maps["limit"] == pytest.approx(0.75)  # weft 6 of 8 %, warp 2 of 5 %
    found = tension_summary(cloth, flat(cloth) * [1.06, 1.02, 1.0], materials(), WEFT)
    assert found == {"p50": pytest.approx(490.33), "p99": pytest.approx(490.33), "max": pytest.approx(490.33)}


def test_tension_of_the_border_is_that_of_its_patches() -> None:
    """A zigzag of the middle row: single triangles are strained one way and the other, their means around each particle are not."""
    cloth = rectangles(2, 2, 0.01, 1, sewn=False, border=True)
    positions = flat(cloth)
    positions[4, 1] += 2e-4
    single = yarn_strain(cloth, positions, WARP).strain
    assert (single.min(), single.max()) == pytest.approx((-0.02, 0.02))
    around_middle = np.flatnonzero((cloth.particle_triangles == 4).any(axis=1))
    carried = carried_strain(cloth, positions, WARP)
    at_middle = carried.strain[carried.particles[:, 0] == 4]
    assert at_middle == pytest.approx(single[around_middle].mean(), abs=1e-12)
    assert carried.area.sum() == pytest.approx(4e-4)


@pytest.mark.parametrize("border", [False, True])
def test_bias_strain(border: bool) -> None:
    """Simple shear of angle g: the diagonals of a unit square become sqrt((1 +- tan g)^2 + 1). Equal stretch of both yarns stretches the bias alike."""
    cloth = rectangles(8, 6, 0.01, 1, sewn=False, border=border)
    stretched = strain_percentiles(*bias_strain(cloth, flat(cloth) * [1.03, 1.03, 1.0]))
    assert list(stretched.values()) == pytest.approx([3.0] * 4, abs=1e-9)
    positions, slope = flat(cloth), 0.1
    positions[:, 0] += slope * positions[:, 1]
    one, other = bias_strain(cloth, positions)
    longer, shorter = (math.sqrt((1.0 + sign * slope) ** 2 + 1.0) / math.sqrt(2.0) - 1.0 for sign in (1.0, -1.0))
    assert one.strain == pytest.approx(longer)
    assert other.strain == pytest.approx(shorter)
    assert one.area.sum() == pytest.approx(48e-4)
    assert fabric_maps(cloth, positions, materials())["bias"].max() == pytest.approx(longer)


def test_strain_of_the_fabric_s_own_limit() -> None:
    cloth = rectangles(4, 8, 0.01, 1, sewn=False)
    positions = flat(cloth) * [0.99, 1.06, 1.0]
    warp, weft = yarn_strain(cloth, positions, WARP), yarn_strain(cloth, positions, WEFT)
    assert of_limit_percent(warp, weft, materials()) == {"warp": {"p99": pytest.approx(120.0), "max": pytest.approx(120.0)}, "weft": {"p99": 0.0, "max": 0.0}}

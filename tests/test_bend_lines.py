"""Bend lines: their geometry by brute force, and the energy of panels bent to cylinders against B k^2 A/2 in any direction."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from drawn import disc, materials, mesh, panel, pattern, rectangle

from garmentcad.cloth.bend_lines import bend_lines
from garmentcad.cloth.cloth import WARP, WEFT, BendLines
from garmentcad.cloth.contour import sample_contours
from garmentcad.cloth.lattice import panel_cloth
from garmentcad.cloth.panel_mesh import PanelMesh, mesh_panel
from garmentcad.pattern.pattern import EdgeUse, Seam

RADIUS = 0.2


def ends(bends: BendLines, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return tuple((1 - w)[:, None] * x[arm[:, 0]] + w[:, None] * x[arm[:, 1]] for arm, w in ((bends.arm_a, bends.weight_a), (bends.arm_b, bends.weight_b)))  # type: ignore[return-value]


def cylinder(points: np.ndarray, direction: float) -> np.ndarray:
    """Points (weft, warp) rolled without strain onto a cylinder that curves along `direction`."""
    along, across = np.array([math.cos(direction), math.sin(direction)]), np.array([-math.sin(direction), math.cos(direction)])
    s, t = points @ along, points @ across
    return np.stack([RADIUS * np.sin(s / RADIUS), t, RADIUS * np.cos(s / RADIUS)], axis=1)


def cylinder_energy(made: PanelMesh, bends: BendLines, twist_area: np.ndarray, direction: float) -> float:
    """Energy for B = 1 in both directions and D66 = 1/2 (isotropic, no lateral contraction)."""
    x = cylinder(made.points * 1e-3, direction)
    a, b = ends(bends, x)
    into, out = x[bends.center] - a, b - x[bends.center]
    turn = np.arctan2(np.linalg.norm(np.cross(into, out), axis=1), np.sum(into * out, axis=1))
    lines = np.sum(bends.width * turn**2 / (bends.length_a + bends.length_b))
    c = x[made.cells]
    normal = np.cross(c[:, 2] - c[:, 0], c[:, 3] - c[:, 1])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    twist = np.sum(normal * (c[:, 0] - c[:, 1] - c[:, 3] + c[:, 2]), axis=1) / (made.spacing * 1e-3) ** 2
    return float(lines + np.sum(twist_area * twist**2))


def energy_errors(drawn, grid: float) -> np.ndarray:
    """Relative errors for curvature at 0, 30, 45, 90 degrees to the panel's x axis."""
    made = mesh(drawn, grid)
    twist_area = panel_cloth(drawn, materials(0.1), grid_mm=grid).cells.twist_area
    exact = made.contour.polygon.area * 1e-6 / (2.0 * RADIUS**2)
    bends = bend_lines(made)
    return np.array([cylinder_energy(made, bends, twist_area, math.radians(angle - drawn.grain_deg)) / exact - 1.0 for angle in (0, 30, 45, 90)])


@pytest.mark.parametrize(("grid", "limit"), [(10.0, 0.006), (5.0, 0.003)])
@pytest.mark.parametrize("grain", [0.0, 17.0, 30.0, 45.0])
def test_disc_bent_to_a_cylinder(grid: float, limit: float, grain: float) -> None:
    assert np.abs(energy_errors(disc(150.0, grain), grid)).max() < limit


def test_rectangle_cut_along_the_grain_is_exact() -> None:
    for grid in (10.0, 5.0):
        assert np.abs(energy_errors(rectangle(150.0, 50.0), grid)).max() < 3e-4


@pytest.mark.parametrize(("grid", "limit", "mean"), [(10.0, 0.03, 0.01), (5.0, 0.02, 0.005)])
@pytest.mark.parametrize("grain", [17.0, 30.0, 45.0])
def test_narrow_strip_cut_across_the_grain(grid: float, limit: float, mean: float, grain: float) -> None:
    # Five cells wide at 10 mm, so that two fifths of the strip are border.
    errors = energy_errors(rectangle(150.0, 50.0, grain), grid)
    assert np.abs(errors).max() < limit
    assert abs(errors.mean()) < mean


@pytest.mark.parametrize("grain", [0.0, 33.0])
def test_lines_are_straight_and_end_on_neighbours_or_on_the_contour(grain: float) -> None:
    dart = panel([(0, 0), (300, 0), (300, 200), (165, 200), (150, 100), (135, 200), (0, 200)], grain)
    made = mesh(dart, 10.0)
    bends = bend_lines(made)
    x = made.points * 1e-3
    a, b = ends(bends, x)
    center = x[bends.center]
    outline = shapely.Polygon(made.points[made.lattice_count :] * 1e-3)
    for end, length, arm, sign in ((a, bends.length_a, bends.arm_a, -1.0), (b, bends.length_b, bends.arm_b, 1.0)):
        step = np.where((bends.direction == WEFT)[:, None], [[1.0, 0.0]], [[0.0, 1.0]]) * length[:, None] * sign
        assert end - center == pytest.approx(step, abs=1e-12)
        on_lattice = arm[:, 0] < made.lattice_count
        assert np.array_equal(arm[on_lattice, 0], arm[on_lattice, 1])
        assert length[on_lattice] == pytest.approx(np.full(on_lattice.sum(), 0.01))
        assert np.all((length[~on_lattice] >= 0.0049) & (length[~on_lattice] <= 0.02))
        segments = shapely.linestrings(np.stack([center, end], axis=1))
        assert shapely.covers(outline.buffer(1e-9), segments).all(), "a line crosses the contour"
    # Every lattice point has its line unless the contour along it is more than two grids away.
    for direction, axis in ((WEFT, 0), (WARP, 1)):
        for k in np.setdiff1d(np.arange(made.lattice_count), bends.center[bends.direction == direction]):
            reach = np.zeros(2)
            reach[axis] = 0.02
            inside = [outline.covers(shapely.LineString([x[k], x[k] + sign * reach])) for sign in (-1, 1)]
            assert any(inside)


def test_lines_stand_for_the_whole_area() -> None:
    inner = mesh(rectangle(150.0, 80.0), 10.0)
    lines = bend_lines(inner)
    for direction in (WARP, WEFT):
        mine = lines.direction == direction
        assert np.sum((lines.width * 0.5 * (lines.length_a + lines.length_b))[mine]) == pytest.approx(150e-3 * 80e-3, rel=1e-9)


def test_beside_a_seam_the_outer_half_arm_is_left_to_the_hinge() -> None:
    panels = rectangle(100.0, 100.0), rectangle(100.0, 100.0, name="back")
    sewn = pattern(*panels, seams=(Seam("side", (EdgeUse("front", 1, False),), (EdgeUse("back", 3, True),)),))
    contours, _ = sample_contours(sewn, 10.0)
    free = bend_lines(mesh(panels[0], 10.0))
    made = mesh_panel("front", contours["front"], 0.0, 10.0)
    sewn_lines = bend_lines(made)
    at_seam = (sewn_lines.direction == WEFT) & (made.points[sewn_lines.center, 0] > 85.0)
    assert at_seam.sum() == 9
    # 10 mm to the contour: the line stands for 5 + 10 mm at a free edge, for 5 + 5 mm at a seam.
    assert sewn_lines.width[at_seam] == pytest.approx(free.width[at_seam] * 10.0 / 15.0)
    assert sewn_lines.width[~at_seam] == pytest.approx(free.width[~at_seam])

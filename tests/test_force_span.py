"""Contour spans against the saw tooth and against shapes that must cost nothing."""

from __future__ import annotations

import numpy as np
import pytest
from small_cloth import materials

from garmentcad.cloth.lattice import panel_cloth, rectangle_cloth
from garmentcad.forces.span import ForceSpan
from garmentcad.geometry.curve import Arc
from garmentcad.pattern.pattern import Edge, Panel, Transform

MATERIALS = materials()


def flat(cloth) -> np.ndarray:
    return np.column_stack([cloth.vertex_uv_mm / 1000.0, np.zeros(cloth.particle_count)])


def disc(radius_mm: float, grid_mm: float):
    half = Arc((radius_mm, 0.0), (-radius_mm, 0.0), center=(0.0, 0.0), clockwise=False)
    other = Arc((-radius_mm, 0.0), (radius_mm, 0.0), center=(0.0, 0.0), clockwise=False)
    edges = (Edge("upper", "a", "b", half), Edge("lower", "b", "a", other))
    return panel_cloth(Panel("disc", edges, 0.0, Transform((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))), MATERIALS, grid_mm=grid_mm)


def test_a_saw_tooth_costs_what_a_bend_line_of_half_a_spacing_costs() -> None:
    cloth = rectangle_cloth(200.0, 100.0, 10.0, 0.0, MATERIALS)
    bottom = cloth.edge_vertices["rectangle.bottom"]
    height = 1e-7  # a tooth of a/l tilts the side between two points by 2 a/l, and the measure is taken across it
    positions = flat(cloth)
    positions[bottom, 2] = height * (-1.0) ** np.arange(len(bottom))
    # turning angle 4 a/l at each point: E = B w t^2/(2 l) with w = l/2, at each of the spans along the bottom edge
    spacing, stiffness = 0.01, MATERIALS.bending[0, 1]
    one = stiffness * (0.5 * spacing) * (4.0 * height / spacing) ** 2 / (2.0 * spacing)
    # the two upright edges see their end point alone: d = a, k = B/(8 l^2)
    ends = 2.0 * 0.5 * MATERIALS.bending[0, 0] / (8.0 * spacing**2) * height**2
    assert ForceSpan(cloth, MATERIALS).energy(positions) == pytest.approx((len(bottom) - 3) * one + ends, rel=1e-9)


@pytest.mark.parametrize("grain", [0.0, 30.0])
def test_affine_maps_and_cylinders_along_straight_contours_cost_nothing(grain: float) -> None:
    cloth = rectangle_cloth(200.0, 100.0, 10.0, grain, MATERIALS)
    force = ForceSpan(cloth, MATERIALS)
    rng = np.random.default_rng(3)
    affine = flat(cloth) @ rng.normal(size=(3, 3)) + rng.normal(size=3)
    parabola = flat(cloth)
    parabola[:, 2] = 3.0 * (parabola[:, 0] + 0.5 * parabola[:, 1]) ** 2
    tooth = flat(cloth)
    tooth[cloth.edge_vertices["rectangle.top"], 2] = 1e-3 * (-1.0) ** np.arange(21)
    scale = force.energy(tooth)
    assert force.energy(affine) < 1e-20 * scale
    assert force.energy(parabola) < 1e-20 * scale


def test_a_strip_rolled_up_tightly_along_its_contour_costs_nothing() -> None:
    cloth = rectangle_cloth(200.0, 100.0, 10.0, 0.0, MATERIALS)
    force, turn = ForceSpan(cloth, MATERIALS), 1.5
    rolled, tooth = flat(cloth), flat(cloth)
    radius = 0.01 / (2.0 * np.sin(0.5 * turn))
    angle = flat(cloth)[:, 0] / 0.01 * turn
    rolled[:, 0], rolled[:, 2] = radius * np.sin(angle), -radius * np.cos(angle)
    tooth[cloth.edge_vertices["rectangle.top"], 2] = 1e-3 * (-1.0) ** np.arange(21)
    assert force.energy(rolled) < 1e-20 * force.energy(tooth)


def test_a_bent_disc_keeps_nearly_all_of_its_energy_in_the_bend_lines() -> None:
    cloth = disc(60.0, 10.0)
    force = ForceSpan(cloth, MATERIALS)
    np.testing.assert_allclose(np.einsum("ni,nik->nk", cloth.spans.coefficients, flat(cloth)[cloth.spans.corners]), 0.0, atol=1e-12)
    curvature = 5.0
    bent = flat(cloth)
    bent[:, 2] = 0.5 * curvature * bent[:, 0] ** 2
    plate = 0.5 * MATERIALS.bending[0].max() * curvature**2 * np.pi * 0.06**2
    assert len(cloth.spans.length) == cloth.vertex_on_contour.sum()  # no corner anywhere
    assert force.energy(bent) < 2e-3 * plate


def test_spans_do_not_reach_around_corners() -> None:
    cloth = rectangle_cloth(100.0, 50.0, 10.0, 0.0, MATERIALS)
    uv = cloth.vertex_uv_mm[cloth.spans.corners]
    assert len(uv) == 2 * (11 - 3) + 2 * (6 - 3)
    assert ((np.ptp(uv, axis=1) < 1e-9).any(axis=1)).all()

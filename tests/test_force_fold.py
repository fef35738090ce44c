"""Folds: a strip that relaxes without weight to the angle that its fold rests at, whatever the direction of the fold."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import minimize

from garmentcad.arrays import floats
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import panel_cloth
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.hinge import ForceHinge
from garmentcad.forces.internal import internal_forces
from garmentcad.forces.lattice import ForceLattice, contour_lines
from garmentcad.geometry.curve import Line
from garmentcad.pattern.fold import cut_at_folds
from garmentcad.pattern.pattern import Edge, FoldLine, Panel, Transform


def fabric() -> MaterialTable:
    """Suiting, but for tension that is soft enough for a general minimiser."""
    both, one = floats([[1.0, 1.0]]), floats([1.0])
    return MaterialTable(
        areal_mass=0.2 * one,
        tension_strain=0.5 * both,
        tension_force=25.0 * both,
        tension_exponent=0.0 * both,
        tension_slope=50.0 * both,
        tension_friction=0.0 * both,
        strain_limit=both,
        shear=15.0 * one,
        shear_friction=0.0 * both,
        shear_way=0.0 * one,
        bending=floats([[1.5e-5, 1.0e-5]]),
        bending_friction=0.0 * both,
        twist=0.6e-5 * one,
        twist_friction=0.0 * one,
        thickness=5e-4 * one,
        friction_body=0.2 * one,
        friction_cloth=0.26 * one,
    )


MATERIALS = fabric()


def strip(width: float, height: float, grid: float, *folds: FoldLine, grain_deg: float = 0.0) -> Cloth:
    corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
    edges = tuple(Edge(f"e{k}", f"p{k}", f"p{(k + 1) % 4}", Line(corners[k], corners[(k + 1) % 4])) for k in range(4))
    return panel_cloth(cut_at_folds(Panel("strip", edges, grain_deg, Transform((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), folds=folds)), MATERIALS, 0, grid)


def fold_at(slant_deg: float, width: float, height: float, **more: float) -> FoldLine:
    """Through a point beside the middle of a strip, from its lower to its upper edge, `slant_deg` off the upright."""
    along = np.array([math.tan(math.radians(slant_deg)), 1.0])
    middle = np.array([0.5 * width + 1.3, 0.5 * height])
    return FoldLine("f", np.array([middle - 0.5 * height * along, middle + 0.5 * height * along]), 90.0, **more)


def bent(cloth: Cloth, fold: FoldLine, angle: float) -> np.ndarray:
    """Sharply folded along the line, half of the angle on either side; panel millimetres become metres."""
    start, end = fold.points_mm
    along = (end - start) / np.linalg.norm(end - start)
    across = np.array([along[1], -along[0]])
    away = (cloth.vertex_uv_mm - start) @ across
    flat = (cloth.vertex_uv_mm - start) - away[:, None] * across + (away * math.cos(0.5 * angle))[:, None] * across
    return np.column_stack([flat, np.abs(away) * math.sin(0.5 * angle)]) * 1e-3


SLANTED = fold_at(35.0, 55.0, 43.0)
SMALL = strip(55.0, 43.0, 10.0, SLANTED, grain_deg=12.0)


def test_hinges_lie_along_the_whole_fold_and_nothing_else_reaches_across_it() -> None:
    start, end = SLANTED.points_mm
    hinges, uv = SMALL.hinges, SMALL.vertex_uv_mm
    assert hinges.length.sum() == pytest.approx(np.linalg.norm(end - start) * 1e-3)
    assert set(hinges.fold.tolist()) == {0}
    along = (end - start) / np.linalg.norm(end - start)
    away = (uv - start) @ np.array([along[1], -along[0]])
    assert np.abs(away[hinges.corners[:, :2]]).max() < 1e-6
    elements = [SMALL.links.ends, SMALL.cells.corners, SMALL.border.corners, np.column_stack([SMALL.bends.center, SMALL.bends.arm_a, SMALL.bends.arm_b])]
    for corners in [*elements, SMALL.spans.corners]:
        side = away[corners]
        assert not ((side > 1e-6).any(axis=1) & (side < -1e-6).any(axis=1)).any()


def test_a_fold_line_that_is_flat_is_no_fold() -> None:
    """Bent to a cylinder over the fold, cloth holds B k^2/2 an area, as it does without a fold line."""
    radius, width, height = 0.1, 120.0, 60.0
    for slant in (0.0, 35.0):
        cloth = strip(width, height, 5.0, fold_at(slant, width, height))
        angle = cloth.vertex_uv_mm[:, 0] * 1e-3 / radius
        rolled = np.column_stack([radius * np.sin(angle), cloth.vertex_uv_mm[:, 1] * 1e-3, radius * np.cos(angle)])
        forces = [ForceLattice(cloth, MATERIALS, ("twist", "bend")), contour_lines(cloth, MATERIALS), ForceHinge(cloth, MATERIALS)]
        assert sum(force.energy(rolled) for force in forces) == pytest.approx(1.0e-5 * width * height * 1e-6 / (2.0 * radius**2), rel=0.05)


def relaxed(cloth: Cloth, start: np.ndarray, angle: float) -> np.ndarray:
    assembly = ForceAssembly(internal_forces(cloth, MATERIALS, 0.0, np.array([angle])), cloth.particle_count)
    rest, out = np.zeros_like(start), np.empty_like(start)

    def energy(flat: np.ndarray) -> tuple[float, np.ndarray]:
        positions = flat.reshape(-1, 3)
        assembly.add_up(positions, rest, out)
        return 1e6 * sum(assembly.energy(positions).values()), -1e6 * out.ravel()

    found = minimize(energy, start.ravel(), jac=True, method="L-BFGS-B", options={"maxiter": 4000, "maxfun": 8000, "ftol": 1e-13, "gtol": 1e-5, "maxcor": 30})
    return found.x.reshape(-1, 3)


def angle_between_the_ends(cloth: Cloth, positions: np.ndarray, fold: FoldLine, beyond_mm: float) -> float:
    """Degrees between planes fitted to both ends of the strip (singular vectors), signed: positive where the ends rise toward +z."""
    start, end = fold.points_mm
    along = (end - start) / np.linalg.norm(end - start)
    away = (cloth.vertex_uv_mm - start) @ np.array([along[1], -along[0]])
    normals = []
    for side in (away < -beyond_mm, away > beyond_mm):
        points = positions[side] - positions[side].mean(axis=0)
        normal = np.linalg.svd(points)[2][2]
        u, v = cloth.vertex_uv_mm[side].T
        du, dv = np.linalg.lstsq(np.column_stack([u, v, np.ones(len(u))]), points, rcond=None)[0][:2]
        normals.append(normal * np.sign(normal @ np.cross(du, dv)))
    one, two = normals
    apart = positions[away > beyond_mm].mean(axis=0) - positions[away < -beyond_mm].mean(axis=0)
    return math.degrees(math.atan2(np.linalg.norm(np.cross(one, two)), one @ two)) * np.sign(apart @ (one - two))


@pytest.mark.parametrize(("grid", "slant", "angle", "within"), [
    (10.0, 0.0, 90.0, 1.0), (10.0, 0.0, 170.0, 2.0), (10.0, 30.0, -90.0, 5.0), (10.0, 45.0, 90.0, 5.0), (5.0, 45.0, -60.0, 4.0),
])  # fmt: skip
def test_a_strip_without_weight_rests_at_the_angle_of_its_fold(grid: float, slant: float, angle: float, within: float) -> None:
    width, height = (80.0, 30.0) if grid == 10.0 else (60.0, 26.0)
    fold = fold_at(slant, width, height)
    cloth = strip(width, height, grid, fold)
    shape = relaxed(cloth, bent(cloth, fold, math.radians(0.45 * angle)) * [1.0, 1.0, math.copysign(1.0, angle)], math.radians(angle))
    assert angle_between_the_ends(cloth, shape, fold, 1.5 * grid) == pytest.approx(angle, abs=within)


def test_strength_multiplies_bending_over_the_fold() -> None:
    """A moment that opens a fold works against bending over it alone: n times the strength, 1/n of the opening; here from the energy of the fold held flat."""
    energies = []
    for strength in (1.0, 3.0):
        fold = fold_at(0.0, 200.0, 60.0, strength=strength)
        cloth = strip(200.0, 60.0, 10.0, fold)
        energies.append(ForceHinge(cloth, MATERIALS, np.array([1.0])).energy(bent(cloth, fold, 0.0)))
    # K t^2/2 with K = B/w a unit of length, w half of what lies between the lattice on either side: a grid to two
    assert 1.0e-5 / (2.0 * 0.015) * 0.06 < energies[0] < 1.0e-5 / (2.0 * 0.0075) * 0.06
    assert energies[1] / energies[0] == pytest.approx(3.0)

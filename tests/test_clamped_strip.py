"""Strips stretched in their plane, at any angle to the grain and any lattice spacing, against their own fine value and against the off-axis modulus.

`python tests/test_clamped_strip.py` prints the reactions of the clamped strip from 10 to 1.25 mm; the last column is REACTIONS_N (minutes).
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from elastic import elastic
from scipy.optimize import minimize

from garmentcad.arrays import floats
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import rectangle_cloth
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.border import ForceBorder
from garmentcad.forces.lattice import ForceLattice

SLOPE, SHEAR = 2000.0, 45.0  # N/m, N/m per rad
WIDTH, GRIP_TO_GRIP, STRAIN = 50.0, 150.0, 0.01  # mm, mm
REACTIONS_N = {0: 1.0, 30: 0.15124, 45: 0.10167}  # at 1.25 mm


def linear_material() -> MaterialTable:
    pair = floats([[1.0, 1.0]])
    return elastic(
        floats([0.15]),
        tension_strain=0.1 * pair,
        tension_force=0.1 * SLOPE * pair,
        tension_exponent=0.0 * pair,
        tension_slope=SLOPE * pair,
        strain_limit=0.15 * pair,
        shear=floats([SHEAR]),
        bending=1e-5 * pair,
        twist=floats([0.0]),
        thickness=floats([1e-3]),
        friction_body=floats([0.3]),
        friction_cloth=floats([0.3]),
    )


class Strip:
    """A flat strip of width x height mm whose height is stretched: x across, y along it, the warp turned by `angle_deg` from y."""

    def __init__(self, width_mm: float, height_mm: float, grid_mm: float, angle_deg: float, origin_mm: tuple[float, float] | None = None) -> None:
        materials = linear_material()
        self.cloth: Cloth = rectangle_cloth(width_mm, height_mm, grid_mm, angle_deg, materials, origin_mm=origin_mm)
        forces = [ForceLattice(self.cloth, materials, ("stretch", "shear")), ForceBorder(self.cloth, materials)]
        self.assembly = ForceAssembly(forces, self.cloth.particle_count)
        self.rest = np.column_stack([self.cloth.vertex_uv_mm / 1000.0, np.zeros(self.cloth.particle_count)])
        self.bottom, self.top = self.cloth.edge_vertices["rectangle.bottom"], self.cloth.edge_vertices["rectangle.top"]

    def forces(self, positions: np.ndarray) -> np.ndarray:
        out = np.empty_like(positions)
        self.assembly.add_up(positions, np.zeros_like(positions), out)
        return out

    def stretched(self, start: np.ndarray, held: np.ndarray) -> np.ndarray:
        """Equilibrium in the plane from `start`; `held` (P,2) bool: coordinates that keep their value."""
        free = ~held
        positions = start.copy()
        stiffness = np.zeros(len(start))
        self.assembly.stiffness(start, stiffness)
        scale = np.repeat(1.0 / np.sqrt(stiffness)[:, None], 2, axis=1)[free]

        def energy_and_gradient(shift: np.ndarray) -> tuple[float, np.ndarray]:
            positions[:, :2][free] = start[:, :2][free] + scale * shift
            return sum(self.assembly.energy(positions).values()), -self.forces(positions)[:, :2][free] * scale

        found = minimize(
            energy_and_gradient,
            np.zeros(int(free.sum())),
            jac=True,
            method="L-BFGS-B",
            options={"maxiter": 50000, "maxfun": 50000, "maxcor": 40, "ftol": 0.0, "gtol": 2e-9},
        )
        energy_and_gradient(found.x)
        residual = np.abs(self.forces(positions)[:, :2][free]).max()
        assert residual < 1e-4 * np.abs(self.forces(positions)).max(), f"not at rest: {found.message}"
        return positions


def clamped_reaction(grid_mm: float, angle_deg: float, origin_mm: tuple[float, float] | None = None) -> float:
    """Force [N] that stretches the strip between two grips that hold its short ends in both directions."""
    strip = Strip(WIDTH, GRIP_TO_GRIP, grid_mm, angle_deg, origin_mm)
    held = np.zeros((strip.cloth.particle_count, 2), dtype=bool)
    held[strip.bottom] = held[strip.top] = True
    at_rest = strip.stretched(strip.rest * [1.0, 1.0 + STRAIN, 1.0], held)
    return -float(strip.forces(at_rest)[strip.top, 1].sum())


def free_width_modulus(grid_mm: float, angle_deg: float) -> float:
    """Force per width over strain [N/m] in the middle third of a 30 x 2.5 cm strip whose ends are pulled along it and slide freely across."""
    strip = Strip(25.0, 300.0, grid_mm, angle_deg)
    ends = np.concatenate([strip.bottom, strip.top])
    held = np.zeros((strip.cloth.particle_count, 2), dtype=bool)
    held[ends, 1] = True
    held[strip.bottom[len(strip.bottom) // 2], 0] = True
    strain = 0.002
    at_rest = strip.stretched(strip.rest * [1.0, 1.0 + strain, 1.0], held)
    force = -float(strip.forces(at_rest)[strip.top, 1].sum())
    # strain of the middle third: slope of y over Y by least squares
    height = strip.rest[:, 1]
    middle = (height > 0.1) & (height < 0.2)
    columns = np.column_stack([np.ones(middle.sum()), height[middle], strip.rest[middle, 0]])
    slope = np.linalg.lstsq(columns, at_rest[middle, 1], rcond=None)[0][1]
    return force / 0.025 / (slope - 1.0)


def off_axis_modulus(angle_deg: float) -> float:
    """1/E(t) = cos^4/E1 + sin^4/E2 + cos^2 sin^2/G."""
    c2 = math.cos(math.radians(angle_deg)) ** 2
    return 1.0 / ((c2**2 + (1.0 - c2) ** 2) / SLOPE + c2 * (1.0 - c2) / SHEAR)


@pytest.mark.parametrize(("grid_mm", "tolerance"), [(10.0, 0.08), (5.0, 0.03)])
@pytest.mark.parametrize("angle_deg", REACTIONS_N)
def test_clamped_strip_converges(grid_mm: float, tolerance: float, angle_deg: int) -> None:
    assert clamped_reaction(grid_mm, angle_deg) == pytest.approx(REACTIONS_N[angle_deg], rel=tolerance)


@pytest.mark.parametrize("angle_deg", [0, 15, 30, 45])
def test_free_strip_has_the_off_axis_modulus(angle_deg: int) -> None:
    assert free_width_modulus(10.0, angle_deg) == pytest.approx(off_axis_modulus(angle_deg), rel=0.03)


if __name__ == "__main__":
    for angle in REACTIONS_N:
        print(angle, [round(clamped_reaction(grid, angle), 5) for grid in (10.0, 5.0, 2.5, 1.25)])
    for angle in (0, 15, 30, 45):
        print(angle, [round(free_width_modulus(grid, angle) / off_axis_modulus(angle), 4) for grid in (10.0, 5.0, 2.5)])

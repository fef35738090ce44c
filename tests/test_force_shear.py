"""Trellis shear against T = G gamma."""

from __future__ import annotations

import math

import numpy as np
import pytest
from force_checks import particle_forces
from small_cloth import COLUMNS, ROWS, H, flat, materials, small_cloth

from garmentcad.forces.lattice import ForceLattice

CLOTH = small_cloth()
MATERIALS = materials()._replace(shear=np.array([45.0, 45.0]))


def trellis(gamma: float) -> np.ndarray:
    """The cloth as a trellis of stiff yarns: the warp leans by gamma, all lengths kept."""
    weft, warp = flat(CLOTH)[:, 0], flat(CLOTH)[:, 1]
    return np.column_stack([weft + math.sin(gamma) * warp, math.cos(gamma) * warp, np.zeros_like(weft)])


@pytest.mark.parametrize("degrees", [-60.0, -2.5, 1e-7, 0.5, 8.0, 75.0])
def test_energy_and_shear_force(degrees: float) -> None:
    gamma = math.radians(degrees)
    force = ForceLattice(CLOTH, MATERIALS, ("shear",))
    area = (COLUMNS - 1) * (ROWS - 1) * H * H
    assert force.energy(trellis(gamma)) == pytest.approx(0.5 * 45.0 * gamma**2 * area, rel=1e-7)
    forces = particle_forces(force, trellis(gamma))
    lattice = forces[: ROWS * COLUMNS].reshape(ROWS, COLUMNS, 3)
    # the top row is pulled back, square to the leaning warp, by T per width of cloth
    across = np.array([math.cos(gamma), -math.sin(gamma), 0.0])
    assert lattice[-1].sum(axis=0) @ across == pytest.approx(-45.0 * gamma * (COLUMNS - 1) * H, rel=1e-7)
    np.testing.assert_allclose(lattice[1:-1, 1:-1], 0.0, atol=1e-16 + 1e-12 * abs(gamma))


def test_collapsed_cells_are_finite() -> None:
    for positions in (np.zeros((CLOTH.particle_count, 3)), flat(CLOTH) * [1.0, 0.0, 0.0], trellis(math.pi / 2)):
        assert np.isfinite(particle_forces(ForceLattice(CLOTH, MATERIALS, ("shear",)), positions)).all()

"""Twist against the saddle z = k u w, whose kappa_uv is k."""

from __future__ import annotations

import numpy as np
import pytest
from force_checks import particle_forces
from small_cloth import COLUMNS, ROWS, H, flat, materials, small_cloth

from garmentcad.forces.lattice import ForceLattice

CLOTH, MATERIALS = small_cloth(), materials()


def saddle(k: float) -> np.ndarray:
    positions = flat(CLOTH)
    positions[:, 2] = k * positions[:, 0] * positions[:, 1]
    return positions


def test_energy_of_a_saddle() -> None:
    k = 0.1
    expected = float(np.sum(0.5 * 4.0 * MATERIALS.twist[CLOTH.cells.material] * k**2 * CLOTH.cells.twist_area))
    assert ForceLattice(CLOTH, MATERIALS, ("twist",)).energy(saddle(k)) == pytest.approx(expected, rel=1e-4)


def test_corner_forces_of_a_uniform_twist() -> None:
    # a uniform twisting moment 2 (2 D66) kappa... is carried by corner forces alone: inside, the forces of the four cells cancel
    uniform = type(MATERIALS)(*(np.repeat(column[:1], 2, axis=0) for column in MATERIALS))
    forces = particle_forces(ForceLattice(CLOTH, uniform, ("twist",)), saddle(0.1))[: ROWS * COLUMNS, 2].reshape(ROWS, COLUMNS)
    corner = 4.0 * uniform.twist[0] * 0.1 * 1.2  # 4 D66 kappa (A/h^2)
    assert forces[0, 0] == pytest.approx(-corner, rel=1e-3)
    assert forces[0, -1] == pytest.approx(corner, rel=1e-3)
    np.testing.assert_allclose(forces[1:-1, 1:-1], 0.0, atol=1e-3 * corner)


def test_no_twist_without_d66() -> None:
    none = MATERIALS._replace(twist=np.zeros(2))
    force = ForceLattice(CLOTH, none, ("twist",))
    assert np.abs(particle_forces(force, saddle(0.1))).max() == 0.0
    assert force.energy(saddle(0.1)) == 0.0


def test_cylinders_along_the_grain_do_not_twist_and_collapsed_cells_are_finite() -> None:
    positions = flat(CLOTH)
    positions[:, 2] = 3.0 * positions[:, 0] ** 2
    force = ForceLattice(CLOTH, MATERIALS, ("twist",))
    assert force.energy(positions) < 1e-25
    for collapsed in (np.zeros((CLOTH.particle_count, 3)), flat(CLOTH) * [1.0, 0.0, 1.0], H * np.ones((CLOTH.particle_count, 3))):
        assert np.isfinite(particle_forces(force, collapsed)).all()

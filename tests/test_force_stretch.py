"""Link tension against the tensile curve, and its damping."""

from __future__ import annotations

import math

import numpy as np
import pytest
from force_checks import particle_forces
from small_cloth import COLUMNS, H, flat, materials, small_cloth

from garmentcad.cloth.cloth import WARP
from garmentcad.forces.lattice import ForceLattice

CLOTH, MATERIALS = small_cloth(), materials()


def link_force(strain: float, rate: float = 0.0, damping_time: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Tension over width of every warp link of material 0 and of material 1 when the cloth is stretched along the warp."""
    positions = flat(CLOTH) * [1.0, 1.0 + strain, 1.0]
    velocities = flat(CLOTH) * [0.0, rate, 0.0]
    force = ForceLattice(CLOTH, MATERIALS, ("stretch",), damping_time)
    total = particle_forces(force, positions, velocities)
    # the links that begin in the lowest row pull at it alone: inside, the forces of two links cancel
    lowest = np.flatnonzero((CLOTH.links.direction == WARP) & (CLOTH.links.ends[:, 0] < COLUMNS))
    assert len(lowest) == COLUMNS
    tension, material = total[CLOTH.links.ends[lowest, 0], 1] / CLOTH.links.width[lowest], CLOTH.links.material[lowest]
    return tension[material == 0], tension[material == 1]


@pytest.mark.parametrize("share", [-1.0, 0.25, 0.5, 1.0, 1.5])
def test_tension_is_the_tensile_curve(share: float) -> None:
    strain, fm, x = 0.04 * share, 490.33, 2.5
    initial = fm * x / (0.04 * math.expm1(x))
    expected = (
        fm * math.expm1(x * share) / math.expm1(x) if 0 <= share <= 1 else initial * strain if share < 0 else fm + (initial + x * fm / 0.04) * (strain - 0.04)
    )
    curved, linear = link_force(strain)
    np.testing.assert_allclose(curved, expected, rtol=1e-9)
    np.testing.assert_allclose(linear, 200.0 * strain / 0.10, rtol=1e-9)


def test_damping_is_tau_times_initial_slope_times_rate() -> None:
    curved, linear = link_force(0.0, rate=3.0, damping_time=1e-5)
    np.testing.assert_allclose(linear, 1e-5 * 2000.0 * 3.0, rtol=1e-9)
    np.testing.assert_allclose(curved, 1e-5 * 490.33 * 2.5 / (0.04 * math.expm1(2.5)) * 3.0, rtol=1e-9)


def test_damping_takes_energy() -> None:
    velocities = np.random.default_rng(0).normal(size=(CLOTH.particle_count, 3))
    power = np.sum(particle_forces(ForceLattice(CLOTH, MATERIALS, ("stretch",), 1e-5), flat(CLOTH), velocities) * velocities)
    assert power < -1e-3


def test_a_link_of_no_length_is_finite() -> None:
    positions = flat(CLOTH)
    positions[1] = positions[0]
    assert np.isfinite(particle_forces(ForceLattice(CLOTH, MATERIALS, ("stretch",)), positions)).all()
    assert ForceLattice(CLOTH, MATERIALS, ("stretch",)).energy(positions) > 0.5 * 0.5 * H * H  # one link at strain -1, at least 1 N/m over h/2

"""Weight: free fall keeps the motion of the centre of mass exact."""

from __future__ import annotations

import numpy as np
import pytest
from force_checks import march
from small_cloth import deformed, materials, small_cloth

from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.forces.time_step import largest_stable_time_step

CLOTH = small_cloth()


def test_weight_and_energy() -> None:
    positions = np.random.default_rng(0).normal(size=(CLOTH.particle_count, 3))
    force, out = ForceGravity(CLOTH.masses), np.ones((CLOTH.particle_count, 3))
    force.add_forces(positions, np.zeros_like(positions), out)
    np.testing.assert_allclose(out - 1.0, np.outer(CLOTH.masses, [0.0, -9.81, 0.0]), atol=1e-15)
    assert force.energy(positions) == pytest.approx(9.81 * float(CLOTH.masses @ positions[:, 1]))


def test_free_fall_of_momentum() -> None:
    # a crumpled cloth that vibrates while it falls: momentum grows by m g t and nothing else
    assembly = ForceAssembly(internal_forces(CLOTH, materials()), CLOTH.particle_count, [ForceGravity(CLOTH.masses)])
    positions = deformed(CLOTH, "wavy")
    velocities = np.zeros_like(positions)
    stiffness = np.zeros(CLOTH.particle_count)
    assembly.stiffness(positions, stiffness)
    step = 0.5 * largest_stable_time_step(stiffness, CLOTH.masses)
    march(assembly, CLOTH.masses, positions, velocities, step, 1000)
    momentum, weight = CLOTH.masses @ velocities, 9.81 * CLOTH.masses.sum()
    np.testing.assert_allclose(momentum / (weight * 1000 * step), [0.0, -1.0, 0.0], atol=1e-10)


def test_the_stepper_takes_weight_alone() -> None:
    """It keeps one number a particle, along y: the wind of the howto would be lost in it."""

    class ForceWind:
        name = "wind"

        def add_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
            out += np.outer(CLOTH.masses, [0.0, 0.0, 1.0])

        def energies(self, positions: np.ndarray) -> dict[str, float]:
            return {"wind": 0.0}

    weight = ForceGravity(CLOTH.masses)
    laws = internal_forces(CLOTH, materials())
    assert ForceAssembly(laws, CLOTH.particle_count, [weight]).sums(CLOTH.masses).weight == pytest.approx(9.81 * CLOTH.masses)
    assembly = ForceAssembly(laws, CLOTH.particle_count, [weight, ForceWind()])
    with pytest.raises(ValueError, match="wind acts across the vertical"):
        assembly.sums(CLOTH.masses)
    total = np.zeros((CLOTH.particle_count, 3))
    assembly.add_up(deformed(CLOTH, "wavy"), np.zeros_like(total), total)
    assert (CLOTH.masses.sum() * np.array([0.0, -9.81, 1.0])) == pytest.approx(total.sum(axis=0), abs=1e-10)

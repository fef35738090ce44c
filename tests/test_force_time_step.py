"""The time step against the exact limits of modified Euler."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from force_checks import march, tangent_by_differences
from small_cloth import deformed, materials, small_cloth

from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.internal import internal_forces
from garmentcad.forces.time_step import SAFETY, SmallMotion, internal_damping_time, largest_stable_time_step


def test_two_masses_on_a_spring_are_exact() -> None:
    # equal masses: omega^2 = 2 k/m, and the row sum 2 k is no overestimate
    assert largest_stable_time_step(np.array([200.0, 200.0]), np.array([0.5, 0.5])) == pytest.approx(SAFETY * 2.0 / math.sqrt(400.0))
    assert internal_damping_time(np.array([200.0, 200.0]), np.array([0.5, 0.5]), 0.1) == pytest.approx(0.2 / 20.0)
    assert largest_stable_time_step(np.zeros(2), np.ones(2)) == math.inf


@pytest.mark.parametrize("ratio", [0.0, 0.15, 0.2])
def test_damped_oscillator_is_stable_at_the_step(ratio: float) -> None:
    omega = 100.0
    step = largest_stable_time_step(np.array([omega**2]), np.array([1.0]))
    matrix = np.array([[1 - 2 * ratio * omega * step, -step * omega**2], [step * (1 - 2 * ratio * omega * step), 1 - (step * omega) ** 2]])
    assert np.abs(np.linalg.eigvals(matrix)).max() <= 1.0 + 1e-12
    far = 1.3 * step
    matrix = np.array([[1 - 2 * ratio * omega * far, -far * omega**2], [far * (1 - 2 * ratio * omega * far), 1 - (far * omega) ** 2]])
    assert np.abs(np.linalg.eigvals(matrix)).max() > 1.0


def largest_motion(factor: float) -> float:
    cloth = small_cloth()
    cloth = replace(cloth, hinges=cloth.hinges._replace(rest_angle=np.zeros(len(cloth.hinges.rest_angle))))
    assembly = ForceAssembly(internal_forces(cloth, materials()), cloth.particle_count)
    positions = deformed(cloth, "wavy")
    start = positions.copy()
    velocities, stiffness = np.zeros_like(positions), np.zeros(cloth.particle_count)
    assembly.stiffness(positions, stiffness)
    march(assembly, cloth.masses, positions, velocities, factor * largest_stable_time_step(stiffness, cloth.masses), 1500)
    return float(np.nan_to_num(np.abs(positions - start), nan=np.inf).max())  # what ran away beyond numbers is infinitely far


def test_a_cloth_is_stable_at_the_step_and_not_far_beyond() -> None:
    assert largest_motion(1.0) < 0.02
    assert largest_motion(2.5) > 1.0


def test_measured_frequency_is_the_largest_eigenvalue_of_the_tangent() -> None:
    cloth = small_cloth()
    assembly = ForceAssembly(internal_forces(cloth, materials()), cloth.particle_count)
    positions = deformed(cloth, "wavy")
    inverse_masses = 1.0 / cloth.masses
    inverse_masses[:3] = 0.0
    root = np.repeat(np.sqrt(inverse_masses), 3)
    exact = math.sqrt(np.linalg.eigvalsh(root[:, None] * tangent_by_differences(assembly, positions) * root)[-1])
    measured = SmallMotion(assembly, positions).highest_frequency(lambda vectors: np.sqrt(inverse_masses)[:, None] * vectors)
    assert measured == pytest.approx(exact, rel=0.01)
    stiffness = np.empty(cloth.particle_count)
    assembly.stiffness(positions, stiffness)
    assert measured < math.sqrt(float((stiffness * inverse_masses).max()))

"""Rigid displacement and rigid velocity cost nothing, and internal forces conserve momentum and angular momentum."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from force_checks import corner_scale, march, particle_forces
from small_cloth import deformed, flat, materials, rotation, small_cloth

from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.internal import internal_forces
from garmentcad.forces.lattice import ForceLattice
from garmentcad.forces.time_step import largest_stable_time_step

CLOTH = small_cloth()
CLOTH = replace(CLOTH, hinges=CLOTH.hinges._replace(rest_angle=np.zeros(len(CLOTH.hinges.rest_angle))))
FORCES = {force.name: force for force in internal_forces(CLOTH, materials()) if len(force.corners)}
DAMPING_TIME = FORCES["border"].damping_time  # type: ignore[attr-defined]
LAWS = FORCES | {f"lattice {law}": ForceLattice(CLOTH, materials(), (law,), DAMPING_TIME) for law in ForceLattice.LAWS}


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("seed", range(3))
def test_rigid_displacement_gives_no_force(name: str, seed: int) -> None:
    force = LAWS[name]
    moved = flat(CLOTH) @ rotation(seed).T
    scale = corner_scale(force, deformed(CLOTH, "stretched")) if name in ("lattice stretch", "border") else corner_scale(force, deformed(CLOTH, "folded"))
    assert np.abs(particle_forces(force, moved)).max() < 1e-12 * scale


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("kind", ["wavy", "stretched", "sheared"])
def test_rigid_velocity_gives_no_damping(name: str, kind: str) -> None:
    force = LAWS[name]
    positions = deformed(CLOTH, kind)
    positions -= positions.mean(axis=0)
    still = particle_forces(force, positions)
    rigid = np.array([3.0, -1.0, 2.0]) + np.cross([5.0, 2.0, -4.0], positions)
    assert np.abs(particle_forces(force, positions, rigid) - still).max() < 1e-12 * corner_scale(force, positions)


@pytest.mark.parametrize("name", ["lattice stretch", "lattice shear", "border"])
def test_damping_is_felt_otherwise(name: str) -> None:
    positions = deformed(CLOTH, "wavy")
    velocities = np.random.default_rng(0).normal(size=positions.shape)
    damping = particle_forces(LAWS[name], positions, velocities) - particle_forces(LAWS[name], positions)
    assert np.sum(damping * velocities) < 0.0
    assert np.abs(damping).max() > 1e-5 * corner_scale(LAWS[name], positions)
    # momentum and angular momentum are kept by the damping too
    centred = positions - positions.mean(axis=0)
    assert np.abs(damping.sum(axis=0)).max() < 1e-12 * np.abs(damping).max()
    assert np.abs(np.cross(centred, damping).sum(axis=0)).max() < 1e-11 * np.abs(damping).max() * np.abs(centred).max()


def test_momentum_and_angular_momentum_for_one_second() -> None:
    assembly = ForceAssembly(list(FORCES.values()), CLOTH.particle_count)
    positions = deformed(CLOTH, "wavy")
    positions -= positions.mean(axis=0)
    masses = CLOTH.masses[:, None]
    velocities = np.array([0.1, 0.2, -0.1]) + np.cross([2.0, -1.0, 3.0], positions)
    momentum, turn = (masses * velocities).sum(axis=0), np.cross(positions, masses * velocities).sum(axis=0)
    stiffness = np.zeros(CLOTH.particle_count)
    assembly.stiffness(positions, stiffness)
    step = largest_stable_time_step(stiffness, CLOTH.masses)
    march(assembly, CLOTH.masses, positions, velocities, step, round(1.0 / step))
    assert np.abs(positions.mean(axis=0)).max() > 0.1  # it went its way
    assert np.abs((masses * velocities).sum(axis=0) - momentum).max() < 1e-10 * np.abs(momentum).max()
    now = np.cross(positions, masses * velocities).sum(axis=0)
    assert np.abs(now - turn).max() < 1e-10 * np.abs(turn).max()

"""The gather: equal to a plain sum, the same bits for any number of threads, one force a name."""

from __future__ import annotations

import numpy as np
import pytest
from command import printed_on_threads
from force_checks import particle_forces
from small_cloth import KINDS, deformed, materials, small_cloth

from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces

CLOTH = small_cloth()


def assembly() -> ForceAssembly:
    return ForceAssembly(internal_forces(CLOTH, materials()), CLOTH.particle_count, [ForceGravity(CLOTH.masses)])


def total(kind: str) -> np.ndarray:
    positions = deformed(CLOTH, kind)
    velocities = np.random.default_rng(5).normal(size=positions.shape)
    out = np.full_like(positions, np.nan)
    assembly().add_up(positions, velocities, out)
    return out


@pytest.mark.parametrize("kind", KINDS)
def test_sum_of_all_forces(kind: str) -> None:
    positions = deformed(CLOTH, kind)
    velocities = np.random.default_rng(5).normal(size=positions.shape)
    expected = np.sum([particle_forces(force, positions, velocities) for force in internal_forces(CLOTH, materials())], axis=0)
    expected[:, 1] -= 9.81 * CLOTH.masses
    np.testing.assert_allclose(total(kind), expected, rtol=1e-12, atol=1e-13 * np.abs(expected).max())


def test_energy_and_stiffness() -> None:
    positions = deformed(CLOTH, "wavy")
    energy = assembly().energy(positions)
    assert list(energy) == ["stretch", "shear", "twist", "bend", "border", "span", "hinge", "gravity"]
    forces = {force.name: force for force in internal_forces(CLOTH, materials())}
    assert energy["bend"] == forces["bend"].energy(positions) + forces["lattice"].energies(positions)["bend"]
    stiffness = np.zeros(CLOTH.particle_count)
    assembly().stiffness(positions, stiffness)
    assert (stiffness > 100.0).all()


def test_two_forces_of_one_name_are_refused() -> None:
    with pytest.raises(ValueError, match="gravity"):
        ForceAssembly([], 3, [ForceGravity(np.ones(3)), ForceGravity(np.ones(3))])


def test_no_forces_at_all() -> None:
    out = np.ones((3, 3))
    ForceAssembly([], 3).add_up(np.zeros((3, 3)), np.zeros((3, 3)), out)
    assert not out.any()


def test_same_bits_for_1_2_and_4_threads() -> None:
    """Of all forces on every kind of state."""
    printed = printed_on_threads("import test_force_assembly as t; print([t.total(kind).tobytes().hex() for kind in t.KINDS])")
    assert len(printed[0]) > 60
    assert len(set(printed)) == 1

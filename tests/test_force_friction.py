"""Internal friction in the forces of a cloth: sticking it is the gradient of its energy, without net force or torque; rigid motion leaves sliders alone."""

from __future__ import annotations

import numpy as np
import pytest
from force_checks import particle_forces
from small_cloth import KINDS, deformed, flat, materials, rotation, small_cloth

from garmentcad.forces.force import NO_PARTICLE, Force
from garmentcad.forces.internal import internal_forces
from garmentcad.forces.lattice import ForceLattice

CLOTH, MATERIALS = small_cloth(), materials(friction=1.0)
FORCES = {force.name: force for force in internal_forces(CLOTH, MATERIALS) if force.name != "span" and len(force.corners)}
LAWS = FORCES | {f"lattice {law}": ForceLattice(CLOTH, MATERIALS, (law,)) for law in ForceLattice.LAWS}


def stuck(force, positions: np.ndarray, seed: int = 0) -> np.ndarray:
    """Sliders that hold, anywhere within their way."""
    gauge = force.gauge(positions)
    return gauge.strain + np.random.default_rng(seed).uniform(-0.8, 0.8, gauge.way.shape) * gauge.way


class Held:
    """A force with its sliders at hand, for the checks of forces; copies of them, as checks move particles to and fro."""

    def __init__(self, force: Force, sliders: np.ndarray) -> None:
        self.force, self.sliders, self.name, self.corners = force, sliders, force.name, force.corners

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
        self.force.write_forces(positions, velocities, out, self.sliders.copy())

    def energy(self, positions: np.ndarray) -> float:
        return sum(self.force.energies(positions, self.sliders).values())


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", LAWS)
def test_sticking_is_minus_gradient_of_energy(name: str, kind: str) -> None:
    positions = deformed(CLOTH, kind, seed=1)
    positions -= positions.mean(axis=0)
    sliders = stuck(LAWS[name], positions)
    held, step = Held(LAWS[name], sliders), 1e-7  # so short that the sliders hold
    found = particle_forces(held, positions)
    largest = np.abs(found).max()
    rng = np.random.default_rng(3)
    for particle in rng.choice(len(positions), 12, replace=False):
        for axis in range(3):
            values = []
            for k in (-2, -1, 1, 2):
                moved = positions.copy()
                moved[particle, axis] += k * step
                values.append(held.energy(moved))
            expected = -(values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * step)
            assert found[particle, axis] == pytest.approx(expected, rel=1e-6, abs=1e-6 * largest)
    used = sliders.copy()
    LAWS[name].write_forces(positions, np.zeros_like(positions), np.zeros((len(held.corners), 3)), used)
    assert np.array_equal(used, sliders)


@pytest.mark.parametrize("share", [-0.9, 0.0, 0.9])
@pytest.mark.parametrize("name", LAWS)
def test_drawn_sliders_stand_a_share_of_their_way_behind_the_strain_and_hold(name: str, share: float) -> None:
    positions = deformed(CLOTH, KINDS[0], seed=1)
    force, gauge = LAWS[name], LAWS[name].gauge(positions)
    drawn = force.drawn(positions, share)
    assert np.allclose(gauge.strain - drawn, share * gauge.way, rtol=1e-9, atol=1e-12)
    used = drawn.copy()
    force.write_forces(positions, np.zeros_like(positions), np.zeros((len(force.corners), 3)), used)
    assert np.array_equal(used, drawn)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", LAWS)
def test_no_net_force_nor_torque(name: str, kind: str) -> None:
    """With sliders that hold, and with sliders that are dragged."""
    positions = deformed(CLOTH, kind, seed=2)
    positions -= positions.mean(axis=0)
    force = LAWS[name]
    for sliders in (stuck(force, positions), force.slack(), 50.0 * stuck(force, positions, 1)):
        total = particle_forces(Held(force, sliders), positions)
        corner = np.zeros((len(force.corners), 3))
        force.write_forces(positions, np.zeros_like(positions), corner, sliders.copy())
        scale = np.abs(corner).max()
        assert np.abs(total.sum(axis=0)).max() < 1e-12 * scale
        assert np.abs(np.cross(positions, total).sum(axis=0)).max() < 1e-12 * scale * np.abs(positions).max()


@pytest.mark.parametrize("name", FORCES)
def test_rigid_motion_leaves_sliders_and_energy_alone(name: str) -> None:
    force = FORCES[name]
    positions = deformed(CLOTH, "wavy")
    sliders = stuck(force, positions)
    before, energy = sliders.copy(), sum(force.energies(positions, sliders).values())
    out = np.zeros((len(force.corners), 3))
    for seed in range(4):
        moved = positions @ rotation(seed).T + [0.5, -0.2, 0.1]
        force.write_forces(moved, np.zeros_like(moved), out, sliders)
        assert np.array_equal(sliders, before)
        assert sum(force.energies(moved, sliders).values()) == pytest.approx(energy, rel=1e-9)


@pytest.mark.parametrize("kind", ["wavy", "stretched", "sheared", "folded"])
@pytest.mark.parametrize("name", LAWS)
def test_a_strain_drags_its_slider_to_the_end_of_its_way_once(name: str, kind: str) -> None:
    force, positions = LAWS[name], deformed(CLOTH, kind, seed=4)
    gauge, sliders = force.gauge(positions), force.slack()
    out = np.zeros((2, len(force.corners), 3))
    before = sliders.copy()
    force.write_forces(positions, np.zeros_like(positions), out[0], sliders)
    np.testing.assert_allclose(sliders, np.clip(before, gauge.strain - gauge.way, gauge.strain + gauge.way), rtol=1e-9, atol=1e-9 * np.abs(gauge.strain).max())
    once = sliders.copy()
    force.write_forces(positions, np.zeros_like(positions), out[1], sliders)
    assert np.array_equal(sliders, once)
    assert np.array_equal(out[0], out[1])
    assert (once != before).any() or name == "lattice stretch"


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", LAWS)
def test_row_sum_bounds_the_highest_eigenvalue_of_sticking_cloth(name: str, kind: str) -> None:
    force, positions = LAWS[name], deformed(CLOTH, kind, seed=3)
    size = positions.size
    held, step = Held(force, stuck(force, positions)), 1e-7
    hessian = np.empty((size, size))
    for column, index in enumerate(np.ndindex(*positions.shape)):
        pair = []
        for sign in (1, -1):
            moved = positions.copy()
            moved[index] += sign * step
            pair.append(particle_forces(held, moved).ravel())
        hessian[:, column] = -(pair[0] - pair[1]) / (2 * step)
    root = np.repeat(1.0 / np.sqrt(CLOTH.masses), 3)
    found = np.linalg.eigvalsh(0.5 * (hessian + hessian.T) * root[:, None] * root[None, :]).max()
    corner_stiffness = np.zeros(len(force.corners))
    force.write_stiffness(positions, corner_stiffness)
    used = force.corners != NO_PARTICLE
    bound = np.bincount(force.corners[used], weights=corner_stiffness[used], minlength=len(CLOTH.masses))
    assert found <= 1.001 * np.max(bound / CLOTH.masses)


def test_cloth_that_was_never_strained_is_as_without_friction() -> None:
    """Flat, no force; stretched for the first time, the printed curve."""
    for force in FORCES.values():
        if force.name != "hinge":
            assert np.abs(particle_forces(force, flat(CLOTH))).max() < 1e-12
    elastic, full = (ForceLattice(CLOTH, table, ("stretch",)) for table in (materials(), MATERIALS))
    stretched = flat(CLOTH) * [1.03, 1.02, 1.0]
    np.testing.assert_allclose(particle_forces(full, stretched), particle_forces(elastic, stretched), rtol=1e-12, atol=1e-12)

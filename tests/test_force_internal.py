"""Every internal force is the gradient of its energy, has no net force nor torque, and its row sum bounds the highest eigenvalue."""

from __future__ import annotations

import numpy as np
import pytest
from force_checks import balance_error, gradient_error, row_sums_over_bounds, stiffness_over_bound
from small_cloth import KINDS, deformed, flat, materials, small_cloth

from garmentcad.fabric.material import softened
from garmentcad.forces.force import NO_PARTICLE, Force
from garmentcad.forces.internal import BINS, dealt, internal_forces, soften
from garmentcad.forces.lattice import ForceLattice
from garmentcad.forces.time_step import highest_frequency

CLOTH, MATERIALS = small_cloth(), materials()
FORCES = {force.name: force for force in internal_forces(CLOTH, MATERIALS)}
LAWS = {name: force for name, force in FORCES.items() if len(force.corners)} | {law: ForceLattice(CLOTH, MATERIALS, (law,)) for law in ForceLattice.LAWS}
LAWS["bend at the contour"] = FORCES["bend"]


def test_all_laws_are_there() -> None:
    assert list(FORCES) == ["lattice", "border", "bend", "span", "hinge"]
    assert list(FORCES["lattice"].energies(flat(CLOTH))) == ["stretch", "shear", "twist", "bend"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", LAWS)
def test_force_is_minus_gradient_of_energy(name: str, kind: str) -> None:
    positions = deformed(CLOTH, kind, seed=1)
    assert gradient_error(LAWS[name], positions - positions.mean(axis=0)) < 1e-6


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", LAWS)
def test_no_net_force_nor_torque(name: str, kind: str) -> None:
    force, torque = balance_error(LAWS[name], deformed(CLOTH, kind, seed=2))
    assert force < 1e-12
    assert torque < 1e-12


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", LAWS)
def test_row_sum_bounds_the_highest_eigenvalue(name: str, kind: str) -> None:
    ratio = stiffness_over_bound(LAWS[name], deformed(CLOTH, kind, seed=3), CLOTH.masses)
    assert 0.1 < ratio <= 1.0 + 1e-6


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["lattice", *ForceLattice.LAWS])
def test_each_row_of_the_lattice_is_bounded(name: str, kind: str) -> None:
    """At every particle, and of the whole lattice closely: what one element or neighbour is forgotten or counted twice for shows."""
    ratio = row_sums_over_bounds(LAWS[name], deformed(CLOTH, kind, seed=3))
    assert 0.1 < ratio.max() <= 1.0 + 1e-6
    assert name != "lattice" or ratio[ratio > 0.0].min() > 0.6


def test_damping_ratio_of_the_highest_mode() -> None:
    # tau omega/2 = 0.15 at the bound of the highest in-plane frequency at rest
    tau = {FORCES[name].damping_time for name in ("lattice", "border")}  # type: ignore[attr-defined]
    assert len(tau) == 1
    stiffness = np.zeros(CLOTH.particle_count)
    for force in (ForceLattice(CLOTH, MATERIALS, ("stretch", "shear")), FORCES["border"]):
        corner_stiffness = np.zeros(len(force.corners))
        force.write_stiffness(flat(CLOTH), corner_stiffness)
        used = force.corners != NO_PARTICLE
        np.add.at(stiffness, force.corners[used], corner_stiffness[used])
    assert 0.5 * tau.pop() * highest_frequency(stiffness, CLOTH.masses) == pytest.approx(0.15, rel=1e-6)


def acts(force: Force, positions: np.ndarray, velocities: np.ndarray) -> list[np.ndarray]:
    """Forces, bounds of stiffness, sliders that have moved, energies."""
    sliders, forces, bounds = force.slack(), np.zeros((len(force.corners), 3)), np.zeros(len(force.corners))
    force.write_forces(positions, velocities, forces, sliders)
    force.write_stiffness(positions, bounds)
    return [forces, bounds, sliders, np.array(list(force.energies(positions, sliders).values()))]


def test_laws_in_many_parts_are_the_laws_in_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Large cloths have more elements than one part takes: the same forces, sliders, bounds, energies and gauges, for a softened cloth as well."""
    rough = materials(friction=1.0)
    whole = ForceLattice(CLOTH, rough, damping_time=1e-5)
    monkeypatch.setattr("garmentcad.forces.lattice.PART_OF_LAW", 7)
    parts = ForceLattice(CLOTH, rough, damping_time=1e-5)
    assert len(parts.laws) > 4 * len(whole.laws)
    positions = deformed(CLOTH, "crumpled", seed=6)
    velocities = 0.1 * np.random.default_rng(7).standard_normal(positions.shape)
    for softness in (1.0, 8.0):
        for force in (whole, parts):
            force.set_plane(softened(rough, softness))
        for one, other in zip(acts(parts, positions, velocities), acts(whole, positions, velocities)):
            assert one == pytest.approx(other, rel=1e-12)
        for one, other in zip(parts.gauge(positions), whole.gauge(positions)):
            assert np.array_equal(one, other)
    bounds = np.zeros((2, len(whole.corners)))
    whole.write_stiffness_across(positions, bounds[0])
    parts.write_stiffness_across(positions, bounds[1])
    assert bounds[1] == pytest.approx(bounds[0], rel=1e-12)


@pytest.mark.parametrize("last", [3.0, 1.0])
def test_softened_again_and_again_they_are_those_of_the_softened_fabric(last: float) -> None:
    """Of cloth in motion with internal friction, damping included: as if they had been made so."""
    rough = materials(friction=1.0)
    positions = deformed(CLOTH, "crumpled", seed=4)
    velocities = 0.1 * np.random.default_rng(5).standard_normal(positions.shape)
    found = internal_forces(CLOTH, rough)
    before = acts(found[0], positions, velocities)
    for softness in (64.0, last):
        soften(found, CLOTH, rough, softness)
    for force, expected in zip(found, internal_forces(CLOTH, softened(rough, last))):
        for one, other in zip(acts(force, positions, velocities), acts(expected, positions, velocities)):
            assert np.array_equal(one, other)
    assert np.array_equal(before[0], acts(found[0], positions, velocities)[0]) == (last == 1.0)


@pytest.mark.parametrize("blocks", [1, 5, 6, 11, 40])
def test_two_and_four_threads_get_about_the_same_work_side_by_side(blocks: int) -> None:
    """A few large blocks among many small parts, as garments have them: all parts once, and shares that differ by no more than a part could mend. Of equal
    parts alone, what one thread gets lies before what the other gets."""
    rng = np.random.default_rng(blocks)
    work = np.concatenate([rng.uniform(25.0, 35.0, blocks), rng.uniform(1.0, 3.0, 30)])
    place = rng.permutation(len(work)).astype(np.float64)
    bins = dealt(work, place)
    assert len(bins) == BINS
    assert sorted(part for one in bins for part in one) == list(range(len(work)))
    load = np.array([work[one].sum() for one in bins])
    halves = load.reshape(2, -1).sum(axis=1)
    assert abs(halves[0] - halves[1]) <= (work.max() if blocks == 1 else work[blocks:].max())
    for pair in load.reshape(2, 2, -1).sum(axis=2):
        assert abs(pair[0] - pair[1]) <= work.max()
    place = rng.permutation(8.0 * np.arange(8 * blocks))
    order = [place[part] for one in dealt(np.ones(8 * blocks), place) for part in one]
    assert order == sorted(order)

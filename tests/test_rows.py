"""The padded rows of a whole garment: its lattice forces are the gradient of energies that are summed over the element lists, without rows."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from small_cloth import materials as two_materials
from small_cloth import small_cloth

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import build_cloth, rectangle_cloth
from garmentcad.cloth.weld import weld
from garmentcad.fabric.material import MaterialTable, without_friction
from garmentcad.forces import rows
from garmentcad.forces.force import NO_PARTICLE
from garmentcad.forces.lattice import ForceLattice, lattice_block
from garmentcad.forces.rows import CELLS, KEPT, LINES, LatticeSlots
from garmentcad.placement.place import place_vertices
from garmentcad.simulation.job import make_job
from garmentcad.simulation.materials import lay_out


@pytest.fixture(scope="module", params=["straight-skirt", "t-shirt"])
def garment(request: pytest.FixtureRequest) -> tuple[Cloth, MaterialTable, np.ndarray]:
    """Several panels of different widths, regions included, laid around the body and shaken."""
    job = make_job(request.param, "wool-suiting", "woman-88", grid_mm=25.0)
    materials, material_of = lay_out(job)
    cloth, _ = weld(build_cloth(job.pattern, material_of, materials, job.grid_mm))
    positions = np.empty((cloth.particle_count, 3))
    positions[cloth.vertex_particle] = place_vertices(job.pattern, cloth, job.mannequin)
    return cloth, materials, positions + 1e-3 * np.random.default_rng(4).standard_normal(positions.shape)


@pytest.mark.parametrize("law", ForceLattice.LAWS)
def test_forces_of_several_panels_are_the_gradient_of_the_energy(garment: tuple[Cloth, MaterialTable, np.ndarray], law: str) -> None:
    cloth, materials, positions = garment
    materials = without_friction(materials)
    force = ForceLattice(cloth, materials, (law,))
    corner_forces = np.full((len(force.corners), 3), np.nan)
    force.write_forces(positions, np.zeros_like(positions), corner_forces)
    used = force.corners != NO_PARTICLE
    total = np.zeros_like(positions)
    np.add.at(total, force.corners[used], corner_forces[used])
    for seed in range(4):  # one direction moves all particles, another a twentieth of them
        rng = np.random.default_rng(seed)
        direction = rng.standard_normal(positions.shape) * ((rng.random(len(positions)) < 0.05)[:, None] if seed % 2 else 1.0)
        step = 1e-7
        slope = [force.energy(positions + k * step * direction) for k in (-2, -1, 1, 2)]
        expected = -(slope[0] - 8.0 * slope[1] + 8.0 * slope[2] - slope[3]) / (12.0 * step)
        assert np.sum(total * direction) == pytest.approx(expected, rel=1e-5, abs=1e-7 * np.linalg.norm(total) * np.linalg.norm(direction))


def test_a_link_that_joins_no_neighbours_is_refused() -> None:
    cloth = small_cloth()
    ends = cloth.links.ends.copy()
    ends[0, 1] += 1
    with pytest.raises(ValueError, match="two neighbours"):
        ForceLattice(Cloth(**{**cloth.__dict__, "links": cloth.links._replace(ends=ends)}), two_materials())


def test_every_lattice_particle_has_one_slot(garment: tuple[Cloth, MaterialTable, np.ndarray]) -> None:
    cloth, _, _ = garment
    slots = LatticeSlots(cloth)
    blocks = slots.blocks
    held = np.concatenate([blocks.particle[first : first + size] for first, size in zip(blocks.first, blocks.size, strict=True)])
    expected = np.sort(cloth.vertex_particle[~cloth.vertex_on_contour])
    np.testing.assert_array_equal(np.sort(held[held != NO_PARTICLE]), expected)


@pytest.mark.parametrize("slots", [1, 120])
def test_forces_and_sliders_do_not_depend_on_the_blocks(garment: tuple[Cloth, MaterialTable, np.ndarray], slots: int, monkeypatch) -> None:
    """Blocks of one row or a few compute most of it two times or more."""
    cloth, materials, positions = garment

    def moved() -> tuple[list[bytes], int]:
        force, rng, found = ForceLattice(cloth, materials, damping_time=1e-5), np.random.default_rng(7), []
        sliders, out = force.slack(), np.zeros((len(force.corners), 3))
        for _ in range(3):  # there and back, so that sliders move
            places, velocities = positions + 2e-4 * rng.standard_normal(positions.shape), rng.standard_normal(positions.shape)
            force.write_forces(places, velocities, out, sliders)
            total = np.zeros_like(positions)
            total[force.corners[force.corners != NO_PARTICLE]] = out[force.corners != NO_PARTICLE]
            found += [total.tobytes(), sliders.tobytes()]
        return found, len(LatticeSlots(cloth).blocks.first)

    expected, blocks = moved()
    monkeypatch.setattr(rows, "BLOCK", slots)
    monkeypatch.setattr(rows, "BLOCK_ROWS", 1)
    found, others = moved()
    assert others != blocks
    assert found == expected


def test_wide_cloth_has_blocks_of_many_rows() -> None:
    """Three rows of a block are computed twice: with four rows, as blocks of so many slots would have here, that is three quarters more."""
    cloth = rectangle_cloth(4000.0, 800.0, 10.0, 0.0, two_materials())
    blocks = LatticeSlots(cloth).blocks
    assert len(blocks.size) > 1
    assert (blocks.size // blocks.columns).min() >= 16


@pytest.mark.parametrize("lanes", [1, rows.LANES])
def test_what_loops_leave_out_reaches_no_force(garment: tuple[Cloth, MaterialTable, np.ndarray], lanes: int, monkeypatch) -> None:
    """A room that holds no numbers, as one may after a run that diverged, gives the same forces, sliders, losses and bounds as an empty one; also where runs
    are not rounded to whole registers."""
    cloth, materials, positions = garment
    runs_of = rows._runs_of_loops

    def with_lanes(*arguments):  # type: ignore[no-untyped-def]
        with monkeypatch.context() as patch:
            patch.setattr(rows, "LANES", lanes)
            return runs_of(*arguments)

    monkeypatch.setattr(rows, "_runs_of_loops", with_lanes)
    places, velocities = positions + 2e-4 * np.random.default_rng(8).standard_normal(positions.shape), 0.1 * positions
    found = []
    for held in (0.0, np.nan):
        force = ForceLattice(cloth, materials, damping_time=1e-5)
        (blocks, coefficients, setting, room), sliders, used = force.arguments, force.slack(), force.corners != NO_PARTICLE
        out, bounds = np.zeros((len(force.corners), 3)), np.zeros(len(force.corners))
        lost = []
        for at in (positions, places):
            room[:] = held
            fabric = coefficients, sliders
            lost.append([lattice_block(np.int64(k), blocks, fabric, setting, at, velocities, room, out) for k in range(len(blocks.first))])
        room[:] = held
        force.write_stiffness(places, bounds)
        found.append([lost, out[used].tobytes(), sliders.tobytes(), bounds[used].tobytes()])
    assert found[0] == found[1]
    assert sum(found[0][0][1]) > 0.0
    assert not np.isnan(np.frombuffer(found[0][1])).any()


def test_loops_leave_out_what_holds_no_particle() -> None:
    """Of the rectangle around a panel of a flared skirt a third is empty."""
    job = make_job("flared-skirt", grid_mm=10.0)
    materials, material_of = lay_out(job)
    cloth = build_cloth(job.pattern, material_of, materials, job.grid_mm)
    slots = LatticeSlots(cloth)
    gone_over = np.array([[(slots.blocks.runs[a:b, 1] - slots.blocks.runs[a:b, 0]).sum() for a, b in itertools.pairwise(row)] for row in slots.blocks.start])
    held = np.count_nonzero(slots.slot >= 0)
    assert gone_over[:, KEPT].sum() == held
    # two and three of 32 rows twice, and at either end of a row a slot and half a register more: 1.19 and 1.26
    assert gone_over[:, LINES].sum() < 1.25 * held
    assert gone_over[:, CELLS].sum() < 1.35 * held
    assert held < 0.7 * slots.blocks.size.sum()

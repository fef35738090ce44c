"""Energy of a swatch that falls into its drape: it never grows, what friction takes counted or not."""

from __future__ import annotations

import numpy as np
import pytest

from garmentcad.cloth.lattice import rectangle_cloth
from garmentcad.cloth.state import State
from garmentcad.contact.contact import Contact
from garmentcad.fabric.material import without_friction
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.io.fabric_file import fabric_path, load_fabric
from garmentcad.rigs.kes import sheet_materials
from garmentcad.solve.dynamics import Dynamics
from garmentcad.solve.strain_limit import strain_limit

SIDE_MM, GRID_MM, UNTIL_S = 200.0, 20.0, 0.6
STEPS = 24  # between two looks
GROWTH = 1e-3  # of the range


@pytest.mark.parametrize("friction", [True, False])
def test_energy_of_a_damped_drape_never_grows(friction: bool) -> None:
    """Held at two corners, laid flat with a waviness of 1 mm. Only drag and internal damping may take what friction did not."""
    materials = sheet_materials(load_fabric(fabric_path("wool-suiting")).sheet)
    if not friction:
        materials = without_friction(materials)
    cloth = rectangle_cloth(SIDE_MM, SIDE_MM, GRID_MM, 0.0, materials)
    place = 1e-3 * cloth.vertex_uv_mm
    positions = np.column_stack([place[:, 0], 1e-3 * np.sin(40.0 * place[:, 0] + 25.0 * place[:, 1]), -place[:, 1]])
    corners = (place[:, 1] < 1e-9) & ((place[:, 0] < 1e-9) | (place[:, 0] > 1e-3 * SIDE_MM - 1e-9))
    forces = ForceAssembly(internal_forces(cloth, materials), cloth.particle_count, [ForceGravity(cloth.masses)])
    dynamics = Dynamics(cloth, forces, strain_limit(cloth, materials), Contact(cloth, materials), corners)
    dynamics.drag = 3.0
    state = State(positions, np.zeros_like(positions))
    dynamics.start(state)
    stored, taken = [], []
    while state.time_s < UNTIL_S:
        kinetic, _, _ = dynamics.measures(state)
        stored.append(kinetic + sum(forces.energy(state.positions, state.friction).values()))
        taken.append(-state.work_j["internal_friction"] - state.work_j["friction"])
        dynamics.advance(state, STEPS)
    energy, friction_work = np.array(stored), np.array(taken)
    fallen = energy.max() - energy.min()
    assert fallen > 0.3 * cloth.masses.sum() * 9.81 * 1e-3 * SIDE_MM  # it did fall
    for kept in (energy, energy + friction_work):
        assert (kept - np.minimum.accumulate(kept)).max() < GROWTH * fallen
    assert (friction_work[-1] > 0.01 * fallen) == friction
    assert np.diff(friction_work).min() >= -1e-12 * fallen

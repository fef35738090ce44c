"""The drapemeter: a plate stays flat, limp cloth hangs down, and what the discs hold does not move."""

from __future__ import annotations

import numba
import numpy as np
import pytest

from garmentcad.errors import InputError
from garmentcad.fabric.material import MaterialTable, without_friction
from garmentcad.io.fabric_file import fabric_path, load_fabric
from garmentcad.rigs.cusick import CLAMPED, Drape, Drapemeter
from garmentcad.rigs.kes import sheet_materials

numba.set_num_threads(1)

ELASTIC = without_friction(sheet_materials(load_fabric(fabric_path("cotton-broad")).sheet))
GRID_MM = 20.0


def bent(times: float) -> MaterialTable:
    """The fabric with its bending stiffness multiplied in all directions."""
    return ELASTIC._replace(bending=times * ELASTIC.bending, twist=times * ELASTIC.twist)


@pytest.fixture(scope="module")
def drapes() -> dict[float, Drape]:
    return {times: Drapemeter(bent(times), GRID_MM).lay(0) for times in (0.1, 100.0)}


def test_a_plate_casts_the_shadow_of_its_disc_and_limp_cloth_hangs(drapes: dict[float, Drape]) -> None:
    plate, limp = drapes[100.0], drapes[0.1]
    assert plate.status == limp.status == "converged"
    assert plate.dc_percent == pytest.approx(100.0, abs=2.0)  # the rim of a 20 mm lattice is a polygon
    assert plate.shadow.nodes == 0
    assert limp.dc_percent < 45.0
    assert limp.shadow.nodes >= 3
    assert limp.lowest_mm > 45.0  # of 60 mm that hang over


def test_what_the_discs_hold_does_not_move(drapes: dict[float, Drape]) -> None:
    drape = drapes[0.1]
    radius = np.linalg.norm(drape.cloth.vertex_uv_mm, axis=1)
    held = radius <= 90.0 + CLAMPED * GRID_MM
    assert 0.3 < held.mean() < 0.7
    assert np.abs(drape.state.positions[held, 1]).max() == 0.0
    assert np.linalg.norm(drape.state.positions[held][:, [0, 2]], axis=1) == pytest.approx(radius[held] / 1000.0, abs=1e-12)


def test_a_drape_at_rest_stays_in_true_motion_and_when_it_is_taken_over() -> None:
    """With internal friction, whose sliders go over: without them DC moves by a point."""
    materials = sheet_materials(load_fabric(fabric_path("cotton-broad")).sheet)
    here, there = Drapemeter(materials, GRID_MM), Drapemeter(materials, GRID_MM)
    drape = here.lay(0)
    later = here.waited(drape, 1.0)
    assert later.state.time_s >= drape.state.time_s + 1.0
    assert abs(later.dc_percent - drape.dc_percent) < 0.1  # points per second
    moved = there.taken_over(here, drape)
    assert moved.status == "converged"
    assert moved.shadow.nodes == drape.shadow.nodes
    assert moved.dc_percent == pytest.approx(drape.dc_percent, abs=0.1)


def test_an_unknown_drapemeter_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(InputError, match=r"18/24, 18/30, 18/36, 12\.7/25\.4"):
        Drapemeter(ELASTIC, GRID_MM, "20/30")


def test_bending_begins_at_the_disc_whatever_the_lattice() -> None:
    """Twice the spacing moves DC of a stiff cotton by 2.4 points; where bend lines out of the clamp have the length of the lattice, by 12."""
    materials = sheet_materials(load_fabric(fabric_path("cotton-broad")).sheet)
    coarse, fine = (Drapemeter(materials, grid_mm).lay(0).dc_percent for grid_mm in (GRID_MM, 0.5 * GRID_MM))
    assert coarse == pytest.approx(fine, abs=4.0)

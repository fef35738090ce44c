"""The drapemeter: a plate stays flat, limp cloth hangs down, shaking lets go what friction held, and what the discs hold does not move."""

from __future__ import annotations

import math

import numpy as np
import pytest

from garmentcad.errors import InputError
from garmentcad.fabric.material import MaterialTable, without_friction
from garmentcad.io.fabric_file import fabric_path, load_fabric
from garmentcad.rigs import cusick
from garmentcad.rigs.cusick import CLAMPED, HANDLED, Drape, Drapemeter
from garmentcad.rigs.kes import sheet_materials
from garmentcad.units import GRAVITY_M_S2

COTTON = sheet_materials(load_fabric(fabric_path("cotton-broad")).sheet)
ELASTIC = without_friction(COTTON)
GRID_MM = 20.0


def bent(times: float) -> MaterialTable:
    """The fabric with its bending stiffness multiplied in all directions."""
    return ELASTIC._replace(bending=times * ELASTIC.bending, twist=times * ELASTIC.twist)


@pytest.fixture(scope="module")
def drapes() -> dict[float, Drape]:
    return {times: Drapemeter(bent(times), GRID_MM).lay(0) for times in (0.1, 100.0)}


@pytest.fixture(scope="module")
def cotton() -> Drape:
    return Drapemeter(COTTON, GRID_MM).lay(0)


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


def test_a_drape_at_rest_stays_in_true_motion_and_when_it_is_taken_over(cotton: Drape) -> None:
    """With internal friction, whose sliders go over: without them DC moves by a point."""
    here, there = Drapemeter(COTTON, GRID_MM), Drapemeter(COTTON, GRID_MM)
    later = here.waited(cotton, 1.0)
    assert later.state.time_s >= cotton.state.time_s + 1.0
    assert abs(later.dc_percent - cotton.dc_percent) < 0.1  # points per second
    moved = there.taken_over(here, cotton)
    assert moved.status == "converged"
    assert moved.shadow.nodes == cotton.shadow.nodes
    assert moved.dc_percent == pytest.approx(cotton.dc_percent, abs=0.1)
    shifted = Drapemeter(COTTON, GRID_MM, origin_mm=(0.25 * GRID_MM, 0.25 * GRID_MM)).taken_over(here, cotton)
    assert shifted.dc_percent == pytest.approx(cotton.dc_percent, abs=1.5)


def test_the_weight_comes_on_from_nothing_without_a_jump_and_the_shaken_cloth_always_bears_on_the_disc() -> None:
    shares = np.linspace(0.0, 1.0, 301)
    loads = np.array([[part.load(share) for share in shares] for part in HANDLED])
    assert loads[0, 0] == 0.0
    assert loads[:-1, -1] == pytest.approx(loads[1:, 0])
    assert loads[-1, -1] == 1.0
    assert loads[1:].min() > 0.0
    assert loads[1].mean() == pytest.approx(1.0, abs=1e-9)  # up as much as down: the disc is back where it was


def test_half_the_time_step_drapes_alike(cotton: Drape) -> None:
    """What is done to the specimen is a matter of time and not of steps (0.14 points where the load followed every 192 steps)."""
    assert Drapemeter(COTTON, GRID_MM).lay(0, 0.5).dc_percent == pytest.approx(cotton.dc_percent, abs=0.05)


def test_shaking_lets_go_what_internal_friction_held(cotton: Drape, monkeypatch: pytest.MonkeyPatch) -> None:
    """A stiff light cotton that is only let down stays up (DC 85; 50 without friction)."""
    monkeypatch.setattr(cusick, "HANDLED", HANDLED[:1])
    let_down = Drapemeter(COTTON, GRID_MM).lay(0)
    assert cotton.dc_percent < let_down.dc_percent - 5.0


def test_an_unknown_drapemeter_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(InputError, match=r"18/24, 18/30, 18/36, 12\.7/25\.4"):
        Drapemeter(ELASTIC, GRID_MM, "20/30")


def plate_droop_m(bending: float, weight_pa: float, clamp_m: float, rim_m: float) -> float:
    """How far the rim of an annular plate without Poisson effect sinks under its weight. Source: Timoshenko, Theory of Plates and Shells, chapter 3: w =
    q r^4/(64 B) + c1 + c2 ln r + c3 r^2 + c4 r^2 ln r, clamped inside (w = w' = 0), free outside (w'' = 0, no shear force)."""
    inner, outer = math.log(clamp_m), math.log(rim_m)
    conditions = [
        [1.0, inner, clamp_m**2, clamp_m**2 * inner],
        [0.0, 1.0 / clamp_m, 2.0 * clamp_m, clamp_m * (2.0 * inner + 1.0)],
        [0.0, -1.0 / rim_m**2, 2.0, 2.0 * outer + 3.0],
        [0.0, 0.0, 0.0, 4.0 / rim_m],
    ]
    share = weight_pa / (64.0 * bending)
    constants = np.linalg.solve(conditions, [-share * clamp_m**4, -4.0 * share * clamp_m**3, -12.0 * share * rim_m**2, -32.0 * share * rim_m])
    return float(share * rim_m**4 + constants @ [1.0, outer, rim_m**2, rim_m**2 * outer])


@pytest.mark.parametrize("shift", [0.0, 0.25, 0.5])
def test_a_plate_droops_from_the_edge_of_the_disc_wherever_the_lattice_lies(shift: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Stiff alike in all directions."""
    monkeypatch.setattr(cusick, "HANDLED", HANDLED[:1])
    bending, grid_mm = 400.0 * float(ELASTIC.bending.mean()), 0.5 * GRID_MM
    stiff = ELASTIC._replace(bending=np.full_like(ELASTIC.bending, bending), twist=np.full_like(ELASTIC.twist, 0.5 * bending))
    drape = Drapemeter(stiff, grid_mm, origin_mm=(shift * grid_mm, shift * grid_mm)).lay(0)
    rim = np.linalg.norm(drape.cloth.vertex_uv_mm, axis=1) > 149.9
    droop = -drape.state.positions[rim, 1]
    weight_pa = float(ELASTIC.areal_mass[0]) * GRAVITY_M_S2
    assert droop.mean() == pytest.approx(plate_droop_m(bending, weight_pa, 0.09, 0.15), rel=0.01)
    assert np.ptp(droop) < 0.07 * droop.mean()

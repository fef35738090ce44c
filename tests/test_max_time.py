"""A drape that its cap on simulated time stops: while it is sewn, and while tension is soft."""

from __future__ import annotations

import pytest

from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.internal import internal_forces
from garmentcad.simulation.job import make_job
from garmentcad.simulation.record import record
from garmentcad.simulation.run import Outcome, run


def stopped_at(max_time_s: float, grid_mm: float = 50.0) -> Outcome:
    return run(make_job("straight-skirt", grid_mm=grid_mm, max_time_s=max_time_s), lambda progress: None)


def test_the_cap_counts_while_seams_close() -> None:
    outcome = stopped_at(0.2, grid_mm=30.0)
    assert outcome.status == "max_time"
    assert 0.2 <= outcome.state.time_s < 0.3  # looked at every 192 steps
    assert outcome.cloth.particle_count == outcome.flat.particle_count, "nothing is welded across an open seam"
    assert all("it stood" in warning for warning in outcome.warnings if "did not close" in warning)
    assert any("did not close" in warning for warning in outcome.warnings)


def test_seams_whose_turn_has_not_come_stand_open() -> None:
    """The legs of the trousers are sewn first, the crotch seam afterwards."""
    outcome = run(make_job("trousers", grid_mm=50.0, max_time_s=0.05), lambda progress: None)
    later = [seam.name for seam in outcome.job.pattern.seams if seam.order > 1]
    assert outcome.status == "max_time"
    assert later
    assert all(outcome.welding.gap_mm[name] > 1.0 for name in later)


def test_what_is_stopped_while_tension_is_soft_is_judged_with_the_tension_of_its_fabric() -> None:
    outcome = stopped_at(2.2)
    assert (outcome.status, outcome.state.phase) == ("max_time", "fall")
    forces = ForceAssembly(internal_forces(outcome.cloth, outcome.materials), outcome.cloth.particle_count)
    true = forces.energy(outcome.state.positions, outcome.state.friction)
    made, _ = record(outcome)
    assert made.energy_j["stretch"] == pytest.approx(true["stretch"] + true.get("border", 0.0))

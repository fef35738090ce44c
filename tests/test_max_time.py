"""A drape that its cap on simulated time stops: while it is sewn, and while tension is soft."""

from __future__ import annotations

import numpy as np
import pytest

from garmentcad.cloth.state import State
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.simulation.job import make_job
from garmentcad.simulation.record import record
from garmentcad.simulation.run import Outcome, run
from garmentcad.solve.dynamics import Dynamics, IntersectingError


def stopped_at(max_time_s: float, grid_mm: float = 50.0) -> Outcome:
    return run(make_job("straight-skirt", grid_mm=grid_mm, max_time_s=max_time_s), lambda progress: None)


def test_the_cap_counts_while_seams_close() -> None:
    outcome = stopped_at(0.2, grid_mm=30.0)
    assert outcome.status == "max_time"
    assert 0.2 <= outcome.state.time_s < 0.3  # looked at every 192 steps
    assert outcome.cloth.particle_count == outcome.flat.particle_count, "nothing is welded across an open seam"
    assert all("it stood" in warning for warning in outcome.warnings if "did not close" in warning)
    assert any("did not close" in warning for warning in outcome.warnings)


def of_true_cloth(outcome: Outcome) -> dict[str, float]:
    """Energies of the final state by the laws of the fabric and with weight, J."""
    cloth, folds = outcome.cloth, outcome.state.fold_angles
    forces = ForceAssembly(internal_forces(cloth, outcome.materials, fold_angles=folds), cloth.particle_count, [ForceGravity(cloth.masses)])
    return forces.energy(outcome.state.positions, outcome.state.friction)


def refuse_other_energies(outcome: Outcome) -> None:
    true, (made, _) = of_true_cloth(outcome), record(outcome)
    assert made.energy_j["gravity"] == pytest.approx(true["gravity"])
    assert made.energy_j["stretch"] == pytest.approx(true["stretch"] + true.get("border", 0.0))
    assert made.energy_j["bend"] == pytest.approx(sum(true.get(name, 0.0) for name in ("bend", "twist", "hinge", "span")))


def test_what_is_stopped_while_seams_close_is_judged_as_the_cloth_that_it_is() -> None:
    """And not as card without weight, as which it is sewn."""
    outcome = stopped_at(0.2)
    assert outcome.state.phase == "close"
    refuse_other_energies(outcome)


def test_what_sticks_under_the_iron_too(monkeypatch: pytest.MonkeyPatch) -> None:
    def stuck(dynamics: Dynamics, state: State, *given: object) -> None:
        raise IntersectingError(dynamics.cloth, np.array([0]), state)

    monkeypatch.setattr("garmentcad.simulation.run.press", stuck)
    outcome = run(make_job("pleated-skirt", grid_mm=50.0), lambda progress: None)
    assert (outcome.status, outcome.state.phase) == ("intersecting", "press")
    refuse_other_energies(outcome)


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


def test_what_was_torn_at_has_a_record() -> None:
    """A step from such a state runs away; shorts whose crotch seam tore at them left no report."""
    outcome = stopped_at(0.2)
    assert record(outcome)[0].rest["residual_g_rms"] is not None
    outcome.state.positions[0, 2] += 2.0
    outcome.state.contact = {}
    outcome.dynamics.start(outcome.state)
    made, _ = record(outcome)
    assert made.rest["residual_g_rms"] is None


def test_what_crosses_the_body_says_where() -> None:
    outcome = stopped_at(0.2)
    assert not any("the body" in warning for warning in record(outcome)[0].warnings)
    outcome.state.positions[:, 2] += 0.1
    made, _ = record(outcome)
    assert made.status == "intersecting"
    (said,) = (warning for warning in made.warnings if warning.startswith("the cloth crosses the body ("))
    assert "(torso" in said
    assert "of 'back_left' at (" in said
    assert "of 'back_right' at (" in said


def test_a_report_has_the_lattice_on_which_a_run_ended() -> None:
    """Particles and grid belong to each other: an error bar goes by both."""
    made, _ = record(stopped_at(0.02, grid_mm=20.0))
    assert (made.grid_mm, [text for text in made.warnings if "lattice" in text]) == (20.0, [])
    outcome = stopped_at(0.02, grid_mm=12.0)
    made, _ = record(outcome)
    assert made.grid_mm == pytest.approx(1000.0 * outcome.cloth.spacing) == 24.0
    assert "it ended on the lattice of 24 mm, before the one of 12 mm that was asked for" in made.warnings

"""True motion without a whole drape: a garment that follows a movement, what the loop does when motion runs away, and the steps of dynamics."""

from __future__ import annotations

import numpy as np
import pytest

from garmentcad.cloth.state import State
from garmentcad.forces.band import ForceBand
from garmentcad.forces.time_step import largest_stable_time_step
from garmentcad.geometry.intersection import crossing_triangle_pairs
from garmentcad.mannequin.motion import KeyFrame, Pose
from garmentcad.simulation import movement
from garmentcad.simulation.job import make_job
from garmentcad.simulation.run import run
from garmentcad.solve.dynamics import DivergedError, Dynamics


def test_a_movement_that_runs_away_goes_on_with_shorter_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    outcome = run(make_job("straight-skirt", grid_mm=50.0, max_time_s=0.9), lambda progress: None)
    outcome.state.run["step_factor"] = 0.5  # what the drape took
    factors: list[float] = []
    longer: list[float] = []
    advance = Dynamics.advance

    def run_away_once(self: Dynamics, state: State, steps: int) -> None:
        factors.append(self.step_factor)
        row_sums = np.zeros(self.cloth.particle_count)
        self.forces.stiffness(state.positions, row_sums)
        longer.append(state.time_step_s / self.step_factor / largest_stable_time_step(row_sums, self.cloth.masses))
        advance(self, state, steps)
        if len(factors) == 2:
            raise DivergedError(self.cloth, self.cloth.stitches[:0], "ran", state)

    monkeypatch.setattr(movement, "HOLD_S", 0.01)
    monkeypatch.setattr(Dynamics, "advance", run_away_once)
    moved = movement.move(outcome, [KeyFrame(0.1, Pose(turn=2.0))], lambda progress: None)
    assert (moved.status, moved.warning) == ("moved", None)
    assert (factors[:2], set(factors[2:])) == ([0.5, 0.5], {0.25})
    assert min(longer[1:-1]) > 1.1, "steps are those of the highest frequency, not of its bound"
    assert (moved.times_s[1:] > moved.times_s[:-1]).all()
    assert outcome.state.run["step_factor"] == 0.5, "the outcome stays as it is"
    monkeypatch.undo()
    outcome.state.positions[:, 1] -= outcome.state.positions[:, 1].max() + 0.05
    lost = movement.move(outcome, [KeyFrame(0.5, Pose())], lambda progress: None)
    assert (lost.status, lost.warning) == ("fell", "after 0.00 s of the movement the garment fell off: all of it is below the body")


def test_in_dynamics_a_garment_falls_in_steps_of_its_highest_frequency(monkeypatch: pytest.MonkeyPatch) -> None:
    longer: list[float] = []
    choose = Dynamics._choose_step

    def chosen(self: Dynamics, state: State, equalise: bool, measured: bool) -> None:
        choose(self, state, equalise, measured)
        if state.phase == "fall":
            assert not equalise
            longer.append(state.time_step_s / largest_stable_time_step(self._stiffness, self.cloth.masses))

    monkeypatch.setattr(Dynamics, "_choose_step", chosen)
    outcome = run(make_job("straight-skirt", grid_mm=30.0, max_time_s=1.0, mode="dynamics"), lambda progress: None)
    assert (outcome.status, outcome.state.phase, outcome.warnings) == ("max_time", "fall", [])
    assert min(longer[1:]) > 1.1, "after the first look, which comes before the course has set its phase"
    assert outcome.dynamics.measures(outcome.state)[1] < 1.5, "nothing is thrown"
    assert crossing_triangle_pairs(outcome.state.positions, outcome.cloth.particle_triangles).size == 0


def test_in_dynamics_a_belt_draws_its_garment_together_and_does_not_throw_it() -> None:
    """It ended as `diverged` 0.5 s after the beginning."""
    outcome = run(make_job("wrap-skirt", grid_mm=40.0, max_time_s=0.9, mode="dynamics"), lambda progress: None)
    assert (outcome.status, outcome.state.phase, outcome.warnings) == ("max_time", "fall", [])
    (belt,) = (force for force in outcome.dynamics.forces.forces if isinstance(force, ForceBand))
    assert belt.lengths(outcome.state.positions)[0] < 1.1 * belt.segments.rest[0]
    assert outcome.dynamics.measures(outcome.state)[1] < 5.0
    assert crossing_triangle_pairs(outcome.state.positions, outcome.cloth.particle_triangles).size == 0

"""What does not close is placed and sewn once more, from a start that differs by a hundredth of a millimetre."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from garmentcad.cloth.state import State
from garmentcad.simulation import run
from garmentcad.simulation.course import Progress
from garmentcad.simulation.job import Job, make_job
from garmentcad.simulation.run import JITTER_M, SEWINGS
from garmentcad.simulation.sewing import Welding, close_seams
from garmentcad.solve.dynamics import IntersectingError

OPEN = Welding({"side_left": 3.9})
ANEW = "placed once more"


class Sewing:
    """`close_seams` that fails `failures` times. starts: where cloth began (P,3) m; all_or_none: as it was
    called; ends: states after a sewing that was real."""

    def __init__(self, failures: int, stuck: bool = False) -> None:
        self.failures, self.stuck = failures, stuck
        self.starts: list[np.ndarray] = []
        self.all_or_none: list[bool] = []
        self.ends: list[str] = []

    def __call__(self, dynamics: Any, state: State, *given: Any) -> Welding:
        self.starts.append(state.positions.copy())
        self.all_or_none.append(given[-1])
        if len(self.starts) > self.failures:
            welding = close_seams(dynamics, state, *given)
            self.ends.append(state.sha256())
            return welding
        state.velocities[:] = np.inf  # whatever it leaves is of no use
        if self.stuck:
            raise IntersectingError(dynamics.cloth, np.array([0]), state)
        return OPEN


def skirt(max_time_s: float = 2.2) -> Job:
    return make_job("straight-skirt", grid_mm=50.0, max_time_s=max_time_s)


@pytest.mark.parametrize("stuck", [False, True])
def test_one_that_fails_is_placed_anew(monkeypatch: pytest.MonkeyPatch, stuck: bool) -> None:
    sewing = Sewing(1, stuck)
    monkeypatch.setattr(run, "close_seams", sewing)
    outcome = run.run(skirt(), lambda progress: None)
    first, second = sewing.starts
    assert 0.1 * JITTER_M < np.abs(second - first).max() < 20.0 * JITTER_M
    assert sewing.all_or_none == [True, False], "the last one sews what it can"
    assert outcome.welding.open_seams == []
    assert outcome.state.phase == "fall"
    assert [warning for warning in outcome.warnings if "clos" in warning or "stuck" in warning] == [w for w in outcome.warnings if ANEW in w]
    assert sum(ANEW in warning for warning in outcome.warnings) == 1


def test_one_that_closes_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    sewing = Sewing(0)
    monkeypatch.setattr(run, "close_seams", sewing)
    outcome = run.run(skirt(), lambda progress: None)
    assert len(sewing.starts) == 1
    assert not any(ANEW in warning for warning in outcome.warnings)


def test_nor_one_that_its_cap_on_time_stops(monkeypatch: pytest.MonkeyPatch) -> None:
    sewing = Sewing(0)
    monkeypatch.setattr(run, "close_seams", sewing)
    outcome = run.run(skirt(0.1), lambda progress: None)
    assert len(sewing.starts) == 1
    assert outcome.welding.open_seams


def test_what_fails_again_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    sewing = Sewing(SEWINGS, stuck=True)
    monkeypatch.setattr(run, "close_seams", sewing)
    outcome = run.run(skirt(), lambda progress: None)
    assert len(sewing.starts) == SEWINGS
    assert outcome.status == "intersecting"
    assert sum("contact is stuck" in warning for warning in outcome.warnings) == 1


def test_the_second_one_is_resumed_as_the_second(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    whole = Sewing(1)
    monkeypatch.setattr(run, "close_seams", whole)
    run.run(skirt(), lambda progress: None)

    def stop(progress: Progress) -> None:
        if progress.time_s > 0.3:
            raise KeyboardInterrupt

    job, path = skirt(), tmp_path / "state.npz"
    monkeypatch.setattr(run, "close_seams", Sewing(1))
    monkeypatch.setattr(run, "CHECKPOINT_EVERY_S", 0.0)
    with pytest.raises(KeyboardInterrupt):
        run.run(job, stop, path)
    resumed = Sewing(0)
    monkeypatch.setattr(run, "close_seams", resumed)
    outcome = run.run(job, lambda progress: None, path, resume=True)
    assert resumed.all_or_none == [False]
    assert resumed.ends == whole.ends
    assert any(ANEW in warning for warning in outcome.warnings)

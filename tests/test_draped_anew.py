"""What a finer lattice cannot take over from a coarse one is draped anew on the finer one alone, and the report tells."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from garmentcad.cloth.state import State
from garmentcad.simulation import run
from garmentcad.simulation.job import Job, make_job
from garmentcad.solve.dynamics import Dynamics, IntersectingError

SQUARE = """
schema: 1
units: mm
name: square
fabric: cotton-shirting
mannequin: woman-88
panels:
  sheet:
    points: {a: [0, 0], b: [600, 0], c: [600, 600], d: [0, 600]}
    edges: [{name: low, from: a, to: b}, {name: right, from: b, to: c}, {name: top, from: c, to: d}, {name: left, from: d, to: a}]
    placement: {transform: {translation: [0, 1900, 0], rotation: [90, 0, 0]}}
"""


@pytest.fixture
def job(tmp_path: Path) -> Job:
    path = tmp_path / "square.yaml"
    path.write_text(SQUARE)
    return make_job(path, grid_mm=12.5)


def stuck_from(monkeypatch: pytest.MonkeyPatch, stuck: list[bool]) -> list[float]:
    """Let the courses of a run end at once, in turn: stuck or at rest. Returns the spacings, mm, of their lattices, which fill up."""
    spacings: list[float] = []

    class Course:
        def __init__(self, dynamics: Dynamics, *given: Any) -> None:
            self.dynamics = dynamics

        def run(self, state: State, look: Any) -> str:
            spacings.append(1e3 * self.dynamics.cloth.spacing)
            if stuck[len(spacings) - 1]:
                state.positions[:] = np.nan  # whatever it leaves is of no use
                raise IntersectingError(self.dynamics.cloth, np.array([0]), state)
            return "converged"

    monkeypatch.setattr(run, "Course", Course)
    return spacings


def test_what_sticks_on_the_finer_lattice_begins_there_anew(job: Job, monkeypatch: pytest.MonkeyPatch) -> None:
    spacings = stuck_from(monkeypatch, [False, True, False])
    outcome = run.run(job, lambda progress: None)
    assert spacings == [25.0, 12.5, 12.5]
    assert outcome.status == "converged"
    assert np.isfinite(outcome.state.positions).all()
    told = [warning for warning in outcome.warnings if "draped anew there" in warning]
    assert len(told) == 1
    assert told[0].startswith("on the lattice of 12.5 mm: contact is stuck at panel 'sheet'")


@pytest.mark.parametrize("stuck", [[True], [False, True, True]])
def test_what_sticks_on_its_first_lattice_ends(job: Job, monkeypatch: pytest.MonkeyPatch, stuck: list[bool]) -> None:
    spacings = stuck_from(monkeypatch, stuck)
    assert run.run(job, lambda progress: None).status == "intersecting"
    assert len(spacings) == len(stuck)

"""What does not close is placed and sewn once more, from a start that differs by a hundredth of a millimetre."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import ipctk
import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.state import State
from garmentcad.simulation import keeper, run
from garmentcad.simulation.course import Progress
from garmentcad.simulation.job import Job, make_job
from garmentcad.simulation.run import JITTER_M, SEWINGS
from garmentcad.simulation.sewing import Welding, close_seams, weld_state
from garmentcad.solve.dynamics import IntersectingError

ANEW = "placed once more"


class Sewing:
    """`close_seams` that fails `failures` times, with a seam `open_mm`. starts: where cloth began (P,3) m; give_up_mm: as it was called; ends: states after a
    sewing that was real."""

    def __init__(self, failures: int, stuck: bool = False, open_mm: float = 3.9) -> None:
        self.failures, self.stuck, self.open = failures, stuck, Welding({"side_left": open_mm})
        self.starts: list[np.ndarray] = []
        self.give_up_mm: list[float] = []
        self.ends: list[str] = []

    def __call__(self, dynamics: Any, state: State, *given: Any) -> Welding:
        self.starts.append(state.positions.copy())
        self.give_up_mm.append(given[-1])
        if len(self.starts) > self.failures:
            welding = close_seams(dynamics, state, *given)
            self.ends.append(state.sha256())
            return welding
        state.velocities[:] = np.inf if len(self.starts) < SEWINGS or self.stuck else 0.0  # whatever it leaves is of no use but the last
        if self.stuck:
            raise IntersectingError(dynamics.cloth, np.array([0]), state)
        return self.open


def skirt(max_time_s: float = 2.2) -> Job:
    return make_job("straight-skirt", grid_mm=50.0, max_time_s=max_time_s)


@pytest.mark.parametrize("stuck", [False, True])
def test_one_that_fails_is_placed_anew(monkeypatch: pytest.MonkeyPatch, stuck: bool) -> None:
    sewing = Sewing(1, stuck)
    monkeypatch.setattr(run, "close_seams", sewing)
    phases: list[str] = []
    outcome = run.run(skirt(), lambda progress: phases.append(progress.phase))
    first, second = sewing.starts
    assert list(dict.fromkeys(phases)) == ["close anew", "fall"]
    assert 0.1 * JITTER_M < np.abs(second - first).max() < 20.0 * JITTER_M
    assert sewing.give_up_mm == [1.0, 100.0], "the last one sews what it can"
    assert outcome.welding.open_seams == []
    assert outcome.state.phase == "fall"
    assert [warning for warning in outcome.warnings if "clos" in warning or "stuck" in warning] == [w for w in outcome.warnings if ANEW in w]
    assert sum(ANEW in warning for warning in outcome.warnings) == 1


def test_one_that_closes_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    sewing = Sewing(0)
    monkeypatch.setattr(run, "close_seams", sewing)
    phases: list[str] = []
    outcome = run.run(skirt(), lambda progress: phases.append(progress.phase))
    assert phases[0] == "close"
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


@pytest.mark.parametrize(("open_mm", "welded"), [(99.0, True), (101.0, False)])
def test_what_stands_open_by_more_than_two_cells_is_not_welded(monkeypatch: pytest.MonkeyPatch, open_mm: float, welded: bool) -> None:
    sewing = Sewing(SEWINGS, open_mm=open_mm)
    monkeypatch.setattr(run, "close_seams", sewing)
    outcome = run.run(skirt(0.5), lambda progress: None)
    assert len(sewing.starts) == SEWINGS
    assert (len(outcome.cloth.stitches) == 0) == welded
    assert outcome.status == "max_time"
    assert outcome.state.phase == ("fall" if welded else "close")
    assert any("did not close: it stood" in warning for warning in outcome.warnings)
    assert any("open by more than 100 mm are not welded" in warning for warning in outcome.warnings) != welded


def test_what_is_stuck_tells_its_open_seams(monkeypatch: pytest.MonkeyPatch) -> None:
    """The widest stitch of each seam, as it stands where the run ended."""
    monkeypatch.setattr(run, "close_seams", Sewing(SEWINGS, stuck=True))
    outcome = run.run(skirt(), lambda progress: None)
    a, b = (outcome.state.positions[outcome.cloth.stitches[:, side]] for side in (0, 1))
    gaps = 1e3 * np.linalg.norm(a - b, axis=1)
    assert outcome.status == "intersecting"
    assert gaps.max() > 1.0
    assert outcome.welding.gap_mm == {name: pytest.approx(gaps[outcome.cloth.stitch_seam == seam].max()) for seam, name in enumerate(outcome.cloth.seam_names)}
    assert sum("mm open" in warning for warning in outcome.warnings) == sum(gap > 1.0 for gap in outcome.welding.gap_mm.values())


def test_the_second_one_is_resumed_as_the_second(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    whole = Sewing(1)
    monkeypatch.setattr(run, "close_seams", whole)
    run.run(skirt(), lambda progress: None)

    def stop(progress: Progress) -> None:
        if progress.time_s > 0.3:
            raise KeyboardInterrupt

    job, path = skirt(), tmp_path / "state.npz"
    monkeypatch.setattr(run, "close_seams", Sewing(1))
    monkeypatch.setattr(keeper, "CHECKPOINT_EVERY_S", 0.0)
    with pytest.raises(KeyboardInterrupt):
        run.run(job, stop, path)
    resumed = Sewing(0)
    monkeypatch.setattr(run, "close_seams", resumed)
    outcome = run.run(job, lambda progress: None, path, resume=True)
    assert resumed.give_up_mm == [100.0]
    assert resumed.ends == whole.ends
    assert any(ANEW in warning for warning in outcome.warnings)


def test_what_a_weld_pricks_on_the_body_is_taken_off_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Welding moves both sides of a gap of up to a millimetre at once. A knit top hung on two vertices of the body under its arm and never came to rest."""
    job = skirt(0.9)
    body, crossings = job.mannequin, []

    def crossing(cloth: Cloth, state: State) -> bool:
        positions = np.vstack([state.positions, body.vertices])
        faces = np.vstack([cloth.particle_triangles, body.faces + len(state.positions)]).astype(np.int32)
        return bool(ipctk.has_intersections(ipctk.CollisionMesh(positions, ipctk.edges(faces), faces), positions))

    def pricked(start: Cloth, welded: Cloth, particle_map: np.ndarray, state: State) -> State:
        made = weld_state(start, welded, particle_map, state)
        crossings.append(crossing(welded, made))
        distance, vertex = cKDTree(body.vertices).query(made.positions)
        nearest = int(np.argmin(distance))
        normal = trimesh.Trimesh(body.vertices, body.faces, process=False).vertex_normals[vertex[nearest]]
        made.positions[nearest] = body.vertices[vertex[nearest]] - 1e-3 * normal
        crossings.append(crossing(welded, made))
        return made

    monkeypatch.setattr(run, "weld_state", pricked)
    monkeypatch.setattr(run.Course, "run", lambda course, state, look: crossings.append(crossing(course.dynamics.cloth, state)) or "max_time")
    run.run(job, lambda progress: None)
    assert crossings == [False, True, False]

"""What the progress line says about the time that is left."""

from __future__ import annotations

import re

import numpy as np
import pytest
from test_course import CLOTH, course

import garmentcad.simulation.course as course_module
from garmentcad.cli.drape import ProgressLine
from garmentcad.simulation.course import READY, WATCH_S, Progress
from garmentcad.solve.rest import PATCH_RESIDUAL_G, RESIDUAL_G, Residual, patches


def test_seconds_left_follow_the_residual(monkeypatch: pytest.MonkeyPatch) -> None:
    """A residual that falls tenfold in 0.1 s, from a thousand times what lets the watch begin."""
    made, state = course(1.0, 9.0, "drape")
    began = state.time_s

    def residual(*_: object) -> Residual:
        share = 1e3 * 10.0 ** (-10.0 * (state.time_s - began)) * READY
        return Residual(share * RESIDUAL_G, 0.5 * share * PATCH_RESIDUAL_G, np.ones(patches(CLOTH).max() + 1))

    monkeypatch.setattr(course_module, "residual", residual)
    state.phase, state.run = "settle", {"phase_from_s": began}
    seen: list[tuple[str, float, float | None]] = []
    made.run(state, lambda progress: seen.append((progress.phase, progress.time_s, progress.eta_s)))
    settling, watching = ([look for look in seen if look[0] == phase] for phase in ("settle", "watch"))
    assert settling[0][2] is None
    assert len(settling) > 3
    for _, time_s, eta_s in settling[1:]:
        assert eta_s == pytest.approx(began + 0.3 - time_s + WATCH_S)
    for _, time_s, eta_s in watching:
        assert eta_s == pytest.approx(watching[0][1] + WATCH_S - time_s, abs=1e-12)
    assert seen[-1][0] == "rest"
    assert seen[-1][2] is None


def test_the_end_of_a_coarser_lattice_is_not_called_rest() -> None:
    made, state = course(1.0, 9.0, "drape")
    made.is_last = False
    seen: list[str] = []
    assert made.run(state, lambda progress: seen.append(progress.phase)) == "converged"
    assert set(seen[:-1]) == {"fall"}
    assert seen[-1] == "refine"


def test_no_more_is_left_than_the_cap(monkeypatch: pytest.MonkeyPatch) -> None:
    """A residual that hardly falls."""
    made, state = course(1.0, 0.2, "drape")
    began = state.time_s

    def residual(*_: object) -> Residual:
        share = 1e3 - 10.0 * (state.time_s - began)
        return Residual(share * RESIDUAL_G, share * PATCH_RESIDUAL_G, np.ones(patches(CLOTH).max() + 1))

    monkeypatch.setattr(course_module, "residual", residual)
    state.phase, state.run = "settle", {"phase_from_s": began}
    seen: list[tuple[float, float | None]] = []
    assert made.run(state, lambda progress: seen.append((progress.time_s, progress.eta_s))) == "max_time"
    assert len(seen) > 3
    for time_s, eta_s in seen[1:]:
        assert eta_s == pytest.approx(max(0.0, 0.2 - time_s))


def test_wall_seconds_left_follow_the_last_looks(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The first look took 100 s, for kernels that were compiled; from then on a simulated second takes 20, and at the end 40."""
    clock = [0.0]
    monkeypatch.setattr("time.perf_counter", lambda: clock[0])
    line = ProgressLine(silent=False)
    for wall_s, time_s in ((100.0, 0.1), *((100.0 + 2.0 * k, 0.1 + 0.1 * k) for k in range(1, 8)), *((114.0 + 4.0 * k, 0.8 + 0.1 * k) for k in range(1, 8))):
        clock[0] = wall_s
        line.show(Progress("settle", 0, time_s, None, 1e-2, 0.0, 0.5))
    said = [int(found.group(1)) for found in re.finditer(r"about (\d+) s to go", capsys.readouterr().err)]
    assert said[0] == 10
    assert said[-1] == 20


def test_a_drape_that_begins_anew_says_nothing_of_the_time_before(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    clock = [0.0]
    monkeypatch.setattr("time.perf_counter", lambda: clock[0])
    line = ProgressLine(silent=False)
    for wall_s, time_s in ((5.0, 1.0), (10.0, 0.0), (15.0, 0.5)):
        clock[0] = wall_s
        line.show(Progress("settle", 0, time_s, None, 1e-2, 0.0, 2.0))
    assert re.findall(r"about (\d+) s to go", capsys.readouterr().err) == ["20"]

"""What other programs are given is our workload W1, and what they leave is judged rightly."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from bench import compare
from bench.peers import workload
from bench.peers.environment import PeerError, ask
from garmentcad.bench import cloth_on_ball


def test_numbers_are_those_of_our_workload() -> None:
    shared = {name for name in dir(workload) if name.isupper()} & {name for name in dir(cloth_on_ball) if name.isupper()}
    assert {"SIDE_M", "RADIUS_M", "START_M", "GAP_M", "AREAL_MASS_KG_M2", "TENSION_N_M", "SHEAR_N_M_RAD", "BENDING_N_M", "FRICTION"} <= shared
    for name in shared:
        assert getattr(workload, name) == getattr(cloth_on_ball, name), name


def test_meshes_are_oriented_and_closed() -> None:
    vertices, faces = workload.ball(16, 8)
    assert np.linalg.norm(vertices, axis=1) == pytest.approx(np.full(len(vertices), 0.25))
    half = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    assert len(np.unique(half, axis=0)) == len(half) == 2 * len(np.unique(np.sort(half, axis=1), axis=0))
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    assert (np.einsum("fk,fk->f", np.cross(b - a, c - a), a + b + c) > 0.0).all()
    points, quads = workload.square(100.0)
    assert (len(points), len(quads)) == (121, 100)
    a, b, c = (points[workload.triangles_of(quads)[:, k]] for k in range(3))
    assert np.cross(b - a, c - a)[:, 2] == pytest.approx(np.full(200, 0.01), rel=1e-2)


def test_judge_sees_strain_depth_and_crossings() -> None:
    flat, _ = workload.square(50.0)
    clean = compare.judged(flat, 50.0)
    assert (clean["penetration_mm"], clean["crossings"]) == (0.0, 0)
    assert clean["strain_p99_percent"] == pytest.approx(0.0, abs=0.01)
    assert clean["mean_height_mm"] == pytest.approx(255.0, abs=0.01)
    worse = flat * [1.02, 1.02, 1.0] - [0.0, 0.0, 0.008]
    worse[0] = worse[2 * 21 + 2] + [0.01, 0.01, 0.02]  # a corner that is folded over and through the cloth
    worse[1], worse[21] = worse[2 * 21 + 3] - [0.0, 0.0, 0.02], worse[3 * 21 + 2] - [0.0, 0.0, 0.02]
    bad = compare.judged(worse, 50.0)
    assert bad["strain_p99_percent"] == pytest.approx(2.0, abs=0.1)
    assert bad["penetration_mm"] == pytest.approx(3.0, abs=0.2)
    assert bad["crossings"] > 0


def test_recorder_writes_the_last_speed(tmp_path: Path) -> None:
    recorder = workload.Recorder()
    recorder.start()
    recorder.frame(0.1, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    recorder.frame(0.2, [[0.0, 0.0, 0.03], [1.0, 0.04, 0.0]])
    recorder.write(tmp_path / "run.json", "program", "1", 1, {})
    run = json.loads((tmp_path / "run.json").read_text())
    assert run["largest_speed_m_s"] == pytest.approx(0.4)
    assert run["simulated_s"] == 0.2
    assert np.load(tmp_path / "run.npz")["positions"].shape == (2, 3)


def test_medians_count_and_the_worst_of_what_must_be_zero() -> None:
    runs = [{"program": "p", "wall_s": wall, "crossings": crossings, "penetration_mm": 0.0} for wall, crossings in ((9.0, 0), (1.0, 2), (3.0, 0))]
    assert compare.summary(runs) == {"program": "p", "wall_s": 3.0, "crossings": 2, "penetration_mm": 0.0, "runs": 3}


def test_a_peer_that_cannot_run_says_why() -> None:
    with pytest.raises(PeerError, match="no-such-program"):
        ask(["no-such-program"])
    with pytest.raises(PeerError, match="no wheel"):
        ask(["python3", "-c", "import sys; sys.exit('no wheel')"])

"""A whole drape, coarse: it comes to rest clean; same bits for 1 and 2 threads; a run that is stopped and resumed ends in the same bits."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import igl
import ipctk
import numpy as np
import pytest
import trimesh

from garmentcad.simulation.keeper import stop_signal

GRID = "20"


def command(folder: Path, *more: str) -> list[str]:
    """On one thread: other tests run beside, and the bits are those of two."""
    words = ["drape", "t-shirt", "--fabric", "wool-suiting", "--grid", GRID, "--threads", "1", "-o", str(folder), "--json", "--quiet"]
    return [sys.executable, "-m", "garmentcad", *words, *more]


def report_of(folder: Path, *more: str) -> dict:  # type: ignore[type-arg]
    run = subprocess.run(command(folder, *more), capture_output=True, text=True, timeout=500, check=False)
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout)


@pytest.fixture(scope="module")
def draped(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict]:  # type: ignore[type-arg]
    folder = tmp_path_factory.mktemp("draped")
    return folder, report_of(folder, "--threads", "2")  # the last word counts


def test_comes_to_rest_clean(draped: tuple[Path, dict]) -> None:  # type: ignore[type-arg]
    _, report = draped
    assert report["status"] == "converged"
    assert report["rest"]["residual_g_rms"] < 1e-3
    assert report["seam_gap_mm"]["max"] <= 1.0
    assert report["self_intersections"] == report["mannequin_intersections"] == 0
    assert report["mannequin_penetration_mm"]["max"] == 0.0
    # the hem is drafted 10 mm below the hip line, which is 834 mm above the floor; the armholes lie at the shoulders
    assert 824.0 - 15.0 < report["hem_height_mm"] < 824.0 + 15.0
    assert all(distance < 15.0 for distance in report["armhole_to_shoulder_mm"].values())


def test_the_body_carries_the_garment(draped: tuple[Path, dict]) -> None:  # type: ignore[type-arg]
    """Pressure and friction on the body sum to the weight; `garmentcad fit` prints the same figures and lines besides."""
    folder, report = draped
    support = report["support_n"]
    assert support["weight"] == pytest.approx(9.81 * report["mass_kg"])
    assert support["normal"] + support["friction"] == pytest.approx(support["weight"], rel=0.01)
    run = subprocess.run(
        [sys.executable, "-m", "garmentcad", "fit", str(folder), "--line", "chest=1204", "--json"], capture_output=True, text=True, timeout=100, check=True
    )
    fit = json.loads(run.stdout)
    assert fit["support_n"] == support
    # the bust line once more, by the way that any plane is measured
    assert fit["lines"]["chest"]["torso"]["ease_mm"] == pytest.approx(report["ease_mm"]["bust"], abs=0.5)


def test_judges_that_are_not_ours_agree(draped: tuple[Path, dict]) -> None:  # type: ignore[type-arg]
    folder, _ = draped
    garment = trimesh.load(folder / "garment.obj", process=False, maintain_order=True)
    body = trimesh.load(folder / "mannequin.obj", process=False, maintain_order=True)
    vertices = np.vstack([garment.vertices, body.vertices])
    faces = np.vstack([garment.faces, body.faces + len(garment.vertices)]).astype(np.int32)
    mesh = ipctk.CollisionMesh(vertices, ipctk.edges(faces), faces)
    assert not ipctk.has_intersections(mesh, vertices)
    samples = np.vstack([garment.vertices, garment.triangles_center])
    distance = igl.signed_distance(samples, np.asarray(body.vertices), np.asarray(body.faces))[0]
    assert distance.min() > 0.0


def test_same_bits_with_one_thread(draped: tuple[Path, dict], tmp_path: Path) -> None:  # type: ignore[type-arg]
    _, report = draped
    single = report_of(tmp_path)
    assert (single["threads"], report["threads"]) == (1, 2)
    assert single["state_sha256"] == report["state_sha256"]


def test_stopped_and_resumed_ends_in_the_same_bits(draped: tuple[Path, dict], tmp_path: Path) -> None:  # type: ignore[type-arg]
    _, report = draped
    loud = [word for word in command(tmp_path) if word not in ("--quiet", "--json")]
    process = subprocess.Popen(loud, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env={**os.environ, "PYTHONUNBUFFERED": "1"})
    assert process.stderr is not None
    for line in process.stderr:
        if line.startswith(("fall", "settle")):  # sewn and welded: the resumed run has to find its way back to the welded cloth
            break
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=120)
    assert process.returncode == 130, said
    assert (tmp_path / "checkpoint.npz").exists()
    assert not (tmp_path / "report.json").exists()
    resumed = report_of(tmp_path, "--resume")
    assert resumed["state_sha256"] == report["state_sha256"]
    assert not (tmp_path / "checkpoint.npz").exists()


def test_ctrl_c_stays_with_a_program_that_handles_it_without_python(monkeypatch: pytest.MonkeyPatch) -> None:
    before = signal.getsignal(signal.SIGINT)
    monkeypatch.setattr(signal, "getsignal", lambda number: None)
    with stop_signal() as stopped:
        assert signal.signal(signal.SIGINT, before) is before
    assert not stopped


def test_a_checkpoint_of_another_run_is_refused(draped: tuple[Path, dict], tmp_path: Path) -> None:  # type: ignore[type-arg]
    folder, _ = draped
    (tmp_path / "checkpoint.npz").write_bytes((folder / "state.npz").read_bytes())
    run = subprocess.run(command(tmp_path, "--resume", "--seed", "5"), capture_output=True, text=True, timeout=120, check=False)
    assert run.returncode == 2
    assert "seed: 0 there, 5 here" in run.stderr


def test_the_garment_follows_a_movement(draped: tuple[Path, dict], tmp_path: Path) -> None:  # type: ignore[type-arg]
    """Arms go down by nine degrees: sleeves go along, and no frame has an intersection or a penetration, says who is not the solver."""
    folder, report = draped
    pose = tmp_path / "down.yaml"
    pose.write_text("schema: 1\nframes:\n  - {time: 0.3, arms: 36}\n", encoding="utf-8")
    # A checkpoint of a garment at rest: the drape is over, the movement begins.
    (tmp_path / "checkpoint.npz").write_bytes((folder / "state.npz").read_bytes())
    moved = report_of(tmp_path, "--resume", "--pose", str(pose))
    assert moved["state_sha256"] == report["state_sha256"]
    assert (moved["movement"]["status"], moved["movement"]["self_intersections"], moved["movement"]["mannequin_penetration_mm"]) == ("moved", 0, 0.0)
    with np.load(tmp_path / "movement" / "frames.npz") as file:
        times, frames, bodies = file["times_s"], file["positions"].astype(float), file["body"].astype(float)
    assert len(times) == len(moved["movement"]["frames"]) == 17  # each 50 ms for 0.3 s and 0.5 s more
    with np.load(folder / "cloth.npz") as file:
        triangles = file["vertex_particle"][file["triangles"]]
        sleeve = np.unique(file["vertex_particle"][file["vertex_panel"] == list(file["panel_names"]).index("sleeve_left")])
    faces = trimesh.load(folder / "mannequin.obj", process=False, maintain_order=True).faces
    for positions, body in zip(frames, bodies):
        both = np.vstack([positions, body])
        all_faces = np.vstack([triangles, faces + len(positions)]).astype(np.int32)
        assert not ipctk.has_intersections(ipctk.CollisionMesh(both, ipctk.edges(all_faces), all_faces), both)
        assert igl.signed_distance(np.vstack([positions, positions[triangles].mean(axis=1)]), body, np.asarray(faces))[0].min() > 0.0
    hand = np.argmax(bodies[0][:, 0])
    assert bodies[0][hand, 1] - bodies[-1][hand, 1] > 0.04  # by sin 45 - sin 36 degrees of an arm
    # The sleeve goes inward with the arm, and the rest of the shirt stays.
    inward = frames[0][:, 0] - frames[-1][:, 0]
    assert inward[sleeve].mean() > 0.003
    assert abs(inward[np.setdiff1d(np.arange(len(inward)), sleeve)].mean()) < 0.002


def test_a_pose_that_is_no_pose_is_refused_at_once(tmp_path: Path) -> None:
    run = subprocess.run(command(tmp_path, "--pose", "sqat"), capture_output=True, text=True, timeout=120, check=False)
    assert run.returncode == 2
    assert "sqat" in run.stderr
    assert "squat" in run.stderr

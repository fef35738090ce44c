"""Garments at rest on a body that then moves, at 10 mm: every saved frame judged by ipctk and libigl, and how far what sits at the waist comes down.

`python -m tools.movement_study [TEXT]` runs cases (with TEXT in their name) that have no row in docs/studies/movement.jsonl yet and writes movement.md.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from garmentcad import __version__
from garmentcad.export.movement import movement_report, write_movement
from garmentcad.simulation.job import make_job
from garmentcad.simulation.movement import move
from garmentcad.simulation.run import run
from garmentcad.simulation.study import StudyCase, run_study, write_study_table
from tools.judges import crosses, least_distance_mm

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "docs" / "studies"
GRID_MM = 10.0
CASES = (("t-shirt", "arms-down"), ("trousers", "step"), ("trousers", "squat"), ("flared-skirt", "turn"), ("flared-skirt", "squat"), ("sheath-dress", "step"))
COLUMNS = {
    "case": "case", "fabric": "fabric", "particles": "particles", "drape": "drape", "movement": "status", "s": "seconds:.2f", "frames": "frames",
    "frames that cross (ipctk)": "crossing_frames", "least distance to the body in a frame mm (libigl)": "least_distance_mm:.2f",
    "waist lower by at most, mm": "waist_slip_mm:.1f",
}  # fmt: skip


def cases() -> list[StudyCase]:
    found = []
    for garment, pose in CASES:
        job = make_job(garment, grid_mm=GRID_MM, pose=pose)
        parameters = {"garment": garment, "pose": pose, "grid_mm": GRID_MM}
        found.append(StudyCase(f"{garment} {pose}", job.spec_sha256, job.spec.fabric, job.mannequin.name, __version__, parameters))
    return found


def moved(case: StudyCase) -> Mapping[str, Any]:
    """Drape, move, judge."""
    job = make_job(case.parameters["garment"], grid_mm=GRID_MM, pose=case.parameters["pose"])
    outcome = run(job, lambda progress: None)
    movement = move(outcome, job.poses, lambda progress: None)
    report = movement_report(movement, outcome.cloth, job.mannequin, job.pattern)
    write_movement(ROOT / "out" / "movement" / case.name.replace(" ", "-"), movement, outcome.cloth, job.mannequin)
    triangles, faces = outcome.cloth.particle_triangles, job.mannequin.faces
    frames = [(positions, triangles, body, faces) for positions, body in zip(movement.positions, movement.body, strict=True)]
    return {
        "particles": outcome.cloth.particle_count,
        "drape": outcome.status,
        **{name: report[name] for name in ("status", "seconds", "waist_slip_mm", "warning")},
        "frames": len(frames),
        "crossing_frames": sum(crosses(*frame) for frame in frames),
        "least_distance_mm": min(least_distance_mm(*frame) for frame in frames),
    }


def main() -> None:
    rows = run_study("movement", cases(), moved, FOLDER, only=sys.argv[1] if len(sys.argv) > 1 else None, say=print).rows
    clean = sum(row["status"] == "moved" and not row["crossing_frames"] and row["least_distance_mm"] >= 0.0 for row in rows)
    title = f"Movement at {GRID_MM:g} mm: {clean} of {len(rows)} sequences without an intersection or a penetration in any frame"
    write_study_table(FOLDER / "movement.md", title, rows, COLUMNS, "python -m tools.movement_study")


if __name__ == "__main__":
    main()

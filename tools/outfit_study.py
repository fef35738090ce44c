"""Outfits from starts that differ: do they close, come to rest clean, and keep their order?

`python -m tools.outfit_study [TEXT]` runs cases (with TEXT in their name) that have no row in docs/studies/outfits.jsonl yet and writes outfits.md.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from garmentcad import __version__
from garmentcad.simulation.job import Job, make_job
from garmentcad.simulation.run import run
from garmentcad.simulation.study import StudyCase, run_study, write_study_table
from tools.judges import crosses, least_distance_mm, uncovered

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "studies"
OUTFITS = ("under-the-shirt", "tucked-in", "over-the-skirt")
SEEDS = {20.0: (0, 1, 2), 10.0: (0,)}  # of each grid in mm
COLUMNS = {
    "case": "case", "grid mm": "grid_mm:g", "mannequin": "mannequin", "particles": "particles", "status": "status",
    "widest seam when welded mm": "widest_gap_mm:.2f",
    "steps": "steps", "simulated s": "simulated_s:.2f", "crosses (ipctk)": "crosses", "least distance to the body mm (libigl)": "least_distance_mm:.2f",
    "particles of an inner garment outside an outer one": "out_of_order",
}  # fmt: skip


def job_of(outfit: str, grid_mm: float, seed: int) -> Job:
    return make_job(outfit, grid_mm=grid_mm, seed=seed)


def cases() -> list[StudyCase]:
    found = []
    for grid_mm, seeds in SEEDS.items():
        for outfit in OUTFITS:
            for seed in seeds:
                job = job_of(outfit, grid_mm, seed)
                parameters = {"outfit": outfit, "seed": seed, "grid_mm": grid_mm}
                found.append(StudyCase(f"{outfit} {seed}", job.spec_sha256, "", job.mannequin.name, __version__, parameters))
    return found


def dressed(case: StudyCase) -> Mapping[str, Any]:
    """Drape and judge."""
    job = job_of(case.parameters["outfit"], case.parameters["grid_mm"], case.parameters["seed"])
    outcome = run(job, lambda progress: None)
    cloth, positions = outcome.cloth, outcome.state.positions
    triangles, body = cloth.particle_triangles, (job.mannequin.vertices, job.mannequin.faces)
    layer = np.zeros(cloth.particle_count, dtype=np.int32)
    np.maximum.at(layer, triangles, cloth.triangle_layer[:, None])
    out_of_order = 0
    for inner in range(int(layer.max())):
        outer = triangles[(layer[triangles] > inner).all(axis=1)]
        out_of_order += int(uncovered(positions[layer == inner], positions, outer, *body).sum())
    return {
        "particles": cloth.particle_count,
        "status": outcome.status,
        "widest_gap_mm": max(outcome.welding.gap_mm.values()),
        "steps": outcome.state.step,
        "simulated_s": outcome.state.time_s,
        "crosses": crosses(positions, triangles, *body),
        "least_distance_mm": least_distance_mm(positions, triangles, *body),
        "out_of_order": out_of_order,
    }


def main() -> None:
    rows = run_study("outfits", cases(), dressed, FOLDER, only=sys.argv[1] if len(sys.argv) > 1 else None, say=print).rows
    clean = sum(row["status"] == "converged" and not row["crosses"] and row["least_distance_mm"] >= 0.0 and not row["out_of_order"] for row in rows)
    title = f"Outfits at {' and '.join(f'{grid_mm:g}' for grid_mm in SEEDS)} mm: {clean} of {len(rows)} starts end at rest, clean and in order"
    write_study_table(FOLDER / "outfits.md", title, rows, COLUMNS, "python -m tools.outfit_study")


if __name__ == "__main__":
    main()

"""Every shipped garment, in the fabric that it is drafted for, from starts that differ: each panel displaced by up to 5 mm and turned by up to 2 degrees.

`python -m tools.jitter_study` runs the starts that have no row in docs/studies/jitter.jsonl yet and writes jitter.md; with TEXT only those with TEXT
in their name.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from garmentcad import __version__
from garmentcad.errors import TangledError
from garmentcad.export.report import build_report
from garmentcad.io.atomic import write_atomic
from garmentcad.io.shipped import shipped_names
from garmentcad.simulation.job import make_job
from garmentcad.simulation.lay import DISPLACED_MM, TURNED_DEG, displaced
from garmentcad.simulation.record import record
from garmentcad.simulation.run import run
from garmentcad.simulation.study import StudyCase, run_study, study_table
from tools.judges import crosses, least_distance_mm

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "studies"
STARTS = 10
GRID_MM = 20.0
KEPT = ("status", "particles", "steps", "simulated_time_s", "wall_time_s", "rest", "seam_gap_mm", "mannequin_penetration_mm", "self_intersections",
        "mannequin_intersections", "ease_mm", "hem_height_mm", "waist_drop_mm", "armhole_to_shoulder_mm", "state_sha256")  # fmt: skip
COLUMNS = {
    "start": "case", "fabric": "fabric", "mannequin": "mannequin", "status": "status", "steps": "steps", "simulated s": "simulated_time_s:.2f",
    "residual g": "rest.residual_g_rms:.1e",
    "crosses (ipctk)": "crosses", "least distance to the body mm (libigl)": "least_distance_mm:.2f", "seam gap mm": "seam_gap_mm.max:.2f",
    "hem mm": "hem_height_mm:.1f",
}  # fmt: skip


def run_case(case: StudyCase) -> Mapping[str, Any]:
    """Figures of one start. A start that is refused as tangled is a row, too."""
    job = displaced(make_job(case.parameters["garment"], case.fabric, grid_mm=GRID_MM), case.parameters["start"])
    try:
        outcome = run(job, lambda progress: None)
    except TangledError as error:
        row: dict[str, Any] = {"status": "refused", "refusal": str(error)}
    else:
        report = build_report(*record(outcome))
        drape = (outcome.state.positions, outcome.cloth.particle_triangles, job.mannequin.vertices, job.mannequin.faces)
        row = {name: report[name] for name in KEPT} | {"crosses": crosses(*drape), "least_distance_mm": least_distance_mm(*drape)}
    print(*(f"{name} {row.get(name)}" for name in ("status", "refusal", "steps", "crosses", "least_distance_mm", "hem_height_mm") if name in row), flush=True)
    return row


def main(only: str | None) -> None:
    """Run the study and write its page."""
    cases = []
    for garment in shipped_names("patterns"):
        job = make_job(garment, grid_mm=GRID_MM)
        for start in range(STARTS):
            parameters = {"garment": garment, "grid_mm": GRID_MM, "start": start}
            cases.append(StudyCase(f"{garment} {start}", job.spec_sha256, job.spec.fabric, job.mannequin.name, __version__, parameters))
    study = run_study("jitter", cases, run_case, FOLDER, only=only, say=lambda message: print(message, flush=True))
    clean = [row for row in study.rows if row["status"] == "converged" and not row["crosses"] and row["least_distance_mm"] >= 0.0]
    said = f"{GRID_MM:g} mm; every panel displaced by up to {DISPLACED_MM:g} mm and turned by up to {TURNED_DEG:g} degrees; the number is the seed."
    line = f"{len(clean)} of {len(study.rows)} starts ({len(cases)} planned) end converged, without crossings (ipctk) and outside the body (libigl)."
    spread = ["| garment | starts | hem mm, lowest to highest |", "|---|---|---|"]
    for garment in shipped_names("patterns"):
        hems = [row["hem_height_mm"] for row in clean if row["garment"] == garment]
        spread += [f"| {garment} | {len(hems)} | {min(hems):.1f} to {max(hems):.1f} |"] if hems else []
    print(line)
    table = study_table(study.rows, COLUMNS, "python -m tools.jitter_study")
    write_atomic(FOLDER / "jitter.md", "\n".join(["# Starts that differ", "", said, "", line, "", *spread, "", table]))


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)

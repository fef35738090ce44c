"""make study: runs every case that has no committed row yet and writes the tables in docs/studies.

`python -m tools.study TEXT` runs only cases with TEXT in their name.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from garmentcad import __version__
from garmentcad.cloth.cloth import WARP
from garmentcad.export.drape import finish
from garmentcad.export.result_folder import Result
from garmentcad.fabric.law_tension import strain_at_force
from garmentcad.simulation.job import Job, make_job
from garmentcad.simulation.materials import lay_out
from garmentcad.simulation.study import StudyCase, run_study, write_study_table
from garmentcad.units import GRAVITY_M_S2, MM_TO_M

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "docs" / "studies"
GARMENTS = ("flared-skirt", "straight-skirt", "t-shirt")
GRIDS_MM = (20.0, 10.0)
FABRICS = ("cotton-shirting", "wool-suiting", "silk-habotai")
MANNEQUINS = {"flared-skirt": ("woman-88",), "straight-skirt": ("woman-88",), "t-shirt": ("woman-88", "man-100")}
KEPT = ("status", "particles", "steps", "simulated_time_s", "wall_time_s", "rest",
        "strain_percent", "seam_gap_mm", "mannequin_penetration_mm",
        "self_intersections", "mannequin_intersections", "pattern_ease_mm", "ease_mm", "hem_height_mm", "hem_range_mm",
        "pressure_kpa", "waist_drop_mm", "armhole_to_shoulder_mm", "mass_kg", "threads", "state_sha256")  # fmt: skip
COLUMNS = {
    "case": "case", "status": "status", "particles": "particles", "steps": "steps", "wall s": "wall_time_s.total:.0f",
    "steps s": "wall_time_s.steps:.1f", "detection s": "wall_time_s.detection:.1f", "residual g": "rest.residual_g_rms:.1e",
    "warp p99 %": "strain_percent.warp.p99:.2f", "weft p99 %": "strain_percent.weft.p99:.2f", "bar %": "strain_bar_percent:.2f",
    "seam gap mm": "seam_gap_mm.max:.2f",
    "penetration mm": "mannequin_penetration_mm.max:.2f", "self x": "self_intersections", "body x": "mannequin_intersections",
    "waist ease mm": "ease_mm.waist:.0f", "waist drop mm": "waist_drop_mm:.1f", "armhole off mm": "armhole_to_shoulder_mm.left:.1f",
    "hem mm": "hem_height_mm:.0f",
}  # fmt: skip


def strain_bar(job: Job, result: Result) -> float:
    """Largest 99th percentile of strain that is allowed: 1 %, or 1.5 times the sheet's warp strain at weight per girth of the line that carries the garment.

    That line is the waist edge of a skirt, the neckline of a shirt.
    """
    materials, _ = lay_out(job)
    edges = [edge for panel in job.pattern.panels.values() for edge in panel.edges]
    girth = max(sum(edge.curve.length for edge in edges if edge.role == role) for role in ("waist", "neck")) * MM_TO_M
    force = result.report["mass_kg"] * GRAVITY_M_S2 / girth
    strain = strain_at_force(force, materials.tension_strain[0, WARP], materials.tension_force[0, WARP], materials.tension_exponent[0, WARP])
    return max(1.0, 150.0 * float(strain))


def garments(only: str | None) -> None:
    """The three garments in three fabrics, coarse and fine."""
    cases = []
    for grid in GRIDS_MM:
        for garment in GARMENTS:
            for body in MANNEQUINS[garment]:
                for fabric in FABRICS:
                    job = make_job(garment, fabric, body, grid_mm=grid)
                    name = f"{garment} {fabric} {body} {grid:g} mm"
                    cases.append(StudyCase(name, job.spec_sha256, fabric, body, __version__, {"garment": garment, "grid_mm": grid}))

    def run_case(case: StudyCase) -> Mapping[str, Any]:
        job = make_job(case.parameters["garment"], case.fabric, case.mannequin, grid_mm=case.parameters["grid_mm"])
        result, _ = finish(job, lambda progress: None, ROOT / "out" / "study" / case.name.replace(" ", "-"))
        return {name: result.report[name] for name in KEPT} | {"strain_bar_percent": strain_bar(job, result)}

    study = run_study("garments", cases, run_case, FOLDER, only=only, say=print)
    write_study_table(FOLDER / "garments.md", "Three garments in three fabrics", study.rows, COLUMNS, "make study")
    for name, message in study.failed.items():
        print(f"refused: {name}: {message}", file=sys.stderr)


if __name__ == "__main__":
    garments(sys.argv[1] if len(sys.argv) > 1 else None)

"""What hangs on friction, closures and bands stays up: garments at rest go on for 20 simulated seconds of dynamics, true masses and light damping.

`python -m tools.soak_study [TEXT]` runs cases (with TEXT in their name) that have no row in docs/studies/soak.jsonl yet and writes soak.md.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from garmentcad import __version__
from garmentcad.pattern.parse import parse_spec
from garmentcad.simulation.course import AIR_DRAG, STEPS_PER_LOOK
from garmentcad.simulation.job import Job, make_job
from garmentcad.simulation.run import run
from garmentcad.simulation.study import Row, StudyCase, run_study, write_study_table
from garmentcad.units import M_TO_MM
from tools.judges import crosses, least_distance_mm
from tools.wardrobe_study import FABRICS

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "studies"
BODY, GRID_MM, SOAK_S = "woman-88", 20.0, 20.0
SLID_MM = 5.0
GARMENTS = ("trousers", "flared-skirt", "straight-skirt", "pleated-skirt", "wrap-skirt", "lined-skirt")
STRAPLESS = "strapless top"
COLUMNS = {
    "case": "case", "drape": "drape", "particles": "particles", "simulated s": "simulated_s:.1f", "lower after 5 s, mm": "lower_mm.5:z.2f",
    "10 s": "lower_mm.10:z.2f", "20 s": "lower_mm.20:z.2f", "farthest particle after 20 s, mm": "farthest_mm:.2f",
    "RMS speed at the end mm/s": "rms_speed_mm_s:.3f",
    "crosses (ipctk)": "crosses", "least distance to the body mm (libigl)": "least_distance_mm:.2f",
}  # fmt: skip


def strapless() -> dict[str, Any]:
    """A tube of two panels, 40 mm wider than the bust, whose upper edge an elastic draws to three quarters of its length."""
    points = {"a": ["-half / 2", 0], "b": ["half / 2", 0], "c": ["half / 2", 330], "d": ["-half / 2", 330]}
    edges = [{"name": name, "from": start, "to": end} for name, start, end in (("hem", "a", "b"), ("left", "b", "c"), ("top", "c", "d"), ("right", "d", "a"))]
    panels = {
        name: {"points": points, "edges": edges, "placement": {"wrap": {"part": "torso", "anchor": [0, 330], "angle": angle, "height": "bust_height + 70"}}}
        for name, angle in (("front", 0), ("back", 180))
    }
    seams = [
        {"name": "one", "a": ["front.left.c", "front.left.b"], "b": ["back.right.d", "back.right.a"]},
        {"name": "two", "a": ["back.left.c", "back.left.b"], "b": ["front.right.d", "front.right.a"]},
    ]
    elastic = {"name": "edge", "along": [["front.top.d", "front.top.c"], ["back.top.d", "back.top.c"]], "ratio": 0.75, "stiffness": 20}
    return {"schema": 1, "units": "mm", "name": "strapless-top", "fabric": "cotton-shirting", "mannequin": BODY, "values": {"half": "(bust + 40) / 2"},
            "panels": panels, "seams": seams, "elastics": [elastic]}  # fmt: skip


def job_of(garment: str, fabric: str) -> Job:
    return make_job(parse_spec(strapless()) if garment == STRAPLESS else garment, fabric, BODY, grid_mm=GRID_MM)


def cases() -> list[StudyCase]:
    found = []
    for garment, fabrics in [*((garment, FABRICS[garment][:2]) for garment in GARMENTS), (STRAPLESS, ("cotton-shirting", "interlock-knit"))]:
        for fabric in fabrics:
            key = job_of(garment, fabric).spec_sha256
            found.append(StudyCase(f"{garment} {fabric}", key, fabric, BODY, __version__, {"garment": garment, "grid_mm": GRID_MM, "soak_s": SOAK_S}))
    return found


def soak(case: StudyCase) -> Mapping[str, Any]:
    """Drape, then go on with the masses, tension and drag of dynamics. lower_mm: by how much the centre of mass has come down by then."""
    job = job_of(case.parameters["garment"], case.fabric)
    outcome = run(job, lambda progress: None)
    dynamics, state, masses = outcome.dynamics, outcome.state, outcome.cloth.masses
    dynamics.measured = dynamics.steady = True
    dynamics.equalise, dynamics.drag, dynamics.speed_cap_m_s = False, AIR_DRAG, math.inf
    start, began = state.positions.copy(), state.time_s
    row: Row = {"drape": outcome.status, "particles": len(start), "lower_mm": {}}
    for moment in (5.0, 10.0, SOAK_S):
        while state.time_s < began + moment:
            dynamics.advance(state, STEPS_PER_LOOK)
        row["lower_mm"][f"{moment:g}"] = M_TO_MM * float(np.average(start[:, 1] - state.positions[:, 1], weights=masses))
    shape = state.positions, outcome.cloth.particle_triangles, job.mannequin.vertices, job.mannequin.faces
    return row | {
        "simulated_s": state.time_s - began,
        "farthest_mm": M_TO_MM * float(np.linalg.norm(state.positions - start, axis=1).max()),
        "rms_speed_mm_s": M_TO_MM * dynamics.measures(state)[2],
        "crosses": crosses(*shape),
        "least_distance_mm": least_distance_mm(*shape),
    }


def main() -> None:
    rows = run_study("soak", cases(), soak, FOLDER, only=sys.argv[1] if len(sys.argv) > 1 else None, say=print).rows
    stay = sum(row["lower_mm"][f"{SOAK_S:g}"] < SLID_MM and not row["crosses"] and row["least_distance_mm"] >= 0.0 for row in rows)
    title = f"{SOAK_S:g} simulated seconds on {BODY}: {stay} of {len(rows)} garments stay clean and come down by less than {SLID_MM:g} mm"
    write_study_table(FOLDER / "soak.md", title, rows, COLUMNS, "python -m tools.soak_study")


if __name__ == "__main__":
    main()

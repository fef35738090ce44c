"""Every shipped garment on bodies from small to large in three fabrics: does it come to rest clean, and does its ease stay what it was drafted with?

Clean is what ipctk (crossings of cloth with itself and with the body) and libigl (signed distance from the body) say.

`python -m tools.wardrobe_study [--minutes 30] [TEXT]` runs cases (with TEXT in their name) that have no row yet, for as long, and writes
docs/studies/wardrobe.md. Breadth first: the first fabric of every garment on every body, then the next one.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from garmentcad import __version__
from garmentcad.export.drape import finish
from garmentcad.io.atomic import write_atomic
from garmentcad.io.shipped import shipped_file, shipped_names
from garmentcad.io.spec_file import read_spec
from garmentcad.simulation.job import Job, make_job
from garmentcad.simulation.study import Row, StudyCase, run_study, study_table
from tools.judges import crosses, least_distance_mm

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "docs" / "studies"
GRID_MM = 20.0
WOMEN = ("woman-88", "woman-80", "woman-104", "woman-116")
MEN = ("man-100", "man-92", "man-116")
FABRICS = {
    "flared-skirt": ("wool-suiting", "cotton-shirting", "silk-habotai"),
    "knit-top": ("interlock-knit", "ponte-roma", "stretch-twill"),
    "lined-skirt": ("wool-suiting", "wool-tropical", "polyester-tropical"),
    "mens-shirt": ("cotton-shirting", "polycotton-twill", "silk-habotai"),
    "pleated-skirt": ("wool-suiting", "wool-tropical", "polyester-tropical"),
    "sheath-dress": ("wool-dress", "cotton-shirting", "polyester-satin"),
    "straight-skirt": ("wool-suiting", "cotton-shirting", "denim-lightweight"),
    "t-shirt": ("interlock-knit", "cotton-shirting", "wool-suiting"),
    "trousers": ("wool-suiting", "polycotton-trousering", "denim"),
    "wrap-skirt": ("wool-suiting", "cotton-shirting", "viscose-lining"),
}
# A woven stretch cloth gives half as much as a knit: as drafted the doctor says that the top does not pass the head, and
# on two men it did not close or not come to rest. A roomier top of it does.
VALUES = {("knit-top", "stretch-twill"): {"reduction": 0.015, "arm_ease": 30.0, "armhole_drop": 25.0, "neck_ease": 150.0, "band_reduction": 0.05}}
BODIES = {"t-shirt": WOMEN + MEN, "trousers": WOMEN + MEN, "mens-shirt": MEN, "knit-top": WOMEN + MEN}
KEPT = ("status", "particles", "steps", "simulated_time_s", "seam_gap_mm", "mannequin_penetration_mm", "self_intersections", "mannequin_intersections",
        "constraints", "pattern_ease_mm", "ease_mm", "hem_height_mm", "waist_drop_mm", "armhole_to_shoulder_mm", "state_sha256", "warnings")  # fmt: skip
GIRTHS = ("bust", "waist", "hip")
COLUMNS = {
    "case": "case", "status": "status", "particles": "particles", "steps": "steps", "crosses (ipctk)": "crosses",
    "least distance to the body mm (libigl)": "least_distance_mm:.2f", "seam gap mm": "seam_gap_mm.max:.2f", "ease bust mm": "ease_mm.bust:.0f",
    "ease waist mm": "ease_mm.waist:.0f", "ease hip mm": "ease_mm.hip:.0f", "waist drop mm": "waist_drop_mm:.1f", "hem mm": "hem_height_mm:.0f",
}  # fmt: skip


def job_of(garment: str, fabric: str, body: str, grid_mm: float) -> Job:
    spec = read_spec(shipped_file("patterns", garment))
    return make_job(spec, fabric, body, grid_mm=grid_mm, values=VALUES.get((garment, fabric)))


def cases() -> list[StudyCase]:
    """All cases of garments that are there."""
    found = []
    for choice in range(3):
        for garment in shipped_names("patterns"):
            for body in BODIES.get(garment, WOMEN):
                fabric = FABRICS[garment][choice]
                job = job_of(garment, fabric, body, GRID_MM)
                found.append(StudyCase(f"{garment} {fabric} {body}", job.spec_sha256, fabric, body, __version__, {"garment": garment, "grid_mm": GRID_MM}))
    return found


def processor() -> str:
    """What the system calls this processor, with the numbers of its model, where the name may say little."""
    lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    told = {name.strip(): value.strip() for name, _, value in (line.partition(":") for line in reversed(lines))}
    return f"{told.get('model name', 'unknown')} (family {told.get('cpu family', '?')}, model {told.get('model', '?')})"


def measured(case: StudyCase) -> Mapping[str, Any]:
    """The figures of one drape."""
    job = job_of(case.parameters["garment"], case.fabric, case.mannequin, case.parameters["grid_mm"])
    folder = ROOT / "out" / "wardrobe" / f"{case.name} {job.grid_mm:g} mm".replace(" ", "-")
    result, _ = finish(job, lambda progress: None, folder)
    shape = result.state.positions, result.cloth.particle_triangles, job.mannequin.vertices, job.mannequin.faces
    judged = {"crosses": crosses(*shape), "least_distance_mm": least_distance_mm(*shape)}
    return {name: result.report[name] for name in KEPT} | judged | {"processor": processor()}


def between_sizes(rows: Sequence[Row]) -> list[Row]:
    """Largest minus smallest ease of a garment in a fabric over the bodies of a sex, mm, at every girth that all of them have."""
    found = []
    for one in dict.fromkeys((row["garment"], row["fabric"], row["mannequin"].partition("-")[0]) for row in rows):
        eases = [row["ease_mm"] for row in rows if (row["garment"], row["fabric"], row["mannequin"].partition("-")[0]) == one]
        spread: Row = {"case": " ".join(one[:2]), "bodies": f"{len(eases)}, {one[2]}"}
        for girth in GIRTHS:
            values = [ease[girth] for ease in eases if ease.get(girth) is not None]
            if len(values) == len(eases) > 1:
                spread[girth] = max(values) - min(values)
        found.append(spread)
    return found


def rows_within_minutes(
    name: str, whole: Sequence[StudyCase], description: str | None, measure: Callable[[StudyCase], Mapping[str, Any]] = measured
) -> tuple[Row, ...]:
    """Run the cases that the command line asks for (`--minutes`, TEXT) and that have no row yet; all rows. What is refused is named at the end."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--minutes", type=float, default=1e9)
    parser.add_argument("only", nargs="?")
    options = parser.parse_args()
    end = time.monotonic() + 60.0 * options.minutes
    failed: dict[str, str] = {}
    for case in whole:
        if time.monotonic() > end:
            break
        if options.only is None or options.only in case.name:
            failed |= run_study(name, [case], measure, FOLDER, say=print).failed
    for case_name, message in failed.items():
        print(f"refused: {case_name}: {message}", file=sys.stderr)
    return run_study(name, whole, measure, FOLDER, only="\0").rows


def main() -> None:
    """Run the study and write its page."""
    whole = cases()
    rows = rows_within_minutes("wardrobe", whole, __doc__)
    clean = sum(row["status"] == "converged" and not row["crosses"] and row["least_distance_mm"] >= 0.0 for row in rows)
    title = f"The wardrobe at {GRID_MM:g} mm: {len(rows)} of {len(whole)} cases run, {clean} of them at rest without an intersection or a penetration"
    command = "python -m tools.wardrobe_study"
    spreads = {"garment, fabric": "case", "bodies": "bodies", **{f"{girth} mm": f"{girth}:.1f" for girth in GIRTHS}}
    own = [f"{garment} in {fabric}: {', '.join(f'{name} {value:g}' for name, value in values.items())}" for (garment, fabric), values in VALUES.items()]
    said = "Largest minus smallest draped ease of one draft over all sizes."
    page = [f"# {title}", "", study_table(rows, COLUMNS, command), f"As drafted, but for {'; '.join(own)}.", "", "## Ease between sizes", "", said, ""]
    write_atomic(FOLDER / "wardrobe.md", "\n".join([*page, study_table(between_sizes(rows), spreads, command)]))


if __name__ == "__main__":
    main()

"""Ease between sizes at 10 mm: each garment that closes around the body, in the fabric of its spec, on bodies from small to large.

`python -m tools.size_study [--minutes 30] [TEXT]` runs cases (with TEXT in their name) that have no row yet, for as long, and writes docs/studies/sizes.md.
"""

from __future__ import annotations

from garmentcad import __version__
from garmentcad.io.atomic import write_atomic
from garmentcad.io.shipped import shipped_file, shipped_names
from garmentcad.io.spec_file import read_spec
from garmentcad.simulation.study import Row, StudyCase, study_table
from tools.wardrobe_study import BODIES, COLUMNS, FOLDER, GIRTHS, WOMEN, between_sizes, job_of, rows_within_minutes

GRID_MM = 10.0
OPEN = ("mens-shirt", "wrap-skirt")  # no level section of them closes around the body: they have no ease


def cases() -> list[StudyCase]:
    """All cases, the garments that take longest last."""
    found = []
    for garment in sorted(shipped_names("patterns"), key=lambda name: name in ("lined-skirt", "pleated-skirt")):
        fabric = read_spec(shipped_file("patterns", garment)).fabric
        for body in BODIES.get(garment, WOMEN) if garment not in OPEN else ():
            job = job_of(garment, fabric, body, GRID_MM)
            found.append(StudyCase(f"{garment} {fabric} {body}", job.spec_sha256, fabric, body, __version__, {"garment": garment, "grid_mm": GRID_MM}))
    return found


def drafted_and_draped(rows: tuple[Row, ...]) -> list[Row]:
    """Rows with the ease of each girth as it was drafted and as it hangs, in one text."""

    def both(row: Row, girth: str) -> str:
        drafted, draped = row["pattern_ease_mm"].get(girth), row["ease_mm"].get(girth)
        return "-" if draped is None else f"{drafted:.1f} / {draped:.1f}"

    return [row | {f"{girth}_both": both(row, girth) for girth in GIRTHS} for row in rows]


def main() -> None:
    """Run the study and write its page."""
    whole = cases()
    rows = rows_within_minutes("sizes", whole, __doc__)
    command = "python -m tools.size_study"
    columns = {title: key for title, key in COLUMNS.items() if not title.startswith("ease")} | {f"{girth} mm": f"{girth}_both" for girth in GIRTHS}
    spreads = {"garment, fabric": "case", "bodies": "bodies", **{f"{girth} mm": f"{girth}:.1f" for girth in GIRTHS}}
    said = (
        "Largest minus smallest draped ease of one draft over all sizes, where all of them have one. The flared skirt is a half circle on every body: it "
        "states no ease at the hip, and what it has there goes with waist and hip."
    )
    page = [f"# Ease between sizes at {GRID_MM:g} mm: {len(rows)} of {len(whole)} cases run", "", said, "", study_table(between_sizes(rows), spreads, command)]
    page += ["## Each size", "", "Ease as drafted / as it hangs.", "", study_table(drafted_and_draped(rows), columns, command)]
    write_atomic(FOLDER / "sizes.md", "\n".join(page))


if __name__ == "__main__":
    main()

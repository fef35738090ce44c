"""Drapes of the wardrobe once more on this machine: do they end in the bits that another one has recorded (docs/studies/wardrobe.jsonl)?

`python -m tools.machines_study [--minutes 30] [TEXT]` drapes cases (with TEXT in their name) that have no row for this processor yet, for as long, and writes
docs/studies/machines.md. Every seventh case first, so that a short run is a broad one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from garmentcad.io.atomic import write_atomic
from garmentcad.simulation.record import record
from garmentcad.simulation.run import run
from garmentcad.simulation.study import StudyCase, read_rows, study_table
from tools.wardrobe_study import FOLDER, cases, job_of, processor, rows_within_minutes

RECORDED_ON = "AMD EPYC (Zen 5)"  # of rows of before they name their processor
_STRIDE = 7
COLUMNS = {"case": "case", "steps": "steps", "recorded on": "recorded_on", "bits": "recorded", "again on": "processor", "its bits": "here", "same": "same"}


def main() -> None:
    """Run the study and write its page."""
    here = processor()
    recorded = {(row["case"], row["spec_sha256"]): row for row in read_rows(FOLDER / "wardrobe.jsonl") if row.get("processor") != here}

    def compared(case: StudyCase) -> Mapping[str, Any]:
        job = job_of(case.parameters["garment"], case.fabric, case.mannequin, case.parameters["grid_mm"])
        made, _ = record(run(job, lambda progress: None))
        before = recorded[case.name, case.spec_sha256]
        bits = {"recorded": before["state_sha256"][:16], "here": made.state_sha256[:16]}
        same = "yes" if made.state_sha256 == before["state_sha256"] else "NO"
        return {"steps": made.steps, "recorded_on": before.get("processor", RECORDED_ON), **bits, "same": same}

    whole = [replace(case, parameters={**case.parameters, "processor": here}) for case in cases() if (case.name, case.spec_sha256) in recorded]
    rows_within_minutes("machines", [case for first in range(_STRIDE) for case in whole[first::_STRIDE]], __doc__, compared)
    rows = read_rows(FOLDER / "machines.jsonl")  # of other processors, too
    alike = sum(row["same"] == "yes" for row in rows)
    title = f"The same bits on another machine: {alike} of {len(rows)} drapes"
    said = "Drapes at 20 mm that the wardrobe study has recorded, once more. Bits: the first 16 digits of `state_sha256`."
    write_atomic(FOLDER / "machines.md", "\n".join([f"# {title}", "", said, "", study_table(rows, COLUMNS, "python -m tools.machines_study")]))
    print(title)


if __name__ == "__main__":
    main()

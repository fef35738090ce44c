"""Whether garment tests fail when they must, and only then: the hem moved by 10 mm, bending stiffness doubled, and ten runs on lays that no baseline saw.

`python -m tools.garment_test_study` runs the cases that have no row in docs/studies/garment-tests.jsonl yet and writes garment-tests.md; with TEXT only those
with TEXT in their name. Rows belong to their baseline: after `garmentcad test patterns/tests --remake` all cases run again.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from garmentcad import __version__
from garmentcad.errors import TangledError
from garmentcad.fabric.missing import complete
from garmentcad.io.atomic import write_atomic
from garmentcad.io.garment_test_file import find_garment_tests, read_garment_tests
from garmentcad.io.shipped import shipped_folder
from garmentcad.pattern.draft import draft
from garmentcad.regression.assertion import means
from garmentcad.regression.lays import drape_lays
from garmentcad.regression.trial import Trial, prepare, verdicts_on
from garmentcad.simulation.job import Job
from garmentcad.simulation.study import StudyCase, run_study, study_table

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "studies"
# The parameter that moves the hem, where it is not the length.
HEM = {"knit-top": "below_hip", "mens-shirt": "below_hip", "t-shirt": "below_hip", "trousers": "hem_height"}
HEM_MM = (-10.0, 10.0)
RUNS, FIRST_SEED = 10, 1000  # a run takes its starts from a thousand of its own; baselines count theirs from 0
STIFFER = "flared-skirt"
UNCHANGED, MOVED, DOUBLED = "unchanged", "hem", "B doubled"
KEPT = {  # means over the lays of a run
    "hem_height_mm": "hem_height_mm", "nodes": "hem.nodes", "drape_coefficient_percent": "hem.drape_coefficient_percent", "bend_j": "energy_j.bend",
}  # fmt: skip
COLUMNS = {
    "case": "case", "status": "status", "hem mm": "hem_height_mm:.1f", "nodes": "nodes:.1f", "drape coefficient %": "drape_coefficient_percent:.1f",
    "bending energy J": "bend_j:.2e", "assertions": "assertions", "failed": "failed_keys",
}  # fmt: skip


def with_hem(job: Job, parameter: str, by_mm: float) -> Job:
    """The job with a garment that is longer, or shorter."""
    given = job.spec.parameters[parameter]
    changed = given.model_copy(update={"value": f"({given.value}) + ({by_mm:g})"})
    spec = job.spec.model_copy(update={"parameters": job.spec.parameters | {parameter: changed}})
    return replace(job, spec=spec, pattern=draft(spec, job.mannequin.measurements_mm))


def with_doubled_bending(job: Job) -> Job:
    """The job with twice the B of its fabric, in every direction; its 2HB stays."""
    sheet = job.fabrics[job.pattern.fabric].sheet
    twice = {key: value.model_copy(update={"value": 2.0 * value.value}) for key, value in sheet.values().items() if key.partition(".")[0] == "B"}
    return replace(job, fabrics=job.fabrics | {job.pattern.fabric: complete(sheet.with_values(twice))})


def changed_job(trial: Trial, parameters: Mapping[str, Any]) -> Job:
    """The drape of a case."""
    if parameters["change"] == MOVED:
        return with_hem(trial.job, HEM.get(trial.job.pattern.name, "length"), parameters["by_mm"])
    if parameters["change"] == DOUBLED:
        return with_doubled_bending(trial.job)
    return trial.job


def cases_of(trial: Trial) -> list[StudyCase]:
    """All cases of one garment test."""
    baseline = hashlib.sha256(trial.case.baseline_file.read_bytes()).hexdigest()[:16]
    changes: list[tuple[str, dict[str, Any]]] = [(f"hem {by:+g} mm", {"change": MOVED, "by_mm": by}) for by in HEM_MM]
    changes += [(DOUBLED, {"change": DOUBLED})] if trial.job.pattern.name == STIFFER else []
    changes += [(f"{UNCHANGED}, run {run}", {"change": UNCHANGED, "start": FIRST_SEED * run}) for run in range(1, RUNS + 1)]
    job = trial.job
    fabric = job.fabrics[job.pattern.fabric].sheet.name
    same = {"grid_mm": job.grid_mm, "baseline": baseline}
    return [StudyCase(f"{trial.case.name}: {name}", job.spec_sha256, fabric, job.mannequin.name, __version__, same | change) for name, change in changes]


def main(only: str | None) -> None:
    """Run the study and write its page."""
    trials = [prepare(case) for file in find_garment_tests(shipped_folder("patterns") / "tests") for case in read_garment_tests(file)]
    owner = {case.name: trial for trial in trials for case in cases_of(trial)}

    def run_case(case: StudyCase) -> Mapping[str, Any]:
        trial = owner[case.name]
        test = trial.case.test
        try:
            lays, _ = drape_lays(changed_job(trial, case.parameters), test.lays, lambda lay: None, lambda progress: None, case.parameters.get("start", 0))
        except TangledError as error:
            return {"status": "refused", "refusal": str(error)}
        verdicts = verdicts_on(trial, lays)
        failed = [verdict.key for verdict in verdicts if not verdict.passed]
        row: dict[str, Any] = {"status": " ".join(lay.result.report["status"] for lay in lays), "starts": [lay.seed for lay in lays]}
        row |= {name: means([lay.result.report for lay in lays], key).get(key) for name, key in KEPT.items()}
        row |= {"assertions": len(verdicts), "failed": failed}
        row |= {"failed_keys": ", ".join(failed) or "none"}
        print(f"{row['status']}, failed: {row['failed_keys']}", flush=True)
        return row

    cases = [case for trial in trials for case in cases_of(trial)]
    study = run_study("garment-tests", cases, run_case, FOLDER, only=only, say=lambda message: print(message, flush=True))
    lines = summary(study.rows)
    print("\n".join(lines))
    table = study_table(study.rows, COLUMNS, "python -m tools.garment_test_study")
    write_atomic(FOLDER / "garment-tests.md", "\n".join(["# Do garment tests fail when they must, and only then?", "", __doc__ or "", *lines, "", table]))


def summary(rows: tuple[Mapping[str, Any], ...]) -> list[str]:
    """What the rows say, change by change. A start that is refused as tangled is no drape to judge."""
    lines = []
    for change, wanted in ((MOVED, "caught"), (DOUBLED, "caught"), (UNCHANGED, "pass")):
        judged = [row for row in rows if row["change"] == change and row["status"] != "refused"]
        right = [row for row in judged if bool(row["failed"]) == (wanted == "caught")]
        lines.append(f"* {change}: {len(right)} of {len(judged)} {wanted}.")
    refused = sum(row["status"] == "refused" for row in rows)
    return [*lines, f"* {refused} starts refused because displaced panels crossed."]


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)

"""The one call from spec to result: drape, judge, measure, and write the result folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from garmentcad.export.report import build_report
from garmentcad.export.result_folder import Result, WrittenFolder, write_result_folder
from garmentcad.pattern.spec import GarmentSpec
from garmentcad.simulation.course import Progress
from garmentcad.simulation.job import Job, Mode, make_job
from garmentcad.simulation.record import record
from garmentcad.simulation.run import run

CHECKPOINT = "checkpoint.npz"


def drape(
    spec: str | Path | GarmentSpec,
    fabric: str | None = None,
    mannequin: str | None = None,
    *,
    grid_mm: float = 10.0,
    seed: int = 0,
    mode: Mode = "drape",
    max_time_s: float = 12.0,
    folder: str | Path | None = None,
) -> Result:
    """Drape a garment and return its report, cloth, state and maps; with `folder`, write the result folder too.

    spec: shipped name, file or model; fabric, mannequin: shipped name or file, in place of the spec's own. Raises InputError for what is refused.
    """
    job = make_job(spec, fabric, mannequin, grid_mm=grid_mm, seed=seed, mode=mode, max_time_s=max_time_s)
    return finish(job, lambda progress: None, None if folder is None else Path(folder))[0]


def finish(job: Job, look: Callable[[Progress], None], folder: Path | None, resume: bool = False) -> tuple[Result, WrittenFolder | None]:
    """Run a job to its end and write what comes out. The checkpoint in `folder` is kept while the run lasts and removed when the folder is whole."""
    checkpoint = None if folder is None else folder / CHECKPOINT
    outcome = run(job, look, checkpoint, resume)
    made, measures = record(outcome)
    result = Result(build_report(made, measures), outcome.cloth, outcome.state, measures.maps, job.mannequin)
    if folder is None or checkpoint is None:
        return result, None
    written = write_result_folder(folder, result, job.identity)
    checkpoint.unlink(missing_ok=True)
    return result, written

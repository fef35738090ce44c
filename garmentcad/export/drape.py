"""The one call from spec to result: drape, judge, measure, and write the result folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path

from garmentcad.analysis.clearance import clearing_moves, move_panels
from garmentcad.analysis.run_record import Mode
from garmentcad.check.placement import check_twists
from garmentcad.check.region import check_regions
from garmentcad.check.seam import check_seams
from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.panel_mesh import PARTICLE_CAP
from garmentcad.errors import InputError
from garmentcad.export.movement import movement_report, write_movement
from garmentcad.export.report import build_report
from garmentcad.export.result_folder import CHECKPOINT, Result, WrittenFolder, clear_folder, make_folder, write_result_folder
from garmentcad.fabric.sheet import KesSheet
from garmentcad.io.arguments import refuse_unnamed
from garmentcad.io.held_folder import held_folder
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.spec import GarmentSpec
from garmentcad.placement.place import place_vertices
from garmentcad.simulation.course import Progress
from garmentcad.simulation.job import Job, make_job
from garmentcad.simulation.keeper import Interrupted
from garmentcad.simulation.lattices import grids_of
from garmentcad.simulation.materials import lay_out
from garmentcad.simulation.movement import move
from garmentcad.simulation.record import record
from garmentcad.simulation.run import Outcome, run


def drape(
    spec: str | Path | GarmentSpec,
    fabric: str | Path | KesSheet | None = None,
    mannequin: str | Path | Mannequin | None = None,
    *,
    grid_mm: float = 10.0,
    seed: int = 0,
    mode: Mode = "drape",
    max_time_s: float = 20.0,
    max_particles: int = PARTICLE_CAP,
    pose: str | Path | None = None,
    values: Mapping[str, float] | None = None,
    folder: str | Path | None = None,
) -> Result:
    """Drape a garment and return its report, cloth, state and maps; with `folder`, write the result folder too, in place of an older result there.

    Arguments as of `make_job`, which raises InputError for what is refused. A garment that did not come to rest is no error: `report["status"]` says it.
    """
    if folder is not None:
        refuse_unnamed(folder, "folder")
        if not str(folder):
            raise InputError("an empty text came; a folder is wanted", key="folder")
    job = make_job(spec, fabric, mannequin, grid_mm=grid_mm, seed=seed, mode=mode, max_time_s=max_time_s, max_particles=max_particles, pose=pose, values=values)
    return finish(job, lambda progress: None, None if folder is None else Path(folder))[0]


def finish(job: Job, look: Callable[[Progress], None], folder: Path | None, resume: bool = False) -> tuple[Result, WrittenFolder | None]:
    """Run a job to its end, and through its movement where it came to rest, and write what comes out.

    An older result in `folder` stays until nothing can refuse the job any more. The checkpoint is kept while the run lasts and removed when the folder is
    whole. A movement that was broken off begins anew. FileError where another process is draping into the folder.
    """
    reserved = begun = False
    with ExitStack() as held:

        def reserve() -> None:
            nonlocal reserved
            if folder is not None and not reserved:
                make_folder(folder)
                held.enter_context(held_folder(folder))
                reserved = True

        def begin() -> None:
            nonlocal begun
            reserve()
            if folder is not None:
                clear_folder(folder, movement=True)
            begun = True

        checkpoint = None if folder is None else folder / CHECKPOINT
        try:
            outcome = run(job, look, checkpoint, resume, begin, reserve)
        except InputError:
            if checkpoint is not None and reserved and not begun:
                checkpoint.unlink(missing_ok=True)  # of what is worn below; what goes over it was refused, and would be again
            raise
        return _written(outcome, look, folder)


def _doctor_on(outcome: Outcome) -> list[str]:
    """What can be draped all the same and come to rest clean, and is wrong to the pattern doctor: errors of the seams, and regions without effect on the
    lattice that was draped."""
    job = outcome.job
    materials, material_of = lay_out(job)
    cloth = build_cloth(job.pattern, material_of, materials, grids_of(job)[0], particle_cap=job.max_particles)  # the coarsest on which it is sewn
    positions = place_vertices(job.pattern, cloth, job.mannequin)
    positions = move_panels(cloth, positions, clearing_moves(job.pattern, cloth, positions, job.mannequin))
    seams = [*check_seams(job.pattern, job.spec.file), *check_twists(job.pattern, cloth, positions, job.spec.file)]
    told = [f"`garmentcad check` finds an error: {one.key}: {one.message} [{one.code}]" for one in seams if one.severity == "error"]
    return told + [f"`garmentcad check` warns: {one.key}: {one.message} [{one.code}]" for one in check_regions(job.pattern, outcome.flat, job.spec.file)]


def _written(outcome: Outcome, look: Callable[[Progress], None], folder: Path | None) -> tuple[Result, WrittenFolder | None]:
    job = outcome.job
    made, measures = record(outcome)
    report = build_report(made, measures)
    report["warnings"] += _doctor_on(outcome)
    files: list[Path] = []
    notes: list[str] = []
    if job.poses and made.status == "converged":
        try:
            movement = move(outcome, job.poses, look)
        except KeyboardInterrupt:
            again = "" if folder is None else f"; --resume begins it anew from {folder / CHECKPOINT}"
            raise Interrupted(f"stopped during the movement{again}") from None
        report["movement"] = movement_report(movement, outcome.cloth, job.mannequin, job.pattern)
        if folder is not None:
            files, notes = write_movement(folder / "movement", movement, outcome.cloth, job.mannequin)
    elif job.poses:
        report["warnings"].append(f"the garment did not come to rest clean ({made.status}): the movement was left out")
    result = Result(report, outcome.cloth, outcome.state, measures.maps, job.mannequin)
    if folder is None:
        return result, None
    written = write_result_folder(folder, result, job.identity)
    written = WrittenFolder(written.folder, (*files, *written.files), (*notes, *written.notes))
    (folder / CHECKPOINT).unlink(missing_ok=True)
    return result, written

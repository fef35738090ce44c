"""One garment test carried out: drape, and a verdict for each assertion."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import filter as filter_names
from pathlib import Path
from typing import get_args

import numpy as np

from garmentcad.analysis.run_record import Status
from garmentcad.analysis.surface_distance import Surface, SurfaceDistance, surface_distance
from garmentcad.errors import FileError, InputError, SpecError, did_you_mean
from garmentcad.export.report import LISTS, SWITCHES, WORDS
from garmentcad.export.result_folder import Result, write_result_folder
from garmentcad.io.garment_test_file import GarmentTestCase
from garmentcad.pattern.garment_test import ANY, SHAPE, Expected
from garmentcad.pattern.parse import shown
from garmentcad.regression.assertion import Verdict, expected_text, judge, means, refuse_unknown_keys, verdict
from garmentcad.regression.baseline import Baseline, Shape, read_baseline, read_shape
from garmentcad.regression.difference_picture import draw_difference
from garmentcad.regression.known_values import known_values
from garmentcad.regression.lays import Lay, drape_lays
from garmentcad.simulation.course import Progress
from garmentcad.simulation.job import Job, make_job

AT_REST: dict[str, Expected] = {"status": "converged"}  # of every test that says nothing else of it


@dataclass(frozen=True)
class Trial:
    """A test that was read and found sound: nothing but the drape is left to do."""

    case: GarmentTestCase
    job: Job
    baseline: Baseline | None
    shape: Shape | None


@dataclass(frozen=True)
class Judgement:
    """What became of a test. refusal: why there was no drape to judge; files: what was written because it failed; notes: what was left out, and why."""

    case: GarmentTestCase
    verdicts: tuple[Verdict, ...] = ()
    wall_s: float = 0.0
    refusal: str | None = None
    files: tuple[Path, ...] = ()
    notes: tuple[str, ...] = field(default=())

    @property
    def passed(self) -> bool:
        return self.refusal is None and all(verdict.passed for verdict in self.verdicts)


def job_of(case: GarmentTestCase) -> Job:
    """The drape that a test asks for. InputError for what is refused, a key that its report will not have among it."""
    test = case.test
    if not test.baseline and "baseline" in test.model_fields_set:
        raise SpecError("it names no value; name some (or shape), or leave the key out", file=str(case.file), key="baseline")
    if twice := [key for k, key in enumerate(test.baseline) if key in test.baseline[:k]]:
        raise SpecError(f"{', '.join(twice)} stands twice; each key may stand once", file=str(case.file), key="baseline")
    fabric, mannequin = case.resolve(test.fabric, "fabrics"), case.resolve(test.mannequin, "mannequins")
    try:
        job = make_job(case.spec, fabric, mannequin, grid_mm=test.grid_mm, seed=test.seed, max_time_s=test.max_time_s)
    except InputError as error:
        if error.file is not None:
            raise
        raise type(error)(error.message, file=str(case.file), key=error.key, others=error.others) from None
    known = known_values(job.pattern)
    for place, keys in (("report", test.report), ("baseline", [key for key in test.baseline if key != SHAPE])):
        refuse_unknown_keys(keys, known, str(case.file), place)
    status = test.report.get("status")
    if isinstance(status, str) and status not in (*get_args(Status), ANY):
        raise SpecError(f"no drape ends as {shown(status)}{did_you_mean(status, get_args(Status))}", file=str(case.file), key="report.status")
    for key, wanted in test.report.items():
        if wanted is not None and wanted != ANY:
            _refuse_kind(key, wanted, str(case.file))
    return job


def _refuse_kind(key: str, wanted: Expected, file: str) -> None:
    """SpecError for what no value of a key can be. A first name with `*` may mean values of several kinds."""
    place = key if key in LISTS else key.split(".")[0]
    for said, names, kind in (("a word", WORDS, str), ("true or false", SWITCHES, bool), ("a list, of which [] can be expected", LISTS, list)):
        if place in names and not isinstance(wanted, kind):
            raise SpecError(f"{expected_text(wanted)} came; this value is {said}", file=file, key=f"report.{key}")
        if isinstance(wanted, kind) and not filter_names(names, place):
            came = shown(wanted) if isinstance(wanted, str) else expected_text(wanted)
            raise SpecError(f"{came} came; a number is wanted here, a range as in [10, 20], or {{value: 15, tol: 2}}", file=file, key=f"report.{key}")


def setting(case: GarmentTestCase, job: Job) -> dict[str, str]:
    """What a baseline must agree with. Not the spec itself: a garment that was changed is what a test is to find."""
    fabric = job.fabrics[job.pattern.fabric].sheet.name
    return {
        "garment": job.pattern.name, "fabric": fabric, "mannequin": job.mannequin.name, "grid_mm": f"{job.grid_mm:.12g}", "lays_in_test": str(case.test.lays),
    }  # fmt: skip


def prepare(case: GarmentTestCase) -> Trial:
    """Read all that a test needs. InputError for what is refused."""
    job = job_of(case)
    if not case.test.baseline:
        return Trial(case, job, None, None)
    baseline = read_baseline(case.baseline_file, setting(case, job), case.test.baseline)
    return Trial(case, job, baseline, read_shape(case.baseline_file))


def run_trial(trial: Trial, folder: Path | None, look: Callable[[Progress], None] = lambda progress: None) -> Judgement:
    """Drape and judge. folder: where the drape (of the start as drafted) and a picture of the difference are written if it fails."""
    began = time.perf_counter()
    try:
        lays, _ = drape_lays(trial.job, trial.case.test.lays, lambda lay: None, look)
    except InputError as error:  # a start that only the run can refuse: panels that cross
        return Judgement(trial.case, wall_s=time.perf_counter() - began, refusal=str(error))
    verdicts = verdicts_on(trial, lays)
    wall_s = time.perf_counter() - began
    if folder is None or all(verdict.passed for verdict in verdicts):
        return Judgement(trial.case, tuple(verdicts), wall_s)
    files, notes = _keep(trial, lays[0].result, folder)
    return Judgement(trial.case, tuple(verdicts), wall_s, files=files, notes=notes)


def _keep(trial: Trial, result: Result, folder: Path) -> tuple[tuple[Path, ...], tuple[str, ...]]:
    """Write a failed drape and its picture. Where that cannot be, its verdicts are said all the same, and a note says why."""
    picture = folder / "difference.png"
    try:
        picture.unlink(missing_ok=True)  # of an older drape
        written = write_result_folder(folder, result, trial.job.identity)
    except (FileError, OSError) as error:
        return (), (f"the failed drape was not kept: {error}",)
    apart = distance_from_baseline(trial, result)
    if trial.shape is None or apart is None or written.notes:
        return written.files, written.notes
    return (*written.files, draw_difference(picture, result, trial.shape, apart)), ()


def distance_from_baseline(trial: Trial, result: Result) -> SurfaceDistance | None:
    """None where there is no baseline or the drape has no finite shape."""
    if trial.shape is None or not np.isfinite(result.state.positions).all():
        return None
    return surface_distance(Surface(result.state.positions, result.cloth.particle_triangles), Surface(trial.shape.positions, trial.shape.particle_triangles))


def verdicts_on(trial: Trial, lays: Sequence[Lay]) -> list[Verdict]:
    """A verdict for each assertion of a test: those written by hand on every lay, the baseline's figures on their means, its shape on the first lay."""
    verdicts = judge(lays[0].result.report, AT_REST | trial.case.test.report)
    for lay in lays[1:]:
        verdicts += [replace(verdict, key=f"start {lay.seed}: {verdict.key}") for verdict in judge(lay.result.report, AT_REST | trial.case.test.report)]
    if trial.baseline is None:
        return verdicts
    reports = [lay.result.report for lay in lays]
    by_hand = {verdict.key for verdict in verdicts}
    for key, figure in trial.baseline.report.items():
        value = means(reports, key).get(key)
        name = f"{key} (baseline)" if key in by_hand else key  # servers that read JUnit XML take two cases of one name for one
        verdicts.append(verdict(name, value, figure.expected))
    if limits := trial.baseline.distances():
        apart = distance_from_baseline(trial, lays[0].result)
        came = {SHAPE: {"rms_mm": apart and apart.rms_mm, "max_mm": apart and apart.max_mm}}
        verdicts += judge(came, {f"{SHAPE}.{name}": (None, figure.value + figure.tol) for name, figure in limits.items()})
    return verdicts

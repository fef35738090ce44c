"""Making a baseline: drape the garment from several lays, keep the figures and how they scatter."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from garmentcad import __version__
from garmentcad.analysis.surface_distance import Surface, surface_distance
from garmentcad.errors import GarmentError, InputError, SpecError
from garmentcad.io.garment_test_file import GarmentTestCase
from garmentcad.pattern.garment_test import SHAPE
from garmentcad.regression.assertion import values_at
from garmentcad.regression.baseline import FEWEST_LAYS, RULE, Baseline, Shape, distance_figure, factor, figure, write_baseline
from garmentcad.regression.lays import Lay, drape_lays
from garmentcad.regression.trial import job_of, setting
from garmentcad.simulation.course import Progress
from garmentcad.simulation.job import Job

LAYS = 10
# Where other lays lie farther away than this in the mean (RMS), folds fall elsewhere: the shape says nothing, its figures do.
SHARE_OF_GRID = 0.5


class UnfitBaselineError(GarmentError):
    """A garment whose lays do not come to rest, or do not agree in what the test asks for, can have no such baseline."""


def remake(case: GarmentTestCase, lays: int, say: Callable[[str], None], look: Callable[[Progress], None] = lambda progress: None) -> Baseline:
    """Drape `lays` lays and write the baseline of a test. say: told of each lay, and of tolerances that are too wide.

    InputError for a test that is refused, UnfitBaselineError where lays end otherwise than at rest, or lie too far apart for a shape; then nothing is written.
    """
    if lays < FEWEST_LAYS:
        wide = f"of {FEWEST_LAYS - 1} a tolerance is {factor(FEWEST_LAYS - 1):.3g} standard deviations wide, of fewer still more: it holds for almost anything"
        raise InputError(f"{lays} lays; at least {FEWEST_LAYS} are allowed ({wide})", key="lays")
    if not case.test.baseline:
        raise SpecError("the test names no keys of which a baseline could be made", file=str(case.file), key="baseline")
    job = job_of(case)

    def at_rest(lay: Lay) -> None:
        say(f"start {lay.seed}: {lay.result.report['status']}")
        if lay.result.report["status"] != "converged":
            raise UnfitBaselineError(f"start {lay.seed} ended as {lay.result.report['status']}; a garment that does not come to rest can have no baseline")
        numbers_over(case, [lay])  # what the first lay has no number for is not looked for in all others

    drapes, refused = drape_lays(job, lays, at_rest, look)
    baseline = baseline_of(case, job, drapes, refused)
    first = drapes[0].result
    write_baseline(case.baseline_file, baseline, Shape(first.state.positions, first.cloth.triangles, first.cloth.vertex_particle))
    for doubt in doubts(baseline, job.grid_mm):
        say(f"warning: {doubt}; more lays make it narrower, or leave this key out")
    return baseline


def doubts(baseline: Baseline, grid_mm: float) -> list[str]:
    """A sentence for each tolerance that is as large as what it guards: a figure's above the figure itself, the shape's above what no shape's lays may be
    apart in the mean. Where lays agree, the least tolerance is no fault of theirs."""
    wide = {key: figure for key, figure in baseline.report.items() if figure.sd > 0.0 and figure.tol > abs(figure.value)}
    found = [f"{key}: the tolerance, {figure.tol:g}, is larger than the value, {figure.value:g}: hardly any change will fail" for key, figure in wide.items()]
    rms = baseline.rms_mm
    if rms is not None and rms.tol > SHARE_OF_GRID * grid_mm:
        found.append(f"{SHAPE}: the tolerance, {rms.tol:g} mm (RMS), is more than {SHARE_OF_GRID:g} of the grid: other folds will not fail")
    return found


def numbers_over(case: GarmentTestCase, drapes: Sequence[Lay]) -> dict[str, list[float | int]]:
    """Path -> number of each lay, of all that the keys of a baseline mean. UnfitBaselineError where some lay has none."""
    found: dict[str, list[float | int]] = {}
    for key in case.test.baseline:
        if key == SHAPE:
            continue
        by_lay = [values_at(lay.result.report, key) for lay in drapes]
        if not by_lay[0]:
            raise UnfitBaselineError(f"{case.file}: baseline.{key}: no such value was measured")
        for path in by_lay[0]:
            values = [values.get(path) for values in by_lay]
            found[path] = [value for value in values if isinstance(value, (int, float)) and not isinstance(value, bool)]
            if len(found[path]) < len(values):
                raise UnfitBaselineError(f"{case.file}: baseline.{path}: a number is wanted of every lay, came {values}")
    return found


def baseline_of(case: GarmentTestCase, job: Job, drapes: list[Lay], refused: int) -> Baseline:
    """The figures over lays. UnfitBaselineError where a key has no number in some lay, or the lays lie too far apart for a shape."""
    report = {path: figure(numbers, case.test.lays) for path, numbers in numbers_over(case, drapes).items()}
    rms = biggest = None
    if SHAPE in case.test.baseline:
        first, *others = (Surface(lay.result.state.positions, lay.result.cloth.particle_triangles) for lay in drapes)
        apart = [surface_distance(other, first) for other in others]
        rms, biggest = distance_figure([distance.rms_mm for distance in apart]), distance_figure([distance.max_mm for distance in apart])
        if rms.value > SHARE_OF_GRID * job.grid_mm:
            far = f"the lays lie {rms.value:.1f} mm (RMS) apart, more than {SHARE_OF_GRID:g} of the grid: folds fall elsewhere each time"
            remedy = f"take {SHAPE} off the list and keep what does not depend on their place (hem.nodes, hem.drape_coefficient_percent, hem_height_mm)"
            raise UnfitBaselineError(f"{case.file}: baseline.{SHAPE}: {far}; {remedy}")
    return Baseline(
        version=__version__, rule=RULE, lays=len(drapes), refused=refused, setting=setting(case, job), keys=list(case.test.baseline), report=report,
        rms_mm=rms, max_mm=biggest,
    )  # fmt: skip

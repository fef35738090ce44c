"""Garment tests carried out on drapes that are made up: exit codes, JUnit XML, pytest items, baselines over lays, the picture of a difference."""

from __future__ import annotations

import dataclasses
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from command import garmentcad_here
from garment_band import band_spec
from hand_made import cylinder_body, rectangles, tube
from typer.testing import CliRunner

from garmentcad.cli.main import app
from garmentcad.cloth.state import State
from garmentcad.errors import FileError, InputError, SpecError, TangledError
from garmentcad.export.report import blank_report
from garmentcad.export.result_folder import Result
from garmentcad.io.garment_test_file import GarmentTestCase, read_garment_tests
from garmentcad.regression import lays as lays_module
from garmentcad.regression.junit import write_junit
from garmentcad.regression.remake import UnfitBaselineError, remake
from garmentcad.regression.trial import job_of, prepare, run_trial
from garmentcad.simulation.job import Job
from garmentcad.simulation.keeper import Interrupted

ROOT = Path(__file__).resolve().parent.parent
CLOTH = rectangles(30, 20, 0.02, 2, sewn=True)
RUN = CliRunner()
TEST = """\
schema: 1
spec: band.yaml
grid_mm: 30
report: {ease_mm.waist: [15, 25], self_intersections: 0}
baseline: [hem_height_mm, hem.nodes, shape]
"""


def drape_of(hem_mm: float = 600.0, nodes: int = 8, radius_m: float = 0.2, **changes: Any) -> Result:
    """A drape that never was: a tube with a hem at that height."""
    report = blank_report() | {"status": "converged", "self_intersections": 0, "hem_height_mm": hem_mm}
    report |= {"ease_mm": {"bust": None, "waist": 20.0, "hip": None}, "hem": report["hem"] | {"nodes": nodes}} | changes
    positions = tube(CLOTH, 30, 2, lambda row, angle: np.full_like(angle, radius_m), lambda row: 1e-3 * hem_mm + 0.02 * row)
    return Result(report, CLOTH, State(positions, np.zeros_like(positions)), {}, cylinder_body())


Fake = Callable[[Result | BaseException | Callable[[Job], Result]], None]


@pytest.fixture
def drapes(monkeypatch: pytest.MonkeyPatch) -> Fake:
    """Make every drape that one."""

    def fake(made: Result | BaseException | Callable[[Job], Result]) -> None:
        def finish(job: Job, look: object, folder: object) -> tuple[Result, None]:
            if isinstance(made, BaseException):
                raise made
            return (made if isinstance(made, Result) else made(job)), None

        monkeypatch.setattr(lays_module, "finish", finish)

    return fake


def scattered(job: Job) -> Result:
    """A lay: hem and radius by where its panels start."""
    shift = job.pattern.panels["front"].placement.height_mm - 995.0  # type: ignore[union-attr]
    return drape_of(hem_mm=600.0 + 0.02 * shift, radius_m=0.2 + 1e-5 * shift)


def case_in(folder: Path, text: str = TEST) -> GarmentTestCase:
    band_spec(folder)
    path = folder / "band.garment-test.yaml"
    path.write_text(text)
    return read_garment_tests(path)[0]


@pytest.fixture
def case(tmp_path: Path, drapes: Fake) -> GarmentTestCase:
    """A test whose baseline was made."""
    made = case_in(tmp_path)
    drapes(scattered)
    remake(made, 6, lambda said: None)
    return made


def failed(case: GarmentTestCase) -> set[str]:
    return {verdict.key for verdict in run_trial(prepare(case), None).verdicts if not verdict.passed}


def test_what_fails_and_what_does_not(case: GarmentTestCase, drapes: Fake) -> None:
    assert failed(case) == set()
    drapes(drape_of(nodes=9))
    assert failed(case) == set()
    drapes(drape_of(nodes=10))
    assert failed(case) == {"hem.nodes"}
    drapes(drape_of(hem_mm=610.0))  # the shape's hem row is 10 mm away too, of 21 rows of each
    assert failed(case) >= {"hem_height_mm", "shape.max_mm"}
    drapes(drape_of(radius_m=0.21))
    assert failed(case) == {"shape.rms_mm", "shape.max_mm"}
    drapes(drape_of(ease_mm={"bust": None, "waist": 26.0, "hip": None}, self_intersections=1))
    assert failed(case) == {"ease_mm.waist", "self_intersections"}


def test_a_drape_that_did_not_come_to_rest_fails_with_its_status(case: GarmentTestCase, drapes: Fake) -> None:
    drapes(drape_of(status="max_time"))
    (verdict,) = [verdict for verdict in run_trial(prepare(case), None).verdicts if not verdict.passed]
    assert (verdict.key, verdict.expected, verdict.came) == ("status", "converged", "max_time")
    lost = drape_of()
    lost.state.positions[:] = np.nan
    drapes(dataclasses.replace(lost, report=blank_report() | {"status": "diverged"}))
    assert failed(case) == {"status", "ease_mm.waist", "self_intersections", "hem_height_mm", "hem.nodes", "shape.rms_mm", "shape.max_mm"}


def test_a_status_of_its_own(tmp_path: Path, drapes: Fake) -> None:
    case = case_in(tmp_path, "schema: 1\nspec: band.yaml\nreport: {status: max_time}\n")
    drapes(drape_of(status="max_time"))
    assert failed(case) == set()
    drapes(drape_of())
    assert failed(case) == {"status"}


def test_several_lays_are_judged_by_their_mean(tmp_path: Path, drapes: Fake) -> None:
    """A figure whose lays scatter more than it moves: one lay of the changed garment passes, four show it."""
    scatter = np.random.default_rng(0).standard_normal(60)
    seeds = {0: 0}

    def lay(job: Job, shift: float = 0.0) -> Result:
        seeds[0] += 1
        return drape_of(hem_mm=600.0 + 3.0 * scatter[seeds[0]] + shift)

    for count, caught in ((1, False), (8, True)):
        case = case_in(tmp_path, f"schema: 1\nspec: band.yaml\ngrid_mm: 30\nlays: {count}\nbaseline: [hem_height_mm]\n")
        seeds[0] = 0
        drapes(lay)
        remake(case, 10, lambda said: None)
        assert failed(case) == set()
        drapes(lambda job: lay(job, 10.0))
        assert failed(case) == ({"hem_height_mm"} if caught else set())
    # a lay that does not come to rest is named
    begun = iter(["converged", "max_time", *["converged"] * 6])
    drapes(lambda job: drape_of(status=next(begun)))
    assert failed(case) >= {"start 1: status"}


def test_command_exit_codes_table_and_junit(case: GarmentTestCase, drapes: Fake, tmp_path: Path) -> None:
    words = ["test", str(tmp_path), "--quiet", "--junit", str(tmp_path / "j.xml"), "-o", str(tmp_path / "out")]
    good = RUN.invoke(app, words)
    assert (good.exit_code, "1 garment tests, 0 failed" in good.stdout) == (0, True)
    suites = ElementTree.parse(tmp_path / "j.xml").getroot()
    assert (suites.get("tests"), suites.get("failures"), suites.get("errors")) == ("7", "0", "0")
    assert not (tmp_path / "out").exists()
    drapes(drape_of(hem_mm=610.0))
    bad = RUN.invoke(app, words)
    assert bad.exit_code == 4
    assert "FAILS" in bad.stdout
    suite = ElementTree.parse(tmp_path / "j.xml").getroot()[0]
    assert suite.get("name") == "band"
    told = {case.get("name"): case.find("failure") for case in suite.iter("testcase")}
    assert told["hem.nodes"] is None
    failure = told["hem_height_mm"]
    assert failure is not None
    assert "came 610" in (failure.get("message") or "")
    # the failed drape is kept, and drawn beside its baseline
    assert (tmp_path / "out" / "band" / "report.json").exists()
    assert (tmp_path / "out" / "band" / "difference.png").exists()


def test_a_place_for_the_outcome_is_looked_at_before_anything_is_draped(case: GarmentTestCase, drapes: Fake, tmp_path: Path) -> None:
    def draped(job: Job) -> Result:
        raise AssertionError("draped")

    drapes(draped)
    (tmp_path / "file").write_text("a file in the place of the folder")
    run = RUN.invoke(app, ["test", str(tmp_path), "--quiet", "--junit", str(tmp_path / "file" / "j.xml")])
    assert isinstance(run.exception, FileError)
    assert "cannot be the folder" in str(run.exception)


def two_folders(folder: Path) -> None:
    """Two tests of one name, which fail on the drape that is made up."""
    for name in ("a", "b"):
        (folder / name).mkdir()
        case_in(folder / name, "schema: 1\nspec: band.yaml\ngrid_mm: 30\nreport: {hem_height_mm: {value: 10, tol: 1}}\n")


def test_a_key_of_both_report_and_baseline_is_two_cases(tmp_path: Path, drapes: Fake) -> None:
    case = case_in(tmp_path, TEST.replace("report: {", "report: {hem_height_mm: [0, 1000], "))
    drapes(scattered)
    remake(case, 6, lambda said: None)
    write_junit(tmp_path / "j.xml", [run_trial(prepare(case), None)])
    names = [found.get("name") for found in ElementTree.parse(tmp_path / "j.xml").iter("testcase")]
    assert {"hem_height_mm", "hem_height_mm (baseline)"} <= set(names)
    assert len(names) == len(set(names))


def test_a_drape_without_warnings_is_asserted(case: GarmentTestCase, drapes: Fake, tmp_path: Path) -> None:
    quiet = case_in(tmp_path, "schema: 1\nspec: band.yaml\ngrid_mm: 30\nreport: {warnings: []}\n")
    drapes(drape_of(warnings=[]))
    assert failed(quiet) == set()
    drapes(drape_of(warnings=["seam 'side' did not close"]))
    assert failed(quiet) == {"warnings"}


def test_an_older_picture_goes_where_the_failed_drape_has_none(tmp_path: Path, drapes: Fake) -> None:
    two_folders(tmp_path)
    case = read_garment_tests(tmp_path / "a" / "band.garment-test.yaml")[0]
    drapes(drape_of())
    kept = tmp_path / "kept"
    kept.mkdir()
    (kept / "difference.png").write_bytes(b"of an older run")
    run_trial(prepare(case), kept)
    assert (kept / "report.json").exists()
    assert not (kept / "difference.png").exists()


def test_verdicts_are_said_where_the_failed_drape_cannot_be_kept(case: GarmentTestCase, drapes: Fake, tmp_path: Path) -> None:
    (tmp_path / "out").write_text("a file in the place of the folder")
    drapes(drape_of(hem_mm=610.0))
    judged = run_trial(prepare(case), tmp_path / "out" / "band")
    assert "hem_height_mm" in {verdict.key for verdict in judged.verdicts if not verdict.passed}
    assert (judged.refusal, judged.files) == (None, ())
    assert "the failed drape was not kept" in judged.notes[0]


def test_failed_drapes_of_one_name_are_both_kept(drapes: Fake, tmp_path: Path) -> None:
    two_folders(tmp_path)
    drapes(drape_of())
    run = RUN.invoke(app, ["test", str(tmp_path), "--quiet", "--junit", str(tmp_path / "j.xml"), "-o", str(tmp_path / "out")])
    assert run.exit_code == 4
    assert all((tmp_path / "out" / name / "band" / "report.json").exists() for name in ("a", "b"))
    assert [suite.get("name") for suite in ElementTree.parse(tmp_path / "j.xml").getroot()] == ["a/band", "b/band"]
    assert {case.get("classname") for case in ElementTree.parse(tmp_path / "j.xml").iter("testcase")} == {"a/band", "b/band"}


PLAYED = """\
import os
from garmentcad.regression import trial
from garmentcad.simulation.keeper import Interrupted

def run_trial(read, folder):
    print("kept in", folder)
    if os.environ.get("STOP"):
        raise Interrupted("stopped at step 0")
    return trial.Judgement(read.case)

trial.run_trial = run_trial
"""


def test_pytest_tells_folders_apart_and_ends_on_ctrl_c(tmp_path: Path) -> None:
    """A pytest of its own, whose drapes are made up."""
    two_folders(tmp_path)
    (tmp_path / "conftest.py").write_text(PLAYED)
    words = [sys.executable, "-m", "pytest", "-p", "garmentcad.regression.pytest_plugin", "-rA", "-s", "-p", "no:cacheprovider", str(tmp_path)]
    environment = os.environ | {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "NUMBA_NUM_THREADS": "1", "PYTHONPATH": str(ROOT)}
    run = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=600, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    assert [line.split("garment-tests/")[1] for line in run.stdout.splitlines() if "kept in" in line] == ["a/band", "b/band"]
    stopped = subprocess.run(words, cwd=tmp_path, env=environment | {"STOP": "1"}, capture_output=True, text=True, timeout=600, check=False)
    assert (stopped.returncode, stopped.stdout.count("kept in")) == (pytest.ExitCode.INTERRUPTED, 1)
    assert "stopped at step 0" in stopped.stdout


def test_refused_starts_are_errors_and_exit_2(case: GarmentTestCase, drapes: Fake, tmp_path: Path) -> None:
    drapes(TangledError("panels start crossing \x00", key="panels"))
    run = RUN.invoke(app, ["test", str(tmp_path), "--quiet", "--junit", str(tmp_path / "j.xml")])
    assert run.exit_code == 2
    suites = ElementTree.parse(tmp_path / "j.xml").getroot()
    assert (suites.get("tests"), suites.get("failures"), suites.get("errors")) == ("1", "0", "1")


def test_ctrl_c_ends_all_tests_with_its_message_and_130(case: GarmentTestCase, drapes: Fake, tmp_path: Path) -> None:
    (tmp_path / "z.garment-test.yaml").write_text("schema: 1\nspec: band.yaml\ngrid_mm: 30\n")
    drapes(Interrupted("stopped at step 96"))
    run = garmentcad_here("test", str(tmp_path), "--quiet", folder=tmp_path)
    assert (run.returncode, run.stdout, run.stderr) == (130, "", "garmentcad: stopped at step 96\n")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (TEST.replace("ease_mm.waist", "ease_mm.wist"), "report.ease_mm.wist: there is no 'wist' in ease_mm; did you mean 'waist'"),
        (TEST.replace("report: {", "report: {status: convergd, "), "report.status: no drape ends as 'convergd'; did you mean 'converged'"),
        (TEST.replace("report: {", "report: {hem_height_mm: tall, "), "report.hem_height_mm: 'tall' came; a number is wanted here, a range as in"),
        (TEST.replace("report: {", "report: {versions.numpy: 2, "), "report.versions.numpy: 2 came; this value is a word"),
        (TEST.replace("report: {", "report: {fabric: [1, 2], "), "report.fabric: 1 to 2 came; this value is a word"),
        (TEST.replace("self_intersections: 0", "self_intersections: false"), "report.self_intersections: false came; a number is wanted here, a range as in"),
        (TEST.replace("report: {", "report: {uncalibrated: 0, "), "report.uncalibrated: 0 came; this value is true or false"),
        (TEST.replace("report: {", "report: {warnings: 0, "), "report.warnings: 0 came; this value is a list, of which [] can be expected"),
        (TEST.replace("report: {", "report: {constraints.conflicting: none, "), "'none' came; a number is wanted here"),
        (TEST.replace("self_intersections: 0", "self_intersections: []"), "report.self_intersections: [] came; a number is wanted here"),
        (re.sub("baseline: .*", "baseline: []", TEST), "baseline: it names no value"),
        (TEST.replace("hem.nodes,", "hem.node,"), "baseline.hem.node: there is no 'node' in hem; did you mean 'nodes'"),
        (TEST.replace("ease_mm.waist", "fold_deg.front.crease"), "report.fold_deg.front.crease: there is no 'front' in fold_deg. There are none"),
        (TEST.replace("hem.nodes,", "seam_tension.side.max_n_m,"), "baseline.seam_tension.side.max_n_m: there is no 'side' in seam_tension"),
        (TEST.replace("hem.nodes,", "hem.nodes, hem.nodes,"), "z.garment-test.yaml: baseline: hem.nodes stands twice"),
        (TEST.replace("grid_mm: 30", "grid_mm: 25"), "grid_mm: '30' there, '25' here"),
        (TEST.replace("grid_mm: 30", "grid_mm: 0.1"), "z.garment-test.yaml: grid_mm: grid of 0.1 mm; 2 to 50 mm is allowed"),
        (TEST + "max_time_s: 0\n", "z.garment-test.yaml: max_time_s: 0 simulated seconds"),
        (TEST.replace("grid_mm: 30", "fabric: tweed"), "wool-tropical"),
        (TEST.replace("shape", "ease_mm.hip"), "--remake"),
    ],
)
def test_all_is_refused_before_the_first_drape(case: GarmentTestCase, drapes: Fake, tmp_path: Path, text: str, says: str) -> None:
    drapes(AssertionError("draped"))
    (tmp_path / "z.garment-test.yaml").write_text(text)
    (tmp_path / "z.baseline.json").write_bytes(case.baseline_file.read_bytes())
    (tmp_path / "z.baseline.npz").write_bytes(case.baseline_file.with_suffix(".npz").read_bytes())
    run = RUN.invoke(app, ["test", str(tmp_path), "--quiet"])
    assert isinstance(run.exception, InputError)  # `main.run` makes it exit code 2
    assert says in str(run.exception)


def test_a_name_with_a_star_may_mean_words_beside_numbers(tmp_path: Path) -> None:
    report = "report: {'stat*': converged, '*.numpy': '2.0', '*.total': [0, 100], "
    job = job_of(case_in(tmp_path, TEST.replace("report: {", report)))
    assert job.pattern.name == "band"


def test_baselines_are_made_of_lays(tmp_path: Path, drapes: Fake) -> None:
    case = case_in(tmp_path)
    seen: list[float] = []

    def lay(job: Job) -> Result:
        seen.append(job.pattern.panels["front"].placement.height_mm)  # type: ignore[union-attr]
        if len(seen) == 3:
            raise TangledError("this start is no lay")
        return scattered(job)

    drapes(lay)
    baseline = remake(case, 6, lambda said: None)
    assert (baseline.lays, baseline.refused, len(set(seen))) == (6, 1, 7)
    hems = [600.0 + 0.02 * (height - 995.0) for number, height in enumerate(seen) if number != 2]
    assert baseline.report["hem_height_mm"].value == pytest.approx(np.mean(hems), abs=1e-3)
    assert baseline.report["hem_height_mm"].high == pytest.approx(max(hems), abs=1e-3)
    assert baseline.report["hem.nodes"].tol == 1.0
    assert baseline.rms_mm is not None
    assert 0.0 < baseline.rms_mm.value < 0.2


def test_garments_without_a_baseline(tmp_path: Path, drapes: Fake) -> None:
    case = case_in(tmp_path)
    radii = iter(np.linspace(0.2, 0.3, 6))
    for made, says in (
        (drape_of(status="max_time"), "start 0 ended as max_time"),
        (lambda job: drape_of(radius_m=next(radii)), "more than 0.5 of the grid"),
        (drape_of(hem_mm=600.0, hem=dict.fromkeys(("nodes",))), "a number is wanted of every lay"),
    ):
        drapes(made)
        with pytest.raises(UnfitBaselineError, match=says):
            remake(case, 6, lambda said: None)
    assert not case.baseline_file.exists()
    with pytest.raises(SpecError, match="names no keys"):
        remake(case_in(tmp_path, "schema: 1\nspec: band.yaml\n"), 6, lambda said: None)


@pytest.mark.parametrize("lays", [-1, 0, 2, 3, 5])
def test_lays_too_few_for_a_usable_tolerance_are_refused(lays: int, case: GarmentTestCase, drapes: Fake, tmp_path: Path) -> None:
    drapes(AssertionError("draped"))
    run = RUN.invoke(app, ["test", str(tmp_path), "--quiet", "--remake", "--lays", str(lays)])
    assert isinstance(run.exception, InputError)
    assert f"lays: {lays} lays; at least 6 are allowed (of 5 a tolerance is 14.3 standard deviations wide" in str(run.exception)


def test_tolerances_as_large_as_what_they_guard_are_told(tmp_path: Path, drapes: Fake) -> None:
    """Of eight lays (k = 7.5, 8.6 for the seven distances): hems that scatter by 100 mm, radii by 2 mm on a grid of 30."""
    case = case_in(tmp_path)
    said: list[str] = []
    drapes(scattered)
    remake(case, 8, said.append)
    assert not [line for line in said if "warning" in line]
    hems, radii = iter([500.0, 700.0] * 4), iter([0.2, *[0.202, 0.206] * 3, 0.202])
    drapes(lambda job: drape_of(hem_mm=600.0, hem_height_mm=next(hems), radius_m=next(radii)))
    remake(case, 8, said.append)
    told = [line for line in said if "warning" in line]
    assert len(told) == 2
    assert "hem_height_mm: the tolerance, 801, is larger than the value, 600: hardly any change will fail" in told[0]
    assert "shape: the tolerance, 1" in told[1]
    assert "more than 0.5 of the grid" in told[1]


def test_a_baseline_that_no_lay_can_have_costs_no_lays(tmp_path: Path, drapes: Fake) -> None:
    """A key that the report will not have is refused before any test is draped, one without a number ends the first lay."""
    case = case_in(tmp_path)
    (tmp_path / "z.garment-test.yaml").write_text(TEST.replace("hem.nodes", "fold_deg.front.crease"))
    drapes(AssertionError("draped"))
    run = RUN.invoke(app, ["test", str(tmp_path), "--quiet", "--remake"])
    assert isinstance(run.exception, InputError)  # `main.run` makes it exit code 2
    assert "z.garment-test.yaml: baseline.fold_deg.front.crease: there is no" in str(run.exception)
    lays = iter([drape_of(hem_height_mm=None)])
    drapes(lambda job: next(lays))
    with pytest.raises(UnfitBaselineError, match=r"baseline.hem_height_mm: a number is wanted of every lay, came \[None\]"):
        remake(case, 6, lambda said: None)


def test_folds_have_a_baseline_over_several_lays(tmp_path: Path, drapes: Fake) -> None:
    case = case_in(tmp_path, "schema: 1\nspec: band.yaml\ngrid_mm: 30\nlays: 2\nbaseline: [fold_deg.*]\n")
    crease = "internal_lines: {middle: [[100, 0], [100, height]]}\n    folds: [{name: crease, line: middle, angle: 90}]"
    case.spec.write_text(case.spec.read_text().replace("    edges:", f"    {crease}\n    edges:", 1))
    drapes(drape_of(fold_deg={"front.crease": -20.3, "back.crease": -20.3}))
    assert set(remake(case, 6, lambda said: None).report) == {"fold_deg.front.crease", "fold_deg.back.crease"}
    assert failed(case) == set()
    drapes(drape_of(fold_deg={"front.crease": -50.0, "back.crease": -20.3}))
    assert failed(case) == {"fold_deg.front.crease"}


def test_pytest_collects_runs_and_reports(tmp_path: Path) -> None:
    """True drapes of the band in a pytest of its own: one holds, one fails, one is refused, foreign YAML is left alone."""
    case_in(tmp_path, "schema: 1\nspec: band.yaml\ngrid_mm: 30\nreport: {ease_mm.waist: [0, 60], self_intersections: 0, hem_height_mm: {value: 0, tol: 1}}\n")
    (tmp_path / "good.garment-test.yaml").write_text("schema: 1\nspec: band.yaml\ngrid_mm: 30\nreport: {ease_mm.waist: [0, 60], hem.nodes: [0, 3]}\n")
    (tmp_path / "refused.garment-test.yaml").write_text("schema: 1\nspec: band.yaml\nreport: {ease_mm.wist: 0}\n")
    (tmp_path / "foreign.yaml").write_text("a: [")
    words = [sys.executable, "-m", "pytest", "-p", "garmentcad.regression.pytest_plugin", "-rA", "-p", "no:cacheprovider", str(tmp_path)]
    environment = os.environ | {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "NUMBA_NUM_THREADS": "1", "PYTHONPATH": str(ROOT)}
    run = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=1800, check=False)
    assert run.returncode == 1, run.stdout + run.stderr
    assert "1 passed" in run.stdout
    assert "2 failed" in run.stdout
    assert "foreign" not in run.stdout
    assert "garment test band: 1 of 4 assertions failed" in run.stdout
    assert "hem_height_mm: expected 0 ± 1, came 99" in run.stdout
    assert "did you mean 'waist'" in run.stdout
    assert "Traceback" not in run.stdout
    assert (tmp_path / "out" / "garment-tests" / "band" / "report.json").exists()


def test_entry_point_of_the_plugin() -> None:
    text = (ROOT / "pyproject.toml").read_text()
    assert '[project.entry-points.pytest11]\ngarmentcad = "garmentcad.regression.pytest_plugin"' in text

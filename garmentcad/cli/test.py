"""garmentcad test: garments under regression test."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from garmentcad.cli.drape import ProgressLine, allow_threads, set_threads
from garmentcad.errors import InputError

if TYPE_CHECKING:
    from garmentcad.io.garment_test_file import GarmentTestCase
    from garmentcad.regression.trial import Judgement

FOLDER = Path("out") / "garment-tests"


def garment_test(
    paths: Annotated[list[Path], typer.Argument(help="Files or folders: *.garment-test.yaml, or garment specs with tests.")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Where drapes of failed tests and pictures of the difference go.", show_default=str(FOLDER))
    ] = None,
    junit: Annotated[Path | None, typer.Option(help="Write the outcome as JUnit XML.")] = None,
    remake: Annotated[bool, typer.Option("--remake", help="Do not test: make the baselines anew, from several lays each.")] = False,
    lays: Annotated[int | None, typer.Option(help="With --remake: how many lays a baseline is made of, 6 at least.", max=100, show_default="10")] = None,
    threads: Annotated[int | None, typer.Option(help="Threads; the result does not depend on them.", min=1, max=64)] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress line.")] = False,
) -> None:
    """Drape garments and compare what their reports say with what their tests expect. Exit code 0 where all hold, 4 where one fails."""
    if not remake and lays is not None:
        raise InputError("lays are those of a baseline that is made anew; a test says by itself how many it takes (`lays`)", key="--lays")
    for option, path in (("--junit", junit), ("--out", out)):
        if remake and path is not None:
            raise InputError("baselines are written beside their tests, and nothing is tested; leave one of the two out", key=f"--remake {option}")
    if threads is not None:
        allow_threads(threads)

    from garmentcad.io.garment_test_file import find_garment_tests, read_garment_tests

    if threads is not None:
        set_threads(threads)
    cases = [case for path in paths for file in find_garment_tests(path) for case in read_garment_tests(file)]
    if junit is not None:
        from garmentcad.export.result_folder import make_folder

        make_folder(junit.parent)  # before minutes of work, not after
    if remake:
        _remake(cases, lays, quiet)
        return
    judgements = _run(cases, out or FOLDER, quiet)
    if junit is not None:
        from garmentcad.regression.junit import write_junit

        print(write_junit(junit, judgements))
    if any(judged.refusal is not None for judged in judgements):
        raise typer.Exit(2)
    raise typer.Exit(0 if all(judged.passed for judged in judgements) else 4)


def _run(cases: list[GarmentTestCase], out: Path, quiet: bool) -> list[Judgement]:
    """All are read before the first is draped: what is wrong in the last file is said at once."""
    from garmentcad.io.garment_test_file import distinct_names
    from garmentcad.regression.trial import prepare, run_trial

    judgements = []
    for name, trial in zip(distinct_names(cases), [prepare(case) for case in cases]):
        line = ProgressLine(quiet)
        judgements.append(run_trial(trial, out / name, line.show))
        line.end()
        _print(name, judgements[-1])
    failed = sum(not judged.passed for judged in judgements)
    print(f"{len(judgements)} garment tests, {failed} failed")
    return judgements


def _print(name: str, judged: Judgement) -> None:
    from rich.console import Console
    from rich.text import Text

    from garmentcad.export.table import PlainTable

    if judged.refusal is not None:
        print(f"garmentcad: {name}: {judged.refusal}", file=sys.stderr)
        return
    table = PlainTable(f"{name} ({judged.wall_s:.0f} s)", pad_edge=False)
    table.add_column("assertion", no_wrap=True)
    for column in ("expected", "came", "verdict"):
        table.add_column(column)
    for verdict in judged.verdicts:
        table.add_row(verdict.key, verdict.expected, verdict.came, Text("holds", style="green") if verdict.passed else Text("FAILS", style="red"))
    Console().print(table)
    for path in judged.files:
        print(f"  {path}")
    for note in judged.notes:
        print(f"  {note}")


def _remake(cases: list[GarmentTestCase], lays: int | None, quiet: bool) -> None:
    from garmentcad.io.garment_test_file import distinct_names
    from garmentcad.regression.remake import LAYS, remake
    from garmentcad.regression.trial import job_of

    wanted = [case for case in cases if case.test.baseline]
    if not wanted:
        raise InputError("none of these tests names keys of a baseline; there is nothing to make", key="--remake")
    for case in wanted:
        job_of(case)  # what is wrong in the last file is said before the first is draped
    for name, case in zip(distinct_names(wanted), wanted):
        line = ProgressLine(quiet)
        baseline = remake(case, LAYS if lays is None else lays, lambda said, name=name: print(f"{name}: {said}", flush=True), line.show)  # type: ignore[misc]
        line.end()
        for key, figure in {**baseline.report, **{f"shape.{name}": value for name, value in baseline.distances().items()}}.items():
            print(f"  {key}: {figure.value:g} +- {figure.tol:g} (sd {figure.sd:g}, {figure.low:g} to {figure.high:g})")
        print(f"  {case.baseline_file}")

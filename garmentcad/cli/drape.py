"""garmentcad drape: from spec to report and pictures."""

from __future__ import annotations

import json
import os
import sys
import time
from collections import deque
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from garmentcad.cli.named import named_numbers
from garmentcad.errors import InputError

if TYPE_CHECKING:
    from garmentcad.simulation.course import Progress


RATE_OVER_S = 10.0  # how far back the progress line looks to tell how long a simulated second takes


class Mode(StrEnum):
    drape = "drape"
    dynamics = "dynamics"


class Solver(StrEnum):
    steps = "steps"


def drape(
    spec: Annotated[str, typer.Argument(help="A shipped garment (flared-skirt) or a YAML file.")],
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Result folder. Default: out/GARMENT.")] = None,
    fabric: Annotated[str | None, typer.Option(help="A shipped fabric or a KES sheet (YAML), in place of the spec's.")] = None,
    mannequin: Annotated[str | None, typer.Option(help="A shipped mannequin, a measurements file or a scan, in place of the spec's.")] = None,
    grid: Annotated[float, typer.Option(help="Lattice spacing in mm.")] = 10.0,
    threads: Annotated[int | None, typer.Option(help="Threads; the result does not depend on them.", min=1, max=64)] = None,
    seed: Annotated[int, typer.Option(help="Of the 0.01 mm jitter of the start.")] = 0,
    max_time: Annotated[float, typer.Option(help="Most simulated seconds.")] = 20.0,
    max_particles: Annotated[int | None, typer.Option(help="A lattice of more is refused (a million); each takes about 2 kB.")] = None,
    mode: Annotated[Mode, typer.Option(help="drape: the shape at rest; dynamics: true masses and light damping.")] = Mode.drape,
    solver: Annotated[Solver, typer.Option(help="How the drape is solved.")] = Solver.steps,
    pose: Annotated[
        str | None, typer.Option(help="Key frames (a shipped name or a YAML file) that the mannequin goes through once the garment is at rest.")
    ] = None,
    values: Annotated[list[str] | None, typer.Option("--set", help="NAME=NUMBER: a parameter, in place of the spec's value. May stand several times.")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on from the checkpoint in the result folder.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the report as one JSON object and nothing else.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress line.")] = False,
) -> None:
    """Drape a garment on a mannequin: report, meshes and pictures in a folder. Exit code 0 where it came to rest clean, 3 where not."""
    began = time.perf_counter()
    if threads is not None:
        allow_threads(threads)
    from numba.core import event

    from garmentcad.cloth.panel_mesh import PARTICLE_CAP
    from garmentcad.export.drape import finish
    from garmentcad.export.result_folder import CHECKPOINT
    from garmentcad.simulation.job import make_job

    if threads is not None:
        set_threads(threads)
    named = named_numbers(values, "--set")
    with event.install_recorder("numba:compile") as compiled:
        most = PARTICLE_CAP if max_particles is None else max_particles
        job = make_job(spec, fabric, mannequin, grid_mm=grid, seed=seed, mode=mode.value, max_time_s=max_time, max_particles=most, pose=pose, values=named)
        folder = out if out is not None else Path("out") / job.pattern.name
        if not resume and (checkpoint := folder / CHECKPOINT).exists():
            print(f"garmentcad: {checkpoint} is of a run that has not ended; this one begins anew in its place (--resume goes on from there)", file=sys.stderr)
        line = ProgressLine(quiet or as_json)
        result, written = finish(job, line.show, folder, resume)
    line.end()
    if as_json:
        print(json.dumps(result.report, allow_nan=False))
    else:
        _print_result(result.report, written, compile_seconds(compiled.buffer), time.perf_counter() - began)
    moved = result.report.get("movement", {"status": "moved"})["status"] == "moved"
    raise typer.Exit(0 if result.report["status"] == "converged" and moved else 3)


def allow_threads(threads: int) -> None:
    """Numba fixes its pool when it is first imported."""
    if "numba" not in sys.modules:
        os.environ.setdefault("NUMBA_NUM_THREADS", str(max(threads, os.cpu_count() or 1)))


def set_threads(threads: int) -> None:
    """After the program is loaded, which sets how threads wait. InputError for more than numba's pool has."""
    import numba

    most = numba.config.NUMBA_NUM_THREADS  # type: ignore[attr-defined]
    if threads > most:
        raise InputError(f"{threads} came; {most} threads are allowed, as many as NUMBA_NUM_THREADS or the processors", key="--threads")
    numba.set_num_threads(threads)


def compile_seconds(buffer: list) -> float:  # type: ignore[type-arg]
    """Seconds during which at least one kernel was being compiled; compilations nest."""
    total, depth, since = 0.0, 0, 0.0
    for moment, entry in buffer:
        if entry.is_start:
            since = moment if depth == 0 else since
            depth += 1
        else:
            depth -= 1
            total += moment - since if depth == 0 else 0.0
    return total


def _print_result(report: dict, written: object, compile_s: float, total_s: float) -> None:  # type: ignore[type-arg]
    from rich.console import Console

    from garmentcad.export.report import report_table
    from garmentcad.export.result_folder import WrittenFolder

    Console().print(report_table(report))
    if isinstance(written, WrittenFolder):
        for path in written.files:
            print(f"  {path}")
        for note in written.notes:
            print(f"  {note}")
    kinds = f"{report['wall_time_s']['drape']:.1f} s of them drape, in all {compile_s:.1f} s compiling kernels (none the next time)"
    spent = f"{total_s:.1f} s from the command to the last file: {kinds}"
    print(spent)


class ProgressLine:
    """One line on the terminal that is written over; where the output is no terminal, a line every five seconds and at each new phase."""

    def __init__(self, silent: bool) -> None:
        self._silent, self._terminal = silent, sys.stderr.isatty()
        self._last, self._phase = 0.0, ""
        self._looks: deque[tuple[float, float]] = deque()  # wall and simulated s of those that tell how long a simulated second takes now

    def show(self, progress: Progress) -> None:
        now = time.perf_counter()
        if self._looks and self._looks[-1][1] > progress.time_s:
            self._looks.clear()  # the drape began anew
        while len(self._looks) > 1 and self._looks[1][0] < now - RATE_OVER_S:
            self._looks.popleft()
        self._looks.append((now, progress.time_s))
        if self._silent or (progress.phase == self._phase and now - self._last < (0.2 if self._terminal else 5.0)):
            return
        self._last, self._phase = now, progress.phase
        parts = [f"{progress.phase:6}", f"step {progress.step}", f"{progress.time_s:.2f} s"]
        if progress.gap_mm is not None:
            parts.append(f"seams open {progress.gap_mm:.1f} mm")
        if progress.residual_g is not None:
            parts.append(f"residual {progress.residual_g:.1e} g of 1e-3")
        parts.append(f"speed {1e3 * progress.rms_speed_m_s:.1f} mm/s")
        since, from_s = self._looks[0]
        if progress.eta_s is not None and progress.time_s > from_s:
            parts.append(f"about {progress.eta_s * (now - since) / (progress.time_s - from_s):.0f} s to go")
        text = "  ".join(parts)
        print(f"\r\x1b[2K{text}" if self._terminal else text, end="" if self._terminal else "\n", file=sys.stderr, flush=True)

    def end(self) -> None:
        """Leave the line."""
        if not self._silent and self._terminal:
            print(file=sys.stderr)

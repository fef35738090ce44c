"""garmentcad bench: what a drape costs here, beside the least that a step can cost on this machine."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Annotated, Any

import typer

from garmentcad.cli.drape import ProgressLine, allow_threads, compile_seconds, set_threads

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

_FLOOR_THREADS = (1, 2)


def bench(
    case: Annotated[list[str] | None, typer.Option(help="A case, may be repeated. Default: cloth-on-ball (workload W1) and all shipped garments.")] = None,
    grid: Annotated[float, typer.Option(help="Lattice spacing in mm.")] = 10.0,
    fabric: Annotated[str | None, typer.Option(help="Of the garments, in place of the specs' own; cloth-on-ball keeps its own.")] = None,
    threads: Annotated[int | None, typer.Option(help="Threads. Default: one for each core.", min=1, max=64)] = None,
    seed: Annotated[int, typer.Option(help="Of the 0.01 mm jitter of the start.", min=0)] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress line.")] = False,
) -> None:
    """Measure drapes from start to rest, and the machine's floor. Exit code 3 where a case did not come to rest clean."""
    if threads is not None:
        allow_threads(threads)
    from numba.core import event
    from numba.np.ufunc.parallel import get_thread_count

    from garmentcad import __version__
    from garmentcad.bench.cases import case_job, case_names, run_case, share_of_floor, warm_up
    from garmentcad.bench.explicit_step import PARTICLES, floor_us

    if threads is not None:
        set_threads(threads)
    jobs = [case_job(name, grid, fabric, seed) for name in case or case_names()]
    floors = {count: floor_us(count) for count in _FLOOR_THREADS if count <= get_thread_count()}
    warm_up()
    line = ProgressLine(quiet or as_json)
    rows: list[dict[str, Any]] = []
    for job in jobs:
        with event.install_recorder("numba:compile") as compiled:
            row = run_case(job, line.show)
        line.end()
        row["compile_s"] = compile_seconds(compiled.buffer)
        row["floor_share"] = share_of_floor(row, floors[min(row["threads"], max(floors))])
        rows.append(row)
    machine = {"cores": os.cpu_count(), "load": os.getloadavg()[0]}
    floor = {"particles": PARTICLES, "us_per_step": {str(count): value for count, value in floors.items()}}
    if as_json:
        print(json.dumps({"version": __version__, "machine": machine, "floor": floor, "rows": rows}, allow_nan=False))
    else:
        _print(rows, floors, PARTICLES)
    raise typer.Exit(0 if all(row["status"] == "converged" for row in rows) else 3)


def _print(rows: list[dict[str, Any]], floors: dict[int, float], particles: int) -> None:
    from rich.console import Console

    console = Console()
    for group in _fitting(rows, console):
        console.print(_table(group))
    steps = ", ".join(f"{value:.0f} us on {count} thread{'s' if count > 1 else ''}" for count, value in floors.items())
    print(f"floor: the explicit step of {particles} particles with twelve springs takes {steps}")
    late = [f"{row['case']} {row['compile_s']:.1f} s" for row in rows if row["compile_s"] > 0.0]
    if late:
        print(f"kernels were compiled meanwhile ({', '.join(late)}): run again for clean times")


def _fitting(rows: list[dict[str, Any]], console: Console) -> list[list[dict[str, Any]]]:
    """Cases that stand in one table: as many as fit side by side, since what is cut off would be lost."""
    groups: list[list[dict[str, Any]]] = []
    for row in rows:
        wide = console.options.update(max_width=10_000)
        if not groups or console.measure(_table([*groups[-1], row]), options=wide).maximum > console.width:
            groups.append([])
        groups[-1].append(row)
    return groups


def _table(rows: list[dict[str, Any]]) -> Table:
    """Cases as columns: a row of numbers is too long for a terminal."""
    from rich.text import Text

    from garmentcad.export.table import PlainTable

    def number(value: float | None, form: str) -> str:
        return "-" if value is None else f"{value:{form}}"

    table = PlainTable(f"{rows[0]['grid_mm']:g} mm, {rows[0]['threads']} threads", pad_edge=False)
    table.add_column("", style="dim", no_wrap=True)
    for row in rows:
        table.add_column(row["case"], justify="right")
    table.add_row("fabric", *(row["fabric"] for row in rows))
    for label, key, form in _LINES:
        table.add_row(label, *(number(row[key], form) for row in rows))
    for kind in rows[0]["share"]:
        table.add_row(f"{kind}, share of drape", *(f"{row['share'][kind]:.0%}" for row in rows))
    table.add_row("status", *(Text(row["status"], style="green" if row["status"] == "converged" else "red") for row in rows))
    return table


_LINES = (
    ("particles", "particles", "d"),
    ("steps", "steps", "d"),
    ("simulated, s", "simulated_s", ".2f"),
    ("setup wall, s", "setup_wall_s", ".1f"),
    ("drape wall, s", "drape_wall_s", ".1f"),
    ("cpu of all threads, s", "cpu_s", ".1f"),
    ("step, us", "us_per_step", ".0f"),
    ("floor over step", "floor_share", ".1%"),
    ("strain p99, %", "strain_p99_percent", ".2f"),
    ("penetration, mm", "penetration_mm", ".2f"),
    ("self-intersections", "self_intersections", "d"),
    ("with the body", "mannequin_intersections", "d"),
    ("mean height, mm", "mean_height_mm", ".2f"),
    ("residual, g", "residual_g", ".1e"),
)

"""make bench: workload W1 in garmentcad and in other programs on this machine, and docs/studies/bench.md with the ratios.

Every program runs in a process of its own, one after the other, and medians count. A garmentcad run ends at rest; Blender and Newton have no rest test and
run for three simulated seconds. What they leave is judged here by our judges, by the same rules as our own cloth.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from bench.peers.environment import BLENDER, FOLDER, NEWTON, Peer, PeerError, ask, environment
from bench.peers.workload import SIMULATED_S, ball, square, triangles_of
from garmentcad.analysis.penetration import penetration_mm
from garmentcad.bench.cloth_on_ball import NAME
from garmentcad.geometry.intersection import crossing_triangle_pairs
from garmentcad.io.atomic import write_atomic

ROOT = Path(__file__).resolve().parent.parent
PAGE, RAW, SCRATCH = ROOT / "docs" / "studies" / "bench.md", ROOT / "docs" / "studies" / "bench.json", ROOT / "out" / "bench"
HEAD = ("program", "threads", "runs", "wall s", "simulated s", "cpu s", "wall s per simulated s", "wall over ours", "fastest particle at the end mm/s",
        "strain p99 %", "penetration mm", "crossings", "mean height mm")  # fmt: skip

Run = dict[str, Any]


def our_run(grid_mm: float, threads: int) -> Run:
    """One run of W1 in garmentcad; `floor` and `version` come along."""
    command = [sys.executable, "-m", "garmentcad", "bench", "--case", NAME, "--grid", f"{grid_mm:g}", "--threads", str(threads), "--json"]
    said = json.loads(ask(command, allowed=(0, 3)))
    row = said["rows"][0]
    names = {"program": "garmentcad", "version": said["version"], "floor": said["floor"], "machine": said["machine"]}
    return row | names | {"wall_s": row["drape_wall_s"], "crossings": row["self_intersections"]}


def peer_run(peer: Peer, python: Path, grid_mm: float, seconds: float, threads: int, number: int) -> Run:
    """One run of W1 in another program, judged."""
    out = SCRATCH / f"{peer.name}-{number}.json"
    ask([str(python), str(FOLDER / peer.script), "--grid", f"{grid_mm:g}", "--seconds", f"{seconds:g}", "--threads", str(threads), "--out", str(out)])
    run = json.loads(out.read_text())
    with np.load(out.with_suffix(".npz")) as file:
        return run | judged(file["positions"], grid_mm)


def judged(positions: np.ndarray, grid_mm: float) -> Run:
    """Figures of particles (n*n,3) m, z up. The ball of triangles that Blender gets lies inside the round one: nobody is blamed for its facets."""
    start, quads = square(grid_mm)
    triangles = triangles_of(quads)
    count = round(len(start) ** 0.5)
    rows = positions.reshape(count, count, 3)
    lengths = np.concatenate([np.linalg.norm(np.diff(rows, axis=axis), axis=2).ravel() for axis in (0, 1)])
    return {
        "strain_p99_percent": float(np.percentile(100.0 * (lengths / (1e-3 * grid_mm) - 1.0), 99)),
        "penetration_mm": penetration_mm(positions, triangles, *ball(64, 32)),
        "crossings": len(crossing_triangle_pairs(positions, triangles)),
        "mean_height_mm": 1e3 * float(positions[:, 2].mean()),
    }


def summary(runs: list[Run]) -> Run:
    """Medians of the numbers of equal runs; what is no number is taken from the first, the worst of penetration and crossings counts."""
    made = dict(runs[0])
    for name, value in runs[0].items():
        if isinstance(value, int | float):
            made[name] = statistics.median(run[name] for run in runs)
    return made | {"runs": len(runs)} | {name: max(run[name] for run in runs) for name in ("penetration_mm", "crossings")}


def table(rows: Iterable[Run], our_wall_s: float) -> str:
    """Markdown table, one program a row."""
    lines = ["| " + " | ".join(HEAD) + " |", "|" + "---|" * len(HEAD)]
    for row in rows:
        wall, seconds = row["wall_s"], row["simulated_s"]
        cells = (
            f"{row['program']} {row['version']}", f"{row['threads']}", f"{row['runs']}", f"{wall:.1f}", f"{seconds:.2f}", f"{row['cpu_s']:.1f}",
            f"{wall / seconds:.1f}", f"{wall / our_wall_s:.2f}", f"{1e3 * row['largest_speed_m_s']:.1f}", f"{row['strain_p99_percent']:.2f}",
            f"{row['penetration_mm']:.2f}", f"{row['crossings']}", f"{row['mean_height_mm']:.2f}",
        )  # fmt: skip
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def page(ours: Run, peers: list[Run], missing: dict[str, str], grid_mm: float, command: str) -> str:
    """The text of docs/studies/bench.md. command: what made it."""
    floor = ", ".join(f"{value:.0f} us on {count} thread{'s' if count != '1' else ''}" for count, value in ours["floor"]["us_per_step"].items())
    shares = ", ".join(f"{kind} {share:.0%}" for kind, share in ours["share"].items())
    return "\n".join([
        "# Workload W1 beside other programs", "",
        f"Made by `{command}`; `docs/bench.md` says what is measured, `bench.json` has every run.", "",
        f"{ours['machine']['cores']} cores, load {ours['machine']['load']:.1f} (our own included) after our first run. Wall times of a loaded machine are not "
        "those of a free one.", "",
        f"Grid {grid_mm:g} mm, {ours['particles']} particles. garmentcad runs to rest (here: {ours['status']}); the others for their simulated seconds.", "",
        table([ours, *peers], ours["wall_s"]),
        f"garmentcad: {ours['steps']:.0f} steps of {ours['us_per_step']:.0f} us; of the drape's wall time {shares}.", "",
        f"The machine's floor, an explicit step of {ours['floor']['particles']} particles with twelve springs, takes {floor}: "
        f"{ours['floor_share']:.1%} of our step.", "",
        *(f"Not measured: {name} ({message}).\n" for name, message in missing.items()),
    ])  # fmt: skip


def main() -> None:
    """Run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--grid", type=float, default=10.0)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=SIMULATED_S, help="simulated seconds of the others")
    parser.add_argument("--ours", type=int, default=5, help="runs of garmentcad")
    parser.add_argument("--blender", type=int, default=3, help="runs of Blender")
    parser.add_argument("--newton", type=int, default=1, help="runs of Newton")
    parser.add_argument("--blender-python", default="python3.13", help="an interpreter of the version that Blender's module is built for")
    parser.add_argument("--newton-python", default=sys.executable)
    given = parser.parse_args()
    chosen = [f"--{name} {value:g}" for name, value in vars(given).items() if not isinstance(value, str) and value != parser.get_default(name)]
    command = "make bench" + (f' BENCH_OPTIONS="{" ".join(chosen)}"' if chosen else "")

    ours = [say(our_run(given.grid, given.threads)) for _ in range(given.ours)]
    peers: dict[str, list[Run]] = {}
    missing: dict[str, str] = {}
    for peer, python, count in ((BLENDER, given.blender_python, given.blender), (NEWTON, given.newton_python, given.newton)):
        try:
            inside = environment(peer, python) if count else Path()
            runs = [say(peer_run(peer, inside, given.grid, given.seconds, given.threads, number)) for number in range(count)]
        except PeerError as fault:
            missing[peer.name] = str(fault)
            print(f"{peer.name}: {fault}", file=sys.stderr)
            continue
        if runs:
            peers[peer.name] = runs
    text = page(summary(ours), [summary(runs) for runs in peers.values()], missing, given.grid, command)
    write_atomic(RAW, json.dumps({"grid_mm": given.grid, "garmentcad": ours, **peers}, indent=1) + "\n")
    write_atomic(PAGE, text)
    print(text)


def say(run: Run) -> Run:
    """Tell of a finished run, and pass it on."""
    print(f"{run['program']} {run['version']}: {run['wall_s']:.1f} s for {run['simulated_s']:.2f} simulated s", file=sys.stderr, flush=True)
    return run


if __name__ == "__main__":
    main()

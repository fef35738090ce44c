"""How time and memory grow with the number of particles: workload W1, cloth on a ball, each measurement in a process of its own.

Steps: ever larger cloths of one lattice, so that nothing else changes. Drapes: W1 itself on ever finer lattices. `python -m tools.scaling_study` writes
docs/studies/scaling.md; `python -m tools.scaling_study 0.5 1 -- 50 40` takes these sides [m] for steps and, after --, grids [mm] for drapes.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from garmentcad.bench.cases import warm_up
from garmentcad.bench.cloth_on_ball import ball, cloth_on_ball, linear_sheet, square_spec
from garmentcad.fabric.missing import complete
from garmentcad.pattern.draft import draft
from garmentcad.simulation.job import Job
from garmentcad.simulation.run import Outcome, run

PAGE = Path(__file__).resolve().parent.parent / "docs" / "studies" / "scaling.md"
STEP_GRID_MM, SIDES_M = 5.0, (0.5, 1.0, 1.6, 2.5)
DRAPE_GRIDS_MM = (40.0, 20.0, 10.0)
THREADS = (1, 2)
STEPS = 300  # measured
GAP_M = 1e-3  # what contact keeps thin fabrics apart; the 3 mm of W1 nearly reach from particle to particle of the lattice here
FALLEN_S = 0.03  # simulated before: the cloth has just touched the ball
SMALL_M = 0.1  # side of a cloth whose memory is that of the program, its kernels and the ball


def steps_of(side_m: float) -> dict[str, Any]:
    """Time a step of a cloth of `side_m`; the memory that the program takes with a cloth of SMALL_M, and what this one takes beyond."""
    warm_up()
    _fallen(SMALL_M)
    before_mb = _peak_mb()
    outcome = _fallen(side_m)
    dynamics, state = outcome.dynamics, outcome.state
    began = time.perf_counter()
    dynamics.advance(state, STEPS)
    wall = time.perf_counter() - began
    particles = outcome.cloth.particle_count
    pairs = len(state.contact["pair_nodes"])
    return {"particles": particles, "us_per_step": 1e6 * wall / STEPS, "pairs": pairs, "before_mb": before_mb, "memory_mb": _peak_mb() - before_mb}


def _fallen(side_m: float) -> Outcome:
    """A square on the ball, FALLEN_S after it began to fall."""
    spec, body = square_spec(side_m), ball()
    fabrics = {spec.fabric: complete(linear_sheet(GAP_M))}
    job = Job(spec, draft(spec, body.measurements_mm), fabrics, body, STEP_GRID_MM, mode="dynamics", max_time_s=FALLEN_S)
    return run(job, lambda progress: None)


def drape_of(grid_mm: float) -> dict[str, Any]:
    """A whole drape to rest."""
    warm_up()
    began = time.perf_counter()
    outcome = run(cloth_on_ball(grid_mm), lambda progress: None)
    return {"particles": outcome.cloth.particle_count, "status": outcome.status, "steps": outcome.state.step, "wall_s": time.perf_counter() - began}


def _peak_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def measured(what: str, size: float, threads: int) -> dict[str, Any]:
    """One measurement in a fresh process."""
    command = [sys.executable, "-m", "tools.scaling_study", what, str(size)]
    done = subprocess.run(command, env=os.environ | {"NUMBA_NUM_THREADS": str(threads)}, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"exit {done.returncode}: {done.stderr}")
    return dict(json.loads(done.stdout))


def exponent(particles: list[int], values: list[float]) -> float:
    """Slope of the line through the logarithms."""
    return float(np.polyfit(np.log(particles), np.log(values), 1)[0])


def main(sides: tuple[float, ...], drape_grids: tuple[float, ...]) -> None:
    """Run the study and write its page."""
    load = os.getloadavg()[0]
    said = f"`python -m tools.scaling_study`: W1, cloth on a ball (docs/bench.md), {os.cpu_count()} cores, load {load:.1f} before."
    lines = ["# Time and memory against particles", "", said, "", "## Steps", ""]
    case = f"Squares {1e3 * GAP_M:g} mm thick on a lattice of {STEP_GRID_MM:g} mm"
    lines += [f"{case}: {STEPS} steps of dynamics after {FALLEN_S:g} simulated seconds, detection and looks at the stiffness included.", ""]
    lines += [f"Memory is the peak of the process beyond that with a square of {SMALL_M:g} m, which is the program's, its kernels' and the ball's.", ""]
    table = ["| side m | particles | pairs of self-contact and body | threads | us a step | ns a particle and step | program MB | memory MB | kB a particle |"]
    table += ["|---|---|---|---|---|---|---|---|---|"]
    print(table[0], flush=True)
    grown: dict[int, tuple[list[int], list[float]]] = {threads: ([], []) for threads in THREADS}
    for side in sides:
        for threads in THREADS:
            row = measured("steps", side, threads)
            count, step, memory = row["particles"], row["us_per_step"], row["memory_mb"]
            grown[threads][0].append(count)
            grown[threads][1].append(step)
            cells = f"{side:g} | {count} | {row['pairs']} | {threads} | {step:.0f} | {1e3 * step / count:.0f} | {row['before_mb']:.0f}"
            table.append(f"| {cells} | {memory:.0f} | {1024 * memory / count:.1f} |")
            print(table[-1], flush=True)
    lines += [*table, ""]
    lines += [f"{threads} thread(s): the time a step grows with particles to the power {exponent(*grown[threads]):.2f}." for threads in THREADS]
    lines += ["", "## Drapes to rest", ""]
    table = ["| grid mm | particles | status | steps | wall s |", "|---|---|---|---|---|"]
    counts, walls = [], []
    for grid in drape_grids:
        row = measured("drape", grid, THREADS[0])
        counts.append(row["particles"])
        walls.append(row["wall_s"])
        table.append(f"| {grid:g} | {row['particles']} | {row['status']} | {row['steps']} | {row['wall_s']:.1f} |")
        print(table[-1], flush=True)
    lines += [*table, "", f"On {THREADS[0]} thread the wall time to rest grows with particles to the power {exponent(counts, walls):.2f}."]
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    if sys.argv[1:2] == ["steps"] or sys.argv[1:2] == ["drape"]:
        print(json.dumps((steps_of if sys.argv[1] == "steps" else drape_of)(float(sys.argv[2]))))
    elif sys.argv[1:]:
        cut = sys.argv.index("--")
        main(tuple(map(float, sys.argv[1:cut])), tuple(map(float, sys.argv[cut + 1 :])))
    else:
        main(SIDES_M, DRAPE_GRIDS_MM)

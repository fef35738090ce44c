"""The cases of `garmentcad bench`, and the row of numbers of one run."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from garmentcad.bench import cloth_on_ball
from garmentcad.bench.explicit_step import PARTICLES
from garmentcad.cloth.lattice import GRID_MM
from garmentcad.errors import InputError, did_you_mean
from garmentcad.io.shipped import shipped_names
from garmentcad.simulation.course import Progress
from garmentcad.simulation.job import Job, make_job
from garmentcad.simulation.record import record
from garmentcad.simulation.run import run

Row = dict[str, Any]
_KINDS = ("steps", "detection", "stiffness")
_WARM_UP_S = 0.05  # simulated; enough that every kernel of a step has run


def case_names() -> tuple[str, ...]:
    """W1 and the shipped garments."""
    return (cloth_on_ball.NAME, *shipped_names("patterns"))


def case_job(name: str, grid_mm: float, fabric: str | None, seed: int) -> Job:
    """The job of a case. fabric: of the garments, in place of their own; W1 keeps its own. InputError for an unknown name or a grid that is refused."""
    if name not in case_names():
        raise InputError(f"{name[:100]!r} is no case{did_you_mean(name, case_names())}", key="case")
    if name != cloth_on_ball.NAME:
        return make_job(name, fabric, grid_mm=grid_mm, seed=seed)
    if not GRID_MM[0] <= grid_mm <= GRID_MM[1]:
        raise InputError(f"grid of {grid_mm:g} mm; {GRID_MM[0]:g} to {GRID_MM[1]:g} mm is allowed", key="grid_mm")
    return cloth_on_ball.cloth_on_ball(grid_mm, seed)


def warm_up() -> None:
    """Load or compile the kernels of a step by a moment of the coarsest W1, so that no case pays for it."""
    job = cloth_on_ball.cloth_on_ball(GRID_MM[1])
    run(Job(job.spec, job.pattern, job.fabrics, job.mannequin, job.grid_mm, max_time_s=_WARM_UP_S), lambda progress: None)


def run_case(job: Job, look: Callable[[Progress], None]) -> Row:
    """Drape, judge and measure. Shares are of the wall time of the drape; what is left of it are refinement, measures and the course's questions.

    cpu_s: of all threads, setup included; where others use the machine it says more than wall time. mean_height_mm: above the ball's centre, W1 only.
    """
    began = time.process_time()
    outcome = run(job, look)
    cpu = time.process_time() - began
    made, measures = record(outcome)
    wall, steps = made.wall_time_s["drape"], max(1, made.steps)
    # Of warp and weft: what other programs are asked, too; their bias has no limit of its own.
    strains = [p99 for p99 in (measures.strain_percent[way]["p99"] for way in ("warp", "weft")) if p99 is not None]
    return {
        "case": made.garment,
        "fabric": made.fabric,
        "mannequin": made.mannequin,
        "grid_mm": made.grid_mm,
        "threads": made.threads,
        "particles": measures.particles,
        "steps": made.steps,
        "simulated_s": made.simulated_time_s,
        "setup_wall_s": made.wall_time_s["setup"],
        "drape_wall_s": wall,
        "cpu_s": cpu,
        "us_per_step": 1e6 * wall / steps,
        "share": {kind: made.wall_time_s[kind] / wall for kind in _KINDS},
        "strain_p99_percent": max(strains, default=None),
        "penetration_mm": made.mannequin_penetration_mm,
        "self_intersections": made.self_intersections,
        "mannequin_intersections": made.mannequin_intersections,
        "mean_height_mm": cloth_on_ball.mean_height_mm(outcome.state.positions) if made.garment == cloth_on_ball.NAME else None,
        "largest_speed_m_s": made.rest["max_speed_m_s"],
        "residual_g": made.rest["residual_g_rms"],
        "status": made.status,
        "state_sha256": made.state_sha256,
    }


def share_of_floor(row: Row, floor_us: float) -> float:
    """What the floor's step would need for as many particles, over what the row's step took."""
    return floor_us * row["particles"] / PARTICLES / row["us_per_step"]

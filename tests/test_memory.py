"""What a run takes of memory grows with its particles, and little more than that."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

from garmentcad.bench.cloth_on_ball import cloth_on_ball, square_spec
from garmentcad.pattern.draft import draft
from garmentcad.simulation.job import Job
from garmentcad.simulation.run import run

GRID_MM, STEP_S = 5.0, 1e-5  # so little time that the first look ends the run


def square(side_m: float) -> Job:
    job = cloth_on_ball(GRID_MM)
    spec = square_spec(side_m)
    return replace(job, spec=spec, pattern=draft(spec, job.mannequin.measurements_mm), mode="dynamics", max_time_s=STEP_S)


def peak(side_m: float) -> tuple[int, int]:
    """Particles, and the most bytes that Python and numpy held at once."""
    tracemalloc.start()
    try:
        outcome = run(square(side_m), lambda progress: None)
        return outcome.cloth.particle_count, tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_a_particle_takes_less_than_two_kilobytes_at_the_peak() -> None:
    peak(0.1)  # what is made once, kernels among it
    small, large = peak(0.6), peak(0.9)  # trees about as full, and more elements than are taken at a time
    assert (large[1] - small[1]) / (large[0] - small[0]) < 2048.0

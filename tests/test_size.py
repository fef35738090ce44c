"""What a drape will take is told before anything is allocated, and refused above a cap that one can raise."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
import shapely

from garmentcad.errors import LimitError
from garmentcad.fabric.material import material_row
from garmentcad.forces.time_step import SAFETY
from garmentcad.simulation.job import make_job
from garmentcad.simulation.lattices import PARTICLE_BYTES, check_size
from garmentcad.simulation.materials import lay_out
from garmentcad.simulation.run import run

REFUSED = re.compile(r"([\d.]+) m2 at a grid of 20 mm are about ([\d,]+) particles, ([\d.]+) GB and up to ([\d,]+) steps in 20 simulated seconds")


def test_the_estimate_is_that_of_its_area_and_of_its_stiffest_yarn() -> None:
    job = make_job("straight-skirt", grid_mm=20.0, max_particles=100)
    with pytest.raises(LimitError, match=r"grid_mm: .*at most 100 particles are allowed") as refused:
        run(job, lambda progress: None)
    area_m2, particles, gigabytes, steps = (float(number.replace(",", "")) for number in REFUSED.search(str(refused.value)).groups())  # type: ignore[union-attr]
    drawn = [shapely.Polygon([point for edge in panel.edges for point in edge.curve.polyline(0.5)[:-1]]) for panel in job.pattern.panels.values()]
    area_mm2 = sum(polygon.area for polygon in drawn)
    assert area_m2 == pytest.approx(1e-6 * area_mm2, abs=0.006)
    assert particles == pytest.approx(area_mm2 / 400.0, rel=1e-3)
    assert gigabytes == pytest.approx(1e-9 * PARTICLE_BYTES * particles, abs=0.06)
    # A row of links by numpy: the highest frequency of a chain of 400 masses W h^2 with springs of stiffness E between them, in the stiffest of its materials.
    chain = 2.0 * np.eye(400) - np.eye(400, k=1) - np.eye(400, k=-1)
    rows = [
        material_row(completed.sheet, region.factors) for completed in job.fabrics.values() for panel in job.pattern.panels.values() for region in panel.regions
    ]
    rows += [material_row(completed.sheet) for completed in job.fabrics.values()]
    squares = [max(row.tension_slope) / (row.areal_mass * 0.02**2) * np.linalg.eigvalsh(chain)[-1] for row in rows]
    assert steps == pytest.approx(20.0 * np.sqrt(max(squares)) / (2.0 * SAFETY), rel=1e-3)


def test_the_cap_can_be_raised_and_a_lattice_within_it_is_drawn() -> None:
    job = make_job("straight-skirt", grid_mm=50.0, max_time_s=0.01)
    outcome = run(job, lambda progress: None)
    count = outcome.flat.particle_count
    with pytest.raises(LimitError, match=f"at most {count // 2} particles|at most {count // 2} are"):
        run(replace(job, max_particles=count // 2), lambda progress: None)
    run(replace(job, max_particles=2 * count), lambda progress: None)
    huge = replace(job, grid_mm=0.5)
    with pytest.raises(LimitError, match="at most 1,000,000 particles"):
        check_size(huge, lay_out(huge)[0])
    check_size(replace(huge, max_particles=10_000_000), lay_out(huge)[0])

"""The lattices of a run: which it goes through, from coarse to fine, and what the finest of them will cost before anything is allocated."""

from __future__ import annotations

import math

import numpy as np
from shapely.geometry import Polygon

from garmentcad.cloth.gathers import COARSEST_GATHERED_MM, GATHERED
from garmentcad.errors import LimitError
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.time_step import SAFETY
from garmentcad.pattern.pattern import Panel, Pattern
from garmentcad.pattern.runs import side_length
from garmentcad.simulation.job import Job
from garmentcad.units import MM_TO_M

COARSEST_MM = 25.0
# Coarse spacings along the side of a square as large as the largest panel. An estimate: a disc of 240 mm over a pedestal has 6 folds at 10 mm
# (docs/studies/agreement.md), and 4 where it falls at 20 mm.
FEWEST_CELLS = 20.0
# Memory beyond that of the program, as squares of 40,000 to 250,000 particles take it (docs/studies/scaling.md).
PARTICLE_BYTES = 2000


def check_size(job: Job, materials: MaterialTable) -> None:
    """LimitError with what the finest lattice would take, where that is more than `job.max_particles`: the areas decide, before anything is allocated.

    Steps are those of all the simulated time that is allowed, each as long as the stiffest yarn bears: links of mass W h^2 and stiffness E in a row have the
    highest frequency 2 sqrt(E/W)/h. While it falls softened and light, cloth goes in longer ones.
    """
    area_mm2 = sum(_area_mm2(panel) for panel in job.pattern.panels.values())
    count = int(area_mm2 / job.grid_mm**2)
    if count > job.max_particles:
        step_s = SAFETY * MM_TO_M * job.grid_mm / math.sqrt(float((materials.tension_slope.max(axis=1) / materials.areal_mass).max()))
        raise LimitError(
            f"{area_mm2 * 1e-6:.2f} m2 at a grid of {job.grid_mm:g} mm are about {count:,} particles, {count * PARTICLE_BYTES / 1e9:.1f} GB and up to "
            f"{job.max_time_s / step_s:,.0f} steps in {job.max_time_s:g} simulated seconds; at most {job.max_particles:,} particles are allowed "
            "(max_particles raises it)",
            key="grid_mm",
        )


def grids_of(job: Job) -> tuple[float, ...]:
    """Lattice spacings of a run, mm, coarse to fine: drape mode finds folds and seats the garment on lattices that cost an eighth a level, but for pieces
    and gathers whose folds would be too coarse there."""
    coarsest = min(COARSEST_GATHERED_MM if _fullest(job.pattern) > GATHERED else COARSEST_MM, _side_mm(job) / FEWEST_CELLS)
    grids = [job.grid_mm]
    while job.mode == "drape" and 2.0 * grids[0] <= coarsest:
        grids.insert(0, 2.0 * grids[0])
    return tuple(grids)


def is_small(job: Job) -> bool:
    """Whether no coarser lattice would hold the folds of its largest panel. Such a piece costs seconds in true motion, too, and lies in the ridges in which it
    came down: a swatch of 160 mm on a ball ended 3.4 mm from true motion where it fell with soft tension, and at the same place with its own."""
    return _side_mm(job) < 2.0 * job.grid_mm * FEWEST_CELLS


def _side_mm(job: Job) -> float:
    """Side of a square as large as the largest panel."""
    return math.sqrt(max(_area_mm2(panel) for panel in job.pattern.panels.values()))


def _fullest(pattern: Pattern) -> float:
    """Largest ratio of cloth to seam of its seams."""
    lengths = [(side_length(pattern, seam.a), side_length(pattern, seam.b)) for seam in pattern.seams]
    return max((max(pair) / min(pair) for pair in lengths if min(pair) > 0.0), default=1.0)


def _area_mm2(panel: Panel) -> float:
    return float(Polygon(np.vstack([edge.curve.polyline(1.0)[:-1] for edge in panel.edges])).area)

"""Cusick drapemeter: a round specimen hangs over a smaller round disc; its shadow gives the drape coefficient.

The cloth is clamped between two discs, as in the tester: particles up to CLAMPED spacings outside the disc are held, because bending begins at the last
held row, half a spacing before it. It is laid flat with a small random waviness (the lay), falls and settles as a garment does.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import panel_cloth
from garmentcad.cloth.state import State
from garmentcad.contact.contact import Contact
from garmentcad.errors import InputError
from garmentcad.fabric.material import MaterialTable, softened
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.geometry.curve import Arc
from garmentcad.pattern.pattern import Edge, Panel, Transform
from garmentcad.rigs.shadow import Shadow, cast_shadow, drape_coefficient
from garmentcad.simulation.course import Course, Progress
from garmentcad.solve.dynamics import Dynamics
from garmentcad.solve.strain_limit import strain_limit
from garmentcad.units import M_TO_MM, MM_TO_M

CLAMPED = 0.75
WAVINESS_MM = 0.5  # greatest height of a lay
WAVES = 12  # of the waviness around the specimen
LAYS = 5
MAX_TIME_S = 20.0


class Geometry(NamedTuple):
    """Diameters in mm."""

    disc_mm: float
    specimen_mm: float


GEOMETRIES = {"18/24": Geometry(180.0, 240.0), "18/30": Geometry(180.0, 300.0), "18/36": Geometry(180.0, 360.0), "12.7/25.4": Geometry(127.0, 254.0)}
USUAL = "18/30"


@dataclass(frozen=True)
class Drape:
    """One lay at rest. status: converged or max_time; lowest_mm: how far the lowest point lies below the disc."""

    status: str
    cloth: Cloth
    state: State
    shadow: Shadow
    dc_percent: float
    lowest_mm: float


def drape_test(
    materials: MaterialTable,
    grid_mm: float,
    seed: int,
    geometry: str = USUAL,
    origin_mm: tuple[float, float] | None = None,
    look: Callable[[Progress], None] = lambda progress: None,
) -> Drape:
    """Drape the fabric in row 0 of `materials`. seed: of the lay; the same seed gives the same waviness on any lattice. InputError for an unknown geometry."""
    if geometry not in GEOMETRIES:
        raise InputError(f"no drapemeter {geometry!r}; allowed are {', '.join(GEOMETRIES)} cm")
    disc_mm, specimen_mm = GEOMETRIES[geometry]
    cloth = panel_cloth(_disc(0.5 * specimen_mm), materials, grid_mm=grid_mm, origin_mm=origin_mm)
    place = MM_TO_M * cloth.vertex_uv_mm
    radius = np.linalg.norm(place, axis=1)
    held = 0.5 * disc_mm * MM_TO_M + CLAMPED * cloth.spacing
    # right side up: warp along -z, weft along x
    positions = np.column_stack([place[:, 0], _waviness(place, held, seed), -place[:, 1]])

    def forces_at(softness: float) -> ForceAssembly:
        return ForceAssembly(internal_forces(cloth, softened(materials, softness)), cloth.particle_count, [ForceGravity(cloth.masses)])

    dynamics = Dynamics(cloth, forces_at(1.0), strain_limit(cloth, materials), Contact(cloth, materials), fixed=radius <= held)
    state = State(positions, np.zeros_like(positions), phase="fall", run={"phase_from_s": 0.0})
    dynamics.start(state)
    status = Course(dynamics, forces_at, "drape", MAX_TIME_S).run(state, look)
    shadow = cast_shadow(state.positions, cloth.particle_triangles)
    coefficient = drape_coefficient(shadow.area_m2, disc_mm, specimen_mm)
    return Drape(status, cloth, state, shadow, coefficient, -M_TO_MM * float(state.positions[:, 1].min()))


def _disc(radius_mm: float) -> Panel:
    right, left = (radius_mm, 0.0), (-radius_mm, 0.0)
    edges = (Edge("upper", "right", "left", Arc(right, left, (0.0, 0.0), False)), Edge("lower", "left", "right", Arc(left, right, (0.0, 0.0), False)))
    return Panel("specimen", edges, 0.0, Transform((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))


def _waviness(place: np.ndarray, held: float, seed: int) -> np.ndarray:
    """Heights (P,) m of a lay: waves around the specimen of random height and phase that grow from the clamp to the rim."""
    rng = np.random.default_rng(seed)
    heights, phases = rng.standard_normal(WAVES), rng.uniform(0.0, 2.0 * math.pi, WAVES)
    angle, radius = np.arctan2(place[:, 1], place[:, 0]), np.linalg.norm(place, axis=1)
    waves = sum(height * np.cos((k + 1) * angle + phase) for k, (height, phase) in enumerate(zip(heights, phases)))
    grown = np.clip((radius - held) / (radius.max() - held), 0.0, None)
    return np.asarray(WAVINESS_MM * MM_TO_M * waves * grown / np.abs(heights).sum())

"""Bias extension: a specimen cut at 45 degrees, three times as long as wide, is pulled between clamps; its middle shears as a trellis.

Yarns of the middle zone end on no clamp. If they neither stretch nor slip, kinematics alone give the shear angle there,

    gamma = 90 degrees - 2 acos((L0 + d)/(sqrt2 L0)),     L0 = length - width,     d the way of the clamp,

and what a camera sees beside it says how far that holds. Source: Cao et al. 2008, Composites Part A 39(6) 1037-1053 (benchmark of trellis tests).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from garmentcad.errors import InputError
from garmentcad.fabric.material import MaterialTable
from garmentcad.rigs.specimen import ANGLES, Specimen
from garmentcad.units import MM_TO_M

WIDTH_MM, LENGTH_MM = 50.0, 150.0
LONGEST_STEP_MM = 2.5
LOCKED_MM = (math.sqrt(2.0) - 1.0) * (LENGTH_MM - WIDTH_MM)  # way of the clamp at 90 degrees of shear
_CAMERA = 0.25  # of the width: half the side of the square that is looked at


class Extension(NamedTuple):
    """At one way of the clamp: force [N/m] per width of the specimen, shear angle [deg] seen in its middle, and that of the kinematics."""

    way_mm: float
    force_n_m: float
    seen_deg: float
    kinematic_deg: float


def kinematic_deg(way_mm: float) -> float:
    """Shear angle of yarns that neither stretch nor slip, for a way of 0 to 41.4 mm, at which they lie along each other. InputError for others."""
    if not 0.0 <= way_mm <= LOCKED_MM:
        raise InputError(f"a way of {way_mm:g} mm; 0 to {LOCKED_MM:.1f} mm are allowed, where yarns that do not stretch lie along each other", key="ways_mm")
    free = LENGTH_MM - WIDTH_MM
    return 90.0 - 2.0 * math.degrees(math.acos((free + way_mm) / (math.sqrt(2.0) * free)))


def bias_extension(materials: MaterialTable, grid_mm: float, ways_mm: Iterable[float]) -> list[Extension]:
    """Pull the fabric in row 0 of `materials` to each of these ways, one after the other. InputError for a way that is none of 0 to 41.4 mm, and for a lattice
    of more than 12.5 mm, of which the camera sees too few yarns."""
    ways_mm, widest = list(ways_mm), _CAMERA * WIDTH_MM
    kinematic = [kinematic_deg(way) for way in ways_mm]
    if not 0.0 < grid_mm <= widest:
        raise InputError(f"a lattice of {grid_mm:g} mm; more than 0 and at most {widest:g} mm are allowed", key="grid_mm")
    # Yarns run from a corner, where clamp and free edge meet: there the middle zone begins.
    specimen = Specimen(materials, WIDTH_MM, LENGTH_MM, grid_mm, ANGLES["bias"], (0.0, 0.0), stays_flat=True)
    lower, upper = specimen.ends
    modes = specimen.modes([lower, upper])
    off_middle = specimen.rest[:, :2] - MM_TO_M * np.array([0.5 * WIDTH_MM, 0.5 * LENGTH_MM])
    seen = np.abs(off_middle).max(axis=1) <= _CAMERA * MM_TO_M * WIDTH_MM
    unknowns, way, found = np.zeros(modes.shape[1]), 0.0, []
    for wanted, angle_deg in zip(ways_mm, kinematic):
        steps = max(1, math.ceil(abs(wanted - way) / LONGEST_STEP_MM))
        for pulled in np.linspace(way, wanted, steps + 1)[1:]:
            given = specimen.rest.copy()
            given[upper, 1] += MM_TO_M * pulled
            unknowns = specimen.balance.solve(given, modes, unknowns)
            positions = given + (modes @ unknowns).reshape(-1, 3)
            reaction = -specimen.balance.keep(positions)[upper, 1].sum()
        way = wanted
        found.append(Extension(way, float(reaction / specimen.width), _trellis_deg(off_middle[seen], positions[seen, :2]), angle_deg))
    return found


def _trellis_deg(rest: np.ndarray, positions: np.ndarray) -> float:
    """90 degrees minus the angle between two yarns at 45 degrees to the length, from the linear map that fits best."""
    columns = np.column_stack([np.ones(len(rest)), rest])
    gradient = np.linalg.lstsq(columns, positions, rcond=None)[0][1:].T
    one, other = gradient @ [1.0, 1.0], gradient @ [-1.0, 1.0]
    return math.degrees(math.asin(float(one @ other) / (np.linalg.norm(one) * np.linalg.norm(other))))

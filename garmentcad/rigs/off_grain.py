"""Small-strain stiffness of wide clamped specimens cut at any angle to the grain, and what an orthotropic sheet without Poisson effect has.

    tension  E1 c^4 + E2 s^4 + 4 G s^2 c^2        shear  (E1 + E2) s^2 c^2 + G (c^2 - s^2)^2        [N/m]

c, s cosine and sine of the angle between the specimen's length and warp. Both clamps hold their particles in either direction. The formulas hold away from the
free edges, over which yarns end that no clamp holds; two specimens of different width have the same edges, so that what the wider one bears more is borne by
cloth that the edges do not reach.
Source: plane stress of an orthotropic sheet turned about its normal, nu = 0 (Jones, Mechanics of Composite Materials).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from garmentcad.cloth.cloth import WARP, WEFT
from garmentcad.fabric.material import MaterialTable
from garmentcad.rigs.specimen import Specimen
from garmentcad.units import MM_TO_M

GAUGE_MM = 50.0
WIDTHS_MM = (200.0, 400.0)  # yarns at 60 degrees to the length leave 87 mm at either edge
STRAIN = 1e-5


class Stiffness(NamedTuple):
    """N/m: force per width over strain, and over angle."""

    tension: float
    shear: float


def clamped_stiffness(materials: MaterialTable, angle_deg: float, grid_mm: float, origin_mm: tuple[float, float] | None = None) -> Stiffness:
    """Of the fabric in row 0 of `materials`, from the reactions of one clamp that is moved along and across a specimen by STRAIN of its length."""
    borne = np.array([_borne(Specimen(materials, width, GAUGE_MM, grid_mm, angle_deg, origin_mm, stays_flat=True)) for width in WIDTHS_MM])
    return Stiffness(*((borne[1] - borne[0]) / (MM_TO_M * (WIDTHS_MM[1] - WIDTHS_MM[0]))))


def _borne(specimen: Specimen) -> tuple[float, float]:
    """Force [N] over strain and over angle of a whole specimen."""
    lower, upper = specimen.ends
    modes = specimen.modes([lower, upper])
    found = []
    for axis in (1, 0):
        given = specimen.rest.copy()
        given[upper, axis] += STRAIN * GAUGE_MM * MM_TO_M
        change = modes @ specimen.balance.solve(given, modes, np.zeros(modes.shape[1]))
        found.append(-float(specimen.balance.forces(given + change.reshape(-1, 3))[upper, axis].sum()) / STRAIN)
    return found[0], found[1]


def sheet_stiffness(materials: MaterialTable, angle_deg: float) -> Stiffness:
    """What the formulas give for row 0 of `materials`, from its slopes at rest."""
    c2 = math.cos(math.radians(angle_deg)) ** 2
    s2 = 1.0 - c2
    warp, weft, trellis = materials.tension_slope[0, WARP], materials.tension_slope[0, WEFT], materials.shear[0]
    return Stiffness(
        float(warp * c2 * c2 + weft * s2 * s2 + 4.0 * trellis * s2 * c2),
        float((warp + weft) * s2 * c2 + trellis * (c2 - s2) ** 2),
    )

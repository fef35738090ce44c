"""KES-FB1 shear: a specimen 20 cm wide between clamps 5 cm apart, under 10 gf/cm, is sheared to 8 degrees on either side.

One clamp slides sideways and keeps the tension by moving along. The angle is that of the line between the clamps. Of the sideways reaction per width the
part is taken off that the tension has by leaning, F - T tan(angle): the tester's own correction (Kawabata 1980); of inextensible yarns G angle/cos(angle)
is left.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from garmentcad.fabric.material import MaterialTable
from garmentcad.rigs.loop import Branch, Loop
from garmentcad.rigs.specimen import Specimen
from garmentcad.units import GF_CM_TO_N_M, MM_TO_M

WIDTH_MM, GAUGE_MM = 200.0, 50.0
TENSION_GF_CM = 10.0
ANGLES_DEG = (0.0, 0.25, 0.5, 1.0, 1.5, 2.5, 3.5, 5.0, 6.5, 8.0)  # where a record has its points, those among them that values are read at


def shear_test(materials: MaterialTable, angle_deg: float, grid_mm: float, origin_mm: tuple[float, float] | None = None, sides: int = 2) -> Loop:
    """Shear angle [deg] and force [gf/cm] over a whole cycle; sides: 1 for its first half."""
    specimen = Specimen(materials, WIDTH_MM, GAUGE_MM, grid_mm, angle_deg, origin_mm, stays_flat=True)
    lower, upper = specimen.ends
    modes = specimen.modes([lower, upper], [(upper, 1)])
    load = np.zeros(modes.shape[1])
    load[-1] = TENSION_GF_CM * GF_CM_TO_N_M * specimen.width
    gauge = GAUGE_MM * MM_TO_M
    unknowns = specimen.balance.solve(specimen.rest, modes, np.zeros(len(load)), load)
    leaning = 0.0

    def branch(angles: Iterable[float]) -> Branch:
        nonlocal unknowns, leaning
        points = []
        for degrees in angles:
            tangent = math.tan(math.radians(degrees))
            # the guess: every particle goes along with the line between the clamps
            along = specimen.rest[:, 1:2] * np.array([[1.0, 0.0, 0.0]])
            unknowns = unknowns + (tangent - leaning) * _in_modes(modes, along)
            leaning = tangent
            given = specimen.rest.copy()
            given[upper, 0] += gauge * tangent
            unknowns = specimen.balance.solve(given, modes, unknowns, load)
            reaction = specimen.balance.keep(given + (modes @ unknowns).reshape(-1, 3))[lower].sum(axis=0) / (specimen.width * GF_CM_TO_N_M)
            sheared = gauge * tangent / (gauge + unknowns[-1])
            points.append((math.degrees(math.atan(sheared)), reaction[0] - reaction[1] * sheared))
        return Branch(*np.array(points).T)

    rising = np.array(ANGLES_DEG)
    ways = (rising, rising[::-1], -rising, -rising[::-1])
    return Loop(*(branch(way) for way in ways[: 2 * sides]))


def _in_modes(modes, displacement: np.ndarray) -> np.ndarray:  # type: ignore[no-untyped-def]
    """A displacement (P,3) of the free particles as a change of the unknowns."""
    change = modes.T @ displacement.ravel()
    change[-1] = 0.0
    return np.asarray(change)


def printed_shear(loop: Loop, window_deg: tuple[float, float]) -> dict[str, float]:
    """G (gf/(cm.deg)), 2HG and 2HG5 (gf/cm) of the record."""
    return {"G": loop.slope(window_deg), "2HG": loop.width(0.5), "2HG5": loop.width(5.0)}

"""KES-FB1 shear: a specimen 20 cm wide between clamps 5 cm apart, under 10 gf/cm, is sheared to 8 degrees on either side.

One clamp slides sideways and keeps the tension by moving along. The angle is that of the line between the clamps. Of the sideways reaction per width the
part is taken off that the tension has by leaning, F - T tan(angle): the tester's own correction (Kawabata 1980); of inextensible yarns G angle/cos(angle)
is left.

What such a specimen prints of its law has a closed form, `clamped_share`: under the tester's tension it is 1 + e times as long between the clamps, and along
its free edges no shear is carried. There cross yarns follow the clamps while the others give way along themselves, E v_yy + G v_xx = 0 with v = 0 at the
clamps and v_x = -gamma at the edge: v = sum over odd n of 4 gamma/(n pi k) exp(-k x) sin(n pi y/L), k = (n pi/L) sqrt(E/G), which takes its mean over y from
either edge,

    printed/law = (1 - 14 zeta(3)/pi^3 (L/b) sqrt(G/E))/(1 + e),    L = 5 cm, b = 20 cm; e, E strain and tangent of the tensile curve at 10 gf/cm.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from scipy.special import zeta

from garmentcad.cloth.cloth import WARP, WEFT
from garmentcad.fabric.law_shear import HIGH, LOW
from garmentcad.fabric.law_tension import loading, strain_at_force
from garmentcad.fabric.material import MaterialTable
from garmentcad.rigs.loop import Branch, Loop
from garmentcad.rigs.specimen import Specimen
from garmentcad.units import GF_CM_TO_N_M, MM_TO_M

WIDTH_MM, GAUGE_MM = 200.0, 50.0
TENSION_GF_CM = 10.0
# Where a record has its points, those among them that values are read at; of the specimen as the tension has it, for a power net is half as long again then. It
# becomes shorter as it is sheared, and the angles a little larger.
ANGLES_DEG = (0.0, 0.25, 0.5, 1.0, 1.5, 2.5, 3.5, 5.0, 6.5, 8.0)


def shear_test(materials: MaterialTable, angle_deg: float, grid_mm: float, origin_mm: tuple[float, float] | None = None, sides: int = 2) -> Loop:
    """Shear angle [deg] and force [gf/cm] over a whole cycle; sides: 1 for its first half."""
    specimen = Specimen(materials, WIDTH_MM, GAUGE_MM, grid_mm, angle_deg, origin_mm, stays_flat=True)
    lower, upper = specimen.ends
    modes = specimen.modes([lower, upper], [(upper, 1)])
    load = np.zeros(modes.shape[1])
    load[-1] = TENSION_GF_CM * GF_CM_TO_N_M * specimen.width
    gauge = GAUGE_MM * MM_TO_M
    unknowns = specimen.balance.solve(specimen.rest, modes, np.zeros(len(load)), load)
    tensioned, leaning = gauge + unknowns[-1], 0.0

    def branch(angles: Iterable[float]) -> Branch:
        nonlocal unknowns, leaning
        points = []
        for degrees in angles:
            tangent = math.tan(math.radians(degrees)) * tensioned / gauge
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


def clamped_share(materials: MaterialTable) -> tuple[float, float]:
    """What the tester prints over what the law has, warp and weft, of row 0 of `materials`, by the closed form above; to first order in the edges' loss."""
    low, high = materials.shear_friction[0]
    slope = float(materials.shear[0] + (high - low) / (HIGH - LOW))  # of loading, as printed
    return _share(materials, WARP, slope), _share(materials, WEFT, slope)


def _share(materials: MaterialTable, way: int, slope: float) -> float:
    em, fm, exponent, initial = (
        float(column[0, way]) for column in (materials.tension_strain, materials.tension_force, materials.tension_exponent, materials.tension_slope)
    )
    strain = strain_at_force(TENSION_GF_CM * GF_CM_TO_N_M, em, fm, exponent)
    tangent = loading(strain, em, fm, exponent, initial)[1]
    edges = 14.0 * zeta(3) / math.pi**3 * GAUGE_MM / WIDTH_MM * math.sqrt(slope / tangent)
    return float((1.0 - edges) / (1.0 + strain))

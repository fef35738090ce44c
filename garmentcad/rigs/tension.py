"""KES-FB1 tension: a specimen 20 cm wide between clamps 5 cm apart is pulled up to Fm and let go.

The clamps hold the short edges in both directions; the upper one follows the pull. Force per width is the reaction of the lower clamp, strain
the way of the upper one over the gauge. Source: Kawabata 1980.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from garmentcad.fabric.material import MaterialTable
from garmentcad.rigs.loop import Branch
from garmentcad.rigs.specimen import Specimen
from garmentcad.units import GF_CM_TO_N_M, MM_TO_M

WIDTH_MM, GAUGE_MM = 200.0, 50.0
POINTS = 16  # on each way


def tension_test(
    materials: MaterialTable, angle_deg: float, grid_mm: float, fm_gf_cm: float, origin_mm: tuple[float, float] | None = None
) -> tuple[Branch, Branch]:
    """Strain [%] and force [gf/cm] of the way up to Fm and of the way back."""
    specimen = Specimen(materials, WIDTH_MM, GAUGE_MM, grid_mm, angle_deg, origin_mm, stays_flat=True)
    lower, upper = specimen.ends
    modes = specimen.modes([lower, upper], [(upper, 1)])
    unknowns = np.zeros(modes.shape[1])
    load = np.zeros(len(unknowns))

    def branch(forces: Iterable[float]) -> Branch:
        nonlocal unknowns
        points = []
        for force in forces:
            load[-1] = force * GF_CM_TO_N_M * specimen.width
            unknowns = specimen.balance.solve(specimen.rest, modes, unknowns, load)
            reaction = specimen.balance.keep(specimen.rest + (modes @ unknowns).reshape(-1, 3))[lower, 1].sum()
            points.append((100.0 * unknowns[-1] / (GAUGE_MM * MM_TO_M), reaction / specimen.width / GF_CM_TO_N_M))
        return Branch(*np.array(points).T)

    # close together where a soft curve begins
    rising = fm_gf_cm * np.linspace(0.0, 1.0, POINTS + 1) ** 2
    return branch(rising), branch(rising[::-1])


def printed_tension(out: Branch, back: Branch) -> dict[str, float]:
    """LT (-), WT (gf.cm/cm2), RT (%), EMT (%) of the record."""
    emt, energy = float(out.x[-1]), out.energy() / 100.0
    return {"LT": energy / (0.005 * emt * float(out.y[-1])), "WT": energy, "RT": -back.energy() / energy, "EMT": emt}

"""How far a fabric extends along any direction under a force per width."""

from __future__ import annotations

import numpy as np

from garmentcad.fabric.law_tension import strain_at_force
from garmentcad.fabric.material import STRAIN_LIMIT_FORCE, MaterialTable

LOCKED = np.radians(30.0)  # trellis angle at which the yarns of a woven cloth meet; an estimate, testers shear to 8 degrees


def extension(materials: MaterialTable, row: int, along_warp: float, force: float) -> float:
    """Strain of a strip that is pulled with `force` (N/m, at most what the strain limit of the sheet stands for) at an angle of cosine `along_warp` to warp.

    The pull splits into tension along warp and weft and shear (free width): e = c^2 e_warp(T c^2) + s^2 e_weft(T s^2) + c^2 s^2 T/G.
    """
    pulled = min(force, STRAIN_LIMIT_FORCE * float(materials.tension_force[row].max()))
    share = min(1.0, along_warp**2)
    strain = 0.0
    for axis, part in enumerate((share, 1.0 - share)):
        em, fm, exponent = (float(column[row, axis]) for column in (materials.tension_strain, materials.tension_force, materials.tension_exponent))
        strain += part * strain_at_force(part * pulled, em, fm, exponent)
    across = np.sqrt(share * (1.0 - share))
    return float(strain + across * min(across * pulled / float(materials.shear[row]), LOCKED))

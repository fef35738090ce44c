"""Material table: one row per fabric (or per region of a fabric with factors), SI, as arrays that kernels read."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class MaterialTable(NamedTuple):
    """Rows of law values. Column 0 is warp, 1 is weft where a second axis stands."""

    areal_mass: np.ndarray  # (M,) kg/m2
    tension_strain: np.ndarray  # (M,2) em = EMT/100 at Fm
    tension_force: np.ndarray  # (M,2) Fm, N/m
    tension_exponent: np.ndarray  # (M,2) x of F = Fm (exp(x u) - 1)/(exp(x) - 1), u = e/em; 0 is linear
    strain_limit: np.ndarray  # (M,2) strain at 1.5 Fm
    shear: np.ndarray  # (M,) N/m per rad
    bending: np.ndarray  # (M,2) N.m
    twist: np.ndarray  # (M,) D66 = max(0, B_bias - (B_warp + B_weft)/4), N.m
    thickness: np.ndarray  # (M,) T0, m
    friction_body: np.ndarray  # (M,) fabric on body
    friction_cloth: np.ndarray  # (M,) fabric on fabric

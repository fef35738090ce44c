"""Tension of the cloth along its yarns, from its strain and the KES tensile curve."""

from __future__ import annotations

import numpy as np

from garmentcad.analysis.strain import YarnStrain, weighted_quantile
from garmentcad.fabric.material import MaterialTable


def tension_n_m(strain: np.ndarray, material: np.ndarray, materials: MaterialTable, direction: int) -> np.ndarray:
    """Tension (E,) N/m at strains (E,) of the given material rows.

    F = Fm (exp(x u) - 1) / (exp(x) - 1), u = e / em (KES-FB1 loading curve); the tangent at em beyond it, the initial slope below rest.
    Written a second time beside the law of the solver, on purpose: a map that called the solver's law could not contradict it.
    """
    em = materials.tension_strain[material, direction]
    fm = materials.tension_force[material, direction]
    x = materials.tension_exponent[material, direction]
    u = strain / em
    linear = np.abs(x) < 1e-8
    safe = np.where(linear, 1.0, x)
    inside = np.clip(u, 0.0, 1.0)
    curve = np.where(linear, inside, np.expm1(safe * inside) / np.expm1(safe))
    slope = np.where(linear, 1.0, safe * np.exp(safe * inside) / np.expm1(safe))
    return fm * (curve + slope * (u - inside))


def tension_summary(part: YarnStrain, materials: MaterialTable, direction: int) -> dict[str, float | None]:
    """{p50, p99, max} of the tension along `direction` (WARP or WEFT), N/m, weighted by area; None for a cloth without such elements."""
    tension = tension_n_m(part.strain, part.material, materials, direction)
    quantiles = {f"p{percent}": weighted_quantile(tension, part.area, percent / 100.0) for percent in (50, 99)}
    return quantiles | {"max": float(tension.max()) if len(tension) else None}

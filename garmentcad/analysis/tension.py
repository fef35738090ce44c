"""Tension of the cloth along its yarns, from its strain and the KES tensile curve."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from garmentcad.analysis.strain import YarnStrain, element_panels, share_of_limit, weighted_quantile, yarn_strain
from garmentcad.cloth.cloth import WARP, WEFT, Cloth
from garmentcad.fabric.material import MaterialTable

AT_LIMIT, MANY_AT_LIMIT = 0.95, 0.01  # of the strain limit, and of a panel's area: estimates


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


def carried_strain(cloth: Cloth, positions: np.ndarray, direction: int) -> YarnStrain:
    """Strain along `direction` (WARP or WEFT) that carries tension, at positions (P,3) m: of every link, and at every corner of every border triangle the mean
    over the patch of triangles that the law averages, because single border triangles zigzag without force."""
    yarns, border = yarn_strain(cloth, positions, direction), cloth.border
    links = len(yarns.strain) - len(border.area)
    patch_of = np.repeat(np.arange(len(border.patch_start) - 1), np.diff(border.patch_start))
    area = border.area[border.patch_triangle]
    sums = np.bincount(patch_of, area * yarns.strain[links:][border.patch_triangle], len(border.patch_start) - 1)
    mean = sums / np.maximum(np.bincount(patch_of, area, len(sums)), 1e-300)
    corners = border.corners.ravel()
    return YarnStrain(
        strain=np.concatenate([yarns.strain[:links], mean[border.patch.ravel()]]),
        area=np.concatenate([yarns.area[:links], np.repeat(border.area / 3.0, 3)]),
        material=np.concatenate([yarns.material[:links], border.patch_material[border.patch.ravel()]]),
        particles=np.concatenate([yarns.particles[:links], np.repeat(corners[:, None], 3, axis=1)]),
        share=np.concatenate([yarns.share[:links], np.tile([1.0, 0.0, 0.0], (len(corners), 1))]),
    )


def panels_at_limit(cloth: Cloth, positions: np.ndarray, materials: MaterialTable) -> dict[str, float]:
    """Share of the area at positions (P,3) m, warp and weft counted each, whose `carried_strain` is more than AT_LIMIT of the fabric's strain limit, of each
    panel in which it is more than MANY_AT_LIMIT."""
    return _panels_where(cloth, positions, MANY_AT_LIMIT, lambda part, direction: share_of_limit(part, direction, materials) > AT_LIMIT)


def panels_pulled(cloth: Cloth, positions: np.ndarray, materials: MaterialTable, tension: float, many: float) -> dict[str, float]:
    """Share of the area, as of `panels_at_limit`, in which the fabrics of `materials` pull with more than `tension` N/m at their `carried_strain`, of each
    panel in which it is more than `many`."""

    def pulled(part: YarnStrain, direction: int) -> np.ndarray:
        return tension_n_m(part.strain, part.material, materials, direction) > tension

    return _panels_where(cloth, positions, many, pulled)


def _panels_where(cloth: Cloth, positions: np.ndarray, many: float, holds: Callable[[YarnStrain, int], np.ndarray]) -> dict[str, float]:
    """Share of the area of each panel for whose elements `holds`, where it is more than `many`."""
    full, whole = np.zeros((2, len(cloth.panel_names)))
    for direction in (WARP, WEFT):
        part, triangles = carried_strain(cloth, positions, direction), len(cloth.border.area)
        panel = element_panels(cloth, yarn_strain(cloth, positions, direction))
        links = len(panel) - triangles
        panel = np.append(panel[:links], np.repeat(panel[links:], 3))
        whole += np.bincount(panel, part.area, len(whole))
        full += np.bincount(panel, np.where(holds(part, direction), part.area, 0.0), len(whole))
    shares = np.divide(full, whole, out=np.zeros(len(whole)), where=whole > 0.0)
    return {name: float(share) for name, share in zip(cloth.panel_names, shares, strict=True) if share > many}


def tension_summary(cloth: Cloth, positions: np.ndarray, materials: MaterialTable, direction: int) -> dict[str, float | None]:
    """{p50, p99, max} of the tension along `direction` (WARP or WEFT) at positions (P,3) m, N/m, weighted by area; None for a cloth without elements."""
    part = carried_strain(cloth, positions, direction)
    tension = tension_n_m(part.strain, part.material, materials, direction)
    quantiles = {f"p{percent}": weighted_quantile(tension, part.area, percent / 100.0) for percent in (50, 99)}
    return quantiles | {"max": float(tension.max()) if len(tension) else None}

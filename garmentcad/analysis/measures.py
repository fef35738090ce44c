"""Everything that the report says about the draped garment itself, measured on its final positions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from garmentcad.analysis.carried import Carried, carried
from garmentcad.analysis.ease import Ease, garment_ease
from garmentcad.analysis.folds import fold_angles_deg
from garmentcad.analysis.hem import HemHeight, hem_height
from garmentcad.analysis.hem_shape import HemShape, hem_shape
from garmentcad.analysis.maps import fabric_maps
from garmentcad.analysis.on_body import OnBody
from garmentcad.analysis.pressure import CONTACT_KEYS, SUPPORT_KEYS
from garmentcad.analysis.seam_tension import SeamTension
from garmentcad.analysis.strain import (
    AXES,
    bias_strain,
    of_limit_percent,
    share_over_limit_percent,
    strain_percentiles,
    trellis,
    trellis_summary,
    weighted_quantile,
    yarn_strain,
)
from garmentcad.analysis.tension import tension_summary
from garmentcad.analysis.tributary import draped_areas
from garmentcad.cloth.cloth import WARP, WEFT, Cloth
from garmentcad.fabric.material import MaterialTable
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.units import GRAVITY_M_S2, M_TO_MM

HEM = "hem"
DISTANCE_KEYS = ("p5", "p50", "p95", "max")


@dataclass(frozen=True)
class Measures:
    """Numbers for the report and, in `maps`, one value a particle (P,) for the pictures (see `fabric_maps`; pressure and friction in kPa, distance in mm).

    Dicts hold the report's keys: strain_percent warp, weft and bias; tension_n_m warp and weft; distance_mm of the cloth from the body, by its area.
    """

    particles: int
    triangles: int
    panels: int
    strain_percent: dict[str, dict[str, float | None]]
    strain_of_limit_percent: dict[str, dict[str, float | None]]
    tension_n_m: dict[str, dict[str, float | None]]
    trellis_deg: dict[str, float | None]
    strain_over_limit_percent: float | None
    ease: dict[str, Ease | None]
    hem: HemHeight | None
    hem_shape: HemShape | None
    carried: Carried | None
    fold_deg: dict[str, float | None]
    mass_kg: float
    pressure_kpa: dict[str, float | None]
    friction_kpa: dict[str, float | None]
    support_n: dict[str, float | None]
    contact_area_m2: float | None
    distance_mm: dict[str, float | None]
    seams: dict[str, SeamTension | None]
    maps: dict[str, np.ndarray] = field(default_factory=dict)


def measure(
    cloth: Cloth,
    positions: np.ndarray,
    materials: MaterialTable,
    mannequin: Mannequin | None,
    roles: Mapping[str, Sequence[str]] | None = None,
    placed: np.ndarray | None = None,
    on_body: OnBody | None = None,
    seams: dict[str, SeamTension | None] | None = None,
    folds: Mapping[str, np.ndarray] | None = None,
) -> Measures:
    """Measure a garment at positions (P,3) m. roles: role of edges -> keys of `Cloth.edge_vertices`; placed: (V,3) m of the vertices before sewing; folds: see
    `fold_angles_deg`. Without a mannequin (swatches) there is no ease.

    Positions that are not finite (a diverged run) give a record whose values are None.
    """
    roles = {} if roles is None else roles
    counts = (cloth.particle_count, len(cloth.triangles), len(cloth.panel_names))
    mass = float(cloth.masses.sum())
    if not np.isfinite(positions).all():
        return unmeasured(*counts, mass, tuple(folds or {}))
    warp, weft = (yarn_strain(cloth, positions, direction) for direction in (WARP, WEFT))
    maps = fabric_maps(cloth, positions, materials)
    if on_body is not None:
        maps |= {"pressure": on_body.pressure.kpa, "friction": on_body.pressure.friction_kpa, "distance": M_TO_MM * on_body.distance_m}
    pressure = None if on_body is None else on_body.pressure
    return Measures(
        *counts,
        strain_percent={"warp": strain_percentiles(warp), "weft": strain_percentiles(weft), "bias": strain_percentiles(*bias_strain(cloth, positions))},
        strain_of_limit_percent=of_limit_percent(warp, weft, materials),
        tension_n_m={axis: tension_summary(cloth, positions, materials, direction) for axis, direction in zip(AXES, (WARP, WEFT))},
        trellis_deg=trellis_summary(trellis(cloth, positions)),
        strain_over_limit_percent=share_over_limit_percent(warp, weft, materials),
        ease={} if mannequin is None else garment_ease(cloth, positions, mannequin),
        hem=hem_height(cloth, positions, roles.get(HEM, ())),
        hem_shape=hem_shape(cloth, positions, roles.get(HEM, ())),
        carried=None if mannequin is None or placed is None else carried(cloth, placed, positions, mannequin, roles),
        fold_deg=fold_angles_deg(cloth, positions, folds or {}),
        mass_kg=mass,
        pressure_kpa=dict.fromkeys(CONTACT_KEYS) if pressure is None else pressure.summary(),
        friction_kpa=dict.fromkeys(CONTACT_KEYS) if pressure is None else pressure.friction_summary(),
        support_n=dict.fromkeys(SUPPORT_KEYS) if pressure is None else pressure.support_n(GRAVITY_M_S2 * mass),
        contact_area_m2=None if pressure is None else pressure.contact_area_m2(),
        distance_mm=dict.fromkeys(DISTANCE_KEYS) if on_body is None else _distances(on_body.distance_m, draped_areas(cloth, positions)),
        seams={} if seams is None else seams,
        maps=maps,
    )


def _distances(distance_m: np.ndarray, area: np.ndarray) -> dict[str, float | None]:
    quantiles = {f"p{percent}": weighted_quantile(distance_m, area, percent / 100.0) for percent in (5, 50, 95)}
    found = quantiles | {"max": float(distance_m.max())}
    return {key: None if value is None else M_TO_MM * value for key, value in found.items()}


def unmeasured(particles: int, triangles: int, panels: int, mass_kg: float, folds: Iterable[str] = ()) -> Measures:
    """The record of a garment that has no shape to measure: every value is None."""

    def none(*keys: str) -> dict[str, float | None]:
        return dict.fromkeys(keys)

    return Measures(
        particles,
        triangles,
        panels,
        strain_percent={axis: none("p50", "p99", "max", "min") for axis in (*AXES, "bias")},
        strain_of_limit_percent={axis: none("p99", "max") for axis in AXES},
        tension_n_m={axis: none("p50", "p99", "max") for axis in AXES},
        trellis_deg=none("p99", "max", "over_8_percent"),
        strain_over_limit_percent=None,
        ease={},
        hem=None,
        hem_shape=None,
        carried=None,
        fold_deg=dict.fromkeys(folds),
        mass_kg=mass_kg,
        pressure_kpa=none(*CONTACT_KEYS),
        friction_kpa=none(*CONTACT_KEYS),
        support_n=none(*SUPPORT_KEYS),
        contact_area_m2=None,
        distance_mm=none(*DISTANCE_KEYS),
        seams={},
    )

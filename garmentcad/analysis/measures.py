"""Everything that the report says about the draped garment itself, measured on its final positions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from garmentcad.analysis.carried import Carried, carried
from garmentcad.analysis.ease import Ease, garment_ease
from garmentcad.analysis.folds import fold_angles_deg
from garmentcad.analysis.hem import HemHeight, hem_height
from garmentcad.analysis.pressure import ContactPressure
from garmentcad.analysis.strain import AXES, share_over_limit_percent, strain_map, strain_percentiles, trellis, trellis_summary, yarn_strain
from garmentcad.analysis.tension import tension_map
from garmentcad.cloth.cloth import WARP, WEFT, Cloth
from garmentcad.fabric.material import MaterialTable
from garmentcad.mannequin.mannequin import Mannequin

HEM = "hem"


@dataclass(frozen=True)
class Measures:
    """Numbers for the report and, in `maps`, one value a particle (P,) for the pictures: strain (no unit), tension (N/m), pressure (kPa)."""

    particles: int
    triangles: int
    panels: int
    strain_percent: dict[str, dict[str, float | None]]
    trellis_deg: dict[str, float | None]
    strain_over_limit_percent: float | None
    ease: dict[str, Ease | None]
    hem: HemHeight | None
    carried: Carried | None
    fold_deg: dict[str, float | None]
    mass_kg: float
    pressure_kpa: dict[str, float | None]
    maps: dict[str, np.ndarray] = field(default_factory=dict)


def measure(
    cloth: Cloth,
    positions: np.ndarray,
    materials: MaterialTable,
    mannequin: Mannequin | None,
    roles: Mapping[str, Sequence[str]] | None = None,
    placed: np.ndarray | None = None,
    pressure: ContactPressure | None = None,
    folds: Mapping[str, np.ndarray] | None = None,
) -> Measures:
    """Measure a garment at positions (P,3) m. roles: role of edges -> keys of `Cloth.edge_vertices`; placed: (V,3) m of the vertices before sewing; folds: see
    `fold_angles_deg`. Without a mannequin (swatches) there is no ease.

    Positions that are not finite (a diverged run) give a record whose values are None.
    """
    roles = {} if roles is None else roles
    counts = (cloth.particle_count, len(cloth.triangles), len(cloth.panel_names))
    if not np.isfinite(positions).all():
        nothing: dict[str, float | None] = dict.fromkeys(("p50", "p99", "max", "min"))
        no_trellis: dict[str, float | None] = dict.fromkeys(("p99", "max", "over_8_percent"))
        no_pressure: dict[str, float | None] = dict.fromkeys(("max", "mean_in_contact"))
        no_strain, mass_kg = {axis: dict(nothing) for axis in AXES}, float(cloth.masses.sum())
        return Measures(*counts, no_strain, no_trellis, None, {}, None, None, dict.fromkeys(folds or ()), mass_kg, no_pressure)
    warp, weft = yarn_strain(cloth, positions, WARP), yarn_strain(cloth, positions, WEFT)
    maps = {"strain": strain_map(cloth, warp, weft), "tension": tension_map(cloth, warp, weft, materials)}
    if pressure is not None:
        maps["pressure"] = pressure.kpa
    return Measures(
        *counts,
        strain_percent={axis: strain_percentiles(part) for axis, part in zip(AXES, (warp, weft))},
        trellis_deg=trellis_summary(trellis(cloth, positions)),
        strain_over_limit_percent=share_over_limit_percent(warp, weft, materials),
        ease={} if mannequin is None else garment_ease(cloth, positions, mannequin),
        hem=hem_height(cloth, positions, roles.get(HEM, ())),
        carried=None if mannequin is None or placed is None else carried(cloth, placed, positions, mannequin, roles),
        fold_deg=fold_angles_deg(cloth, positions, folds or {}),
        mass_kg=float(cloth.masses.sum()),
        pressure_kpa={"max": None, "mean_in_contact": None} if pressure is None else pressure.summary(),
        maps=maps,
    )

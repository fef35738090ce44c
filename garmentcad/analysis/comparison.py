"""Two draped garments: how far their surfaces lie apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from garmentcad.analysis.penetration import signed_distances
from garmentcad.analysis.tributary import draped_areas
from garmentcad.cloth.cloth import Cloth
from garmentcad.units import M_TO_MM


@dataclass(frozen=True)
class ShapeDifference:
    """apart_mm: (P,) distance of each particle of the first garment from the second one's surface; rms_mm over its area, max_mm: the farthest of either garment
    from the other."""

    apart_mm: np.ndarray
    rms_mm: float
    max_mm: float


def shape_difference(cloth: Cloth, positions: np.ndarray, other: Cloth, other_positions: np.ndarray) -> ShapeDifference:
    """Compare two garments of any pattern and lattice as surfaces, from positions (P,3) m of each."""
    apart = M_TO_MM * np.abs(signed_distances(positions, other_positions, other.particle_triangles))
    back = M_TO_MM * np.abs(signed_distances(other_positions, positions, cloth.particle_triangles))
    rms = float(np.sqrt(np.average(apart**2, weights=draped_areas(cloth, positions))))
    return ShapeDifference(apart, rms, float(max(apart.max(), back.max())))

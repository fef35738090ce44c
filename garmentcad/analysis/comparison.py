"""Two draped garments: how far their surfaces lie apart."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from garmentcad.analysis.penetration import signed_distances
from garmentcad.units import M_TO_MM


class Surface(NamedTuple):
    """A garment as it hangs: positions (P,3) m and triangles (F,3) of them."""

    positions: np.ndarray
    triangles: np.ndarray


@dataclass(frozen=True)
class ShapeDifference:
    """apart_mm: (P,) distance of each particle of the first garment from the second one's surface; rms_mm over its area, max_mm: the farthest of either garment
    from the other."""

    apart_mm: np.ndarray
    rms_mm: float
    max_mm: float


def shape_difference(one: Surface, other: Surface) -> ShapeDifference:
    """Compare two garments of any pattern and lattice as surfaces."""
    apart = M_TO_MM * np.abs(signed_distances(one.positions, *other))
    back = M_TO_MM * np.abs(signed_distances(other.positions, *one))
    corners = one.positions[one.triangles]
    double = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    rms = float(np.sqrt(np.average((apart**2)[one.triangles].mean(axis=1), weights=double)))
    return ShapeDifference(apart, rms, float(max(apart.max(), back.max())))

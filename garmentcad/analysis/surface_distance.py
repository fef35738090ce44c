"""How far two draped surfaces lie apart.

Points of one cloth need no partner on the other: patterns and lattices may differ, and cloth that slid within its own surface is not apart.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from garmentcad.analysis.penetration import signed_distances
from garmentcad.errors import InputError
from garmentcad.units import M_TO_MM


class Surface(NamedTuple):
    """A garment as it hangs: positions (P,3) m and triangles (F,3) of them."""

    positions: np.ndarray
    triangles: np.ndarray


@dataclass(frozen=True)
class SurfaceDistance:
    """from_first_mm: (P,) distance of each particle of the first surface from the second; from_second_mm: (Q,) the other way.

    rms_mm: of both ways together, over the area of both; max_mm: the farthest of either from the other.
    """

    from_first_mm: np.ndarray
    from_second_mm: np.ndarray
    rms_mm: float
    max_mm: float


def surface_distance(first: Surface, second: Surface) -> SurfaceDistance:
    """Distances of two surfaces from each other. Both ways, so that cloth that is missing on one side counts as well."""
    there, back = M_TO_MM * np.abs(signed_distances(first.positions, *second)), M_TO_MM * np.abs(signed_distances(second.positions, *first))
    squares = np.concatenate([(apart**2)[surface.triangles].mean(axis=1) for apart, surface in ((there, first), (back, second))])
    areas = np.concatenate([_areas(first), _areas(second)])
    if not areas.sum() > 0.0:
        raise InputError("neither surface has an area; a distance of surfaces is a mean over it")
    return SurfaceDistance(there, back, float(np.sqrt(np.average(squares, weights=areas))), float(max(there.max(), back.max())))


def _areas(surface: Surface) -> np.ndarray:
    corners = surface.positions[surface.triangles]
    return np.asarray(0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1))

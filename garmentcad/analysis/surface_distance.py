"""How far two draped surfaces lie apart.

Points of one cloth need no partner on the other: lattices may differ, and cloth that slid within its own surface is not apart.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from garmentcad.analysis.penetration import signed_distances
from garmentcad.units import M_TO_MM


class Surface(Protocol):
    """Triangles of vertices and the particles they stand for: a Cloth is one."""

    @property
    def triangles(self) -> np.ndarray: ...  # (F,3)
    @property
    def vertex_particle(self) -> np.ndarray: ...  # (V,)
    @property
    def particle_triangles(self) -> np.ndarray: ...  # (F,3)


@dataclass(frozen=True)
class SurfaceDistance:
    """from_first: (P,) m, distance of each particle of the first surface from the second; from_second: (Q,) m, the other way.

    rms_mm, max_mm: of both ways together.
    """

    from_first: np.ndarray
    from_second: np.ndarray

    @property
    def rms_mm(self) -> float:
        return M_TO_MM * float(np.sqrt((np.concatenate([self.from_first, self.from_second]) ** 2).mean()))

    @property
    def max_mm(self) -> float:
        return M_TO_MM * float(max(self.from_first.max(), self.from_second.max()))


def surface_distance(first: Surface, first_positions: np.ndarray, second: Surface, second_positions: np.ndarray) -> SurfaceDistance:
    """Distances of the particles (P,3), (Q,3) m of two surfaces from the other one. Both ways, so that cloth that is missing on one side counts as well."""
    return SurfaceDistance(
        np.abs(signed_distances(first_positions, second_positions, second.particle_triangles)),
        np.abs(signed_distances(second_positions, first_positions, first.particle_triangles)),
    )

"""Area that each particle stands for."""

from __future__ import annotations

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.units import MM_TO_M


def triangle_areas(cloth: Cloth) -> np.ndarray:
    """Rest areas (F,) of the triangles on the pattern, m2."""
    a, b, c = (cloth.vertex_uv_mm[cloth.triangles[:, corner]] * MM_TO_M for corner in range(3))
    return 0.5 * np.abs((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))


def particle_areas(cloth: Cloth) -> np.ndarray:
    """Rest area (P,) of each particle, m2: a third of every triangle around it, both sides of a seam included."""
    third = triangle_areas(cloth) / 3.0
    return np.bincount(cloth.particle_triangles.ravel(), weights=np.repeat(third, 3), minlength=cloth.particle_count)


def draped_areas(cloth: Cloth, positions: np.ndarray) -> np.ndarray:
    """Area (P,) of each particle at positions (P,3) m, m2: a third of every triangle around it."""
    corners = positions[cloth.particle_triangles]
    double = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return np.bincount(cloth.particle_triangles.ravel(), weights=np.repeat(double / 6.0, 3), minlength=cloth.particle_count)

"""Area that each particle stands for."""

from __future__ import annotations

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.geometry.triangle import corner_shares


def draped_areas(cloth: Cloth, positions: np.ndarray) -> np.ndarray:
    """Area (P,) of each particle at positions (P,3) m, m2: a quarter of every cell around it, and of every border triangle what is
    nearest to it, over seams.

    As masses are shared; the triangles that stand for cells would give twice as much to a particle where their diagonals meet as to its neighbours.
    """
    cells, strip = positions[cloth.cells.corners], positions[cloth.border.corners]
    of_cells = 0.5 * np.linalg.norm(np.cross(cells[:, 2] - cells[:, 0], cells[:, 3] - cells[:, 1]), axis=1)
    of_strip = 0.5 * np.linalg.norm(np.cross(strip[:, 1] - strip[:, 0], strip[:, 2] - strip[:, 0]), axis=1)
    corners = np.concatenate([cloth.cells.corners.ravel(), cloth.border.corners.ravel()])
    shares = np.concatenate([np.repeat(0.25 * of_cells, 4), (of_strip[:, None] * corner_shares(strip)).ravel()])
    return np.bincount(corners, weights=shares, minlength=cloth.particle_count)

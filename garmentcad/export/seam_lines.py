"""Lines of a garment that a picture shows: where sewn edges meet, and where the cloth ends."""

from __future__ import annotations

import numpy as np

from garmentcad.arrays import indices
from garmentcad.cloth.cloth import Cloth


def seam_and_free_edges(cloth: Cloth) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of particles (S,2) along seams and dart legs, and (B,2) along hems and other free edges.

    An edge of one panel that one triangle alone uses lies on the contour. Where two contour edges have the same two particles they are sewn together.
    """
    corners = cloth.triangles
    edges, uses = _counted(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]))
    pairs, uses = _counted(cloth.vertex_particle[edges[uses == 1]])
    return pairs[uses > 1], pairs[uses == 1]


def _counted(pairs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The different pairs among (E,2), either way around, and how often each occurs."""
    width = int(pairs.max(initial=0)) + 1
    keys, uses = np.unique(pairs.min(axis=1).astype(np.int64) * width + pairs.max(axis=1), return_counts=True)
    return indices(np.column_stack([keys // width, keys % width])), uses

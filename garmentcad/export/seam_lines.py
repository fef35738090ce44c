"""Lines of a garment that a picture shows: where sewn edges meet, and where the cloth ends."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from garmentcad.arrays import unique_pairs


class SewnTriangles(Protocol):
    """Triangles of vertices and the particles they stand for: all that a picture needs of a Cloth."""

    @property
    def triangles(self) -> np.ndarray: ...  # (F,3)
    @property
    def vertex_particle(self) -> np.ndarray: ...  # (V,)
    @property
    def particle_triangles(self) -> np.ndarray: ...  # (F,3)
    @property
    def triangle_layer(self) -> np.ndarray: ...  # (F,)


def seam_and_free_edges(cloth: SewnTriangles) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of particles (S,2) along seams and dart legs, and (B,2) along hems and other free edges.

    An edge of one panel that one triangle alone uses lies on the contour. Where two contour edges have the same two particles they are sewn together.
    """
    corners = cloth.triangles
    edges, edge = unique_pairs(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]))
    pairs, pair = unique_pairs(cloth.vertex_particle[edges[np.bincount(edge) == 1]])
    uses = np.bincount(pair)
    return pairs[uses > 1], pairs[uses == 1]
